//! Reading and setting variables.

use super::calls::Mode;
use super::instance::{Core, Failure, Instance, Outcome, broken, refuse};
use crate::declaration::{
    self, ArrayVariable, Attributes, Causality, Configuration, DependencyKind, Elements, Kind,
    Naming, Quantity,
};
use crate::simulation::State;
use crate::vehicle::{WheelOutputs, Wrench};

/// Refuses references to variables of a type that does not occur. An empty list succeeds.
pub(super) fn none_of(kind: &str, references: &[u32]) -> Outcome {
    match references.first() {
        Some(reference) => refuse(format!(
            "value reference {reference} is no {kind}; there are none"
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

/// Before the initialization there is nothing but what a variable starts with.
fn check_start(reference: u32, attributes: &Attributes) -> Outcome {
    match attributes.causality {
        Causality::Input | Causality::Parameter => Ok(()),
        _ => refuse(format!(
            "the variable with value reference {reference} has no value before the initialization"
        )),
    }
}

impl Instance {
    /// What is behind a reference, which must be of the given type.
    pub(super) fn find(
        &self,
        reference: u32,
        kind: Kind,
    ) -> Outcome<(Elements, &'static Attributes)> {
        match self.naming.find(reference, self.configuration()) {
            Some((elements, attributes)) if attributes.kind == kind => Ok((elements, attributes)),
            Some((_, attributes)) => refuse(format!(
                "value reference {reference} is of type {:?}, not {kind:?}",
                attributes.kind
            )),
            None => refuse(format!(
                "there is no variable with value reference {reference}"
            )),
        }
    }

    /// Refuses a number of values that is not the one that the variables have together.
    pub(super) fn check_count(&self, references: &[u32], kind: Kind, given: usize) -> Outcome {
        if self.naming == Naming::Scalars && references.len() == given {
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
        // First check them all, so that a refused call has changed nothing.
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

    /// Reads the terrain's number, the only enumeration.
    pub(super) fn get_enumerations<T: From<u8>>(
        &self,
        references: &[u32],
        values: &mut [T],
    ) -> Outcome {
        self.check_count(references, Kind::Enumeration, values.len())?;
        for reference in references {
            self.find(*reference, Kind::Enumeration)?;
        }
        let number = self.core.parameters.configuration.selected as u8 + 1;
        values.fill_with(|| number.into());
        Ok(())
    }

    pub(super) fn set_enumerations<T: Copy + Into<i64>>(
        &mut self,
        references: &[u32],
        values: &[T],
    ) -> Outcome {
        self.check_count(references, Kind::Enumeration, values.len())?;
        for (reference, value) in references.iter().zip(values) {
            let (_, attributes) = self.find(*reference, Kind::Enumeration)?;
            self.check_settable(*reference, attributes)?;
            let value: i64 = (*value).into();
            if !(1..=5).contains(&value) {
                return refuse(format!("terrain {value} is not one of 1 to 5"));
            }
        }
        if let Some(value) = values.last() {
            let value: i64 = (*value).into();
            self.core.parameters.configuration.selected = value as usize - 1;
            self.core.simulation = None;
        }
        Ok(())
    }

    /// Reads whether to start without slip, the only Boolean.
    pub(super) fn get_booleans<T: From<bool>>(
        &self,
        references: &[u32],
        values: &mut [T],
    ) -> Outcome {
        self.check_count(references, Kind::Boolean, values.len())?;
        for reference in references {
            self.find(*reference, Kind::Boolean)?;
        }
        values.fill_with(|| self.core.parameters.no_slip.into());
        Ok(())
    }

    /// Sets it to the last of the values.
    pub(super) fn set_booleans<T: Copy>(
        &mut self,
        references: &[u32],
        values: &[T],
        is_true: impl Fn(T) -> bool,
    ) -> Outcome {
        self.check_count(references, Kind::Boolean, values.len())?;
        for reference in references {
            let (_, attributes) = self.find(*reference, Kind::Boolean)?;
            self.check_settable(*reference, attributes)?;
        }
        if let Some(value) = values.last() {
            self.core.parameters.no_slip = is_true(*value);
            self.core.simulation = None;
        }
        Ok(())
    }

    /// References of what an output or a state derivative depends on, and how: until the initialization
    /// ends, on what it starts from.
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
        let variables = declaration::array_variables(configuration);
        let of = |quantity: &Quantity| {
            let held = |v: &&ArrayVariable| v.elements == Elements::One(*quantity);
            variables.iter().find(held).map(|v| v.reference)
        };
        Ok((quantities.iter().filter_map(of).collect(), kind))
    }

    /// In model exchange the states are the importer's, and some set them one by one.
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
            if *order != 1 && (*order < 1 || self.naming == Naming::Arrays) {
                return refuse(format!("input derivatives are of order 1, not {order}"));
            }
            if !value.is_finite() {
                return refuse(format!("an input derivative cannot be {value}"));
            }
            if *order > 1 {
                // To FMI 2.0 the order that is known cannot be told beforehand.
                if *value != 0.0 {
                    self.logger.warning(&format!(
                        "the input derivative of order {order} is left out: wheel speeds are linear within a step"
                    ));
                }
                continue;
            }
            match elements {
                Elements::One(Quantity::Input(0)) => rates.left = *value,
                Elements::One(Quantity::Input(_)) => rates.right = *value,
                _ => return refuse(format!("value reference {reference} is no input")),
            }
        }
        self.core.rates = rates;
        Ok(())
    }
}

impl Core {
    pub(super) fn real(&mut self, quantity: Quantity) -> Outcome<f64> {
        Ok(match quantity {
            Quantity::Input(0) => self.speeds.left,
            Quantity::Input(_) => self.speeds.right,
            Quantity::State(index) => self.simulation()?.state().to_array()[index],
            Quantity::Rate(index) => self.simulation()?.derivative().map_err(broken)?[index],
            Quantity::Total(index) => total(self.simulation()?.wrench().map_err(broken)?, index),
            Quantity::Wheel(wheel, field) => wheel_field(
                &self.simulation()?.wrench().map_err(broken)?.wheels[wheel],
                field,
            ),
            Quantity::Time => self.time,
            parameter => match self.parameters.real(parameter) {
                Some(value) => value,
                None => return refuse("that variable is no Real"),
            },
        })
    }

    pub(super) fn set_real(&mut self, quantity: Quantity, value: f64) -> Outcome {
        if let Quantity::Input(side) = quantity {
            if side == 0 {
                self.speeds.left = value;
            } else {
                self.speeds.right = value;
            }
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

/// A total of the wrench by its number in [`Quantity::Total`].
pub(super) fn total(wrench: &Wrench, index: usize) -> f64 {
    match index {
        0 => wrench.a_x,
        1 => wrench.a_y,
        2 => wrench.rolling_resistance,
        3 => wrench.turning_resistance_moment,
        _ => wrench.turning_moment,
    }
}

/// A wheel's output by its number in [`Quantity::Wheel`].
pub(super) fn wheel_field(wheel: &WheelOutputs, field: usize) -> f64 {
    match field {
        0 => wheel.longitudinal_slip,
        1 => wheel.lateral_slip,
        2 => wheel.load,
        3 => wheel.sinkage,
        4 => wheel.entry_angle,
        5 => wheel.force_x,
        _ => wheel.force_y,
    }
}
