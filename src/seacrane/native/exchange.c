/* Outputs to inputs, extrapolated where that is wanted, and the step of one slave. seacrane/cosim/python_slave.py
 * does the same in the same order. */
#include "master.h"

#include <math.h>
#include <string.h>

void weigh(const plan_t *p, const slave_t *from, double a, double b, weights_t *w) {
    const double known = from->times[p->depth], length = b - a;
    double tau[MOST_SAMPLES];
    w->count = known > 1 ? (int)known : 1;
    for (int i = 0; i < w->count; ++i) tau[i] = (from->times[i] - a) / length;
    if (w->count == 1) {
        w->mean[0] = w->begin[0] = w->end[0] = 1;
        w->slope[0] = 0;
    } else if (w->count == 2) {
        const double d = tau[0] - tau[1];
        w->slope[0] = 1 / d;
        w->slope[1] = -1 / d;
        w->begin[1] = tau[0] / d;
        w->begin[0] = 1 - w->begin[1];
        w->mean[1] = (tau[0] - 0.5) / d;
        w->mean[0] = 1 - w->mean[1];
        w->end[1] = (tau[0] - 1) / d;
        w->end[0] = 1 - w->end[1];
    } else {
        for (int i = 0; i < 3; ++i) {
            const double j = tau[(i + 1) % 3], k = tau[(i + 2) % 3];
            const double c2 = 1 / ((tau[i] - j) * (tau[i] - k)), c1 = -(j + k) * c2, c0 = j * k * c2;
            w->mean[i] = c0 + c1 / 2 + c2 / 3;
            w->begin[i] = c0 - c2 / 6;
            w->slope[i] = c1 + c2;
            w->end[i] = c0 + c1 + c2;
        }
    }
}

/* Sum of weight times sample of the output at `place`. */
static double weighed(const plan_t *p, const double *weight, int count, int64_t place) {
    double sum = weight[0] * p->samples[place];
    for (int i = 1; i < count; ++i) sum += weight[i] * p->samples[i * p->output_count + place];
    return sum;
}

/* Whether a slave steps in the present macro step: a slower one does in the last of each `every`. */
int active(const plan_t *p, const slave_t *s) {
    return !s->stopped && (s->every == 1 || (p->done + 1) % s->every == 0);
}

/* All inputs of a slave for its step from `from` to `to`. */
void transfer(plan_t *p, const slave_t *s, int64_t from, int64_t to) {
    const connection_t *c = p->connections + s->first_connection;
    const double seconds = (double)(to - from) / 1e9;
    weights_t w = {0};
    int64_t weighed_for = -1;
    for (int64_t i = 0; i < s->connection_count; ++i, ++c) {
        double mean = p->values[c->source], more = 0;
        if (p->depth) {
            if (c->from != weighed_for) weigh(p, p->slaves + (weighed_for = c->from), (double)from, (double)to, &w);
            mean = weighed(p, w.mean, w.count, c->source);
        }
        const double scaled = mean * c->gain;
        double value = scaled + (c->adds ? p->values[c->target] : c->bias);
        if (c->owed >= 0) {
            more = p->values[c->owed] / seconds;
            value = value + more;
        }
        p->values[c->target] = value;
        if (s->derive) {
            double *begin = s->begins + (c->target - s->first_input), *slope = s->slopes + (c->target - s->first_input);
            const double begun = weighed(p, w.begin, w.count, c->source) * c->gain;
            const double rate = weighed(p, w.slope, w.count, c->source) * c->gain / seconds;
            *begin = begun + (c->adds ? *begin : c->bias);
            *begin = *begin + more;
            *slope = c->adds ? *slope + rate : rate;
        }
    }
}

static int bad(int status) { return status > 1 || status < 0; }

static int failed(slave_t *s, int64_t stage, int64_t status, int64_t variable) {
    s->fault_stage = stage;
    s->fault_status = status;
    s->fault_variable = variable;
    return FAULT;
}

/* FMI 2 status: 0 is OK, 1 a warning; discard, error, fatal and pending end the run. */
static int call(slave_t *s, double t, double h) {
    int status;
    if (s->callback) return bad(status = s->callback(s->handle, t, h)) ? failed(s, STEP, status, -1) : DONE;
    if (s->input_count) {
        const double *inputs = s->derive ? s->begins : s->inputs;
        status = s->set(s->handle, s->input_references, (size_t)s->input_count, inputs);
        if (bad(status)) return failed(s, SET, status, -1);
    }
    if (s->derive && s->derived_count) {
        for (int64_t i = 0; i < s->derived_count; ++i) s->derived_slopes[i] = s->slopes[s->derived[i]];
        status = s->derive(s->handle, s->derived_references, (size_t)s->derived_count, s->orders, s->derived_slopes);
        if (bad(status)) return failed(s, SET, status, -1);
    }
    return bad(status = s->step(s->handle, t, h, 1)) ? failed(s, STEP, status, -1) : DONE;
}

static double changed(const change_t *c, double raw, double t) {
    const double scaled = c->gain * raw;
    double value = scaled + c->bias;
    if (t < c->end) {
        const double rest = c->slope * (c->end - t);
        value -= rest;
    }
    return value;
}

