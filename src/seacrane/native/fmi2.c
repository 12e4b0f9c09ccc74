/* The face of the core to the outside: FMI 2.0 for co-simulation. It checks the order of calls and turns failures into
   a status and a message to the environment's logger. */
#include "fmi2.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core.h"

/* Tells the environment the recorded message; returns the status. */
static fmi2Status report(struct instance *m, fmi2Status status)
{
    char text[2 * sizeof m->message];
    size_t length = 0;
    if (m->logger == NULL)
        return status;
    for (const char *c = m->message; *c != '\0'; c++) { /* the environment may treat it as a printf format */
        if (*c == '%')
            text[length++] = '%';
        text[length++] = *c;
    }
    text[length] = '\0';
    ((fmi2CallbackLogger)m->logger)(m->environment, m->name, status,
                                    status == fmi2Discard ? "logStatusDiscard" : "logStatusError", text);
    return status;
}

static fmi2Status answer(struct instance *m, int failed)
{
    return failed ? report(m, fmi2Error) : fmi2OK;
}

/* Whether `function` may be called now; if not, the message says so. */
static int misplaced(struct instance *m, const char *function, unsigned phases)
{
    static const char *const when[] = {"after fmi2Instantiate", "in initialization mode", "in step mode",
                                       "after fmi2Terminate"};
    if (phases >> m->state.phase & 1u)
        return 0;
    return fail(m, "%s must not be called %s", function, when[m->state.phase]);
}
#define WHEN(phase) (1u << (phase))

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    (void)c, (void)on, (void)count, (void)categories; /* only failures are logged, and those always */
    return fmi2OK;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)resources, (void)visible, (void)logging;
    const char *trouble = NULL;
    if (type != fmi2CoSimulation)
        trouble = "this FMU is for co-simulation only";
    else if (guid == NULL || strcmp(guid, MODEL_GUID) != 0)
        trouble = "the GUID is not the one of this binary, " MODEL_GUID;
    else if (name == NULL || name[0] == '\0')
        trouble = "the instance needs a name";
    struct instance *m = trouble == NULL ? instance_new(name) : NULL;
    if (m == NULL) {
        if (functions != NULL && functions->logger != NULL)
            functions->logger(functions->componentEnvironment, name != NULL ? name : "", fmi2Error, "logStatusError",
                              trouble != NULL ? trouble : "not enough memory");
        return NULL;
    }
    if (functions != NULL) {
        m->logger = (void (*)(void))functions->logger;
        m->environment = functions->componentEnvironment;
    }
    return m;
}

EXPORT void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                                      fmi2Boolean has_stop, fmi2Real stop)
{
    struct instance *m = c;
    (void)has_stop, (void)stop;
    if (misplaced(m, "fmi2SetupExperiment", WHEN(INSTANTIATED)))
        return report(m, fmi2Error);
    if (!isfinite(start))
        return answer(m, fail(m, "the start time is not a finite number"));
    if (has_tolerance && !(tolerance >= 1e-12 && tolerance <= 0.1))
        return answer(m, fail(m, "the tolerance %.3g is outside 1e-12 to 0.1", tolerance));
    if (has_tolerance)
        m->state.setting[TOLERANCE] = tolerance;
    m->state.time = start;
    changed(m);
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    struct instance *m = c;
    if (misplaced(m, "fmi2EnterInitializationMode", WHEN(INSTANTIATED)))
        return report(m, fmi2Error);
    m->state.phase = INITIALIZING;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    struct instance *m = c;
    if (misplaced(m, "fmi2ExitInitializationMode", WHEN(INITIALIZING)) || refresh(m, 0) != 0)
        return report(m, fmi2Error);
    m->state.phase = STEPPING;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    struct instance *m = c;
    if (misplaced(m, "fmi2Terminate", WHEN(STEPPING)))
        return report(m, fmi2Error);
    m->state.phase = TERMINATED;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    instance_reset(c);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[])
{
    return answer(c, get_values(c, vr, count, value));
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[])
{
    struct instance *m = c;
    if (misplaced(m, "fmi2SetReal", WHEN(INSTANTIATED) | WHEN(INITIALIZING) | WHEN(STEPPING)))
        return report(m, fmi2Error);
    return answer(m, set_values(m, vr, count, value));
}

/* All variables of this model are Real. */
static fmi2Status only_reals(struct instance *m, size_t count)
{
    return count == 0 ? fmi2OK : answer(m, fail(m, "this model has Real variables only"));
}

EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Integer value[])
{
    (void)vr, (void)value;
    return only_reals(c, count);
}

EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Boolean value[])
{
    (void)vr, (void)value;
    return only_reals(c, count);
}

EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2String value[])
{
    (void)vr, (void)value;
    return only_reals(c, count);
}

EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                 const fmi2Integer value[])
{
    (void)vr, (void)value;
    return only_reals(c, count);
}

EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                 const fmi2Boolean value[])
{
    (void)vr, (void)value;
    return only_reals(c, count);
}

EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2String value[])
{
    (void)vr, (void)value;
    return only_reals(c, count);
}

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *saved)
{
    struct instance *m = c;
    if (*saved == NULL)
        *saved = malloc(sizeof m->state);
    if (*saved == NULL)
        return answer(m, fail(m, "not enough memory to save the state"));
    memcpy(*saved, &m->state, sizeof m->state);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate saved)
{
    return answer(c, instance_restore(c, saved));
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *saved)
{
    (void)c;
    free(*saved);
    *saved = NULL;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate saved, size_t *size)
{
    (void)c, (void)saved;
    *size = sizeof(struct state);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate saved, fmi2Byte bytes[], size_t size)
{
    if (size < sizeof(struct state))
        return answer(c, fail(c, "a saved state needs %zu bytes", sizeof(struct state)));
    memcpy(bytes, saved, sizeof(struct state));
    return fmi2OK;
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *saved)
{
    struct instance *m = c;
    if (size != sizeof m->state)
        return answer(m, fail(m, "%zu bytes are not a saved state of this model, which has %zu", size, sizeof m->state));
    if (*saved == NULL)
        *saved = malloc(size);
    if (*saved == NULL)
        return answer(m, fail(m, "not enough memory for the state"));
    memcpy(*saved, bytes, size);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                               const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                               fmi2Real sensitivity[])
{
    struct instance *m = c;
    double dy[ROOM(N)] = {0}, du[ROOM(NU)] = {0}, dp[ROOM(NP)] = {0}, df[ROOM(N)] = {0}, doutput[ROOM(NY)] = {0};
    if (misplaced(m, "fmi2GetDirectionalDerivative", WHEN(INITIALIZING) | WHEN(STEPPING)))
        return report(m, fmi2Error);
    for (size_t i = 0; i < knowns; i++) {
        const struct variable *v = find_variable(known[i]);
        double *direction = v == NULL ? NULL : v->kind == STATE ? dy : v->kind == INPUT ? du : v->kind == PARAMETER ? dp : NULL;
        if (direction == NULL)
            return answer(m, fail(m, "value reference %u is no state, input or parameter", known[i]));
        direction[v->index] += seed[i];
    }
    if (evaluate_directional(m, dy, du, dp, df, doutput) != 0)
        return report(m, fmi2Error);
    for (size_t i = 0; i < unknowns; i++) {
        const struct variable *v = find_variable(unknown[i]);
        if (v == NULL || (v->kind != DERIVATIVE && v->kind != OUTPUT))
            return answer(m, fail(m, "value reference %u is no output or state derivative", unknown[i]));
        sensitivity[i] = (v->kind == OUTPUT ? doutput : df)[v->index];
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                              const fmi2Integer order[], const fmi2Real value[])
{
    for (size_t i = 0; i < count; i++)
        if (order[i] != 1)
            return answer(c, fail(c, "inputs are interpolated to first order only"));
    return answer(c, set_slopes(c, vr, count, value));
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                               const fmi2Integer order[], fmi2Real value[])
{
    (void)vr, (void)order, (void)value;
    return count == 0 ? fmi2OK : answer(c, fail(c, "output derivatives are not provided"));
}

/* A step that cannot be done is discarded: the slave is left at fmi2LastSuccessfulTime, with its values there. */
EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real size, fmi2Boolean no_rollback)
{
    struct instance *m = c;
    (void)no_rollback;
    if (misplaced(m, "fmi2DoStep", WHEN(STEPPING)))
        return report(m, fmi2Error);
    if (!(size > 0) || !isfinite(from + size))
        return answer(m, fail(m, "the step size %g s is not a positive number", size));
    if (!(fabs(from - m->state.time) <= 1e-9 * fmax(1, fabs(from)) + 1e-6 * size))
        return answer(m, fail(m, "a step from t = %.12g s was asked for, but the model is at t = %.12g s", from,
                              m->state.time));
    m->state.time = from;
    return integrate(m, from + size) == 0 ? fmi2OK : report(m, fmi2Discard);
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return answer(c, fail(c, "steps are not asynchronous, so there is none to cancel"));
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime)
        return fmi2Discard;
    *value = ((struct instance *)c)->state.time;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)c;
    if (kind != fmi2Terminated)
        return fmi2Discard;
    *value = fmi2False;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}
