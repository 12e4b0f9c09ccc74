/* A slave of FMI 1.0 as somebody else would write it, against the headers of the standard: a low-pass filter
   x' = (gain * u - x) / T, exact for an input that is a straight line over a step, with variables of all types. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi1Functions.h"

#define EXPORT(name) lowpass_fmi##name
#define GUID "{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}"
enum { U, X, TIME_CONSTANT };

typedef struct {
    double u, slope, x, time_constant, started;
    int gain, mode;
    char on, label[32], name[32];
    fmi1CallbackFunctions use;
} Slave;

static void say(Slave *s, fmi1Status status, const char *format, double value)
{ s->use.logger(s, s->name, status, "filter", format, s->name, value); }

const char *EXPORT(GetTypesPlatform)(void) { return "standard32"; }
const char *EXPORT(GetVersion)(void) { return "1.0"; }
fmi1Status EXPORT(SetDebugLogging)(fmi1Component c, fmi1Boolean on) { (void)c, (void)on; return fmi1OK; }
fmi1Component EXPORT(InstantiateSlave)(fmi1String name, fmi1String guid, fmi1String location, fmi1String mime,
                                       fmi1Real timeout, fmi1Boolean visible, fmi1Boolean interactive,
                                       fmi1CallbackFunctions use, fmi1Boolean logging)
{
    (void)timeout, (void)visible, (void)interactive, (void)logging;
    if (strcmp(guid, GUID) != 0) {
        use.logger(NULL, name, fmi1Error, "filter", "the GUID is %s and not %s", guid, GUID);
        return NULL;
    }
    Slave *s = use.allocateMemory(1, sizeof *s);
    s->use = use;
    s->gain = 2, s->mode = 1, s->on = 1, s->time_constant = 0.5;
    const int known = strncmp(location, "file:", 5) == 0 && strcmp(mime, "application/x-fmu-sharedlibrary") == 0;
    strcpy(s->label, known ? "filter" : "nowhere");
    snprintf(s->name, sizeof s->name, "%s", name);
    return s;
}
fmi1Status EXPORT(InitializeSlave)(fmi1Component c, fmi1Real start, fmi1Boolean defined, fmi1Real stop)
{
    (void)start, (void)defined, (void)stop;
    ((Slave *)c)->started = 1;
    say(c, fmi1OK, "%s starts with T = %.2f s", ((Slave *)c)->time_constant);
    return fmi1OK;
}
fmi1Status EXPORT(TerminateSlave)(fmi1Component c) { say(c, fmi1OK, "%s ends at x = %.2f", ((Slave *)c)->x); return fmi1OK; }
fmi1Status EXPORT(ResetSlave)(fmi1Component c) { ((Slave *)c)->x = ((Slave *)c)->started = 0; return fmi1OK; }
void EXPORT(FreeSlaveInstance)(fmi1Component c) { ((Slave *)c)->use.freeMemory(c); }

fmi1Status EXPORT(DoStep)(fmi1Component c, fmi1Real t, fmi1Real h, fmi1Boolean new_step)
{
    Slave *s = c;
    (void)t;
    if (!s->started || !new_step) return fmi1Error;
    if (s->u > 100) {
        say(s, fmi1Discard, "%s: an input of %.1f is too large", s->u);
        return fmi1Discard;
    }
    if (s->on) { /* a particular solution for u + slope * t, and what is left of the difference to it */
        const double a = s->gain * s->slope, b = s->gain * s->u - a * s->time_constant;
        s->x = b + a * h + (s->x - b) * exp(-h / s->time_constant);
    }
    s->u += s->slope * h;
    s->slope = 0;
    return fmi1OK;
}
fmi1Status EXPORT(SetRealInputDerivatives)(fmi1Component c, const fmi1ValueReference r[], size_t n,
                                           const fmi1Integer order[], const fmi1Real v[])
{
    for (size_t i = 0; i < n; i++)
        if (r[i] == U && order[i] == 1) ((Slave *)c)->slope = v[i]; else return fmi1Error;
    return fmi1OK;
}
fmi1Status EXPORT(GetRealOutputDerivatives)(fmi1Component c, const fmi1ValueReference r[], size_t n,
                                            const fmi1Integer order[], fmi1Real v[])
{
    const Slave *s = c;
    for (size_t i = 0; i < n; i++)
        if (r[i] == X && order[i] == 1) v[i] = (s->gain * s->u - s->x) / s->time_constant; else return fmi1Error;
    return fmi1OK;
}
fmi1Status EXPORT(CancelStep)(fmi1Component c) { (void)c; return fmi1Error; }

static double *real(Slave *s, fmi1ValueReference r) { return r == U ? &s->u : r == X ? &s->x : &s->time_constant; }
fmi1Status EXPORT(GetReal)(fmi1Component c, const fmi1ValueReference r[], size_t n, fmi1Real v[])
{ for (size_t i = 0; i < n; i++) v[i] = *real(c, r[i]); return fmi1OK; }
fmi1Status EXPORT(SetReal)(fmi1Component c, const fmi1ValueReference r[], size_t n, const fmi1Real v[])
{ for (size_t i = 0; i < n; i++) *real(c, r[i]) = v[i]; return fmi1OK; }
#define ACCESS(name, type, get, set) \
    fmi1Status EXPORT(Get##name)(fmi1Component c, const fmi1ValueReference r[], size_t n, type v[]) \
    { Slave *s = c; (void)r; for (size_t i = 0; i < n; i++) get; return fmi1OK; } \
    fmi1Status EXPORT(Set##name)(fmi1Component c, const fmi1ValueReference r[], size_t n, const type v[]) \
    { Slave *s = c; (void)r; for (size_t i = 0; i < n; i++) set; return fmi1OK; }
ACCESS(Integer, fmi1Integer, v[i] = r[i] ? s->mode : s->gain, *(r[i] ? &s->mode : &s->gain) = v[i])
ACCESS(Boolean, fmi1Boolean, v[i] = s->on, s->on = v[i])
ACCESS(String, fmi1String, v[i] = s->label, snprintf(s->label, sizeof s->label, "%s", v[i]))
#define STATUS(kind, type) \
    fmi1Status EXPORT(Get##kind)(fmi1Component c, const fmi1StatusKind k, type *v) { (void)c, (void)k, (void)v; return fmi1Discard; }
STATUS(Status, fmi1Status)
STATUS(RealStatus, fmi1Real)
STATUS(IntegerStatus, fmi1Integer)
STATUS(BooleanStatus, fmi1Boolean)
STATUS(StringStatus, fmi1String)
