//! Recordings cut into segments, each with a start of its own (multiple shooting).
//!
//! H. G. Bock, "Recent advances in parameter identification techniques for ODE" (1983):
//! short segments with free initial states keep the problem close to linear and forget
//! whatever disturbance came before. Here neighbouring segments are not tied together: a
//! disturbance that the model lacks then stays in its segment.

use super::sensor::{SensorParameter, SensorValues};
use crate::recording::{Channel, Drive, Recording, Run};
use std::sync::Arc;

/// A channel that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Position east.
    X,
    /// Position north.
    Y,
    /// Heading.
    Heading,
    /// Velocity forward.
    VelocityForward,
    /// Velocity to the left.
    VelocityLeft,
    /// Yaw rate.
    YawRate,
}

impl Signal {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::X,
        Self::Y,
        Self::Heading,
        Self::VelocityForward,
        Self::VelocityLeft,
        Self::YawRate,
    ];

    /// The channel of a recording.
    #[must_use]
    pub const fn channel(self) -> Channel {
        match self {
            Self::X => Channel::X,
            Self::Y => Channel::Y,
            Self::Heading => Channel::Heading,
            Self::VelocityForward => Channel::VX,
            Self::VelocityLeft => Channel::VY,
            Self::YawRate => Channel::YawRate,
        }
    }

    /// The noise that it has: x and y share theirs.
    #[must_use]
    pub const fn group(self) -> NoiseGroup {
        match self {
            Self::X | Self::Y => NoiseGroup::Position,
            Self::Heading => NoiseGroup::Heading,
            Self::VelocityForward => NoiseGroup::VelocityForward,
            Self::VelocityLeft => NoiseGroup::VelocityLeft,
            Self::YawRate => NoiseGroup::YawRate,
        }
    }

    /// Whether it comes from the sensor of the pose, with its latency.
    #[must_use]
    pub const fn is_pose(self) -> bool {
        matches!(self, Self::X | Self::Y | Self::Heading)
    }

    /// How late it is \[s\].
    #[must_use]
    pub const fn latency(self, sensors: &SensorValues) -> f64 {
        if self.is_pose() {
            sensors[SensorParameter::PoseLatency.index()]
        } else {
            0.0
        }
    }
}

/// Channels that share their noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseGroup {
    /// x and y.
    Position,
    /// Heading.
    Heading,
    /// v_x.
    VelocityForward,
    /// v_y.
    VelocityLeft,
    /// Yaw rate.
    YawRate,
}

impl NoiseGroup {
    /// All groups.
    pub const ALL: [Self; 5] = [
        Self::Position,
        Self::Heading,
        Self::VelocityForward,
        Self::VelocityLeft,
        Self::YawRate,
    ];

    /// Name and unit.
    #[must_use]
    pub const fn describe(self) -> (&'static str, &'static str) {
        match self {
            Self::Position => ("position", "m"),
            Self::Heading => ("heading", "rad"),
            Self::VelocityForward => ("v_x", "m/s"),
            Self::VelocityLeft => ("v_y", "m/s"),
            Self::YawRate => ("yaw_rate", "rad/s"),
        }
    }

    /// Noise to begin with: what such a sensor and a fair model leave.
    #[must_use]
    pub const fn first_guess(self) -> f64 {
        match self {
            Self::Position => 0.05,
            Self::Heading | Self::YawRate => 0.03,
            Self::VelocityForward | Self::VelocityLeft => 0.05,
        }
    }
}

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

    /// Number of samples, of all channels together.
    #[must_use]
    pub fn sample_count(&self) -> usize {
        self.samples.iter().map(|samples| samples.time.len()).sum()
    }
}

/// Standard deviations of the start's prior: pose \[m, m, rad\], then velocities.
const START_DEVIATION: [f64; 6] = [0.5, 0.5, 0.3, 0.5, 0.4, 0.5];
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
const AT_REST: f64 = 0.005;
/// Slower wheels stand still \[rad/s\].
const STANDSTILL: f64 = 0.05;
/// ... within so many seconds of the start \[s\]: latencies are not known yet.
const STILL_SECONDS: f64 = 0.1;
/// Wheel speeds this long apart leave open what happened in between \[s\].
const LONGEST_GAP: f64 = 1.0;
/// Runs' stretches of the model's clock begin so far apart \[s\].
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