static void manipulate(plan_t *p, const slave_t *s, int64_t first, int64_t count, double t) {
    change_t *c = p->changes + first;
    for (const change_t *end = c + count; c < end; ++c) {
        double *value = p->values + c->target;
        const int64_t input = c->target - s->first_input;
        if (!c->fixed) c->raw = *value;
        *value = changed(c, c->raw, t);
        if (s->derive && input >= 0 && input < s->input_count) {
            s->begins[input] = changed(c, c->fixed ? c->raw : s->begins[input], t);
            s->slopes[input] = c->gain * s->slopes[input];
        }
    }
}

/* A macro step of a slave, in its own steps, up to its outputs. */
static int exchange(plan_t *p, slave_t *s, int64_t from, int64_t size) {
    const int64_t window = s->every * size, first = from + size - window;
    int status;
    for (int64_t k = 0; k < s->substeps; ++k) {
        const int64_t a = first + window * k / s->substeps, b = first + window * (k + 1) / s->substeps;
        const double t = (double)(p->start_ns + a) / 1e9;
        if (s->derive) memcpy(s->begins, s->inputs, (size_t)s->input_count * sizeof(double)); /* for what nothing drives */
        if (p->depth) transfer(p, s, a, b);
        if (s->input_changes && (p->depth || k == 0)) manipulate(p, s, s->first_change, s->input_changes, t);
        if (call(s, t, (double)(b - a) / 1e9) != DONE) return FAULT;
    }
    if (p->depth && s->substeps > 1) { /* what is shown is the mean of all */
        transfer(p, s, first, first + window);
        if (s->input_changes)
            manipulate(p, s, s->first_change, s->input_changes, (double)(p->start_ns + first) / 1e9);
    }
    if (!s->callback && s->output_count) {
        status = s->get(s->handle, s->output_references, (size_t)s->output_count, s->outputs);
        if (bad(status)) return failed(s, GET, status, -1);
    }
    for (int64_t j = 0; j < s->output_count; ++j)
        if (!isfinite(s->outputs[j])) return failed(s, FINITE, 0, j);
    return DONE;
}

/* Step a slave over the macro step from `from` of length `size`. Touches nothing of other slaves. */
int step_slave(plan_t *p, slave_t *s, int64_t from, int64_t size) {
    volatile int64_t *calls = p->calls + (s - p->slaves);
    *calls += 1;
    const int result = exchange(p, s, from, size);
    *calls += 1;
    if (s->output_changes && result == DONE) {
        const double begin = (double)(p->start_ns + from) / 1e9, h = (double)size / 1e9;
        manipulate(p, s, s->first_change + s->input_changes, s->output_changes, begin + h);
    }
    return result;
}

/* The outputs that a slave's history lets expect at the end of a macro step. */
void predict(plan_t *p, const slave_t *s, int64_t from, int64_t size, double *outputs) {
    weights_t w;
    weigh(p, s, (double)from, (double)(from + size), &w);
    for (int64_t j = 0; j < s->output_count; ++j) outputs[j] = weighed(p, w.end, w.count, s->first_output + j);
}

/* Outputs at `time` become the newest sample. */
void push(plan_t *p, slave_t *s, int64_t time, const double *outputs) {
    const size_t bytes = (size_t)s->output_count * sizeof(double);
    double *newest = p->samples + s->first_output;
    for (int64_t i = p->depth - 1; i > 0; --i) {
        memcpy(newest + i * p->output_count, newest + (i - 1) * p->output_count, bytes);
        s->times[i] = s->times[i - 1];
    }
    memcpy(newest, outputs, bytes);
    s->times[0] = (double)time;
    if (s->times[p->depth] < (double)p->depth) s->times[p->depth] += 1;
}

/* All slaves once over the macro step, group after group; while iterating the newest sample is a guess to be replaced. */
int sweep(plan_t *p, int64_t from, int64_t size, int iterating) {
    p->sweeps += 1;
    for (int64_t n = 0; n < p->group_count; ++n) {
        group_t *g = p->groups + n;
        const int64_t begin = group_begin(p, g);
        if (!p->depth)
            for (int64_t i = 0; i < g->count; ++i) {
                const slave_t *s = p->slaves + g->members[i];
                if (active(p, s)) transfer(p, s, from + size - s->every * size, from + size);
            }
        step_group(p, g, from, size);
        for (int64_t i = 0; i < g->count; ++i) {
            slave_t *s = p->slaves + g->members[i];
            if (!active(p, s)) continue;
            if (s->fault_stage >= 0)
                return fault(p, g->members[i], s->fault_stage, s->fault_status, s->fault_variable);
            if (iterating)
                memcpy(p->samples + s->first_output, s->outputs, (size_t)s->output_count * sizeof(double));
            else if (p->depth)
                push(p, s, from + size, s->outputs);
        }
        group_end(p, g, begin);
    }
    return DONE;
}

int save_all(plan_t *p, int slot) {
    for (int64_t i = 0; i < p->slave_count; ++i) {
        slave_t *s = p->slaves + i;
        const int status = s->save(s->handle, s->saved + slot);
        if (bad(status)) return fault(p, i, SAVE, status, -1);
    }
    return DONE;
}

int restore_slave(plan_t *p, int64_t i, int slot) {
    slave_t *s = p->slaves + i;
    const int status = s->restore(s->handle, s->saved[slot]);
    return bad(status) ? fault(p, i, RESTORE, status, -1) : DONE;
}

int restore_all(plan_t *p, int slot) {
    for (int64_t i = 0; i < p->slave_count; ++i)
        if (restore_slave(p, i, slot) != DONE) return FAULT;
    return DONE;
}
