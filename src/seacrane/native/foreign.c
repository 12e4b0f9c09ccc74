/* Any FMU behind the three functions that the master loop takes: set, get and step with the signatures of FMI 2.

   An FMU of FMI 3 for co-simulation has its extra arguments filled in, is stepped on after an early return, and gets its
   events handled in event mode. An FMU for model exchange (FMI 2 or 3) is integrated here: RODAS of order 4 with step
   size control (Hairer & Wanner, Solving Ordinary Differential Equations II, sections IV.7 and VI.4, coefficients of
   table 4.2), its Jacobian from directional derivatives or from differences. Step, time and state events end a step; the
   time of a state event is found by repeating the step with smaller sizes, so that the state there is a solution and
   no interpolation (FMI 2.0.4, section 3.2; FMI 3.0.1, section 3.2).

   The importer fills in the first part of the structure and gives `room` doubles of memory. */
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define STAGES 6
#define GAMMA 0.25
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
    double *memory;
    int64_t version, exchange, event_mode, discrete_inputs, n, m; /* n states, m event indicators */
    double tolerance;
    /* how far the run is; saved and restored with the FMU's own state */
    double time, next_event, next_step;
    int64_t mode, event_known, steps, rejected, events, jacobians;
    char message[256];
} foreign_t;

typedef struct {
    double *y, *trial, *f, *ft, *nominal, *error, *seed, *before, *after, *jacobian, *matrix, *stage[STAGES], *pivot;
} work_t;

EXPORT size_t seacrane_foreign_room(int64_t n, int64_t m) { return (size_t)((8 + STAGES) * n + 2 * n * n + 2 * m + 1); }

static work_t work(const foreign_t *s)
{
    const int64_t n = s->n, m = s->m;
    work_t w;
    double *next = s->memory;
    double **vectors[] = {&w.y, &w.trial, &w.f, &w.ft, &w.nominal, &w.error, &w.seed, &w.pivot};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++, next += n)
        *vectors[i] = next;
    for (int i = 0; i < STAGES; i++, next += n)
        w.stage[i] = next;
    w.jacobian = next, next += n * n;
    w.matrix = next, next += n * n;
    w.before = next, next += m;
    w.after = next;
    return w;
}

static int failed(int status) { return status > WARNING || status < OK; }

static int said(foreign_t *s, int status, const char *what)
{
    snprintf(s->message, sizeof s->message, "%s at t = %.9g s", what, s->time);
    return status;
}

/* Event mode until the discrete states are settled; what the events changed is read anew. */
static int settle(foreign_t *s)
{
    const work_t w = work(s);
    int again = 1, stop = 0, status;
    if (s->mode != EVENT && failed(status = ((plain_t)s->enter_event)(s->fmu)))
        return said(s, status, "event mode could not be entered");
    s->mode = EVENT;
    for (int count = 0; again && !stop; count++) {
        if (s->version == 2) {
            event_info_t info = {0};
            status = ((update2_t)s->update)(s->fmu, &info);
            again = info.update, stop = info.terminate, s->event_known = info.defined, s->next_event = info.next;
        } else {
            bool update = 0, terminate = 0, nominals = 0, values = 0, defined = 0;
            status = ((update3_t)s->update)(s->fmu, &update, &terminate, &nominals, &values, &defined, &s->next_event);
            again = update, stop = terminate, s->event_known = defined;
        }
        if (failed(status))
            return said(s, status, "the discrete states could not be updated");
        if (count == 1000)
            return said(s, ERROR, "the discrete states do not settle within 1000 iterations");
    }
    if (stop)
        return said(s, DISCARD, "the FMU asked to end the simulation");
    if (failed(status = ((plain_t)s->resume)(s->fmu)))
        return said(s, status, "event mode could not be left");
    s->mode = RUNNING;
    s->events++;
    if (!s->exchange)
        return OK;
    if (s->n && (failed(status = ((take_t)s->get_states)(s->fmu, w.y, (size_t)s->n)) ||
                 failed(status = ((take_t)s->nominals)(s->fmu, w.nominal, (size_t)s->n))))
        return said(s, status, "the continuous states could not be read");
    for (int64_t i = 0; i < s->n; i++)
        w.nominal[i] = w.nominal[i] > 0 ? w.nominal[i] : 1;
    if (s->m && failed(status = ((take_t)s->indicators)(s->fmu, w.before, (size_t)s->m)))
        return said(s, status, "the event indicators could not be read");
    return OK;
}

