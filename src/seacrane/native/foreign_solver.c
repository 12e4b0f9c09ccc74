/* FMUs for model exchange (FMI 2 or 3), integrated here: RODAS (rodas.h) with step size control, its Jacobian from
   directional derivatives or from differences.

   Step, time and state events end a step; the time of a state event is found by repeating the step with smaller sizes, so
   that the state there is a solution and no interpolation (FMI 2.0.4, section 3.2; FMI 3.0.1, section 3.2). */
#include "foreign.h"

#include <float.h>
#include <math.h>
#include <string.h>

static int residual(const foreign_t *s, double t, const double *y, double *f)
{
    int status = foreign_at(s, t);
    if (!foreign_failed(status) && s->n)
        status = ((give_t)s->set_states)(s->fmu, y, (size_t)s->n);
    if (!foreign_failed(status) && s->n)
        status = ((take_t)s->derivatives)(s->fmu, f, (size_t)s->n);
    return status;
}

/* f, df/dt and df/dy at the present point, before a step of size h; columns of df/dy are stored one after the other. */
static int linearise(foreign_t *s, const work_t *w, double h)
{
    const size_t n = (size_t)s->n;
    int status = residual(s, s->time, w->y, w->f);
    s->jacobians++;
    for (size_t j = 0; !foreign_failed(status) && j < n; j++) {
        double *column = w->jacobian + j * n;
        if (s->directional) {
            const double one = 1;
            status = s->version == 2 ? ((directional2_t)s->directional)(s->fmu, s->derivative_references, n,
                                                                         s->state_references + j, 1, &one, column)
                                     : ((directional3_t)s->directional)(s->fmu, s->derivative_references, n,
                                                                         s->state_references + j, 1, &one, 1, column, n);
            continue;
        }
        const double kept = w->y[j], delta = sqrt(DBL_EPSILON) * fmax(fabs(kept), w->nominal[j]);
        w->y[j] = kept + delta;
        status = residual(s, s->time, w->y, column);
        for (size_t i = 0; i < n; i++)
            column[i] = (column[i] - w->f[i]) / (w->y[j] - kept);
        w->y[j] = kept;
    }
    if (foreign_failed(status))
        return status;
    /* so near that the difference costs no order, so far that rounding does not show */
    const double later = s->time + fmin(h, fmax(1e-6 * h, 1e3 * DBL_EPSILON * fabs(s->time)));
    status = residual(s, later, w->y, w->ft);
    for (size_t i = 0; i < n; i++)
        w->ft[i] = (w->ft[i] - w->f[i]) / (later - s->time);
    return status;
}

/* LU factors of the matrix (columns one after the other) with row exchanges; 1 if it is singular. */
static int factor(int64_t n, double *a, double *pivot)
{
    for (int64_t k = 0; k < n; k++) {
        int64_t p = k;
        for (int64_t i = k + 1; i < n; i++)
            if (fabs(a[k * n + i]) > fabs(a[k * n + p]))
                p = i;
        pivot[k] = (double)p;
        if (!(fabs(a[k * n + p]) > 0))
            return 1;
        for (int64_t j = 0; j < n && p != k; j++) {
            const double x = a[j * n + k];
            a[j * n + k] = a[j * n + p];
            a[j * n + p] = x;
        }
        for (int64_t i = k + 1; i < n; i++)
            a[k * n + i] /= a[k * n + k];
        for (int64_t j = k + 1; j < n; j++)
            for (int64_t i = k + 1; i < n; i++)
                a[j * n + i] -= a[k * n + i] * a[j * n + k];
    }
    return 0;
}

static void solve(int64_t n, const double *a, const double *pivot, double *b)
{
    for (int64_t k = 0; k < n; k++) {
        const int64_t p = (int64_t)pivot[k];
        const double x = b[p];
        b[p] = b[k];
        b[k] = x;
    }
    for (int64_t k = 0; k < n; k++)
        for (int64_t i = k + 1; i < n; i++)
            b[i] -= a[k * n + i] * b[k];
    for (int64_t k = n - 1; k >= 0; k--) {
        b[k] /= a[k * n + k];
        for (int64_t i = 0; i < k; i++)
            b[i] -= a[k * n + i] * b[k];
    }
}

