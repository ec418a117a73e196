//! What the sensors tell of a segment's start before the fit.

use super::segment::{Samples, Segment, Signal};
use super::sensor::{SensorParameter, SensorValues};
use crate::recording::{Channel, Run, Series};
use std::f64::consts::TAU;

/// Standard deviations of the start's prior: pose \[m, m, rad\], then velocities. Positions are those of the antenna,
/// which may be some metres from the reference point: many starts would pull a lever arm to zero.
pub const START_DEVIATION: [f64; 6] = [5.0, 5.0, 0.3, 0.5, 0.4, 0.5];
/// The same for velocities that follow from the wheel speeds alone.
const GUESSED_VELOCITY: [f64; 3] = [2.0, 1.0, 1.0];
/// Standard deviation of a heading that nothing tells of \[rad\].
const GUESSED_HEADING: f64 = 3.0;
/// A vehicle that moves faster than this \[m/s\] heads where it goes, or where it comes from if its wheels turn backwards.
const COURSE_SPEED: f64 = 0.3;
/// A pose is differentiated over so many seconds to either side.
const SLOPE_SECONDS: f64 = 0.4;
/// The same where the wheels stand still: the vehicle does, too. A start that slides on locked
/// wheels is often one that no soil bears.
pub const AT_REST: f64 = 0.005;
/// Samples further apart than this, and than so many usual intervals, do not tell what was in between \[s\]; nor does one
/// that is further away tell what was here.
const KNOWN: (f64, f64) = (1.0, 2.5);
/// Standard deviation of a position of another time \[m\].
const GUESSED_POSITION: f64 = 20.0;

/// Reads the start off the sensors. Where none tells the heading it is the course, or that of later where the vehicle does
/// not move yet.
pub fn with_start(mut segment: Segment, run: &Run, sensors: &SensorValues) -> Segment {
    let time = segment.start;
    let late = Signal::X.latency(sensors);
    let at = |channel, time| run.series(channel).and_then(|series| known(series, time));
    // The first sample of the segment, and how much later it is.
    let first = |channel| {
        let of_channel = |s: &&Samples| s.signal.channel() == channel;
        let samples = segment.samples.iter().find(of_channel);
        samples.map(|samples| (samples.value[0], samples.time[0] - time - late))
    };
    let here = |channel| {
        let soon = first(channel).filter(|(_, later)| *later <= KNOWN.0);
        at(channel, time + late).or(soon.map(|(value, _)| value))
    };
    let about = |channel| {
        let between = run
            .series(channel)
            .and_then(|series| series.at(time + late));
        between.or(first(channel).map(|(value, _)| value))
    };
    let slope = |channel, time: f64| {
        let (from, to) = (time + late - SLOPE_SECONDS, time + late + SLOPE_SECONDS);
        let middle = at(channel, time + late);
        match (at(channel, from), middle, at(channel, to)) {
            (Some(a), _, Some(b)) => Some((b - a) / (2.0 * SLOPE_SECONDS)),
            (None, Some(a), Some(b)) => Some((b - a) / SLOPE_SECONDS),
            _ => None,
        }
    };
    let velocity = |time| slope(Channel::X, time).zip(slope(Channel::Y, time));
    let course = |time| {
        let (x, y) = velocity(time).filter(|(x, y)| x.hypot(*y) > COURSE_SPEED)?;
        let row = segment.drive.time.partition_point(|t| *t <= time).max(1) - 1;
        let turning: f64 = segment.drive.wheel_speeds(row).iter().sum();
        let ahead = if turning < 0.0 { -1.0 } else { 1.0 };
        Some((ahead * y).atan2(ahead * x))
    };
    let mut pose = [0.0; 3];
    let mut deviation = segment.start_deviation;
    for (k, channel) in [Channel::X, Channel::Y].into_iter().enumerate() {
        if let Some(position) = here(channel) {
            pose[k] = position;
        } else if let Some(position) = about(channel) {
            (pose[k], deviation[k]) = (position, GUESSED_POSITION);
        }
    }
    let heading = here(Channel::Heading);
    let mut heads = heading.is_some();
    pose[2] = heading.unwrap_or_default();
    if !heads {
        let moves = |step: i32| course(time + SLOPE_SECONDS * f64::from(step));
        heads = moves(0).is_some();
        let steps = 0..((segment.end - time) / SLOPE_SECONDS) as i32;
        pose[2] = steps.into_iter().find_map(moves).unwrap_or(0.0);
        // On the turn of the headings that are told later.
        if let Some(told) = about(Channel::Heading) {
            pose[2] += TAU * ((told - pose[2]) / TAU).round();
        }
        if !heads {
            deviation[2] = GUESSED_HEADING;
        }
    }
    let (sin, cos) = pose[2].sin_cos();
    let along = velocity(time).filter(|_| heads);
    let along = along.map(|(x, y)| x * cos + y * sin);
    let bias = sensors[SensorParameter::YawRateBias.index()];
    let yaw = at(Channel::YawRate, time).map(|rate| rate - bias);
    let velocities = [
        at(Channel::VX, time).or(along),
        at(Channel::VY, time).or(along.map(|_| 0.0)),
        yaw.or_else(|| slope(Channel::Heading, time)),
    ];
    segment.start_prior[..3].copy_from_slice(&pose);
    segment.start_deviation = deviation;
    for (k, velocity) in velocities.into_iter().enumerate() {
        segment.start_prior[3 + k] = velocity.unwrap_or(0.0);
        if velocity.is_none() {
            segment.start_deviation[3 + k] = GUESSED_VELOCITY[k];
        }
    }
    segment
}

/// The value at a time, between samples that are near enough to tell it.
fn known(series: &Series, time: f64) -> Option<f64> {
    let after = series.time.partition_point(|sample| *sample <= time);
    let interval = |next: usize| {
        let before = next.checked_sub(1)?;
        Some(series.time.get(next)? - series.time[before])
    };
    let usual = [after.checked_sub(1).and_then(interval), interval(after + 1)];
    let usual = usual.into_iter().flatten().reduce(f64::min);
    let longest = KNOWN.0.max(KNOWN.1 * usual.unwrap_or(0.0));
    if interval(after).is_some_and(|gap| gap > longest) {
        return None;
    }
    series.at(time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_lost_is_not_known() {
        let times = (0..20).chain(60..80).map(|k| 0.1 * f64::from(k));
        let series: Series = times.map(|time| (time, time)).collect();
        assert_eq!(known(&series, 4.0), None);
        assert_eq!(known(&series, 7.0), series.at(7.0));
        assert_eq!(known(&series, -1.0), None);
        // A sensor that tells its value every other second tells it.
        let slow: Series = (0..5).map(|k| (2.0 * f64::from(k), 1.0)).collect();
        assert_eq!(known(&slow, 3.0), Some(1.0));
    }
}
