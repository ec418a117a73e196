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
#include "fmi2Functions.h"

#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FUNCTIONS(X)                                                                               \
    X(GetTypesPlatform) X(GetVersion) X(SetDebugLogging) X(Instantiate) X(FreeInstance)            \
    X(SetupExperiment) X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset)  \
    X(GetReal) X(GetInteger) X(GetBoolean) X(GetString)                                            \
    X(SetReal) X(SetInteger) X(SetBoolean) X(SetString)                                            \
    X(GetFMUstate) X(SetFMUstate) X(FreeFMUstate) X(SerializedFMUstateSize)                        \
    X(SerializeFMUstate) X(DeSerializeFMUstate) X(GetDirectionalDerivative)                        \
    X(EnterEventMode) X(NewDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep)   \
    X(SetTime) X(SetContinuousStates) X(GetDerivatives) X(GetEventIndicators)                      \
    X(GetContinuousStates) X(GetNominalsOfContinuousStates)                                        \
    X(SetRealInputDerivatives) X(GetRealOutputDerivatives) X(DoStep) X(CancelStep)                 \
    X(GetStatus) X(GetRealStatus) X(GetIntegerStatus) X(GetBooleanStatus) X(GetStringStatus)

#define NUMBER(name) F_##name,
enum function { FUNCTIONS(NUMBER) FUNCTION_COUNT };
#define NAME(name) "fmi2" #name,
static const char *const NAMES[] = {FUNCTIONS(NAME)};
#define MEMBER(name) fmi2##name##TYPE *name;
static struct { FUNCTIONS(MEMBER) } fmu;

enum { ACTORS = 4, SLOTS = 3, STATES = 4, MOST = 8, STATUSES = 6 };

/* An instance, and the time that it should have reached. */
struct slot {
    fmi2Component component;
    double time;
};

struct actor {
    uint64_t random, digest;
    struct slot slots[SLOTS];
    fmi2FMUstate states[STATES];
    double state_times[STATES];
    fmi2Byte *bytes;
    size_t size;
    double bytes_time;
    unsigned long count[FUNCTION_COUNT][STATUSES];
    long calls;
};

static const char *resources, *guid;

static void fail(const char *what) {
    fprintf(stderr, "fmu_host: %s\n", what);
    exit(1);
}

