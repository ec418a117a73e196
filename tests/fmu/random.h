/*
 * Random calls by four actors, of either version of the standard: what host.c and host_3.c share.
 * They define COUNT and FUNCTION_NAMES, the functions of their version, before they include this; and
 * `call`, `choose`, `begin` and `finish` after it.
 */
#ifndef FMU_RANDOM_H
#define FMU_RANDOM_H

#include "host.h"
#include "ugv.h"

#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ACTORS = 4, SLOTS = 3, STATES = 4, MOST = 8, STATUSES = 6 };

/* An instance, and the time that it should have reached. */
struct slot {
    void *component;
    double time;
};

struct actor {
    uint64_t random, digest;
    struct slot slots[SLOTS];
    void *states[STATES];
    double state_times[STATES];
    void *bytes;
    size_t size;
    double bytes_time;
    unsigned long count[COUNT][STATUSES];
    long calls;
};

static const char *resources, *guid;

static void fail(const char *what) {
    fprintf(stderr, "fmu_host: %s\n", what);
    exit(1);
}

/* Makes a call and returns its status; which one, what for, and how it ends. */
static int call(struct actor *a, int function);
static int choose(struct actor *a);
static void begin(struct actor *a, struct slot *slot);
static void finish(struct actor *a);
static const char *load_functions(const char *path);

static int integer(struct actor *a) { return percent(&a->random, 90) ? 1 + (int)below(&a->random, 5) : (int)draw(&a->random); }

static void digest(struct actor *a, const void *data, size_t size) {
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) a->digest = (a->digest ^ bytes[i]) * 0x100000001b3u;
}

/* What a logger gets: texts, that cannot be taken for formats. */
static void take_note(struct actor *a, unsigned status, const char *category, const char *message) {
    if (!category || !message) fail("the logger got a null pointer");
    if (strchr(message, '#')) fail("a message could be taken for a format");
    if (strncmp(category, "log", 3) != 0) fail("a log category is not declared");
    digest(a, &status, sizeof status);
    digest(a, message, strlen(message));
}

/* Arrays have exactly the size that is told, for a memory checker to see what goes beyond. */
static void *array(struct actor *a, size_t count, size_t size) {
    if (percent(&a->random, count ? 2 : 50)) return NULL;
    void *memory = calloc(count ? count : 1, size);
    if (!memory) fail("out of memory");
    return memory;
}

static double *reals(struct actor *a, size_t count, double size) {
    double *values = array(a, count, sizeof *values);
    for (size_t i = 0; values && i < count; i++) values[i] = real(&a->random, size);
    return values;
}

/* Mostly inputs, outputs or parameters that are there. */
static unsigned reference(struct actor *a) {
    switch (below(&a->random, 10)) {
    case 0: return below(&a->random, 60);
    case 1: return 1000 + below(&a->random, 5);
    case 2: case 3: return 2000 + 16 * below(&a->random, 8) + below(&a->random, 7);
    case 4: return percent(&a->random, 70) ? below(&a->random, 13) : (unsigned)draw(&a->random);
    case 5: case 6: return 2 + below(&a->random, 11);
    case 7: return 500 + 16 * below(&a->random, 21) + below(&a->random, 7);
    default: return below(&a->random, 2);
    }
}

static unsigned *references(struct actor *a, size_t count, int inputs) {
    unsigned *values = array(a, count, sizeof *values);
    for (size_t i = 0; values && i < count; i++)
        values[i] = inputs && percent(&a->random, 85) ? below(&a->random, 2) : reference(a);
    return values;
}

static void one_call(struct actor *a) {
    if (percent(&a->random, 5)) begin(a, &a->slots[below(&a->random, SLOTS)]);
    int function = choose(a);
    int status = call(a, function);
    a->count[function][status]++;
    digest(a, &status, sizeof status);
    a->calls--;
}

static void *all_calls(void *actor) {
    struct actor *a = actor;
    while (a->calls > 0) one_call(a);
    return NULL;
}

static void run(struct actor *actors, const char *way, uint64_t seed, long calls) {
    uint64_t schedule = seed;
    memset(actors, 0, ACTORS * sizeof *actors);
    for (unsigned k = 0; k < ACTORS; k++) {
        actors[k].random = draw(&schedule);
        actors[k].calls = calls / ACTORS;
    }
    if (strcmp(way, "threads") == 0) {
        pthread_t threads[ACTORS];
        for (unsigned k = 0; k < ACTORS; k++)
            if (pthread_create(&threads[k], NULL, all_calls, &actors[k]) != 0) fail("no thread");
        for (unsigned k = 0; k < ACTORS; k++) pthread_join(threads[k], NULL);
    } else if (strcmp(way, "mixed") == 0) {
        for (long done = 0; done < calls / ACTORS * ACTORS;) {
            struct actor *a = &actors[below(&schedule, ACTORS)];
            if (a->calls > 0) one_call(a), done++;
        }
    } else if (strcmp(way, "serial") == 0) {
        for (unsigned k = 0; k < ACTORS; k++) all_calls(&actors[k]);
    } else {
        fail("the ways are mixed, serial and threads");
    }
    for (unsigned k = 0; k < ACTORS; k++) finish(&actors[k]);
}

int main(int argc, char **argv) {
    static struct actor first[ACTORS], again[ACTORS];
    if (argc < 7) fail("usage: LIBRARY RESOURCES GUID SEED CALLS WAY...");
    const char *missing = load_functions(argv[1]);
    if (missing) fail(missing);
    resources = argv[2], guid = argv[3];
    uint64_t seed = strtoull(argv[4], NULL, 10);
    long calls = strtol(argv[5], NULL, 10);
    run(first, argv[6], seed, calls);
    for (int way = 7; way < argc; way++) {
        run(again, argv[way], seed, calls);
        for (unsigned k = 0; k < ACTORS; k++)
            if (again[k].digest != first[k].digest) fail("the ways saw different things");
    }
    for (unsigned f = 0; f < COUNT; f++) {
        printf("%s", FUNCTION_NAMES[f]);
        for (unsigned status = fmi2OK; status <= fmi2Error; status++) {
            unsigned long sum = 0;
            for (unsigned k = 0; k < ACTORS; k++) sum += first[k].count[f][status];
            printf(" %lu", sum);
        }
        printf("\n");
    }
    return 0;
}

#endif
