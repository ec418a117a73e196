//! The variables of an FMU with their value references: scalars in FMI 2.0, in FMI 3.0 one array for
//! each quantity of rows and wheels.
//!
//! A scalar has the same value reference in both. An array has that of its first element: the row
//! positions 1000, the quantities of the wheels 2000 and up. The time is a variable in FMI 3.0 only.

use super::configuration::Configuration;
use super::effects;
use super::row::{Attributes, Row};
use super::table::{
    FORCES, INITIAL, INPUTS, NO_SLIP, RATES, ROW, SOIL, STATES, TERRAIN_NUMBER, TIME, VEHICLE,
    WHEEL,
};
use super::variable::{Quantity, Side, Variable};
use crate::effects::CATALOGUE;
use std::sync::LazyLock;

/// Value reference of the time, and the first ones of rows and wheels.
const TIME_REFERENCE: u32 = 400;
const FIRST_ROW: u32 = 1000;
const FIRST_WHEEL: u32 = 2000;
/// Value references reserved for each wheel.
const PER_WHEEL: u32 = 16;

const _: () = {
    assert!(TIME_REFERENCE < effects::FIRST);
    assert!(effects::FIRST + effects::PER_EFFECT * CATALOGUE.len() as u32 <= FIRST_ROW);
    assert!(WHEEL.len() <= PER_WHEEL as usize);
};

/// The scalars of the table; the index is the value reference.
static SCALARS: LazyLock<Vec<Variable>> = LazyLock::new(|| {
    let mut all = Vec::new();
    numbered(&mut all, &INPUTS, |index| {
        Quantity::Input(Side::BOTH[index])
    });
    numbered(&mut all, &STATES, Quantity::State);
    numbered(&mut all, &FORCES, Quantity::Total);
    numbered(&mut all, &RATES, Quantity::Rate);
    numbered(&mut all, &TERRAIN_NUMBER, |_| Quantity::Terrain);
    numbered(&mut all, &SOIL, Quantity::Soil);
    numbered(&mut all, &VEHICLE, Quantity::Vehicle);
    numbered(&mut all, &INITIAL, Quantity::Initial);
    numbered(&mut all, &NO_SLIP, |_| Quantity::NoSlip);
    all
});

/// Appends the rows of a table with the value references that follow.
fn numbered<F>(all: &mut Vec<Variable>, rows: &'static [Row<F>], quantity: fn(usize) -> Quantity) {
    for (index, row) in rows.iter().enumerate() {
        all.push(Variable {
            name: row.name.to_owned(),
            reference: all.len() as u32,
            quantity: quantity(index),
            attributes: &row.attributes,
        });
    }
}

/// The variables of the FMU of a configuration, in the order of the model description.
#[must_use]
pub fn variables(configuration: &Configuration) -> Vec<Variable> {
    let rows = configuration.rows();
    let row_variables = (0..rows).map(|row| Variable {
        name: format!("{}[{}]", ROW.name, row + 1),
        reference: FIRST_ROW + row as u32,
        quantity: Quantity::Row(row),
        attributes: &ROW.attributes,
    });
    let wheel_variables = (0..2 * rows).flat_map(|wheel| {
        WHEEL.iter().enumerate().map(move |(index, row)| Variable {
            name: format!("wheel[{}].{}", wheel + 1, row.name),
            reference: FIRST_WHEEL + PER_WHEEL * wheel as u32 + index as u32,
            quantity: Quantity::Wheel(wheel, index),
            attributes: &row.attributes,
        })
    });
    let scalars = SCALARS.iter().cloned();
    let with_effects = scalars.chain(effects::variables(configuration));
    let with_rows = with_effects.chain(row_variables);
    with_rows.chain(wheel_variables).collect()
}

/// The states' orders of magnitude, in the order of [`crate::simulation::State::to_array`].
#[must_use]
pub fn state_nominals() -> [f64; 6] {
    STATES
        .each_ref()
        .map(|row| row.attributes.nominal.unwrap_or(1.0))
}

