//! Reading and setting variables.

use super::calls::Mode;
use super::instance::{Core, Failure, Instance, Outcome, broken, refuse};
use super::status::Status;
use crate::declaration::{
    self, ArrayVariable, Attributes, Causality, Configuration, DependencyKind, Elements, Kind,
    Naming, Quantity,
};
use crate::simulation::State;

/// Refuses references to variables of a type that does not occur. An empty list succeeds.
pub(super) fn none_of(kind: &str, references: &[u32]) -> Outcome {
    match references.first() {
        Some(reference) => refuse(format!(
            "value reference {reference} is no {kind}; no variable is of that type"
        )),
        None => Ok(()),
    }
}

/// There are no event indicators. Reading none of them succeeds.
pub(super) fn no_event_indicators(count: usize) -> Outcome {
    match count {
        0 => Ok(()),
        _ => refuse("there are no event indicators"),
    }
}

/// Before the initialization only variables with a start value can be read.
fn check_start(reference: u32, attributes: &Attributes) -> Outcome {
    match attributes.causality {
        Causality::Input | Causality::Parameter => Ok(()),
        _ => refuse(format!(
            "the variable with value reference {reference} has no value before the initialization"
        )),
    }
}

impl Instance {
    /// The variable behind a reference, which must be of the given type.
    pub(super) fn find(
        &self,
        reference: u32,
        kind: Kind,
    ) -> Outcome<(Elements, &'static Attributes)> {
        let variables = &self.variables;
        let Ok(index) = variables.binary_search_by_key(&reference, |v| v.reference) else {
            return refuse(format!(
                "there is no variable with value reference {reference}"
            ));
        };
        let found = &variables[index];
        let actual = found.attributes.kind;
        if actual != kind {
            return refuse(format!(
                "value reference {reference} is of type {actual:?}, not {kind:?}"
            ));
        }
        Ok((found.elements, found.attributes))
    }

    /// Refuses a number of values other than that of the variables together.
    pub(super) fn check_count(&self, references: &[u32], kind: Kind, given: usize) -> Outcome {
        if self.purpose.naming == Naming::Scalars && references.len() == given {
            return Ok(());
        }
        let mut count = 0;
        for reference in references {
            count += self.find(*reference, kind)?.0.count();
        }
        if count == given {
            return Ok(());
        }
        refuse(format!("the variables have {count} values, not {given}"))
    }

    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Outcome {
        self.check_count(references, Kind::Real, values.len())?;
        let early = self.core.mode == Mode::Instantiated;
        let mut places = values.iter_mut();
        for reference in references {
            let (elements, attributes) = self.find(*reference, Kind::Real)?;
            if early {
                check_start(*reference, attributes)?;
            }
            for (quantity, place) in elements.quantities().zip(&mut places) {
                *place = self.core.real(quantity)?;
            }
        }
        Ok(())
    }

    pub(super) fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Outcome {
        self.check_count(references, Kind::Real, values.len())?;
        // All are checked first, so that a refused call changes nothing.
        let mut given = values.iter();
        for reference in references {
            let (elements, attributes) = self.find(*reference, Kind::Real)?;
            if attributes.causality != Causality::Input && !self.is_free_state(elements) {
                self.check_settable(*reference, attributes)?;
            }
            for (quantity, value) in elements.quantities().zip(&mut given) {
                if !value.is_finite() {
                    return refuse(format!(
                        "value reference {reference} cannot be set to {value}"
                    ));
                }
                Configuration::check_parameter(quantity, *value)
                    .map_err(|e| Failure::Refused(e.to_string()))?;
            }
        }
        let mut given = values.iter();
        for reference in references {
            let (elements, _) = self.find(*reference, Kind::Real)?;
            for (quantity, value) in elements.quantities().zip(&mut given) {
                self.core.set_real(quantity, *value)?;
            }
        }
        Ok(())
    }

    /// Reads the number of the terrain, the only enumeration.
    pub(super) fn get_enumerations<T: From<u8>>(
        &self,
        references: &[u32],
        values: &mut [T],
    ) -> Outcome {
        self.check_all(references, Kind::Enumeration, values.len())?;
        let number = self.core.parameters.configuration.selected as u8 + 1;
        values.fill_with(|| number.into());
        Ok(())
    }

    pub(super) fn set_enumerations<T: Copy + Into<i64>>(
        &mut self,
        references: &[u32],
        values: &[T],
    ) -> Outcome {
        self.check_all_settable(references, Kind::Enumeration, values.len())?;
        let numbers = values.iter().map(|value| (*value).into());
        if let Some(number) = numbers.clone().find(|number| !(1..=5).contains(number)) {
            return refuse(format!("terrain {number} is not one of 1 to 5"));
        }
        if let Some(number) = numbers.last() {
            self.core.parameters.configuration.selected = number as usize - 1;
            self.core.simulation = None;
        }
        Ok(())
    }

    /// Reads whether the start is without slip, the only Boolean.
    pub(super) fn get_booleans<T: From<bool>>(
        &self,
        references: &[u32],
        values: &mut [T],
    ) -> Outcome {
        self.check_all(references, Kind::Boolean, values.len())?;
        values.fill_with(|| self.core.parameters.no_slip.into());
        Ok(())
    }

    pub(super) fn set_booleans<T: Copy>(
        &mut self,
        references: &[u32],
        values: &[T],
        is_true: impl Fn(T) -> bool,
    ) -> Outcome {
        self.check_all_settable(references, Kind::Boolean, values.len())?;
        if let Some(value) = values.last() {
            self.core.parameters.no_slip = is_true(*value);
            self.core.simulation = None;
        }
        Ok(())
    }

