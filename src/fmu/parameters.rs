//! The values that an importer may set before the simulation starts.

use crate::declaration::{Configuration, Quantity};
use crate::parameter::ParameterError;
use crate::simulation::{State, WheelSpeeds};
use crate::vehicle::{Vehicle, VehicleModel};

/// The values from which a simulation is built.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Parameters {
    pub configuration: Configuration,
    pub initial: State,
    pub no_slip: bool,
}

impl Parameters {
    pub(super) fn new(configuration: Configuration) -> Self {
        Self {
            configuration,
            initial: State::default(),
            no_slip: false,
        }
    }

    /// The vehicle on its terrain, with its effects.
    pub(super) fn model(&self) -> Result<VehicleModel, ParameterError> {
        VehicleModel::from_specification(&self.configuration.specification())
    }

    /// The state at the start for initial values and wheel speeds. The function is linear in both, so
    /// that it also gives the change of the start from their changes.
    pub(super) fn start(&self, initial: State, speeds: WheelSpeeds) -> State {
        let Vehicle {
            wheel_radius,
            half_track,
            ..
        } = self.configuration.vehicle;
        if self.no_slip {
            initial.rolling_without_slip(speeds, wheel_radius, half_track)
        } else {
            initial
        }
    }

    /// The value of a parameter of type Real.
    pub(super) fn real(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Initial(index) => Some(self.initial.to_array()[index]),
            other => self.configuration.parameter(other),
        }
    }

    /// Sets a parameter of type Real. False if the quantity is none.
    pub(super) fn set_real(&mut self, quantity: Quantity, value: f64) -> bool {
        match quantity {
            Quantity::Initial(index) => {
                let mut initial = self.initial.to_array();
                initial[index] = value;
                self.initial = State::from_array(initial);
                true
            }
            other => self.configuration.set_parameter(other, value),
        }
    }

    /// Visits every number, for a saved state.
    pub(super) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        self.configuration.visit(visit);
        let mut initial = self.initial.to_array();
        initial.iter_mut().for_each(&mut *visit);
        self.initial = State::from_array(initial);
        let mut no_slip = f64::from(u8::from(self.no_slip));
        visit(&mut no_slip);
        self.no_slip = no_slip != 0.0;
    }
}
