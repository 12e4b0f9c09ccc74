/* Master loop of a co-simulation: macro steps over slaves given as function addresses, on one flat array of values.
 *
 * A slave is either a set of FMI 2 functions (set, step, get) with a handle, or one callback that works on the shared
 * arrays. The loop transfers outputs to inputs, steps, checks that every output is finite, accounts for the power at
 * each bond, chooses the next step where that is wanted, and writes due rows of the recorders. It allocates nothing.
 * The Python loop in seacrane/cosim/python_loop.py does the same operations in the same order, so both give the same
 * bits; compile with -ffp-contract=off. */
#include "master.h"

#include <math.h>
#include <string.h>

enum { FIXED, POWER_RESIDUAL, STEP_DOUBLING };
enum { NEXT_STEP, LAST_ERROR, GREATEST_POWER }; /* layout of plan.controller */

#define PROPORTIONAL 0.4 /* shares of a PI controller of the step size, over the order of the error */
#define INTEGRAL 0.7
#define LEAST_CHANGE 0.2
#define MOST_CHANGE 2.0
#define MUCH 25.0 /* the error of a step that has failed: it is done again with the least share of its size */
#define DISCARD 2 /* FMI 2 status of a step that a slave could not do in this size */
#define FATAL 4   /* FMI 2 status after which a slave must not be called any more */

#define LEAST_ERROR 1e-4 /* below it, errors say no more about the step */

int fault(plan_t *p, int64_t slave, int64_t stage, int64_t status, int64_t variable) {
    p->fault_slave = slave;
    p->fault_stage = stage;
    p->fault_status = status;
    p->fault_variable = variable;
    return FAULT;
}

static void remember(const bond_t *b, double *v) {
    v[b->account + EFFORT_BEFORE] = v[b->effort_out];
    v[b->account + FLOW_BEFORE] = v[b->flow_out];
}

/* How long a slave has stepped in this macro step [s]: 0 between the steps of a slower one. */
static double stepped(const plan_t *p, int64_t slave, double h) {
    const slave_t *s = p->slaves + slave;
    return s->every == 1 ? h : active(p, s) ? (double)s->every * h : 0;
}

/* What an input has missed of its output: the integral of their difference. The mean of an output over a step is that
 * of its two ends. */
static void owe(plan_t *p, const connection_t *c, double mean, double h) {
    if (c->owed < 0 || h == 0) return;
    const double scaled = mean * c->gain;
    const double due = scaled + c->bias;
    p->values[c->owed] += (due - p->values[c->target]) * h;
}

/* Inputs count with their mean over the macro step. */
static void balance(plan_t *p, const bond_t *b, double h) {
    double *v = p->values, *a = v + b->account;
    const double effort = 0.5 * (a[EFFORT_BEFORE] + v[b->effort_out]);
    const double flow = 0.5 * (a[FLOW_BEFORE] + v[b->flow_out]);
    const double given = effort * v[b->flow_in] * b->effort_side;
    const double taken = v[b->effort_in] * flow * b->flow_side;
    const double residual = given - taken;
    const double giving = stepped(p, b->effort_slave, h), taking = stepped(p, b->flow_slave, h);
    a[POWER] = given;
    a[FLOW_POWER] = taken;
    a[RESIDUAL] = residual;
    a[ENERGY] += given * giving;
    a[ENERGY_ERROR] += giving == taking ? residual * giving : given * giving - taken * taking;
    a[ENERGY_MOVED] += fabs(given) * giving;
    if (fabs(residual) > a[PEAK_RESIDUAL]) a[PEAK_RESIDUAL] = fabs(residual);
    owe(p, p->connections + b->effort_connection, effort, taking);
    owe(p, p->connections + b->flow_connection, flow, giving);
}

/* Read the watched internal variables of all slaves. */
EXPORT int seacrane_watch(plan_t *p) {
    for (int64_t i = 0; i < p->slave_count; ++i) {
        const slave_t *s = p->slaves + i;
        if (!s->watched_count) continue;
        const int status = s->get(s->handle, s->watched_references, (size_t)s->watched_count, s->watched);
        if (status > 1 || status < 0) return fault(p, i, WATCH, status, -1);
    }
    return DONE;
}

static int record(plan_t *p, double t) {
    int watched = 0;
    for (int64_t i = 0; i < p->recorder_count; ++i) {
        recorder_t *r = p->recorders + i;
        if (p->done % r->stride) continue;
        if (r->watches && !watched++) {
            const int result = seacrane_watch(p);
            if (result != DONE) return result;
        }
        double *row = r->rows + r->count++ * (r->width + 1);
        row[0] = t;
        for (int64_t j = 0; j < r->width; ++j) row[j + 1] = p->values[r->indices[j]];
    }
    return DONE;
}

