/* FMI 3.0 for co-simulation. */
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"
#include "unit.h"

#define UNUSED(name) (void)(name)

typedef struct {
    unit_memory memory;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} instance;

static fmi3Status refuse(fmi3Instance c, const char *why)
{
    const instance *const one = c;
    if ((one != NULL) && (one->log != NULL)) {
        one->log(one->environment, fmi3Error, "logStatusError", why);
    }
    return fmi3Error;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(
    fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    UNUSED(c), UNUSED(on), UNUSED(count), UNUSED(categories);
    return fmi3OK; /* errors only, and always */
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
    const fmi3ValueReference intermediate[], size_t intermediates,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update)
{
    UNUSED(name), UNUSED(resources), UNUSED(visible), UNUSED(logging), UNUSED(early_return);
    UNUSED(intermediate), UNUSED(update);
    if ((token == NULL) || (strcmp(token, UNIT_TOKEN) != 0) || event_mode
        || (intermediates != 0U)) {
        return NULL;
    }
    instance *const one = calloc(1, sizeof(instance));
    if (one != NULL) {
        one->environment = environment;
        one->log = log;
        unit_reset(&one->memory);
    }
    return one;
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    UNUSED(name), UNUSED(token), UNUSED(resources), UNUSED(visible), UNUSED(logging);
    UNUSED(environment), UNUSED(log);
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
    UNUSED(name), UNUSED(token), UNUSED(resources), UNUSED(visible), UNUSED(logging);
    UNUSED(environment), UNUSED(log), UNUSED(update), UNUSED(lock), UNUSED(unlock);
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(
    fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start,
    fmi3Boolean stop_defined, fmi3Float64 stop)
{
    UNUSED(tolerance_defined), UNUSED(tolerance), UNUSED(stop_defined), UNUSED(stop);
    ((instance *)c)->memory.time = start;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    if (!unit_start(&((instance *)c)->memory)) {
        return refuse(c, "an input or load_force is outside the accepted limits");
    }
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    ((instance *)c)->memory.running = 0;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    unit_reset(&((instance *)c)->memory);
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(
    fmi3Instance c, const fmi3ValueReference references[], size_t count, fmi3Float64 values[],
    size_t room)
{
    for (size_t i = 0; i < count; i++) {
        if ((i >= room) || !unit_get_real(&((instance *)c)->memory, references[i], &values[i])) {
            return refuse(c, "a value reference is no Float64");
        }
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(
    fmi3Instance c, const fmi3ValueReference references[], size_t count,
    const fmi3Float64 values[], size_t room)
{
    for (size_t i = 0; i < count; i++) {
        if ((i >= room) || !unit_set_real(&((instance *)c)->memory, references[i], values[i])) {
            return refuse(c, "a value reference is no Float64 that may be set now");
        }
    }
    return fmi3OK;
}

fmi3Status fmi3GetInt32(
    fmi3Instance c, const fmi3ValueReference references[], size_t count, fmi3Int32 values[],
    size_t room)
{
    for (size_t i = 0; i < count; i++) {
        int value = 0;
        if ((i >= room) || !unit_get_integer(&((instance *)c)->memory, references[i], &value)) {
            return refuse(c, "a value reference is no Int32");
        }
        values[i] = value;
    }
    return fmi3OK;
}

fmi3Status fmi3GetBoolean(
    fmi3Instance c, const fmi3ValueReference references[], size_t count, fmi3Boolean values[],
    size_t room)
{
    for (size_t i = 0; i < count; i++) {
        int value = 0;
        if ((i >= room) || !unit_get_boolean(&((instance *)c)->memory, references[i], &value)) {
            return refuse(c, "a value reference is no Boolean");
        }
        values[i] = (value != 0) ? fmi3True : fmi3False;
    }
    return fmi3OK;
}

/* There are no variables of any other type, and none but Float64 may be set. */
#define NO_GETTER(Type)                                                                    \
    fmi3Status fmi3Get##Type(                                                              \
        fmi3Instance c, const fmi3ValueReference references[], size_t count,               \
        fmi3##Type values[], size_t room)                                                  \
    {                                                                                      \
        UNUSED(references), UNUSED(values), UNUSED(room);                                  \
        return (count == 0U) ? fmi3OK : refuse(c, "there are no variables of this type");  \
    }
#define NO_SETTER(Type)                                                                    \
    fmi3Status fmi3Set##Type(                                                              \
        fmi3Instance c, const fmi3ValueReference references[], size_t count,               \
        const fmi3##Type values[], size_t room)                                            \
    {                                                                                      \
        UNUSED(references), UNUSED(values), UNUSED(room);                                  \
        return (count == 0U) ? fmi3OK : refuse(c, "no variable of this type may be set");  \
    }

NO_GETTER(Float32)
NO_GETTER(Int8)
NO_GETTER(UInt8)
NO_GETTER(Int16)
NO_GETTER(UInt16)
NO_GETTER(UInt32)
NO_GETTER(Int64)
NO_GETTER(UInt64)
NO_GETTER(String)
NO_SETTER(Float32)
NO_SETTER(Int8)
NO_SETTER(UInt8)
NO_SETTER(Int16)
NO_SETTER(UInt16)
NO_SETTER(Int32)
NO_SETTER(UInt32)
NO_SETTER(Int64)
NO_SETTER(UInt64)
NO_SETTER(Boolean)
NO_SETTER(String)

fmi3Status fmi3GetBinary(
    fmi3Instance c, const fmi3ValueReference references[], size_t count, size_t sizes[],
    fmi3Binary values[], size_t room)
{
    UNUSED(references), UNUSED(sizes), UNUSED(values), UNUSED(room);
    return (count == 0U) ? fmi3OK : refuse(c, "there are no variables of this type");
}

fmi3Status fmi3SetBinary(
    fmi3Instance c, const fmi3ValueReference references[], size_t count, const size_t sizes[],
    const fmi3Binary values[], size_t room)
{
    UNUSED(references), UNUSED(sizes), UNUSED(values), UNUSED(room);
    return (count == 0U) ? fmi3OK : refuse(c, "no variable of this type may be set");
}

fmi3Status fmi3GetClock(
    fmi3Instance c, const fmi3ValueReference references[], size_t count, fmi3Clock values[])
{
    UNUSED(references), UNUSED(values);
    return (count == 0U) ? fmi3OK : refuse(c, "there are no clocks");
}

fmi3Status fmi3SetClock(
    fmi3Instance c, const fmi3ValueReference references[], size_t count, const fmi3Clock values[])
{
    UNUSED(references), UNUSED(values);
    return (count == 0U) ? fmi3OK : refuse(c, "there are no clocks");
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(unit_memory));
    }
    if (*state == NULL) {
        return refuse(c, "there is no memory for another state");
    }
    memcpy(*state, &((instance *)c)->memory, sizeof(unit_memory));
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
    if (state == NULL) {
        return refuse(c, "there is no state to set");
    }
    memcpy(&((instance *)c)->memory, state, sizeof(unit_memory));
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
    UNUSED(c);
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

fmi3Status fmi3DoStep(
    fmi3Instance c, fmi3Float64 point, fmi3Float64 step, fmi3Boolean no_earlier_state,
    fmi3Boolean *event_needed, fmi3Boolean *terminate, fmi3Boolean *early_return,
    fmi3Float64 *last_time)
{
    UNUSED(point), UNUSED(no_earlier_state);
    instance *const one = c;
    *event_needed = fmi3False;
    *terminate = fmi3False;
    *early_return = fmi3False;
    const int done = unit_step(&one->memory, step);
    *last_time = one->memory.time;
    return done ? fmi3OK
                : refuse(c, "the communication step must be a whole multiple of T_S,fast, after initialization");
}

/* What a co-simulation without events, clocks and derivatives never needs. */
#define NOT_HERE(name, ...)                                           \
    fmi3Status name(__VA_ARGS__)                                      \
    {                                                                 \
        return refuse(c, #name " is not part of this unit");          \
    }
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

NOT_HERE(fmi3EnterEventMode, fmi3Instance c)
NOT_HERE(fmi3EnterConfigurationMode, fmi3Instance c)
NOT_HERE(fmi3ExitConfigurationMode, fmi3Instance c)
NOT_HERE(fmi3EnterStepMode, fmi3Instance c)
NOT_HERE(fmi3EvaluateDiscreteStates, fmi3Instance c)
NOT_HERE(fmi3EnterContinuousTimeMode, fmi3Instance c)
NOT_HERE(fmi3GetNumberOfVariableDependencies, fmi3Instance c, fmi3ValueReference r, size_t *n)
NOT_HERE(
    fmi3GetVariableDependencies, fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
    fmi3ValueReference independents[], size_t sources[], fmi3DependencyKind kinds[], size_t n)
NOT_HERE(fmi3SerializedFMUStateSize, fmi3Instance c, fmi3FMUState state, size_t *size)
NOT_HERE(fmi3SerializeFMUState, fmi3Instance c, fmi3FMUState state, fmi3Byte b[], size_t size)
NOT_HERE(
    fmi3DeserializeFMUState, fmi3Instance c, const fmi3Byte b[], size_t size, fmi3FMUState *state)
NOT_HERE(
    fmi3GetDirectionalDerivative, fmi3Instance c, const fmi3ValueReference u[], size_t nu,
    const fmi3ValueReference k[], size_t nk, const fmi3Float64 seed[], size_t ns,
    fmi3Float64 found[], size_t nf)
NOT_HERE(
    fmi3GetAdjointDerivative, fmi3Instance c, const fmi3ValueReference u[], size_t nu,
    const fmi3ValueReference k[], size_t nk, const fmi3Float64 seed[], size_t ns,
    fmi3Float64 found[], size_t nf)
NOT_HERE(
    fmi3GetIntervalDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NOT_HERE(
    fmi3GetIntervalFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
NOT_HERE(
    fmi3GetShiftDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    fmi3Float64 shifts[])
NOT_HERE(
    fmi3GetShiftFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NOT_HERE(
    fmi3SetIntervalDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    const fmi3Float64 intervals[])
NOT_HERE(
    fmi3SetIntervalFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_HERE(
    fmi3SetShiftDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    const fmi3Float64 shifts[])
NOT_HERE(
    fmi3SetShiftFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_HERE(
    fmi3UpdateDiscreteStates, fmi3Instance c, fmi3Boolean *more, fmi3Boolean *terminate,
    fmi3Boolean *nominals, fmi3Boolean *states, fmi3Boolean *defined, fmi3Float64 *next)
NOT_HERE(
    fmi3CompletedIntegratorStep, fmi3Instance c, fmi3Boolean no_earlier_state,
    fmi3Boolean *event_mode, fmi3Boolean *terminate)
NOT_HERE(fmi3SetTime, fmi3Instance c, fmi3Float64 time)
NOT_HERE(fmi3SetContinuousStates, fmi3Instance c, const fmi3Float64 x[], size_t n)
NOT_HERE(fmi3GetContinuousStateDerivatives, fmi3Instance c, fmi3Float64 dx[], size_t n)
NOT_HERE(fmi3GetEventIndicators, fmi3Instance c, fmi3Float64 z[], size_t n)
NOT_HERE(fmi3GetContinuousStates, fmi3Instance c, fmi3Float64 x[], size_t n)
NOT_HERE(fmi3GetNominalsOfContinuousStates, fmi3Instance c, fmi3Float64 x[], size_t n)
NOT_HERE(fmi3GetNumberOfEventIndicators, fmi3Instance c, size_t *n)
NOT_HERE(fmi3GetNumberOfContinuousStates, fmi3Instance c, size_t *n)
NOT_HERE(
    fmi3GetOutputDerivatives, fmi3Instance c, const fmi3ValueReference r[], size_t n,
    const fmi3Int32 orders[], fmi3Float64 values[], size_t room)
NOT_HERE(
    fmi3ActivateModelPartition, fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
