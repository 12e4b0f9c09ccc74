/* FMI 2.0, for co-simulation and for model exchange: a thin layer that turns failures into a status and a message to
   the environment's logger. */
#include "fmi2.h"

#include <stdlib.h>
#include <string.h>

#include "interface.h"

/* Tells the environment the recorded message, if there is something to tell; returns the status. */
static fmi2Status answer(struct instance *m, int outcome)
{
    char text[2 * sizeof m->message];
    size_t length = 0;
    fmi2Status status = (fmi2Status)outcome;
    if (status == fmi2OK || m->logger == NULL)
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
    const char *trouble = refusal(name, guid);
    struct instance *m = trouble == NULL ? instance_new(name, type == fmi2ModelExchange) : NULL;
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
    (void)has_stop, (void)stop;
    return answer(c, begin(c, __func__, has_tolerance, tolerance, start));
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return answer(c, move_on(c, __func__, WHEN(INSTANTIATED), INITIALIZING));
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return answer(c, exit_initialization(c, __func__));
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    return answer(c, move_on(c, __func__, WHEN(STEPPING) | EXCHANGING, TERMINATED));
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    instance_reset(c);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[])
{
    return answer(c, get_values(c, vr, count, value) == 0 ? DONE : FAILED);
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[])
{
    return answer(c, assign(c, __func__, vr, count, value));
}

/* All variables of this model are Real. */
static fmi2Status only_reals(struct instance *m, size_t count)
{
    if (count == 0)
        return fmi2OK;
    fail(m, "this model has Real variables only");
    return answer(m, FAILED);
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
    return answer(c, save_state(c, saved));
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate saved)
{
    return answer(c, restore_state(c, saved));
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
    return answer(c, serialize(c, saved, bytes, size));
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *saved)
{
    return answer(c, deserialize(c, bytes, size, saved));
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                               const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                               fmi2Real sensitivity[])
{
    return answer(c, directional(c, __func__, unknown, unknowns, known, knowns, seed, sensitivity));
}

EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    return answer(c, move_on(c, __func__, EXCHANGING, EVENT));
}

/* All events that are due happen in this one call. */
EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    int happened = 0;
    memset(info, 0, sizeof *info);
    int outcome = update_discrete_states(c, __func__, &happened);
    info->valuesOfContinuousStatesChanged = happened;
    return answer(c, outcome);
}

EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    return answer(c, move_on(c, __func__, WHEN(EVENT), CONTINUOUS));
}

EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_rollback, fmi2Boolean *event,
                                              fmi2Boolean *terminate)
{
    (void)no_rollback;
    *event = *terminate = fmi2False;
    return answer(c, move_on(c, __func__, WHEN(CONTINUOUS), CONTINUOUS));
}

EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    return answer(c, set_time(c, __func__, time));
}

EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t count)
{
    return answer(c, set_states(c, __func__, x, count));
}

EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t count)
{
    return answer(c, get_states(c, __func__, x, count));
}

EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominal[], size_t count)
{
    return answer(c, get_nominals(c, nominal, count));
}

EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivative[], size_t count)
{
    return answer(c, get_derivatives(c, __func__, derivative, count));
}

EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicator[], size_t count)
{
    return answer(c, get_indicators(c, __func__, indicator, count));
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                              const fmi2Integer order[], const fmi2Real value[])
{
    return answer(c, input_derivatives(c, __func__, vr, count, order, value));
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                               const fmi2Integer order[], fmi2Real value[])
{
    return answer(c, output_derivatives(c, __func__, vr, count, order, value));
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real size, fmi2Boolean no_rollback)
{
    (void)no_rollback;
    return answer(c, step(c, __func__, from, size));
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    fail(c, "steps are not asynchronous, so there is none to cancel");
    return answer(c, FAILED);
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
