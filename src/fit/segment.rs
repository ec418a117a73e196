//! Recordings cut into segments, each with a start of its own (multiple shooting).
//!
//! H. G. Bock, "Recent advances in parameter identification techniques for ODE" (1983):
//! short segments with free initial states keep the problem close to linear and forget
//! whatever disturbance came before. Here neighbouring segments are not tied together: a
//! disturbance that the model lacks then stays in its segment.

use super::sensor::{SensorParameter, SensorValues};
use super::signal::Signal;
use crate::recording::{Channel, Drive, PoseHistory, Recording, Run, Series};
use crate::vehicle::seen_from;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Samples of a channel within a segment.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// What was measured.
    pub signal: Signal,
    /// Times as recorded \[s\].
    pub time: Vec<f64>,
    /// Values, in the channel's unit.
    pub value: Vec<f64>,
}

/// Some seconds of a run.
#[derive(Debug, Clone)]
pub struct Segment {
    /// Which recording it belongs to.
    pub recording: usize,
    /// Which of its runs.
    pub run: usize,
    /// What the model's clock shows at the run's time 0 \[s\]: each run has a stretch of it of its
    /// own, so that what is bound to a time is bound to one run.
    pub clock: f64,
    /// When its start state holds \[s\].
    pub start: f64,
    /// When it ends \[s\].
    pub end: f64,
    /// The run's wheel speeds.
    pub drive: Arc<Drive>,
    /// What was measured.
    pub samples: Vec<Samples>,
    /// Measured poses of the approach to the start, the start last; empty where not known.
    pub course: Arc<[[f64; 3]]>,
    /// What is known of the start before the fit: read off the sensors, with wide standard
    /// deviations, as the same samples take part in the fit.
    pub start_prior: [f64; 6],
    /// Its standard deviations.
    pub start_deviation: [f64; 6],
}

/// Ends and beginnings within so many seconds of each other are one time.
pub const SAME_TIME: f64 = 1e-6;

impl Segment {
    /// Whether it goes on where another of the same run ends.
    #[must_use]
    pub fn follows(&self, before: &Self) -> bool {
        (self.recording, self.run) == (before.recording, before.run)
            && (self.start - before.end).abs() < SAME_TIME
    }

    /// The poses of the vehicle itself over which it came to the start, seen from there, as
    /// [`Request::course`](super::predictor::Request::course) wants them.
    #[must_use]
    pub fn course_here(&self, sensors: &SensorValues) -> Vec<[f64; 3]> {
        let value = |parameter: SensorParameter| sensors[parameter.index()];
        let vehicle = |told: &[f64; 3]| {
            let heading = told[2] - value(SensorParameter::HeadingOffset);
            let (sin, cos) = heading.sin_cos();
            let ahead = value(SensorParameter::LeverArmX);
            let left = value(SensorParameter::LeverArmY);
            [
                told[0] - ahead * cos + left * sin,
                told[1] - ahead * sin - left * cos,
                heading,
            ]
        };
        let Some((here, before)) = self.course.split_last() else {
            return Vec::new();
        };
        let here = vehicle(here);
        let seen = before.iter().map(|told| seen_from(vehicle(told), here));
        seen.collect()
    }

    /// Number of samples, of all channels together.
    #[must_use]
    pub fn sample_count(&self) -> usize {
        self.samples.iter().map(|samples| samples.time.len()).sum()
    }
}

/// Slower wheels stand still \[rad/s\].
const STANDSTILL: f64 = 0.05;
/// ... within so many seconds before the start and after it \[s\]: wheel speeds that are recorded late, by a time that
/// is not known yet, show it late that the wheels turn.
const STILL_SECONDS: [f64; 2] = [0.1, 0.4];
/// Wheel speeds this long apart leave open what happened in between \[s\].
const LONGEST_GAP: f64 = 1.5;
/// Longer gaps are none of the drive: the clock was set, or the recorder waited \[s\].
const PAUSE: f64 = 60.0;
/// Offset between the runs on the model's clock \[s\].
pub const CLOCK: f64 = 1e6;
/// Segments with less samples or shorter ones than this are not worth a free start.
const FEWEST_SAMPLES: usize = 12;
const SHORTEST: f64 = 2.0;

/// Segments, and what was left out.
#[derive(Debug, Clone, Default)]
pub struct Cut {
    /// The segments.
    pub segments: Vec<Segment>,
    /// Seconds in which the wheels stand still.
    pub at_rest: f64,
    /// Seconds without wheel speeds or without enough samples.
    pub unusable: f64,
}

/// Cuts recordings into segments of about `length` seconds. `sensors` holds for each recording
/// how late its pose is: samples go to the segment in which they were true.
#[must_use]
pub fn cut(recordings: &[Recording], sensors: &[SensorValues], length: f64) -> Cut {
    let mut cut = Cut::default();
    let mut runs = 0;
    for (index, (recording, sensors)) in recordings.iter().zip(sensors).enumerate() {
        for (run, data) in recording.runs.iter().enumerate() {
            let clock = CLOCK * f64::from(runs);
            runs += 1;
            let Some(drive) = data.drive().map(Arc::new) else {
                continue;
            };
            let course = course(data);
            let start = data.start().max(drive.time[0]);
            let end = data.end().min(drive.time[drive.len() - 1]);
            let whole = Segment {
                recording: index,
                run,
                clock,
                start,
                end,
                drive,
                samples: Vec::new(),
                course: Arc::default(),
                start_prior: [0.0; 6],
                start_deviation: START_DEVIATION,
            };
            let mut from = start;
            let lost = data.wheel_gaps(LONGEST_GAP).into_iter();
            let lost = lost.map(|[gap, behind]| [gap.max(start), behind.min(end)]);
            for [gap, behind] in lost.filter(|[gap, behind]| behind > gap) {
                cut.add_pieces(&whole, [from, gap], (data, &course), sensors, length);
                let lost = behind - gap;
                cut.unusable += if lost > PAUSE { 0.0 } else { lost };
                from = behind;
            }
            cut.add_pieces(&whole, [from, end], (data, &course), sensors, length);
        }
    }
    cut
}

