//! The same motion as different sensors see it.

use crate::recording::{Channel, Cumulated, Run, Series, way_along};

/// Something that several sensors tell about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Right less left wheel speed \[rad/s\]: turning, as the wheels have it.
    WheelDifference,
    /// Mean of both wheel speeds \[rad/s\]: driving, as the wheels have it.
    WheelMean,
    /// Yaw rate \[rad/s\], as the gyro has it.
    YawRate,
    /// Rate of the heading \[rad/s\], as the pose has it.
    Heading,
    /// Speed along the heading \[m/s\], as the pose has it.
    Way,
    /// Velocity forward \[m/s\], as measured.
    Velocity,
}

impl Signal {
    /// What it is called in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WheelDifference | Self::WheelMean => "wheels",
            Self::YawRate => "yaw_rate",
            Self::Heading => "heading",
            Self::Way => "position",
            Self::Velocity => "v_x",
        }
    }

    /// Its integral over a run; `None` where it was not measured.
    #[must_use]
    pub fn of(self, run: &Run) -> Option<Cumulated> {
        let rate = |series: &Series| Cumulated::of_rate(series);
        let sum = match self {
            Self::WheelDifference => rate(&wheels(run, [-1.0, 1.0])?),
            Self::WheelMean => rate(&wheel_mean(run)?),
            Self::YawRate => rate(run.series(Channel::YawRate)?),
            Self::Velocity => rate(run.series(Channel::VX)?),
            Self::Heading => Cumulated::of_position(run.series(Channel::Heading)?),
            Self::Way => Cumulated::of_position(&way_along(
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

/// A sum of both wheel speeds, where both are known.
fn wheels(run: &Run, weights: [f64; 2]) -> Option<Series> {
    let right = run.series(Channel::OmegaRight)?;
    let sum = run
        .series(Channel::OmegaLeft)?
        .samples()
        .filter_map(|(time, left)| Some((time, weights[0] * left + weights[1] * right.at(time)?)));
    Some(sum.collect())
}
