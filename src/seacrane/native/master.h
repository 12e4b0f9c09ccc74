/* The plan of a co-simulation as the master loop sees it: slaves, connections, bonds and recorders on one flat array of
 * values. seacrane/cosim/native_loop.py lays out the same structures; everything that belongs to the state of a run,
 * histories and step sizes included, lies in `values`. Times are whole nanoseconds since the start of the run. */
#ifndef SEACRANE_MASTER_H
#define SEACRANE_MASTER_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define MOST_SAMPLES 3 /* of an output's history: enough for a parabola */

typedef int (*set_function)(void *, const uint32_t *, size_t, const double *);
typedef int (*get_function)(void *, const uint32_t *, size_t, double *);
typedef int (*step_function)(void *, double, double, int);
typedef int (*derive_function)(void *, const uint32_t *, size_t, const int32_t *, const double *);
typedef int (*directional_function)(void *, const uint32_t *, size_t, const uint32_t *, size_t, const double *, double *);
typedef int (*save_function)(void *, void **);
typedef int (*restore_function)(void *, void *);
typedef int (*callback_function)(void *, double, double);

enum { STEP_START, MACRO_START, SAVED_STATES }; /* of a slave: where an iteration and where a step size begins anew */

typedef struct {
    void *handle;
    set_function set;
    step_function step;
    get_function get;
    derive_function derive; /* null where inputs are held, and where nothing is extrapolated */
    directional_function directional; /* null where a slave does not give them */
    save_function save, release;
    restore_function restore;
    callback_function callback; /* used instead of set, step and get where it is not null */
    const uint32_t *input_references, *output_references, *watched_references, *derived_references;
    const int32_t *orders;             /* ones */
    double *inputs, *outputs, *watched; /* slices of plan.values */
    double *begins, *slopes;           /* inputs at the beginning of a step, and how fast they change */
    double *derived_slopes;            /* those of the inputs that are driven, in the order of derived_references */
    double *times;                     /* of the samples, newest first [ns]; after them, how many there are */
    int64_t first_input, first_output; /* indices into values */
    int64_t input_count, output_count, watched_count, derived_count;
    const int64_t *derived;            /* places of the driven ones among the inputs */
    int64_t first_connection, connection_count; /* into this slave */
    int64_t first_change, input_changes, output_changes; /* manipulations of its inputs, then of its outputs */
    int64_t stopped;                   /* 1: never stepped again, its outputs stay */
    int64_t substeps, every;           /* steps in a macro step; or macro steps in a step */
    void *saved[SAVED_STATES];
    int64_t fault_stage, fault_status, fault_variable;
} slave_t;

typedef struct {
    int64_t source, target; /* indices into values */
    int64_t from;           /* the slave of the source */
    int64_t owed;           /* index of what the target is still owed, -1 if that is not kept */
    double gain, bias;
    int64_t adds; /* 1: adds to what an earlier connection has brought to the same input, in place of the bias */
} connection_t;

/* A variable that is not what its connection or its slave says, but gain * raw + bias, reached by a ramp of `slope`
 * that ends at time `end`. */
typedef struct {
    int64_t target;
    int64_t fixed; /* 1: nothing drives the variable, so `raw` is what it was set to */
    double gain, bias, slope, end, raw;
} change_t;

/* All of `count` conditions from `first` on; `fired` is set to 1 when they come to hold, unless it is set already. */
typedef struct {
    int64_t first, count, held, fired;
} trigger_t;

typedef struct {
    int64_t index, above; /* above: 1 for value > threshold, 0 for value < threshold */
    double threshold;
} condition_t;

typedef struct {
    int64_t effort_out, flow_in; /* at the effort's side */
    int64_t effort_in, flow_out; /* at the flow's side */
    int64_t account;             /* index of the nine values below */
    int64_t effort_slave, flow_slave;
    int64_t effort_connection, flow_connection;
    double effort_side, flow_side; /* factor of the product of each side to W */
} bond_t;

/* Order of a bond's account; seacrane/cosim/bonds.py names the same. */
enum { EFFORT_BEFORE, FLOW_BEFORE, POWER, FLOW_POWER, RESIDUAL, ENERGY, ENERGY_ERROR, ENERGY_MOVED, PEAK_RESIDUAL };

/* What the algorithm tells of itself; seacrane/cosim/plan.py names the same. */
enum { MACRO_STEP, ITERATIONS, REJECTED, COUPLING_ERROR };

