/* Random numbers for fmu_host.c. */
#ifndef FMU_HOST_RANDOM_H
#define FMU_HOST_RANDOM_H

#include <math.h>
#include <stdint.h>

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
