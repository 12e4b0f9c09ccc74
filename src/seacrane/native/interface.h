/* What FMI 2.0 and FMI 3.0 have in common: the order of calls, and one function for each service of an instance. The
   outcomes have the numbers of fmi2Status and fmi3Status; the reason of a failure is the instance's message. */
#ifndef SEACRANE_INTERFACE_H
#define SEACRANE_INTERFACE_H

#include "core.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum outcome { DONE = 0, DISCARDED = 2, FAILED = 3 };

#define WHEN(phase) (1u << (phase))
#define EXCHANGING (WHEN(EVENT) | WHEN(CONTINUOUS))
#define KNOWN (WHEN(INITIALIZING) | WHEN(STEPPING) | EXCHANGING) /* when results can be had */

INSIDE_BEGIN
int misplaced(struct instance *m, const char *function, unsigned phases);
const char *refusal(const char *name, const char *identity);

int begin(struct instance *m, const char *function, int has_tolerance, double tolerance, double start);
int move_on(struct instance *m, const char *function, unsigned from, enum phase to);
int exit_initialization(struct instance *m, const char *function);
int assign(struct instance *m, const char *function, const uint32_t *reference, size_t count, const double *value);
int step(struct instance *m, const char *function, double from, double size);

int save_state(struct instance *m, void **saved);
int restore_state(struct instance *m, const void *saved);
int serialize(struct instance *m, const void *saved, void *bytes, size_t size);
int deserialize(struct instance *m, const void *bytes, size_t size, void **saved);

int directional(struct instance *m, const char *function, const uint32_t *unknown, size_t unknowns,
                const uint32_t *known, size_t knowns, const double *seed, double *sensitivity);
int adjoint(struct instance *m, const char *function, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
            size_t knowns, const double *seed, double *sensitivity);
int output_derivatives(struct instance *m, const char *function, const uint32_t *reference, size_t count,
                       const int32_t *order, double *value);

int input_derivatives(struct instance *m, const char *function, const uint32_t *reference, size_t count,
                      const int32_t *order, const double *value);

int update_discrete_states(struct instance *m, const char *function, int *happened);
int get_indicators(struct instance *m, const char *function, double *indicator, size_t count);
int set_time(struct instance *m, const char *function, double time);
int set_states(struct instance *m, const char *function, const double *x, size_t count);
int get_states(struct instance *m, const char *function, double *x, size_t count);
int get_nominals(struct instance *m, double *nominal, size_t count);
int get_derivatives(struct instance *m, const char *function, double *derivative, size_t count);
INSIDE_END

#endif
