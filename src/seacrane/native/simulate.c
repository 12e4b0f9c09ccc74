/* What Python calls beside FMI: a whole run in one call, and a look into the instance. */
#include <math.h>
#include <string.h>

#include "interface.h"

struct samples {            /* inputs over time */
    size_t inputs, count;   /* number of inputs, number of sample times */
    const uint32_t *reference;
    const double *time;     /* [count], not falling; a time given twice is a jump */
    const double *value;    /* [count][inputs] */
    int linear;             /* straight lines between samples instead of steps */
};

/* Sets the inputs as they are at and after t; `next` is the first sample later than t. */
static int apply(struct instance *m, const struct samples *s, size_t next, double t)
{
    if (s->inputs == 0 || s->count == 0)
        return 0;
    end_ramps(m);
    size_t from = next > 0 ? next - 1 : 0;
    const double *a = s->value + from * s->inputs;
    if (!s->linear || next == 0 || next == s->count)
        return set_values(m, s->reference, s->inputs, a);
    const double *b = a + s->inputs;
    double length = s->time[next] - s->time[from];
    for (size_t i = 0; i < s->inputs; i++) {
        const int32_t first = 1;
        double slope = (b[i] - a[i]) / length, value = a[i] + slope * (t - s->time[from]);
        if (set_values(m, s->reference + i, 1, &value) != 0 || set_slopes(m, s->reference + i, 1, &first, &slope) != 0)
            return 1;
    }
    return 0;
}

static int run(struct instance *m, const struct samples *inputs, struct rows *rows)
{
    size_t next = 0;
    if (m->state.phase != STEPPING) {
        fail(m, "the model must be initialized before it is simulated");
        return FAILED;
    }
    for (int at_sample = 1;;) {
        while (next < inputs->count && inputs->time[next] <= m->state.time)
            next++;
        if (at_sample && apply(m, inputs, next, m->state.time) != 0)
            return FAILED;
        while (rows->done < rows->count && rows->time[rows->done] <= m->state.time)
            if (record(m, rows) != 0)
                return FAILED;
        if (rows->done == rows->count)
            return DONE;
        double end = rows->time[rows->count - 1];
        if (next < inputs->count)
            end = fmin(end, inputs->time[next]);
        if (integrate(m, end, rows) != 0)
            return DISCARDED;
        at_sample = next < inputs->count && inputs->time[next] <= m->state.time;
    }
}

/* Runs from the present time over `times` (not falling), writing the chosen variables at each into
   result[count][outputs]. Integration stops at each sample of the inputs. Returns an FMI status; `done` counts the rows
   that were written. */
EXPORT int seacrane_simulate(struct instance *m, size_t count, const double *times, const struct samples *inputs,
                             size_t outputs, const uint32_t *reference, double *result, size_t *done)
{
    struct rows rows = {count, 0, outputs, times, reference, result};
    int status = run(m, inputs, &rows);
    *done = rows.done;
    return status;
}

/* From now on explicit steps: Euler's method (order 1) or Runge-Kutta (order 4); order 0 goes back to the settings. */
EXPORT void seacrane_explicit(struct instance *m, int order, double step)
{
    m->explicit_order = order;
    m->explicit_step = step;
}

/* Events from number `first` on, as far as they are kept and there is `room` for them: times, and places in the list of
   events. Returns how many have happened in all. */
EXPORT uint64_t seacrane_events(const struct instance *m, uint64_t first, size_t room, double *time, int32_t *index)
{
    const struct events *e = &m->events;
    for (size_t i = 0; i < room && first + i < e->count; i++) {
        time[i] = e->time[(first + i) % KEPT_EVENTS];
        index[i] = e->index[(first + i) % KEPT_EVENTS];
    }
    return e->count;
}

EXPORT const char *seacrane_message(const struct instance *m)
{
    return m->message;
}

EXPORT double seacrane_time(const struct instance *m)
{
    return m->state.time;
}

EXPORT size_t seacrane_state_size(void)
{
    return sizeof(struct state);
}

/* The state as bytes; the block is flat, so this is all of it. */
EXPORT void seacrane_save(const struct instance *m, void *bytes)
{
    memcpy(bytes, &m->state, sizeof m->state);
}

EXPORT int seacrane_restore(struct instance *m, const void *bytes)
{
    return instance_restore(m, bytes) == 0 ? DONE : FAILED;
}

/* Accepted steps, rejected steps, evaluations of f, Jacobians, factorisations since instantiation or reset. */
EXPORT void seacrane_statistics(const struct instance *m, uint64_t value[5])
{
    memcpy(value, &m->statistics, sizeof m->statistics);
}
