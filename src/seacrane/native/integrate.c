/* Integration of the index-1 DAE  M y' = f(t, y),  M = diag(1 for states, 0 for algebraic unknowns).

   Adaptive: RODAS (rodas.h), for which one linear system with one matrix per step is all that it costs to be implicit.
   Fixed step: the linearly implicit Euler method, order 1, for a bounded cost per step. */
#include "core.h"
#include "rodas.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define BENT 0.01  /* of an indicator between points of its course, against the cubic through them */
#define SHORT 1e-4 /* [s]; within this time an indicator may jump */
#define MOST_STEPS 1000000 /* in one call, or from row to row; beyond it the model chatters, and a run would seem to hang */

static const char *name_of(int index)
{
    int kind = index < NX ? STATE : ALGEBRAIC;
    for (int i = 0; i < NVARIABLES; i++)
        if (model_variables[i].kind == kind && model_variables[i].index == (kind == STATE ? index : index - NX))
            return model_variables[i].name;
    return "";
}

/* Factors s M - df/dy and solves with it for the first time; 1 if it is singular, which the message tells. */
static int factor(struct instance *m, double s, const double *b, double *x)
{
    int lost = matrix_factor(m, s, b, x);
    return lost > 0 && fail(m, "the matrix of the solver is singular at t = %.9g s: nothing determines %s", m->state.time,
                            name_of(lost - 1));
}

/* to = base, with the sum of weight[j] stage[j] over the first `count` stages added in the first n components. */
static void combine(const struct workspace *w, const double *base, int n, int count, const double *weight,
                    double *restrict to)
{
    memcpy(to, base, N * sizeof(double));
    for (int j = 0; j < count; j++)
        for (int i = 0; i < n; i++)
            to[i] += weight[j] * w->stage[j][i];
}

/* One step with the Jacobian in the workspace; new values into `trial`, estimated error into `error`. */
static int rodas_step(struct instance *m, double h)
{
    struct workspace *w = &m->work;
    const double *y = m->state.y, t = m->state.time;
    for (int i = 0; i < N; i++)
        w->right[i] = w->f[i] + h * DELTA[0] * w->ft[i];
    if (factor(m, 1 / (h * GAMMA), w->right, w->stage[0]) != 0)
        return 1;
    for (int stage = 1; stage < STAGES; stage++) {
        double weight[STAGES - 1];
        for (int j = 0; j < stage; j++)
            weight[j] = C[stage][j] / h;
        combine(w, y, N, stage, A[stage], w->trial);
        evaluate_residual(m, t + ALPHA[stage] * h, w->trial, w->error);
        for (int i = 0; i < N; i++)
            w->error[i] += h * DELTA[stage] * w->ft[i];
        combine(w, w->error, NX, stage, weight, w->right);
        matrix_solve(m, w->right, w->stage[stage]);
    }
    for (int i = 0; i < N; i++) {
        w->error[i] = w->stage[STAGES - 1][i];
        w->trial[i] += w->error[i];
    }
    return 0;
}

/* Makes ready for `within` a step that has been tried. */
static void bend(struct instance *m)
{
    struct workspace *w = &m->work;
    memset(w->second, 0, N * sizeof(double));
    memset(w->third, 0, N * sizeof(double));
    for (int j = 0; j < STAGES - 1; j++)
        for (int i = 0; i < N; i++) {
            w->second[i] += DENSE[0][j] * w->stage[j][i];
            w->third[i] += DENSE[1][j] * w->stage[j][i];
        }
}

/* The solution at a share of that step, to third order. */
static const double *within(struct instance *m, double share)
{
    struct workspace *w = &m->work;
    double rest = 1 - share;
    for (int i = 0; i < N; i++)
        w->between[i] = rest * m->state.y[i] + share * (w->trial[i] + rest * (w->second[i] + share * w->third[i]));
    return w->between;
}

#define POINTS 5
static const double POINT[POINTS] = {0, 0.171, 0.437, 0.729, 1}; /* not evenly spaced, lest an oscillation is not seen */

/* The value at `share` of the step of the polynomial through the course of an indicator, of all points but one. */
static double interpolated(struct instance *m, int event, double share, int without)
{
    double sum = 0;
    for (int i = 0; i < POINTS; i++) {
        double weight = i != without;
        for (int j = 0; j < POINTS; j++)
            if (j != i && j != without)
                weight *= (share - POINT[j]) / (POINT[i] - POINT[j]);
        sum += weight * m->work.course[i][event];
    }
    return sum;
}

/* How much of the step that has been tried should be taken so that no event passes unseen: all of it, the share at which
   an indicator is seen to have risen above zero, or fallen from there, as it may not be at the end, or nothing if the
   course of an indicator cannot be told from a few points of it. */
