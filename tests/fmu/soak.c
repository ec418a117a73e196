/*
 * Drives two vehicles, one behind FMI 2.0 and one behind 3.0, for very many steps, then creates and
 * frees very many instances of all four kinds, and watches the memory of the process.
 *
 *   fmu_soak LIBRARY RESOURCE_PATH RESOURCE_URI GUID STEPS INSTANCES
 *
 * Prints a table of the memory (Linux: resident pages). Exit code 1 if it grew by more than
 * GROWTH after the first tenth, if files stay open, if a call fails or gives what is not finite,
 * or if the first drive cannot be repeated to the last bit at the end.
 */
#include "vehicle.h"

#include <dirent.h>
#include <time.h>
#include <unistd.h>

/* kB; samples in each part, the first tenth of which is warming up. */
enum { GROWTH = 1024, SAMPLES = 100, WARM = 10 };
/* The outputs are read after so many steps: they cost more than a step. */
enum { READ = 10 };

static const double STEP = 0.002;

/* Steps, and the wheel speeds at their end; a phase that is no ramp begins with them. */
static const struct phase {
    int steps;
    double left, right;
    int ramp;
} DRIVE[] = {
    {10, 0.0, 0.0, 0},  {80, 6.0, 6.0, 1},   {60, 8.0, 5.0, 1},  {40, 8.0, 5.0, 0},
    {30, 0.0, 0.0, 1},  {30, 0.0, 0.0, 0},   {50, -3.0, 3.0, 0}, {60, -5.0, -6.0, 1},
    {40, 10.0, 9.5, 0}, {30, 18.0, 20.0, 1}, {30, 0.0, 7.0, 0},  {40, 0.0, 0.0, 0},
};
enum { PHASES = sizeof DRIVE / sizeof *DRIVE, DRIVE_STEPS = 500, DRIVES_ON_A_TERRAIN = 1000, TERRAINS = 4 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Resident memory [kB]. */
static long resident(void) {
    long total, pages;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &total, &pages) != 2) fail("/proc/self/statm cannot be read");
    fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

static int open_files(void) {
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    if (!folder) fail("/proc/self/fd cannot be read");
    while (readdir(folder)) count++;
    closedir(folder);
    return count;
}

/* How far a part has come, and what it has needed. */
struct part {
    const char *what;
    long total, taken;
    double began, told;
    long memory[SAMPLES + 1];
};

static struct part begin(const char *what, long total) {
    struct part part = {.what = what, .total = total, .began = now()};
    part.memory[0] = resident();
    return part;
}

static void watch(struct part *part, long done) {
    double time = now();
    while (part->taken < SAMPLES && (double)done * SAMPLES >= (double)(part->taken + 1) * (double)part->total)
        part->memory[++part->taken] = resident();
    if (time - part->told < 5.0 && done < part->total) return;
    part->told = time;
    double left = (time - part->began) * (double)(part->total - done) / (double)done;
    fprintf(stderr, "soak: %s %ld of %ld, %ld kB, %.1f min left\n", part->what, done, part->total, resident(), left / 60.0);
}

/* Whether the memory stayed flat. */
static int report(const struct part *part) {
    double seconds = now() - part->began;
    long most = 0, warm = part->memory[WARM];
    for (int k = WARM; k <= SAMPLES; k++)
        if (part->memory[k] > most) most = part->memory[k];
    printf("%ld %s in %.0f s (%.2f us each), resident memory [kB] after each tenth:\n ", part->total, part->what, seconds,
           seconds / (double)part->total * 1e6);
    for (int k = 0; k <= SAMPLES; k += SAMPLES / 10) printf(" %ld", part->memory[k]);
    printf("\n  growth after the first tenth: %ld kB, of %d allowed\n", most - warm, GROWTH);
    fflush(stdout);
    return most - warm <= GROWTH;
}

/* One drive, with whatever comes out of it on the way. */
static uint64_t drive(struct vehicle *v) {
    static const fmi2ValueReference inputs[] = {UGV_VR_OMEGA_LEFT, UGV_VR_OMEGA_RIGHT};
    static const fmi2Integer orders[] = {1, 1};
    uint64_t digest = 0xcbf29ce484222325u;
    double speeds[2] = {0.0, 0.0}, values[OUTPUTS];
    for (int k = 0; k < PHASES; k++) {
        const struct phase *phase = &DRIVE[k];
        double seconds = STEP * phase->steps, rates[2] = {(phase->left - speeds[0]) / seconds, (phase->right - speeds[1]) / seconds};
        if (!phase->ramp) speeds[0] = phase->left, speeds[1] = phase->right;
        for (int i = 0; i < phase->steps; i++) {
            if (phase->ramp && v->version == 2)
                ok(fmu.SetRealInputDerivatives(v->handle, inputs, 2, orders, rates), "SetRealInputDerivatives");
            step(v, speeds, STEP);
            if (phase->ramp) speeds[0] += rates[0] * STEP, speeds[1] += rates[1] * STEP;
            if (i % READ != 0) continue;
            outputs(v, values);
            digest = digest_of(digest, values, OUTPUTS);
        }
    }
    return digest;
}

static int many_steps(long total) {
    struct vehicle vehicles[] = {create(2, 0), create(3, 0)};
    uint64_t first[2];
    long done = 0;
    start(&vehicles[0], 1), start(&vehicles[1], 1);
    struct part part = begin("steps", total);
    for (long drives = 0; done < total; drives++) {
        struct vehicle *v = &vehicles[drives % 2];
        long round = drives / 2;
        if (round && round % DRIVES_ON_A_TERRAIN == 0)
            reset(v), start(v, 1 + (int)(round / DRIVES_ON_A_TERRAIN % TERRAINS));
        uint64_t digest = drive(v);
        if (round == 0) first[drives % 2] = digest;
        through_bytes(v);
        watch(&part, done += DRIVE_STEPS);
    }
    for (int k = 0; k < 2; k++) {
        reset(&vehicles[k]), start(&vehicles[k], 1);
        if (drive(&vehicles[k]) != first[k]) fail("the first drive cannot be repeated");
        terminate(&vehicles[k]), release(&vehicles[k]);
    }
    return report(&part);
}

static void one_life(long number) {
    static const double speeds[] = {6.0, 5.0};
    double values[OUTPUTS];
    struct vehicle v = create(number % 2 ? 3 : 2, (int)(number / 2 % 2));
    set(&v, UGV_VR_VEHICLE_MASS, 300.0 + (double)(number % 200));
    start(&v, 1 + (int)(number % TERRAINS));
    for (int k = 0; k < 3; k++) step(&v, speeds, STEP);
    outputs(&v, values);
    through_bytes(&v);
    /* Some are left without a word. */
    if (number % 3) terminate(&v);
    release(&v);
}

static int many_instances(long total) {
    struct part part = begin("instances", total);
    for (long done = 1; done <= total; done++) {
        one_life(done);
        watch(&part, done);
    }
    return report(&part);
}

int main(int argc, char **argv) {
    if (argc != 7) fail("usage: fmu_soak LIBRARY RESOURCE_PATH RESOURCE_URI GUID STEPS INSTANCES");
    const char *missing = load_both(argv + 1);
    if (missing) fail(missing);
    int files = open_files();
    int steps_flat = many_steps(strtol(argv[5], NULL, 10)), instances_flat = many_instances(strtol(argv[6], NULL, 10));
    if (open_files() != files) fail("files stay open");
    if (!steps_flat || !instances_flat) fail("the memory grew");
    return 0;
}
