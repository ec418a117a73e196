/*
 * Calls all functions of an FMU at random: in and out of order, with valid pointers but otherwise
 * arbitrary arguments, on several live instances and saved states.
 *
 *   fmu_host LIBRARY RESOURCES GUID SEED CALLS WAY...
 *
 * Four actors share the calls, each with instances, states and random numbers of its own, so that
 * what an actor sees does not depend on how their calls interleave. Ways: `mixed` (a random actor
 * makes the next call), `serial` (one after the other), `threads` (all at once). All ways must see
 * the same statuses, values, bytes and messages.
 * Prints how often each function returned each status. Exit code: 0, or 1 if something is wrong.
 */
#include "host.h"

#define COUNT FUNCTION_COUNT
#define FUNCTION_NAMES NAMES
#include "random.h"

static const char *load_functions(const char *path) { return load(path); }

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...) {
    if (!name) fail("the logger got a null pointer");
    if (strchr(message, '%')) fail("a message could be taken for a format");
    take_note(environment, status, category, message);
}

static int *integers(struct actor *a, size_t count) {
    int *values = array(a, count, sizeof *values);
    for (size_t i = 0; values && i < count; i++) values[i] = integer(a);
    return values;
}

static fmi2Component instantiate(struct actor *a) {
    static const char *const places[] = {"", "rubbish", "file:///nowhere/%20", NULL};
    const fmi2CallbackFunctions functions = {percent(&a->random, 90) ? logger : NULL, NULL, NULL, NULL, a};
    int wrong = percent(&a->random, 3);
    fmi2Type kind = (fmi2Type)(percent(&a->random, 97) ? below(&a->random, 2) : draw(&a->random) % 1000);
    const char *place = percent(&a->random, 50) ? resources : places[below(&a->random, 4)];
    const char *name = percent(&a->random, 95) ? "random" : NULL;
    return fmu.Instantiate(name, kind, wrong ? "{0}" : guid, place, percent(&a->random, 95) ? &functions : NULL,
                           (int)below(&a->random, 2), (int)below(&a->random, 2));
}

