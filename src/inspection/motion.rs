//! How long, how far, and how much of it at rest.

use crate::recording::{Channel, Run, way_along};

/// Wheels slower than this stand still \[rad/s\].
const STILL: f64 = 0.02;

/// Duration and distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// From the first sample to the last \[s\].
    pub duration: f64,
    /// Length of the way along the heading, forward and back, after the pose \[m\]; `None`
    /// without a pose.
    pub distance: Option<f64>,
    /// Angle turned, both ways, after the yaw rate, or after the heading without one \[rad\].
    pub turned: Option<f64>,
    /// Time in which all wheels stand still \[s\].
    pub at_rest: f64,
}

impl Motion {
    /// Of one run.
    #[must_use]
    pub fn of(run: &Run) -> Self {
        let series = |channel| run.series(channel);
        let pose = (
            series(Channel::X),
            series(Channel::Y),
            series(Channel::Heading),
        );
        let length = |values: &[f64]| {
            values
                .windows(2)
                .map(|pair| (pair[1] - pair[0]).abs())
                .sum()
        };
        let distance = match pose {
            (Some(x), Some(y), Some(heading)) => Some(length(&way_along(x, y, heading).value)),
            _ => None,
        };
        let turned = series(Channel::YawRate).map(|rate| {
            let pairs = rate.value.windows(2).zip(rate.intervals());
            pairs
                .map(|(pair, interval)| (pair[0] + pair[1]).abs() / 2.0 * interval)
                .sum()
        });
        Self {
            duration: run.duration(),
            distance,
            turned: turned
                .or_else(|| series(Channel::Heading).map(|heading| length(&heading.value))),
            // A sum of nothing is -0.
            at_rest: 0.0
                + rest_spans(run)
                    .iter()
                    .map(|(from, to)| to - from)
                    .sum::<f64>(),
        }
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let sum = |a: Option<f64>, b: Option<f64>| a.map_or(b, |a| Some(a + b.unwrap_or(0.0)));
        Self {
            duration: self.duration + other.duration,
            distance: sum(self.distance, other.distance),
            turned: sum(self.turned, other.turned),
            at_rest: self.at_rest + other.at_rest,
        }
    }
}

/// The spans in which all wheels stand still \[s\].
#[must_use]
pub fn rest_spans(run: &Run) -> Vec<(f64, f64)> {
    let Some(drive) = run.drive() else {
        return Vec::new();
    };
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut still_since = None;
    for (row, &time) in drive.time.iter().enumerate() {
        let is_still = drive
            .wheel_speeds(row)
            .iter()
            .all(|speed| speed.abs() <= STILL);
        match (is_still, still_since) {
            (true, None) => still_since = Some((time, time)),
            (true, Some((since, _))) => still_since = Some((since, time)),
            (false, Some(span)) => {
                spans.push(span);
                still_since = None;
            }
            (false, None) => {}
        }
    }
    spans.extend(still_since);
    spans.retain(|(from, to)| to > from);
    spans
}
