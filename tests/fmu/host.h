/* What host.c and drive.c call: the functions of FMI 2.0, and random numbers. */
#ifndef FMU_HOST_H
#define FMU_HOST_H

#include "fmi2Functions.h"

#include <math.h>
#include <stdint.h>

#ifdef _WIN32
#include <windows.h>
static void *open_library(const char *path) { return LoadLibraryA(path); }
static void *find_function(void *library, const char *name) { return (void *)GetProcAddress(library, name); }
static const char *loading_error(void) { return "the library or one that it needs cannot be loaded"; }
#else
#include <dlfcn.h>
static void *open_library(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void *find_function(void *library, const char *name) { return dlsym(library, name); }
static const char *loading_error(void) { return dlerror(); }
#endif

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

/* Loads the functions; returns what is wrong, or a null pointer. */
static const char *load(const char *path) {
    void *library = open_library(path);
    if (!library) return loading_error();
#define LOAD(name) \
    if (!(fmu.name = (fmi2##name##TYPE *)find_function(library, "fmi2" #name))) return "fmi2" #name " is missing";
    FUNCTIONS(LOAD)
    return NULL;
}

/* splitmix64. */
static uint64_t draw(uint64_t *random) {
    uint64_t z = (*random += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static unsigned below(uint64_t *random, unsigned count) { return (unsigned)(draw(random) % count); }
static int percent(uint64_t *random, unsigned chance) { return below(random, 100) < chance; }
static double uniform(uint64_t *random, double low, double high) {
    return low + (high - low) * (double)(draw(random) >> 11) * 0x1p-53;
}

/* Mostly a sensible number, sometimes a strange one. */
static double real(uint64_t *random, double size) {
    static const double strange[] = {0.0, -0.0, NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-310, 1e6};
    if (percent(random, 3)) return strange[below(random, sizeof strange / sizeof *strange)];
    return uniform(random, -size, size);
}

#endif
