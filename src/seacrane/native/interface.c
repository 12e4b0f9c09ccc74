/* The services of an instance as FMI wants them, whatever its version. */
#include "interface.h"
#include "model_guid.h" /* MODEL_GUID */

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Whether `function` must not be called now; then the message says so. */
int misplaced(struct instance *m, const char *function, unsigned phases)
{
    static const char *const when[] = {"before initialization", "in initialization mode", "in step mode",
                                       "after termination",     "in event mode",          "in continuous-time mode"};
    if (phases >> m->state.phase & 1u)
        return 0;
    return fail(m, "%s must not be called %s", function, when[m->state.phase]);
}

/* Why no instance can be made, or NULL. */
const char *refusal(const char *name, const char *identity)
{
    if (identity == NULL || strcmp(identity, MODEL_GUID) != 0)
        return "the GUID is not the one of this binary, " MODEL_GUID;
    return name == NULL || name[0] == '\0' ? "the instance needs a name" : NULL;
}

/* The experiment: tolerance of the solver, if given, and start time. */
int begin(struct instance *m, const char *function, int has_tolerance, double tolerance, double start)
{
    if (misplaced(m, function, WHEN(INSTANTIATED)))
        return FAILED;
    if (!isfinite(start))
        return fail(m, "the start time is not a finite number"), FAILED;
    if (has_tolerance && !(tolerance >= 1e-12 && tolerance <= 0.1))
        return fail(m, "the tolerance %.3g is outside 1e-12 to 0.1", tolerance), FAILED;
    if (has_tolerance)
        m->state.setting[TOLERANCE] = tolerance;
    m->state.time = start;
    changed(m);
    return DONE;
}

int move_on(struct instance *m, const char *function, unsigned from, enum phase to)
{
    if (misplaced(m, function, from))
        return FAILED;
    m->state.phase = to;
    return DONE;
}

int exit_initialization(struct instance *m, const char *function)
{
    if (misplaced(m, function, WHEN(INITIALIZING)) || refresh(m, 0) != 0)
        return FAILED;
    m->state.phase = m->state.exchange ? EVENT : STEPPING;
    return NE > 0 && !m->state.exchange && settle(m) != 0 ? FAILED : DONE;
}

int assign(struct instance *m, const char *function, const uint32_t *reference, size_t count, const double *value)
{
    if (misplaced(m, function, WHEN(INSTANTIATED) | KNOWN) || set_values(m, reference, count, value) != 0)
        return FAILED;
    return DONE;
}

/* A step that cannot be done is discarded: the slave is left at the last good point, with its values there. */
int step(struct instance *m, const char *function, double from, double size)
{
    if (misplaced(m, function, WHEN(STEPPING)))
        return FAILED;
    if (!(size > 0) || !isfinite(from + size))
        return fail(m, "the step size %g s is not a positive number", size), FAILED;
    if (!(fabs(from - m->state.time) <= 1e-9 * fmax(1, fabs(from)) + 1e-6 * size))
        return fail(m, "a step from t = %.12g s was asked for, but the model is at t = %.12g s", from, m->state.time),
               FAILED;
    m->state.time = from;
    if (m->state.sloped == USED_UP)
        end_ramps(m);
    if (integrate(m, from + size, NULL) != 0)
        return DISCARDED;
    if (m->state.sloped == RAMPED)
        m->state.sloped = USED_UP;
    return DONE;
}

int save_state(struct instance *m, void **saved)
{
    if (*saved == NULL)
        *saved = malloc(sizeof m->state);
    if (*saved == NULL)
        return fail(m, "not enough memory to save the state"), FAILED;
    memcpy(*saved, &m->state, sizeof m->state);
    return DONE;
}

int restore_state(struct instance *m, const void *saved)
{
    return instance_restore(m, saved) == 0 ? DONE : FAILED;
}

int serialize(struct instance *m, const void *saved, void *bytes, size_t size)
{
    if (size < sizeof(struct state))
        return fail(m, "a saved state needs %u bytes", (unsigned)sizeof(struct state)), FAILED;
    memcpy(bytes, saved, sizeof(struct state));
    return DONE;
}

