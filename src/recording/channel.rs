//! The quantities that a recording may hold.

use std::fmt;

/// A measured quantity: a column of the file. Velocities and accelerations are those of the
/// reference point along the body's axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Angular speed of the left wheels \[rad/s\], positive forward.
    OmegaLeft,
    /// Angular speed of the right wheels \[rad/s\], positive forward.
    OmegaRight,
    /// Position east \[m\].
    X,
    /// Position north \[m\].
    Y,
    /// Heading \[rad\], counter-clockwise from x, continuous beyond a full turn.
    Heading,
    /// Velocity forward \[m/s\].
    VX,
    /// Velocity to the left \[m/s\].
    VY,
    /// Yaw rate \[rad/s\], positive counter-clockwise.
    YawRate,
    /// Acceleration along X \[m/s^2\].
    AX,
    /// Acceleration along Y \[m/s^2\].
    AY,
}

/// Name and unit of each channel, in the order of [`Channel::index`].
const COLUMNS: [(&str, &str); 10] = [
    ("omega_left", "rad/s"),
    ("omega_right", "rad/s"),
    ("x", "m"),
    ("y", "m"),
    ("heading", "rad"),
    ("v_x", "m/s"),
    ("v_y", "m/s"),
    ("yaw_rate", "rad/s"),
    ("a_x", "m/s^2"),
    ("a_y", "m/s^2"),
];

impl Channel {
    /// Every channel, in the order of [`Channel::index`].
    pub const ALL: [Self; 10] = [
        Self::OmegaLeft,
        Self::OmegaRight,
        Self::X,
        Self::Y,
        Self::Heading,
        Self::VX,
        Self::VY,
        Self::YawRate,
        Self::AX,
        Self::AY,
    ];

    /// Index in [`Channel::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Name of the column.
    #[must_use]
    pub const fn name(self) -> &'static str {
        COLUMNS[self.index()].0
    }

    /// Unit of the values.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        COLUMNS[self.index()].1
    }

    /// Whether a recording without this channel is refused.
    #[must_use]
    pub const fn is_required(self) -> bool {
        matches!(self, Self::OmegaLeft | Self::OmegaRight)
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_places() {
        for (place, channel) in Channel::ALL.into_iter().enumerate() {
            assert_eq!(channel.index(), place);
        }
    }
}
