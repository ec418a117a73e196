/* Times the FMU from C: the drive of a table in steps of 10 ms, and the calls around a step.
 *
 *   fmu_steps LIBRARY GUID RESOURCES TABLE.csv
 *
 * prints, as JSON, seconds of the 60 s drive and nanoseconds of the calls other than doStep,
 * each the best of several runs, and the peak memory. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "fmi2FunctionTypes.h"

#define ROWS_MAX 100000
#define PARTS 5 /* steps for each row of the table */
#define RUNS 15

static double table[ROWS_MAX][3];

static void silent(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String m, ...) {
    (void)e, (void)n, (void)s, (void)c;
    fprintf(stderr, "%s\n", m);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *function(void *library, const char *name) {
    void *symbol = dlsym(library, name);
    if (!symbol) {
        fprintf(stderr, "%s is missing\n", name);
        exit(1);
    }
    return symbol;
}

#define LOAD(name) name##TYPE *name = (name##TYPE *)function(library, #name)

int main(int argc, char **argv) {
    if (argc != 5) {
        fprintf(stderr, "usage: fmu_steps LIBRARY GUID RESOURCES TABLE.csv\n");
        return 2;
    }
    FILE *file = fopen(argv[4], "r");
    char line[256];
    if (!file || !fgets(line, sizeof line, file)) {
        fprintf(stderr, "%s cannot be read\n", argv[4]);
        return 1;
    }
    int rows = 0;
    while (rows < ROWS_MAX && fgets(line, sizeof line, file)) {
        double *r = table[rows++];
        if (sscanf(line, "%lf,%lf,%lf", r, r + 1, r + 2) != 3) return 1;
    }
    fclose(file);
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 1;
    }
    LOAD(fmi2Instantiate);
    LOAD(fmi2SetupExperiment);
    LOAD(fmi2EnterInitializationMode);
    LOAD(fmi2ExitInitializationMode);
    LOAD(fmi2Reset);
    LOAD(fmi2SetReal);
    LOAD(fmi2SetRealInputDerivatives);
    LOAD(fmi2GetReal);
    LOAD(fmi2DoStep);
    fmi2CallbackFunctions callbacks = {silent, calloc, free, NULL, NULL};
    fmi2Component c = fmi2Instantiate("bench", fmi2CoSimulation, argv[2], argv[3], &callbacks, 0, 0);
    if (!c) return 1;
    const fmi2ValueReference inputs[2] = {0, 1}, outputs[6] = {2, 3, 4, 5, 6, 7};
    const fmi2Integer orders[2] = {1, 1};
    double out[6], best_drive = 1e9, best_calls = 1e9;
    for (int run = 0; run < RUNS; run++) {
        fmi2Reset(c);
        fmi2SetupExperiment(c, 0, 0, 0, 0, 0);
        fmi2EnterInitializationMode(c);
        fmi2ExitInitializationMode(c);
        double start = now();
        for (int k = 0; k + 1 < rows; k++) {
            const double *a = table[k], *b = table[k + 1], step = (b[0] - a[0]) / PARTS;
            const double rate[2] = {(b[1] - a[1]) / (b[0] - a[0]), (b[2] - a[2]) / (b[0] - a[0])};
            for (int part = 0; part < PARTS; part++) {
                const double elapsed = (b[0] - a[0]) * part / PARTS;
                const double speeds[2] = {a[1] + rate[0] * elapsed, a[2] + rate[1] * elapsed};
                fmi2SetReal(c, inputs, 2, speeds);
                fmi2SetRealInputDerivatives(c, inputs, 2, orders, rate);
                if (fmi2DoStep(c, a[0] + elapsed, step, 1) != fmi2OK) return 1;
                fmi2GetReal(c, outputs, 6, out);
            }
        }
        double seconds = now() - start;
        if (seconds < best_drive) best_drive = seconds;
        const int calls = 200000;
        double speeds[2], rate[2] = {0, 0};
        fmi2GetReal(c, inputs, 2, speeds);
        start = now();
        for (int k = 0; k < calls; k++) {
            fmi2SetReal(c, inputs, 2, speeds);
            fmi2SetRealInputDerivatives(c, inputs, 2, orders, rate);
            fmi2GetReal(c, outputs, 6, out);
        }
        double each = (now() - start) / calls;
        if (each < best_calls) best_calls = each;
    }
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("{\"drive_seconds\": %.9f, \"simulated_seconds\": %.3f, \"calls_nanoseconds\": %.2f, \"peak_kilobytes\": %ld, \"end\": [%.12g, %.12g]}\n",
           best_drive, table[rows - 1][0] - table[0][0], 1e9 * best_calls, usage.ru_maxrss, out[0], out[1]);
    return 0;
}