/* The bytes may come from anywhere: they become a state only if they are one of this model. */
int deserialize(struct instance *m, const void *bytes, size_t size, void **saved)
{
    if (size != sizeof m->state)
        return fail(m, "%u bytes are not a saved state of this model, which has %u", (unsigned)size,
                    (unsigned)sizeof m->state), FAILED;
    void *copy = *saved != NULL ? *saved : malloc(size);
    if (copy == NULL)
        return fail(m, "not enough memory for the state"), FAILED;
    memcpy(copy, bytes, size);
    if (instance_accepts(m, copy)) {
        *saved = copy;
        return DONE;
    }
    if (*saved == NULL)
        free(copy);
    return FAILED;
}

/* Where in the workspace the derivative with respect to a known variable is put in, or NULL. */
static double *direction_of(struct instance *m, uint32_t reference, double *dt)
{
    const struct variable *v = find_variable(reference);
    struct workspace *w = &m->work;
    if (v != NULL && v->kind == TIME)
        return dt;
    double *d = v == NULL ? NULL : v->kind == STATE ? w->dy : v->kind == INPUT ? w->du : v->kind == PARAMETER ? w->dp : NULL;
    if (d == NULL)
        fail(m, "value reference %u is no state, input or parameter", (unsigned)reference);
    return d == NULL ? NULL : d + v->index;
}

static void no_direction(struct workspace *w)
{
    memset(w->dy, 0, sizeof w->dy);
    memset(w->du, 0, sizeof w->du);
    memset(w->dp, 0, sizeof w->dp);
}

/* Where the derivative of an unknown is found after evaluate_directional, or NULL. */
static const double *slope_of(struct instance *m, uint32_t reference)
{
    const struct variable *v = find_variable(reference);
    if (v != NULL && v->kind == OUTPUT)
        return m->work.doutput + v->index;
    if (v != NULL && v->kind == DERIVATIVE)
        return m->work.df + v->index;
    fail(m, "value reference %u is no output or state derivative", (unsigned)reference);
    return NULL;
}

int directional(struct instance *m, const char *function, const uint32_t *unknown, size_t unknowns,
                const uint32_t *known, size_t knowns, const double *seed, double *sensitivity)
{
    double dt = 0;
    if (misplaced(m, function, KNOWN))
        return FAILED;
    no_direction(&m->work);
    for (size_t i = 0; i < knowns; i++) {
        double *d = direction_of(m, known[i], &dt);
        if (d == NULL)
            return FAILED;
        *d += seed[i];
    }
    if (evaluate_directional(m, dt) != 0)
        return FAILED;
    for (size_t i = 0; i < unknowns; i++) {
        const double *slope = slope_of(m, unknown[i]);
        if (slope == NULL)
            return FAILED;
        sensitivity[i] = *slope;
    }
    return DONE;
}

/* Seeds of the unknowns times their Jacobian: one directional derivative for each known variable, which is cheap as long
   as these are the inputs and states of one drive. */
int adjoint(struct instance *m, const char *function, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
            size_t knowns, const double *seed, double *sensitivity)
{
    if (misplaced(m, function, KNOWN))
        return FAILED;
    for (size_t j = 0; j < knowns; j++) {
        double dt = 0;
        no_direction(&m->work);
        double *d = direction_of(m, known[j], &dt);
        if (d == NULL)
            return FAILED;
        *d = 1;
        if (evaluate_directional(m, dt) != 0)
            return FAILED;
        sensitivity[j] = 0;
        for (size_t i = 0; i < unknowns; i++) {
            const double *slope = slope_of(m, unknown[i]);
            if (slope == NULL)
                return FAILED;
            sensitivity[j] += seed[i] * *slope;
        }
    }
    return DONE;
}

