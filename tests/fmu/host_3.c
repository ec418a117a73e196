/*
 * As host.c, with the functions of FMI 3.0:
 *
 *   fmu_host_3 LIBRARY RESOURCES TOKEN SEED CALLS WAY...
 */
#include "host_3.h"

#define COUNT FUNCTION_3_COUNT
#define FUNCTION_NAMES NAMES_3
#include "random.h"

enum { WHEELS = 8, ROOM = 4 * MOST, TIME = 400 };

static const char *load_functions(const char *path) { return load_3(path); }

static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    take_note(environment, status, category, message);
}

static fmi3Instance instantiate(struct actor *a, enum function_3 function) {
    static const char *const places[] = {"", "rubbish", "/nowhere/%20/", NULL};
    static const fmi3ValueReference required = UGV_VR_X;
    const char *token = percent(&a->random, 3) ? "{0}" : guid;
    const char *place = percent(&a->random, 50) ? resources : places[below(&a->random, 4)];
    const char *name = percent(&a->random, 95) ? "random" : NULL;
    fmi3LogMessageCallback log = percent(&a->random, 90) ? logger : NULL;
    int on = percent(&a->random, 80), events = percent(&a->random, 50), variables = percent(&a->random, 3);
    if (function == F3_InstantiateScheduledExecution)
        return fmu3.InstantiateScheduledExecution(name, token, place, 0, on, a, log, NULL, NULL, NULL);
    return function == F3_InstantiateModelExchange
               ? fmu3.InstantiateModelExchange(name, token, place, 0, on, a, log)
               : fmu3.InstantiateCoSimulation(name, token, place, 0, on, events, 1, &required, (size_t)variables, a, log, NULL);
}

/* The values that variables have: mostly as many as they need. */
static size_t values_of(struct actor *a, const unsigned *known, size_t count) {
    size_t values = 0;
    for (size_t k = 0; known && k < count; k++)
        values += known[k] >= 2000 && known[k] < 2016 ? WHEELS : known[k] == 1000 ? WHEELS / 2 : 1;
    return percent(&a->random, 95) ? values : below(&a->random, ROOM);
}

/* As reference, of arrays: the first elements of rows and wheels stand for all. */
static unsigned *array_references(struct actor *a, size_t count, int inputs) {
    unsigned *known = references(a, count, inputs);
    for (size_t k = 0; known && k < count; k++) {
        if (known[k] >= 2000 && known[k] < 2200 && percent(&a->random, 90)) known[k] = 2000 + known[k] % 16;
        if (known[k] >= 1000 && known[k] < 1010 && percent(&a->random, 90)) known[k] = 1000;
        if (!inputs && percent(&a->random, 5)) known[k] = TIME;
    }
    return known;
}

/* Steps, to where the instance has come; some of the results have nowhere to go. */
static fmi3Status do_step(struct actor *a, struct slot *slot, fmi3Instance c) {
    bool flags[3] = {1, 1, 1}, *places[3];
    double step = pow(10.0, uniform(&a->random, -6.0, -2.5)), reached = slot->time;
    for (int k = 0; k < 3; k++) places[k] = percent(&a->random, 1) ? NULL : &flags[k];
    if (percent(&a->random, 5)) step = real(&a->random, 1e-3);
    /* Drives on for as long as it is told, and 1e300 s is very long. */
    if (step > 1.0 && step < INFINITY) step = -step;
    double point = percent(&a->random, 95) ? slot->time : real(&a->random, 1.0);
    fmi3Status status = fmu3.DoStep(c, point, step, 1, places[0], places[1], places[2], percent(&a->random, 99) ? &reached : NULL);
    if (status == fmi3OK && (flags[0] || flags[1] || flags[2] || reached != point + step)) fail("a step ended early");
    slot->time = reached;
    return status;
}