static double share_to_take(struct instance *m, double h)
{
    struct workspace *w = &m->work;
    const struct state *s = &m->state;
    bend(m);
    for (int k = 0; k < POINTS; k++) {
        const double *y = k == 0 ? s->y : k == POINTS - 1 ? w->trial : within(m, POINT[k]);
        evaluate_indicators(m, s->time + POINT[k] * h, y, w->course[k]);
    }
    for (int i = 0; i < NE; i++)
        for (int k = 1; k < POINTS - 1 && h > SHORT; k++)
            if (fabs(interpolated(m, i, POINT[k], k) - w->course[k][i]) > BENT)
                return 0;
    for (int k = 1; k < POINTS - 1; k++)
        for (int i = 0; i < NE; i++)
            if (s->above[i] ? !(w->course[k][i] > 0) : w->course[k][i] > MARGIN)
                return POINT[k];
    for (int i = 0; i < NE; i++)
        for (double share = 0.05; share < 1 && !s->above[i]; share += 0.05)
            if (interpolated(m, i, share, -1) > 0 && due_at(m, s->time + share * h, within(m, share)))
                return share;
    return 1;
}

static double tolerated(const struct instance *m, int i)
{
    double before = fabs(m->state.y[i]), after = fabs(m->work.trial[i]);
    return m->state.setting[TOLERANCE] * (model_nominal_y[i] + (after > before ? after : before));
}

/* Root mean square of the error relative to what is tolerated; infinite if anything is not finite. */
static double error_norm(const struct instance *m)
{
    double sum = 0;
    for (int i = 0; i < N; i++) {
        double relative = m->work.error[i] / tolerated(m, i);
        sum += relative * relative + 0 * m->work.trial[i]; /* which is no number if the value is not finite */
    }
    return isfinite(sum) ? sqrt(sum / ROOM(N)) : HUGE_VAL;
}

/* The error of the solution within the step of size h that has been tried, where it is looked at: its defect there, as far
   as it matters to the unknowns. Quantities that follow from others without delay are right at the end of a step of any
   size; it is only here that the error of what lies between them shows. */
static double error_within(struct instance *m, double h)
{
    struct workspace *w = &m->work;
    const double share = 0.4;
    bend(m);
    evaluate_residual(m, m->state.time + share * h, within(m, share), w->right);
    for (int i = 0; i < NX; i++)
        w->right[i] -= (w->trial[i] - m->state.y[i] + (1 - 2 * share) * w->second[i]
                        + share * (2 - 3 * share) * w->third[i]) / h;
    matrix_solve(m, w->right, w->error);
    return error_norm(m);
}

/* The component whose error is the largest, or the first one that is not finite. */
static int culprit_of(const struct instance *m)
{
    int culprit = 0;
    double largest = -1;
    for (int i = 0; i < N; i++) {
        double relative = fabs(m->work.error[i]) / tolerated(m, i);
        if (!isfinite(relative) || !isfinite(m->work.trial[i]))
            return i;
        if (relative > largest) {
            largest = relative;
            culprit = i;
        }
    }
    return culprit;
}

/* The first component of f that is not a finite number, or -1. */
static int first_not_finite(const double *f)
{
    for (int i = 0; i < N; i++)
        if (!isfinite(f[i]))
            return i;
    return -1;
}

/* Moves time on to t, taking the inputs along, and makes the trial values the present ones. */
void advance_to(struct instance *m, double t)
{
    move_to(m, t);
    memcpy(m->state.y, m->work.trial, N * sizeof(double));
    m->fresh = 0;
    m->statistics.steps++;
}

/* Records the rows before time t, which lie within the step of size h that has been found good. Steps are counted from the
   last row on. */
static int record_within(struct instance *m, double h, double t, struct rows *rows, int *count)
{
    for (; rows->done < rows->count && rows->time[rows->done] < t; *count = 0) {
        double at = rows->time[rows->done];
        leave_point(m);
        memcpy(m->state.y, within(m, (at - m->state.time) / h), N * sizeof(double));
        move_to(m, at);
        int failed = record(m, rows);
        return_to_point(m);
        if (failed)
            return 1;
    }
    return 0;
}