/* A step of size h into `trial`; `error` gets its error relative to the tolerance, infinite if it cannot be done. */
static int attempt(foreign_t *s, const work_t *w, double h, double *error)
{
    const int64_t n = s->n;
    *error = HUGE_VAL;
    for (int64_t i = 0; i < n * n; i++)
        w->matrix[i] = -w->jacobian[i];
    for (int64_t i = 0; i < n; i++)
        w->matrix[i * n + i] += 1 / (h * GAMMA);
    if (factor(n, w->matrix, w->pivot))
        return OK;
    for (int stage = 0; stage < STAGES; stage++) {
        double *k = w->stage[stage];
        memcpy(w->trial, w->y, (size_t)n * sizeof(double));
        for (int j = 0; j < stage; j++)
            for (int64_t i = 0; i < n; i++)
                w->trial[i] += A[stage][j] * w->stage[j][i];
        if (stage == 0) {
            memcpy(k, w->f, (size_t)n * sizeof(double));
        } else {
            const int status = residual(s, s->time + ALPHA[stage] * h, w->trial, k);
            if (foreign_failed(status))
                return status == DISCARD ? OK : status; /* discarded: the step was too large */
        }
        for (int64_t i = 0; i < n; i++) {
            double sum = 0;
            for (int j = 0; j < stage; j++)
                sum += C[stage][j] * w->stage[j][i];
            k[i] += sum / h + h * DELTA[stage] * w->ft[i];
        }
        solve(n, w->matrix, w->pivot, k);
    }
    double sum = 0;
    for (int64_t i = 0; i < n; i++) {
        const double change = w->stage[STAGES - 1][i];
        w->trial[i] += change;
        const double scale = s->tolerance * (w->nominal[i] + fmax(fabs(w->y[i]), fabs(w->trial[i])));
        sum += change * change / (scale * scale);
    }
    *error = n ? sqrt(sum / (double)n) : 0;
    if (!isfinite(*error))
        *error = HUGE_VAL;
    return OK;
}

/* Event indicators at the end of the step of size h; whether any has another sign than at its beginning. `where` gets
   the earliest crossing, in parts of the step, as a straight line gives it. */
static int crossed(foreign_t *s, const work_t *w, double h, int *status, double *where)
{
    int any = 0;
    *where = 1;
    if (s->m == 0)
        return 0;
    *status = foreign_at(s, s->time + h);
    if (!foreign_failed(*status) && s->n)
        *status = ((give_t)s->set_states)(s->fmu, w->trial, (size_t)s->n);
    if (!foreign_failed(*status))
        *status = ((take_t)s->indicators)(s->fmu, w->after, (size_t)s->m);
    if (foreign_failed(*status))
        return 0;
    for (int64_t i = 0; i < s->m; i++)
        if ((w->before[i] > 0) != (w->after[i] > 0)) {
            any = 1;
            *where = fmin(*where, w->before[i] / (w->before[i] - w->after[i]));
        }
    return any;
}

/* The size of the step at whose end an event indicator has just changed its sign; `trial` is the state there. */
static int locate(foreign_t *s, const work_t *w, double *h, double where)
{
    const double close = fmax(1e-13 * *h, 4 * DBL_EPSILON * fmax(fabs(s->time), *h));
    double low = 0, high = *h, guess = where * high, error;
    int status = OK, slow = 0;
    while (high - low > close) {
        /* a little beyond the straight line's crossing, so that the bracket closes from above, or else its middle */
        double size = slow >= 2 ? low + 0.5 * (high - low) : guess + 0.5 * close;
        size = fmin(fmax(size, low + 0.25 * close), high - 0.25 * close);
        const double width = high - low;
        if (foreign_failed(status = attempt(s, w, size, &error)))
            return status;
        if (error == HUGE_VAL)
            break;
        double part;
        const int yes = crossed(s, w, size, &status, &part);
        if (foreign_failed(status))
            return status;
        if (yes) {
            high = size;
            guess = part * size;
        } else {
            low = size;
            guess = low + 0.5 * (high - low);
            if (s->m == 1 && w->after[0] != w->before[0]) /* the line from the start through the point just found */
                guess = fmin(guess, size * w->before[0] / (w->before[0] - w->after[0]));
            if (!(guess > low))
                guess = low + 0.5 * (high - low);
        }
        slow = high - low > 0.5 * width ? slow + 1 : 0;
    }
    *h = high;
    return attempt(s, w, high, &error);
}

