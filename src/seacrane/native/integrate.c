/* Integration of the index-1 DAE  M y' = f(t, y),  M = diag(1 for states, 0 for algebraic unknowns).

   Adaptive: RODAS, a Rosenbrock method of order 4 with an embedded error estimate of order 3, L-stable and stiffly
   accurate, so that one linear system with one matrix per step is all that it costs to be implicit
   (Hairer & Wanner, Solving Ordinary Differential Equations II, section IV.7 and VI.4; coefficients of table 4.2 and
   their program RODAS, in the transformed form (7.25) that needs no products with the Jacobian).
   Fixed step: the linearly implicit Euler method, order 1, for a bounded cost per step. */
#include "core.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define STAGES 6
#define GAMMA 0.25
#define BENT 0.01  /* of an indicator between points of its course, against the cubic through them */
#define SHORT 1e-4 /* [s]; within this time an indicator may jump */
#define MOST_STEPS 1000000 /* in one call; beyond it the model is chattering, and a run would seem to hang */

static const double A[STAGES][STAGES - 1] = {
    {0},
    {1.544000000000000},
    {0.9466785280815826, 0.2557011698983284},
    {3.314825187068521, 2.896124015972201, 0.9986419139977817},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1},
};
static const double C[STAGES][STAGES - 1] = {
    {0},
    {-5.668800000000000},
    {-2.430093356833875, -0.2063599157091915},
    {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
    {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
    {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054},
};
static const double ALPHA[STAGES] = {0, 0.386, 0.21, 0.63, 1, 1};
static const double DENSE[2][STAGES - 1] = {
    {10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662},
    {-0.6762803392806887, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872},
};
static const double DELTA[STAGES] = {0.25, -0.1043, 0.1035, -0.0362000000000023, 0, 0};

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
static void combine(const struct workspace *w, const double *base, int n, int count, const double *weight, double *to)
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

/* The solution at a share of the step that has been tried, to third order. */
static const double *within(struct instance *m, double share)
{
    struct workspace *w = &m->work;
    double rest = 1 - share;
    for (int i = 0; i < N; i++) {
        double second = 0, third = 0;
        for (int j = 0; j < STAGES - 1; j++) {
            second += DENSE[0][j] * w->stage[j][i];
            third += DENSE[1][j] * w->stage[j][i];
        }
        w->between[i] = rest * m->state.y[i] + share * (w->trial[i] + rest * (second + share * third));
    }
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

/* Root mean square of the error relative to tolerance; infinite if anything is not finite. `culprit` gets the index
   of the largest. */
static double error_norm(struct instance *m, int *culprit)
{
    const struct workspace *w = &m->work;
    double sum = 0, largest = -1, tolerance = m->state.setting[TOLERANCE];
    for (int i = 0; i < N; i++) {
        double scale = tolerance * (model_nominal_y[i] + fmax(fabs(m->state.y[i]), fabs(w->trial[i])));
        double relative = fabs(w->error[i]) / scale;
        if (!isfinite(relative) || !isfinite(w->trial[i])) {
            *culprit = i;
            return HUGE_VAL;
        }
        if (relative > largest) {
            largest = relative;
            *culprit = i;
        }
        sum += relative * relative;
    }
    return sqrt(sum / ROOM(N));
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

/* By which factor the step size may change after a step of this error, of order 4. Square roots are rounded alike by
   every C library, pow is not: so the same steps are taken on all platforms. */
static double growth(double error)
{
    return 0.9 / sqrt(sqrt(error));
}

static int adaptive(struct instance *m, double end)
{
    struct state *s = &m->state;
    double least = fmax(1e-14, 16 * DBL_EPSILON * fmax(fabs(s->time), fabs(end)));
    int known = 0, rejected = 0, culprit = 0, event = 0;
    for (int count = 0; s->time < end; count++) {
        double left = end - s->time, h = s->next_step, scale;
        int last = 1.01 * h >= left;
        if (last)
            h = left;
        else if (2 * h > left)
            h = left / 2; /* two equal steps rather than one long and one sliver */
        if (!known) {
            evaluate_jacobian(m, s->time, s->y);
            culprit = first_not_finite(m->work.f);
            if (culprit >= 0)
                return fail(m, "the equations give no finite value at t = %.9g s; first is the one of %s", s->time,
                            name_of(culprit));
            known = 1;
        }
        int singular = rodas_step(m, h);
        double error = singular ? HUGE_VAL : error_norm(m, &culprit);
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
                                       least, s->time, name_of(culprit), s->setting[TOLERANCE]);
        }
        if (count == MOST_STEPS)
            return fail(m, "%d steps did not reach t = %.9g s; at t = %.9g s the step size is %.3g s, limited by %s",
                        MOST_STEPS, end, s->time, h, name_of(culprit));
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

/* From the present time to `end`; on failure the instance stays at the last good point. */
int integrate(struct instance *m, double end)
{
    if (NE > 0 ? settle(m) : !m->state.consistent && solve_algebraic(m) != 0) /* inputs may have jumped */
        return 1;
    if (N == 0 && NE == 0) {
        advance_to(m, end);
        return 0;
    }
    if (m->explicit_order > 0)
        return integrate_explicitly(m, end);
    return m->state.setting[FIXED_STEP] > 0 ? fixed(m, end) : adaptive(m, end);
}
