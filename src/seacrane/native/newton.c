/* The algebraic unknowns at the present time, states and inputs.

   Damped Newton with the natural monotonicity test (Deuflhard, Newton Methods for Nonlinear Problems, section 3.3):
   a step is accepted if the next, simplified Newton correction is smaller. Corrections are measured relative to
   magnitude and nominal value, which makes the test independent of how the equations are scaled.

   Where Newton finds no way, pseudo-transient continuation brings z nearer first: (1/delta + J'J) dz = -J'g, the flow
   that descends |g|, with z in nominal values and g in rows scaled by the Jacobian at the start; delta grows as |g| falls
   (Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998). It needs no equations written with the right sign. */
#include "core.h"

#include <math.h>
#include <string.h>

#define LARGEST_COUNT 50
#define ENOUGH 1e-10        /* relative size of the last correction */
#define LEAST_DAMPING 1e-5
#define MOST_STEPS 200      /* in pseudo-time */
#define NEAR 1e-3           /* relative size of a step in pseudo-time from which Newton takes over */
#define LEAST_DELTA 1e-30

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

/* From y in the workspace; on failure the state is left as it was. */
static int newton(struct instance *m)
{
    struct state *s = &m->state;
    struct workspace *w = &m->work;
    double *y = w->trial, *z = y + NX, *dz = w->stage[0], *next = w->stage[1], *from = w->stage[2];
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

/* |g| in scaled rows. */
static double norm_of(const double *g, const double *weight)
{
    double sum = 0;
    for (int i = 0; i < NZ; i++)
        sum += weight[i] * g[i] * (weight[i] * g[i]);
    return sqrt(sum);
}

/* One step into w->stage[5], from the Jacobian in w->jacobian; 1 if there is none. */
static int step_in_pseudo_time(struct instance *m, const double *g, const double *weight, double delta)
{
    struct workspace *w = &m->work;
    const double *j = w->jacobian, *nominal = model_nominal_y + NX;
    double *step = w->stage[5];
    for (int a = 0; a < NZ; a++) {
        step[a] = 0;
        for (int b = 0; b < NZ; b++)
            w->matrix[a * NZ + b] = a == b ? 1 / delta : 0;
    }
    for (int i = 0; i < NZ; i++)
        for (int a = 0; a < NZ; a++) {
            double left = weight[i] * j[i * NZ + a] * nominal[a];
            if (left == 0)
                continue;
            step[a] -= left * weight[i] * g[i];
            for (int b = 0; b < NZ; b++)
                w->matrix[a * NZ + b] += left * weight[i] * j[i * NZ + b] * nominal[b];
        }
    if (lu_factor(NZ, w->matrix, w->pivot) != 0)
        return 1;
    lu_solve(NZ, w->matrix, w->pivot, step);
    return 0;
}

/* Moves z in w->trial nearer to a solution; 1 if it gets nowhere. */
static int approach(struct instance *m)
{
    struct workspace *w = &m->work;
    const double *nominal = model_nominal_y + NX;
    double *z = w->trial + NX, *g = w->stage[0], *next = w->stage[1], *from = w->stage[2], *weight = w->stage[3];
    double delta = 1;
    evaluate_algebraic(m, m->state.time, w->trial, g, w->jacobian);
    for (int i = 0; i < NZ; i++) {
        double largest = 0;
        for (int k = 0; k < NZ; k++)
            largest = fmax(largest, fabs(w->jacobian[i * NZ + k]) * nominal[k]);
        weight[i] = largest > 0 ? 1 / largest : 1;
    }
    double size = norm_of(g, weight);
    if (!isfinite(size))
        return 1;
    for (int count = 0; count < MOST_STEPS && delta > LEAST_DELTA; count++) {
        if (step_in_pseudo_time(m, g, weight, delta) != 0)
            return 1;
        memcpy(from, z, NZ * sizeof(double));
        double change = 0;
        for (int i = 0; i < NZ; i++) {
            z[i] += nominal[i] * w->stage[5][i];
            change = fmax(change, fabs(w->stage[5][i]) / (1 + fabs(z[i]) / nominal[i]));
        }
        evaluate_algebraic(m, m->state.time, w->trial, next, NULL);
        double size_now = norm_of(next, weight);
        if (!(size_now <= size)) { /* not finite, or further away */
            memcpy(z, from, NZ * sizeof(double));
            delta /= 10;
            continue;
        }
        if (change <= NEAR && delta > 1e3)
            return 0;
        delta = fmin(delta * fmax(2, fmin(size / fmax(size_now, 1e-300), 1e4)), 1e12);
        size = size_now;
        evaluate_algebraic(m, m->state.time, w->trial, g, w->jacobian);
    }
    return 1;
}

/* Solves for z in place; on failure z is left as it was. */
int solve_algebraic(struct instance *m)
{
    memcpy(m->work.trial, m->state.y, N * sizeof(double));
    if (newton(m) == 0)
        return 0;
    memcpy(m->work.trial, m->state.y, N * sizeof(double));
    return approach(m) != 0 || newton(m) != 0; /* the message is that of Newton's last attempt */
}