/* Random numbers: splitmix64. */
static uint64_t draw(struct actor *a) {
    uint64_t z = (a->random += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static unsigned below(struct actor *a, unsigned count) { return (unsigned)(draw(a) % count); }
static int percent(struct actor *a, unsigned chance) { return below(a, 100) < chance; }
static double uniform(struct actor *a, double low, double high) {
    return low + (high - low) * (double)(draw(a) >> 11) * 0x1p-53;
}

/* Mostly a sensible number, sometimes a strange one. */
static double real(struct actor *a, double size) {
    static const double strange[] = {0.0, -0.0, NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-310, 1e6};
    if (percent(a, 3)) return strange[below(a, sizeof strange / sizeof *strange)];
    return uniform(a, -size, size);
}

static int integer(struct actor *a) { return percent(a, 90) ? 1 + (int)below(a, 5) : (int)draw(a); }

static void digest(struct actor *a, const void *data, size_t size) {
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) a->digest = (a->digest ^ bytes[i]) * 0x100000001b3u;
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...) {
    struct actor *a = environment;
    if (!name || !category || !message) fail("the logger got a null pointer");
    if (strpbrk(message, "%#")) fail("a message could be taken for a format");
    if (strncmp(category, "log", 3) != 0) fail("a log category is not declared");
    digest(a, &status, sizeof status);
    digest(a, message, strlen(message));
}

/* Arrays have exactly the size that is told, for a memory checker to see what goes beyond. */
static void *array(struct actor *a, size_t count, size_t size) {
    if (percent(a, count ? 2 : 50)) return NULL;
    void *memory = calloc(count ? count : 1, size);
    if (!memory) fail("out of memory");
    return memory;
}

static fmi2Real *reals(struct actor *a, size_t count, double size) {
    fmi2Real *values = array(a, count, sizeof *values);
    for (size_t i = 0; values && i < count; i++) values[i] = real(a, size);
    return values;
}

static fmi2Integer *integers(struct actor *a, size_t count) {
    fmi2Integer *values = array(a, count, sizeof *values);
    for (size_t i = 0; values && i < count; i++) values[i] = integer(a);
    return values;
}

/* Mostly inputs, outputs or parameters that are there. */
static fmi2ValueReference reference(struct actor *a) {
    switch (below(a, 10)) {
    case 0: return below(a, 60);
    case 1: return 1000 + below(a, 5);
    case 2: case 3: return 2000 + 16 * below(a, 8) + below(a, 7);
    case 4: return percent(a, 70) ? below(a, 13) : (fmi2ValueReference)draw(a);
    case 5: case 6: return 2 + below(a, 11);
    default: return below(a, 2);
    }
}

static fmi2ValueReference *references(struct actor *a, size_t count, int inputs) {
    fmi2ValueReference *values = array(a, count, sizeof *values);
    for (size_t i = 0; values && i < count; i++)
        values[i] = inputs && percent(a, 85) ? below(a, 2) : reference(a);
    return values;
}

static fmi2Component instantiate(struct actor *a) {
    static const char *const places[] = {"", "rubbish", "file:///nowhere/%20", NULL};
    const fmi2CallbackFunctions functions = {percent(a, 90) ? logger : NULL, NULL, NULL, NULL, a};
    int wrong = percent(a, 3);
    fmi2Type kind = (fmi2Type)(percent(a, 97) ? below(a, 2) : draw(a) % 1000);
    const char *place = percent(a, 50) ? resources : places[below(a, 4)];
    const char *name = percent(a, 95) ? "random" : NULL;
    return fmu.Instantiate(name, kind, wrong ? "{0}" : guid, place, percent(a, 95) ? &functions : NULL,
                           (int)below(a, 2), (int)below(a, 2));
}

/* One call; what it gave goes into the digest. */
static int call(struct actor *a, enum function function) {
    unsigned which = below(a, SLOTS), kept = below(a, STATES);
    struct slot *slot = &a->slots[which];
    fmi2Component c = percent(a, 1) ? NULL : slot->component;
    fmi2FMUstate *state = &a->states[kept];
    size_t n = below(a, MOST), m = below(a, 4), six = percent(a, 90) ? 6 : n, size = 0;
    fmi2ValueReference *known = NULL, *unknown = NULL;
    fmi2Real *x = NULL, *y = NULL, number = 0.0, step = pow(10.0, uniform(a, -6.0, -2.5));
    fmi2Integer *i = NULL, orders[MOST], flag = 0, other = 0;
    fmi2String *strings = NULL, text = NULL;
    fmi2EventInfo event;
    fmi2Status status = fmi2OK, value = fmi2OK;
    fmi2StatusKind kind = (fmi2StatusKind)below(a, 5);

    switch (function) {
    case F_GetTypesPlatform: status = strcmp(fmu.GetTypesPlatform(), "default") ? fmi2Error : fmi2OK; break;
    case F_GetVersion: status = strcmp(fmu.GetVersion(), "2.0") ? fmi2Error : fmi2OK; break;
    case F_SetDebugLogging: {
        static const char *const categories[] = {"logStatusError", "logStatusWarning", "logEvents", "logAll", NULL};
        strings = array(a, m, sizeof *strings);
        for (size_t k = 0; strings && k < m; k++) strings[k] = categories[percent(a, 90) ? below(a, 3) : below(a, 5)];
        status = fmu.SetDebugLogging(c, (int)below(a, 2), m, strings);
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
        number = percent(a, 80) ? 0.0 : real(a, 100.0);
        status = fmu.SetupExperiment(c, (int)below(a, 2), real(a, 1.0), number, percent(a, 10), real(a, 10.0));
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
            known[k] = percent(a, 5) ? reference(a) : function == F_GetInteger || function == F_SetInteger ? 19 : 39;
        i = integers(a, m);
        status = function == F_GetInteger   ? fmu.GetInteger(c, known, m, i)
                 : function == F_GetBoolean ? fmu.GetBoolean(c, known, m, i)
                 : function == F_SetInteger ? fmu.SetInteger(c, known, m, i)
                                            : fmu.SetBoolean(c, known, m, i);
        if (i) digest(a, i, m * sizeof *i);
        break;
    case F_GetString: case F_SetString:
        m = percent(a, 50) ? 0 : m;
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
    case F_FreeFMUstate: status = fmu.FreeFMUstate(c, percent(a, 95) ? state : NULL); break;
    case F_SerializedFMUstateSize:
        status = fmu.SerializedFMUstateSize(c, *state, &size);
        digest(a, &size, sizeof size);
        break;
    case F_SerializeFMUstate: {
        if (fmu.SerializedFMUstateSize(c, *state, &size) != fmi2OK) { status = fmi2Error; break; }
        if (percent(a, 10)) size -= 1 + below(a, 100);
        fmi2Byte *bytes = calloc(size, 1);
        status = fmu.SerializeFMUstate(c, *state, bytes, size);
        digest(a, bytes, size);
        if (status != fmi2OK) { free(bytes); break; }
        free(a->bytes);
        a->bytes = bytes, a->size = size, a->bytes_time = a->state_times[kept];
        break;
    }
    case F_DeSerializeFMUstate:
        if (a->bytes && percent(a, 20)) {
            /* Damaged, cut short, or both; the next ones will be whole again. */
            if (percent(a, 70)) a->bytes[below(a, (unsigned)a->size)] ^= (fmi2Byte)(1 + below(a, 255));
            size = a->size - (percent(a, 50) ? below(a, (unsigned)a->size) : 0);
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
        for (size_t k = 0; unknown && k < n; k++) unknown[k] = percent(a, 97) ? 2 + below(a, 17) : reference(a);
        for (size_t k = 0; known && k < m; k++) known[k] = percent(a, 97) ? below(a, 8) : reference(a);
        x = reals(a, m, 10.0), y = array(a, n, sizeof *y);
        status = fmu.GetDirectionalDerivative(c, unknown, n, known, m, x, y);
        if (y) digest(a, y, n * sizeof *y);
        break;
    case F_EnterEventMode: status = fmu.EnterEventMode(c); break;
    case F_NewDiscreteStates:
        memset(&event, 0, sizeof event);
        status = fmu.NewDiscreteStates(c, percent(a, 98) ? &event : NULL);
        digest(a, &event.nextEventTime, sizeof event.nextEventTime);
        break;
    case F_EnterContinuousTimeMode: status = fmu.EnterContinuousTimeMode(c); break;
    case F_CompletedIntegratorStep: status = fmu.CompletedIntegratorStep(c, 1, percent(a, 98) ? &flag : NULL, &other); break;
    case F_SetTime: status = fmu.SetTime(c, real(a, 100.0)); break;
    case F_SetContinuousStates: status = fmu.SetContinuousStates(c, x = reals(a, six, 2.0), six); break;
    case F_GetDerivatives: status = fmu.GetDerivatives(c, x = array(a, six, sizeof *x), six); break;
    case F_GetEventIndicators: status = fmu.GetEventIndicators(c, x = array(a, m, sizeof *x), m); break;
    case F_GetContinuousStates: status = fmu.GetContinuousStates(c, x = array(a, six, sizeof *x), six); break;
    case F_GetNominalsOfContinuousStates:
        status = fmu.GetNominalsOfContinuousStates(c, x = array(a, six, sizeof *x), six);
        break;
    case F_SetRealInputDerivatives: case F_GetRealOutputDerivatives:
        for (size_t k = 0; k < MOST; k++) orders[k] = percent(a, 98) ? 1 : integer(a);
        known = array(a, n, sizeof *known);
        flag = function == F_SetRealInputDerivatives;
        for (size_t k = 0; known && k < n; k++)
            known[k] = percent(a, 3) ? reference(a) : flag ? below(a, 2) : 2 + below(a, 11);
        x = reals(a, n, 20.0);
        status = flag ? fmu.SetRealInputDerivatives(c, known, n, orders, x)
                      : fmu.GetRealOutputDerivatives(c, known, n, orders, x);
        if (x) digest(a, x, n * sizeof *x);
        break;
    case F_DoStep:
        if (percent(a, 5)) step = real(a, 1e-3);
        number = percent(a, 95) ? slot->time : real(a, 1.0);
        status = fmu.DoStep(c, number, step, (int)below(a, 2));
        if (status == fmi2OK) slot->time = number + step;
        break;
    case F_CancelStep: status = fmu.CancelStep(c); break;
    case F_GetStatus: status = fmu.GetStatus(c, kind, &value); break;
    case F_GetRealStatus:
        status = fmu.GetRealStatus(c, kind, &number);
        if (status == fmi2OK && number != slot->time && a->count[F_DoStep][fmi2Error] == 0) fail("the time is wrong");
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
