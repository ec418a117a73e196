//! The way that a vehicle went.

use super::Series;

/// Way along the heading from the first position on \[m\], negative in reverse, at the times of x
/// at which the other two are known; heading in \[rad\].
#[must_use]
pub fn way_along(x: &Series, y: &Series, heading: &Series) -> Series {
    let mut total = 0.0;
    let mut last: Option<[f64; 3]> = None;
    let mut points = Vec::new();
    for (time, east) in x.samples() {
        let (Some(north), Some(angle)) = (y.at(time), heading.at(time)) else {
            continue;
        };
        if let Some([from_east, from_north, from]) = last {
            // Unwrapped or not, the mean direction is that of the sum of both.
            let (cos, sin) = (angle.cos() + from.cos(), angle.sin() + from.sin());
            let length = cos.hypot(sin).max(f64::MIN_POSITIVE);
            total += ((east - from_east) * cos + (north - from_north) * sin) / length;
        }
        last = Some([east, north, angle]);
        points.push((time, total));
    }
    points.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reverse_counts_backward_and_sideways_not_at_all() {
        let series = |values: [f64; 4]| -> Series {
            let times = [0.0, 1.0, 2.0, 3.0];
            times.into_iter().zip(values).collect()
        };
        let x = series([0.0, 2.0, 1.0, 1.0]);
        let y = series([0.0, 0.0, 0.0, 5.0]);
        assert_eq!(
            way_along(&x, &y, &series([0.0; 4])).value,
            [0.0, 2.0, 1.0, 1.0]
        );
    }
}