/* Gives the rows on its way, if there are any. */
static int adaptive(struct instance *m, double end, struct rows *rows)
{
    struct state *s = &m->state;
    double least = fmax(1e-14, 16 * DBL_EPSILON * fmax(fabs(s->time), fabs(end)));
    int known = 0, rejected = 0, event = 0;
    for (int count = 0; s->time < end; count++) {
        double left = end - s->time, h = s->next_step, scale;
        int last = 1.01 * h >= left;
        if (last)
            h = left;
        else if (2 * h > left)
            h = left / 2; /* two equal steps rather than one long and one sliver */
        if (!known) {
            evaluate_jacobian(m, s->time, s->y);
            int first = first_not_finite(m->work.f);
            if (first >= 0)
                return fail(m, "the equations give no finite value at t = %.9g s; first is the one of %s", s->time,
                            name_of(first));
            known = 1;
        }
        int singular = rodas_step(m, h);
        double error = singular ? HUGE_VAL : error_norm(m), next = last ? end : s->time + h;
        if (error <= 1 && rows != NULL && rows->time[rows->done] < next)
            error = fmax(error, error_within(m, h));
        if (error <= 1) {
            scale = fmin(rejected ? 1 : NE > 0 ? 2 : 5, growth(fmax(error, 1e-10)));
            double share = NE > 0 ? share_to_take(m, h) : 1;
            if (share == 0) {
                s->next_step = h / 2;
                rejected = 1;
                m->statistics.rejected++;
                continue;
            }
            s->next_step = last ? fmax(s->next_step, h * scale) : h * scale;
            if (NE > 0) {
                double whole = h;
                last &= share == 1;
                h *= share;
                if ((share < 1 && rodas_step(m, h) != 0) || (event = shorten_to_event(m, rodas_step, &h)) < 0)
                    return 1;
                if (h < whole)
                    s->next_step = fmin(s->next_step, whole);
            }
            if (rows != NULL && record_within(m, h, next, rows, &count) != 0)
                return 1;
            advance_to(m, last && !event ? end : s->time + h);
            known = rejected = 0;
            if (event && settle(m) != 0)
                return 1;
        } else {
            scale = error < HUGE_VAL ? fmax(0.1, growth(error)) : 0.1;
            s->next_step = h * scale;
            rejected = 1;
            m->statistics.rejected++;
            if (s->next_step < least)
                return singular ? 1
                                : fail(m,
                                       "the step size fell below %.3g s at t = %.9g s; %s could not be integrated to "
                                       "the tolerance %.3g",
                                       least, s->time, name_of(culprit_of(m)), s->setting[TOLERANCE]);
        }
        if (count == MOST_STEPS)
            return fail(m, "%d steps did not reach t = %.9g s; at t = %.9g s the step size is %.3g s, limited by %s",
                        MOST_STEPS, end, s->time, h, name_of(culprit_of(m)));
    }
    return 0;
}

/* One step of the linearly implicit Euler method with the Jacobian in the workspace. */
static int euler_step(struct instance *m, double h)
{
    struct workspace *w = &m->work;
    double t = m->state.time;
    for (int j = 0; j < N; j++)
        w->right[j] = w->f[j] + h * w->ft[j];
    if (factor(m, 1 / h, w->right, w->trial) != 0)
        return 1;
    for (int j = 0; j < N; j++)
        w->trial[j] += m->state.y[j];
    int culprit = first_not_finite(w->trial);
    return culprit < 0 ? 0 : fail(m, "%s is not finite after the step of %.3g s from t = %.9g s", name_of(culprit), h, t);
}

static int fixed(struct instance *m, double end)
{
    struct state *s = &m->state;
    double start = s->time, count = fmax(1, ceil((end - start) / s->setting[FIXED_STEP] - 1e-6));
    for (double i = 1; i <= count;) {
        double next = i < count ? start + i * ((end - start) / count) : end, h = next - s->time;
        evaluate_jacobian(m, s->time, s->y);
        if (euler_step(m, h) != 0)
            return 1;
        int event = NE > 0 ? shorten_to_event(m, euler_step, &h) : 0;
        if (event < 0)
            return 1;
        advance_to(m, event ? s->time + h : next);
        if (event && settle(m) != 0)
            return 1;
        i += s->time >= next;
    }
    return 0;
}

/* From the present time to `end`; on failure the instance stays at the last good point. If `rows` are wanted (the next of
   them in the future), those before the end are recorded where their values within steps are known. Otherwise the end is
   the first of them: so it is with other methods than RODAS, and if there are events, lest one is over before the next step
   begins. */
int integrate(struct instance *m, double end, struct rows *rows)
{
    int adapts = m->explicit_order == 0 && m->state.setting[FIXED_STEP] == 0;
    if (rows != NULL && (!adapts || NE > 0 || N == 0)) {
        end = fmin(end, rows->time[rows->done]);
        rows = NULL;
    }
    if (NE > 0 ? settle(m) : !m->state.consistent && solve_algebraic(m) != 0) /* inputs may have jumped */
        return 1;
    if (N == 0 && NE == 0) {
        advance_to(m, end);
        return 0;
    }
    if (adapts)
        return adaptive(m, end, rows);
    return m->explicit_order > 0 ? integrate_explicitly(m, end) : fixed(m, end);
}