    /// Refuses references to variables of another type, and another number of values than variables.
    fn check_all(&self, references: &[u32], kind: Kind, given: usize) -> Outcome {
        self.check_count(references, kind, given)?;
        references
            .iter()
            .try_for_each(|reference| self.find(*reference, kind).map(drop))
    }

    /// The same for variables to be set.
    fn check_all_settable(&self, references: &[u32], kind: Kind, given: usize) -> Outcome {
        self.check_count(references, kind, given)?;
        references.iter().try_for_each(|reference| {
            let (_, attributes) = self.find(*reference, kind)?;
            self.check_settable(*reference, attributes)
        })
    }

    /// The references on which an output or a state derivative depends, and how: before the end of the
    /// initialization on start values.
    pub(super) fn dependencies(&self, reference: u32) -> Outcome<(Vec<u32>, DependencyKind)> {
        let (elements, _) = self.find(reference, Kind::Real)?;
        let configuration = self.configuration();
        let (quantities, kind) = declaration::dependencies(elements.at(0), configuration);
        if quantities.is_empty() {
            return refuse(format!(
                "value reference {reference} is neither an output nor a state derivative"
            ));
        }
        if self.core.mode.is_early() {
            let known =
                declaration::initial_dependencies(elements.at(0), configuration).into_iter();
            return Ok((
                known.map(|v| v.reference).collect(),
                DependencyKind::Dependent,
            ));
        }
        let of = |quantity: &Quantity| {
            let is_it = |v: &&ArrayVariable| v.elements == Elements::One(*quantity);
            self.variables.iter().find(is_it).map(|v| v.reference)
        };
        Ok((quantities.iter().filter_map(of).collect(), kind))
    }

    /// In model exchange some importers set the states one by one as variables.
    fn is_free_state(&self, elements: Elements) -> bool {
        matches!(elements, Elements::One(Quantity::State(_))) && self.core.mode.has_solver()
    }

    /// Inputs can be set at any time, parameters until the end of the initialization.
    fn check_settable(&self, reference: u32, attributes: &Attributes) -> Outcome {
        match attributes.causality {
            Causality::Input => Ok(()),
            Causality::Parameter if self.core.mode.is_early() => Ok(()),
            Causality::Parameter => refuse(format!(
                "the parameter with value reference {reference} can only be set before the end of the initialization"
            )),
            Causality::Output | Causality::Local | Causality::Independent => refuse(format!(
                "the variable with value reference {reference} is computed and cannot be set"
            )),
        }
    }

    pub(super) fn set_input_rates(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Outcome {
        let mut rates = self.core.rates;
        for ((reference, order), value) in references.iter().zip(orders).zip(values) {
            let (elements, _) = self.find(*reference, Kind::Real)?;
            if *order != 1 && (*order < 1 || self.purpose.naming == Naming::Arrays) {
                return refuse(format!("input derivatives are of order 1, not {order}"));
            }
            if !value.is_finite() {
                return refuse(format!("an input derivative cannot be {value}"));
            }
            if *order > 1 {
                // FMI 2.0 has no attribute for the highest order that an FMU supports.
                if *value != 0.0 {
                    self.logger.report(Status::Warning, &format!(
                        "the input derivative of order {order} is ignored: wheel speeds are linear within a step"
                    ));
                }
                continue;
            }
            match elements {
                Elements::One(Quantity::Input(side)) => *side.of(&mut rates) = *value,
                _ => return refuse(format!("value reference {reference} is no input")),
            }
        }
        self.core.rates = rates;
        Ok(())
    }
}

fn no_real() -> Failure {
    Failure::Refused("that variable is no Real".to_owned())
}

impl Core {
    pub(super) fn real(&mut self, quantity: Quantity) -> Outcome<f64> {
        Ok(match quantity {
            Quantity::Input(side) => *side.of(&mut self.speeds),
            Quantity::State(index) => self.simulation()?.state().to_array()[index],
            Quantity::Rate(index) => self.simulation()?.derivative().map_err(broken)?[index],
            Quantity::Total(_) | Quantity::Wheel(..) => {
                let wrench = self.simulation()?.wrench().map_err(broken)?;
                quantity.in_wrench(wrench).ok_or_else(no_real)?
            }
            Quantity::Time => self.time,
            parameter => self.parameters.real(parameter).ok_or_else(no_real)?,
        })
    }

    pub(super) fn set_real(&mut self, quantity: Quantity, value: f64) -> Outcome {
        if let Quantity::Input(side) = quantity {
            *side.of(&mut self.speeds) = value;
            return self.pass_on_speeds();
        }
        if let Quantity::State(index) = quantity {
            let simulation = self.simulation()?;
            let mut states = simulation.state().to_array();
            states[index] = value;
            return simulation
                .set_state(State::from_array(states))
                .map_err(|e| Failure::Refused(e.to_string()));
        }
        if self.parameters.set_real(quantity, value) {
            self.simulation = None;
            return Ok(());
        }
        refuse("that variable cannot be set")
    }

    fn pass_on_speeds(&mut self) -> Outcome {
        if self.mode.is_early() && self.parameters.no_slip {
            // The initial velocities follow from the wheel speeds.
            self.simulation = None;
        }
        match &mut self.simulation {
            Some(simulation) => simulation
                .set_wheel_speeds(self.speeds)
                .map_err(|e| Failure::Refused(e.to_string())),
            None => Ok(()),
        }
    }
}
