//! One instance of the FMU, without any C: modes, values, steps.

use super::calls::{Interface, Mode};
use super::logger::Logger;
use super::parameters::Parameters;
use super::status::Status;
use crate::declaration::{ArrayVariable, Configuration, Naming, state_nominals};
use crate::simulation::{LONGEST_CALL, Simulation, SimulationError, State, WheelSpeeds};

/// Why a call fails.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Failure {
    /// The call was wrong. The instance is unchanged.
    Refused(String),
    /// The computation failed. The instance must be reset, unless a solver may try again.
    Broken(String),
    /// The requested value does not exist.
    Unavailable(String),
}

pub(super) type Outcome<T = ()> = Result<T, Failure>;

/// Shorthand for a refusal.
pub(super) fn refuse<T>(message: impl Into<String>) -> Outcome<T> {
    Err(Failure::Refused(message.into()))
}

/// The use of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Purpose {
    pub interface: Interface,
    /// Whether its value references stand for scalars or arrays.
    pub naming: Naming,
    /// Whether the importer uses the event mode of co-simulation.
    pub has_events: bool,
}

pub(super) struct Instance {
    pub logger: Logger,
    pub purpose: Purpose,
    /// From the FMU's resources. A reset returns to it.
    configuration: Configuration,
    /// The variables, by rising value reference.
    pub variables: Vec<ArrayVariable>,
    pub core: Core,
}

/// The state of an instance that can be saved.
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
    /// The next event when continuous-time mode was entered; infinite where there is none.
    pub due: f64,
    /// Whether a lifted wheel has been reported.
    pub lift_reported: bool,
    /// Built from the parameters when first needed; `None` again when a parameter changes.
    pub simulation: Option<Simulation>,
}

/// Communication points may be off by rounding: by this share of the step, up to so much \[s\].
const TIME_ROUNDING: f64 = 1e-6;
const MAX_ROUNDING: f64 = 1e-6;
/// And by this share of the time: an importer adds or multiplies its steps in double precision.
const TIME_RESOLUTION: f64 = 16.0 * f64::EPSILON;
/// Up to this time \[s\], some 272 years, neighbouring numbers are no more than `MAX_ROUNDING` apart.
const MAX_TIME: f64 = (1_u64 << 33) as f64;

impl Instance {
    pub(super) fn new(logger: Logger, purpose: Purpose, configuration: Configuration) -> Self {
        let mut variables = purpose.naming.variables(&configuration);
        variables.sort_by_key(|variable| variable.reference);
        Self {
            logger,
            purpose,
            variables,
            core: Core::new(configuration.clone()),
            configuration,
        }
    }

    pub(super) fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    pub(super) fn reset(&mut self) -> Outcome {
        self.core = Core::new(self.configuration.clone());
        Ok(())
    }

    pub(super) fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Outcome {
        check_time("start time", start)?;
        let stop = stop.unwrap_or(f64::INFINITY);
        if stop.is_nan() || stop < start {
            return refuse(format!("stop time {stop} is not after start time {start}"));
        }
        self.core.time = start;
        self.core.stop_time = stop;
        // If it exists, it was built at another time.
        self.core.simulation = None;
        Ok(())
    }

    pub(super) fn enter_initialization(&mut self) -> Outcome {
        self.core.mode = Mode::Initialization;
        Ok(())
    }

    pub(super) fn exit_initialization(&mut self) -> Outcome {
        let time = self.core.time;
        let simulation = self.core.simulation()?;
        simulation.set_time(time).map_err(broken)?;
        simulation.wrench().map_err(broken)?;
        self.core.mode = match self.purpose.interface {
            Interface::CoSimulation if self.purpose.has_events => Mode::StepEvent,
            Interface::CoSimulation => Mode::StepComplete,
            Interface::ModelExchange => Mode::Event,
        };
        self.report_lift();
        Ok(())
    }

    /// Enters event mode; in co-simulation only where the importer uses it.
    pub(super) fn enter_event_mode(&mut self) -> Outcome {
        self.core.mode = match self.purpose.interface {
            Interface::CoSimulation if self.purpose.has_events => Mode::StepEvent,
            Interface::CoSimulation => {
                return refuse("this instance was made for a co-simulation without event mode");
            }
            Interface::ModelExchange => Mode::Event,
        };
        self.core.pass_on_time()
    }

    pub(super) fn enter_continuous_time_mode(&mut self) -> Outcome {
        self.core.due = self.next_event()?.unwrap_or(f64::INFINITY);
        self.core.mode = Mode::ContinuousTime;
        self.core.pass_on_time()
    }

    pub(super) fn enter_step_mode(&mut self) -> Outcome {
        self.core.mode = Mode::StepComplete;
        Ok(())
    }

