/* Times the FMU from C: the drive of a table on a soil, in so many steps for each row, and the calls around a step.
 *
 *   fmu_steps LIBRARY GUID RESOURCES TABLE.csv TERRAIN PARTS
 *
 * TERRAIN is the number of the soil, as the FMU's parameter `terrain` has it. Prints, as JSON, seconds of the processor:
 * of the drive, of its dearest step, and of the calls other than doStep, each the best of several runs; the final pose, and
 * the peak memory. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "fmi2FunctionTypes.h"
#include "ugv.h"

#define ROWS_MAX 100000
#define RUNS 5

static double table[ROWS_MAX][3];

static void silent(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String m, ...) {
    (void)e, (void)n, (void)s, (void)c;
    fprintf(stderr, "%s\n", m);
}

static double processor(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
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
    if (argc != 7) {
        fprintf(stderr, "usage: fmu_steps LIBRARY GUID RESOURCES TABLE.csv TERRAIN PARTS\n");
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
    const int terrain = atoi(argv[5]), parts = atoi(argv[6]);
    if (rows < 2 || terrain < 1 || parts < 1) {
        fprintf(stderr, "TABLE has two rows or more, TERRAIN and PARTS are 1 or more\n");
        return 2;
    }
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
    LOAD(fmi2SetInteger);
    LOAD(fmi2SetReal);
    LOAD(fmi2SetRealInputDerivatives);
    LOAD(fmi2GetReal);
    LOAD(fmi2DoStep);
    fmi2CallbackFunctions callbacks = {silent, calloc, free, NULL, NULL};
    fmi2Component c = fmi2Instantiate("bench", fmi2CoSimulation, argv[2], argv[3], &callbacks, 0, 0);
    if (!c) return 1;
    const fmi2ValueReference soil = UGV_VR_TERRAIN, inputs[2] = {UGV_VR_OMEGA_LEFT, UGV_VR_OMEGA_RIGHT};
    fmi2ValueReference outputs[6];
    for (int k = 0; k < 6; k++) outputs[k] = UGV_VR_X + (fmi2ValueReference)k;
    const fmi2Integer orders[2] = {1, 1};
    const int steps = (rows - 1) * parts;
    double *dearest = malloc(sizeof *dearest * (size_t)steps);
    if (!dearest) return 1;
    for (int k = 0; k < steps; k++) dearest[k] = 1e9;
    double out[6], best_drive = 1e9, best_calls = 1e9;
    /* A clock around each step would slow down the drive: every other run has it. */
    for (int run = 0; run < 2 * RUNS; run++) {
        const int each = run % 2;
        fmi2Reset(c);
        if (fmi2SetInteger(c, &soil, 1, &terrain) != fmi2OK) return 1;
        fmi2SetupExperiment(c, 0, 0, 0, 0, 0);
        fmi2EnterInitializationMode(c);
        if (fmi2ExitInitializationMode(c) != fmi2OK) return 1;
        const double start = processor();
        for (int k = 0; k + 1 < rows; k++) {
            const double *a = table[k], *b = table[k + 1], step = (b[0] - a[0]) / parts;
            const double rate[2] = {(b[1] - a[1]) / (b[0] - a[0]), (b[2] - a[2]) / (b[0] - a[0])};
            for (int part = 0; part < parts; part++) {
                const double elapsed = (b[0] - a[0]) * part / parts;
                const double speeds[2] = {a[1] + rate[0] * elapsed, a[2] + rate[1] * elapsed};
                const double before = each ? processor() : 0.0;
                fmi2SetReal(c, inputs, 2, speeds);
                fmi2SetRealInputDerivatives(c, inputs, 2, orders, rate);
                if (fmi2DoStep(c, a[0] + elapsed, step, 1) != fmi2OK) return 1;
                fmi2GetReal(c, outputs, 6, out);
                if (each) {
                    const double seconds = processor() - before;
                    if (seconds < dearest[k * parts + part]) dearest[k * parts + part] = seconds;
                }
            }
        }
        const double seconds = processor() - start;
        if (!each && seconds < best_drive) best_drive = seconds;
        const int calls = 50000;
        double speeds[2], rate[2] = {0, 0}, last[6];
        fmi2GetReal(c, inputs, 2, speeds);
        const double begun = processor();
        for (int k = 0; k < calls; k++) {
            fmi2SetReal(c, inputs, 2, speeds);
            fmi2SetRealInputDerivatives(c, inputs, 2, orders, rate);
            fmi2GetReal(c, outputs, 6, last);
        }
        const double one = (processor() - begun) / calls;
        if (one < best_calls) best_calls = one;
    }
    double worst = 0.0;
    for (int k = 0; k < steps; k++)
        if (dearest[k] > worst) worst = dearest[k];
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("{\"terrain\": %d, \"step\": %.9g, \"steps\": %d, \"drive\": %.9g, \"mean_step\": %.9g, \"worst_step\": %.9g, \"calls\": %.9g, "
           "\"peak_kilobytes\": %ld, \"end\": [%.12g, %.12g, %.12g]}\n",
           terrain, (table[1][0] - table[0][0]) / parts, steps, best_drive, best_drive / steps, worst, best_calls,
           usage.ru_maxrss, out[0], out[1], out[2]);
    return 0;
}
