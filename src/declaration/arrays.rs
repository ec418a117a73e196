//! The variables as FMI 3.0 has them: one array for each quantity of the rows and of the wheels.
//!
//! Value references: a scalar has the one that it has among [`super::variables()`], an array that of
//! its first element there. So `vehicle.row_positions` is at 1000 and the quantities of the wheels are
//! from 2000 on. The time, which is a variable here alone, is at 400.

use super::{
    Attributes, Causality, Configuration, FIRST_ROW, Kind, Quantity, SCALARS, effects, find,
    variables,
};

/// Value reference of the time.
const TIME: u32 = 400;
const _: () = assert!(SCALARS.len() <= TIME as usize && TIME < effects::FIRST && TIME < FIRST_ROW);

static TIME_ATTRIBUTES: Attributes = Attributes {
    causality: Causality::Independent,
    kind: Kind::Real,
    unit: "s",
    start: None,
    min: None,
    max: None,
    nominal: None,
    description: "Simulated time",
};

/// Whether value references stand for scalars alone or for arrays as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Naming {
    /// Each row and wheel has variables of its own: [`super::variables()`].
    Scalars,
    /// Each quantity of rows and wheels is one variable: [`array_variables`].
    Arrays,
}

/// What a variable holds.
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

    /// What begins with a quantity; `None` for the rows and wheels after the first.
    fn beginning_with(quantity: Quantity, configuration: &Configuration) -> Option<Self> {
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
    /// What it holds.
    pub elements: Elements,
    /// What is declared of it, or of each of its elements.
    pub attributes: &'static Attributes,
}

/// The variables of the FMU of a configuration, the time first.
#[must_use]
pub fn array_variables(configuration: &Configuration) -> Vec<ArrayVariable> {
    let time = ArrayVariable {
        name: "time".to_owned(),
        reference: TIME,
        elements: Elements::One(Quantity::Time),
        attributes: &TIME_ATTRIBUTES,
    };
    let others = variables(configuration).into_iter().filter_map(|variable| {
        let elements = Elements::beginning_with(variable.quantity, configuration)?;
        Some(ArrayVariable {
            name: variable.name.replace("[1]", ""),
            reference: variable.reference,
            elements,
            attributes: variable.attributes,
        })
    });
    std::iter::once(time).chain(others).collect()
}

impl Naming {
    /// What a value reference stands for in the FMU of a configuration.
    #[inline]
    #[must_use]
    pub fn find(
        self,
        reference: u32,
        configuration: &Configuration,
    ) -> Option<(Elements, &'static Attributes)> {
        if self == Self::Arrays && reference == TIME {
            return Some((Elements::One(Quantity::Time), &TIME_ATTRIBUTES));
        }
        let (quantity, attributes) = find(reference, configuration)?;
        let elements = match self {
            Self::Scalars => Elements::One(quantity),
            Self::Arrays => Elements::beginning_with(quantity, configuration)?,
        };
        Some((elements, attributes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_reference_finds_its_variable_and_no_other_does() {
        for rows in [2, 3, 64] {
            let mut configuration = Configuration::default();
            configuration.vehicle.row_positions = vec![0.0; rows];
            let variables = array_variables(&configuration);
            for variable in &variables {
                let found = Naming::Arrays.find(variable.reference, &configuration);
                let expected = Some((variable.elements, variable.attributes));
                assert_eq!(found, expected, "{}", variable.name);
            }
            let references: HashSet<u32> = variables.iter().map(|v| v.reference).collect();
            assert_eq!(references.len(), variables.len());
            for reference in (0..10_000).chain([u32::MAX]) {
                assert_eq!(
                    Naming::Arrays.find(reference, &configuration).is_some(),
                    references.contains(&reference)
                );
            }
        }
    }

    #[test]
    fn the_arrays_hold_each_scalar_once_and_the_time() {
        let configuration = Configuration::default();
        let arrays = array_variables(&configuration);
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
