//! One instance of the FMU, without any C: modes, values, steps.

use super::calls::Mode;
use super::logger::Logger;
use super::parameters::Parameters;
use crate::declaration::{self, Attributes, Causality, Configuration, Kind, Quantity};
use crate::simulation::{Simulation, State, WheelSpeeds};
use crate::vehicle::{WheelOutputs, Wrench};

/// Why a call cannot be fulfilled.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Failure {
    /// The call was wrong; the instance stands where it stood.
    Refused(String),
    /// The computation failed; the instance has to be reset.
    Broken(String),
    /// What was asked for does not exist.
    Unavailable(String),
}

pub(super) type Outcome<T = ()> = Result<T, Failure>;

/// Shorthand for a refusal.
pub(super) fn refuse<T>(message: impl Into<String>) -> Outcome<T> {
    Err(Failure::Refused(message.into()))
}

/// Which interface the instance serves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Interface {
    ModelExchange,
    CoSimulation,
}

pub(super) struct Instance {
    pub logger: Logger,
    pub interface: Interface,
    /// What the FMU's resources say: where a reset returns to.
    configuration: Configuration,
    pub core: Core,
}

/// Everything that a saved state holds.
#[derive(Debug, Clone)]
pub(super) struct Core {
    pub mode: Mode,
    pub parameters: Parameters,
    pub speeds: WheelSpeeds,
    /// Rates of the wheel speeds in the next step.
    pub rates: WheelSpeeds,
    pub time: f64,
    /// Infinite where none is defined.
    pub stop_time: f64,
    /// Whether a lifted wheel has been reported.
    pub lift_reported: bool,
    /// Built from the parameters when first needed; none while they may still change.
    pub simulation: Option<Simulation>,
}

/// Communication points may be off by rounding: by this share of the step and of the time.
const TIME_ROUNDING: f64 = 1e-6;
const TIME_RESOLUTION: f64 = 1e-12;

impl Instance {
    pub(super) fn new(logger: Logger, interface: Interface, configuration: Configuration) -> Self {
        let core = Core::new(configuration.clone());
        Self {
            logger,
            interface,
            configuration,
            core,
        }
    }

    pub(super) fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    pub(super) fn reset(&mut self) {
        self.core = Core::new(self.configuration.clone());
    }

    pub(super) fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Outcome {
        if !start.is_finite() {
            return refuse(format!("start time {start} is not finite"));
        }
        let stop = stop.unwrap_or(f64::INFINITY);
        if stop.is_nan() || stop < start {
            return refuse(format!("stop time {stop} is not after start time {start}"));
        }
        self.core.time = start;
        self.core.stop_time = stop;
        // Built at another time, if it is built already.
        self.core.simulation = None;
        Ok(())
    }

    pub(super) fn exit_initialization(&mut self) -> Outcome {
        let time = self.core.time;
        let simulation = self.core.simulation()?;
        simulation.set_time(time);
        simulation
            .wrench()
            .map_err(|e| Failure::Broken(e.to_string()))?;
        self.core.mode = match self.interface {
            Interface::CoSimulation => Mode::StepComplete,
            Interface::ModelExchange => Mode::Event,
        };
        self.report_lift();
        Ok(())
    }

    /// The variable behind a reference, which must be of the given type.
    pub(super) fn find(
        &self,
        reference: u32,
        kind: Kind,
    ) -> Outcome<(Quantity, &'static Attributes)> {
        match declaration::find(reference, &self.configuration) {
            Some((quantity, attributes)) if attributes.kind == kind => Ok((quantity, attributes)),
            Some((_, attributes)) => refuse(format!(
                "value reference {reference} is of type {:?}, not {kind:?}",
                attributes.kind
            )),
            None => refuse(format!(
                "there is no variable with value reference {reference}"
            )),
        }
    }

    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Outcome {
        for (reference, value) in references.iter().zip(values) {
            let (quantity, _) = self.find(*reference, Kind::Real)?;
            *value = self.core.real(quantity)?;
        }
        Ok(())
    }

    pub(super) fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Outcome {
        // First check them all, so that a refused call has changed nothing.
        for (reference, value) in references.iter().zip(values) {
            let (quantity, attributes) = self.find(*reference, Kind::Real)?;
            if !self.is_free_state(quantity) {
                self.check_settable(*reference, attributes)?;
            }
            if !value.is_finite() {
                return refuse(format!(
                    "value reference {reference} cannot be set to {value}"
                ));
            }
            Configuration::check_parameter(quantity, *value)
                .map_err(|e| Failure::Refused(e.to_string()))?;
        }
        for (reference, value) in references.iter().zip(values) {
            let (quantity, _) = self.find(*reference, Kind::Real)?;
            self.core.set_real(quantity, *value)?;
        }
        Ok(())
    }

