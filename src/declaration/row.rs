//! The rows of the table of variables.

use super::configuration::Configuration;
use crate::vehicle::{WheelOutputs, Wrench};

/// How a variable is seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set by the environment.
    Input,
    /// Computed for the environment.
    Output,
    /// Computed, but not connected to other models.
    Local,
    /// Set before the simulation starts.
    Parameter,
    /// The time.
    Independent,
}

/// The FMI type of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `fmi2Real`, `fmi3Float64`.
    Real,
    /// `fmi2Boolean`, `fmi3Boolean`.
    Boolean,
    /// `fmi2Integer`, `fmi3Int64`: the number of a terrain, from 1, in [`super::TERRAINS`].
    Enumeration,
}

/// The declared properties of a variable besides its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attributes {
    /// How it is seen from outside.
    pub causality: Causality,
    /// FMI's type.
    pub kind: Kind,
    /// Name of the unit, one of [`super::UNITS`]; empty for Booleans and enumerations.
    pub unit: &'static str,
    /// Start value, where it does not come from the vehicle or the terrain.
    pub start: Option<f64>,
    /// Smallest value.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Order of magnitude.
    pub nominal: Option<f64>,
    /// Meaning, with the paper's equation.
    pub description: &'static str,
}

/// A unit and its exponents of the SI base units; `None` where they depend on the soil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Name.
    pub name: &'static str,
    /// Exponents of the base units.
    pub base: Option<&'static [(&'static str, i32)]>,
    /// Factor to the base unit, 1 where absent.
    pub factor: Option<f64>,
}

/// One variable. `F` gives its value, where that is not a state, an input or a setting of the FMU.
pub(super) struct Row<F: 'static = ()> {
    /// Name in the model description; for rows and wheels without the number.
    pub name: &'static str,
    pub attributes: Attributes,
    pub value: F,
}

/// An output that the forces give. The function also takes the derivative of the forces to that of
/// the output, so that it must be linear.
pub(super) type Computed<S> = Row<fn(&S) -> f64>;

/// Where a parameter is kept, in SI units and radians.
#[derive(Clone, Copy)]
pub(super) struct Field {
    pub get: fn(&Configuration) -> f64,
    pub set: fn(&mut Configuration, f64),
}

pub(super) const fn row(
    causality: Causality,
    name: &'static str,
    unit: &'static str,
    description: &'static str,
) -> Row {
    let attributes = Attributes {
        causality,
        kind: Kind::Real,
        unit,
        start: None,
        min: None,
        max: None,
        nominal: None,
        description,
    };
    Row {
        name,
        attributes,
        value: (),
    }
}

impl Row {
    pub const fn of_kind(mut self, kind: Kind) -> Self {
        self.attributes.kind = kind;
        self
    }

    pub const fn range(mut self, min: f64, max: f64) -> Self {
        self.attributes.min = Some(min);
        self.attributes.max = Some(max);
        self
    }

    pub const fn nominal(mut self, nominal: f64) -> Self {
        self.attributes.nominal = Some(nominal);
        self
    }

    pub const fn start(mut self, start: f64) -> Self {
        self.attributes.start = Some(start);
        self
    }

    pub const fn force(self, value: fn(&Wrench) -> f64) -> Computed<Wrench> {
        self.with(value)
    }

    pub const fn wheel(self, value: fn(&WheelOutputs) -> f64) -> Computed<WheelOutputs> {
        self.with(value)
    }

    pub const fn field(self, value: Field) -> Row<Field> {
        self.with(value)
    }

    const fn with<F: Copy>(self, value: F) -> Row<F> {
        Row {
            name: self.name,
            attributes: self.attributes,
            value,
        }
    }
}

pub(super) const fn unit(name: &'static str, base: &'static [(&'static str, i32)]) -> Unit {
    Unit {
        name,
        base: Some(base),
        factor: None,
    }
}
