/*
 * Drives 64 vehicles at once in 16 threads, each with parameters and wheel speeds of its own, half of them
 * behind FMI 2.0 and half behind 3.0, some for model exchange; and each alone, one after the other.
 * From round to round the vehicles wander from thread to thread. Both ways must give the same bits.
 *
 *   fmu_threads LIBRARY RESOURCE_PATH RESOURCE_URI GUID ROUNDS [warm]
 *
 * With `warm` vehicles drive before the threads begin: what the library makes once is there then. It is guarded by
 * atomics, of which valgrind's helgrind and drd do not know, and they would take it for a race.
 *
 * Exit code: 0, or 1 if something is wrong.
 */
#include "vehicle.h"

#include <pthread.h>

enum { VEHICLES = 64, THREADS = 16, STEPS_OF_A_ROUND = 10 };

static const double STEP = 0.01;

struct drive {
    struct vehicle vehicle;
    uint64_t digest;
};

static struct drive alone[VEHICLES], together[VEHICLES];
static long rounds;

/* Waits until all threads are here. Not a pthread_barrier_t, which helgrind does not know of every C library. */
static void meet(void) {
    static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    static pthread_cond_t all = PTHREAD_COND_INITIALIZER;
    static long arrived, meeting;
    pthread_mutex_lock(&mutex);
    long mine = meeting;
    if (++arrived == THREADS) {
        arrived = 0, meeting++;
        pthread_cond_broadcast(&all);
    }
    while (mine == meeting) pthread_cond_wait(&all, &mutex);
    pthread_mutex_unlock(&mutex);
}

/* A vehicle unlike the others. */
static void begin(struct drive *drive, int number) {
    struct vehicle *v = &drive->vehicle;
    *drive = (struct drive){create(2 + number % 2, number % 8 >= 6), 0xcbf29ce484222325u};
    set(v, UGV_VR_VEHICLE_MASS, 250.0 + 3.0 * number);
    set(v, UGV_VR_INITIAL_HEADING, 0.1 * number);
    if (number % 3 == 0) set(v, UGV_VR_EFFECTS_GRADE_SLOPE_EAST, 0.002 * number);
    if (number % 5 == 0) set(v, UGV_VR_EFFECTS_PAYLOAD_MASS, 1.0 + number);
    start(v, 1 + number % 4);
}

static void go_on(struct drive *drive, int number, long round) {
    double values[OUTPUTS];
    for (int k = 0; k < STEPS_OF_A_ROUND; k++) {
        double time = STEP * (double)(round * STEPS_OF_A_ROUND + k), swing = sin(time * (1.0 + 0.05 * number));
        const double speeds[] = {5.0 * swing + 0.05 * number, 5.0 * swing - 0.1 * (number % 7)};
        step(&drive->vehicle, speeds, STEP);
        outputs(&drive->vehicle, values);
        drive->digest = digest_of(drive->digest, values, OUTPUTS);
    }
    if ((round + number) % 4 == 0) through_bytes(&drive->vehicle);
}

static void end(struct drive *drive) {
    terminate(&drive->vehicle);
    release(&drive->vehicle);
}

/* What a thread does: in each round the vehicles that have come to it. */
static void *work(void *number) {
    long thread = (long)(intptr_t)number;
    meet();
    for (long round = -1; round <= rounds; round++) {
        for (int k = 0; k < VEHICLES; k++) {
            if ((k + round + 1) % THREADS != thread) continue;
            if (round < 0) begin(&together[k], k);
            else if (round < rounds) go_on(&together[k], k, round);
            else end(&together[k]);
        }
        meet();
    }
    return NULL;
}

int main(int argc, char **argv) {
    pthread_t threads[THREADS];
    if (argc != 6 && argc != 7) fail("usage: fmu_threads LIBRARY RESOURCE_PATH RESOURCE_URI GUID ROUNDS [warm]");
    const char *missing = load_both(argv + 1);
    if (missing) fail(missing);
    rounds = strtol(argv[5], NULL, 10);
    for (int k = 0; argc == 7 && k < 2 * THREADS; k++) {
        begin(&alone[k], k);
        for (long round = 0; round < 4; round++) go_on(&alone[k], k, round);
        end(&alone[k]);
    }
    for (intptr_t k = 0; k < THREADS; k++)
        if (pthread_create(&threads[k], NULL, work, (void *)k) != 0) fail("no thread");
    for (int k = 0; k < THREADS; k++) pthread_join(threads[k], NULL);
    for (int k = 0; k < VEHICLES; k++) {
        begin(&alone[k], k);
        for (long round = 0; round < rounds; round++) go_on(&alone[k], k, round);
        end(&alone[k]);
        if (alone[k].digest != together[k].digest) {
            fprintf(stderr, "vehicle %d drove otherwise among others than alone\n", k);
            return 1;
        }
        for (int other = 0; other < k; other++)
            if (alone[other].digest == alone[k].digest) fail("two vehicles drove the same");
    }
    printf("%d vehicles in %d threads, %ld steps each: the same bits as alone\n", VEHICLES, THREADS, rounds * STEPS_OF_A_ROUND);
    return 0;
}
