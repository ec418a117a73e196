//! A run's series on one clock.

use super::error::IdentificationError;
use crate::recording::{Channel, Drive, PoseHistory, Recording, Run, Series, median};
use crate::vehicle::seen_from;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Longer intervals between wheel speeds or yaw rates are gaps \[s\].
const MAX_INTERVAL: f64 = 1.5;
/// Slower wheels stand still \[rad/s\].
const STANDING: f64 = 0.1;
/// Seconds on either side over which the gyro is tied to the recorded heading.
const TIE: f64 = 1.0;

/// Source of the heading that a prediction is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeadingSource {
    /// The recorded heading.
    Pose,
    /// The integrated yaw rate, tied to the recorded heading around the window's start.
    Gyro,
}

impl HeadingSource {
    /// Name in tables and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pose => "pose",
            Self::Gyro => "gyro",
        }
    }
}

/// Pose, wheel speeds and yaw rate of one run. Times are those of the yaw rate's sensor; pose and wheels are shifted by
/// their latencies.
#[derive(Debug, Clone)]
pub struct Signals {
    /// The run's label.
    pub label: String,
    x: Series,
    y: Series,
    heading: Series,
    /// Computed on demand.
    history: OnceLock<PoseHistory>,
    wheels: Drive,
    yaw_rate: Option<Series>,
    /// Integral of the yaw rate \[rad\] at its samples.
    turned: Option<Series>,
    /// Gaps of wheel speeds and yaw rate, each on the clock of its sensor.
    gaps: [Vec<[f64; 2]>; 2],
    latencies: [f64; 2],
    gyro_bias: f64,
}

impl Signals {
    /// The runs with wheel speeds and a pose, before any latency is removed.
    ///
    /// # Errors
    /// No run has both.
    pub fn of(recording: &Recording) -> Result<Vec<Self>, IdentificationError> {
        let found: Vec<Self> = recording.runs.iter().filter_map(Self::of_run).collect();
        if !found.is_empty() {
            return Ok(found);
        }
        let absent = |channel: &Channel| {
            let mut runs = recording.runs.iter();
            !runs.any(|run| run.series(*channel).is_some())
        };
        let pose = [Channel::X, Channel::Y, Channel::Heading];
        Err(IdentificationError::NoPose {
            recording: recording.name.clone(),
            missing: pose.into_iter().filter(absent).collect(),
        })
    }

    /// Whether a run has wheel speeds and a pose.
    pub(super) fn is_complete(run: &Run) -> bool {
        Self::of_run(run).is_some()
    }

    fn of_run(run: &Run) -> Option<Self> {
        let yaw_rate = run.series(Channel::YawRate).cloned();
        let gyro_gaps = yaw_rate.iter().flat_map(|series| series.gaps(MAX_INTERVAL));
        Some(Self {
            gaps: [run.wheel_gaps(MAX_INTERVAL), gyro_gaps.collect()],
            label: run.label.clone(),
            x: run.series(Channel::X)?.clone(),
            y: run.series(Channel::Y)?.clone(),
            heading: run.series(Channel::Heading)?.clone(),
            history: OnceLock::new(),
            wheels: run.drive()?,
            turned: yaw_rate.as_ref().map(integral),
            yaw_rate,
            latencies: [0.0; 2],
            gyro_bias: 0.0,
        })
    }

    /// Sets the latencies of pose and wheel speeds, and the bias of the yaw rate.
    pub(super) fn correct(&mut self, latencies: [f64; 2], gyro_bias: f64) {
        self.latencies = latencies;
        self.gyro_bias = gyro_bias;
    }

    pub(super) fn pose_latency(&self) -> f64 {
        self.latencies[0]
    }

    fn wheel_latency(&self) -> f64 {
        self.latencies[1]
    }

