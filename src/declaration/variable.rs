//! What a variable stands for, and the value of an output.

use super::row::{Attributes, Field, Row};
use super::table::{FORCES, SOIL, VEHICLE, WHEEL};
use crate::effects::ParameterName;
use crate::simulation::{State, WheelSpeeds};
use crate::vehicle::Wrench;

/// A side of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Side {
    /// Both, in the order of the wheel speeds.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// The speed of the wheels of this side.
    pub fn of(self, speeds: &mut WheelSpeeds) -> &mut f64 {
        match self {
            Self::Left => &mut speeds.left,
            Self::Right => &mut speeds.right,
        }
    }
}

/// What a variable is to the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The wheel speed of a side.
    Input(Side),
    /// A state, in the order of [`crate::simulation::State::to_array`].
    State(usize),
    /// The rate of change of a state.
    Rate(usize),
    /// An output of the whole vehicle by its row in the table of forces.
    Total(usize),
    /// A wheel (from 0), and its output by the row in the table of wheels.
    Wheel(usize, usize),
    /// The terrain's number.
    Terrain,
    /// A parameter of the custom soil by its row in the table.
    Soil(usize),
    /// A parameter of the vehicle by its row in the table.
    Vehicle(usize),
    /// The offset of a wheel row (from 0).
    Row(usize),
    /// A parameter of an effect.
    Effect(ParameterName),
    /// An initial state.
    Initial(usize),
    /// Whether to start at the velocities of rolling without slip.
    NoSlip,
    /// The time.
    Time,
}

impl Quantity {
    /// An output of the forces: its value, or its derivative where `wrench` is one.
    #[inline]
    #[must_use]
    pub fn in_wrench(self, wrench: &Wrench) -> Option<f64> {
        match self {
            Self::Total(row) => Some((FORCES[row].value)(wrench)),
            Self::Wheel(wheel, row) => Some((WHEEL[row].value)(&wrench.wheels[wheel])),
            _ => None,
        }
    }

    /// The value of an input or output; `None` for other variables.
    #[must_use]
    pub fn output(self, mut speeds: WheelSpeeds, state: State, wrench: &Wrench) -> Option<f64> {
        match self {
            Self::Input(side) => Some(*side.of(&mut speeds)),
            Self::State(index) => Some(state.to_array()[index]),
            other => other.in_wrench(wrench),
        }
    }

    /// The row of a parameter of the custom soil or the vehicle.
    pub(super) fn parameter(self) -> Option<&'static Row<Field>> {
        match self {
            Self::Soil(row) => SOIL.get(row),
            Self::Vehicle(row) => VEHICLE.get(row),
            _ => None,
        }
    }
}

/// One variable of the FMU of a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name in the model description.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// What it stands for.
    pub quantity: Quantity,
    /// Its declared properties.
    pub attributes: &'static Attributes,
}