/* One call; what it gave goes into the digest. */
static int call(struct actor *a, int function) {
    unsigned which = below(&a->random, SLOTS), kept = below(&a->random, STATES);
    struct slot *slot = &a->slots[which];
    fmi2Component c = percent(&a->random, 1) ? NULL : slot->component;
    fmi2FMUstate *state = &a->states[kept];
    size_t n = below(&a->random, MOST), m = below(&a->random, 4), six = percent(&a->random, 90) ? 6 : n, size = 0;
    fmi2ValueReference *known = NULL, *unknown = NULL;
    fmi2Real *x = NULL, *y = NULL, number = 0.0, step = pow(10.0, uniform(&a->random, -6.0, -2.5));
    fmi2Integer *i = NULL, orders[MOST], flag = 0, other = 0;
    fmi2String *strings = NULL, text = NULL;
    fmi2EventInfo event;
    fmi2Status status = fmi2OK, value = fmi2OK;
    fmi2StatusKind kind = (fmi2StatusKind)below(&a->random, 5);

    switch ((enum function)function) {
    case F_GetTypesPlatform: status = strcmp(fmu.GetTypesPlatform(), "default") ? fmi2Error : fmi2OK; break;
    case F_GetVersion: status = strcmp(fmu.GetVersion(), "2.0") ? fmi2Error : fmi2OK; break;
    case F_SetDebugLogging: {
        static const char *const categories[] = {"logStatusError", "logStatusWarning", "logEvents", "logAll", NULL};
        strings = array(a, m, sizeof *strings);
        for (size_t k = 0; strings && k < m; k++) strings[k] = categories[percent(&a->random, 90) ? below(&a->random, 3) : below(&a->random, 5)];
        status = fmu.SetDebugLogging(c, (int)below(&a->random, 2), m, strings);
        break;
    }
    case F_Instantiate:
        if (slot->component) fmu.FreeInstance(slot->component);
        *slot = (struct slot){instantiate(a), 0.0};
        status = slot->component ? fmi2OK : fmi2Error;
        break;
    case F_FreeInstance:
        fmu.FreeInstance(c);
        if (c) slot->component = NULL;
        break;
    case F_SetupExperiment:
        number = percent(&a->random, 80) ? 0.0 : real(&a->random, 100.0);
        status = fmu.SetupExperiment(c, (int)below(&a->random, 2), real(&a->random, 1.0), number, percent(&a->random, 10), real(&a->random, 10.0));
        if (status == fmi2OK) slot->time = number;
        break;
    case F_EnterInitializationMode: status = fmu.EnterInitializationMode(c); break;
    case F_ExitInitializationMode: status = fmu.ExitInitializationMode(c); break;
    case F_Terminate: status = fmu.Terminate(c); break;
    case F_Reset:
        status = fmu.Reset(c);
        if (status == fmi2OK) slot->time = 0.0;
        break;
    case F_GetReal:
        status = fmu.GetReal(c, known = references(a, n, 0), n, x = array(a, n, sizeof *x));
        if (x) digest(a, x, n * sizeof *x);
        break;
    case F_SetReal: status = fmu.SetReal(c, known = references(a, n, 1), n, x = reals(a, n, 10.0)); break;
    case F_GetInteger: case F_GetBoolean: case F_SetInteger: case F_SetBoolean:
        known = array(a, m, sizeof *known);
        /* The terrain and initial.no_slip, or their neighbours. */
        for (size_t k = 0; known && k < m; k++)
            known[k] = percent(&a->random, 5)                                          ? reference(a)
                       : function == F_GetInteger || function == F_SetInteger ? UGV_VR_TERRAIN
                                                                           : UGV_VR_INITIAL_NO_SLIP;
        i = integers(a, m);
        status = function == F_GetInteger   ? fmu.GetInteger(c, known, m, i)
                 : function == F_GetBoolean ? fmu.GetBoolean(c, known, m, i)
                 : function == F_SetInteger ? fmu.SetInteger(c, known, m, i)
                                            : fmu.SetBoolean(c, known, m, i);
        if (i) digest(a, i, m * sizeof *i);
        break;
    case F_GetString: case F_SetString:
        m = percent(&a->random, 50) ? 0 : m;
        strings = array(a, m, sizeof *strings);
        known = references(a, m, 0);
        status = function == F_GetString ? fmu.GetString(c, known, m, strings) : fmu.SetString(c, known, m, strings);
        break;
    case F_GetFMUstate:
        status = fmu.GetFMUstate(c, state);
        if (status == fmi2OK) a->state_times[kept] = slot->time;
        break;
    case F_SetFMUstate:
        status = fmu.SetFMUstate(c, *state);
        if (status == fmi2OK) slot->time = a->state_times[kept];
        break;
    case F_FreeFMUstate: status = fmu.FreeFMUstate(c, percent(&a->random, 95) ? state : NULL); break;
    case F_SerializedFMUstateSize:
        status = fmu.SerializedFMUstateSize(c, *state, &size);
        digest(a, &size, sizeof size);
        break;
    case F_SerializeFMUstate: {
        if (fmu.SerializedFMUstateSize(c, *state, &size) != fmi2OK) { status = fmi2Error; break; }
        if (percent(&a->random, 10)) size -= 1 + below(&a->random, 100);
        fmi2Byte *bytes = calloc(size, 1);
        status = fmu.SerializeFMUstate(c, *state, bytes, size);
        digest(a, bytes, size);
        if (status != fmi2OK) { free(bytes); break; }
        free(a->bytes);
        a->bytes = bytes, a->size = size, a->bytes_time = a->state_times[kept];
        break;
    }
    case F_DeSerializeFMUstate:
        if (a->bytes && percent(&a->random, 20)) {
            /* Damaged, cut short, or both; the next ones will be whole again. */
            if (percent(&a->random, 70)) ((fmi2Byte *)a->bytes)[below(&a->random, (unsigned)a->size)] ^= (fmi2Byte)(1 + below(&a->random, 255));
            size = a->size - (percent(&a->random, 50) ? below(&a->random, (unsigned)a->size) : 0);
            status = fmu.DeSerializeFMUstate(c, a->bytes, size, state);
            if (c && status == fmi2OK && size != a->size) fail("a part of a state was taken for a whole one");
            if (status != fmi2OK) { free(a->bytes); a->bytes = NULL; }
        } else {
            status = fmu.DeSerializeFMUstate(c, a->bytes, a->size, state);
        }
        if (status == fmi2OK) a->state_times[kept] = a->bytes_time;
        break;
    case F_GetDirectionalDerivative:
        unknown = array(a, n, sizeof *unknown), known = array(a, m, sizeof *known);
        for (size_t k = 0; unknown && k < n; k++) unknown[k] = percent(&a->random, 97) ? 2 + below(&a->random, 20) : reference(a);
        for (size_t k = 0; known && k < m; k++) known[k] = percent(&a->random, 97) ? below(&a->random, 8) : reference(a);
        x = reals(a, m, 10.0), y = array(a, n, sizeof *y);
        status = fmu.GetDirectionalDerivative(c, unknown, n, known, m, x, y);
        if (y) digest(a, y, n * sizeof *y);
        break;
    case F_EnterEventMode: status = fmu.EnterEventMode(c); break;
    case F_NewDiscreteStates:
        memset(&event, 0, sizeof event);
        status = fmu.NewDiscreteStates(c, percent(&a->random, 98) ? &event : NULL);
        digest(a, &event.nextEventTime, sizeof event.nextEventTime);
        break;
    case F_EnterContinuousTimeMode: status = fmu.EnterContinuousTimeMode(c); break;
    case F_CompletedIntegratorStep: status = fmu.CompletedIntegratorStep(c, 1, percent(&a->random, 98) ? &flag : NULL, &other); break;
    case F_SetTime:
        status = fmu.SetTime(c, number = real(&a->random, 100.0));
        if (status == fmi2OK) slot->time = number;
        break;
    case F_SetContinuousStates: status = fmu.SetContinuousStates(c, x = reals(a, six, 2.0), six); break;
    case F_GetDerivatives: status = fmu.GetDerivatives(c, x = array(a, six, sizeof *x), six); break;
    case F_GetEventIndicators: status = fmu.GetEventIndicators(c, x = array(a, m, sizeof *x), m); break;
    case F_GetContinuousStates: status = fmu.GetContinuousStates(c, x = array(a, six, sizeof *x), six); break;
    case F_GetNominalsOfContinuousStates:
        status = fmu.GetNominalsOfContinuousStates(c, x = array(a, six, sizeof *x), six);
        break;
    case F_SetRealInputDerivatives: case F_GetRealOutputDerivatives:
        for (size_t k = 0; k < MOST; k++) orders[k] = percent(&a->random, 98) ? 1 : integer(a);
        known = array(a, n, sizeof *known);
        flag = function == F_SetRealInputDerivatives;
        for (size_t k = 0; known && k < n; k++)
            known[k] = percent(&a->random, 3) ? reference(a) : flag ? below(&a->random, 2) : 2 + below(&a->random, 11);
        x = reals(a, n, 20.0);
        status = flag ? fmu.SetRealInputDerivatives(c, known, n, orders, x)
                      : fmu.GetRealOutputDerivatives(c, known, n, orders, x);
        if (x) digest(a, x, n * sizeof *x);
        break;
    case F_DoStep:
        if (percent(&a->random, 5)) step = real(&a->random, 1e-3);
        /* Drives on for as long as it is told, and 1e300 s is very long. */
        if (step > 1.0 && step < INFINITY) step = -step;
        number = percent(&a->random, 95) ? slot->time : real(&a->random, 1.0);
        status = fmu.DoStep(c, number, step, (int)below(&a->random, 2));
        if (status == fmi2OK) slot->time = number + step;
        /* A step that failed may have got somewhere. */
        else fmu.GetRealStatus(c, fmi2LastSuccessfulTime, &slot->time);
        break;
    case F_CancelStep: status = fmu.CancelStep(c); break;
    case F_GetStatus: status = fmu.GetStatus(c, kind, &value); break;
    case F_GetRealStatus:
        status = fmu.GetRealStatus(c, kind, &number);
        if (status == fmi2OK && number != slot->time) fail("the time is wrong");
        break;
    case F_GetIntegerStatus: status = fmu.GetIntegerStatus(c, kind, &flag); break;
    case F_GetBooleanStatus: status = fmu.GetBooleanStatus(c, kind, &flag); break;
    case F_GetStringStatus: status = fmu.GetStringStatus(c, kind, &text); break;
    case FUNCTION_COUNT: break;
    }
    if (function >= F_GetDerivatives && function <= F_GetNominalsOfContinuousStates && x && status == fmi2OK)
        digest(a, x, (function == F_GetEventIndicators ? 0 : six) * sizeof *x);
    free(known), free(unknown), free(x), free(y), free(i), free(strings);
    if ((unsigned)status >= fmi2Fatal) {
        fprintf(stderr, "fmu_host: %s returned %d\n", NAMES[function], (int)status);
        exit(1);
    }
    return (int)status;
}

