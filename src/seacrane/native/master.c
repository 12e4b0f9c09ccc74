/* Master loop of a co-simulation: macro steps over slaves given as function addresses, on one flat array of values.
 *
 * A slave is either a set of FMI 2 functions (set, step, get) with a handle, or one callback that works on the shared
 * arrays. The loop transfers outputs to inputs, steps, checks that every output is finite, accounts for the power at
 * each bond and writes due rows of the recorders. It allocates nothing. The Python loop in seacrane/cosim/loops.py does
 * the same operations in the same order, so both give the same bits; compile with -ffp-contract=off. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef int (*set_function)(void *, const uint32_t *, size_t, const double *);
typedef int (*get_function)(void *, const uint32_t *, size_t, double *);
typedef int (*step_function)(void *, double, double, int);
typedef int (*callback_function)(void *, double, double);

typedef struct {
    void *handle;
    set_function set;
    step_function step;
    get_function get;
    callback_function callback; /* used instead of the three where it is not null */
    const uint32_t *input_references, *output_references, *watched_references;
    double *inputs, *outputs, *watched; /* slices of plan.values */
    int64_t input_count, output_count, watched_count;
    int64_t first_connection, connection_count; /* into this slave */
    int64_t first_change, input_changes, output_changes; /* manipulations of its inputs, then of its outputs */
    int64_t stopped;                                     /* 1: never stepped again, its outputs stay */
} slave_t;

typedef struct {
    int64_t source, target; /* indices into values */
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
    double effort_side, flow_side; /* factor of the product of each side to W */
} bond_t;

/* Order of a bond's account; seacrane/cosim/bonds.py names the same. */
enum { EFFORT_BEFORE, FLOW_BEFORE, POWER, FLOW_POWER, RESIDUAL, ENERGY, ENERGY_ERROR, ENERGY_MOVED, PEAK_RESIDUAL };

typedef struct {
    int64_t stride, width, capacity, count, watches;
    const int64_t *indices;
    double *rows; /* capacity rows of time and width values */
} recorder_t;

typedef struct {
    int64_t slave_count, connection_count, bond_count, recorder_count;
    int64_t simultaneous; /* 1: all inputs are transferred before any slave steps (Jacobi) */
    int64_t start_ns, step_ns;
    slave_t *slaves;
    connection_t *connections;
    bond_t *bonds;
    recorder_t *recorders;
    double *values;
    change_t *changes;
    trigger_t *triggers;
    const condition_t *conditions;
    int64_t trigger_count, trigger_watches;
    volatile int64_t *calls; /* of each slave: odd while it is at work, for a watchdog on another thread */
    volatile int64_t *stop;  /* set from another thread: end after this macro step */
    int64_t done;                                     /* macro steps since the start */
    int64_t fault_slave, fault_stage, fault_status, fault_variable;
} plan_t;

enum { DONE, ROWS_FULL, FAULT, STOPPED };
enum { SET, STEP, GET, FINITE, WATCH };

static int fault(plan_t *p, int64_t slave, int stage, int64_t status, int64_t variable) {
    p->fault_slave = slave;
    p->fault_stage = stage;
    p->fault_status = status;
    p->fault_variable = variable;
    return FAULT;
}

static void transfer(plan_t *p, int64_t first, int64_t count) {
    const connection_t *c = p->connections + first;
    for (const connection_t *end = c + count; c < end; ++c) {
        const double scaled = p->values[c->source] * c->gain;
        p->values[c->target] = scaled + (c->adds ? p->values[c->target] : c->bias);
    }
}

static void manipulate(plan_t *p, int64_t first, int64_t count, double t) {
    change_t *c = p->changes + first;
    for (const change_t *end = c + count; c < end; ++c) {
        double *value = p->values + c->target;
        if (!c->fixed) c->raw = *value;
        const double scaled = c->gain * c->raw;
        *value = scaled + c->bias;
        if (t < c->end) {
            const double rest = c->slope * (c->end - t);
            *value -= rest;
        }
    }
}

/* FMI 2 status: 0 is OK, 1 a warning; discard, error, fatal and pending end the run. */
static int exchange(plan_t *p, int64_t i, double t, double h) {
    const slave_t *s = p->slaves + i;
    int status;
    if (s->callback) {
        if ((status = s->callback(s->handle, t, h)) > 1 || status < 0) return fault(p, i, STEP, status, -1);
    } else {
        if (s->input_count) {
            status = s->set(s->handle, s->input_references, (size_t)s->input_count, s->inputs);
            if (status > 1 || status < 0) return fault(p, i, SET, status, -1);
        }
        status = s->step(s->handle, t, h, 1);
        if (status > 1 || status < 0) return fault(p, i, STEP, status, -1);
        if (s->output_count) {
            status = s->get(s->handle, s->output_references, (size_t)s->output_count, s->outputs);
            if (status > 1 || status < 0) return fault(p, i, GET, status, -1);
        }
    }
    for (int64_t j = 0; j < s->output_count; ++j)
        if (!isfinite(s->outputs[j])) return fault(p, i, FINITE, 0, j);
    return DONE;
}