/* One macro step from `from`, of `size` nanoseconds. */
static int macro_step(plan_t *p, int64_t from, int64_t size) {
    for (int64_t i = 0; i < p->bond_count; ++i) remember(p->bonds + i, p->values);
    const int result = p->iteration ? iterate(p, from, size) : sweep(p, from, size, 0);
    if (result != DONE) return result;
    const double h = (double)size / 1e9;
    for (int64_t i = 0; i < p->bond_count; ++i) balance(p, p->bonds + i, h);
    p->signals[MACRO_STEP] = h;
    return DONE;
}

/* The energy that the coupling has created or lost in this step, over that which the bond moves with its greatest power
 * in a whole step of the grid; over the tolerance, of the worst bond. */
static double power_error(plan_t *p, double h) {
    const double whole = (double)p->step_ns / 1e9;
    double worst = 0;
    for (int64_t i = 0; i < p->bond_count; ++i) {
        const double *a = p->values + p->bonds[i].account;
        double *greatest = p->controller + GREATEST_POWER + i;
        const double power = fabs(a[POWER]) > fabs(a[FLOW_POWER]) ? fabs(a[POWER]) : fabs(a[FLOW_POWER]);
        if (power > *greatest) *greatest = power;
        const double usual = p->power > 0 ? p->power : *greatest;
        if (usual == 0) continue;
        const double error = fabs(a[RESIDUAL]) * h / (usual * whole * p->control_tolerance);
        if (error > worst) worst = error;
    }
    return worst;
}

/* The difference between one step and two halves, of the worst output; its share that is the error of the halves. */
static double doubling_error(const plan_t *p) {
    double worst = 0;
    for (int64_t k = 0; k < p->output_count; ++k) {
        const double size = fabs(p->values[k]) > p->nominal[k] ? fabs(p->values[k]) : p->nominal[k];
        const double error = fabs(p->values[k] - p->coarse[k]) / (p->control_tolerance * size);
        if (error > worst) worst = error;
    }
    return worst / (double)((1 << p->order) - 1);
}

/* The next step from the error of this one (a PI controller), in whole nanoseconds within its bounds. */
static void choose(plan_t *p, int64_t size, double error, int rejected) {
    double *c = p->controller;
    const double wanted = c[NEXT_STEP], exponent = 1 / (double)(p->order + 1);
    if (error < LEAST_ERROR) error = LEAST_ERROR;
    double change = p->safety * pow(error, -INTEGRAL * exponent) * pow(c[LAST_ERROR], PROPORTIONAL * exponent);
    if (rejected) change = p->safety * pow(error, -exponent);
    if (change < LEAST_CHANGE) change = LEAST_CHANGE;
    if (change > MOST_CHANGE) change = MOST_CHANGE;
    double next = (double)size * change;
    if (!rejected && error <= 1 && next < wanted) next = wanted; /* the step was cut to end on the grid */
    if (rejected && next > 0.9 * (double)size) next = 0.9 * (double)size;
    if (next < (double)p->smallest_ns) next = (double)p->smallest_ns;
    if (next > (double)p->step_ns) next = (double)p->step_ns;
    c[NEXT_STEP] = floor(next);
    if (!rejected) c[LAST_ERROR] = error;
}

/* What a step can be done again from. */
static int keep(plan_t *p) {
    memcpy(p->backup, p->values, (size_t)p->value_count * sizeof(double));
    return save_all(p, MACRO_START);
}

static int go_back(plan_t *p) {
    memcpy(p->values, p->backup, (size_t)p->value_count * sizeof(double));
    return restore_all(p, MACRO_START);
}

/* Whether a smaller step may mend what has failed: a slave has discarded the step, or an iteration does not converge. */
static int may_be_mended(const plan_t *p, int64_t size) {
    const int discarded = p->fault_stage == STEP && p->fault_status == DISCARD;
    return (p->fault_stage == CONVERGE || discarded) && size > p->smallest_ns;
}

/* Back to where the step began, for one of a smaller size. */
static int reject(plan_t *p, int64_t *size, double error) {
    if (go_back(p) != DONE) return FAULT;
    p->signals[REJECTED] += 1;
    choose(p, *size, error, 1);
    *size = (int64_t)p->controller[NEXT_STEP];
    memcpy(p->backup, p->values, (size_t)p->value_count * sizeof(double));
    return DONE;
}