/// Cuts recordings into segments of about `length` seconds. `sensors` tells for each recording
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
            let start = data.start().max(drive.time[0]);
            let end = data.end().min(drive.time[drive.len() - 1]);
            let pieces = ((end - start) / length).round().max(1.0);
            let step = (end - start) / pieces;
            if step < SHORTEST {
                cut.unusable += step.max(0.0);
                continue;
            }
            for piece in 0..pieces as usize {
                let from = start + step * piece as f64;
                let wheels = wheels_between(&drive, from, from + step);
                let rests = wheels_between(&drive, from - STILL_SECONDS, from + STILL_SECONDS);
                if wheels.fastest < STANDSTILL {
                    cut.at_rest += step;
                    continue;
                }
                let segment = Segment {
                    recording: index,
                    run,
                    clock,
                    start: from,
                    end: from + step,
                    drive: drive.clone(),
                    samples: samples(data, sensors, from, from + step),
                    start_prior: [0.0; 6],
                    start_deviation: START_DEVIATION,
                };
                let count = segment.sample_count();
                if wheels.gap > LONGEST_GAP || count < FEWEST_SAMPLES {
                    cut.unusable += step;
                } else {
                    let mut segment = with_start(segment, data, sensors);
                    if rests.fastest < STANDSTILL {
                        segment.start_prior[3..].fill(0.0);
                        segment.start_deviation[3..].fill(AT_REST);
                    }
                    cut.segments.push(segment);
                }
            }
        }
    }
    cut
}

struct Wheels {
    fastest: f64,
    gap: f64,
}

fn wheels_between(drive: &Drive, from: f64, to: f64) -> Wheels {
    let first = drive.time.partition_point(|t| *t <= from).max(1) - 1;
    let last = drive.time.partition_point(|t| *t < to);
    let last = last.clamp(first, drive.len() - 1);
    let rows = first..=last;
    let speed = |row: usize| drive.wheel_speeds(row).map(f64::abs);
    Wheels {
        fastest: rows.clone().flat_map(speed).fold(0.0, f64::max),
        gap: (first..last)
            .map(|row| drive.time[row + 1] - drive.time[row])
            .fold(0.0, f64::max),
    }
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

/// Reads the start off the sensors. Where none tells the heading it is the course, or that of later where the vehicle does
/// not move yet.
fn with_start(mut segment: Segment, run: &Run, sensors: &SensorValues) -> Segment {
    let time = segment.start;
    let late = Signal::X.latency(sensors);
    let at = |channel, time| run.series(channel).and_then(|series| series.at(time));
    let nearest = |channel| {
        let of_channel = |s: &&Samples| s.signal.channel() == channel;
        let samples = segment.samples.iter().find(of_channel);
        samples.map_or(0.0, |samples| samples.value[0])
    };
    let slope = |channel, time: f64| {
        let (from, to) = (time + late - SLOPE_SECONDS, time + late + SLOPE_SECONDS);
        let here = at(channel, time + late);
        match (at(channel, from), here, at(channel, to)) {
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
    let mut pose = [Channel::X, Channel::Y, Channel::Heading]
        .map(|channel| at(channel, time + late).unwrap_or_else(|| nearest(channel)));
    let mut heads = run.series(Channel::Heading).is_some();
    if !heads {
        let moves = |step: i32| course(time + SLOPE_SECONDS * f64::from(step));
        heads = moves(0).is_some();
        let steps = 0..((segment.end - time) / SLOPE_SECONDS) as i32;
        pose[2] = steps.into_iter().find_map(moves).unwrap_or(0.0);
        if !heads {
            segment.start_deviation[2] = GUESSED_HEADING;
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
    for (k, velocity) in velocities.into_iter().enumerate() {
        segment.start_prior[3 + k] = velocity.unwrap_or(0.0);
        if velocity.is_none() {
            segment.start_deviation[3 + k] = GUESSED_VELOCITY[k];
        }
    }
    segment
}
