/*
 * As drive.c, behind FMI 3.0: fmu_drive_3 LIBRARY RESOURCES TOKEN VALUES REFERENCE...
 * VALUES is how many values the variables have together. Wheel speeds are held within a step: FMI 3.0 has no
 * input derivatives. After the drive comes a directional derivative, of the first variable by the left wheels' speed.
 */
#include "host_3.h"
#include "manoeuvre.h"

#include <stdio.h>
#include <stdlib.h>

enum { MOST = 200 };

static fmi3ValueReference references[MOST];
static size_t count, value_count;
static int messages;

static void fail(const char *what) {
    fprintf(stderr, "fmu_drive_3: %s\n", what);
    exit(1);
}

static void ok(fmi3Status status, const char *what) {
    if (status != fmi3OK) fail(what);
}

static void logger(fmi3InstanceEnvironment e, fmi3Status s, fmi3String category, fmi3String text) {
    (void)e, (void)s, (void)category;
    fprintf(stderr, "%s\n", text);
    messages++;
}

static void print(fmi3Instance c, double time) {
    double values[MOST];
    ok(fmu3.GetFloat64(c, references, count, values, value_count), "GetFloat64");
    printf("%.17g", time);
    for (size_t k = 0; k < value_count; k++) printf(" %.17g", values[k]);
    printf("\n");
}

/* Takes the state along as bytes into a new instance. */
static fmi3Instance move(fmi3Instance old, fmi3Instance fresh) {
    fmi3FMUState state = NULL, same = NULL;
    size_t size = 0;
    ok(fmu3.GetFMUState(old, &state), "GetFMUState");
    ok(fmu3.SerializedFMUStateSize(old, state, &size), "SerializedFMUStateSize");
    fmi3Byte *bytes = malloc(size);
    ok(fmu3.SerializeFMUState(old, state, bytes, size), "SerializeFMUState");
    ok(fmu3.FreeFMUState(old, &state), "FreeFMUState");
    fmu3.FreeInstance(old);
    ok(fmu3.DeserializeFMUState(fresh, bytes, size, &same), "DeserializeFMUState");
    ok(fmu3.SetFMUState(fresh, same), "SetFMUState");
    ok(fmu3.FreeFMUState(fresh, &same), "FreeFMUState");
    free(bytes);
    return fresh;
}

static fmi3Instance instantiate(const char *name, char **argv) {
    return fmu3.InstantiateCoSimulation(name, argv[3], argv[2], 0, 1, 0, 0, NULL, 0, NULL, logger, NULL);
}

int main(int argc, char **argv) {
    static const fmi3ValueReference inputs[] = {0, 1}, nothing = 999999999;
    if (argc < 6 || argc - 5 > MOST) fail("usage: fmu_drive_3 LIBRARY RESOURCES TOKEN VALUES REFERENCE...");
    const char *missing = load_3(argv[1]);
    if (missing) fail(missing);
    value_count = strtoul(argv[4], NULL, 10);
    if (value_count > MOST) fail("too many values");
    for (int k = 5; k < argc; k++) references[count++] = (fmi3ValueReference)strtoul(argv[k], NULL, 10);
    fmi3Instance c = instantiate("drive", argv);
    if (!c || messages) fail("InstantiateCoSimulation");
    ok(fmu3.EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0), "EnterInitializationMode");
    ok(fmu3.ExitInitializationMode(c), "ExitInitializationMode");
    print(c, 0.0);
    double now[2] = {0.0, 0.0};
    long done = 0;
    for (size_t k = 0; k < PHASE_COUNT; k++) {
        for (long i = 0; i < steps_of(&PHASES[k]); i++) {
            bool event, ended, early;
            double rates[2], speeds[2], reached;
            wheels(&PHASES[k], now, i, speeds, rates);
            ok(fmu3.SetFloat64(c, inputs, 2, speeds, 2), "SetFloat64");
            ok(fmu3.DoStep(c, (double)done * STEP, STEP, 1, &event, &ended, &early, &reached), "DoStep");
            if (event || ended || early) fail("a step ended early");
            done++;
            print(c, (double)done * STEP);
        }
        now[0] = PHASES[k].left, now[1] = PHASES[k].right;
        if (k == MOVED_AFTER) c = move(c, instantiate("later", argv));
    }
    static const fmi3String errors = "logStatusError";
    const double seed = 1.0;
    double value;
    ok(fmu3.GetDirectionalDerivative(c, &references[0], 1, inputs, 1, &seed, 1, &value, 1), "GetDirectionalDerivative");
    if (!isfinite(value)) fail("a derivative is not finite");
    ok(fmu3.SetDebugLogging(c, 1, 1, &errors), "SetDebugLogging");
    if (messages || fmu3.GetFloat64(c, &nothing, 1, &value, 1) != fmi3Error || messages != 1)
        fail("a wrong reference was not refused with a message");
    ok(fmu3.Terminate(c), "Terminate");
    fmu3.FreeInstance(c);
    return 0;
}