/* Two steps of half the size, compared with a whole one; done again with a smaller size until the error is tolerable. */
static int doubled_step(plan_t *p, int64_t from, int64_t *size) {
    if (keep(p) != DONE) return FAULT;
    for (;;) {
        const int64_t half = *size / 2;
        double error = MUCH;
        int result = macro_step(p, from, *size);
        if (result == DONE) {
            memcpy(p->coarse, p->values, (size_t)p->output_count * sizeof(double));
            if (go_back(p) != DONE) return FAULT;
            result = macro_step(p, from, half);
            if (result == DONE) result = macro_step(p, from + half, *size - half);
        }
        if (result == DONE) {
            error = doubling_error(p);
            if (error <= 1 || *size <= p->smallest_ns) {
                p->signals[COUPLING_ERROR] = error * p->control_tolerance;
                choose(p, *size, error, 0);
                return DONE;
            }
        } else if (!may_be_mended(p, *size)) return FAULT;
        if (reject(p, size, error) != DONE) return FAULT;
    }
}

/* One step; done again with a smaller size where it fails, if all slaves can be brought back. */
static int followed_step(plan_t *p, int64_t from, int64_t *size) {
    if (p->repeats && keep(p) != DONE) return FAULT;
    while (macro_step(p, from, *size) != DONE) {
        if (!p->repeats || !may_be_mended(p, *size)) return FAULT;
        if (reject(p, size, MUCH) != DONE) return FAULT;
    }
    const double error = power_error(p, (double)*size / 1e9);
    p->signals[COUPLING_ERROR] = error * p->control_tolerance;
    choose(p, *size, error, 0);
    return DONE;
}

/* A whole step of the grid in steps that the errors allow; the last of them ends on the grid exactly. */
static int controlled_step(plan_t *p, int64_t from) {
    for (int64_t done = 0; done < p->step_ns;) {
        const int64_t rest = p->step_ns - done, wanted = (int64_t)p->controller[NEXT_STEP];
        int64_t size = wanted >= rest ? rest : 2 * wanted > rest ? rest - rest / 2 : wanted;
        const int result = p->control == STEP_DOUBLING ? doubled_step(p, from + done, &size)
                                                       : followed_step(p, from + done, &size);
        if (result != DONE) return result;
        done += size;
    }
    return DONE;
}

static int look(plan_t *p) {
    int64_t fired = 0;
    if (p->trigger_watches) {
        const int result = seacrane_watch(p);
        if (result != DONE) return result;
    }
    for (int64_t i = 0; i < p->trigger_count; ++i) {
        trigger_t *t = p->triggers + i;
        int64_t holds = 1;
        for (const condition_t *c = p->conditions + t->first, *end = c + t->count; c < end; ++c)
            holds = holds && (c->above ? p->values[c->index] > c->threshold : p->values[c->index] < c->threshold);
        if (holds && !t->held && !t->fired) t->fired = fired = 1;
        t->held = holds;
    }
    return fired ? STOPPED : DONE;
}

/* Do `steps` macro steps; plan.done counts those done. It does fewer if a recorder's rows are full, a slave fails, a
 * trigger fires or it is told to stop. */
EXPORT int seacrane_run(plan_t *p, int64_t steps) {
    for (; steps > 0; --steps) {
        const int64_t from = p->done * p->step_ns;
        int result;
        for (int64_t i = 0; i < p->recorder_count; ++i)
            if (p->recorders[i].count == p->recorders[i].capacity) return ROWS_FULL;
        result = p->control ? controlled_step(p, from) : macro_step(p, from, p->step_ns);
        if (result != DONE) return result;
        p->done += 1;
        result = record(p, (double)(p->start_ns + p->done * p->step_ns) / 1e9);
        if (result != DONE) return result;
        if (p->trigger_count && (result = look(p)) != DONE) return result;
        if (*p->stop) return STOPPED;
    }
    return DONE;
}

/* End the threads and free the saved states. */
EXPORT void seacrane_end(plan_t *p) {
    pool_end(p);
    for (int64_t i = 0; i < p->slave_count; ++i)
        for (int slot = 0; slot < SAVED_STATES; ++slot) {
            slave_t *s = p->slaves + i;
            const int callable = !(s->fault_stage >= 0 && s->fault_status == FATAL);
            if (s->saved[slot] && s->release && callable) (void)s->release(s->handle, s->saved + slot);
            s->saved[slot] = NULL;
        }
}
