/* One vehicle behind either version of the standard: what soak.c and threads.c drive. */
#ifndef FMU_VEHICLE_H
#define FMU_VEHICLE_H

#include "host_3.h"
#include "ugv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The vehicle of the FMU's own resources has eight wheels. */
enum { SCALARS = UGV_VR_DER_YAW_RATE - UGV_VR_X + 1, WHEELS = 8, OUTPUTS = SCALARS + WHEELS, CONTINUOUS_STATES = 6 };

/* What is being tested, and where its resources are: as a URI, and as a path. */
static const char *guid, *resources, *resource_path;

struct vehicle {
    int version, exchange;
    void *handle;
    double time;
};

static void fail(const char *what) {
    fprintf(stderr, "%s\n", what);
    exit(1);
}

static void ok(int status, const char *what) {
    if (status != fmi2OK) fail(what);
}

static void log_2(fmi2ComponentEnvironment e, fmi2String name, fmi2Status s, fmi2String category, fmi2String text, ...) {
    (void)e, (void)name, (void)category;
    if (s >= fmi2Error) fprintf(stderr, "%s\n", text);
}

static void log_3(fmi3InstanceEnvironment e, fmi3Status s, fmi3String category, fmi3String text) {
    (void)e, (void)category;
    if (s >= fmi3Error) fprintf(stderr, "%s\n", text);
}

static const char *load_both(char *const *arguments) {
    const char *missing = load(arguments[0]);
    resource_path = arguments[1], resources = arguments[2], guid = arguments[3];
    return missing ? missing : load_3(arguments[0]);
}

static struct vehicle create(int version, int exchange) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    struct vehicle v = {version, exchange, NULL, 0.0};
    if (version == 2)
        v.handle = fmu.Instantiate("vehicle", exchange ? fmi2ModelExchange : fmi2CoSimulation, guid, resources, &callbacks, 0, 0);
    else if (exchange)
        v.handle = fmu3.InstantiateModelExchange("vehicle", guid, resource_path, 0, 1, NULL, log_3);
    else
        v.handle = fmu3.InstantiateCoSimulation("vehicle", guid, resource_path, 0, 1, 0, 0, NULL, 0, NULL, log_3, NULL);
    if (!v.handle) fail("an instance was refused");
    return v;
}

static void set(struct vehicle *v, unsigned reference, double value) {
    ok(v->version == 2 ? (int)fmu.SetReal(v->handle, &reference, 1, &value)
                       : (int)fmu3.SetFloat64(v->handle, &reference, 1, &value, 1), "a value was refused");
}

/* Initializes on a terrain, and goes to where steps can be made. */
static void start(struct vehicle *v, int terrain) {
    static const unsigned reference = UGV_VR_TERRAIN;
    v->time = 0.0;
    if (v->version == 2) {
        ok(fmu.SetInteger(v->handle, &reference, 1, &terrain), "SetInteger");
        ok(fmu.SetupExperiment(v->handle, 0, 0.0, 0.0, 0, 0.0), "SetupExperiment");
        ok(fmu.EnterInitializationMode(v->handle), "EnterInitializationMode");
        ok(fmu.ExitInitializationMode(v->handle), "ExitInitializationMode");
        if (v->exchange) ok(fmu.EnterContinuousTimeMode(v->handle), "EnterContinuousTimeMode");
    } else {
        const int64_t number = terrain;
        ok(fmu3.SetInt64(v->handle, &reference, 1, &number, 1), "SetInt64");
        ok(fmu3.EnterInitializationMode(v->handle, 0, 0.0, 0.0, 0, 0.0), "EnterInitializationMode");
        ok(fmu3.ExitInitializationMode(v->handle), "ExitInitializationMode");
        if (v->exchange) ok(fmu3.EnterContinuousTimeMode(v->handle), "EnterContinuousTimeMode");
    }
}

/* The importer's own step in model exchange: Euler's. */
static void integrate(struct vehicle *v, double size) {
    double states[CONTINUOUS_STATES], rates[CONTINUOUS_STATES];
    const size_t n = CONTINUOUS_STATES;
    int two = v->version == 2;
    ok(two ? (int)fmu.GetContinuousStates(v->handle, states, n) : (int)fmu3.GetContinuousStates(v->handle, states, n), "GetContinuousStates");
    ok(two ? (int)fmu.GetDerivatives(v->handle, rates, n) : (int)fmu3.GetContinuousStateDerivatives(v->handle, rates, n), "the derivatives");
    for (size_t k = 0; k < n; k++) states[k] += size * rates[k];
    ok(two ? (int)fmu.SetTime(v->handle, v->time + size) : (int)fmu3.SetTime(v->handle, v->time + size), "SetTime");
    ok(two ? (int)fmu.SetContinuousStates(v->handle, states, n) : (int)fmu3.SetContinuousStates(v->handle, states, n), "SetContinuousStates");
}

