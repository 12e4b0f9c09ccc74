/* Birth, reset, rollback and end of an instance. */
#include "core.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_STEP 1e-4       /* [s] where the step size control starts; it adapts by itself from there */
#define DEFAULT_TOLERANCE 1e-5 /* relative; see also seacrane.model.codegen, which tells the user */

/* An instance for co-simulation, or for model exchange. */
struct instance *instance_new(const char *name, int exchange)
{
    struct instance *m = calloc(1, sizeof *m);
    size_t length = strlen(name) + 1;
    if (m == NULL)
        return NULL;
    m->name = malloc(length);
    if (m->name == NULL) {
        free(m);
        return NULL;
    }
    memcpy(m->name, name, length);
    m->base[STATE] = m->state.y;
    m->base[ALGEBRAIC] = m->state.y + NX;
    m->base[INPUT] = m->state.u;
    m->base[PARAMETER] = m->state.p;
    m->base[MODE] = m->state.p + NP;
    m->base[SETTING] = m->state.setting;
    m->base[DERIVATIVE] = m->derivative;
    m->base[OUTPUT] = m->output;
    m->base[OBSERVABLE] = m->observable;
    m->base[INDICATOR] = m->indicator;
    m->base[TIME] = &m->state.time;
    m->state.exchange = exchange;
    instance_reset(m);
    return m;
}

void instance_free(struct instance *m)
{
    if (m != NULL)
        free(m->name);
    free(m);
}

/* Back to the start values of the model, as if just instantiated. */
void instance_reset(struct instance *m)
{
    struct state *s = &m->state;
    int32_t exchange = s->exchange;
    memset(s, 0, sizeof *s);
    s->exchange = exchange;
    s->magic = STATE_MAGIC;
    s->version = STATE_VERSION;
    s->size = (uint32_t)sizeof *s;
    memcpy(s->model, model_hash, sizeof s->model);
    memcpy(s->y, model_start_y, N * sizeof(double));
    memcpy(s->u, model_start_u, NU * sizeof(double));
    memcpy(s->p, model_start_p, NP * sizeof(double));
    memcpy(s->p + NP, model_start_m, NM * sizeof(double));
    s->setting[TOLERANCE] = DEFAULT_TOLERANCE;
    s->next_step = FIRST_STEP;
    s->phase = INSTANTIATED;
    memset(&m->statistics, 0, sizeof m->statistics);
    m->events.count = 0;
    m->message[0] = '\0';
    changed(m);
}

/* Whether a saved state is one of this model, 1 if so; the message says why not. */
int instance_accepts(struct instance *m, const struct state *saved)
{
    const struct state *s = &m->state;
    if (saved->magic != STATE_MAGIC)
        return !fail(m, "these bytes are not the state of a model");
    if (saved->version != STATE_VERSION)
        return !fail(m, "the state has format version %u; this model reads version %u", saved->version, STATE_VERSION);
    if (memcmp(saved->model, s->model, sizeof s->model) != 0 || saved->size != s->size)
        return !fail(m, "the state belongs to another model, or to another version of this one");
    if (saved->exchange != s->exchange)
        return !fail(m, "the state is one of an instance for %s", saved->exchange ? "model exchange" : "co-simulation");
    return 1;
}

/* Takes over a saved state if it is one of this model; otherwise nothing happens but the message. */
int instance_restore(struct instance *m, const struct state *saved)
{
    if (!instance_accepts(m, saved))
        return 1;
    memcpy(&m->state, saved, sizeof *saved);
    m->fresh = 0;
    return 0;
}

/* Something that the algebraic unknowns and all results may depend on has changed. */
void changed(struct instance *m)
{
    m->state.consistent = NZ == 0;
    m->fresh = 0;
}

/* Keeps where the instance is, so that it can be moved to look at another point. */
void leave_point(struct instance *m)
{
    struct workspace *w = &m->work;
    w->left = m->state.time;
    memcpy(w->left_y, m->state.y, N * sizeof(double));
    memcpy(w->left_u, m->state.u, NU * sizeof(double));
    memcpy(w->left_u + NU, m->state.slope, NU * sizeof(double));
    m->fresh = 0;
}

/* Back to that point, whose algebraic unknowns were known. */
void return_to_point(struct instance *m)
{
    struct workspace *w = &m->work;
    m->state.time = w->left;
    memcpy(m->state.y, w->left_y, N * sizeof(double));
    memcpy(m->state.u, w->left_u, NU * sizeof(double));
    memcpy(m->state.slope, w->left_u + NU, NU * sizeof(double));
    m->state.consistent = 1;
    m->fresh = 0;
}

int fail(struct instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(m->message, sizeof m->message, format, arguments);
    va_end(arguments);
    return 1;
}
