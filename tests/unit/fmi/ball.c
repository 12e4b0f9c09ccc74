/* A ball that falls and bounces as somebody else would write it, against the headers of the standard: h' = v, v' = -g
   with a state event at h = 0, a time event at `kick_time` that adds to v in three iterations, a step event above
   `ceiling`, which stops the ball, an end asked for at `end`, and the input `wind` as an acceleration.
   With -DFMI=2 an FMU for model exchange of FMI 2, with -DFMI=3 one of FMI 3 for model exchange and co-simulation. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#if FMI == 2
#include "fmi2Functions.h"
typedef fmi2Status status_t;
typedef fmi2Boolean flag_t;
#define OK fmi2OK
#define WRONG fmi2Error
#define F(name) fmi2##name
#else
#include "fmi3Functions.h"
typedef fmi3Status status_t;
typedef bool flag_t;
#define OK fmi3OK
#define WRONG fmi3Error
#define F(name) fmi3##name
#endif

enum { TIME, H, V, A, G, E, KICK_TIME, KICK, WIND, BOUNCES, CEILING, END, LAST, CAUGHT, NAP, VARIABLES };
typedef struct {
    double x[VARIABLES];
    int bounces, kicked, events, slave, ended, steps;
#if FMI == 3
    double grid[6];
    unsigned char blob[8];
    size_t blob_size;
    char label[32];
    signed char small;
    long long mode;
    bool on;
    fmi3LogMessageCallback log;
#endif
} Ball;

static double acceleration(const Ball *b) { return -b->x[G] + b->x[WIND]; }
static void *new_ball(void)
{
    Ball *b = calloc(1, sizeof *b);
    b->x[H] = 1, b->x[G] = 9.81, b->x[E] = 0.7, b->x[KICK_TIME] = b->x[CEILING] = b->x[END] = 1e9;
    return b;
}
static int too_high(const Ball *b) { return b->x[CAUGHT] == 0 && b->x[H] > b->x[CEILING]; }
static double next_event(const Ball *b) { return b->kicked ? b->x[END] : fmin(b->x[KICK_TIME], b->x[END]); }
static int bounce(Ball *b)
{
    int changed = 0;
    if (b->x[H] <= 0 && b->x[V] < 0) {
        b->x[H] = 0;
        b->x[V] *= -b->x[E];
        b->bounces++;
        b->x[LAST] = b->x[TIME];
        changed = 1;
    }
    if (b->kicked < 3 && b->x[TIME] >= b->x[KICK_TIME]) { /* a third in each of three iterations */
        b->x[V] += b->x[KICK] / 3;
        b->kicked++;
        changed = 1;
    }
    if (too_high(b)) {
        b->x[V] = 0;
        b->x[CAUGHT] = b->x[TIME];
        changed = 1;
    }
    b->ended = b->x[TIME] >= b->x[END];
    b->events++;
    return changed;
}
static double value(const Ball *b, unsigned r) { return r == A ? acceleration(b) : r == BOUNCES ? b->bounces : r == VARIABLES ? b->steps : b->x[r]; }

status_t F(SetTime)(void *c, double t) { ((Ball *)c)->x[TIME] = t; return OK; }
status_t F(SetContinuousStates)(void *c, const double x[], size_t n)
{ if (n != 2) return WRONG; memcpy(&((Ball *)c)->x[H], x, sizeof(double) * 2); return OK; }
status_t F(GetContinuousStates)(void *c, double x[], size_t n)
{ if (n != 2) return WRONG; memcpy(x, &((Ball *)c)->x[H], sizeof(double) * 2); return OK; }
status_t F(GetNominalsOfContinuousStates)(void *c, double x[], size_t n)
{ (void)c; for (size_t i = 0; i < n; i++) x[i] = 1; return OK; }
status_t F(GetEventIndicators)(void *c, double z[], size_t n)
{ if (n != 1) return WRONG; z[0] = ((Ball *)c)->x[H]; return OK; }
status_t F(EnterEventMode)(void *c) { (void)c; return OK; }
status_t F(EnterContinuousTimeMode)(void *c) { (void)c; return OK; }
status_t F(ExitInitializationMode)(void *c) { (void)c; return OK; }
status_t F(Terminate)(void *c) { (void)c; return OK; }
status_t F(Reset)(void *c) { (void)c; return OK; }
void F(FreeInstance)(void *c) { free(c); }
static status_t derivatives(void *c, double d[], size_t n)
{ if (n != 2) return WRONG; d[0] = ((Ball *)c)->x[V]; d[1] = acceleration(c); return OK; }

