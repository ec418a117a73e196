//! One side's wheel speeds in another unit than the other's, or behind another gear.

use super::doubt::{Doubt, DoubtKind};
use super::pairs::Pairs;
use crate::inspection::signals::MotionSignal;
use crate::recording::{Channel, Recording, TimeGrid};
use nalgebra::{Matrix2, Vector2};

/// Window of the mean rates and step between windows \[s\].
const WINDOW: f64 = 1.0;
const STEP: f64 = 0.05;
/// Sides roll alike within this factor: soils that differ between left and right stay below it.
const ALIKE: f64 = 1.5;
/// Turning and distance have to find the same factor, within this one.
const SAME: f64 = 1.2;
/// Most that the wheel speeds may leave unexplained, as a share of the motion.
const UNEXPLAINED: f64 = 0.3;
/// Fewer windows prove nothing.
const FEWEST: usize = 160;
const PROBABILITY: f64 = 0.95;

/// How many times as far the right wheels carry the vehicle as the left ones, for one radian of each.
///
/// A motion of distance goes with a_L omega_L + a_R omega_R, a turn with a_R omega_R - a_L omega_L (`sign` -1), by least
/// squares over all windows; the factor is a_R / a_L. `None` if that does not explain the motion.
fn factor(recording: &Recording, motion: MotionSignal, sign: f64) -> Option<f64> {
    let delay = Pairs::of(
        &recording.runs,
        MotionSignal::Distance,
        MotionSignal::WheelMean,
    )?
    .delay;
    let (mut normal, mut right_side, mut square, mut count) =
        (Matrix2::zeros(), Vector2::zeros(), 0.0, 0);
    for run in &recording.runs {
        let signals = [
            motion,
            MotionSignal::WheelMean,
            MotionSignal::WheelDifference,
        ];
        let [Some(motion), Some(mean), Some(difference)] = signals.map(|signal| signal.of(run))
        else {
            continue;
        };
        let Some(grid) = TimeGrid::over(&motion, &mean, STEP) else {
            continue;
        };
        for time in (0..grid.count).map(|index| grid.time(index)) {
            let rates = [(&motion, time + delay), (&mean, time), (&difference, time)];
            let [Some(moved), Some(mean), Some(difference)] =
                rates.map(|(signal, time)| signal.mean_rate(time, WINDOW))
            else {
                continue;
            };
            let sides = Vector2::new(sign * (mean - 0.5 * difference), mean + 0.5 * difference);
            normal += sides * sides.transpose();
            right_side += sides * moved;
            square += moved * moved;
            count += 1;
        }
    }
    let by = normal.cholesky()?.solve(&right_side);
    let explained = by.dot(&right_side) / square;
    let is_explained = count >= FEWEST && 1.0 - explained < UNEXPLAINED * UNEXPLAINED;
    (is_explained && by.min() > 0.0).then(|| by[1] / by[0])
}

/// A doubt about sides that roll by different factors.
pub fn doubt(recording: &Recording) -> Option<Doubt> {
    let ahead = factor(recording, MotionSignal::Distance, 1.0)?;
    let turning = factor(recording, MotionSignal::Heading, -1.0)
        .or_else(|| factor(recording, MotionSignal::YawRate, -1.0))?;
    let differs = ahead.ln().abs() > ALIKE.ln() && turning.ln().abs() > ALIKE.ln();
    let agrees = (ahead / turning).ln().abs() < SAME.ln();
    (differs && agrees).then(|| {
        let (more, less, times) = if ahead > 1.0 {
            ("left", "right", ahead)
        } else {
            ("right", "left", 1.0 / ahead)
        };
        Doubt {
            kind: DoubtKind::RollingRatio,
            channels: vec![Channel::OmegaLeft, Channel::OmegaRight],
            span: None,
            probability: PROBABILITY,
            left_out: Vec::new(),
            evidence: format!(
                "omega_{more} counts {times:.2} times as much as omega_{less} for the same way, by the distance; by the \
                 turns {:.2} times",
                if ahead > 1.0 { turning } else { 1.0 / turning }
            ),
            remedy: format!(
                "Check unit, gear and ticks of both sides: divide omega_{more} by {times:.2}, or multiply omega_{less} by it"
            ),
        }
    })
}
