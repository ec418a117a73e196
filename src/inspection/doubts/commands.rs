//! Wheel speeds that are commands and not measurements.

use super::doubt::{Doubt, DoubtKind};
use crate::recording::{Channel, Recording, Run, Series, range};

/// Share of the moving samples without any change that no encoder has.
const HELD: f64 = 0.6;
/// A step changes the speed by this share of its range from one sample to the next, within so many seconds.
const STEP: f64 = 0.2;
const SUDDEN: f64 = 0.25;
const MIN_STEPS: usize = 3;
/// Minimum share of steps among the changes: a measurement that is logged faster than it is made also repeats its values, but
/// changes little by little.
const STEPWISE: f64 = 0.25;
/// Slower wheels stand \[rad/s\].
const STANDING: f64 = 0.1;
const MIN_SAMPLES: usize = 100;
/// Share of repeated values below which another channel is a measurement.
const MEASURED: f64 = 0.1;

/// Whether the wheel speeds jump and stay, while the motion is measured.
pub fn doubt(recording: &Recording) -> Option<Doubt> {
    let sides = [Channel::OmegaLeft, Channel::OmegaRight];
    let (mut held, mut moving, mut steps, mut changed) = (0, 0, 0, 0);
    let mut is_measured = false;
    for run in &recording.runs {
        for series in sides.iter().filter_map(|side| run.series(*side)) {
            let found = changes(series);
            held += found[0];
            moving += found[1];
            steps += found[2];
            changed += found[3];
        }
        is_measured |= motion_is_measured(run);
    }
    let share = held as f64 / moving.max(1) as f64;
    let is_stepwise = steps >= MIN_STEPS && steps as f64 >= STEPWISE * changed as f64;
    if moving < MIN_SAMPLES || share < HELD || !is_stepwise || !is_measured {
        return None;
    }
    Some(Doubt {
        kind: DoubtKind::Commanded,
        channels: sides.into(),
        span: None,
        probability: 0.7,
        left_out: Vec::new(),
        evidence: format!(
            "the wheel speeds change in {steps} steps and are exactly constant for {:.0} % of the driving, as commands are",
            100.0 * share
        ),
        remedy: "Record the speeds that the encoders measured: between a command and the wheels lie the motor and its \
                 controller"
            .into(),
    })
}

/// Numbers of unchanged samples in motion, of samples in motion, of steps, and of all changes.
fn changes(series: &Series) -> [usize; 4] {
    let [low, high] = range(series.value.iter().copied());
    let large = STEP * (high - low);
    let (mut held, mut moving, mut steps, mut changed) = (0, 0, 0, 0);
    for (pair, interval) in series.value.windows(2).zip(series.intervals()) {
        let change = (pair[1] - pair[0]).abs();
        if pair[1].abs() > STANDING {
            moving += 1;
            held += usize::from(change == 0.0);
        }
        changed += usize::from(change > 0.0);
        steps += usize::from(change > large && large > 0.0 && interval <= SUDDEN);
    }
    [held, moving, steps, changed]
}

/// Whether some channel of the motion changes from sample to sample, as measurements do.
fn motion_is_measured(run: &Run) -> bool {
    let motion = [Channel::YawRate, Channel::VX, Channel::X, Channel::Heading];
    let mut measured = motion.iter().filter_map(|channel| run.series(*channel));
    measured.any(|series| {
        let repeats = series.value.windows(2).filter(|pair| pair[0] == pair[1]);
        let second = series.value.windows(3);
        // A computed motion is smooth: consecutive changes have the same sign.
        let turns = second
            .filter(|v| (v[1] - v[0]) * (v[2] - v[1]) < 0.0)
            .count();
        let count = series.len();
        count >= MIN_SAMPLES
            && (repeats.count() as f64) < MEASURED * count as f64
            && turns as f64 > 0.2 * count as f64
    })
}