#if FMI == 2
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String s[])
{ (void)c, (void)on, (void)n, (void)s; return OK; }
fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *f, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)name, (void)guid, (void)resources, (void)f, (void)visible, (void)logging;
    return type == fmi2ModelExchange ? new_ball() : NULL;
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real t, fmi2Boolean d, fmi2Real e)
{ (void)a, (void)b, (void)d, (void)e; ((Ball *)c)->x[TIME] = t; return OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return OK; }
fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real d[], size_t n) { return derivatives(c, d, n); }
fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean n, fmi2Boolean *event, fmi2Boolean *end)
{ (void)n; *event = too_high(c), *end = 0; return OK; }
fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *i)
{
    Ball *b = c;
    memset(i, 0, sizeof *i);
    i->valuesOfContinuousStatesChanged = i->newDiscreteStatesNeeded = bounce(b);
    i->terminateSimulation = b->ended;
    i->nextEventTimeDefined = !b->ended;
    i->nextEventTime = next_event(b);
    return OK;
}
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[])
{ for (size_t i = 0; i < n; i++) v[i] = value(c, r[i]); return OK; }
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[])
{ for (size_t i = 0; i < n; i++) ((Ball *)c)->x[r[i]] = v[i]; return OK; }
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer v[])
{ (void)r; for (size_t i = 0; i < n; i++) v[i] = ((Ball *)c)->bounces; return OK; }
#define NOTHING(name, type) \
    fmi2Status name(fmi2Component c, const fmi2ValueReference r[], size_t n, type v[]) \
    { (void)c, (void)r, (void)v; return n ? WRONG : OK; }
NOTHING(fmi2SetInteger, const fmi2Integer)
NOTHING(fmi2GetBoolean, fmi2Boolean)
NOTHING(fmi2SetBoolean, const fmi2Boolean)
NOTHING(fmi2GetString, fmi2String)
NOTHING(fmi2SetString, const fmi2String)
#else
const char *fmi3GetVersion(void) { return fmi3Version; }
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String s[])
{ (void)c, (void)on, (void)n, (void)s; return OK; }
static fmi3Instance make(fmi3String name, fmi3String token, fmi3String resources, fmi3LogMessageCallback log, int slave)
{
    if (strcmp(token, "{ball}") != 0) {
        log(NULL, fmi3Error, "logStatusError", "wrong instantiation token");
        return NULL;
    }
    Ball *b = new_ball();
    b->slave = slave;
    b->log = log;
    strcpy(b->label, resources ? "with resources" : name);
    memcpy(b->blob, "\0\377", b->blob_size = 2);
    b->small = -128, b->mode = 1, b->on = true;
    for (int i = 0; i < 6; i++) b->grid[i] = i;
    return b;
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment e, fmi3LogMessageCallback log)
{ (void)visible, (void)logging, (void)e; return make(name, token, resources, log, 0); }
fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n, fmi3InstanceEnvironment e,
                                         fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)visible, (void)logging, (void)required, (void)n, (void)e, (void)update;
    return events && early ? make(name, token, resources, log, 1) : NULL;
}
fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean a, fmi3Float64 b, fmi3Float64 t, fmi3Boolean d,
                                       fmi3Float64 e)
{ (void)a, (void)b, (void)d, (void)e; ((Ball *)c)->x[TIME] = t; return OK; }
fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 d[], size_t n) { return derivatives(c, d, n); }
fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean n, fmi3Boolean *event, fmi3Boolean *end)
{ (void)n; *event = too_high(c), *end = false; return OK; }
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n) { (void)c; *n = 2; return OK; }
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n) { (void)c; *n = 1; return OK; }
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *end, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next)
{
    Ball *b = c;
    *again = *values = bounce(b);
    *nominals = false;
    *end = b->ended;
    *defined = !b->ended;
    *next = next_event(b);
    return OK;
}
fmi3Status fmi3EnterStepMode(fmi3Instance c) { (void)c; return OK; }
/* Exact, up to the ground at most, where it returns early and asks for event mode. */
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean n, fmi3Boolean *event, fmi3Boolean *end,
                      fmi3Boolean *early, fmi3Float64 *last)
{
    Ball *b = c;
    (void)n;
    if (b->x[WIND] > 100) {
        b->log(NULL, fmi3Discard, "logStatusDiscard", "blown away");
        return fmi3Discard;
    }
    const double a = acceleration(b), to_ground = (b->x[V] + sqrt(b->x[V] * b->x[V] - 2 * a * b->x[H])) / -a;
    *event = *early = to_ground < h;
    *end = t + h >= b->x[END];
    if (*early) h = to_ground;
    if (b->x[NAP] > 0 && h > b->x[NAP]) { /* early, without an event */
        h = b->x[NAP];
        *early = true;
        *event = false;
    }
    b->steps++;
    b->x[H] += h * b->x[V] + a * h * h / 2;
    b->x[V] += a * h;
    if (*event) b->x[H] = 0;
    *last = b->x[TIME] = t + h;
    return OK;
}
fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t m)
{
    Ball *b = c;
    size_t j = 0;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == 20) memcpy(v + j, b->grid, sizeof b->grid), j += 6;
        else v[j++] = value(b, r[i]);
    }
    return j == m ? OK : WRONG;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[], size_t m)
{
    Ball *b = c;
    size_t j = 0;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == 20) memcpy(b->grid, v + j, sizeof b->grid), j += 6;
        else b->x[r[i]] = v[j++];
    }
    return j == m ? OK : WRONG;
}
#define ACCESS(name, type, field) \
    fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference r[], size_t n, type v[], size_t m) \
    { (void)r, (void)n; for (size_t i = 0; i < m; i++) v[i] = (type)((Ball *)c)->field; return OK; } \
    fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference r[], size_t n, const type v[], size_t m) \
    { (void)r, (void)n; for (size_t i = 0; i < m; i++) ((Ball *)c)->field = v[i]; return OK; }
