/* Explicit methods of fixed step, for comparison with what the field has used: the step must resolve the fastest rate
   of the model, whether anything moves at that rate or not.

   Euler's method, and the classical Runge-Kutta method of order 4 (Hairer, Norsett & Wanner, Solving Ordinary
   Differential Equations I, section II.1). Algebraic unknowns are solved for at every stage. */
#include "core.h"

#include <math.h>
#include <string.h>

/* The states become those at the start of the step + h k, at time t. */
static void go(struct instance *m, double t, double h, const double *k)
{
    for (int i = 0; i < NX; i++)
        m->state.y[i] = m->work.left_y[i] + h * k[i];
    move_to(m, t);
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

static int euler(struct instance *m, double h)
{
    if (slopes(m, m->work.k) != 0)
        return 1;
    go(m, m->state.time + h, h, m->work.k);
    return 0;
}

static int runge_kutta(struct instance *m, double h)
{
    static const double reach[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
    double t = m->state.time, *k = m->work.k, *sum = m->work.sum;
    memset(sum, 0, NX * sizeof(double));
    for (int j = 0; j < 4; j++) {
        if (j > 0)
            go(m, t + reach[j] * h, reach[j] * h, k);
        if (slopes(m, k) != 0)
            return 1;
        for (int i = 0; i < NX; i++)
            sum[i] += weight[j] / 6 * k[i];
    }
    go(m, t + h, h, sum);
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

/* The stages move the instance itself, which then goes back to where it was. */
static int explicit_step(struct instance *m, double h)
{
    struct state *s = &m->state;
    double before = s->time;
    if (!s->consistent && solve_algebraic(m) != 0)
        return 1;
    leave_point(m);
    int failed = m->explicit_order == 1 ? euler(m, h) : runge_kutta(m, h);
    const char *culprit = first_not_finite(m);
    if (culprit != NULL)
        failed = fail(m, "%s is not finite after the step of %.3g s from t = %.9g s: too long a step for an explicit "
                         "method", culprit, h, before);
    if (!failed && NE > 0) /* indicators may depend on algebraic unknowns */
        failed = solve_algebraic(m);
    memcpy(m->work.trial, s->y, N * sizeof(double));
    return_to_point(m);
    return failed;
}

/* From the present time to `end` in equal steps not longer than asked, but for events; on failure at the last good
   point. */
int integrate_explicitly(struct instance *m, double end)
{
    struct state *s = &m->state;
    double from = s->time, count = fmax(1, ceil((end - from) / m->explicit_step - 1e-6));
    for (double i = 1; i <= count;) {
        double next = i < count ? from + i * ((end - from) / count) : end, h = next - s->time;
        if (explicit_step(m, h) != 0)
            return 1;
        int event = NE > 0 ? shorten_to_event(m, explicit_step, &h) : 0;
        if (event < 0)
            return 1;
        advance_to(m, event ? s->time + h : next);
        s->consistent = NZ == 0 || NE > 0;
        if (event && settle(m) != 0)
            return 1;
        i += s->time >= next;
    }
    return 0;
}
