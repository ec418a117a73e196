/* Speed and yaw rate of a skid-steer vehicle by its wheel speeds, with a limit on the wheels' slip.
 *
 * Each side has a PI controller of the speed that it covers over ground. Thrust grows with slip up to some
 * slip, beyond which wheels dig: its demand is bounded to covered / (1 - slip_limit), at which the wheels slip
 * by slip_limit, and to creep_speed where the vehicle all but stands. While the bound holds the integral
 * waits (no wind-up). slip_limit = 1 switches the bound off. Wheels that brake are not bounded.
 */
#include <math.h>

#include "block.h"
#include "variables.h"

static double side(double *v, double direction, double *integral, double step)
{
    double demand = v[speed_demand] + direction * v[half_track] * v[yaw_rate_demand];
    double covered = v[v_x] + direction * v[half_track] * v[yaw_rate];
    double error = demand - covered;
    double bound = v[slip_limit] < 1.0 ? fmax(fabs(covered) / (1.0 - v[slip_limit]), v[creep_speed]) : INFINITY;
    double limit = fmin(bound, v[wheel_radius] * v[omega_limit]);
    double wanted = demand + v[gain] * error + *integral;
    double given = fmin(fmax(wanted, -limit), limit);

    if (given == wanted || error * wanted < 0.0)
        *integral += v[integral_gain] * error * step;
    return given / v[wheel_radius];
}

void advance(double *v, double time, double step)
{
    v[omega_left] = side(v, -1.0, &v[integral_left], step);
    v[omega_right] = side(v, 1.0, &v[integral_right], step);
}
