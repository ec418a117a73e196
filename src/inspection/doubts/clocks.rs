//! Sensors of one motion whose clocks differ by seconds.

use super::doubt::{Doubt, DoubtKind, logistic};
use super::pairs::Pairs;
use crate::inspection::signals::MotionSignal;
use crate::recording::{Channel, Recording, SENSOR_DELAYS};

/// Delays that are looked at, in steps of [`Pairs`]: 10 s either way.
const FAR: std::ops::RangeInclusive<isize> = -200..=200;
/// Correlation at a delay of seconds from which on it is one motion.
const STRONG: f64 = 0.9;
/// By how much it exceeds that at the delays of sensors at even odds, and the width of the transition. A drive that repeats
/// itself fits at its period nearly as well.
const CLEAR: f64 = 0.1;
const WIDTH: f64 = 0.02;

/// Doubts about the clock of the pose, and of the gyro.
pub fn doubts(recording: &Recording) -> Vec<Doubt> {
    let pose = [
        (MotionSignal::Heading, MotionSignal::WheelDifference),
        (MotionSignal::Distance, MotionSignal::WheelMean),
    ];
    let gyro = [(MotionSignal::YawRate, MotionSignal::WheelDifference)];
    let found = [
        doubt(
            recording,
            &pose,
            &[Channel::X, Channel::Y, Channel::Heading],
            "the pose",
        ),
        doubt(recording, &gyro, &[Channel::YawRate], "yaw_rate"),
    ];
    found.into_iter().flatten().collect()
}

fn doubt(
    recording: &Recording,
    pairs: &[(MotionSignal, MotionSignal)],
    channels: &[Channel],
    what: &str,
) -> Option<Doubt> {
    // Of the two that tell most about a delay.
    let found = pairs.iter().filter_map(|(signal, wheels)| {
        let delays = |delays| {
            let pairs = Pairs::within(&recording.runs, *signal, *wheels, delays)?;
            Some((pairs.ratio()?.correlation.abs(), pairs.delay))
        };
        Some((delays(SENSOR_DELAYS)?.0, delays(FAR)?))
    });
    let (near, (far, delay)) = found.max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    if far < STRONG || SENSOR_DELAYS.contains(&Pairs::steps(delay)) {
        return None;
    }
    let (late, side) = if delay > 0.0 {
        (delay, "after")
    } else {
        (-delay, "before")
    };
    Some(Doubt {
        kind: DoubtKind::Clock,
        channels: channels.to_vec(),
        span: None,
        probability: logistic((far - near - CLEAR) / WIDTH),
        left_out: Vec::new(),
        evidence: format!(
            "{what} comes {late:.1} s {side} the wheels: shifted by that they agree (correlation {far:.2}), as they are \
             they do not ({near:.2} at the best delay of a sensor)"
        ),
        remedy: format!("Take {delay:.2} s off the times of {what}: it has another clock"),
    })
}
