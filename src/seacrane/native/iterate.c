/* A macro step repeated until the outputs that it was done with are those that it gives: z = Y(z), for the connected
 * outputs z at its end. seacrane/cosim/python_iteration.py does the same in the same order. */
#include "master.h"

#include <math.h>
#include <string.h>

enum { NONE, FIXED_POINT, NEWTON };
enum { WHENCE, FOR_STEP, JACOBIAN }; /* layout of plan.jacobian */
enum { NOWHERE, TOLD, DIFFERENCES }; /* whence a Jacobian comes */

#define LEAST_FACTOR 0.1 /* bounds of a relaxation that changes, without which single directions lead it astray */
#define MOST_FACTOR 1.0
#define SLOW 0.25       /* a Jacobian that reduces the error by less than to this share is computed anew */
#define DIFFERENCE 1e-4 /* of the larger of value and nominal: well above the errors of the slaves' own solvers */

/* The largest of |Y - z| over what is tolerated, and the residuals Y - z. */
static double compare(plan_t *p) {
    double worst = 0;
    for (int64_t i = 0; i < p->coupled_count; ++i) {
        const int64_t k = p->coupled[i];
        p->residual[i] = p->values[k] - p->guess[i];
        const double size = fabs(p->values[k]) > p->nominal[k] ? fabs(p->values[k]) : p->nominal[k];
        const double error = fabs(p->residual[i]) / (p->tolerance * size);
        if (error > worst) worst = error;
    }
    return worst;
}

/* Dynamic relaxation of Aitken: the factor with which the last two residuals would have cancelled, within bounds. */
static double aitken(plan_t *p, double factor) {
    double product = 0, square = 0;
    for (int64_t i = 0; i < p->coupled_count; ++i) {
        const double last = p->before[i] * p->scale[i], change = p->residual[i] * p->scale[i] - last;
        product += last * change;
        square += change * change;
    }
    if (square == 0) return factor;
    const double found = -factor * product / square;
    return found < LEAST_FACTOR ? LEAST_FACTOR : found > MOST_FACTOR ? MOST_FACTOR : found;
}

/* What a slave tells of the derivatives of its outputs at the end of the step: all of dY/dz where it has no states. */
static int ask(plan_t *p, int64_t i, int64_t from, int64_t size) {
    const slave_t *s = p->slaves + i;
    const connection_t *c = p->connections + s->first_connection;
    const double one = 1;
    for (int64_t m = 0; m < s->connection_count; ++m, ++c) {
        int64_t j = 0;
        while (p->coupled[j] != c->source) ++j;
        if (!active(p, p->slaves + p->coupled_slave[j])) continue;
        weights_t w;
        weigh(p, p->slaves + c->from, (double)from, (double)(from + size), &w);
        const double share = (s->derive ? w.end[0] : w.mean[0]) * c->gain;
        const uint32_t *input = s->input_references + (c->target - s->first_input);
        const int status =
            s->directional(s->handle, s->output_references, (size_t)s->output_count, input, 1, &one, p->column);
        if (status > 1 || status < 0) return fault(p, i, DERIVE, status, -1);
        for (int64_t r = 0; r < p->coupled_count; ++r)
            if (p->coupled_slave[r] == i) {
                const double part = p->column[p->coupled[r] - s->first_output] * share;
                p->jacobian[JACOBIAN + r * p->coupled_count + j] += part;
            }
    }
    return DONE;
}

/* dY/dz by differences: each slave that takes an output steps once more with it changed. With `told`, slaves that give
 * directional derivatives are asked instead. */
static int differentiate(plan_t *p, int64_t from, int64_t size, int told) {
    const int64_t n = p->coupled_count;
    double *matrix = p->jacobian + JACOBIAN;
    memcpy(p->base, p->values, (size_t)p->output_count * sizeof(double));
    memset(matrix, 0, (size_t)(n * n) * sizeof(double));
    for (int64_t i = 0; told && i < p->slave_count; ++i)
        if (p->slaves[i].directional && active(p, p->slaves + i) && ask(p, i, from, size) != DONE) return FAULT;
    for (int64_t j = 0; j < n; ++j) {
        const int64_t k = p->coupled[j];
        if (!active(p, p->slaves + p->coupled_slave[j])) continue;
        const double magnitude = fabs(p->guess[j]) > p->nominal[k] ? fabs(p->guess[j]) : p->nominal[k];
        const double changed = p->guess[j] + DIFFERENCE * magnitude, delta = changed - p->guess[j];
        p->samples[k] = changed;
        for (int64_t i = 0; i < p->slave_count; ++i) {
            slave_t *s = p->slaves + i;
            const connection_t *c = p->connections + s->first_connection;
            int takes = 0;
            for (int64_t m = 0; m < s->connection_count; ++m) takes |= c[m].source == k;
            if (!takes || !active(p, s) || (told && s->directional)) continue;
            if (restore_slave(p, i, STEP_START) != DONE) return FAULT;
            if (step_slave(p, s, from, size) != DONE) return fault(p, i, s->fault_stage, s->fault_status, s->fault_variable);
            for (int64_t m = 0; m < n; ++m)
                if (p->coupled_slave[m] == i)
                    matrix[m * n + j] = (p->values[p->coupled[m]] - p->base[p->coupled[m]]) / delta;
        }
        p->samples[k] = p->guess[j];
    }
    p->sweeps += 1;
    memcpy(p->values, p->base, (size_t)p->output_count * sizeof(double));
    p->jacobian[WHENCE] = told ? TOLD : DIFFERENCES;
    p->jacobian[FOR_STEP] = (double)size;
    return DONE;
}

