/* Reading and writing variables by value reference. */
#include "core.h"

#include <math.h>
#include <string.h>

#define BIT(kind) (1u << (kind))
#define COMPUTED (BIT(DERIVATIVE) | BIT(ALGEBRAIC) | BIT(OUTPUT) | BIT(OBSERVABLE) | BIT(INDICATOR))
#define SETTABLE (BIT(INPUT) | BIT(PARAMETER) | BIT(SETTING))
#define SETTABLE_AT_START (SETTABLE | BIT(STATE) | BIT(ALGEBRAIC) | BIT(MODE))

const struct variable *find_variable(uint32_t reference)
{
    size_t low = 0, high = NVARIABLES;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (model_variables[middle].reference < reference)
            low = middle + 1;
        else
            high = middle;
    }
    return low < NVARIABLES && model_variables[low].reference == reference ? &model_variables[low] : NULL;
}

/* Resolves up to LOOKUP_SIZE references; free of cost if they are the same as last time. */
static int resolve(struct instance *m, struct lookup *lookup, const uint32_t *reference, size_t count)
{
    if (lookup->count == count && memcmp(lookup->reference, reference, count * sizeof *reference) == 0)
        return 0;
    lookup->count = 0;
    lookup->kinds = 0;
    for (size_t i = 0; i < count; i++) {
        const struct variable *variable = find_variable(reference[i]);
        if (variable == NULL)
            return fail(m, "no variable has the value reference %u", reference[i]);
        lookup->reference[i] = reference[i];
        lookup->value[i] = m->base[variable->kind] + variable->index;
        lookup->kinds |= BIT(variable->kind);
    }
    lookup->count = count;
    return 0;
}

int get_values(struct instance *m, const uint32_t *reference, size_t count, double *value)
{
    struct lookup *lookup = &m->get;
    while (count > 0) {
        size_t part = count < LOOKUP_SIZE ? count : LOOKUP_SIZE;
        if (resolve(m, lookup, reference, part) != 0)
            return 1;
        if (lookup->kinds & COMPUTED) {
            if (m->state.phase == INSTANTIATED)
                return fail(m, "results are not known before the model is initialized");
            if ((!m->state.consistent || (lookup->kinds & ~m->fresh & COMPUTED)) && refresh(m, lookup->kinds) != 0)
                return 1;
        }
        for (size_t i = 0; i < part; i++)
            value[i] = *lookup->value[i];
        reference += part;
        value += part;
        count -= part;
    }
    return 0;
}

static int refuse(struct instance *m, uint32_t reference, double value)
{
    const struct variable *v = find_variable(reference);
    const int plain = strcmp(v->unit, "1") == 0; /* a number without a unit */
    const char *gap = plain ? "" : " ", *unit = plain ? "" : v->unit;
    if (!isfinite(value))
        return fail(m, "%s cannot be set to %g: it is not a finite number", v->name, value);
    switch (v->kind) {
    case STATE:
    case ALGEBRAIC:
    case MODE:
        return fail(m, "%s can only be set before or during initialization", v->name);
    case PARAMETER:
        return fail(m, "%s = %.9g%s%s is outside its range of %.9g to %.9g%s%s", v->name, value, gap, unit,
                    model_minimum_p[v->index], model_maximum_p[v->index], gap, unit);
    case SETTING:
        return fail(m, "%s = %.9g%s%s is outside its range of %s", v->name, value, gap, unit,
                    v->index == TOLERANCE ? "1e-12 to 0.1" : "0 (adaptive) upwards");
    default:
        return fail(m, "%s is a result and cannot be set", v->name);
    }
}

/* Whether a parameter or setting may take this value; inputs are only asked to be finite, by the caller. */
static int within(const struct variable *v, double value)
{
    if (v->kind == PARAMETER)
        return value >= model_minimum_p[v->index] && value <= model_maximum_p[v->index];
    if (v->kind == SETTING)
        return v->index == TOLERANCE ? value >= 1e-12 && value <= 0.1 : value >= 0;
    return 1;
}

/* From now on inputs stay where they are. */
void end_ramps(struct instance *m)
{
    memset(m->state.slope, 0, sizeof m->state.slope);
    memset(m->state.curvature, 0, sizeof m->state.curvature);
    m->state.sloped = CONSTANT;
}

/* Sets all values of a part or none of it. */
static int set_part(struct instance *m, const uint32_t *reference, size_t count, const double *value)
{
    struct lookup *lookup = &m->set;
    int jumped = 0;
    if (resolve(m, lookup, reference, count) != 0)
        return 1;
    uint32_t allowed = m->state.phase <= INITIALIZING ? SETTABLE_AT_START : SETTABLE;
    int look = (lookup->kinds & ~BIT(INPUT)) != 0;
    for (size_t i = 0; i < count; i++) {
        const struct variable *v = look ? find_variable(reference[i]) : NULL;
        if (!isfinite(value[i]) || (look && (!(BIT(v->kind) & allowed) || !within(v, value[i]))))
            return refuse(m, reference[i], value[i]);
        jumped |= *lookup->value[i] != value[i];
    }
    for (size_t i = 0; i < count; i++)
        *lookup->value[i] = value[i];
    if (jumped)
        changed(m);
    return 0;
}

int set_values(struct instance *m, const uint32_t *reference, size_t count, const double *value)
{
    while (count > 0) {
        size_t part = count < LOOKUP_SIZE ? count : LOOKUP_SIZE;
        if (set_part(m, reference, part, value) != 0)
            return 1;
        reference += part;
        value += part;
        count -= part;
    }
    return 0;
}

/* Time derivatives of inputs, of first or second order, at the present time: from there on they change along lines or
   parabolas, until the end of the communication step. */
int set_slopes(struct instance *m, const uint32_t *reference, size_t count, const int32_t *order, const double *value)
{
    if (m->state.sloped == USED_UP)
        end_ramps(m);
    for (size_t i = 0; i < count; i++) {
        const struct variable *v = find_variable(reference[i]);
        if (v == NULL)
            return fail(m, "no variable has the value reference %u", reference[i]);
        if (v->kind != INPUT)
            return fail(m, "%s is no input and has no input derivative", v->name);
        if (!isfinite(value[i]))
            return fail(m, "the time derivative of %s is not a finite number", v->name);
        if (order[i] != 1 && order[i] != 2)
            return fail(m, "inputs have derivatives of order 1 and 2; %s was given one of order %d", v->name,
                        (int)order[i]);
        (order[i] == 1 ? m->state.slope : m->state.curvature)[v->index] = value[i];
    }
    m->state.sloped = CONSTANT;
    for (int i = 0; i < NU; i++)
        if (m->state.slope[i] != 0 || m->state.curvature[i] != 0)
            m->state.sloped = RAMPED;
    return 0;
}

/* The next row, from the present point. */
int record(struct instance *m, struct rows *rows)
{
    if (get_values(m, rows->reference, rows->outputs, rows->value + rows->done * rows->outputs) != 0)
        return 1;
    rows->done++;
    return 0;
}
