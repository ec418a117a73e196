//! What the wheels of each side add to a motion.

use super::cumulated::{Cumulated, DELAY_STEP, SENSOR_DELAYS, TimeGrid};
use nalgebra::{Matrix2, Vector2};

/// Window of the mean rates \[s\].
const WINDOW: f64 = 1.0;
/// Fewer windows, which overlap, prove nothing.
const MIN_WINDOWS: usize = 160;
/// Maximum share of the motion that the wheels leave unexplained. Seven real recordings have 0.05 to 0.30; with one side's
/// wheel speeds frozen for most of the time, 0.4 to 0.9.
const UNEXPLAINED: f64 = 0.4;
/// Minimum of a ratio over its standard error. Straight driving alone does not separate the sides.
const CLEAR: f64 = 5.0;

/// Cumulated motion, left and right wheel angles of one run.
pub type SideMotion = [Cumulated; 3];

/// A motion as the sum of what the wheels of both sides add to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BySides {
    /// Motion for each radian of the left and of the right wheels.
    pub by: [f64; 2],
    /// Their standard errors.
    pub errors: [f64; 2],
    /// Root mean square of the residual: of the motion's rate less what both sides add to it.
    pub residual: f64,
    /// The same as a share of that of the rate.
    pub unexplained: f64,
    /// Delay of the motion behind the wheels \[s\].
    pub delay: f64,
}

impl BySides {
    /// By least squares over windows of a second of all runs; `None` if they are too few, or the sides move as one.
    ///
    /// # Algorithm
    /// 1. Mean rates of the motion and of both sides' wheels in windows of 1 s, every 0.05 s.
    /// 2. For each delay of the motion from -0.6 to 1 s, least squares of the motion on both sides, without a constant.
    /// 3. The delay that leaves least unexplained. The standard errors count only windows that do not overlap.
    pub fn of(runs: &[SideMotion]) -> Option<Self> {
        let rates = |[motion, left, right]: &SideMotion| {
            let grid = TimeGrid::over(motion, left, DELAY_STEP)?;
            Some([motion, left, right].map(|sum| sum.mean_rates(&grid, WINDOW)))
        };
        let rates: Vec<_> = runs.iter().filter_map(rates).collect();
        let found = SENSOR_DELAYS.filter_map(|delay| Self::at(&rates, delay));
        found.min_by(|a, b| a.unexplained.total_cmp(&b.unexplained))
    }

    fn at(rates: &[[Vec<Option<f64>>; 3]], delay: isize) -> Option<Self> {
        let (mut normal, mut product, mut square, mut count) =
            (Matrix2::zeros(), Vector2::zeros(), 0.0, 0);
        for [motion, left, right] in rates {
            for (index, sides) in left.iter().zip(right).enumerate() {
                let moved = index.checked_add_signed(delay);
                let moved = moved.and_then(|index| *motion.get(index)?);
                let (Some(moved), Some(left), Some(right)) = (moved, *sides.0, *sides.1) else {
                    continue;
                };
                let sides = Vector2::new(left, right);
                normal += sides * sides.transpose();
                product += sides * moved;
                square += moved * moved;
                count += 1;
            }
        }
        let factor = normal.cholesky()?;
        let by = factor.solve(&product);
        let squares = (square - by.dot(&product)).max(0.0);
        let overlap = WINDOW / DELAY_STEP;
        let variance = squares / (count as f64 - 2.0 * overlap);
        let inverse = factor.inverse();
        let error = |k: usize| (variance * inverse[(k, k)] * overlap).sqrt();
        (count >= MIN_WINDOWS && square > 0.0).then(|| Self {
            by: by.into(),
            errors: [error(0), error(1)],
            residual: (squares / count as f64).sqrt(),
            unexplained: (squares / square).sqrt(),
            delay: delay as f64 * DELAY_STEP,
        })
    }