/// Whether value references stand for scalars only or also for arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Naming {
    /// FMI 2.0: each row and wheel has its own variables.
    Scalars,
    /// FMI 3.0: each quantity of rows and wheels is one array.
    Arrays,
}

/// The quantities of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Elements {
    /// One quantity.
    One(Quantity),
    /// The offsets of so many rows.
    Rows(usize),
    /// One of the fields of so many wheels.
    Wheels(usize, usize),
}

impl Elements {
    /// Size of the array; `None` for a scalar.
    #[inline]
    #[must_use]
    pub fn dimension(self) -> Option<usize> {
        match self {
            Self::One(_) => None,
            Self::Rows(count) | Self::Wheels(count, _) => Some(count),
        }
    }

    /// Number of quantities.
    #[inline]
    #[must_use]
    pub fn count(self) -> usize {
        self.dimension().unwrap_or(1)
    }

    /// The quantity at a place, from 0.
    #[inline]
    #[must_use]
    pub fn at(self, index: usize) -> Quantity {
        match self {
            Self::One(quantity) => quantity,
            Self::Rows(_) => Quantity::Row(index),
            Self::Wheels(_, field) => Quantity::Wheel(index, field),
        }
    }

    /// All quantities in order.
    #[inline]
    pub fn quantities(self) -> impl Iterator<Item = Quantity> {
        (0..self.count()).map(move |index| self.at(index))
    }

    /// The array whose first element is a quantity; `None` for the other rows and wheels.
    fn from_first(quantity: Quantity, configuration: &Configuration) -> Option<Self> {
        Some(match quantity {
            Quantity::Row(0) => Self::Rows(configuration.rows()),
            Quantity::Wheel(0, field) => Self::Wheels(2 * configuration.rows(), field),
            Quantity::Row(_) | Quantity::Wheel(..) => return None,
            other => Self::One(other),
        })
    }
}

/// A variable that may be an array.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayVariable {
    /// Name in the model description.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// Its quantities.
    pub elements: Elements,
    /// The declared properties of each element.
    pub attributes: &'static Attributes,
}

impl ArrayVariable {
    /// The start values of its elements, separated by spaces; empty for calculated variables.
    #[must_use]
    pub fn starts(&self, configuration: &Configuration) -> String {
        let starts = self.elements.quantities().filter_map(|quantity| {
            let start = configuration.parameter(quantity);
            start.or(self.attributes.start)
        });
        let starts: Vec<String> = starts.map(|start| start.to_string()).collect();
        starts.join(" ")
    }
}

impl Naming {
    /// The variables of the FMU of a configuration, in the order of the model description: of arrays,
    /// the time first.
    #[must_use]
    pub fn variables(self, configuration: &Configuration) -> Vec<ArrayVariable> {
        let time = ArrayVariable {
            name: TIME.name.to_owned(),
            reference: TIME_REFERENCE,
            elements: Elements::One(Quantity::Time),
            attributes: &TIME.attributes,
        };
        let others = variables(configuration).into_iter().filter_map(|variable| {
            Some(ArrayVariable {
                elements: self.elements(variable.quantity, configuration)?,
                name: match self {
                    Self::Scalars => variable.name,
                    Self::Arrays => variable.name.replace("[1]", ""),
                },
                reference: variable.reference,
                attributes: variable.attributes,
            })
        });
        let time = (self == Self::Arrays).then_some(time);
        time.into_iter().chain(others).collect()
    }

