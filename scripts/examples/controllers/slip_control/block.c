/* FMI 2.0 for co-simulation around a block (block.h), with all functions that the standard asks for.
 *
 * The whole memory of an instance is one array of numbers; value references are its indices.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "block.h"
#include "fmi2Functions.h"
#include "variables.h"

typedef struct {
    double values[VARIABLES];
    char *name;
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment environment;
    fmi2Boolean stepping; /* initialized, and not terminated */
} Instance;

static fmi2Status fail(Instance *block, const char *message)
{
    if (block->log)
        block->log(block->environment, block->name, fmi2Error, "logStatusError", message);
    return fmi2Error;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *block = calloc(1, sizeof *block);

    if (!block)
        return NULL;
    block->name = strdup(name ? name : "");
    block->log = functions ? functions->logger : NULL;
    block->environment = functions ? functions->componentEnvironment : NULL;
    memcpy(block->values, STARTS, sizeof STARTS);
    if (block->name && type == fmi2CoSimulation && guid && strcmp(guid, GUID) == 0)
        return block;
    fail(block, "not created: it is for co-simulation, with the guid of its modelDescription.xml");
    fmi2FreeInstance(block);
    return NULL;
}

void fmi2FreeInstance(fmi2Component component)
{
    Instance *block = component;

    if (block)
        free(block->name);
    free(block);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    ((Instance *)c)->stepping = fmi2True;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    ((Instance *)c)->stepping = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *block = c;

    memcpy(block->values, STARTS, sizeof STARTS);
    block->stepping = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= VARIABLES)
            return fail(c, "fmi2GetReal: no variable has this value reference");
        value[i] = ((Instance *)c)->values[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= VARIABLES)
            return fail(c, "fmi2SetReal: no variable has this value reference");
        if (!(value[i] >= LEAST[vr[i]] && value[i] <= MOST[vr[i]]))
            return fail(c, "fmi2SetReal: a value is outside the variable's bounds, or not a number");
    }
    for (size_t i = 0; i < n; i++)
        ((Instance *)c)->values[vr[i]] = value[i];
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state_before)
{
    Instance *block = c;

    if (!block->stepping || !(step >= 0.0) || !isfinite(time + step))
        return fail(block, "fmi2DoStep: not initialized, or the step is negative or not a number");
    advance(block->values, time, step);
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (!*state)
        *state = malloc(sizeof(Instance));
    if (!*state)
        return fail(c, "fmi2GetFMUstate: out of memory");
    memcpy(*state, c, sizeof(Instance));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    Instance *block = c;
    const Instance *saved = state;

    memcpy(block->values, saved->values, sizeof block->values);
    block->stepping = saved->stepping;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    free(*state);
    *state = NULL;
    return fmi2OK;
}

/* What a block does not have. */
#define LACKING(function, ...) \
    fmi2Status function(fmi2Component c, __VA_ARGS__) { return fail(c, #function " is not available"); }
#define NONE_OF(function, type)                                                                          \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[])          \
    {                                                                                                    \
        return n == 0 ? fmi2OK : fail(c, #function ": all variables are of type Real");                  \
    }
#define NO_STATUS(function, type)                                                                        \
    fmi2Status function(fmi2Component c, const fmi2StatusKind kind, type *value)                         \
    {                                                                                                    \
        return fmi2Discard;                                                                              \
    }

NONE_OF(fmi2GetInteger, fmi2Integer)
NONE_OF(fmi2GetBoolean, fmi2Boolean)
NONE_OF(fmi2GetString, fmi2String)
NONE_OF(fmi2SetInteger, const fmi2Integer)
NONE_OF(fmi2SetBoolean, const fmi2Boolean)
NONE_OF(fmi2SetString, const fmi2String)
LACKING(fmi2SerializedFMUstateSize, fmi2FMUstate state, size_t *size)
LACKING(fmi2SerializeFMUstate, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
LACKING(fmi2DeSerializeFMUstate, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
LACKING(fmi2GetDirectionalDerivative, const fmi2ValueReference unknown[], size_t unknowns,
        const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[], fmi2Real derivative[])
LACKING(fmi2SetRealInputDerivatives, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], const fmi2Real value[])
LACKING(fmi2GetRealOutputDerivatives, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], fmi2Real value[])
fmi2Status fmi2CancelStep(fmi2Component c) { return fail(c, "fmi2CancelStep: steps are never under way"); }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetRealStatus, fmi2Real)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetBooleanStatus, fmi2Boolean)
NO_STATUS(fmi2GetStringStatus, fmi2String)