/* The residuals become the change of z, by (1 - dY/dz) dz = r; false if that has no solution. */
static int solve(plan_t *p) {
    const int64_t n = p->coupled_count;
    double *a = p->matrix, *b = p->residual;
    for (int64_t i = 0; i < n * n; ++i) a[i] = -p->jacobian[JACOBIAN + i];
    for (int64_t i = 0; i < n; ++i) a[i * n + i] = 1 + a[i * n + i];
    for (int64_t k = 0; k < n; ++k) {
        int64_t pivot = k;
        for (int64_t i = k + 1; i < n; ++i)
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k])) pivot = i;
        if (a[pivot * n + k] == 0) return 0;
        if (pivot != k) {
            for (int64_t j = k; j < n; ++j) {
                const double kept = a[k * n + j];
                a[k * n + j] = a[pivot * n + j];
                a[pivot * n + j] = kept;
            }
            const double kept = b[k];
            b[k] = b[pivot];
            b[pivot] = kept;
        }
        for (int64_t i = k + 1; i < n; ++i) {
            const double factor = a[i * n + k] / a[k * n + k];
            if (factor == 0) continue;
            for (int64_t j = k + 1; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
            b[i] -= factor * b[k];
        }
    }
    for (int64_t k = n - 1; k >= 0; --k) {
        for (int64_t j = k + 1; j < n; ++j) b[k] -= a[k * n + j] * b[j];
        b[k] /= a[k * n + k];
    }
    return 1;
}

int iterate(plan_t *p, int64_t from, int64_t size) {
    const int64_t n = p->coupled_count;
    double factor = p->relaxation, last = 0;
    int fresh = 0;
    if (save_all(p, STEP_START) != DONE) return FAULT;
    for (int64_t i = 0; i < p->slave_count; ++i) {
        slave_t *s = p->slaves + i;
        if (!active(p, s)) continue;
        predict(p, s, from, size, p->base + s->first_output);
        push(p, s, from + size, p->base + s->first_output);
    }
    for (int64_t i = 0; i < n; ++i) p->guess[i] = p->samples[p->coupled[i]];
    for (int64_t count = 1;; ++count) {
        if (sweep(p, from, size, 1) != DONE) return FAULT;
        const double error = compare(p);
        p->signals[ITERATIONS] = (double)count;
        if (error <= 1) return DONE;
        if (count == p->most || !isfinite(error)) return fault(p, -1, CONVERGE, 0, -1);
        if (p->iteration == FIXED_POINT) {
            if (count == 1)
                for (int64_t i = 0; i < n; ++i) {
                    const int64_t k = p->coupled[i];
                    p->scale[i] = 1 / (fabs(p->values[k]) > p->nominal[k] ? fabs(p->values[k]) : p->nominal[k]);
                }
            else if (p->aitken)
                factor = aitken(p, factor);
            for (int64_t i = 0; i < n; ++i) {
                p->before[i] = p->residual[i];
                p->guess[i] += factor * p->residual[i];
            }
        } else {
            const double known_for = p->jacobian[FOR_STEP];
            const int whence = (int)p->jacobian[WHENCE];
            const int fits = whence && (double)size < 2 * known_for && (double)size > known_for / 2;
            const int slow = !fresh && count > 1 && error > SLOW * last;
            fresh = 0;
            if (!fits || slow) { /* what slaves tell is tried until it has once proved not to be enough */
                const int told = p->tells && whence != DIFFERENCES && !(fits && slow);
                for (int64_t i = 0; i < n; ++i) p->samples[p->coupled[i]] = p->guess[i];
                if (differentiate(p, from, size, told) != DONE) return FAULT;
                fresh = !told;
            }
            if (!solve(p)) return fault(p, -1, CONVERGE, 1, -1);
            for (int64_t i = 0; i < n; ++i) p->guess[i] += p->residual[i];
        }
        last = error;
        for (int64_t i = 0; i < n; ++i) p->samples[p->coupled[i]] = p->guess[i];
        if (restore_all(p, STEP_START) != DONE) return FAULT;
    }
}