/* What no variable is of, and what there is not at all. */
static fmi3Status absent(struct actor *a, fmi3Instance c, enum function_3 function) {
    size_t n = percent(&a->random, 60) ? 0 : below(&a->random, MOST);
    unsigned *known = array_references(a, n, 0);
    fmi3Status status = fmi3Error;
    switch (function) {
#define NONE(type) \
    case F3_Get##type: status = fmu3.Get##type(c, known, n, NULL, 0); break; \
    case F3_Set##type: status = fmu3.Set##type(c, known, n, NULL, 0); break;
    NONE(Float32) NONE(Int8) NONE(UInt8) NONE(Int16) NONE(UInt16) NONE(Int32) NONE(UInt32) NONE(UInt64) NONE(String)
    case F3_GetBinary: status = fmu3.GetBinary(c, known, n, NULL, NULL, 0); break;
    case F3_SetBinary: status = fmu3.SetBinary(c, known, n, NULL, NULL, 0); break;
    case F3_GetClock: status = fmu3.GetClock(c, known, n, NULL); break;
    case F3_SetClock: status = fmu3.SetClock(c, known, n, NULL); break;
    case F3_GetIntervalDecimal: status = fmu3.GetIntervalDecimal(c, known, n, NULL, NULL); break;
    case F3_GetIntervalFraction: status = fmu3.GetIntervalFraction(c, known, n, NULL, NULL, NULL); break;
    case F3_GetShiftDecimal: status = fmu3.GetShiftDecimal(c, known, n, NULL); break;
    case F3_GetShiftFraction: status = fmu3.GetShiftFraction(c, known, n, NULL, NULL); break;
    case F3_SetIntervalDecimal: status = fmu3.SetIntervalDecimal(c, known, n, NULL); break;
    case F3_SetIntervalFraction: status = fmu3.SetIntervalFraction(c, known, n, NULL, NULL); break;
    case F3_SetShiftDecimal: status = fmu3.SetShiftDecimal(c, known, n, NULL); break;
    case F3_SetShiftFraction: status = fmu3.SetShiftFraction(c, known, n, NULL, NULL); break;
    case F3_EnterConfigurationMode: status = fmu3.EnterConfigurationMode(c); break;
    case F3_ExitConfigurationMode: status = fmu3.ExitConfigurationMode(c); break;
    case F3_EvaluateDiscreteStates: status = fmu3.EvaluateDiscreteStates(c); break;
    case F3_ActivateModelPartition: status = fmu3.ActivateModelPartition(c, 1, 0.0); break;
    default: fail("a function is never called");
    }
    free(known);
    return status;
}

