/* Variables of any type, and elements of arrays, as the real numbers that the master loop exchanges.

   The loop's value references are places in a table of signals here. Real scalars go on to the FMU's own functions many
   at a time; an array is read and written as a whole, and what is not real only when it has changed, since setting it
   may cost an event. The importer fills in the structure. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define CHUNK 64
#define WHOLE 1e-6 /* how far from a whole number a value may be that is set to an integer */

enum { OK, WARNING, DISCARD, ERROR };
enum type { FLOAT64, FLOAT32, INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, BOOL8, BOOL32, TYPES };

typedef int (*plain_t)(void *);
typedef int (*step_t)(void *, double, double, int);
typedef int (*reals_t)(void *, const uint32_t *, size_t, const double *);
typedef int (*take_reals_t)(void *, const uint32_t *, size_t, double *);
typedef int (*derive_t)(void *, const uint32_t *, size_t, const int32_t *, const double *);
typedef int (*values_t)(void *, const uint32_t *, size_t, void *);
typedef int (*values3_t)(void *, const uint32_t *, size_t, void *, size_t);

typedef struct {
    uint32_t reference, type, element, count; /* of how many elements its variable has, this is the one at `element` */
    int64_t place, first;                     /* of its variable: in `buffer`, in doubles; its first signal */
    int64_t discrete, known;                  /* known, of the first: the buffer has what the FMU was set to */
    double sign, low, high;
} signal_t;

typedef struct {
    void *fmu, *inner;                            /* the component, and what the functions for real numbers take */
    void *set_reals, *get_reals, *step, *derive, *open; /* open: to where discrete variables may be set */
    void *set[TYPES], *get[TYPES];
    signal_t *signals;
    double *buffer;
    int64_t version, failed; /* failed: which signal was given a value that it cannot take */
    double value;
} typed_t;

static int bad(int status) { return status < OK || status > WARNING; }
static int direct(const signal_t *s) { return s->type == FLOAT64 && s->count == 1 && s->sign > 0; }
static int same(const signal_t *a, const signal_t *b) { return a->place == b->place && !direct(b); }

static int call(const typed_t *t, void *const functions[TYPES], const signal_t *s)
{
    void *values = t->buffer + s->place, *function = functions[s->type];
    if (!function)
        return ERROR;
    return t->version == 3 ? ((values3_t)function)(t->fmu, &s->reference, 1, values, s->count)
                           : ((values_t)function)(t->fmu, &s->reference, 1, values);
}

#define CASES(DO) \
    DO(FLOAT32, float) DO(INT8, int8_t) DO(UINT8, uint8_t) DO(INT16, int16_t) DO(UINT16, uint16_t) \
    DO(INT32, int32_t) DO(UINT32, uint32_t) DO(INT64, int64_t) DO(UINT64, uint64_t) DO(BOOL8, uint8_t) DO(BOOL32, int32_t)

static double element(const typed_t *t, const signal_t *s)
{
    const void *values = t->buffer + s->place;
    double value = 0;
    switch (s->type) {
    case FLOAT64: value = ((const double *)values)[s->element]; break;
#define READ(name, type) case name: value = (double)((const type *)values)[s->element]; break;
    CASES(READ)
    }
    if (s->sign > 0)
        return value;
    return s->type == BOOL8 || s->type == BOOL32 ? 1 - value : -value;
}

/* 1 if the element has changed, 0 if not, -1 if it cannot take the value. */
static int put(const typed_t *t, const signal_t *s, double value)
{
    void *values = t->buffer + s->place;
    if (s->sign < 0)
        value = s->type == BOOL8 || s->type == BOOL32 ? 1 - value : -value;
    if (s->type > FLOAT32) {
        const double whole = nearbyint(value);
        if (!(fabs(value - whole) <= WHOLE && s->low <= whole && whole <= s->high))
            return -1;
        value = whole;
    }
    switch (s->type) {
#define WRITE(name, type) \
    case name: { \
        const type given = (type)value; \
        const int changed = ((type *)values)[s->element] != given; \
        ((type *)values)[s->element] = given; \
        return changed; \
    }
    WRITE(FLOAT64, double)
    CASES(WRITE)
    }
    return -1;
}

EXPORT int seacrane_typed_set(void *handle, const uint32_t *references, size_t count, const double *values)
{
    typed_t *t = handle;
    for (size_t i = 0, n; i < count; i += n) {
        signal_t *s = t->signals + references[i];
        int status = OK, changed;
        n = 0;
        if (direct(s)) {
            uint32_t chunk[CHUNK];
            for (; n < CHUNK && i + n < count && direct(t->signals + references[i + n]); n++)
                chunk[n] = t->signals[references[i + n]].reference;
            status = ((reals_t)t->set_reals)(t->inner, chunk, n, values + i);
            if (bad(status))
                return status;
            continue;
        }
        while (i + n < count && same(s, t->signals + references[i + n]))
            n++;
        signal_t *first = t->signals + s->first;
        changed = !first->known;
        if (n < s->count && !first->known && bad(status = call(t, t->get, s)))
            return status;
        for (size_t k = 0; k < n; k++) {
            const int differs = put(t, t->signals + references[i + k], values[i + k]);
            if (differs < 0) {
                t->failed = references[i + k];
                t->value = values[i + k];
                return ERROR;
            }
            changed |= differs;
        }
        if (!changed)
            continue;
        if (s->discrete && t->open && bad(status = ((plain_t)t->open)(t->inner)))
            return status;
        if (bad(status = call(t, t->set, s)))
            return status;
        first->known = 1;
    }
    return OK;
}

EXPORT int seacrane_typed_get(void *handle, const uint32_t *references, size_t count, double *values)
{
    typed_t *t = handle;
    for (size_t i = 0, n; i < count; i += n) {
        const signal_t *s = t->signals + references[i];
        int status;
        n = 0;
        if (direct(s)) {
            uint32_t chunk[CHUNK];
            for (; n < CHUNK && i + n < count && direct(t->signals + references[i + n]); n++)
                chunk[n] = t->signals[references[i + n]].reference;
            status = ((take_reals_t)t->get_reals)(t->inner, chunk, n, values + i);
        } else {
            status = call(t, t->get, s);
            for (; i + n < count && same(s, t->signals + references[i + n]); n++)
                values[i + n] = element(t, t->signals + references[i + n]);
        }
        if (bad(status))
            return status;
    }
    return OK;
}

EXPORT int seacrane_typed_step(void *handle, double time, double size, int final)
{
    const typed_t *t = handle;
    return ((step_t)t->step)(t->inner, time, size, final);
}

/* Only real scalars have slopes; all else is held over the step. */
EXPORT int seacrane_typed_derive(void *handle, const uint32_t *references, size_t count, const int32_t *order,
                                 const double *values)
{
    const typed_t *t = handle;
    for (size_t i = 0; i < count; i++) {
        const signal_t *s = t->signals + references[i];
        const int status = direct(s) ? ((derive_t)t->derive)(t->inner, &s->reference, 1, order + i, values + i) : OK;
        if (bad(status))
            return status;
    }
    return OK;
}

/* The FMU may have been set by others, or gone back to another state. */
EXPORT void seacrane_typed_forget(typed_t *t, size_t count)
{
    for (size_t i = 0; i < count; i++)
        t->signals[i].known = 0;
}
EXPORT size_t seacrane_typed_size(void) { return sizeof(typed_t); }