typedef struct {
    int64_t stride, width, capacity, count, watches;
    const int64_t *indices;
    double *rows; /* capacity rows of time and width values */
} recorder_t;

#define TRIALS 7 /* blocks of sweeps of each kind, serial and parallel */
typedef struct { /* slaves that may step side by side, in the order in which their faults count */
    const int64_t *members;
    int64_t count, natives;
    /* how threads have proved here; no part of the state, since it changes no result */
    int64_t phase, parallel, threaded, left, block, taken, block_ns, waited_ns, lost_ns, serial_ns;
    int64_t trial_ns[2][TRIALS];
} group_t;

typedef struct pool pool_t;

typedef struct plan {
    int64_t slave_count, connection_count, bond_count, recorder_count, group_count;
    int64_t start_ns, step_ns;
    slave_t *slaves;
    connection_t *connections;
    bond_t *bonds;
    recorder_t *recorders;
    group_t *groups;
    double *values;
    change_t *changes;
    trigger_t *triggers;
    const condition_t *conditions;
    int64_t trigger_count, trigger_watches;
    volatile int64_t *calls; /* of each slave: odd while it is at work, for a watchdog on another thread */
    volatile int64_t *stop;  /* set from another thread: end after this macro step */
    int64_t value_count, output_count; /* outputs come first in values */
    /* extrapolation: `depth` rows of samples of all outputs, newest first; 0 where inputs are outputs as they are */
    int64_t depth, order;
    double *samples;
    double *signals; /* MACRO_STEP ... */
    /* iteration: 0 none, 1 fixed point, 2 Newton */
    int64_t iteration, aitken, most, tells, coupled_count; /* tells: some slave gives directional derivatives */
    double relaxation, tolerance;
    const int64_t *coupled; /* indices of the outputs that are connected */
    const int64_t *coupled_slave;
    const double *nominal; /* of all outputs */
    double *jacobian;      /* of the coupled outputs to themselves over a macro step, before it whence and for which step */
    double *guess, *residual, *before, *scale, *base, *matrix, *column; /* scratch */
    /* step size control: 0 none, 1 power at the bonds, 2 step doubling */
    int64_t control, repeats, smallest_ns; /* repeats: all slaves can be brought back */
    double control_tolerance, safety, power;
    double *controller; /* next step [ns], error of the last one, then the greatest power of each bond [W] */
    double *backup, *coarse; /* scratch: values, outputs */
    int64_t threads;
    pool_t *pool;
    int64_t done, sweeps; /* macro steps of the grid since the start; steps of all slaves, repeated ones included */
    int64_t fault_slave, fault_stage, fault_status, fault_variable;
} plan_t;

enum { DONE, ROWS_FULL, FAULT, STOPPED };
enum { SET, STEP, GET, FINITE, WATCH, SAVE, RESTORE, CONVERGE, DERIVE };

int fault(plan_t *p, int64_t slave, int64_t stage, int64_t status, int64_t variable);

/* Weights of the samples of a source for a step of its target from `a` to `b`. With tau = 0 ... 1 over the step, the
 * polynomial through the samples is projected on what a slave takes: its mean where inputs are held, the straight line
 * of the same mean and first moment where they may change. */
typedef struct {
    int count;
    double mean[MOST_SAMPLES], begin[MOST_SAMPLES], slope[MOST_SAMPLES], end[MOST_SAMPLES];
} weights_t;

/* exchange.c */
void weigh(const plan_t *p, const slave_t *from, double a, double b, weights_t *w);
int active(const plan_t *p, const slave_t *s);
void transfer(plan_t *p, const slave_t *s, int64_t from, int64_t to);
int step_slave(plan_t *p, slave_t *s, int64_t from, int64_t size);
void predict(plan_t *p, const slave_t *s, int64_t from, int64_t size, double *outputs);
void push(plan_t *p, slave_t *s, int64_t time, const double *outputs);
int sweep(plan_t *p, int64_t from, int64_t size, int iterating);
int save_all(plan_t *p, int slot);
int restore_slave(plan_t *p, int64_t i, int slot);
int restore_all(plan_t *p, int slot);

/* iterate.c */
int iterate(plan_t *p, int64_t from, int64_t size);

/* pool.c */
int64_t group_begin(plan_t *p, group_t *g);
void step_group(plan_t *p, group_t *g, int64_t from, int64_t size);
void group_end(plan_t *p, group_t *g, int64_t begin);
void pool_end(plan_t *p);

#endif
