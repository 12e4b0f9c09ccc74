/* An FMU that does what it is told from time `when` on: return a status, give what is no number, or take its time.
   y' = 1; its state can be saved. It logs a reason when it fails. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"

enum { Y, STATUS, WHEN, VALUE, WORK, LONGEST, COUNT };

typedef struct {
    double v[COUNT], t;
    const fmi2CallbackFunctions *environment;
    char name[64];
} Slave;

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String s[])
{ (void)c, (void)on, (void)n, (void)s; return fmi2OK; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *f, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
    Slave *s = calloc(1, sizeof *s);
    s->environment = f;
    s->v[WHEN] = s->v[LONGEST] = 1e9;
    strncpy(s->name, name, sizeof s->name - 1);
    return s;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real t, fmi2Boolean d, fmi2Real e)
{ (void)a, (void)b, (void)d, (void)e; ((Slave *)c)->t = t; return fmi2OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { ((Slave *)c)->t = 0; return fmi2OK; }

static fmi2Status failed(Slave *s, fmi2Status status, const char *reason)
{
    s->environment->logger(s->environment->componentEnvironment, s->name, status, "logStatusError", reason);
    return status;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean n)
{
    Slave *s = c;
    (void)n;
    if (h > s->v[LONGEST] * (1 + 1e-12)) return failed(s, fmi2Discard, "the step is too long");
    const int due = t + h > s->v[WHEN];
    if (due && s->v[STATUS] > 1) return failed(s, (fmi2Status)s->v[STATUS], "the pump has no oil");
    if (due && s->v[WORK] > 0)
        for (const clock_t end = clock() + (clock_t)(s->v[WORK] * CLOCKS_PER_SEC); clock() < end;) {}
    s->t = t + h;
    s->v[Y] = due && s->v[VALUE] != 0 ? log(-s->v[VALUE]) : s->v[Y] + h;
    return fmi2OK;
}
fmi2Status fmi2CancelStep(fmi2Component c) { (void)c; return fmi2Error; }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[])
{ for (size_t i = 0; i < n; ++i) v[i] = ((Slave *)c)->v[r[i]]; return fmi2OK; }
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[])
{ for (size_t i = 0; i < n; ++i) ((Slave *)c)->v[r[i]] = v[i]; return fmi2OK; }

#define NONE(kind, type) \
    fmi2Status fmi2Get##kind(fmi2Component c, const fmi2ValueReference r[], size_t n, type v[]) \
    { (void)c, (void)r, (void)v; return n ? fmi2Error : fmi2OK; } \
    fmi2Status fmi2Set##kind(fmi2Component c, const fmi2ValueReference r[], size_t n, const type v[]) \
    { (void)c, (void)r, (void)v; return n ? fmi2Error : fmi2OK; }
NONE(Integer, fmi2Integer)
NONE(Boolean, fmi2Boolean)
NONE(String, fmi2String)

#define STATUS_OF(kind, type) \
    fmi2Status fmi2Get##kind(fmi2Component c, const fmi2StatusKind k, type *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
STATUS_OF(Status, fmi2Status)
STATUS_OF(RealStatus, fmi2Real)
STATUS_OF(IntegerStatus, fmi2Integer)
STATUS_OF(BooleanStatus, fmi2Boolean)
STATUS_OF(StringStatus, fmi2String)
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[], const fmi2Real v[])
{ (void)c, (void)r, (void)n, (void)o, (void)v; return fmi2Error; }
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[], fmi2Real v[])
{ (void)c, (void)r, (void)n, (void)o, (void)v; return fmi2Error; }
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference a[], size_t n, const fmi2ValueReference b[], size_t m, const fmi2Real d[], fmi2Real v[])
{ (void)c, (void)a, (void)n, (void)b, (void)m, (void)d, (void)v; return fmi2Error; }

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (*state == NULL) *state = malloc(sizeof(Slave));
    memcpy(*state, c, sizeof(Slave));
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) { memcpy(c, state, sizeof(Slave)); return fmi2OK; }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) { (void)c; free(*state); *state = NULL; return fmi2OK; }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{ (void)c, (void)state; *size = offsetof(Slave, environment); return fmi2OK; }
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{ (void)c; memcpy(bytes, state, size); return fmi2OK; }
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    *state = malloc(sizeof(Slave));
    memcpy(*state, c, sizeof(Slave));
    memcpy(*state, bytes, size);
    return fmi2OK;
}
