//! The FMU's variables, from their one declaration in `modelDescription/variables.json`, and for
//! the parameters of effects in [`crate::effects::CATALOGUE`].
//!
//! The build script turns that file into the tables included here; value references, the
//! model description, its documentation and the C header follow from them.

mod arrays;
mod configuration;
mod dependencies;
mod effects;
mod resources;

pub use arrays::{ArrayVariable, Elements, Naming, array_variables};
pub use configuration::{Configuration, TERRAIN_NAMES};
pub use dependencies::{DependencyKind, dependencies, initial_dependencies, initial_pose};
pub use resources::{ConfigurationError, guid};

use crate::effects::ParameterName;

/// What a variable is to the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Left (0) or right (1) wheel speed.
    Input(usize),
    /// A state, in the order of [`crate::simulation::State::to_array`].
    State(usize),
    /// The rate of change of a state.
    Rate(usize),
    /// a_x, a_y, rolling resistance, moment of turning resistance, turning moment.
    Total(usize),
    /// A wheel (from 0) and which of the fields of [`crate::vehicle::WheelOutputs`].
    Wheel(usize, usize),
    /// The terrain's number.
    Terrain,
    /// A parameter of the custom soil, in the order of the fields of [`crate::terrain::Terrain`].
    Soil(usize),
    /// A parameter of the vehicle, in the order of the fields of [`crate::vehicle::Vehicle`]
    /// without the rows.
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

/// How a variable is seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set by the environment.
    Input,
    /// Computed for the environment.
    Output,
    /// Computed, of interest to the curious.
    Local,
    /// Set before the simulation starts.
    Parameter,
    /// What all else is a function of: the time.
    Independent,
}

/// Which of FMI's types carries a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `fmi2Real`, `fmi3Float64`.
    Real,
    /// `fmi2Boolean`, `fmi3Boolean`.
    Boolean,
    /// `fmi2Integer`, `fmi3Int64`: one of the items of [`enumerations()`].
    Enumeration,
}

/// What is declared of a variable besides its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attributes {
    /// How it is seen from outside.
    pub causality: Causality,
    /// FMI's type.
    pub kind: Kind,
    /// Name of the unit, one of [`units()`]; empty for what is no physical quantity.
    pub unit: &'static str,
    /// Value at the start, where it does not come from the vehicle or the terrain.
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

struct Declared {
    name: &'static str,
    quantity: Quantity,
    attributes: Attributes,
}

/// Declared once for every row or wheel; `{}` in the name stands for its number from 1.
struct DeclaredEach {
    name: &'static str,
    attributes: Attributes,
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

/// An enumeration: its items with value and description.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Enumeration {
    /// Name.
    pub name: &'static str,
    /// Meaning.
    pub description: &'static str,
    /// Name, value and meaning of each item.
    pub items: &'static [(&'static str, i32, &'static str)],
}

include!(concat!(env!("OUT_DIR"), "/declared.rs"));

/// What every library of this version holds and no other: the declaration as it is written, and the version.
pub const MARK: &str = concat!(
    include_str!("../../modelDescription/variables.json"),
    " ",
    env!("CARGO_PKG_VERSION"),
    "\n"
);

/// One variable of the FMU of a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name in the model description.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// What it is to the model.
    pub quantity: Quantity,
    /// What is declared of it.
    pub attributes: &'static Attributes,
}

/// Value references of rows and wheels begin here, each wheel having room for 16.
const FIRST_ROW: u32 = 1000;
const FIRST_WHEEL: u32 = 2000;
const PER_WHEEL: u32 = 16;

