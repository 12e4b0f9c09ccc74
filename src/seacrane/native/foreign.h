/* An FMU run by an importer: what `foreign.c`, its interface, and `foreign_solver.c`, its solver, share. */
#ifndef SEACRANE_FOREIGN_H
#define SEACRANE_FOREIGN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "rodas.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define MOST_STEPS 1000000 /* in one call; beyond it the model is chattering, and a run would seem to hang */

enum { OK, WARNING, DISCARD, ERROR };
enum { EVENT, RUNNING };

typedef int (*set2_t)(void *, const uint32_t *, size_t, const double *);
typedef int (*get2_t)(void *, const uint32_t *, size_t, double *);
typedef int (*set3_t)(void *, const uint32_t *, size_t, const double *, size_t);
typedef int (*get3_t)(void *, const uint32_t *, size_t, double *, size_t);
typedef int (*do_step3_t)(void *, double, double, bool, bool *, bool *, bool *, double *);
typedef int (*plain_t)(void *);
typedef int (*time_t_)(void *, double);
typedef int (*give_t)(void *, const double *, size_t);
typedef int (*take_t)(void *, double *, size_t);
typedef int (*completed2_t)(void *, int, int *, int *);
typedef int (*completed3_t)(void *, bool, bool *, bool *);
typedef struct {
    int update, terminate, nominals, values, defined;
    double next;
} event_info_t;
typedef int (*update2_t)(void *, event_info_t *);
typedef int (*update3_t)(void *, bool *, bool *, bool *, bool *, bool *, double *);
typedef int (*directional2_t)(void *, const uint32_t *, size_t, const uint32_t *, size_t, const double *, double *);
typedef int (*directional3_t)(void *, const uint32_t *, size_t, const uint32_t *, size_t, const double *, size_t,
                              double *, size_t);

typedef struct {
    /* given by the importer */
    void *fmu;
    void *set, *get, *do_step, *enter_event, *update, *resume; /* resume: to step or continuous-time mode */
    void *set_time, *set_states, *get_states, *derivatives, *indicators, *completed, *nominals, *directional;
    const uint32_t *state_references, *derivative_references;
    double *memory, *ramp; /* ramp: values at the beginning of the step, slopes and present values of the inputs */
    const uint32_t *input_references; /* of the continuous inputs */
    int64_t inputs, version, exchange, event_mode, discrete_inputs, n, m; /* n states, m event indicators */
    double tolerance;
    /* how far the run is; saved and restored with the FMU's own state */
    double time, next_event, next_step, ramp_start;
    int64_t ramping, mode, event_known, steps, rejected, events, jacobians;
    char message[256];
} foreign_t;

typedef struct {
    double *y, *trial, *f, *ft, *nominal, *error, *seed, *before, *after, *jacobian, *matrix, *stage[STAGES], *pivot;
} work_t;

work_t foreign_work(const foreign_t *s);
int foreign_failed(int status);
/* Leaves what went wrong in the message; gives the status. */
int foreign_said(foreign_t *s, int status, const char *what);
/* Event mode until the discrete states are settled; what the events changed is read anew. */
int foreign_settle(foreign_t *s);
/* Tells the FMU the time, and its inputs that vary within the step. */
int foreign_at(const foreign_t *s, double time);
/* Integrates an FMU for model exchange up to a time. */
int foreign_exchange(foreign_t *s, double end);

#endif
