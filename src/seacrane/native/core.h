/* An instance of a model: its state, the workspace of its solver, and what is done with them.

   Nothing is static or thread-local: instances are independent of each other, and all that a rollback must bring
   back is one flat block without pointers. */
#ifndef SEACRANE_CORE_H
#define SEACRANE_CORE_H

#include <stddef.h>

#include "model.h"

/* STEPPING is for co-simulation; EVENT and CONTINUOUS are its place in model exchange. */
enum phase { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED, EVENT, CONTINUOUS };

#define STATE_MAGIC 0x52434153u /* "SACR" */
#define STATE_VERSION 3u

struct state {
    uint32_t magic, version, size, unused; /* these and the hash tell whose state this is */
    unsigned char model[16];
    double time, next_step;           /* [s]; the step size the solver would like next */
    double y[ROOM(N)];                /* states, then algebraic unknowns */
    double u[ROOM(NU)];               /* inputs at `time` */
    double slope[ROOM(NU)], curvature[ROOM(NU)]; /* their first and second time derivatives */
    double p[NP + ROOM(NM)];          /* parameters, then modes */
    double setting[NSETTINGS];
    double crowd_since;               /* [s]; start of the time over which events are counted to tell chattering */
    int32_t crowd;
    int32_t phase, consistent;        /* consistent: z solves the algebraic equations */
    int32_t sloped;                   /* enum ramp */
    int32_t exchange;                 /* an instance for model exchange: integrated by the environment */
    int32_t above[ROOM(NE)];          /* whether the indicator of an event is above zero */
};

/* A ramp that a communication step has used up is not continued, but still tells how fast its inputs came to its end. */
enum ramp { CONSTANT, RAMPED, USED_UP };

struct statistics {
    uint64_t steps, rejected, residuals, jacobians, factorizations;
};

#define KEPT_EVENTS 256
struct events { /* the last ones that have happened; the k-th of all is at k % KEPT_EVENTS */
    uint64_t count;
    double time[KEPT_EVENTS];
    int32_t index[KEPT_EVENTS];
};

struct workspace {
    double factors[ROOM(NFACTORS)];   /* of the matrix of a step, or if it is `pivoted`: */
    double matrix[ROOM(N) * ROOM(N)]; /* row-major */
    int pivot[ROOM(N)], pivoted;
    double jacobian[ROOM(NZ) * ROOM(NZ)]; /* dalg/dz, while newton.c works with another matrix */
    double f[ROOM(N)], ft[ROOM(N)], stage[6][ROOM(N)], right[ROOM(N)], trial[ROOM(N)], error[ROOM(N)];
    double rate[ROOM(N)], misfit[ROOM(N)], size[ROOM(N)], u[ROOM(NU)];
    double left, left_y[ROOM(N)], left_u[2 * ROOM(NU)]; /* time, state and inputs of a point that has been left for a while */
    double k[ROOM(N)], sum[ROOM(N)];                    /* of explicit.c */
    double indicator[ROOM(NE)], due[ROOM(NE)], after[NX + ROOM(NM)]; /* of events.c */
    double second[ROOM(N)], third[ROOM(N)], between[ROOM(N)], course[5][ROOM(NE)]; /* within a step, of integrate.c */
    double nonzeros[ROOM(NNZ)], nonzeros_alg[ROOM(NNZ_ALG)];
    double dy[ROOM(N)], du[ROOM(NU)], dp[ROOM(NP)], df[ROOM(N)], doutput[ROOM(NY)]; /* a direction, and derivatives along it */
    const double *argument[WORK_ARG];
    double *result[WORK_RES];
    double w[WORK_REAL];
    int iw[WORK_INT];
};

struct rows { /* values[count][outputs] that are wanted at times, not falling; the first `done` rows are there */
    size_t count, done, outputs;
    const double *time;
    const uint32_t *reference;
    double *value;
};

#define LOOKUP_SIZE 64
struct lookup { /* the value references of the last call, resolved: a master asks for the same ones at each step */
    size_t count;
    uint32_t kinds;
    uint32_t reference[LOOKUP_SIZE];
    double *value[LOOKUP_SIZE];
};

struct instance {
    struct state state;
    double derivative[ROOM(N)], output[ROOM(NY)], observable[ROOM(NW)], indicator[ROOM(NE)];
    uint32_t fresh; /* bit per kind: which of the above belong to `state` */
    double *base[KINDS];
    struct lookup get, set;
    struct statistics statistics;
    struct events events;
    int explicit_order; /* 0: implicit, as the settings say; 1: Euler; 4: Runge-Kutta */
    double explicit_step;
    struct workspace work;
    char *name;
    void (*logger)(void); /* what the environment gave us, as fmi2.c knows it */
    void *environment;
    char message[768]; /* why the last call failed */
};

INSIDE_BEGIN
/* instance.c */
struct instance *instance_new(const char *name, int exchange);
void instance_free(struct instance *m);
void instance_reset(struct instance *m);
int instance_accepts(struct instance *m, const struct state *saved);
int instance_restore(struct instance *m, const struct state *saved);
void changed(struct instance *m);
void leave_point(struct instance *m);
void return_to_point(struct instance *m);
int fail(struct instance *m, const char *format, ...); /* records the message; returns 1 */

/* evaluate.c */
const double *inputs_at(struct instance *m, double t);
void move_to(struct instance *m, double t);
void evaluate_residual(struct instance *m, double t, const double *y, double *f);
void evaluate_jacobian(struct instance *m, double t, const double *y);
void evaluate_algebraic(struct instance *m, double t, const double *y, double *alg, double *matrix);
int evaluate_directional(struct instance *m, double dt);
void evaluate_indicators(struct instance *m, double t, const double *y, double *indicator);
void evaluate_reset(struct instance *m, const double *due, double *after);
int refresh(struct instance *m, uint32_t kinds);

/* linear.c */
int lu_factor(int n, double *a, int *pivot);
void lu_solve(int n, const double *a, const int *pivot, double *b);
int matrix_factor(struct instance *m, double s, const double *b, double *x);
void matrix_solve(struct instance *m, const double *b, double *x);

/* newton.c, integrate.c */
int solve_algebraic(struct instance *m);
int integrate(struct instance *m, double end, struct rows *rows);
void advance_to(struct instance *m, double t);

/* explicit.c */
int integrate_explicitly(struct instance *m, double end);

/* events.c */
typedef int attempt(struct instance *m, double h); /* a step of size h from the present point into work.trial */
#define MARGIN 1e-12 /* by which an indicator must rise above zero, so that it is not at zero after its event */
double margin(const struct instance *m, int event);
int shorten_to_event(struct instance *m, attempt *step, double *h);
int settle(struct instance *m);
int due_at(struct instance *m, double t, const double *y);

/* values.c */
const struct variable *find_variable(uint32_t reference);
int get_values(struct instance *m, const uint32_t *reference, size_t count, double *value);
int set_values(struct instance *m, const uint32_t *reference, size_t count, const double *value);
int set_slopes(struct instance *m, const uint32_t *reference, size_t count, const int32_t *order, const double *value);
void end_ramps(struct instance *m);
int record(struct instance *m, struct rows *rows);
INSIDE_END

#endif