    /// First and last time at which pose and wheel speeds are known \[s\], and the yaw rate if it is the source of the
    /// heading. The last may be before the first.
    #[must_use]
    pub fn span(&self, heading: HeadingSource) -> (f64, f64) {
        let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
        let wheels = &self.wheels.time;
        let series =
            [&self.x.time, &self.y.time, &self.heading.time].map(|t| (t, self.pose_latency()));
        for (time, latency) in series.into_iter().chain([(wheels, self.wheel_latency())]) {
            first = first.max(time.first().map_or(f64::INFINITY, |t| t - latency));
            last = last.min(time.last().map_or(f64::NEG_INFINITY, |t| t - latency));
        }
        if let (HeadingSource::Gyro, Some(turned)) = (heading, &self.turned) {
            first = first.max(turned.start().unwrap_or(first));
            last = last.min(turned.end().unwrap_or(last));
        }
        (first, last)
    }

    /// Recorded x, y and heading at a time.
    #[must_use]
    pub fn pose(&self, time: f64) -> Option<[f64; 3]> {
        let at = time + self.pose_latency();
        Some([self.x.at(at)?, self.y.at(at)?, self.heading.at(at)?])
    }

    /// The poses of the path up to a time, the oldest first, relative to the pose at that time.
    #[must_use]
    pub fn approach(&self, time: f64) -> Vec<[f64; 3]> {
        let at = time + self.pose_latency();
        let path = self
            .history
            .get_or_init(|| PoseHistory::new(&self.x, &self.y, &self.heading))
            .to(at);
        let Some((here, before)) = path.split_last() else {
            return Vec::new();
        };
        before.iter().map(|pose| seen_from(*pose, *here)).collect()
    }

