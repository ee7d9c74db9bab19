/* FMI 2.0 for co-simulation. */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "unit.h"

#define UNUSED(name) (void)(name)

typedef struct {
    unit_memory memory;
    const fmi2CallbackFunctions *callbacks;
    char name[64];
} instance;

static fmi2Status refuse(fmi2Component c, const char *why)
{
    const instance *const one = c;
    if ((one != NULL) && (one->callbacks != NULL) && (one->callbacks->logger != NULL)) {
        one->callbacks->logger(one->callbacks->componentEnvironment, one->name, fmi2Error,
                               "logStatusError", "%s", why);
    }
    return fmi2Error;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(
    fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    UNUSED(c), UNUSED(on), UNUSED(count), UNUSED(categories);
    return fmi2OK; /* errors only, and always */
}

fmi2Component fmi2Instantiate(
    fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    UNUSED(resources), UNUSED(visible), UNUSED(logging);
    if ((type != fmi2CoSimulation) || (guid == NULL) || (strcmp(guid, UNIT_TOKEN) != 0)) {
        return NULL;
    }
    instance *const one = calloc(1, sizeof(instance));
    if (one != NULL) {
        one->callbacks = callbacks;
        strncpy(one->name, (name != NULL) ? name : "", sizeof(one->name) - 1U);
        unit_reset(&one->memory);
    }
    return one;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(
    fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
    fmi2Boolean stop_defined, fmi2Real stop)
{
    UNUSED(tolerance_defined), UNUSED(tolerance), UNUSED(stop_defined), UNUSED(stop);
    ((instance *)c)->memory.time = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    UNUSED(c);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    if (!unit_start(&((instance *)c)->memory)) {
        return refuse(c, "an input or load_force is outside the accepted limits");
    }
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    ((instance *)c)->memory.running = 0;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    unit_reset(&((instance *)c)->memory);
    return fmi2OK;
}

fmi2Status fmi2GetReal(
    fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Real values[])
{
    for (size_t i = 0; i < count; i++) {
        if (!unit_get_real(&((instance *)c)->memory, references[i], &values[i])) {
            return refuse(c, "a value reference is no real");
        }
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(
    fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Integer values[])
{
    for (size_t i = 0; i < count; i++) {
        if (!unit_get_integer(&((instance *)c)->memory, references[i], &values[i])) {
            return refuse(c, "a value reference is no integer");
        }
    }
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(
    fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2Boolean values[])
{
    for (size_t i = 0; i < count; i++) {
        if (!unit_get_boolean(&((instance *)c)->memory, references[i], &values[i])) {
            return refuse(c, "a value reference is no boolean");
        }
    }
    return fmi2OK;
}

fmi2Status fmi2GetString(
    fmi2Component c, const fmi2ValueReference references[], size_t count, fmi2String values[])
{
    UNUSED(references), UNUSED(values);
    return (count == 0U) ? fmi2OK : refuse(c, "there are no strings");
}

fmi2Status fmi2SetReal(
    fmi2Component c, const fmi2ValueReference references[], size_t count, const fmi2Real values[])
{
    for (size_t i = 0; i < count; i++) {
        if (!unit_set_real(&((instance *)c)->memory, references[i], values[i])) {
            return refuse(c, "a value reference is no real that may be set now");
        }
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(
    fmi2Component c, const fmi2ValueReference references[], size_t count,
    const fmi2Integer values[])
{
    UNUSED(references), UNUSED(values);
    return (count == 0U) ? fmi2OK : refuse(c, "no integer may be set");
}

fmi2Status fmi2SetBoolean(
    fmi2Component c, const fmi2ValueReference references[], size_t count,
    const fmi2Boolean values[])
{
    UNUSED(references), UNUSED(values);
    return (count == 0U) ? fmi2OK : refuse(c, "no boolean may be set");
}

fmi2Status fmi2SetString(
    fmi2Component c, const fmi2ValueReference references[], size_t count, const fmi2String values[])
{
    UNUSED(references), UNUSED(values);
    return (count == 0U) ? fmi2OK : refuse(c, "there are no strings");
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(unit_memory));
    }
    if (*state == NULL) {
        return refuse(c, "there is no memory for another state");
    }
    memcpy(*state, &((instance *)c)->memory, sizeof(unit_memory));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    if (state == NULL) {
        return refuse(c, "there is no state to set");
    }
    memcpy(&((instance *)c)->memory, state, sizeof(unit_memory));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    UNUSED(c);
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    UNUSED(state), UNUSED(size);
    return refuse(c, "states are not serialized");
}

fmi2Status fmi2SerializeFMUstate(
    fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    UNUSED(state), UNUSED(bytes), UNUSED(size);
    return refuse(c, "states are not serialized");
}

fmi2Status fmi2DeSerializeFMUstate(
    fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    UNUSED(bytes), UNUSED(size), UNUSED(state);
    return refuse(c, "states are not serialized");
}

fmi2Status fmi2GetDirectionalDerivative(
    fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
    const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[], fmi2Real found[])
{
    UNUSED(unknown), UNUSED(unknowns), UNUSED(known), UNUSED(knowns), UNUSED(seed), UNUSED(found);
    return refuse(c, "there are no derivatives");
}

fmi2Status fmi2SetRealInputDerivatives(
    fmi2Component c, const fmi2ValueReference references[], size_t count,
    const fmi2Integer order[], const fmi2Real values[])
{
    UNUSED(references), UNUSED(count), UNUSED(order), UNUSED(values);
    return refuse(c, "inputs are sampled, not interpolated");
}

fmi2Status fmi2GetRealOutputDerivatives(
    fmi2Component c, const fmi2ValueReference references[], size_t count,
    const fmi2Integer order[], fmi2Real values[])
{
    UNUSED(references), UNUSED(count), UNUSED(order), UNUSED(values);
    return refuse(c, "there are no derivatives");
}

fmi2Status fmi2DoStep(
    fmi2Component c, fmi2Real point, fmi2Real step, fmi2Boolean no_earlier_state)
{
    UNUSED(point), UNUSED(no_earlier_state);
    if (!unit_step(&((instance *)c)->memory, step)) {
        return refuse(c, "the communication step must be a whole multiple of T_S,fast, after initialization");
    }
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) { return refuse(c, "steps are not asynchronous"); }

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    UNUSED(kind), UNUSED(value);
    return refuse(c, "steps are not asynchronous");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime) {
        return refuse(c, "steps are not asynchronous");
    }
    *value = ((instance *)c)->memory.time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    UNUSED(kind), UNUSED(value);
    return refuse(c, "steps are not asynchronous");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (kind != fmi2Terminated) {
        return refuse(c, "steps are not asynchronous");
    }
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    UNUSED(kind), UNUSED(value);
    return refuse(c, "steps are not asynchronous");
}
