/* The algebraic unknowns at the present time, states and inputs.

   Damped Newton with the natural monotonicity test (Deuflhard, Newton Methods for Nonlinear Problems, section 3.3):
   a step is accepted if the next, simplified Newton correction is smaller. Corrections are measured relative to
   magnitude and nominal value, which makes the test independent of how the equations are scaled. */
#include "core.h"

#include <math.h>
#include <string.h>

#define LARGEST_COUNT 50
#define ENOUGH 1e-10        /* relative size of the last correction */
#define LEAST_DAMPING 1e-5

static double size_of(const double *dz, const double *z)
{
    double sum = 0;
    for (int i = 0; i < NZ; i++) {
        double relative = dz[i] / (fabs(z[i]) + model_nominal_y[NX + i]);
        sum += relative * relative;
    }
    return sqrt(sum / ROOM(NZ));
}

static const char *worst(const double *dz, const double *z)
{
    int index = 0;
    double largest = -1;
    for (int i = 0; i < NZ; i++) {
        double size = fabs(dz[i]) / (fabs(z[i]) + model_nominal_y[NX + i]);
        if (!(size <= largest)) {
            largest = size;
            index = i;
            if (!isfinite(size))
                break;
        }
    }
    for (int i = 0; i < NVARIABLES; i++)
        if (model_variables[i].kind == ALGEBRAIC && model_variables[i].index == index)
            return model_variables[i].name;
    return "";
}

/* Solves for z in place; on failure z is left as it was. */
int solve_algebraic(struct instance *m)
{
    struct state *s = &m->state;
    struct workspace *w = &m->work;
    double *y = w->trial, *z = y + NX, *dz = w->stage[0], *next = w->stage[1], *from = w->stage[2];
    memcpy(y, s->y, N * sizeof(double));
    for (int count = 0; count < LARGEST_COUNT; count++) {
        evaluate_algebraic(m, s->time, y, dz, w->matrix);
        if (lu_factor(NZ, w->matrix, w->pivot) != 0)
            return fail(m, "the algebraic equations are singular or not finite at t = %.9g s, near %s", s->time,
                        worst(dz, z));
        for (int i = 0; i < NZ; i++)
            dz[i] = -dz[i];
        lu_solve(NZ, w->matrix, w->pivot, dz);
        double size = size_of(dz, z), damping = 1;
        memcpy(from, z, NZ * sizeof(double));
        if (!isfinite(size))
            return fail(m, "the algebraic equations give no finite value at t = %.9g s; worst is %s", s->time,
                        worst(dz, z));
        for (;;) {
            for (int i = 0; i < NZ; i++)
                z[i] = from[i] + damping * dz[i];
            if (size <= ENOUGH) {
                memcpy(s->y + NX, z, NZ * sizeof(double));
                s->consistent = 1;
                m->fresh = 0;
                return 0;
            }
            evaluate_algebraic(m, s->time, y, next, NULL);
            for (int i = 0; i < NZ; i++)
                next[i] = -next[i];
            lu_solve(NZ, w->matrix, w->pivot, next);
            if (size_of(next, from) <= (1 - damping / 4) * size)
                break;
            damping /= 2;
            if (damping < LEAST_DAMPING)
                return fail(m, "the algebraic equations have no solution near the last one at t = %.9g s; worst is %s",
                            s->time, worst(dz, from));
        }
    }
    return fail(m, "the algebraic equations were not solved in %d iterations at t = %.9g s; worst is %s", LARGEST_COUNT,
                s->time, worst(dz, z));
}
