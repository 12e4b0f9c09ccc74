/* FMI 3.0, for co-simulation and for model exchange: a thin layer over the same services as FMI 2.0. All variables are
   Float64 scalars; what the model has none of (clocks, other types, configuration) answers with an error. */
#include "fmi3.h"

#include <stdlib.h>
#include <string.h>

#include "interface.h"

/* Tells the environment the recorded message, if there is something to tell; returns the status. */
static fmi3Status answer(struct instance *m, int outcome)
{
    fmi3Status status = (fmi3Status)outcome;
    if (status != fmi3OK && m->logger != NULL)
        ((fmi3LogMessageCallback)m->logger)(m->environment, status,
                                            status == fmi3Discard ? "logStatusDiscard" : "logStatusError", m->message);
    return status;
}

static fmi3Status absent(struct instance *m, const char *what)
{
    fail(m, "the model has no %s", what);
    return answer(m, FAILED);
}

EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    (void)c, (void)on, (void)count, (void)categories; /* only failures are logged, and those always */
    return fmi3OK;
}

static fmi3Instance instantiate(fmi3String name, fmi3String token, const char *trouble, int exchange,
                                fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
    if (trouble == NULL)
        trouble = refusal(name, token);
    struct instance *m = trouble == NULL ? instance_new(name, exchange) : NULL;
    if (m == NULL) {
        if (logger != NULL)
            logger(environment, fmi3Error, "logStatusError", trouble != NULL ? trouble : "not enough memory");
        return NULL;
    }
    m->logger = (void (*)(void))logger;
    m->environment = environment;
    return m;
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                 fmi3Boolean visible, fmi3Boolean logging,
                                                 fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
    (void)resources, (void)visible, (void)logging;
    return instantiate(name, token, NULL, 1, environment, logger);
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                                fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                                size_t intermediates, fmi3InstanceEnvironment environment,
                                                fmi3LogMessageCallback logger, fmi3IntermediateUpdateCallback update)
{
    (void)resources, (void)visible, (void)logging, (void)early_return, (void)intermediate, (void)intermediates;
    (void)update;
    return instantiate(name, token, event_mode ? "the model has no event mode in co-simulation" : NULL, 0, environment,
                       logger);
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback logger, fmi3ClockUpdateCallback update,
                                                      fmi3LockPreemptionCallback lock,
                                                      fmi3UnlockPreemptionCallback unlock)
{
    (void)resources, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
    return instantiate(name, token, "the model has no clocks for scheduled execution", 0, environment, logger);
}

EXPORT void fmi3FreeInstance(fmi3Instance c)
{
    instance_free(c);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                              fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    (void)has_stop, (void)stop;
    int outcome = begin(c, __func__, has_tolerance, tolerance, start);
    return answer(c, outcome != DONE ? outcome : move_on(c, __func__, WHEN(INSTANTIATED), INITIALIZING));
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    return answer(c, exit_initialization(c, __func__));
}

EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    return answer(c, move_on(c, __func__, EXCHANGING, EVENT));
}

EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    return absent(c, "event mode in co-simulation");
}

EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    return absent(c, "structural parameters");
}

EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    return absent(c, "structural parameters");
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance c)
{
    return answer(c, move_on(c, __func__, WHEN(STEPPING) | EXCHANGING, TERMINATED));
}

EXPORT fmi3Status fmi3Reset(fmi3Instance c)
{
    instance_reset(c);
    return fmi3OK;
}

static int wrong_size(struct instance *m, size_t count, size_t values)
{
    return count == values ? 0
                           : fail(m, "%u scalar variables have %u values, not %u", (unsigned)count, (unsigned)count,
                                  (unsigned)values);
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Float64 value[],
                                 size_t values)
{
    return answer(c, wrong_size(c, count, values) || get_values(c, vr, count, value) != 0 ? FAILED : DONE);
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                 const fmi3Float64 value[], size_t values)
{
    return answer(c, wrong_size(c, count, values) ? FAILED : assign(c, __func__, vr, count, value));
}

#define NO_VARIABLES_OF(TYPE)                                                                                          \
    EXPORT fmi3Status fmi3Get##TYPE(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3##TYPE value[],   \
                                    size_t values)                                                                     \
    {                                                                                                                  \
        (void)vr, (void)value, (void)values;                                                                           \
        return count == 0 ? fmi3OK : absent(c, "variables of type " #TYPE);                                            \
    }                                                                                                                  \
    EXPORT fmi3Status fmi3Set##TYPE(fmi3Instance c, const fmi3ValueReference vr[], size_t count,                       \
                                    const fmi3##TYPE value[], size_t values)                                           \
    {                                                                                                                  \
        (void)vr, (void)value, (void)values;                                                                           \
        return count == 0 ? fmi3OK : absent(c, "variables of type " #TYPE);                                            \
    }

NO_VARIABLES_OF(Float32)
NO_VARIABLES_OF(Int8)
NO_VARIABLES_OF(UInt8)
NO_VARIABLES_OF(Int16)
NO_VARIABLES_OF(UInt16)
NO_VARIABLES_OF(Int32)
NO_VARIABLES_OF(UInt32)
NO_VARIABLES_OF(Int64)
NO_VARIABLES_OF(UInt64)
NO_VARIABLES_OF(Boolean)
NO_VARIABLES_OF(String)

EXPORT fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t count, size_t sizes[],
                                fmi3Binary value[], size_t values)
{
    (void)vr, (void)sizes, (void)value, (void)values;
    return count == 0 ? fmi3OK : absent(c, "variables of type Binary");
}

EXPORT fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t count, const size_t sizes[],
                                const fmi3Binary value[], size_t values)
{
    (void)vr, (void)sizes, (void)value, (void)values;
    return count == 0 ? fmi3OK : absent(c, "variables of type Binary");
}

