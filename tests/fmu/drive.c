/*
 * Drives an FMU's library on whatever platform this is compiled for, and prints what it reads to the last
 * digit: fmu_drive LIBRARY RESOURCES GUID REFERENCE...
 * Each line is the time and the variables of these value references. On the way a state goes
 * through bytes and back, and a call that is wrong is refused.
 */
#include "host.h"
#include "manoeuvre.h"

#include <stdio.h>
#include <stdlib.h>

enum { MOST = 200 };

static fmi2ValueReference references[MOST];
static size_t count;
static int messages;

static void fail(const char *what) {
    fprintf(stderr, "fmu_drive: %s\n", what);
    exit(1);
}

static void ok(fmi2Status status, const char *what) {
    if (status != fmi2OK) fail(what);
}

static void logger(fmi2ComponentEnvironment e, fmi2String name, fmi2Status s, fmi2String category, fmi2String text, ...) {
    (void)e, (void)name, (void)s, (void)category;
    fprintf(stderr, "%s\n", text);
    messages++;
}

static void print(fmi2Component c, double time) {
    double values[MOST];
    ok(fmu.GetReal(c, references, count, values), "GetReal");
    printf("%.17g", time);
    for (size_t k = 0; k < count; k++) printf(" %.17g", values[k]);
    printf("\n");
}

/* Takes the state along as bytes into a new instance. */
static fmi2Component move(fmi2Component old, fmi2Component fresh) {
    fmi2FMUstate state = NULL, same = NULL;
    size_t size = 0;
    ok(fmu.GetFMUstate(old, &state), "GetFMUstate");
    ok(fmu.SerializedFMUstateSize(old, state, &size), "SerializedFMUstateSize");
    fmi2Byte *bytes = malloc(size);
    ok(fmu.SerializeFMUstate(old, state, bytes, size), "SerializeFMUstate");
    ok(fmu.FreeFMUstate(old, &state), "FreeFMUstate");
    fmu.FreeInstance(old);
    ok(fmu.DeSerializeFMUstate(fresh, bytes, size, &same), "DeSerializeFMUstate");
    ok(fmu.SetFMUstate(fresh, same), "SetFMUstate");
    ok(fmu.FreeFMUstate(fresh, &same), "FreeFMUstate");
    free(bytes);
    return fresh;
}

int main(int argc, char **argv) {
    static const fmi2ValueReference inputs[] = {0, 1}, nothing = 999999999;
    static const fmi2Integer first_order[] = {1, 1};
    static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    if (argc < 5 || argc - 4 > MOST) fail("usage: fmu_drive LIBRARY RESOURCES GUID REFERENCE...");
    const char *missing = load(argv[1]);
    if (missing) fail(missing);
    for (int k = 4; k < argc; k++) references[count++] = (fmi2ValueReference)strtoul(argv[k], NULL, 10);
    fmi2Component c = fmu.Instantiate("drive", fmi2CoSimulation, argv[3], argv[2], &callbacks, 0, 0);
    if (!c || messages) fail("Instantiate");
    ok(fmu.SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), "SetupExperiment");
    ok(fmu.EnterInitializationMode(c), "EnterInitializationMode");
    ok(fmu.ExitInitializationMode(c), "ExitInitializationMode");
    print(c, 0.0);
    double now[2] = {0.0, 0.0};
    long done = 0;
    for (size_t k = 0; k < PHASE_COUNT; k++) {
        const struct phase *phase = &PHASES[k];
        for (long i = 0; i < steps_of(phase); i++) {
            double rates[2], speeds[2];
            wheels(phase, now, i, speeds, rates);
            ok(fmu.SetReal(c, inputs, 2, speeds), "SetReal");
            if (phase->ramp) ok(fmu.SetRealInputDerivatives(c, inputs, 2, first_order, rates), "SetRealInputDerivatives");
            ok(fmu.DoStep(c, (double)done * STEP, STEP, 1), "DoStep");
            done++;
            print(c, (double)done * STEP);
        }
        now[0] = phase->left, now[1] = phase->right;
        if (k == MOVED_AFTER) c = move(c, fmu.Instantiate("later", fmi2CoSimulation, argv[3], argv[2], &callbacks, 0, 0));
    }
    double value;
    if (messages || fmu.GetReal(c, &nothing, 1, &value) != fmi2Error || messages != 1) fail("a wrong reference was not refused with a message");
    ok(fmu.Terminate(c), "Terminate");
    fmu.FreeInstance(c);
    return 0;
}
