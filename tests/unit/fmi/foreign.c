/* A slave as somebody else would write one, against the headers of the standard, with variables of all types:
   x' = gain * u while enabled, u with its slope; it logs with a printf format, and fails when u is above 100. */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

typedef struct {
    double u, slope, x, t;
    int gain, enabled, freed;
    char label[64];
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
    (void)type, (void)guid, (void)visible, (void)logging;
    if (strstr(name, "refuse") != NULL) {
        f->logger(f->componentEnvironment, name, fmi2Error, "logStatusError", "no licence for %s", name);
        return NULL;
    }
    Slave *s = f->allocateMemory(1, sizeof *s);
    s->environment = f;
    s->gain = 2;
    s->enabled = fmi2True;
    strncpy(s->label, strncmp(resources, "file:", 5) == 0 ? "tank" : "no resources", sizeof s->label - 1);
    strncpy(s->name, name, sizeof s->name - 1);
    return s;
}
void fmi2FreeInstance(fmi2Component c)
{
    Slave *s = c;
    s->environment->logger(s->environment->componentEnvironment, s->name, fmi2OK, "logAll", "freed");
    s->environment->freeMemory(c);
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real t, fmi2Boolean d, fmi2Real e)
{ (void)a, (void)b, (void)d, (void)e; ((Slave *)c)->t = t; return fmi2OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { (void)c; return fmi2Warning; }
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { ((Slave *)c)->x = 0; return fmi2OK; }
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean n)
{
    Slave *s = c;
    (void)t, (void)n;
    if (s->u > 100) {
        s->environment->logger(s->environment->componentEnvironment, s->name, fmi2Discard, "logStatusDiscard",
                               "overflow of the tank");
        return fmi2Discard;
    }
    s->x += s->enabled ? h * s->gain * (s->u + h / 2 * s->slope) : 0;
    return fmi2OK;
}
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real v[])
{
    for (size_t i = 0; i < n; i++) v[i] = vr[i] == 0 ? ((Slave *)c)->u : ((Slave *)c)->x;
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real v[])
{
    for (size_t i = 0; i < n; i++) if (vr[i] == 0) ((Slave *)c)->u = v[i]; else return fmi2Error;
    return fmi2OK;
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real v[])
{
    for (size_t i = 0; i < n; i++) if (vr[i] == 0 && order[i] == 1) ((Slave *)c)->slope = v[i]; else return fmi2Error;
    return fmi2OK;
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer v[])
{ (void)vr; for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->gain; return fmi2OK; }
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer v[])
{ (void)vr; for (size_t i = 0; i < n; i++) ((Slave *)c)->gain = v[i]; return fmi2OK; }
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean v[])
{ (void)vr; for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->enabled; return fmi2OK; }
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean v[])
{ (void)vr; for (size_t i = 0; i < n; i++) ((Slave *)c)->enabled = v[i]; return fmi2OK; }
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String v[])
{ (void)vr; for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->label; return fmi2OK; }
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String v[])
{ (void)vr; for (size_t i = 0; i < n; i++) strncpy(((Slave *)c)->label, v[i], 63); return fmi2OK; }