/* After initialization: the FMU is in event mode (or has none). */
EXPORT int seacrane_foreign_begin(foreign_t *s, double time)
{
    s->time = time;
    s->next_step = 0;
    s->event_known = s->steps = s->rejected = s->events = s->jacobians = 0;
    s->mode = EVENT;
    return s->exchange || s->event_mode ? settle(s) : OK;
}

/* Enters event mode, in which everything that may be set while running may be set. */
EXPORT int seacrane_foreign_open(foreign_t *s)
{
    int status;
    if ((!s->exchange && !s->event_mode) || s->mode == EVENT)
        return OK;
    if (failed(status = ((plain_t)s->enter_event)(s->fmu)))
        return said(s, status, "event mode could not be entered");
    s->mode = EVENT;
    return OK;
}

/* Continuous states set from outside: the solver goes on from there, and from no crossing of its own. */
EXPORT int seacrane_foreign_states(foreign_t *s, const double *values)
{
    const work_t w = work(s);
    int status = OK;
    if (s->mode == EVENT && failed(status = settle(s)))
        return status;
    memcpy(w.y, values, (size_t)s->n * sizeof(double));
    if (s->n)
        status = ((give_t)s->set_states)(s->fmu, w.y, (size_t)s->n);
    if (!failed(status) && s->m)
        status = ((take_t)s->indicators)(s->fmu, w.before, (size_t)s->m);
    return failed(status) ? said(s, status, "the continuous states could not be set") : OK;
}

EXPORT int seacrane_foreign_set(void *handle, const uint32_t *references, size_t count, const double *values)
{
    foreign_t *s = handle;
    int status;
    if (s->discrete_inputs && failed(status = seacrane_foreign_open(s)))
        return status;
    return s->version == 2 ? ((set2_t)s->set)(s->fmu, references, count, values)
                           : ((set3_t)s->set)(s->fmu, references, count, values, count);
}

EXPORT int seacrane_foreign_get(void *handle, const uint32_t *references, size_t count, double *values)
{
    foreign_t *s = handle;
    return s->version == 2 ? ((get2_t)s->get)(s->fmu, references, count, values)
                           : ((get3_t)s->get)(s->fmu, references, count, values, count);
}

static int co_simulate(foreign_t *s, double end)
{
    for (int count = 0; count < MOST_STEPS; count++) {
        bool event = 0, terminate = 0, early = 0;
        double reached = end;
        int status = ((do_step3_t)s->do_step)(s->fmu, s->time, end - s->time, 1, &event, &terminate, &early, &reached);
        s->steps++;
        if (failed(status))
            return status;
        s->time = early ? reached : end;
        if (terminate)
            return said(s, DISCARD, "the FMU asked to end the simulation");
        if (event && s->event_mode && failed(status = settle(s)))
            return status;
        if (!early || s->time >= end) {
            s->time = end;
            return OK;
        }
    }
    return said(s, ERROR, "a step is returned from early without end");
}

static int residual(const foreign_t *s, double t, const double *y, double *f)
{
    int status = ((time_t_)s->set_time)(s->fmu, t);
    if (!failed(status) && s->n)
        status = ((give_t)s->set_states)(s->fmu, y, (size_t)s->n);
    if (!failed(status) && s->n)
        status = ((take_t)s->derivatives)(s->fmu, f, (size_t)s->n);
    return status;
}

