/* Jumps: an event happens where its indicator rises above zero, and sets states and modes to new values.

   Indicators are of the order of one. One that has risen above zero by MARGIN is remembered as being above, until it has
   fallen to zero again; in between its event does not happen a second time. At the start of a run, and where inputs jump,
   an indicator that is found above zero counts as one that has risen.

   The time of an event is found by repeating the step with smaller sizes (the Illinois form of the rule of false position,
   with bisection where that is slow: M. Dowell and P. Jarratt, BIT 11, 1971), so that the states there are a solution and
   no interpolation: to 1e-13 of the step, or four units in the last place of the time. */
#include "core.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define CLOSE 1e-13
#define MOST_AT_ONCE 100
#define MOST_IN_A_CROWD 100
#define CROWD 1e-3 /* [s]; no machine switches as often as that in such a time */

/* What an indicator must exceed for its event to be behind. */
double margin(const struct instance *m, int event)
{
    return m->state.above[event] ? 0 : MARGIN;
}

/* By how much the foremost of the events to come is behind at t and y; below zero none of them is. */
static double behind(struct instance *m, double t, const double *y)
{
    double *g = m->work.indicator, most = -HUGE_VAL;
    evaluate_indicators(m, t, y, g);
    for (int i = 0; i < NE; i++)
        if (!m->state.above[i])
            most = fmax(most, g[i] - MARGIN);
    return most;
}

/* Whether an event is behind at t and y. */
int due_at(struct instance *m, double t, const double *y)
{
    return behind(m, t, y) > 0;
}

/* By how much the foremost of those events that are behind where `after` was taken is so where `before` was; not above
   zero. */
static double ahead(const struct instance *m, const double *before, const double *after)
{
    double most = -HUGE_VAL;
    for (int i = 0; i < NE; i++)
        if (!m->state.above[i] && after[i] > MARGIN)
            most = fmax(most, before[i] - MARGIN);
    return fmin(most, 0);
}

/* If an event lies within the step of size *h that has been tried, shortens it to end just after the first one and
   returns 1; 0 if there is none; -1 if a step failed. */
int shorten_to_event(struct instance *m, attempt *step, double *h)
{
    struct state *s = &m->state;
    struct workspace *w = &m->work;
    double over = behind(m, s->time + *h, w->trial);
    if (!(over > 0)) {
        for (int i = 0; i < NE; i++)
            s->above[i] = s->above[i] && w->indicator[i] > 0;
        return 0;
    }
    double *before = w->course[0], *after = w->course[1], low = 0, high = *h, tried = high;
    double close = fmax(CLOSE * *h, 4 * DBL_EPSILON * fmax(fabs(s->time), *h)), kept_low = 1, kept_high = 1;
    memcpy(after, w->indicator, NE * sizeof(double));
    evaluate_indicators(m, s->time, s->y, before);
    for (int slow = 0, side = 0; high - low > close;) {
        double width = high - low, under = kept_low * ahead(m, before, after), at = kept_high * over;
        double guess = slow > 2 ? low + width / 2 : high - width * at / (at - under);
        tried = fmin(fmax(guess, low + close / 4), high - close / 4);
        if (step(m, tried) != 0)
            return -1;
        double value = behind(m, s->time + tried, w->trial);
        if (value > 0) { /* an end of the bracket that stays loses weight */
            kept_low = side > 0 ? kept_low / 2 : 1;
            kept_high = side = 1;
            high = tried;
            over = value;
            memcpy(after, w->indicator, NE * sizeof(double));
        } else {
            kept_high = side < 0 ? kept_high / 2 : 1;
            kept_low = 1;
            side = -1;
            low = tried;
            memcpy(before, w->indicator, NE * sizeof(double));
        }
        slow = high - low > width / 2 ? slow + 1 : 0;
    }
    *h = high;
    return tried != high && step(m, high) != 0 ? -1 : 1;
}

static void note(struct instance *m, int event)
{
    struct events *e = &m->events;
    e->time[e->count % KEPT_EVENTS] = m->state.time;
    e->index[e->count % KEPT_EVENTS] = event;
    e->count++;
}

/* Whether too many events happen in too short a time. */
static int crowded(struct state *s)
{
    if (!(s->crowd > 0 && s->time - s->crowd_since <= CROWD)) {
        s->crowd_since = s->time;
        s->crowd = 0;
    }
    return ++s->crowd > MOST_IN_A_CROWD;
}

/* Lets the events happen that are due at the present point, and those that these bring about, until there are none. */
int settle(struct instance *m)
{
    struct state *s = &m->state;
    struct workspace *w = &m->work;
    for (int count = 0;; count++) {
        int last = -1;
        if (!s->consistent && solve_algebraic(m) != 0)
            return 1;
        evaluate_indicators(m, s->time, s->y, w->indicator);
        for (int i = 0; i < NE; i++) {
            int above = w->indicator[i] > margin(m, i);
            w->due[i] = above && !s->above[i];
            s->above[i] = above;
            if (w->due[i] != 0) {
                note(m, i);
                last = i;
            }
        }
        if (last < 0)
            return 0;
        if (count == MOST_AT_ONCE)
            return fail(m, "events at t = %.9g s do not come to an end: %s brings itself about", s->time,
                        model_event[last]);
        if (crowded(s))
            return fail(m, "%s chatters: %d events within %g s at t = %.9g s; it needs a hysteresis, or a state of rest",
                        model_event[last], MOST_IN_A_CROWD, CROWD, s->time);
        evaluate_reset(m, w->due, w->after);
        for (int i = 0; i < NX + NM; i++)
            if (!isfinite(w->after[i]))
                return fail(m, "%s gives no finite value at t = %.9g s", model_event[last], s->time);
        memcpy(s->y, w->after, NX * sizeof(double));
        memcpy(s->p + NP, w->after + NX, NM * sizeof(double));
        changed(m);
    }
}
