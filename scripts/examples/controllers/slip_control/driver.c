/* What the driver wants: a speed that rises to `speed`, and a turn from `turn_from` to `turn_until`. */
#include <math.h>

#include "block.h"
#include "variables.h"

void advance(double *v, double time, double step)
{
    double end = time + step;

    v[speed_demand] = fmin(v[acceleration] * end, v[speed]);
    v[yaw_rate_demand] = end >= v[turn_from] && end < v[turn_until] ? v[turn_rate] : 0.0;
}