impl Cut {
    /// Cuts what lies between two times into pieces of about this length, none of them too short.
    fn add_pieces(
        &mut self,
        whole: &Segment,
        [start, end]: [f64; 2],
        (run, course): (&Run, &PoseHistory),
        sensors: &SensorValues,
        length: f64,
    ) {
        let most = ((end - start) / SHORTEST).floor();
        if most.is_nan() || most < 1.0 {
            self.unusable += (end - start).max(0.0);
            return;
        }
        let pieces = ((end - start) / length).round().clamp(1.0, most);
        let step = (end - start) / pieces;
        let late = sensors[SensorParameter::WheelLatency.index()];
        let [before, after] = STILL_SECONDS;
        for piece in 0..pieces as usize {
            let from = start + step * piece as f64;
            if fastest(&whole.drive, from, from + step) < STANDSTILL {
                self.at_rest += step;
                continue;
            }
            let segment = Segment {
                start: from,
                end: from + step,
                samples: samples(run, sensors, from, from + step),
                course: course.to(from + Signal::X.latency(sensors)).into(),
                ..whole.clone()
            };
            if segment.sample_count() < FEWEST_SAMPLES {
                self.unusable += step;
                continue;
            }
            let mut segment = with_start(segment, run, sensors);
            let still = [from + late.min(0.0) - before, from + late.max(0.0) + after];
            if fastest(&whole.drive, still[0], still[1]) < STANDSTILL {
                segment.start_prior[3..].fill(0.0);
                segment.start_deviation[3..].fill(AT_REST);
            }
            self.segments.push(segment);
        }
    }
}

/// Where the vehicle was in a run, as far as it is measured.
fn course(run: &Run) -> PoseHistory {
    let series = [Channel::X, Channel::Y, Channel::Heading].map(|channel| run.series(channel));
    let [Some(x), Some(y), Some(heading)] = series else {
        return PoseHistory::default();
    };
    PoseHistory::new(x, y, heading)
}

/// The fastest wheel speed between two times \[rad/s\].
fn fastest(drive: &Drive, from: f64, to: f64) -> f64 {
    let first = drive.time.partition_point(|t| *t <= from).max(1) - 1;
    let last = drive.time.partition_point(|t| *t < to);
    let last = last.clamp(first, drive.len() - 1);
    let speed = |row: usize| drive.wheel_speeds(row).map(f64::abs);
    (first..=last).flat_map(speed).fold(0.0, f64::max)
}

fn samples(run: &Run, sensors: &SensorValues, from: f64, to: f64) -> Vec<Samples> {
    let within = |signal: Signal| {
        let series = run.series(signal.channel())?;
        let late = signal.latency(sensors);
        let begin = series.time.partition_point(|t| t - late < from);
        let end = series.time.partition_point(|t| t - late < to);
        (end > begin).then(|| Samples {
            signal,
            time: series.time[begin..end].to_vec(),
            value: series.value[begin..end].to_vec(),
        })
    };
    Signal::ALL.into_iter().filter_map(within).collect()
}

/// Standard deviations of the start's prior: pose \[m, m, rad\], then velocities. Positions are those of the antenna,
/// which may be some metres from the reference point: many starts would pull a lever arm to zero.
pub const START_DEVIATION: [f64; 6] = [5.0, 5.0, 0.3, 0.5, 0.4, 0.5];
/// The same for velocities that follow from the wheel speeds alone.
const GUESSED_VELOCITY: [f64; 3] = [2.0, 1.0, 1.0];
/// Standard deviation of a heading that is not measured \[rad\].
const GUESSED_HEADING: f64 = 3.0;
/// A vehicle that moves faster than this \[m/s\] heads where it goes, or where it comes from if its wheels turn backwards.
const COURSE_SPEED: f64 = 0.3;
/// A pose is differentiated over so many seconds to either side.
const SLOPE_SECONDS: f64 = 0.4;
/// The same where the wheels stand still: the vehicle does, too. A start that slides on locked
/// wheels is often one that no soil bears.
pub const AT_REST: f64 = 0.005;
/// Samples further apart than this, and than so many usual intervals, are not interpolated \[s\]; nor does one
/// that is further away count here.
const KNOWN: (f64, f64) = (1.0, 2.5);
/// Standard deviation of a position of another time \[m\].
const GUESSED_POSITION: f64 = 20.0;

/// Reads the start off the sensors. Without a measured heading it is the course, or that of later where the vehicle does
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
        // On the same turn as the later headings.
        if let Some(measured) = about(Channel::Heading) {
            pose[2] += TAU * ((measured - pose[2]) / TAU).round();
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

/// The value at a time, between samples that are near enough.
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
        // A sensor that reports every other second is near enough.
        let slow: Series = (0..5).map(|k| (2.0 * f64::from(k), 1.0)).collect();
        assert_eq!(known(&slow, 3.0), Some(1.0));
    }
}
