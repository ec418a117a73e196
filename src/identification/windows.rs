//! The windows over which a model predicts.

use super::signals::wrapped;
use super::start::velocities;
use super::{HeadingSource, IdentificationError, Signals};
use crate::recording::Drive;
use crate::simulation::State;

/// How windows are cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// How far a model predicts \[s\].
    pub horizon: f64,
    /// From the start of a window to that of the next in the same run \[s\].
    pub spacing: f64,
    /// Windows with wheels that turn slower on average are left out: nothing happens
    /// there \[rad/s\].
    pub least_wheel_speed: f64,
    /// Windows are left out at whose start or end the pose follows from samples that are
    /// further apart: in a turn the vehicle does not drive straight from one to the next \[s\].
    pub longest_gap: f64,
    /// What the heading is compared with.
    pub heading: HeadingSource,
}

impl Default for Cut {
    fn default() -> Self {
        Self {
            horizon: 5.0,
            spacing: 0.5,
            least_wheel_speed: 0.1,
            longest_gap: 0.55,
            heading: HeadingSource::Pose,
        }
    }
}

impl Cut {
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

/// A stretch of a run: where it starts, how the wheels turn, where it ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// Index of the run among those with a pose.
    pub run: usize,
    /// When it starts \[s\], on the clock of the yaw rate.
    pub start: f64,
    /// Recorded pose at the start, and velocities from the samples around it.
    pub state: State,
    /// Recorded x \[m\], y \[m\] and heading \[rad\] at the end.
    pub end: [f64; 3],
    /// Wheel speeds in between, times from 0.
    pub wheels: Drive,
    /// Poses over which the vehicle came to the start, the oldest first, seen from there: ahead, to the left \[m\] and
    /// turned \[rad\].
    pub course: Vec<[f64; 3]>,
}

impl Window {
    /// Length \[s\].
    #[must_use]
    pub fn horizon(&self) -> f64 {
        self.wheels.duration()
    }

    /// What changes from start to end, seen from the start: ahead \[m\], to the left \[m\],
    /// heading \[rad\].
    #[must_use]
    pub fn displacement(&self) -> [f64; 3] {
        let (sin, cos) = self.state.heading.sin_cos();
        let (x, y) = (self.end[0] - self.state.x, self.end[1] - self.state.y);
        let heading = wrapped(self.end[2] - self.state.heading);
        [cos * x + sin * y, cos * y - sin * x, heading]
    }

    /// Number of a stretch of its run long enough to be independent of the others'.
    #[must_use]
    pub fn block(&self) -> (usize, i64) {
        (
            self.run,
            (self.start / (2.0 * self.horizon())).floor() as i64,
        )
    }
}

/// Windows that were left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rejected {
    /// The vehicle stands still.
    pub standing: usize,
    /// The pose at the start or the end, a wheel speed in between, or the yaw rate that is asked for, is not known
    /// well enough.
    pub gaps: usize,
}

/// The windows of a recording, in the order of runs and times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WindowSet {
    /// The windows.
    pub windows: Vec<Window>,
    /// What was left out.
    pub rejected: Rejected,
}

/// Cuts windows from the runs of a recording, whose name is for the errors.
///
/// # Errors
/// Settings out of range, runs shorter than the horizon, and nothing left.
pub fn cut(recording: &str, runs: &[Signals], cut: &Cut) -> Result<WindowSet, IdentificationError> {
    cut.validate()?;
    let mut set = WindowSet::default();
    let mut longest: f64 = 0.0;
    for (run, signals) in runs.iter().enumerate() {
        let (first, last) = signals.span(cut.heading);
        longest = longest.max(last - first);
        // A little inside, so that rounding does not lead out of the series.
        let room = last - first - cut.horizon - 2.0 * ROUNDING;
        if room < 0.0 {
            continue;
        }
        let (mut next, count) = (0, (room / cut.spacing).floor() as usize);
        while next <= count {
            let start = first + ROUNDING + cut.spacing * next as f64;
            next += 1;
            if signals.pose_gap(start).is_some_and(|gap| gap > PAUSE)
                && let Some(behind) = signals.next_position(start)
            {
                next = next.max(((behind - first) / cut.spacing).floor() as usize);
                continue;
            }
            let wheels = signals.drive(start, cut.horizon);
            if mean_speed(&wheels) <= cut.least_wheel_speed {
                set.rejected.standing += 1;
            } else if let Some(window) = window(signals, run, start, wheels, cut) {
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
            horizon: cut.horizon,
        }),
        (true, _) => Err(IdentificationError::NoWindows {
            recording: recording(),
            standing,
            gaps,
        }),
    }
}

/// Where there is no pose for longer, nothing was recorded, or the clock was set: no window starts there \[s\].
const PAUSE: f64 = 60.0;
/// Room for rounding of times \[s\].
const ROUNDING: f64 = 1e-6;

fn window(signals: &Signals, run: usize, start: f64, wheels: Drive, cut: &Cut) -> Option<Window> {
    let stop = start + cut.horizon;
    let far_apart = |time| {
        signals
            .pose_gap(time)
            .is_none_or(|gap| gap > cut.longest_gap)
    };
    let is_lost = signals.is_lost(start, stop, cut.heading);
    if is_lost || far_apart(start) || far_apart(stop) {
        return None;
    }
    let ([x, y, mut heading], mut end) = (signals.pose(start)?, signals.pose(stop)?);
    if cut.heading == HeadingSource::Gyro {
        heading = signals.tied_heading(start)?;
        end[2] = heading + signals.turned(stop)? - signals.turned(start)?;
    }
    let [v_x, v_y, yaw_rate] = velocities(signals, start, heading)?;
    Some(Window {
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
        course: signals.course(start),
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
