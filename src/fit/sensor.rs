//! The sensors' parameters: constant faults of a recording's sensors.

use super::catalogue::describe_effect;
use super::error::FitError;
use super::parameter::FreeParameter;
use super::signal::Signal;
use crate::effects::ParameterName;
use crate::identification::{Latencies, Signals};
use crate::recording::{Channel, Recording};
use crate::spelling::nearest;

/// A constant property of a recording's sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SensorParameter {
    /// How much the pose trails the clock \[s\].
    PoseLatency,
    /// How much the wheel speeds trail the clock \[s\].
    WheelLatency,
    /// What the gyro shows at rest \[rad/s\].
    YawRateBias,
    /// How far ahead of the centre of mass the pose is measured \[m\].
    LeverArmX,
    /// How far left of the centre of mass the pose is measured \[m\].
    LeverArmY,
    /// How far the measured heading is turned against the vehicle's axis \[rad\].
    HeadingOffset,
}

/// Values of all sensor parameters of a recording, in the order of [`SensorParameter::ALL`].
pub type SensorValues = [f64; SensorParameter::ALL.len()];

impl SensorParameter {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::PoseLatency,
        Self::WheelLatency,
        Self::YawRateBias,
        Self::LeverArmX,
        Self::LeverArmY,
        Self::HeadingOffset,
    ];

    /// Those that are fitted by default.
    pub const DEFAULT_FREE: [Self; 3] = [Self::PoseLatency, Self::WheelLatency, Self::YawRateBias];

    /// Place in [`SensorParameter::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Name as users write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PoseLatency => "pose_latency",
            Self::WheelLatency => "wheel_latency",
            Self::YawRateBias => "yaw_rate_bias",
            Self::LeverArmX => "lever_arm_x",
            Self::LeverArmY => "lever_arm_y",
            Self::HeadingOffset => "heading_offset",
        }
    }

    /// What is declared of it among the effects of sensors.
    #[must_use]
    pub fn declared(self) -> ParameterName {
        let name = match self {
            Self::PoseLatency => "latency.pose",
            Self::WheelLatency => "latency.wheels",
            Self::YawRateBias => "yaw_rate_bias.bias",
            Self::LeverArmX => "lever_arm.ahead",
            Self::LeverArmY => "lever_arm.left",
            Self::HeadingOffset => "heading_offset.offset",
        };
        ParameterName::find(name).expect("a test looks up every name")
    }

    /// The parameter of a name.
    ///
    /// # Errors
    /// The nearest name, where none fits.
    pub fn parse(name: &str) -> Result<Self, &'static str> {
        let names = Self::ALL.map(Self::name);
        let found = Self::ALL.into_iter().find(|p| p.name() == name);
        found.ok_or_else(|| nearest(name, names).unwrap_or_default())
    }

    /// Whether a recording has the channels that determine it.
    #[must_use]
    pub fn is_told_by(self, recording: &Recording) -> bool {
        let pose = recording.has(Channel::X) || recording.has(Channel::Heading);
        // A pose can only trail something: the gyro or velocities.
        let clock = recording.has(Channel::YawRate) || recording.has(Channel::VX);
        match self {
            Self::PoseLatency => pose && clock,
            Self::WheelLatency => true,
            Self::YawRateBias => recording.has(Channel::YawRate),
            Self::LeverArmX | Self::LeverArmY => recording.has(Channel::X),
            Self::HeadingOffset => recording.has(Channel::Heading),
        }
    }

    /// The parameter to be fitted for a recording, as its effect declares it.
    #[must_use]
    pub fn parameter(self, recording: &str) -> FreeParameter {
        let declared = self.declared().declaration().1;
        let name = format!("{recording}.{}", self.name());
        describe_effect(name, declared)
    }
}

/// Latencies of a recording from the correlation of pose, gyro and wheels; zero where that is not clear, and
/// for all else. A search from zero may end where motions are matched with their neighbours.
#[must_use]
pub fn compared(recording: &Recording) -> SensorValues {
    let mut values = [0.0; SensorParameter::ALL.len()];
    if let Ok(runs) = Signals::of(recording) {
        let latencies = Latencies::estimate(&runs);
        values[SensorParameter::PoseLatency.index()] = latencies.pose.value();
        values[SensorParameter::WheelLatency.index()] = latencies.wheels.value();
    }
    values
}

/// Of the sensor parameters wanted, those that a recording determines.
///
/// # Errors
/// A recording in which nothing is measured, and a parameter that is wanted twice.
pub fn free_sensors(
    recording: &Recording,
    wanted: &[SensorParameter],
) -> Result<Vec<SensorParameter>, FitError> {
    if !Signal::ALL
        .iter()
        .any(|signal| recording.has(signal.channel()))
    {
        return Err(FitError::NothingMeasured {
            recording: recording.name.clone(),
        });
    }
    let twice = |(place, sensor): (usize, &SensorParameter)| wanted[..place].contains(sensor);
    if let Some((_, sensor)) = wanted.iter().enumerate().find(|one| twice(*one)) {
        let name = sensor.name().into();
        return Err(FitError::Twice { name });
    }
    let tells = |sensor: &SensorParameter| sensor.is_told_by(recording);
    Ok(wanted.iter().copied().filter(tells).collect())
}

impl Signal {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for (place, parameter) in SensorParameter::ALL.into_iter().enumerate() {
            assert_eq!(parameter.index(), place);
            assert_eq!(SensorParameter::parse(parameter.name()), Ok(parameter));
            let declared = parameter.declared().declaration().1;
            assert!(declared.low < 0.0 && declared.high == -declared.low);
            assert_eq!(parameter.parameter("drive").prior.median, declared.default);
        }
        assert_eq!(SensorParameter::parse("pose_lag"), Err("pose_latency"));
    }
}
