//! The parameters of vehicle, custom soil and effects, by the quantities of the FMU.

use super::configuration::{CUSTOM, Configuration};
use super::variable::Quantity;
use crate::parameter::ParameterError;
#[cfg(feature = "fmu")]
use {super::table, crate::effects::ParameterName};

/// The unit of the friction angle, which is kept in radians.
const DEGREES: &str = "deg";

impl Configuration {
    /// The value of a parameter of the vehicle, the custom soil (the friction angle in
    /// degrees) or an effect; `None` for any other quantity.
    #[must_use]
    pub fn parameter(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Effect(parameter) => Some(self.effects.get(parameter)),
            Quantity::Row(index) => self.vehicle.row_positions.get(index).copied(),
            other => other.parameter().map(|row| match row.attributes.unit {
                DEGREES => self.terrains[CUSTOM].friction_angle_degrees(),
                _ => (row.value.get)(self),
            }),
        }
    }

    /// Refuses the value of an effect's parameter outside its range. The parameters of vehicle and
    /// soil are checked together when a model is made.
    ///
    /// # Errors
    /// A value that is not finite or out of range.
    pub fn check_parameter(quantity: Quantity, value: f64) -> Result<(), ParameterError> {
        match quantity {
            Quantity::Effect(parameter) => {
                let (effect, declared) = parameter.declaration();
                declared.check(effect.name, value)
            }
            _ => Ok(()),
        }
    }

    /// Sets such a parameter to a value that [`Configuration::check_parameter`] accepts. False if the
    /// quantity is no such parameter or the value is refused.
    pub fn set_parameter(&mut self, quantity: Quantity, value: f64) -> bool {
        match quantity {
            Quantity::Effect(parameter) => self.effects.set(parameter, value).is_ok(),
            Quantity::Row(index) => {
                let position = self.vehicle.row_positions.get_mut(index);
                position.map(|position| *position = value).is_some()
            }
            other => {
                let row = other.parameter();
                let set = row.map(|row| match row.attributes.unit {
                    DEGREES => (row.value.set)(self, value.to_radians()),
                    _ => (row.value.set)(self, value),
                });
                set.is_some()
            }
        }
    }

    /// Visits every number that can be set.
    #[cfg(feature = "fmu")]
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        let mut selected = self.selected as f64;
        visit(&mut selected);
        self.selected = (selected as usize).min(CUSTOM);
        for parameter in ParameterName::all() {
            let mut value = self.effects.get(parameter);
            visit(&mut value);
            self.set_parameter(Quantity::Effect(parameter), value);
        }
        for row in table::SOIL.iter().chain(&table::VEHICLE) {
            let mut value = (row.value.get)(self);
            visit(&mut value);
            (row.value.set)(self, value);
        }
        self.vehicle.row_positions.iter_mut().for_each(visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ParameterName;

    #[test]
    fn parameters_are_read_back_as_they_were_set() {
        let mut configuration = Configuration::default();
        for quantity in [
            Quantity::Soil(1),
            Quantity::Soil(4),
            Quantity::Vehicle(6),
            Quantity::Row(3),
        ] {
            assert!(configuration.set_parameter(quantity, 29.3));
            assert_eq!(configuration.parameter(quantity), Some(29.3));
        }
        let payload = ParameterName::find("payload.mass")
            .map(Quantity::Effect)
            .unwrap();
        assert!(configuration.set_parameter(payload, 29.3));
        assert_eq!(configuration.parameter(payload), Some(29.3));
        assert!(!configuration.set_parameter(payload, -1.0));
        assert!(Configuration::check_parameter(payload, -1.0).is_err());
        assert!(!configuration.set_parameter(Quantity::Row(4), 1.0));
        assert_eq!(configuration.parameter(Quantity::Rate(0)), None);
    }
}