    /// In model exchange the states are the importer's, and some set them one by one.
    fn is_free_state(&self, quantity: Quantity) -> bool {
        matches!(quantity, Quantity::State(_))
            && matches!(self.core.mode, Mode::Event | Mode::ContinuousTime)
    }

    /// Inputs can be set at any time, parameters until the end of the initialization.
    pub(super) fn check_settable(&self, reference: u32, attributes: &Attributes) -> Outcome {
        let early = matches!(self.core.mode, Mode::Instantiated | Mode::Initialization);
        match attributes.causality {
            Causality::Input => Ok(()),
            Causality::Parameter if early => Ok(()),
            Causality::Parameter => refuse(format!(
                "the parameter with value reference {reference} can only be set before the end of the initialization"
            )),
            Causality::Output | Causality::Local => refuse(format!(
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
            let (quantity, _) = self.find(*reference, Kind::Real)?;
            if *order != 1 {
                return refuse(format!("input derivatives are of order 1, not {order}"));
            }
            if !value.is_finite() {
                return refuse(format!("an input derivative cannot be {value}"));
            }
            match quantity {
                Quantity::Input(0) => rates.left = *value,
                Quantity::Input(_) => rates.right = *value,
                _ => return refuse(format!("value reference {reference} is no input")),
            }
        }
        self.core.rates = rates;
        Ok(())
    }

    /// One communication step. Input derivatives serve for this step alone.
    pub(super) fn step(&mut self, point: f64, size: f64) -> Outcome {
        let core = &mut self.core;
        if !(size.is_finite() && size > 0.0) {
            return refuse(format!("a communication step of {size} s is not positive"));
        }
        let rounding = TIME_ROUNDING * size + TIME_RESOLUTION * core.time.abs();
        let on_time = (point - core.time).abs() <= rounding;
        if !on_time {
            let time = core.time;
            return refuse(format!(
                "communication point {point} s is not the current time {time} s"
            ));
        }
        let (end, stop) = (point + size, core.stop_time);
        if end > stop + rounding {
            return refuse(format!("a step to {end} s passes the stop time {stop} s"));
        }
        let rates = std::mem::take(&mut core.rates);
        let simulation = core.simulation()?;
        simulation.set_time(point);
        let stepped = simulation
            .set_wheel_accelerations(rates)
            .and_then(|()| simulation.step(size));
        let (reached, speeds) = (simulation.time(), simulation.wheel_speeds());
        core.speeds = speeds;
        if let Err(error) = stepped {
            core.time = reached;
            return Err(Failure::Broken(error.to_string()));
        }
        core.time = end;
        self.report_lift();
        Ok(())
    }

    fn report_lift(&mut self) {
        if self.core.lift_reported {
            return;
        }
        let time = self.core.time;
        let lifted = self.core.simulation().map(Simulation::wheel_lifted);
        if let Ok(Ok(true)) = lifted {
            self.core.lift_reported = true;
            self.logger.warning(&format!(
                "at {time} s a wheel lifts off the ground; the loads of the others are scaled to carry the weight"
            ));
        }
    }

    pub(super) fn set_states(&mut self, states: &[f64]) -> Outcome {
        let Ok(array) = <[f64; State::COUNT]>::try_from(states) else {
            return refuse(format!(
                "there are {} continuous states, not {}",
                State::COUNT,
                states.len()
            ));
        };
        let simulation = self.core.simulation()?;
        simulation
            .set_state(State::from_array(array))
            .map_err(|e| Failure::Refused(e.to_string()))
    }
}

impl Core {
    fn new(configuration: Configuration) -> Self {
        Self {
            mode: Mode::Instantiated,
            parameters: Parameters::new(configuration),
            speeds: WheelSpeeds::default(),
            rates: WheelSpeeds::default(),
            time: 0.0,
            stop_time: f64::INFINITY,
            lift_reported: false,
            simulation: None,
        }
    }

    /// The simulation, built from the parameters if there is none yet.
    pub(super) fn simulation(&mut self) -> Outcome<&mut Simulation> {
        if self.simulation.is_none() {
            let model = self
                .parameters
                .model()
                .map_err(|e| Failure::Broken(e.to_string()))?;
            let mut simulation = Simulation::new(model);
            simulation.set_time(self.time);
            let state = self.parameters.initial_state(self.speeds);
            simulation
                .set_state(state)
                .and_then(|()| simulation.set_wheel_speeds(self.speeds))
                .map_err(|e| Failure::Broken(e.to_string()))?;
            self.simulation = Some(simulation);
        }
        match &mut self.simulation {
            Some(simulation) => Ok(simulation),
            None => Err(Failure::Broken("there is no simulation".to_owned())),
        }
    }

    pub(super) fn real(&mut self, quantity: Quantity) -> Outcome<f64> {
        let broken = |e: crate::simulation::SimulationError| Failure::Broken(e.to_string());
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
        let early = matches!(self.mode, Mode::Instantiated | Mode::Initialization);
        if early && self.parameters.no_slip {
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