/* f, df/dt and df/dy at the present point; columns of df/dy are stored one after the other. */
static int linearise(foreign_t *s, const work_t *w)
{
    const size_t n = (size_t)s->n;
    int status = residual(s, s->time, w->y, w->f);
    s->jacobians++;
    for (size_t j = 0; !failed(status) && j < n; j++) {
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
    if (failed(status))
        return status;
    const double later = s->time + sqrt(DBL_EPSILON * fmax(1e-5, fabs(s->time)));
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
static const double DELTA[STAGES] = {0.25, -0.1043, 0.1035, -0.0362000000000023, 0, 0};

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
            if (failed(status))
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
    *status = ((time_t_)s->set_time)(s->fmu, s->time + h);
    if (!failed(*status) && s->n)
        *status = ((give_t)s->set_states)(s->fmu, w->trial, (size_t)s->n);
    if (!failed(*status))
        *status = ((take_t)s->indicators)(s->fmu, w->after, (size_t)s->m);
    if (failed(*status))
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
        if (failed(status = attempt(s, w, size, &error)))
            return status;
        if (error == HUGE_VAL)
            break;
        double part;
        const int yes = crossed(s, w, size, &status, &part);
        if (failed(status))
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

static int exchange(foreign_t *s, double end)
{
    const work_t w = work(s);
    int known = 0, rejected = 0, status = OK;
    if (s->m) { /* inputs may have moved an indicator across zero */
        double part;
        memcpy(w.trial, w.y, (size_t)s->n * sizeof(double));
        if (crossed(s, &w, 0, &status, &part))
            status = settle(s);
        if (failed(status))
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
                if (failed(status = linearise(s, &w)))
                    return said(s, status, "the derivatives could not be evaluated");
                known = 1;
            }
            if (failed(status = attempt(s, &w, h, &error)))
                return said(s, status, "the derivatives could not be evaluated");
            if (!(error <= 1)) {
                s->next_step = h * (error < HUGE_VAL ? fmax(0.1, 0.9 * pow(error, -0.25)) : 0.1);
                rejected = 1;
                s->rejected++;
                if (s->next_step < least)
                    return said(s, ERROR, "the step size became too small");
                continue;
            }
            scale = fmin(rejected ? 1 : 5, 0.9 * pow(fmax(error, 1e-10), -0.25));
            if (s->n)
                s->next_step = last ? fmax(s->next_step, h * scale) : h * scale;
            if (crossed(s, &w, h, &status, &part)) {
                if (failed(status = locate(s, &w, &h, part)))
                    return said(s, status, "an event could not be located");
                event = 1;
                last = 0;
            }
            if (failed(status))
                return said(s, status, "the event indicators could not be read");
        } else {
            memcpy(w.trial, w.y, (size_t)s->n * sizeof(double));
        }
        s->time = last ? target : s->time + h;
        s->steps++;
        known = rejected = 0;
        memcpy(w.y, w.trial, (size_t)s->n * sizeof(double));
        status = ((time_t_)s->set_time)(s->fmu, s->time);
        if (!failed(status) && s->n)
            status = ((give_t)s->set_states)(s->fmu, w.y, (size_t)s->n);
        if (!failed(status) && s->completed) {
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
        if (failed(status))
            return said(s, status, "a step could not be completed");
        if (stop)
            return said(s, DISCARD, "the FMU asked to end the simulation");
        if (event || (s->event_known && s->time >= s->next_event)) {
            if (failed(status = settle(s)))
                return status;
            if (s->event_known && s->next_event <= s->time)
                return said(s, ERROR, "the next event is not in the future");
        } else if (s->m) {
            memcpy(w.before, w.after, (size_t)s->m * sizeof(double));
        }
        if (count == MOST_STEPS)
            return said(s, ERROR, "1000000 steps did not reach the end of the step");
    }
    return OK;
}

EXPORT int seacrane_foreign_step(void *handle, double time, double size, int final)
{
    foreign_t *s = handle;
    int status;
    (void)final;
    s->message[0] = 0;
    if (s->mode == EVENT && (s->exchange || s->event_mode) && failed(status = settle(s)))
        return status;
    s->time = time;
    return s->exchange ? exchange(s, time + size) : co_simulate(s, time + size);
}
