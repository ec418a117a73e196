//! Magnitudes in place of velocities.

use super::doubt::{Doubt, DoubtKind, standing};
use super::pairs::Pairs;
use crate::inspection::signals::MotionSignal;
use crate::recording::{Channel, Recording};

/// Minimum correlation of the magnitudes.
const STRONG: f64 = 0.9;
/// Slower wheels stand \[rad/s\], and slower vehicles \[m/s\].
const STANDING: f64 = 0.2;
/// Minimum share of windows in reverse for a conclusion, and of those with the wrong sign.
const ENOUGH: f64 = 0.04;
const MOST: f64 = 0.9;
/// Probability of a relation that has no other explanation.
const CLEAR: f64 = 0.95;

/// A velocity, or wheel speeds, that stay positive while the vehicle goes back.
pub fn doubt(recording: &Recording) -> Option<Doubt> {
    let runs = &recording.runs;
    let still = standing(runs, STANDING);
    let never_negative = |channel, still: f64| {
        let runs = runs.iter().filter_map(|run| run.series(channel));
        let mut values = runs.flat_map(|series| series.value.iter());
        recording.has(channel) && values.all(|value| *value > -still)
    };
    let share = |pairs: &Pairs, is: &dyn Fn(&(f64, f64)) -> bool| {
        let count = pairs.values.iter().filter(|pair| is(pair)).count();
        count as f64 / pairs.values.len() as f64
    };
    let found = |channels: Vec<Channel>, evidence: String, remedy: &str| Doubt {
        kind: DoubtKind::Unsigned,
        channels,
        span: None,
        probability: CLEAR,
        left_out: Vec::new(),
        evidence,
        remedy: remedy.into(),
    };
    if never_negative(Channel::VX, STANDING)
        && let Some(pairs) = Pairs::of(runs, MotionSignal::Velocity, MotionSignal::WheelMean)
    {
        let back = share(&pairs, &|pair| pair.1 < -still);
        let wrong = share(&pairs, &|pair| pair.1 < -still && pair.0 > 0.0);
        if back >= ENOUGH && wrong >= MOST * back {
            let evidence = format!(
                "v_x is never negative, though the wheels turn backwards {:.0} % of the time",
                100.0 * back
            );
            let remedy = "It is the magnitude of the velocity: give it the sign of the motion, or leave the column out";
            return Some(found(vec![Channel::VX], evidence, remedy));
        }
    }
    let sides = [Channel::OmegaLeft, Channel::OmegaRight];
    if sides.into_iter().all(|side| never_negative(side, still))
        && let Some(pairs) = Pairs::of(runs, MotionSignal::Distance, MotionSignal::WheelMean)
    {
        let back = share(&pairs, &|pair| pair.1 > still && pair.0 < -0.05);
        let moving = share(&pairs, &|pair| pair.1 > still);
        let magnitudes: Vec<(f64, f64)> = pairs.values.iter().map(|p| (p.0.abs(), p.1)).collect();
        let magnitudes = Pairs {
            values: magnitudes,
            ..Pairs::default()
        };
        let correlation = magnitudes.ratio().map_or(0.0, |ratio| ratio.correlation);
        if moving > 0.0 && back >= ENOUGH * moving && correlation >= STRONG {
            let evidence = format!(
                "both wheel speeds are never negative, though the vehicle goes backwards {:.0} % of the time",
                100.0 * back / moving
            );
            let remedy =
                "The encoders count without a direction: give the speeds the sign of the motion";
            return Some(found(sides.into(), evidence, remedy));
        }
    }
    None
}
