/* Explicit methods of fixed step, for comparison with what the field has used: the step must resolve the fastest rate
   of the model, whether anything moves at that rate or not.

   Euler's method, and the classical Runge-Kutta method of order 4 (Hairer, Norsett & Wanner, Solving Ordinary
   Differential Equations I, section II.1). Algebraic unknowns are solved for at every stage. */
#include "core.h"

#include <math.h>
#include <string.h>

/* Moves time to t, taking the inputs along. */
static void move(struct instance *m, double t)
{
    struct state *s = &m->state;
    if (s->sloped)
        for (int i = 0; i < NU; i++)
            s->u[i] += s->slope[i] * (t - s->time);
    s->time = t;
}

/* The states become `start` + h k, at time t. */
static void go(struct instance *m, double t, const double *start, double h, const double *k)
{
    for (int i = 0; i < NX; i++)
        m->state.y[i] = start[i] + h * k[i];
    move(m, t);
    changed(m);
}

/* f into k where we are, once the algebraic unknowns are those of the states. */
static int slopes(struct instance *m, double *k)
{
    if (!m->state.consistent && solve_algebraic(m) != 0)
        return 1;
    evaluate_residual(m, m->state.time, m->state.y, k);
    return 0;
}

static int euler(struct instance *m, double h, const double *start, double *k)
{
    if (slopes(m, k) != 0)
        return 1;
    go(m, m->state.time + h, start, h, k);
    return 0;
}

static int runge_kutta(struct instance *m, double h, const double *start, double *k, double *sum)
{
    static const double reach[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
    double t = m->state.time;
    memset(sum, 0, NX * sizeof(double));
    for (int j = 0; j < 4; j++) {
        if (j > 0)
            go(m, t + reach[j] * h, start, reach[j] * h, k);
        if (slopes(m, k) != 0)
            return 1;
        for (int i = 0; i < NX; i++)
            sum[i] += weight[j] / 6 * k[i];
    }
    go(m, t + h, start, h, sum);
    return 0;
}

static const char *first_not_finite(const struct instance *m)
{
    for (int i = 0; i < NX; i++)
        if (!isfinite(m->state.y[i]))
            for (int j = 0; j < NVARIABLES; j++)
                if (model_variables[j].kind == STATE && model_variables[j].index == i)
                    return model_variables[j].name;
    return NULL;
}

/* From the present time to `end` in equal steps not longer than asked; on failure at the last good point. */
int integrate_explicitly(struct instance *m, double end)
{
    struct state *s = &m->state;
    double *start = m->work.stage[3], *k = m->work.stage[4], *sum = m->work.stage[5]; /* solve_algebraic has the others */
    double from = s->time, count = fmax(1, ceil((end - from) / m->explicit_step - 1e-6));
    for (double i = 1; i <= count; i++) {
        double before = s->time, h = (i < count ? from + i * ((end - from) / count) : end) - before;
        memcpy(start, s->y, N * sizeof(double));
        int failed = m->explicit_order == 1 ? euler(m, h, start, k) : runge_kutta(m, h, start, k, sum);
        const char *culprit = first_not_finite(m);
        if (culprit != NULL)
            failed = fail(m, "%s is not finite after the step of %.3g s from t = %.9g s: too long a step for an explicit "
                             "method", culprit, h, before);
        if (failed) {
            memcpy(s->y, start, N * sizeof(double));
            move(m, before);
            changed(m);
            return 1;
        }
        if (i == count)
            s->time = end;
        m->statistics.steps++;
    }
    return 0;
}