/// The variables of the FMU of a configuration, in the order of the model description.
#[must_use]
pub fn variables(configuration: &Configuration) -> Vec<Variable> {
    let rows = configuration.rows();
    let scalars = SCALARS
        .iter()
        .zip(0..)
        .map(|(declared, reference)| Variable {
            name: declared.name.to_owned(),
            reference,
            quantity: declared.quantity,
            attributes: &declared.attributes,
        });
    let each = |declared: &'static DeclaredEach, index: usize, first, quantity| Variable {
        name: declared.name.replace("{}", &(index + 1).to_string()),
        reference: first,
        quantity,
        attributes: &declared.attributes,
    };
    let row_variables = (0..rows)
        .zip(FIRST_ROW..)
        .flat_map(move |(row, reference)| {
            ROW.iter()
                .map(move |declared| each(declared, row, reference, Quantity::Row(row)))
        });
    let wheel_variables = (0..2 * rows).flat_map(move |wheel| {
        let first = FIRST_WHEEL + PER_WHEEL * wheel as u32;
        WHEEL.iter().enumerate().map(move |(field, declared)| {
            each(
                declared,
                wheel,
                first + field as u32,
                Quantity::Wheel(wheel, field),
            )
        })
    });
    scalars
        .chain(effects::variables(configuration))
        .chain(row_variables)
        .chain(wheel_variables)
        .collect()
}

/// The variable behind a value reference in the FMU of a configuration.
#[inline]
#[must_use]
pub fn find(
    reference: u32,
    configuration: &Configuration,
) -> Option<(Quantity, &'static Attributes)> {
    if let Some(declared) = SCALARS.get(reference as usize) {
        return Some((declared.quantity, &declared.attributes));
    }
    if (effects::FIRST..FIRST_ROW).contains(&reference) {
        return effects::find(reference, configuration);
    }
    let rows = configuration.rows() as u32;
    if (FIRST_ROW..FIRST_ROW + rows).contains(&reference) {
        let row = (reference - FIRST_ROW) as usize;
        return Some((Quantity::Row(row), &ROW[0].attributes));
    }
    let offset = reference.checked_sub(FIRST_WHEEL)?;
    let (wheel, field) = (offset / PER_WHEEL, (offset % PER_WHEEL) as usize);
    let declared = WHEEL.get(field).filter(|_| wheel < 2 * rows)?;
    Some((Quantity::Wheel(wheel as usize, field), &declared.attributes))
}

/// The states' orders of magnitude, in the order of [`crate::simulation::State::to_array`].
#[must_use]
pub fn state_nominals() -> [f64; 6] {
    std::array::from_fn(|index| {
        let declared = SCALARS
            .iter()
            .find(|d| d.quantity == Quantity::State(index));
        declared.and_then(|d| d.attributes.nominal).unwrap_or(1.0)
    })
}

/// The units that the variables use.
#[must_use]
pub fn units() -> &'static [Unit] {
    &UNITS
}

/// The enumerations that the variables use.
#[must_use]
pub fn enumerations() -> &'static [Enumeration] {
    &ENUMERATIONS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effects;
    use std::collections::HashSet;

    fn with_rows(rows: usize) -> Configuration {
        let mut configuration = Configuration::default();
        configuration.vehicle.row_positions = vec![0.0; rows];
        configuration
    }

    #[test]
    fn every_reference_finds_its_variable_and_no_other_does() {
        for rows in [2, 3, 4, 64] {
            let configuration = with_rows(rows);
            let variables = variables(&configuration);
            for variable in &variables {
                let found = find(variable.reference, &configuration);
                assert_eq!(
                    found,
                    Some((variable.quantity, variable.attributes)),
                    "{}",
                    variable.name
                );
            }
            let references: HashSet<u32> = variables.iter().map(|v| v.reference).collect();
            let names: HashSet<&str> = variables.iter().map(|v| v.name.as_str()).collect();
            assert_eq!(
                (references.len(), names.len()),
                (variables.len(), variables.len())
            );
            for reference in (0..10_000).chain([u32::MAX]) {
                assert_eq!(
                    find(reference, &configuration).is_some(),
                    references.contains(&reference)
                );
            }
        }
    }

    #[test]
    fn every_unit_is_defined_and_used() {
        let mut configuration = with_rows(2);
        configuration.effects = Effects::NONE.with("multipass.memory", 1.0).unwrap();
        let used = variables(&configuration);
        let used: HashSet<&str> = used.iter().map(|v| v.attributes.unit).collect();
        for unit in used.iter().filter(|unit| !unit.is_empty()) {
            assert!(units().iter().any(|u| u.name == *unit), "{unit}");
        }
        // The time's is "s".
        for unit in units().iter().filter(|unit| unit.name != "s") {
            assert!(used.contains(unit.name), "{}", unit.name);
        }
    }
}
