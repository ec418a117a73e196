//! Recordings cut into segments, each with a start of its own (multiple shooting).
//!
//! H. G. Bock, "Recent advances in parameter identification techniques for ODE" (1983):
//! short segments with free initial states keep the problem close to linear and forget
//! whatever disturbance came before. Here neighbouring segments are not tied together: a
//! disturbance that the model lacks then stays in its segment.

use super::sensor::{SensorParameter, SensorValues};
use super::start_prior::{AT_REST, START_DEVIATION, with_start};
use crate::recording::{Channel, Drive, PoseHistory, Recording, Run};
use crate::vehicle::seen_from;
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
    /// Poses as the sensor told them, over which the vehicle came to the start, that one the last; empty where not known.
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

/// Where the vehicle was in a run, as far as that is told.
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
