//! Wheel speeds over common times.

use super::channel::Channel;
use super::smoothing::knots;

/// Wheel speeds over time, linear in between; at least one row.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Time of each row \[s\], increasing.
    pub time: Vec<f64>,
    /// Angular speed of the left wheels in each row \[rad/s\].
    pub omega_left: Vec<f64>,
    /// Angular speed of the right wheels in each row \[rad/s\].
    pub omega_right: Vec<f64>,
    /// Rows in which a missing wheel speed was interpolated.
    pub filled_rows: usize,
}

impl Drive {
    /// From samples with gaps, which are filled linearly; the first and the last sample are held. Fails with the side that
    /// has no sample.
    pub(super) fn interpolated(
        time: Vec<f64>,
        left: &[Option<f64>],
        right: &[Option<f64>],
    ) -> Result<Self, Channel> {
        let pairs = left.iter().zip(right);
        Ok(Self {
            omega_left: fill_gaps(&time, left).ok_or(Channel::OmegaLeft)?,
            omega_right: fill_gaps(&time, right).ok_or(Channel::OmegaRight)?,
            filled_rows: pairs.filter(|(l, r)| l.is_none() || r.is_none()).count(),
            time,
        })
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// From the first row to the last \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Left and right wheel speed in a row \[rad/s\].
    #[must_use]
    pub fn wheel_speeds(&self, row: usize) -> [f64; 2] {
        [self.omega_left[row], self.omega_right[row]]
    }

    /// The drive whose linear interpolation reproduces the samples. If they were `counted`, as by encoders, a sample is the
    /// mean from the middle of the interval before to the middle of the interval after. Without smoothing this keeps the
    /// angle of the wheels. Otherwise a sample is the value at its time.
    ///
    /// `smoothing` is the weight of the squared second differences against the squared distances from the samples, for
    /// evenly spaced samples (Whittaker's smoother).
    #[must_use]
    pub fn reconstructed(mut self, counted: bool, smoothing: f64) -> Self {
        for side in [&mut self.omega_left, &mut self.omega_right] {
            *side = knots(&self.time, side, counted, smoothing);
        }
        self
    }

    /// The rates at which left and right wheel speed change from a row to the next
    /// \[rad/s^2\]; zero after the last.
    #[must_use]
    pub fn wheel_accelerations(&self, row: usize) -> [f64; 2] {
        if row + 1 == self.len() {
            return [0.0; 2];
        }
        let seconds = self.time[row + 1] - self.time[row];
        let (from, to) = (self.wheel_speeds(row), self.wheel_speeds(row + 1));
        [0, 1].map(|side| (to[side] - from[side]) / seconds)
    }
}

/// Fills gaps between samples linearly and holds the first and the last sample beyond them. `None` without any sample.
fn fill_gaps(time: &[f64], samples: &[Option<f64>]) -> Option<Vec<f64>> {
    let mut filled = Vec::with_capacity(samples.len());
    let mut last: Option<(usize, f64)> = None;
    for (row, sample) in samples.iter().enumerate() {
        let Some(value) = *sample else { continue };
        let (from, start) = last.map_or((time[row], value), |(at, start)| (time[at], start));
        while filled.len() < row {
            let share = (time[filled.len()] - from) / (time[row] - from);
            let between = start + (value - start) * share;
            filled.push(if last.is_some() { between } else { value });
        }
        filled.push(value);
        last = Some((row, value));
    }
    let (_, end) = last?;
    filled.resize(samples.len(), end);
    Some(filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_filled_linearly_and_ends_held() {
        let time = [0.0, 1.0, 2.0, 4.0, 5.0, 6.0];
        let samples = [None, Some(2.0), None, None, Some(10.0), None];
        let filled = fill_gaps(&time, &samples).unwrap();
        assert_eq!(filled, [2.0, 2.0, 4.0, 8.0, 10.0, 10.0]);
        assert_eq!(fill_gaps(&time[..2], &[None, None]), None);
    }

    #[test]
    fn counted_wheel_speeds_keep_the_angle_between_the_middles_of_intervals() {
        let time: Vec<f64> = [0.0, 0.05, 0.11, 0.15, 0.2, 0.3, 0.35, 0.4].into();
        let samples = [0.0, 0.0, 1.0, 3.0, 2.5, 2.0, 2.0, 2.0];
        let drive = Drive {
            omega_left: samples.to_vec(),
            omega_right: time.iter().map(|t| 1.0 + 2.0 * t).collect(),
            time,
            filled_rows: 0,
        };
        let counted = drive.clone().reconstructed(true, 0.0);
        let speed = |time: f64| {
            let row = counted.time.partition_point(|t| *t <= time).max(1) - 1;
            let rate = counted.wheel_accelerations(row)[0];
            counted.omega_left[row] + rate * (time - counted.time[row])
        };
        for (row, sample) in samples.iter().enumerate().take(7).skip(1) {
            let here = drive.time[row];
            let middles = [drive.time[row - 1], drive.time[row + 1]].map(|t| 0.5 * (here + t));
            // Straight on either side of the row: trapezia.
            let angle = |a: f64, b: f64| 0.5 * (b - a) * (speed(a) + speed(b));
            let mean =
                (angle(middles[0], here) + angle(here, middles[1])) / (middles[1] - middles[0]);
            assert!((mean - sample).abs() < 1e-12, "{row}: {mean}");
        }
        let ends = [counted.omega_left[0], counted.omega_left[7] - 2.0];
        assert!(ends.iter().all(|end| end.abs() < 1e-12), "{ends:?}");
        assert!(counted.omega_left[3] > 3.2, "the corner is whole again");
        // Between equal intervals a steady change stays straight.
        let steady = |row: usize| (counted.omega_right[row] - drive.omega_right[row]).abs();
        assert!(steady(6) < 0.01);
        // Two rows have no middle.
        let two = Drive {
            time: vec![0.0, 1.0],
            omega_left: vec![1.0, 5.0],
            omega_right: vec![0.0; 2],
            filled_rows: 0,
        };
        assert_eq!(two.clone().reconstructed(true, 0.0), two);
    }

    #[test]
    fn accelerations_are_the_slopes() {
        let drive = Drive {
            time: vec![1.0, 1.5],
            omega_left: vec![2.0, 3.0],
            omega_right: vec![4.0, 2.0],
            filled_rows: 0,
        };
        assert_eq!(drive.wheel_accelerations(0), [2.0, -4.0]);
        assert_eq!(drive.wheel_accelerations(1), [0.0; 2]);
        assert_eq!(drive.duration(), 0.5);
    }
}
