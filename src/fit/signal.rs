//! Channels that are fitted, and which of them share their noise.

use crate::recording::Channel;

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

    /// Initial noise: that of a fair sensor and model.
    #[must_use]
    pub const fn first_guess(self) -> f64 {
        match self {
            Self::Position => 0.05,
            Self::Heading | Self::YawRate => 0.03,
            Self::VelocityForward | Self::VelocityLeft => 0.05,
        }
    }
}