static void step(struct vehicle *v, const double speeds[2], double size) {
    static const unsigned inputs[] = {UGV_VR_OMEGA_LEFT, UGV_VR_OMEGA_RIGHT};
    ok(v->version == 2 ? (int)fmu.SetReal(v->handle, inputs, 2, speeds)
                       : (int)fmu3.SetFloat64(v->handle, inputs, 2, speeds, 2), "the wheel speeds were refused");
    if (v->exchange) {
        integrate(v, size);
    } else if (v->version == 2) {
        ok(fmu.DoStep(v->handle, v->time, size, 1), "DoStep");
    } else {
        bool event, end, early;
        double reached;
        ok(fmu3.DoStep(v->handle, v->time, size, 1, &event, &end, &early, &reached), "DoStep");
        if (event || end || early) fail("a step wants more than to be made");
    }
    v->time += size;
}

/* States, derivatives, resistances, moments and the loads of the wheels, all finite. */
static void outputs(struct vehicle *v, double values[OUTPUTS]) {
    unsigned references[OUTPUTS];
    for (unsigned k = 0; k < SCALARS; k++) references[k] = UGV_VR_X + k;
    for (unsigned k = 0; k < WHEELS; k++) references[SCALARS + k] = UGV_VR_WHEEL_LOAD(k + 1u);
    ok(v->version == 2 ? (int)fmu.GetReal(v->handle, references, OUTPUTS, values)
                       : (int)fmu3.GetFloat64(v->handle, references, SCALARS + 1, values, OUTPUTS), "the outputs");
    for (unsigned k = 0; k < OUTPUTS; k++)
        if (!isfinite(values[k])) fail("an output is not finite");
}

/* Saves the state, as bytes as well, and returns to what the bytes say. */
static void through_bytes(struct vehicle *v) {
    void *state = NULL, *same = NULL, *c = v->handle;
    size_t size = 0;
    int two = v->version == 2;
    ok(two ? (int)fmu.GetFMUstate(c, &state) : (int)fmu3.GetFMUState(c, &state), "the state");
    ok(two ? (int)fmu.SerializedFMUstateSize(c, state, &size) : (int)fmu3.SerializedFMUStateSize(c, state, &size), "the state's size");
    char *bytes = malloc(size);
    if (!bytes) fail("out of memory");
    ok(two ? (int)fmu.SerializeFMUstate(c, state, bytes, size) : (int)fmu3.SerializeFMUState(c, state, (fmi3Byte *)bytes, size), "the state's bytes");
    ok(two ? (int)fmu.DeSerializeFMUstate(c, bytes, size, &same) : (int)fmu3.DeserializeFMUState(c, (fmi3Byte *)bytes, size, &same), "the state from bytes");
    ok(two ? (int)fmu.SetFMUstate(c, same) : (int)fmu3.SetFMUState(c, same), "going back to a state");
    for (int k = 0; k < 2; k++) {
        void **which = k ? &state : &same;
        ok(two ? (int)fmu.FreeFMUstate(c, which) : (int)fmu3.FreeFMUState(c, which), "freeing a state");
    }
    free(bytes);
}

static void terminate(struct vehicle *v) {
    ok(v->version == 2 ? (int)fmu.Terminate(v->handle) : (int)fmu3.Terminate(v->handle), "Terminate");
}

static void reset(struct vehicle *v) {
    ok(v->version == 2 ? (int)fmu.Reset(v->handle) : (int)fmu3.Reset(v->handle), "Reset");
}

static void release(struct vehicle *v) {
    if (v->version == 2) fmu.FreeInstance(v->handle);
    else fmu3.FreeInstance(v->handle);
    v->handle = NULL;
}

static uint64_t digest_of(uint64_t digest, const double *values, size_t count) {
    const unsigned char *bytes = (const unsigned char *)values;
    for (size_t k = 0; k < count * sizeof *values; k++) digest = (digest ^ bytes[k]) * 0x100000001b3u;
    return digest;
}

#endif