ACCESS(Int8, fmi3Int8, small)
ACCESS(Int64, fmi3Int64, mode)
ACCESS(Boolean, fmi3Boolean, on)
ACCESS(Int32, fmi3Int32, bounces)
ACCESS(Float32, fmi3Float32, x[G])
ACCESS(UInt8, fmi3UInt8, events)
ACCESS(Int16, fmi3Int16, events)
ACCESS(UInt16, fmi3UInt16, events)
ACCESS(UInt32, fmi3UInt32, events)
ACCESS(UInt64, fmi3UInt64, events)
fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3String v[], size_t m)
{ (void)r, (void)n; for (size_t i = 0; i < m; i++) v[i] = ((Ball *)c)->label; return OK; }
fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3String v[], size_t m)
{ (void)r, (void)n; for (size_t i = 0; i < m; i++) strncpy(((Ball *)c)->label, v[i], 31); return OK; }
fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t s[], fmi3Binary v[], size_t m)
{ (void)r, (void)n; for (size_t i = 0; i < m; i++) v[i] = ((Ball *)c)->blob, s[i] = ((Ball *)c)->blob_size; return OK; }
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, const size_t s[], const fmi3Binary v[],
                         size_t m)
{
    Ball *b = c;
    (void)r, (void)n;
    for (size_t i = 0; i < m; i++) memcpy(b->blob, v[i], b->blob_size = s[i] < 8 ? s[i] : 8);
    return OK;
}
fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) { *s = malloc(sizeof(Ball)); memcpy(*s, c, sizeof(Ball)); return OK; }
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) { memcpy(c, s, sizeof(Ball)); return OK; }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) { (void)c; free(*s); *s = NULL; return OK; }
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState s, size_t *n) { (void)c, (void)s; *n = sizeof(Ball); return OK; }
fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState s, fmi3Byte b[], size_t n) { (void)c; memcpy(b, s, n); return OK; }
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte b[], size_t n, fmi3FMUState *s)
{ (void)c; if (n != sizeof(Ball)) return WRONG; *s = malloc(n); memcpy(*s, b, n); return OK; }
#endif