    fn elements(self, quantity: Quantity, configuration: &Configuration) -> Option<Elements> {
        match self {
            Self::Scalars => Some(Elements::One(quantity)),
            Self::Arrays => Elements::from_first(quantity, configuration),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::declaration::table::UNITS;
    use crate::effects::Effects;
    use crate::simulation::State;
    use crate::vehicle::{WheelOutputs, Wrench};
    use std::collections::HashSet;

    fn with_rows(rows: usize) -> Configuration {
        let mut configuration = Configuration::default();
        configuration.vehicle.row_positions = vec![0.0; rows];
        configuration
    }

    #[test]
    fn names_and_references_are_distinct_and_the_same_for_scalars_and_arrays() {
        for rows in [2, 3, 4, 64] {
            let configuration = with_rows(rows);
            let scalars = variables(&configuration);
            let references: HashSet<u32> = scalars.iter().map(|v| v.reference).collect();
            let names: HashSet<&str> = scalars.iter().map(|v| v.name.as_str()).collect();
            assert_eq!(
                (references.len(), names.len()),
                (scalars.len(), scalars.len())
            );
            for array in Naming::Arrays.variables(&configuration).iter().skip(1) {
                let first = scalars.iter().find(|v| v.reference == array.reference);
                assert_eq!(
                    first.unwrap().quantity,
                    array.elements.at(0),
                    "{}",
                    array.name
                );
            }
            assert!(!references.contains(&TIME_REFERENCE));
        }
    }

    #[test]
    fn every_unit_is_defined_and_used() {
        let mut configuration = with_rows(2);
        configuration.effects = Effects::NONE.with("multipass.memory", 1.0).unwrap();
        let used = variables(&configuration);
        let used: HashSet<&str> = used.iter().map(|v| v.attributes.unit).collect();
        for unit in used.iter().filter(|unit| !unit.is_empty()) {
            assert!(UNITS.iter().any(|u| u.name == *unit), "{unit}");
        }
        // The time's is "s".
        for unit in UNITS.iter().filter(|unit| unit.name != "s") {
            assert!(used.contains(unit.name), "{}", unit.name);
        }
    }

    /// The number that the debug output of a structure has for a field.
    fn field(structure: &str, name: &str) -> f64 {
        let (_, rest) = structure.split_once(&format!(" {name}: ")).unwrap();
        rest.split([',', ' ']).next().unwrap().parse().unwrap()
    }

    #[test]
    fn every_output_is_the_field_of_its_name() {
        let wheels = (0..8).map(|wheel| {
            WheelOutputs::from_array(std::array::from_fn(|k| {
                f64::from(10 * wheel) + k as f64 + 0.5
            }))
        });
        let wrench = Wrench {
            a_x: 101.0,
            a_y: 102.0,
            yaw_acceleration: 103.0,
            rolling_resistance: 104.0,
            turning_resistance_moment: 105.0,
            turning_moment: 106.0,
            torque_left: 107.0,
            torque_right: 108.0,
            power: 109.0,
            wheels: wheels.collect(),
        };
        let state = State::from_array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let speeds = [7.0, 8.0].into();
        for variable in variables(&Configuration::default()) {
            let value = variable.quantity.output(speeds, state, &wrench);
            let expected = match (variable.quantity, variable.name.as_str()) {
                (_, "omega_left") => Some(7.0),
                (_, "omega_right") => Some(8.0),
                (Quantity::State(_), name) => Some(field(&format!("{state:?}"), name)),
                (Quantity::Total(_), name) => Some(field(&format!("{wrench:?}"), name)),
                (Quantity::Wheel(wheel, _), name) => {
                    let (_, name) = name.split_once('.').unwrap();
                    Some(field(&format!("{:?}", wrench.wheels[wheel]), name))
                }
                _ => None,
            };
            assert_eq!(value, expected, "{}", variable.name);
        }
    }

    #[test]
    fn the_arrays_hold_each_scalar_once_and_the_time() {
        let configuration = Configuration::default();
        let arrays = Naming::Arrays.variables(&configuration);
        let held: Vec<Quantity> = arrays
            .iter()
            .flat_map(|v| v.elements.quantities())
            .collect();
        let scalars = variables(&configuration);
        assert_eq!(held.len(), scalars.len() + 1);
        for quantity in scalars.iter().map(|v| v.quantity).chain([Quantity::Time]) {
            assert_eq!(held.iter().filter(|q| **q == quantity).count(), 1);
        }
        let load = arrays.iter().find(|v| v.name == "wheel.load").unwrap();
        assert_eq!((load.reference, load.elements.dimension()), (2002, Some(8)));
        assert!(arrays.iter().all(|v| !v.name.contains('[')));
    }
}
