/* What drive.c and drive_3.c drive. */
#ifndef FMU_MANOEUVRE_H
#define FMU_MANOEUVRE_H

#include <stddef.h>

/* Seconds, and the wheel speeds at their end; a phase that is no ramp begins with them. */
static const struct phase {
    double seconds, left, right;
    int ramp;
} PHASES[] = {
    {0.10, 0.0, 0.0, 0}, {0.80, 6.0, 6.0, 1}, {0.60, 8.0, 5.0, 1},   {0.40, 8.0, 5.0, 0},
    {0.30, 0.0, 0.0, 1}, {0.30, 0.0, 0.0, 0}, {0.50, -3.0, 3.0, 0},  {0.60, -5.0, -6.0, 1},
    {0.40, 10.0, 9.5, 0}, {0.30, 18.0, 20.0, 1}, {0.30, 0.0, 0.0, 0},
};
enum { PHASE_COUNT = sizeof PHASES / sizeof *PHASES };
/* The phase after which the state goes into a new instance. */
enum { MOVED_AFTER = 3 };

static const double STEP = 0.01;

static long steps_of(const struct phase *phase) { return (long)(phase->seconds / STEP + 0.5); }

/* Wheel speeds after `i` steps of a phase that begins with `from`, and their rates. */
static void wheels(const struct phase *phase, const double from[2], long i, double speeds[2], double rates[2]) {
    const double target[2] = {phase->left, phase->right};
    for (int side = 0; side < 2; side++) {
        rates[side] = phase->ramp ? (target[side] - from[side]) / phase->seconds : 0.0;
        speeds[side] = phase->ramp ? from[side] + rates[side] * (double)i * STEP : target[side];
    }
}

#endif