    /// Times of the positions within a span.
    pub fn position_times(&self, from: f64, to: f64) -> impl Iterator<Item = f64> + '_ {
        let shift = self.pose_latency();
        let times = within(&self.x.time, from + shift, to + shift);
        times.iter().map(move |time| time - shift)
    }

    /// Seconds between the samples of the pose before and after a time; `None` outside the pose.
    #[must_use]
    pub fn pose_gap(&self, time: f64) -> Option<f64> {
        let at = time + self.pose_latency();
        let gap = |series: &Series| {
            let after = series.time.partition_point(|t| *t <= at);
            Some(series.time.get(after)? - series.time.get(after.checked_sub(1)?)?)
        };
        Some(gap(&self.x)?.max(gap(&self.y)?).max(gap(&self.heading)?))
    }

    /// Samples of the yaw rate within a span.
    pub(super) fn yaw_rates(&self, from: f64, to: f64) -> Vec<(f64, f64)> {
        let pick = |series: &Series| -> Vec<(f64, f64)> {
            let first = series.time.partition_point(|t| *t < from);
            let within = series.samples().skip(first);
            within
                .take_while(|(t, _)| *t <= to)
                .map(|(t, rate)| (t, rate - self.gyro_bias))
                .collect()
        };
        self.yaw_rate.as_ref().map(pick).unwrap_or_default()
    }

    /// Samples of the heading within a span.
    pub(super) fn headings(&self, from: f64, to: f64) -> Vec<(f64, f64)> {
        let shift = self.pose_latency();
        let first = self.heading.time.partition_point(|t| *t < from + shift);
        let samples = self.heading.samples().skip(first);
        samples
            .map(|(t, value)| (t - shift, value))
            .take_while(|(t, _)| *t <= to)
            .collect()
    }

    /// Integral of the yaw rate from an arbitrary start \[rad\].
    #[must_use]
    pub fn turned(&self, time: f64) -> Option<f64> {
        let turned = self.turned.as_ref()?;
        Some(turned.at(time)? - self.gyro_bias * (time - turned.start()?))
    }

    /// Whether wheel speeds have a gap between two times, or the yaw rate if it is the source of the heading.
    #[must_use]
    pub(super) fn has_gap(&self, from: f64, to: f64, heading: HeadingSource) -> bool {
        let overlaps = |gaps: &[[f64; 2]], late: f64| {
            let next = gaps.partition_point(|[_, end]| end - late <= from);
            gaps.get(next).is_some_and(|[start, _]| start - late < to)
        };
        overlaps(&self.gaps[0], self.wheel_latency())
            || heading == HeadingSource::Gyro && overlaps(&self.gaps[1], 0.0)
    }

    /// Duration of turning wheels \[s\].
    #[must_use]
    pub(super) fn moving_seconds(&self) -> f64 {
        let wheels = &self.wheels;
        let turns = |row: &usize| {
            let speeds = wheels.wheel_speeds(*row);
            speeds.iter().any(|speed| speed.abs() > STANDING)
        };
        let rows = (0..wheels.len().saturating_sub(1)).filter(turns);
        let seconds = rows.map(|row| wheels.time[row + 1] - wheels.time[row]);
        seconds.filter(|seconds| *seconds <= MAX_INTERVAL).sum()
    }

    /// Time of the next position after a time; `None` after the last.
    #[must_use]
    pub(super) fn next_position(&self, time: f64) -> Option<f64> {
        let at = time + self.pose_latency();
        let next = self.x.time.partition_point(|t| *t <= at);
        Some(self.x.time.get(next)? - self.pose_latency())
    }

    /// Heading at a time from the integrated yaw rate, tied to the recorded headings around it by a median, which is robust
    /// against wrong ones.
    #[must_use]
    pub fn tied_heading(&self, time: f64) -> Option<f64> {
        let here = self.turned(time)?;
        let around = self.headings(time - TIE, time + TIE).into_iter();
        let mut offsets: Vec<f64> = around
            .filter_map(|(t, heading)| Some(heading + here - self.turned(t)?))
            .collect();
        let first = *offsets.first()?;
        for offset in &mut offsets {
            *offset = first + wrapped(*offset - first);
        }
        Some(median(&mut offsets))
    }

    /// The wheel speeds from a time on for a duration \[s\]: times from 0, both ends included.
    #[must_use]
    pub fn drive(&self, start: f64, seconds: f64) -> Drive {
        let from = start + self.wheel_latency();
        let inside = within(&self.wheels.time, from, from + seconds);
        let mut time: Vec<f64> = vec![0.0];
        time.extend(
            inside
                .iter()
                .map(|t| t - from)
                .filter(|t| *t > 0.0 && *t < seconds),
        );
        time.push(seconds);
        let speeds: Vec<[f64; 2]> = time.iter().map(|t| self.wheel_speeds(from + t)).collect();
        Drive {
            omega_left: speeds.iter().map(|s| s[0]).collect(),
            omega_right: speeds.iter().map(|s| s[1]).collect(),
            time,
            filled_rows: 0,
        }
    }

    /// Wheel speeds at a time of the wheels' clock, linear between samples, held beyond the ends.
    fn wheel_speeds(&self, time: f64) -> [f64; 2] {
        let wheels = &self.wheels;
        let after = wheels.time.partition_point(|t| *t <= time);
        let Some(before) = after.checked_sub(1) else {
            return wheels.wheel_speeds(0);
        };
        let (speeds, rates) = (
            wheels.wheel_speeds(before),
            wheels.wheel_accelerations(before),
        );
        let seconds = time - wheels.time[before];
        [0, 1].map(|side| speeds[side] + rates[side] * seconds)
    }

    /// Integral of right minus left wheel speed \[rad\] on the wheels' clock, which grows with the heading.
    pub(super) fn twist(&self) -> Series {
        let wheels = &self.wheels;
        let difference = wheels
            .omega_right
            .iter()
            .zip(&wheels.omega_left)
            .map(|(r, l)| r - l);
        integral(&wheels.time.iter().copied().zip(difference).collect())
    }

    /// Integral of the yaw rate, if there is one.
    pub(super) fn turned_series(&self) -> Option<&Series> {
        self.turned.as_ref()
    }

    /// The recorded heading on the pose's clock.
    pub(super) fn heading_series(&self) -> &Series {
        &self.heading
    }
}

/// An angle between -pi and pi \[rad\].
pub(super) fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

fn within(time: &[f64], from: f64, to: f64) -> &[f64] {
    let first = time.partition_point(|t| *t < from);
    let end = time.partition_point(|t| *t <= to);
    &time[first..end.max(first)]
}

/// Integral over time, linear between samples, at the samples.
fn integral(series: &Series) -> Series {
    let mut sum = 0.0;
    let mut before: Option<(f64, f64)> = None;
    let add = |(time, value): (f64, f64)| {
        if let Some((t, v)) = before {
            sum += 0.5 * (v + value) * (time - t);
        }
        before = Some((time, value));
        (time, sum)
    };
    series.samples().map(add).collect()
}
