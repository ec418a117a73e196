//! The windows over which a model predicts.

use super::error::IdentificationError;
use super::signals::{HeadingSource, Signals, wrapped};
use super::start::velocities;
use crate::recording::Drive;
use crate::simulation::State;

/// Options of the windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowOptions {
    /// Duration of a prediction \[s\].
    pub horizon: f64,
    /// From the start of a window to that of the next in the same run \[s\].
    pub spacing: f64,
    /// Minimum mean wheel speed \[rad/s\]; slower windows are rejected as standing.
    pub min_wheel_speed: f64,
    /// Maximum interval of the pose at start and end \[s\]; over a longer one a linear interpolation is wrong in turns.
    pub longest_gap: f64,
    /// Source of the recorded heading.
    pub heading: HeadingSource,
}

impl Default for WindowOptions {
    fn default() -> Self {
        Self {
            horizon: 5.0,
            spacing: 0.5,
            min_wheel_speed: 0.1,
            longest_gap: 0.55,
            heading: HeadingSource::Pose,
        }
    }
}

impl WindowOptions {
    fn validate(&self) -> Result<(), IdentificationError> {
        for (what, value) in [("horizon", self.horizon), ("spacing", self.spacing)] {
            if !(0.05..=1e4).contains(&value) {
                let range = "between 0.05 and 10000 s";
                return Err(IdentificationError::Setting { what, value, range });
            }
        }
        Ok(())
    }
}

/// A stretch of a run: initial state, wheel speeds, final pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictionWindow {
    /// Index of the run among those with a pose.
    pub run: usize,
    /// Start time \[s\], on the clock of the yaw rate.
    pub start: f64,
    /// Recorded pose at the start, and velocities from the samples around it.
    pub state: State,
    /// Recorded x \[m\], y \[m\] and heading \[rad\] at the end.
    pub end: [f64; 3],
    /// Wheel speeds in between, times from 0.
    pub wheels: Drive,
    /// Poses of the path up to the start, the oldest first, relative to the pose at the start: ahead, to the left \[m\] and
    /// turned \[rad\].
    pub approach: Vec<[f64; 3]>,
}

impl PredictionWindow {
    /// Length \[s\].
    #[must_use]
    pub fn horizon(&self) -> f64 {
        self.wheels.duration()
    }

    /// Change from start to end in the frame of the start: ahead \[m\], to the left \[m\], heading \[rad\].
    #[must_use]
    pub fn displacement(&self) -> [f64; 3] {
        let (sin, cos) = self.state.heading.sin_cos();
        let (x, y) = (self.end[0] - self.state.x, self.end[1] - self.state.y);
        let heading = wrapped(self.end[2] - self.state.heading);
        [cos * x + sin * y, cos * y - sin * x, heading]
    }

    /// Index of a stretch of the run that is long enough for independence from other stretches.
    #[must_use]
    pub fn block(&self) -> (usize, i64) {
        (
            self.run,
            (self.start / (2.0 * self.horizon())).floor() as i64,
        )
    }
}

/// Numbers of rejected windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rejected {
    /// The vehicle stands still.
    pub standing: usize,
    /// A gap in the pose at start or end, in the wheel speeds, or in the yaw rate if it is needed.
    pub gaps: usize,
}

/// The windows of a recording, in the order of runs and times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WindowSet {
    /// The windows.
    pub windows: Vec<PredictionWindow>,
    /// The rejected ones.
    pub rejected: Rejected,
}

/// Cuts windows from the runs of a recording; its name is for the errors.
///
/// # Errors
/// Settings out of range, runs shorter than the horizon, and no window without rest or gaps.
pub fn cut(
    recording: &str,
    runs: &[Signals],
    options: &WindowOptions,
) -> Result<WindowSet, IdentificationError> {
    options.validate()?;
    let mut set = WindowSet::default();
    let mut longest: f64 = 0.0;
    for (run, signals) in runs.iter().enumerate() {
        let (first, last) = signals.span(options.heading);
        longest = longest.max(last - first);
        // A margin, so that rounding does not lead beyond the series.
        let room = last - first - options.horizon - 2.0 * ROUNDING;
        if room < 0.0 {
            continue;
        }
        let (mut next, count) = (0, (room / options.spacing).floor() as usize);
        while next <= count {
            let start = first + ROUNDING + options.spacing * next as f64;
            next += 1;
            if signals.pose_gap(start).is_some_and(|gap| gap > PAUSE)
                && let Some(behind) = signals.next_position(start)
            {
                next = next.max(((behind - first) / options.spacing).floor() as usize);
                continue;
            }
            let wheels = signals.drive(start, options.horizon);
            if mean_speed(&wheels) <= options.min_wheel_speed {
                set.rejected.standing += 1;
            } else if let Some(window) = window(signals, run, start, wheels, options) {
                set.windows.push(window);
            } else {
                set.rejected.gaps += 1;
            }
        }
    }
    let recording = || recording.to_owned();
    let Rejected { standing, gaps } = set.rejected;
    match (set.windows.is_empty(), standing + gaps) {
        (false, _) => Ok(set),
        (true, 0) => Err(IdentificationError::TooShort {
            recording: recording(),
            longest,
            horizon: options.horizon,
        }),
        (true, _) => Err(IdentificationError::NoWindows {
            recording: recording(),
            standing,
            gaps,
        }),
    }
}

/// No window starts in a longer gap of the pose: nothing was recorded, or the clock was set \[s\].
const PAUSE: f64 = 60.0;
/// Margin for the rounding of times \[s\].
const ROUNDING: f64 = 1e-6;

fn window(
    signals: &Signals,
    run: usize,
    start: f64,
    wheels: Drive,
    options: &WindowOptions,
) -> Option<PredictionWindow> {
    let stop = start + options.horizon;
    let far_apart = |time| {
        signals
            .pose_gap(time)
            .is_none_or(|gap| gap > options.longest_gap)
    };
    let has_gap = signals.has_gap(start, stop, options.heading);
    if has_gap || far_apart(start) || far_apart(stop) {
        return None;
    }
    let ([x, y, mut heading], mut end) = (signals.pose(start)?, signals.pose(stop)?);
    if options.heading == HeadingSource::Gyro {
        heading = signals.tied_heading(start)?;
        end[2] = heading + signals.turned(stop)? - signals.turned(start)?;
    }
    let [v_x, v_y, yaw_rate] = velocities(signals, start, heading)?;
    Some(PredictionWindow {
        run,
        start,
        state: State {
            x,
            y,
            heading,
            v_x,
            v_y,
            yaw_rate,
        },
        end,
        wheels,
        approach: signals.approach(start),
    })
}

/// Mean of the magnitudes of both wheel speeds \[rad/s\].
fn mean_speed(wheels: &Drive) -> f64 {
    let magnitude = |row: usize| wheels.wheel_speeds(row).map(f64::abs).iter().sum::<f64>() / 2.0;
    let piece = |row: usize| {
        (magnitude(row) + magnitude(row + 1)) / 2.0 * (wheels.time[row + 1] - wheels.time[row])
    };
    (0..wheels.len() - 1).map(piece).sum::<f64>() / wheels.duration()
}