/* What is needed to get anywhere comes more often than what ends a simulation. */
static int choose(struct actor *a) {
    static const enum function often[] = {
        F_EnterInitializationMode, F_ExitInitializationMode, F_DoStep, F_DoStep, F_DoStep, F_GetReal, F_SetReal,
        F_SetReal, F_EnterContinuousTimeMode, F_SetContinuousStates, F_GetDerivatives, F_SetRealInputDerivatives,
        F_GetFMUstate, F_SetFMUstate, F_SerializeFMUstate, F_DeSerializeFMUstate,
    };
    if (percent(&a->random, 60)) return often[below(&a->random, sizeof often / sizeof *often)];
    enum function function = (enum function)below(&a->random, FUNCTION_COUNT);
    int ends = function == F_Terminate || function == F_FreeInstance || function == F_Instantiate;
    return ends && percent(&a->random, 80) ? F_GetReal : function;
}

/* A slot that is ready for anything. */
static void begin(struct actor *a, struct slot *slot) {
    fmi2EventInfo event;
    if (!slot->component) *slot = (struct slot){instantiate(a), 0.0};
    fmu.Reset(slot->component);
    slot->time = 0.0;
    fmu.EnterInitializationMode(slot->component);
    fmu.ExitInitializationMode(slot->component);
    fmu.NewDiscreteStates(slot->component, &event);
    fmu.EnterContinuousTimeMode(slot->component);
}

/* Frees everything, through an instance that makes sure of one. */
static void finish(struct actor *a) {
    const fmi2CallbackFunctions functions = {logger, NULL, NULL, NULL, a};
    fmi2Component c = fmu.Instantiate("last", fmi2CoSimulation, guid, resources, &functions, 0, 0);
    if (!c) fail("the last instance was refused");
    for (unsigned k = 0; k < STATES; k++)
        if (fmu.FreeFMUstate(c, &a->states[k]) != fmi2OK || a->states[k]) fail("a state was not freed");
    fmu.FreeInstance(c);
    for (unsigned k = 0; k < SLOTS; k++) fmu.FreeInstance(a->slots[k].component);
    free(a->bytes);
}