    /// Root mean square of the residual of a run within a time, in windows of a second.
    pub fn residual_within(
        &self,
        [motion, left, right]: &SideMotion,
        [start, end]: [f64; 2],
    ) -> Option<f64> {
        let grid = TimeGrid::over(motion, left, DELAY_STEP)?;
        let half = 0.5 * WINDOW;
        let times = (0..grid.count).map(|index| grid.time(index));
        let inside = times.filter(|time| (start + half..=end - half).contains(time));
        let (mut square, mut count) = (0.0, 0);
        for time in inside {
            let sides = [left, right].map(|side| side.mean_rate(time, WINDOW));
            if let (Some(moved), [Some(left), Some(right)]) =
                (motion.mean_rate(time + self.delay, WINDOW), sides)
            {
                square += (moved - self.by[0] * left - self.by[1] * right).powi(2);
                count += 1;
            }
        }
        (count > 0).then(|| (square / f64::from(count)).sqrt())
    }

    /// Whether both sides clearly add to the motion, and nothing else moves it much.
    pub fn is_clear(&self) -> bool {
        let mut sides = self.by.iter().zip(self.errors);
        self.unexplained < UNEXPLAINED && sides.all(|(by, error)| by.abs() > CLEAR * error)
    }

    /// The side, 0 for the left one, whose wheel speeds have the wrong sign, by a `turn` \[rad\] to the left: both sides
    /// turn the vehicle the same way then.
    pub fn inverted_by_turn(&self) -> Option<usize> {
        let [left, right] = self.by.map(|by| by > 0.0);
        (self.is_clear() && left == right).then_some(usize::from(!left))
    }

    /// The same by a distance ahead \[m\]: the sides move the vehicle in opposite directions.
    pub fn inverted_by_distance(&self) -> Option<usize> {
        let [left, right] = self.by.map(|by| by > 0.0);
        (self.is_clear() && left != right).then_some(usize::from(left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::series::Series;

    /// A drive on which the sides move differently, a distance and a turn.
    fn drive([left_ratio, right_ratio]: [f64; 2]) -> [SideMotion; 2] {
        let times: Vec<f64> = (0..600).map(|k| 0.05 * f64::from(k)).collect();
        let left = |t: f64| 3.0 + (0.7 * t).sin();
        let right = |t: f64| 3.0 + (0.4 * t).cos();
        let rate = |f: &dyn Fn(f64) -> f64| {
            let series: Series = times.iter().map(|t| (*t, f(*t))).collect();
            Cumulated::of_rate(&series)
        };
        let sides = || [rate(&left), rate(&right)];
        let [a, b] = sides();
        let [c, d] = sides();
        let (left, right) = (
            |t: f64| left_ratio * left(t - 0.2),
            |t: f64| right_ratio * right(t - 0.2),
        );
        [
            [rate(&|t| 0.15 * (left(t) + right(t))), a, b],
            [rate(&|t| 0.2 * (right(t) - left(t))), c, d],
        ]
    }

    #[test]
    fn both_sides_are_found_with_the_delay() {
        let [ahead, turn] = drive([1.0, 2.0]);
        let found = BySides::of(&[ahead]).unwrap();
        assert!((found.by[0] - 0.15).abs() < 1e-3 && (found.by[1] - 0.3).abs() < 1e-3);
        assert!((found.delay - 0.2).abs() < 1e-9 && found.is_clear());
        let found = BySides::of(&[turn]).unwrap();
        assert!((found.by[0] + 0.2).abs() < 1e-3 && (found.by[1] - 0.4).abs() < 1e-3);
    }

    #[test]
    fn an_inverted_side_shows_in_distance_and_turn() {
        for (ratios, side) in [
            ([1.0, 1.0], None),
            ([-1.0, 1.0], Some(0)),
            ([1.0, -1.0], Some(1)),
        ] {
            let [ahead, turn] = drive(ratios).map(|motion| BySides::of(&[motion]).unwrap());
            assert_eq!(ahead.inverted_by_distance(), side);
            assert_eq!(turn.inverted_by_turn(), side);
        }
    }
}