    /// The next time at which an effect's window opens or closes, where the importer has to stop. In
    /// co-simulation the steps handle it.
    pub(super) fn next_event(&mut self) -> Outcome<Option<f64>> {
        let time = self.core.time;
        let next = self.core.simulation()?.model().next_event(time);
        Ok(next.filter(|_| self.purpose.interface == Interface::ModelExchange))
    }

    pub(super) fn terminate(&mut self) -> Outcome {
        self.core.mode = Mode::Terminated;
        let cost = self.core.simulation()?.counters();
        self.logger
            .report(Status::Ok, &format!("integration: {cost:?}"));
        Ok(())
    }

    pub(super) fn set_time(&mut self, time: f64) -> Outcome {
        check_time("time", time)?;
        self.core.time = time;
        self.core.pass_on_time()
    }

    /// One communication step. Input derivatives act during this step only.
    pub(super) fn step(&mut self, point: f64, size: f64) -> Outcome {
        let core = &mut self.core;
        if !(size.is_finite() && size > 0.0) {
            return refuse(format!("a communication step of {size} s is not positive"));
        }
        if size > LONGEST_CALL {
            return refuse(format!(
                "a communication step of {size} s is longer than {LONGEST_CALL} s"
            ));
        }
        let resolution = TIME_RESOLUTION * core.time.abs();
        if size < 2.0 * resolution {
            return refuse(format!(
                "a communication step of {size} s is too short at {} s, where double precision resolves steps from {} s on",
                core.time,
                2.0 * resolution
            ));
        }
        let rounding = (TIME_ROUNDING * size).min(MAX_ROUNDING) + resolution;
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
        check_time("the end of the step", end)?;
        let rates = std::mem::take(&mut core.rates);
        let simulation = core.simulation()?;
        let stepped = simulation
            .set_time(point)
            .and_then(|()| simulation.set_wheel_accelerations(rates))
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
        let lifted = self
            .core
            .simulation()
            .map(|simulation| simulation.wheel_lifted_lately());
        if let Ok(true) = lifted {
            self.core.lift_reported = true;
            self.logger.report(Status::Warning, &format!(
                "at {time} s a wheel lifts off the ground; the loads of the others are scaled to carry the weight"
            ));
        }
    }

    pub(super) fn get_states(&mut self, values: &mut [f64]) -> Outcome {
        fill(values, self.core.simulation()?.state().to_array())
    }

    pub(super) fn get_rates(&mut self, values: &mut [f64]) -> Outcome {
        let rates = self.core.simulation()?.derivative().map_err(broken)?;
        fill(values, rates)
    }

    pub(super) fn get_nominals(values: &mut [f64]) -> Outcome {
        fill(values, state_nominals())
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
            .map_err(broken)
    }
}

/// Refuses a time at which double precision does not resolve steps.
fn check_time(what: &str, time: f64) -> Outcome {
    if !time.is_finite() {
        return refuse(format!("{what} {time} is not finite"));
    }
    if time.abs() > MAX_TIME {
        return refuse(format!(
            "{what} {time} s is beyond {MAX_TIME} s, where double precision resolves less than {MAX_ROUNDING} s; \
             count the time from a later origin"
        ));
    }
    Ok(())
}

/// Fills an array with one number for each state.
fn fill(values: &mut [f64], numbers: [f64; State::COUNT]) -> Outcome {
    if values.len() != State::COUNT {
        return refuse(format!(
            "there are {} states, not {}",
            State::COUNT,
            values.len()
        ));
    }
    values.copy_from_slice(&numbers);
    Ok(())
}

pub(super) fn broken(error: SimulationError) -> Failure {
    Failure::Broken(error.to_string())
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
            due: f64::INFINITY,
            lift_reported: false,
            simulation: None,
        }
    }

    /// Sets the time of the simulation. While the importer integrates towards an event, the effects
    /// before it act up to it and beyond: they switch in event mode, so that no solver meets a jump.
    fn pass_on_time(&mut self) -> Outcome {
        let time = match self.mode {
            Mode::ContinuousTime => self.time.min(self.due.next_down()),
            _ => self.time,
        };
        self.simulation()?.set_time(time).map_err(broken)
    }

    /// The simulation, built from the parameters where needed.
    pub(super) fn simulation(&mut self) -> Outcome<&mut Simulation> {
        if self.simulation.is_none() {
            let model = self.parameters.model();
            let model = model.map_err(|e| Failure::Broken(e.to_string()))?;
            let mut simulation = Simulation::new(model);
            let state = self.parameters.start(self.parameters.initial, self.speeds);
            simulation
                .set_time(self.time)
                .and_then(|()| simulation.set_state(state))
                .and_then(|()| simulation.set_wheel_speeds(self.speeds))
                .map_err(broken)?;
            self.simulation = Some(simulation);
        }
        let simulation = self.simulation.as_mut();
        simulation.ok_or_else(|| Failure::Broken("there is no simulation".to_owned()))
    }
}

#[cfg(test)]
mod tests;
