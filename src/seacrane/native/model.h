/* What the generated part of a model provides: its sizes, its tables and its equations.

   y = [x; z] holds the states and the algebraic unknowns, f = [ode; alg]:

       dx/dt = ode(t, y, u, p),   0 = alg(t, y, u, p)

   p holds the parameters, then the modes: numbers that only events change.

   "model_size.h", "model_guid.h" and the definitions of the tables are written by seacrane.model.codegen, the functions by
   CasADi. */
#ifndef SEACRANE_MODEL_H
#define SEACRANE_MODEL_H

#include <stdint.h>

#include "model_size.h" /* NX, NZ, NU, NP, NM, NE, NY, NW, NNZ, NNZ_ALG, NFACTORS, WORK_... */

/* However the sources are compiled, what they share stays inside: names such as `step` are in the C library too, and on
   Linux would be taken from there. */
#if defined __GNUC__ && !defined _WIN32
#define INSIDE_BEGIN _Pragma("GCC visibility push(hidden)")
#define INSIDE_END _Pragma("GCC visibility pop")
#else
#define INSIDE_BEGIN
#define INSIDE_END
#endif

#define N (NX + NZ)
#define ROOM(n) ((n) > 0 ? (n) : 1) /* C has no arrays of length zero */

enum kind { STATE, DERIVATIVE, ALGEBRAIC, INPUT, PARAMETER, MODE, SETTING, OUTPUT, OBSERVABLE, INDICATOR, TIME, KINDS };
enum setting { TOLERANCE, FIXED_STEP, NSETTINGS };
#define NVARIABLES (2 * NX + NZ + NU + NP + NM + NSETTINGS + NY + NW + NE + 1)

struct variable {
    uint32_t reference; /* FMI value reference; the table is sorted by it */
    uint16_t kind, index;
    const char *name, *unit;
};

INSIDE_BEGIN
extern const struct variable model_variables[NVARIABLES];
extern const double model_start_y[ROOM(N)], model_nominal_y[ROOM(N)];
extern const double model_start_u[ROOM(NU)];
extern const double model_start_m[ROOM(NM)];
extern const double model_start_p[ROOM(NP)], model_minimum_p[ROOM(NP)], model_maximum_p[ROOM(NP)];
extern const int model_row[ROOM(NNZ)], model_column[ROOM(NNZ)];                 /* pattern of df/dy */
extern const int model_row_alg[ROOM(NNZ_ALG)], model_column_alg[ROOM(NNZ_ALG)]; /* pattern of dalg/dz */
extern const char *const model_event[ROOM(NE)]; /* names */
extern const unsigned char model_hash[16];

/* CasADi's calling convention: arrays of pointers to arguments and results, work arrays, a memory index (unused). */
typedef int model_function(const double **argument, double **result, int *iw, double *w, int memory);
model_function model_residual;    /* t y u p          -> f */
model_function model_jacobian;    /* t y u p          -> f, nonzeros of df/dy, df/dt */
model_function model_factor;      /* nonzeros s       -> factors of s M - df/dy, M = diag(1 for states, 0 for the others) */
model_function model_solve;       /* factors b        -> x with (s M - df/dy) x = b */
model_function model_algebraic;   /* t y u p          -> alg, nonzeros of dalg/dz */
model_function model_input_rate;  /* t y u p du/dt    -> df/du du/dt */
model_function model_output;      /* t y u p          -> outputs */
model_function model_observe;     /* t y u p          -> observables */
model_function model_directional; /* t y u p dt dy du dp -> df, d outputs */
model_function model_indicate;    /* t y u p          -> an indicator of each event, above zero once it has happened */
model_function model_reset;       /* t y u p which    -> states and modes after those events whose `which` is not zero */
INSIDE_END

#endif