int foreign_exchange(foreign_t *s, double end)
{
    const work_t w = foreign_work(s);
    int known = 0, rejected = 0, status = OK;
    if (s->m) { /* inputs may have moved an indicator across zero */
        double part;
        memcpy(w.trial, w.y, (size_t)s->n * sizeof(double));
        if (crossed(s, &w, 0, &status, &part))
            status = foreign_settle(s);
        if (foreign_failed(status))
            return status;
    }
    for (int count = 0; s->time < end; count++) {
        const double target = s->event_known ? fmin(end, fmax(s->next_event, s->time)) : end;
        const double left = target - s->time, least = fmax(1e-14, 16 * DBL_EPSILON * fmax(fabs(s->time), fabs(end)));
        double h = s->next_step > 0 ? s->next_step : 0.01 * (end - s->time), error, part, scale;
        int last = 1.01 * h >= left || s->n == 0, event = 0, stop = 0;
        if (last)
            h = left;
        else if (2 * h > left)
            h = left / 2;
        if (h > 0) {
            if (!known) {
                if (foreign_failed(status = linearise(s, &w, h)))
                    return foreign_said(s, status, "the derivatives could not be evaluated");
                known = 1;
            }
            if (foreign_failed(status = attempt(s, &w, h, &error)))
                return foreign_said(s, status, "the derivatives could not be evaluated");
            if (!(error <= 1)) {
                s->next_step = h * (error < HUGE_VAL ? fmax(0.1, growth(error)) : 0.1);
                rejected = 1;
                s->rejected++;
                if (s->next_step < least)
                    return foreign_said(s, ERROR, "the step size became too small");
                continue;
            }
            scale = fmin(rejected ? 1 : 5, growth(fmax(error, 1e-10)));
            if (s->n)
                s->next_step = last ? fmax(s->next_step, h * scale) : h * scale;
            if (crossed(s, &w, h, &status, &part)) {
                if (foreign_failed(status = locate(s, &w, &h, part)))
                    return foreign_said(s, status, "an event could not be located");
                event = 1;
                last = 0;
            }
            if (foreign_failed(status))
                return foreign_said(s, status, "the event indicators could not be read");
        } else {
            memcpy(w.trial, w.y, (size_t)s->n * sizeof(double));
        }
        s->time = last ? target : s->time + h;
        s->steps++;
        known = rejected = 0;
        memcpy(w.y, w.trial, (size_t)s->n * sizeof(double));
        status = foreign_at(s, s->time);
        if (!foreign_failed(status) && s->n)
            status = ((give_t)s->set_states)(s->fmu, w.y, (size_t)s->n);
        if (!foreign_failed(status) && s->completed) {
            if (s->version == 2) {
                int enter = 0, terminate = 0;
                status = ((completed2_t)s->completed)(s->fmu, 1, &enter, &terminate);
                event |= enter, stop = terminate;
            } else {
                bool enter = 0, terminate = 0;
                status = ((completed3_t)s->completed)(s->fmu, 1, &enter, &terminate);
                event |= enter, stop = terminate;
            }
        }
        if (foreign_failed(status))
            return foreign_said(s, status, "a step could not be completed");
        if (stop)
            return foreign_said(s, DISCARD, "the FMU asked to end the simulation");
        if (event || (s->event_known && s->time >= s->next_event)) {
            if (foreign_failed(status = foreign_settle(s)))
                return status;
            if (s->event_known && s->next_event <= s->time)
                return foreign_said(s, ERROR, "the next event is not in the future");
        } else if (s->m) {
            memcpy(w.before, w.after, (size_t)s->m * sizeof(double));
        }
        if (count == MOST_STEPS)
            return foreign_said(s, ERROR, "1000000 steps did not reach the end of the step");
    }
    return OK;
}