/* One call; what it gave goes into the digest. */
static int call(struct actor *a, int function) {
    unsigned which = below(&a->random, SLOTS), kept = below(&a->random, STATES);
    struct slot *slot = &a->slots[which];
    fmi3Instance c = percent(&a->random, 1) ? NULL : slot->component;
    void **state = &a->states[kept];
    size_t n = below(&a->random, MOST), m = below(&a->random, 4), six = percent(&a->random, 90) ? 6 : n, values = 0, size = 0;
    unsigned *known = NULL, *unknown = NULL;
    double *x = NULL, *y = NULL, number = 0.0;
    bool flags[5] = {0}, *places[5], *booleans = NULL;
    int64_t *numbers = NULL;
    int *orders = NULL;
    fmi3Status status = fmi3OK;
    for (int k = 0; k < 5; k++) places[k] = percent(&a->random, 1) ? NULL : &flags[k];

    switch ((enum function_3)function) {
    case F3_GetVersion: status = strcmp(fmu3.GetVersion(), "3.0") ? fmi3Error : fmi3OK; break;
    case F3_SetDebugLogging: {
        static const char *const categories[] = {"logStatusError", "logStatusWarning", "logEvents", "logAll", NULL};
        const char **strings = array(a, m, sizeof *strings);
        for (size_t k = 0; strings && k < m; k++) strings[k] = categories[below(&a->random, percent(&a->random, 90) ? 3 : 5)];
        status = fmu3.SetDebugLogging(c, percent(&a->random, 50), m, strings);
        free(strings);
        break;
    }
    case F3_InstantiateModelExchange: case F3_InstantiateCoSimulation: case F3_InstantiateScheduledExecution:
        if (slot->component) fmu3.FreeInstance(slot->component);
        *slot = (struct slot){instantiate(a, (enum function_3)function), 0.0};
        status = slot->component ? fmi3OK : fmi3Error;
        break;
    case F3_FreeInstance:
        fmu3.FreeInstance(c);
        if (c) slot->component = NULL;
        break;
    case F3_EnterInitializationMode:
        number = percent(&a->random, 80) ? 0.0 : real(&a->random, 100.0);
        status = fmu3.EnterInitializationMode(c, percent(&a->random, 50), real(&a->random, 1.0), number, percent(&a->random, 10), real(&a->random, 10.0));
        if (status == fmi3OK) slot->time = number;
        break;
    case F3_ExitInitializationMode: status = fmu3.ExitInitializationMode(c); break;
    case F3_EnterEventMode: status = fmu3.EnterEventMode(c); break;
    case F3_EnterStepMode: status = fmu3.EnterStepMode(c); break;
    case F3_Terminate: status = fmu3.Terminate(c); break;
    case F3_Reset:
        status = fmu3.Reset(c);
        if (status == fmi3OK) slot->time = 0.0;
        break;
    case F3_GetFloat64:
        known = array_references(a, n, 0), values = values_of(a, known, n);
        status = fmu3.GetFloat64(c, known, n, x = array(a, values, sizeof *x), values);
        break;
    case F3_SetFloat64:
        known = array_references(a, n, 1), values = values_of(a, known, n);
        status = fmu3.SetFloat64(c, known, n, x = reals(a, values, 10.0), values);
        break;
    case F3_GetInt64: case F3_SetInt64: case F3_GetBoolean: case F3_SetBoolean: {
        int whole = function == F3_GetInt64 || function == F3_SetInt64;
        known = array(a, m, sizeof *known), values = percent(&a->random, 95) ? m : n;
        for (size_t k = 0; known && k < m; k++)
            known[k] = percent(&a->random, 5) ? reference(a) : whole ? UGV_VR_TERRAIN : UGV_VR_INITIAL_NO_SLIP;
        numbers = array(a, values, sizeof *numbers), booleans = array(a, values, sizeof *booleans);
        for (size_t k = 0; numbers && k < values; k++) numbers[k] = integer(a);
        status = function == F3_GetInt64     ? fmu3.GetInt64(c, known, m, numbers, values)
                 : function == F3_SetInt64   ? fmu3.SetInt64(c, known, m, numbers, values)
                 : function == F3_GetBoolean ? fmu3.GetBoolean(c, known, m, booleans, values)
                                             : fmu3.SetBoolean(c, known, m, booleans, values);
        if (numbers) digest(a, numbers, values * sizeof *numbers);
        if (booleans) digest(a, booleans, values);
        break;
    }
    case F3_GetNumberOfVariableDependencies:
        status = fmu3.GetNumberOfVariableDependencies(c, reference(a), percent(&a->random, 98) ? &size : NULL);
        digest(a, &size, sizeof size);
        break;
    case F3_GetVariableDependencies: {
        unsigned of = percent(&a->random, 80) ? 2 + below(&a->random, 20) : reference(a);
        if (fmu3.GetNumberOfVariableDependencies(c, of, &size) != fmi3OK || percent(&a->random, 5)) size = n;
        size_t *elements = array(a, size, sizeof *elements), *others = array(a, size, sizeof *others);
        fmi3DependencyKind *kinds = array(a, size, sizeof *kinds);
        known = array(a, size, sizeof *known);
        status = fmu3.GetVariableDependencies(c, of, elements, known, others, kinds, size);
        if (status == fmi3OK && known) digest(a, known, size * sizeof *known);
        free(elements), free(others), free(kinds);
        break;
    }
    case F3_GetFMUState:
        status = fmu3.GetFMUState(c, state);
        if (status == fmi3OK) a->state_times[kept] = slot->time;
        break;
    case F3_SetFMUState:
        status = fmu3.SetFMUState(c, *state);
        if (status == fmi3OK) slot->time = a->state_times[kept];
        break;
    case F3_FreeFMUState: status = fmu3.FreeFMUState(c, percent(&a->random, 95) ? state : NULL); break;
    case F3_SerializedFMUStateSize:
        status = fmu3.SerializedFMUStateSize(c, *state, &size);
        digest(a, &size, sizeof size);
        break;
    case F3_SerializeFMUState: {
        if (fmu3.SerializedFMUStateSize(c, *state, &size) != fmi3OK) { status = fmi3Error; break; }
        if (percent(&a->random, 10)) size -= 1 + below(&a->random, 100);
        fmi3Byte *bytes = calloc(size, 1);
        status = fmu3.SerializeFMUState(c, *state, bytes, size);
        digest(a, bytes, size);
        if (status != fmi3OK) { free(bytes); break; }
        free(a->bytes);
        a->bytes = bytes, a->size = size, a->bytes_time = a->state_times[kept];
        break;
    }
    case F3_DeserializeFMUState: {
        int damaged = a->bytes && percent(&a->random, 20);
        size = a->size;
        if (damaged) {
            ((fmi3Byte *)a->bytes)[below(&a->random, (unsigned)size)] ^= (fmi3Byte)(1 + below(&a->random, 255));
            if (percent(&a->random, 50)) size -= below(&a->random, (unsigned)size);
        }
        status = fmu3.DeserializeFMUState(c, a->bytes, size, state);
        if (damaged && status == fmi3OK) fail("a damaged state was taken for a whole one");
        if (damaged) free(a->bytes), a->bytes = NULL;
        if (status == fmi3OK) a->state_times[kept] = a->bytes_time;
        break;
    }
    case F3_GetDirectionalDerivative: case F3_GetAdjointDerivative: {
        int adjoint = function == F3_GetAdjointDerivative;
        unknown = array(a, n, sizeof *unknown), known = array(a, m, sizeof *known);
        for (size_t k = 0; unknown && k < n; k++) unknown[k] = percent(&a->random, 97) ? 2 + below(&a->random, 20) : 2000 + below(&a->random, 8);
        for (size_t k = 0; known && k < m; k++) known[k] = percent(&a->random, 97) ? below(&a->random, 8) : reference(a);
        size_t seeds = values_of(a, adjoint ? unknown : known, adjoint ? n : m);
        values = values_of(a, adjoint ? known : unknown, adjoint ? m : n);
        x = array(a, values, sizeof *x), y = reals(a, seeds, 10.0);
        status = adjoint ? fmu3.GetAdjointDerivative(c, unknown, n, known, m, y, seeds, x, values)
                         : fmu3.GetDirectionalDerivative(c, unknown, n, known, m, y, seeds, x, values);
        break;
    }
    case F3_UpdateDiscreteStates:
        status = fmu3.UpdateDiscreteStates(c, places[0], places[1], places[2], places[3], places[4], &number);
        digest(a, &number, sizeof number);
        break;
    case F3_EnterContinuousTimeMode: status = fmu3.EnterContinuousTimeMode(c); break;
    case F3_CompletedIntegratorStep: status = fmu3.CompletedIntegratorStep(c, 1, places[0], places[1]); break;
    case F3_SetTime:
        status = fmu3.SetTime(c, number = real(&a->random, 100.0));
        if (status == fmi3OK) slot->time = number;
        break;
    case F3_SetContinuousStates: status = fmu3.SetContinuousStates(c, x = reals(a, six, 2.0), six), values = six; break;
    case F3_GetContinuousStateDerivatives: status = fmu3.GetContinuousStateDerivatives(c, x = array(a, six, sizeof *x), six), values = six; break;
    case F3_GetContinuousStates: status = fmu3.GetContinuousStates(c, x = array(a, six, sizeof *x), six), values = six; break;
    case F3_GetNominalsOfContinuousStates: status = fmu3.GetNominalsOfContinuousStates(c, x = array(a, six, sizeof *x), six), values = six; break;
    case F3_GetEventIndicators: status = fmu3.GetEventIndicators(c, x = array(a, m, sizeof *x), m), values = m; break;
    case F3_GetNumberOfEventIndicators: status = fmu3.GetNumberOfEventIndicators(c, percent(&a->random, 98) ? &size : NULL); break;
    case F3_GetNumberOfContinuousStates: status = fmu3.GetNumberOfContinuousStates(c, percent(&a->random, 98) ? &size : NULL); break;
    case F3_GetOutputDerivatives:
        orders = array(a, n, sizeof *orders), known = array_references(a, n, 0), values = values_of(a, known, n);
        for (size_t k = 0; orders && k < n; k++) orders[k] = percent(&a->random, 98) ? 1 : integer(a);
        for (size_t k = 0; known && k < n; k++)
            if (percent(&a->random, 95)) known[k] = 2 + below(&a->random, 11);
        if (percent(&a->random, 90)) values = n;
        status = fmu3.GetOutputDerivatives(c, known, n, orders, x = array(a, values, sizeof *x), values);
        break;
    case F3_DoStep: status = do_step(a, slot, c); break;
    default: status = absent(a, c, (enum function_3)function);
    }
    if (x && status == fmi3OK) {
        digest(a, x, values * sizeof *x);
        for (size_t k = 0; k < values; k++)
            if (!isfinite(x[k])) fail("a value is not finite");
    }
    free(known), free(unknown), free(x), free(y), free(orders), free(numbers), free(booleans);
    if ((unsigned)status >= fmi3Fatal) {
        fprintf(stderr, "fmu_host_3: %s returned %d\n", NAMES_3[function], (int)status);
        exit(1);
    }
    return (int)status;
}

