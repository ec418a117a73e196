//! A direction in which a wrench is differentiated.

use crate::vehicle::ModelParameter;

/// What is varied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Direction {
    /// V_X or V_Y.
    Velocity(usize),
    YawRate,
    /// Left or right.
    WheelSpeed(usize),
    /// East or north.
    Position(usize),
    Heading,
    Time,
    /// One of the remembered numbers.
    Memory(usize),
    Parameter(ModelParameter),
}

impl Direction {
    /// The five components of [`Motion`].
    pub const MOTION: [Self; 5] = [
        Self::Velocity(0),
        Self::Velocity(1),
        Self::YawRate,
        Self::WheelSpeed(0),
        Self::WheelSpeed(1),
    ];
    /// Position and heading.
    pub const POSE: [Self; 3] = [Self::Position(0), Self::Position(1), Self::Heading];

    /// Whether the wheels' forces at held entry angles may depend on it; otherwise it acts on the
    /// vehicle's body alone. Chunks of the latter cost little.
    pub fn reaches_wheels(&self) -> bool {
        match self {
            Self::Parameter(parameter) => !parameter.acts_on_body(),
            Self::Position(_) | Self::Heading => false,
            _ => true,
        }
    }

    /// Whether the soil under a wheel depends on its place by it.
    pub fn changes_soil(&self) -> bool {
        matches!(self, Self::Parameter(parameter) if parameter.changes_soil_by_place())
    }
}