EXPORT fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Clock value[])
{
    (void)vr, (void)value;
    return count == 0 ? fmi3OK : absent(c, "clocks");
}

EXPORT fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t count, const fmi3Clock value[])
{
    (void)vr, (void)value;
    return count == 0 ? fmi3OK : absent(c, "clocks");
}

EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                         fmi3Float64 interval[], fmi3IntervalQualifier qualifier[])
{
    (void)vr, (void)count, (void)interval, (void)qualifier;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                          fmi3UInt64 counter[], fmi3UInt64 resolution[],
                                          fmi3IntervalQualifier qualifier[])
{
    (void)vr, (void)count, (void)counter, (void)resolution, (void)qualifier;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Float64 shift[])
{
    (void)vr, (void)count, (void)shift;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                       fmi3UInt64 counter[], fmi3UInt64 resolution[])
{
    (void)vr, (void)count, (void)counter, (void)resolution;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                         const fmi3Float64 interval[])
{
    (void)vr, (void)count, (void)interval;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                          const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
{
    (void)vr, (void)count, (void)counter, (void)resolution;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                      const fmi3Float64 shift[])
{
    (void)vr, (void)count, (void)shift;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                       const fmi3UInt64 counter[], const fmi3UInt64 resolution[])
{
    (void)vr, (void)count, (void)counter, (void)resolution;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return absent(c, "clocks");
}

EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *count)
{
    (void)vr, (void)count;
    return absent(c, "arrays, so no dependencies of elements");
}

EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
                                              fmi3ValueReference independent[], size_t elements_independent[],
                                              fmi3DependencyKind kind[], size_t count)
{
    (void)dependent, (void)elements, (void)independent, (void)elements_independent, (void)kind, (void)count;
    return absent(c, "arrays, so no dependencies of elements");
}

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *saved)
{
    return answer(c, save_state(c, saved));
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState saved)
{
    return answer(c, restore_state(c, saved));
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *saved)
{
    (void)c;
    free(*saved);
    *saved = NULL;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState saved, size_t *size)
{
    (void)c, (void)saved;
    *size = sizeof(struct state);
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState saved, fmi3Byte bytes[], size_t size)
{
    return answer(c, serialize(c, saved, bytes, size));
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *saved)
{
    return answer(c, deserialize(c, bytes, size, saved));
}

EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                               const fmi3ValueReference known[], size_t knowns,
                                               const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[],
                                               size_t sensitivities)
{
    int wrong = wrong_size(c, knowns, seeds) || wrong_size(c, unknowns, sensitivities);
    return answer(c, wrong ? FAILED : directional(c, __func__, unknown, unknowns, known, knowns, seed, sensitivity));
}

EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t unknowns,
                                           const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                           size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities)
{
    int wrong = wrong_size(c, unknowns, seeds) || wrong_size(c, knowns, sensitivities);
    return answer(c, wrong ? FAILED : adjoint(c, __func__, unknown, unknowns, known, knowns, seed, sensitivity));
}

EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                           const fmi3Int32 order[], fmi3Float64 value[], size_t values)
{
    return answer(c, wrong_size(c, count, values) ? FAILED : output_derivatives(c, __func__, vr, count, order, value));
}

/* Discrete states change by events only, so there is nothing to be evaluated before they are updated. */
EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    return answer(c, misplaced(c, __func__, WHEN(INITIALIZING) | WHEN(EVENT)) ? FAILED : DONE);
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *needed, fmi3Boolean *terminate,
                                           fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                           fmi3Boolean *next_defined, fmi3Float64 *next)
{
    int happened = 0;
    *needed = *terminate = *nominals_changed = *next_defined = false;
    *next = 0;
    int outcome = update_discrete_states(c, __func__, &happened); /* all that are due, so no more is needed */
    *values_changed = happened != 0;
    return answer(c, outcome);
}

EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
    return answer(c, move_on(c, __func__, WHEN(EVENT), CONTINUOUS));
}

EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_rollback, fmi3Boolean *event,
                                              fmi3Boolean *terminate)
{
    (void)no_rollback;
    *event = *terminate = false;
    return answer(c, move_on(c, __func__, WHEN(CONTINUOUS), CONTINUOUS));
}

EXPORT fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    return answer(c, set_time(c, __func__, time));
}

EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t count)
{
    return answer(c, set_states(c, __func__, x, count));
}

EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t count)
{
    return answer(c, get_states(c, __func__, x, count));
}

EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominal[], size_t count)
{
    return answer(c, get_nominals(c, nominal, count));
}

EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivative[], size_t count)
{
    return answer(c, get_derivatives(c, __func__, derivative, count));
}

EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicator[], size_t count)
{
    return answer(c, get_indicators(c, __func__, indicator, count));
}

EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *count)
{
    (void)c;
    *count = NE;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *count)
{
    (void)c;
    *count = NX;
    return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 from, fmi3Float64 size, fmi3Boolean no_rollback,
                             fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
{
    (void)no_rollback;
    int outcome = step(c, __func__, from, size);
    *event = *terminate = *early = false;
    *last = ((struct instance *)c)->state.time;
    return answer(c, outcome);
}