/* What is needed to get anywhere comes more often than what ends a simulation. */
static int choose(struct actor *a) {
    static const enum function_3 often[] = {
        F3_EnterInitializationMode, F3_ExitInitializationMode, F3_EnterStepMode, F3_DoStep, F3_DoStep, F3_DoStep,
        F3_GetFloat64, F3_SetFloat64, F3_SetFloat64, F3_EnterContinuousTimeMode, F3_SetContinuousStates,
        F3_GetContinuousStateDerivatives, F3_GetOutputDerivatives, F3_GetFMUState, F3_SetFMUState,
        F3_SerializeFMUState, F3_DeserializeFMUState,
    };
    if (percent(&a->random, 60)) return often[below(&a->random, sizeof often / sizeof *often)];
    enum function_3 function = (enum function_3)below(&a->random, FUNCTION_3_COUNT);
    int ends = function == F3_Terminate || function == F3_FreeInstance || function == F3_InstantiateModelExchange ||
               function == F3_InstantiateCoSimulation || function == F3_InstantiateScheduledExecution;
    return ends && percent(&a->random, 80) ? F3_GetFloat64 : (int)function;
}

/* A slot that is ready for anything. */
static void begin(struct actor *a, struct slot *slot) {
    if (!slot->component)
        *slot = (struct slot){instantiate(a, percent(&a->random, 40) ? F3_InstantiateModelExchange : F3_InstantiateCoSimulation), 0.0};
    fmu3.Reset(slot->component);
    slot->time = 0.0;
    fmu3.EnterInitializationMode(slot->component, 0, 0.0, 0.0, 0, 0.0);
    fmu3.ExitInitializationMode(slot->component);
    if (percent(&a->random, 70)) fmu3.EnterStepMode(slot->component);
    fmu3.EnterContinuousTimeMode(slot->component);
}

/* Frees everything, through an instance that makes sure of one. */
static void finish(struct actor *a) {
    fmi3Instance c = fmu3.InstantiateCoSimulation("last", guid, resources, 0, 1, 0, 0, NULL, 0, a, logger, NULL);
    if (!c) fail("the last instance was refused");
    for (unsigned k = 0; k < STATES; k++)
        if (fmu3.FreeFMUState(c, &a->states[k]) != fmi3OK || a->states[k]) fail("a state was not freed");
    fmu3.FreeInstance(c);
    for (unsigned k = 0; k < SLOTS; k++) fmu3.FreeInstance(a->slots[k].component);
    free(a->bytes);
}
