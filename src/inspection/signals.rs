//! The same motion, measured by different sensors.

use crate::recording::{Channel, Cumulated, Run, Series, distance_along_heading};

/// A signal of the motion from one sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionSignal {
    /// Right minus left wheel speed \[rad/s\]: turning, by the wheels.
    WheelDifference,
    /// Mean of both wheel speeds \[rad/s\]: driving, by the wheels.
    WheelMean,
    /// Speed of the left wheels \[rad/s\].
    LeftWheels,
    /// Speed of the right wheels \[rad/s\].
    RightWheels,
    /// Yaw rate \[rad/s\], by the gyro.
    YawRate,
    /// Rate of the heading \[rad/s\], by the pose.
    Heading,
    /// Speed along the heading \[m/s\], by the pose.
    Distance,
    /// Velocity forward \[m/s\], as measured.
    Velocity,
}

impl MotionSignal {
    /// Name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WheelDifference | Self::WheelMean | Self::LeftWheels | Self::RightWheels => {
                "wheels"
            }
            Self::YawRate => "yaw_rate",
            Self::Heading => "heading",
            Self::Distance => "position",
            Self::Velocity => "v_x",
        }
    }

    /// Its integral over a run; `None` if it was not measured.
    #[must_use]
    pub fn of(self, run: &Run) -> Option<Cumulated> {
        let rate = |series: &Series| Cumulated::of_rate(series);
        let sum = match self {
            Self::WheelDifference => rate(&wheels(run, [-1.0, 1.0])?),
            Self::WheelMean => rate(&wheel_mean(run)?),
            Self::LeftWheels => rate(run.series(Channel::OmegaLeft)?),
            Self::RightWheels => rate(run.series(Channel::OmegaRight)?),
            Self::YawRate => rate(run.series(Channel::YawRate)?),
            Self::Velocity => rate(run.series(Channel::VX)?),
            Self::Heading => Cumulated::of_position(run.series(Channel::Heading)?),
            Self::Distance => Cumulated::of_position(&distance_along_heading(
                run.series(Channel::X)?,
                run.series(Channel::Y)?,
                run.series(Channel::Heading)?,
            )),
        };
        sum.span().filter(|(start, end)| end > start).map(|_| sum)
    }
}

/// Mean of both wheel speeds \[rad/s\].
#[must_use]
pub fn wheel_mean(run: &Run) -> Option<Series> {
    wheels(run, [0.5, 0.5])
}

/// Mean rate of the heading over a window around each sample of it \[rad/s\].
#[must_use]
pub fn heading_rate(run: &Run, window: f64) -> Option<Series> {
    let heading = run.series(Channel::Heading)?;
    let sum = Cumulated::of_position(heading);
    let rates = heading
        .time
        .iter()
        .filter_map(|time| Some((*time, sum.mean_rate(*time, window)?)));
    Some(rates.collect())
}

/// A weighted sum of both wheel speeds.
fn wheels(run: &Run, weights: [f64; 2]) -> Option<Series> {
    let [left, right] = [
        run.series(Channel::OmegaLeft)?,
        run.series(Channel::OmegaRight)?,
    ];
    // At the times of the side with fewer samples: a gap of either is then a gap of the sum.
    let [by_left, by_right] = weights;
    Some(if right.len() < left.len() {
        Series::weighted_sum([right, left], [by_right, by_left])
    } else {
        Series::weighted_sum([left, right], [by_left, by_right])
    })
}
