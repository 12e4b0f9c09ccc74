/* Any FMU behind the functions that the master loop takes, with the signatures of FMI 2: set, get, derive and step.

   An FMU of FMI 3 for co-simulation has its extra arguments filled in, is stepped on after an early return, and gets its
   events handled in event mode. An FMU for model exchange (FMI 2 or 3) is integrated by `foreign_solver.c`, with inputs that are
   held or straight lines over a step.

   The importer fills in the first part of the structure and gives `room` doubles of memory. */
#include "foreign.h"

#include <stdio.h>
#include <string.h>

EXPORT size_t seacrane_foreign_room(int64_t n, int64_t m) { return (size_t)((8 + STAGES) * n + 2 * n * n + 2 * m + 1); }

work_t foreign_work(const foreign_t *s)
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

int foreign_failed(int status) { return status > WARNING || status < OK; }

int foreign_said(foreign_t *s, int status, const char *what)
{
    snprintf(s->message, sizeof s->message, "%s at t = %.9g s", what, s->time);
    return status;
}

int foreign_settle(foreign_t *s)
{
    const work_t w = foreign_work(s);
    int again = 1, stop = 0, status;
    if (s->mode != EVENT && foreign_failed(status = ((plain_t)s->enter_event)(s->fmu)))
        return foreign_said(s, status, "event mode could not be entered");
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
        if (foreign_failed(status))
            return foreign_said(s, status, "the discrete states could not be updated");
        if (count == 1000)
            return foreign_said(s, ERROR, "the discrete states do not settle within 1000 iterations");
    }
    if (stop)
        return foreign_said(s, DISCARD, "the FMU asked to end the simulation");
    if (foreign_failed(status = ((plain_t)s->resume)(s->fmu)))
        return foreign_said(s, status, "event mode could not be left");
    s->mode = RUNNING;
    s->events++;
    if (!s->exchange)
        return OK;
    if (s->n && (foreign_failed(status = ((take_t)s->get_states)(s->fmu, w.y, (size_t)s->n)) ||
                 foreign_failed(status = ((take_t)s->nominals)(s->fmu, w.nominal, (size_t)s->n))))
        return foreign_said(s, status, "the continuous states could not be read");
    for (int64_t i = 0; i < s->n; i++)
        w.nominal[i] = w.nominal[i] > 0 ? w.nominal[i] : 1;
    if (s->m && foreign_failed(status = ((take_t)s->indicators)(s->fmu, w.before, (size_t)s->m)))
        return foreign_said(s, status, "the event indicators could not be read");
    return OK;
}

/* After initialization: the FMU is in event mode (or has none). */
EXPORT int seacrane_foreign_begin(foreign_t *s, double time)
{
    s->time = time;
    s->next_step = 0;
    s->event_known = s->steps = s->rejected = s->events = s->jacobians = 0;
    s->mode = EVENT;
    return s->exchange || s->event_mode ? foreign_settle(s) : OK;
}

/* Enters event mode, in which everything that may be set while running may be set. */
EXPORT int seacrane_foreign_open(foreign_t *s)
{
    int status;
    if ((!s->exchange && !s->event_mode) || s->mode == EVENT)
        return OK;
    if (foreign_failed(status = ((plain_t)s->enter_event)(s->fmu)))
        return foreign_said(s, status, "event mode could not be entered");
    s->mode = EVENT;
    return OK;
}

/* Continuous states set from outside: the solver goes on from there, and from no crossing of its own. */
EXPORT int seacrane_foreign_states(foreign_t *s, const double *values)
{
    const work_t w = foreign_work(s);
    int status = OK;
    if (s->mode == EVENT && foreign_failed(status = foreign_settle(s)))
        return status;
    memcpy(w.y, values, (size_t)s->n * sizeof(double));
    if (s->n)
        status = ((give_t)s->set_states)(s->fmu, w.y, (size_t)s->n);
    if (!foreign_failed(status) && s->m)
        status = ((take_t)s->indicators)(s->fmu, w.before, (size_t)s->m);
    return foreign_failed(status) ? foreign_said(s, status, "the continuous states could not be set") : OK;
}

EXPORT int seacrane_foreign_set(void *handle, const uint32_t *references, size_t count, const double *values)
{
    foreign_t *s = handle;
    int status;
    if (s->discrete_inputs && foreign_failed(status = seacrane_foreign_open(s)))
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

/* The slopes of continuous inputs over the next step: the inputs have been set to their values at its beginning. */
EXPORT int seacrane_foreign_derive(void *handle, const uint32_t *references, size_t count, const int32_t *order,
                                   const double *values)
{
    foreign_t *s = handle;
    const size_t inputs = (size_t)s->inputs;
    double *base = s->ramp, *slope = base + inputs;
    if (!s->ramping) {
        const int status = seacrane_foreign_get(s, s->input_references, inputs, base);
        if (foreign_failed(status))
            return status;
        memset(slope, 0, inputs * sizeof(double));
        s->ramping = 1;
    }
    for (size_t i = 0, place = 0; i < count; i++) {
        if (order[i] != 1)
            return foreign_said(s, ERROR, "only first derivatives of inputs are taken");
        for (size_t tried = 0; tried < inputs; tried++, place = (place + 1) % inputs)
            if (s->input_references[place] == references[i]) {
                slope[place] = values[i];
                break;
            }
    }
    return OK;
}

int foreign_at(const foreign_t *s, double time)
{
    const size_t inputs = (size_t)s->inputs;
    const double *base = s->ramp, *slope = base + inputs;
    double *values = s->ramp + 2 * inputs;
    const int status = ((time_t_)s->set_time)(s->fmu, time);
    if (foreign_failed(status) || !s->ramping)
        return status;
    for (size_t i = 0; i < inputs; i++)
        values[i] = base[i] + slope[i] * (time - s->ramp_start);
    return s->version == 2 ? ((set2_t)s->set)(s->fmu, s->input_references, inputs, values)
                           : ((set3_t)s->set)(s->fmu, s->input_references, inputs, values, inputs);
}

static int co_simulate(foreign_t *s, double end)
{
    for (int count = 0; count < MOST_STEPS; count++) {
        bool event = 0, terminate = 0, early = 0;
        double reached = end;
        int status = ((do_step3_t)s->do_step)(s->fmu, s->time, end - s->time, 1, &event, &terminate, &early, &reached);
        s->steps++;
        if (foreign_failed(status))
            return status;
        s->time = early ? reached : end;
        if (terminate)
            return foreign_said(s, DISCARD, "the FMU asked to end the simulation");
        if (event && s->event_mode && foreign_failed(status = foreign_settle(s)))
            return status;
        if (!early || s->time >= end) {
            s->time = end;
            return OK;
        }
    }
    return foreign_said(s, ERROR, "a step is returned from early without end");
}

EXPORT int seacrane_foreign_step(void *handle, double time, double size, int final)
{
    foreign_t *s = handle;
    int status;
    (void)final;
    s->message[0] = 0;
    if (s->mode == EVENT && (s->exchange || s->event_mode) && foreign_failed(status = foreign_settle(s)))
        return status;
    s->time = s->ramp_start = time;
    status = s->exchange ? foreign_exchange(s, time + size) : co_simulate(s, time + size);
    s->ramping = 0;
    return status;
}
EXPORT size_t seacrane_foreign_size(void) { return sizeof(foreign_t); }