/* Total first time derivatives of outputs, the states moving as they do and the inputs along their slopes. */
int output_derivatives(struct instance *m, const char *function, const uint32_t *reference, size_t count,
                       const int32_t *order, double *value)
{
    if (misplaced(m, function, WHEN(STEPPING)))
        return FAILED;
    if (count == 0)
        return DONE;
    if (refresh(m, 1u << DERIVATIVE) != 0)
        return FAILED;
    no_direction(&m->work);
    memcpy(m->work.dy, m->derivative, NX * sizeof(double));
    memcpy(m->work.du, m->state.slope, NU * sizeof(double));
    if (evaluate_directional(m, 1) != 0)
        return FAILED;
    for (size_t i = 0; i < count; i++) {
        const struct variable *v = find_variable(reference[i]);
        if (v == NULL || v->kind != OUTPUT || order[i] != 1)
            return fail(m, "there are first derivatives of outputs only; value reference %u, order %d is none",
                        (unsigned)reference[i], (int)order[i]), FAILED;
        value[i] = m->work.doutput[v->index];
    }
    return DONE;
}

/* The time derivatives of inputs at the beginning of a communication step; they hold for this step. */
int input_derivatives(struct instance *m, const char *function, const uint32_t *reference, size_t count,
                      const int32_t *order, const double *value)
{
    if (misplaced(m, function, WHEN(INSTANTIATED) | WHEN(INITIALIZING) | WHEN(STEPPING)))
        return FAILED;
    return set_slopes(m, reference, count, order, value) == 0 ? DONE : FAILED;
}

/* In event mode: what is due happens. */
int update_discrete_states(struct instance *m, const char *function, int *happened)
{
    if (misplaced(m, function, WHEN(EVENT)))
        return FAILED;
    uint64_t before = m->events.count;
    int outcome = NE > 0 && settle(m) != 0 ? FAILED : DONE;
    *happened = m->events.count != before;
    return outcome;
}

/* Indicators as FMI wants them: of the order of one, and not zero when an event is over. Discarded where the algebraic
   equations have no solution. */
int get_indicators(struct instance *m, const char *function, double *indicator, size_t count)
{
    if (misplaced(m, function, KNOWN))
        return FAILED;
    if (count != NE)
        return fail(m, "the model has %d event indicators, not %u", NE, (unsigned)count), FAILED;
    if (refresh(m, 1u << INDICATOR) != 0)
        return DISCARDED;
    memcpy(indicator, m->indicator, NE * sizeof(double));
    return DONE;
}

int set_time(struct instance *m, const char *function, double time)
{
    if (misplaced(m, function, EXCHANGING))
        return FAILED;
    if (!isfinite(time))
        return fail(m, "the time is not a finite number"), FAILED;
    m->state.time = time;
    changed(m);
    return DONE;
}

static int wrong_count(struct instance *m, size_t count)
{
    return count == NX ? 0 : fail(m, "the model has %d continuous states, not %u", NX, (unsigned)count);
}

int set_states(struct instance *m, const char *function, const double *x, size_t count)
{
    if (misplaced(m, function, EXCHANGING) || wrong_count(m, count))
        return FAILED;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i]))
            return fail(m, "continuous state %u is not a finite number", (unsigned)i), DISCARDED;
    memcpy(m->state.y, x, NX * sizeof(double));
    changed(m);
    return DONE;
}

int get_states(struct instance *m, const char *function, double *x, size_t count)
{
    if (misplaced(m, function, KNOWN) || wrong_count(m, count))
        return FAILED;
    memcpy(x, m->state.y, NX * sizeof(double));
    return DONE;
}

int get_nominals(struct instance *m, double *nominal, size_t count)
{
    if (wrong_count(m, count))
        return FAILED;
    memcpy(nominal, model_nominal_y, NX * sizeof(double));
    return DONE;
}

/* Discarded where the algebraic equations have no solution: the environment may try a shorter step. */
int get_derivatives(struct instance *m, const char *function, double *derivative, size_t count)
{
    if (misplaced(m, function, KNOWN) || wrong_count(m, count))
        return FAILED;
    if (refresh(m, 1u << DERIVATIVE) != 0)
        return DISCARDED;
    for (int i = 0; i < NX; i++)
        if (!isfinite(m->derivative[i]))
            return fail(m, "the equations give no finite value at t = %.9g s", m->state.time), DISCARDED;
    memcpy(derivative, m->derivative, NX * sizeof(double));
    return DONE;
}