static int advance(plan_t *p, int64_t i, double t, double h) {
    const slave_t *s = p->slaves + i;
    if (s->stopped) return DONE;
    if (s->input_changes) manipulate(p, s->first_change, s->input_changes, t);
    p->calls[i] += 1;
    const int result = exchange(p, i, t, h);
    p->calls[i] += 1;
    if (s->output_changes && result == DONE)
        manipulate(p, s->first_change + s->input_changes, s->output_changes, t + h);
    return result;
}

static void remember(const bond_t *b, double *v) {
    v[b->account + EFFORT_BEFORE] = v[b->effort_out];
    v[b->account + FLOW_BEFORE] = v[b->flow_out];
}

/* Inputs are held during a macro step; the mean of an output over it is that of its two ends. */
static void balance(const bond_t *b, double *v, double h) {
    double *a = v + b->account;
    const double effort = 0.5 * (a[EFFORT_BEFORE] + v[b->effort_out]);
    const double flow = 0.5 * (a[FLOW_BEFORE] + v[b->flow_out]);
    const double given = effort * v[b->flow_in] * b->effort_side;
    const double taken = v[b->effort_in] * flow * b->flow_side;
    const double residual = given - taken;
    a[POWER] = given;
    a[FLOW_POWER] = taken;
    a[RESIDUAL] = residual;
    a[ENERGY] += given * h;
    a[ENERGY_ERROR] += residual * h;
    a[ENERGY_MOVED] += fabs(given) * h;
    if (fabs(residual) > a[PEAK_RESIDUAL]) a[PEAK_RESIDUAL] = fabs(residual);
}

/* Read the watched internal variables of all slaves. */
EXPORT int seacrane_watch(plan_t *p) {
    for (int64_t i = 0; i < p->slave_count; ++i) {
        const slave_t *s = p->slaves + i;
        if (!s->watched_count) continue;
        const int status = s->get(s->handle, s->watched_references, (size_t)s->watched_count, s->watched);
        if (status > 1 || status < 0) return fault(p, i, WATCH, status, -1);
    }
    return DONE;
}

static int record(plan_t *p, double t) {
    int watched = 0;
    for (int64_t i = 0; i < p->recorder_count; ++i) {
        recorder_t *r = p->recorders + i;
        if (p->done % r->stride) continue;
        if (r->watches && !watched++) {
            const int result = seacrane_watch(p);
            if (result != DONE) return result;
        }
        double *row = r->rows + r->count++ * (r->width + 1);
        row[0] = t;
        for (int64_t j = 0; j < r->width; ++j) row[j + 1] = p->values[r->indices[j]];
    }
    return DONE;
}

static int look(plan_t *p) {
    int64_t fired = 0;
    if (p->trigger_watches) {
        const int result = seacrane_watch(p);
        if (result != DONE) return result;
    }
    for (int64_t i = 0; i < p->trigger_count; ++i) {
        trigger_t *t = p->triggers + i;
        int64_t holds = 1;
        for (const condition_t *c = p->conditions + t->first, *end = c + t->count; c < end; ++c)
            holds = holds && (c->above ? p->values[c->index] > c->threshold : p->values[c->index] < c->threshold);
        if (holds && !t->held && !t->fired) t->fired = fired = 1;
        t->held = holds;
    }
    return fired ? STOPPED : DONE;
}

/* Do `steps` macro steps; plan.done counts those done. It does fewer if a recorder's rows are full, a slave fails, a
 * trigger fires or it is told to stop. */
EXPORT int seacrane_run(plan_t *p, int64_t steps) {
    const double h = (double)p->step_ns / 1e9;
    for (; steps > 0; --steps) {
        const double t = (double)(p->start_ns + p->done * p->step_ns) / 1e9;
        int result;
        for (int64_t i = 0; i < p->recorder_count; ++i)
            if (p->recorders[i].count == p->recorders[i].capacity) return ROWS_FULL;
        for (int64_t i = 0; i < p->bond_count; ++i) remember(p->bonds + i, p->values);
        if (p->simultaneous) transfer(p, 0, p->connection_count);
        for (int64_t i = 0; i < p->slave_count; ++i) {
            if (!p->simultaneous) transfer(p, p->slaves[i].first_connection, p->slaves[i].connection_count);
            if ((result = advance(p, i, t, h)) != DONE) return result;
        }
        for (int64_t i = 0; i < p->bond_count; ++i) balance(p->bonds + i, p->values, h);
        p->done += 1;
        result = record(p, (double)(p->start_ns + p->done * p->step_ns) / 1e9);
        if (result != DONE) return result;
        if (p->trigger_count && (result = look(p)) != DONE) return result;
        if (*p->stop) return STOPPED;
    }
    return DONE;
}
