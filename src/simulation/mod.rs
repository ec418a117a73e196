//! The vehicle's motion in time.

#[cfg(feature = "batch")]
pub mod batch;
mod error;
mod evaluation;
mod integrator;
mod jacobian;
mod last_step;
mod linearised;
mod memory;
mod rosenbrock;
mod rut_history;
mod sensitivity;
mod settled;
mod slope_history;
mod snapshot;
mod state;
mod variation;

pub use error::SimulationError;
pub use integrator::Counters;
#[cfg(feature = "fmu")]
pub(crate) use integrator::LONGEST_CALL;
pub use jacobian::Jacobian;
pub use last_step::LastStep;
pub use linearised::Derivatives;
pub use sensitivity::SensitiveSimulation;
pub use snapshot::SnapshotError;
pub(crate) use state::StateVector;
pub use state::{State, WheelSpeeds};

use crate::vehicle::{Balance, BalanceError, Motion, Trend, VehicleModel, Wrench};
use crate::vehicle::{Differentiated, Direction, Directions, Prepared, TrackSlope};
use evaluation::Evaluation;
use integrator::Integrator;
use jacobian::Work;
use memory::directions;
use rut_history::RutHistory;
use std::sync::Arc;

/// A vehicle driving on a terrain: wheel speeds in, motion out.
///
/// A simulation is a value: a clone goes on exactly as the original would, and the same calls
/// give the same bits. With the paper's physics it allocates nothing while it steps.
#[derive(Debug, Clone)]
pub struct Simulation {
    model: Arc<VehicleModel>,
    time: f64,
    state: State,
    /// What the vehicle and its ground remember; nothing in the paper's model.
    memory: Vec<f64>,
    /// The tracks that the wheels left, where they meet them again.
    left: RutHistory,
    inputs: WheelSpeeds,
    input_rates: WheelSpeeds,
    /// The end of the last step: the first guess for whatever is asked next, so
    /// that what a caller reads between steps leaves no trace in the steps that follow.
    anchor: Evaluation,
    now: Evaluation,
    /// How the balance changed with the motion at the last Jacobian: improves the guesses.
    trend: Trend,
    integrator: Integrator,
    work: Work,
}

impl Simulation {
    /// A vehicle at rest at the origin, heading east, wheels standing still, at time 0.
    #[must_use]
    pub fn new(model: impl Into<Arc<VehicleModel>>) -> Self {
        let model = model.into();
        let balance = Balance::new(&model);
        let now = Evaluation {
            valid: false,
            motion: Motion::default(),
            balance,
            wrench: Wrench::for_model(&model),
            derivative: StateVector::zeros(),
            memory_rates: vec![0.0; model.memory_count()],
            beside: StateVector::zeros(),
            memory_beside: vec![0.0; model.memory_count()],
        };
        let trend = Trend::of_wheels(model.vehicle().wheel_count());
        let work = Work::new(&model, &now);
        let memory_count = model.memory_count();
        let memory = vec![0.0; memory_count];
        let left = RutHistory::new(&model);
        Self {
            model,
            time: 0.0,
            state: State::default(),
            memory,
            left,
            inputs: WheelSpeeds::default(),
            input_rates: WheelSpeeds::default(),
            anchor: now.clone(),
            now,
            trend,
            integrator: Integrator::new(memory_count),
            work,
        }
    }

    /// The vehicle and the terrain.
    #[must_use]
    pub fn model(&self) -> &VehicleModel {
        &self.model
    }

    /// Simulated time \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Sets the simulated time \[s\]; only effects may depend on it.
    ///
    /// # Errors
    /// A value that is not finite; then nothing has changed.
    pub fn set_time(&mut self, time: f64) -> Result<(), SimulationError> {
        finite(&["time"], &[time])?;
        // Callers add up time in their own ways: what rounding moves is no other time, unless effects switch there.
        let model = &self.model;
        let rounding = 8.0 * f64::EPSILON * time.abs().max(self.time.abs());
        let is_same = || {
            (time - self.time).abs() <= rounding
                && model.next_event(time) == model.next_event(self.time)
        };
        if time != self.time && !model.effects().is_paper() && !is_same() {
            self.leave();
        }
        self.time = time;
        Ok(())
    }

    /// Pose and velocities.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// Places the vehicle elsewhere or gives it another velocity. A vehicle that is placed elsewhere stands beside
    /// the tracks of before.
    ///
    /// # Errors
    /// A value that is not finite; then nothing has changed.
    pub fn set_state(&mut self, state: State) -> Result<(), SimulationError> {
        const NAMES: [&str; State::COUNT] = ["x", "y", "heading", "v_x", "v_y", "yaw_rate"];
        finite(&NAMES, &state.to_array())?;
        if state != self.state {
            let pose = |state: &State| [state.x, state.y, state.heading];
            if pose(&state) != pose(&self.state) {
                self.left.clear();
            }
            self.state = state;
            self.leave();
        }
        Ok(())
    }

    /// What the vehicle and its ground remember, in the order of
    /// [`VehicleModel::memory_names`]; nothing in the paper's model.
    #[must_use]
    pub fn memory(&self) -> &[f64] {
        &self.memory
    }

    /// Wheel speeds at the current time \[rad/s\].
    #[must_use]
    pub fn wheel_speeds(&self) -> WheelSpeeds {
        self.inputs
    }

    /// Sets the wheel speeds from the current time on \[rad/s\].
    ///
    /// # Errors
    /// A value that is not finite; then nothing has changed.
    pub fn set_wheel_speeds(&mut self, speeds: WheelSpeeds) -> Result<(), SimulationError> {
        finite(&["omega_left", "omega_right"], &[speeds.left, speeds.right])?;
        if !speeds.is_nearly(self.inputs) {
            self.now.valid = false;
        }
        self.inputs = speeds;
        Ok(())
    }

    /// Sets the rates at which the wheel speeds change within the next steps \[rad/s^2\];
    /// zero initially.
    ///
    /// # Errors
    /// A value that is not finite; then nothing has changed.
    pub fn set_wheel_accelerations(&mut self, rates: WheelSpeeds) -> Result<(), SimulationError> {
        let names = ["rate of omega_left", "rate of omega_right"];
        finite(&names, &[rates.left, rates.right])?;
        self.input_rates = rates;
        Ok(())
    }

    /// Forces, moments and resistances at the current state and wheel speeds.
    ///
    /// # Errors
    /// A bogged wheel, or velocities too large for finite forces.
    pub fn wrench(&mut self) -> Result<&Wrench, SimulationError> {
        self.evaluate()?;
        Ok(&self.now.wrench)
    }

    /// Rate of change of the state, in the order of [`State::to_array`].
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn derivative(&mut self) -> Result<[f64; State::COUNT], SimulationError> {
        self.evaluate()?;
        Ok(self.now.derivative.into())
    }

    /// Whether some wheel carries nothing at the current state and wheel speeds.
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn wheel_lifted(&mut self) -> Result<bool, SimulationError> {
        self.evaluate()?;
        Ok(self.now.balance.lifted())
    }

    /// Whether some wheel carried nothing at the last evaluation of the forces, some hundredths of a second ago at most.
    #[cfg(feature = "fmu")]
    pub(crate) fn wheel_lifted_lately(&self) -> bool {
        self.anchor.valid && self.anchor.balance.lifted()
    }

    /// Forgets what the vehicle and its ground remember.
    pub(crate) fn forget(&mut self) {
        self.memory.fill(0.0);
        self.left.clear();
        self.leave();
    }

    /// What follows does not go on from the last step's end.
    fn leave(&mut self) {
        self.now.valid = false;
        self.anchor.valid = false;
    }

    fn input_rates(&self) -> WheelSpeeds {
        self.input_rates
    }

    /// The model at the present, evaluated state.
    fn prepared(&self) -> Prepared<'_> {
        let tracks = self.left.tracks();
        let surroundings = self.state.surroundings(self.time, &self.memory, tracks);
        self.model.prepare(&self.now.motion, &surroundings)
    }

    /// Differentiates in some directions at the present, evaluated state.
    fn differentiate(&self, directions: &mut Directions, results: &mut Vec<Differentiated>) {
        directions.differentiate(&self.prepared(), &self.now.balance, results);
    }

    fn evaluate(&mut self) -> Result<(), SimulationError> {
        if self.now.valid {
            return Ok(());
        }
        let (time, motion) = (self.time, self.state.motion(self.inputs));
        if self.anchor.valid {
            self.now.guess_from(&self.anchor, &self.trend, &motion);
        } else {
            self.now.balance.copy_from(&self.anchor.balance);
        }
        let (model, state, memory) = (&self.model, &self.state, &self.memory);
        let tracks = self.left.tracks();
        let solved = self.now.solve(model, state, motion, time, memory, tracks);
        if let Err(SimulationError::Balance { source, .. }) = &solved
            && matches!(source, BalanceError::NotConverged(_))
        {
            // Wheel speeds that jump may lead too far from the last balance: then from scratch.
            return self.now.solve(model, state, motion, time, memory, tracks);
        }
        solved
    }
}

fn finite<const N: usize>(
    names: &[&'static str; N],
    values: &[f64; N],
) -> Result<(), SimulationError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(SimulationError::NotFinite {
            what: names[index],
            value: values[index],
        }),
        None => Ok(()),
    }
}

impl Simulation {
    /// Takes derivatives at the present, evaluated state for the steps that follow.
    pub(super) fn take_jacobian(&mut self, list: &[Direction], results: &[Differentiated]) {
        let mut jacobian = Jacobian::default();
        jacobian.take(list, results);
        self.trend.take(list, results);
        let integrator = &mut self.integrator;
        integrator.memory.set(list, results);
        integrator.by_state = jacobian.by_state;
        integrator.by_input = jacobian.by_input;
        integrator.jacobian_age = 0;
        integrator.jacobian_lag = 0.0;
    }

    /// The same, in the integrator's own directions.
    pub(super) fn renew_jacobian(&mut self) {
        let mut work = std::mem::take(&mut self.work.derivatives);
        self.differentiate(&mut work.directions, &mut work.results);
        self.take_jacobian(work.directions.list(), &work.results);
        self.work.derivatives = work;
        self.integrator.counters.jacobians += 1;
    }

    /// The derivative of the wrench when velocities and wheel speeds change in `direction`, and
    /// position and heading in `pose` \[m, m, rad\]; what is remembered is held.
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn wrench_derivative(
        &mut self,
        direction: &Motion,
        pose: [f64; 3],
    ) -> Result<&Wrench, SimulationError> {
        self.evaluate()?;
        let mut work = std::mem::take(&mut self.work.derivatives);
        self.differentiate(&mut work.directions, &mut work.results);
        let (motion, list) = (direction.to_array(), work.directions.list());
        let shares = list.iter().map(|direction| {
            let place = |list: &[Direction]| list.iter().position(|one| one == direction);
            match (place(&Direction::MOTION), place(&Direction::POSE)) {
                (Some(component), _) => motion[component],
                (_, Some(component)) => pose[component],
                _ => 0.0,
            }
        });
        let wrenches = work.results.iter().map(|result| &result.wrench);
        self.work.partial.combine(wrenches.zip(shares));
        self.work.derivatives = work;
        Ok(&self.work.partial)
    }

    /// The derivative of the wrench in time, the wheel speeds being held.
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn wrench_rate(&mut self) -> Result<&Wrench, SimulationError> {
        self.evaluate()?;
        let mut list = directions(&self.model);
        list.push(Direction::Time);
        let mut results = Vec::new();
        let mut directions = Directions::new(&self.model, list);
        self.differentiate(&mut directions, &mut results);
        let rate: [f64; State::COUNT] = self.now.derivative.into();
        let rates = directions.list().iter().map(|direction| match *direction {
            Direction::Velocity(axis) => rate[3 + axis],
            Direction::YawRate => rate[5],
            Direction::Position(axis) => rate[axis],
            Direction::Heading => rate[2],
            Direction::Memory(index) => self.now.memory_rates[index],
            Direction::Time => 1.0,
            Direction::WheelSpeed(_) | Direction::Parameter(_) => 0.0,
        });
        let wrenches = results.iter().map(|result| &result.wrench);
        self.work.partial.combine(wrenches.zip(rates));
        Ok(&self.work.partial)
    }

    /// The derivative of the wrench by the time itself, all else being held: there is one where
    /// effects are functions of the time.
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn wrench_by_time(&mut self) -> Result<&Wrench, SimulationError> {
        self.evaluate()?;
        let mut results = Vec::new();
        let mut directions = Directions::new(&self.model, vec![Direction::Time]);
        self.differentiate(&mut directions, &mut results);
        self.work
            .partial
            .combine(results.iter().map(|r| (&r.wrench, 1.0)));
        Ok(&self.work.partial)
    }

    /// Derivatives of the state's rate of change by the state and the wheel speeds.
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn jacobian(&mut self) -> Result<Jacobian, SimulationError> {
        self.evaluate()?;
        let mut work = std::mem::take(&mut self.work.derivatives);
        self.differentiate(&mut work.directions, &mut work.results);
        let mut jacobian = self.state.kinematic_jacobian();
        jacobian.take(work.directions.list(), &work.results);
        self.work.derivatives = work;
        Ok(jacobian)
    }

    /// How the rates of what the wheels meet depend on the samples of their tracks, at the present, evaluated state.
    pub(super) fn track_slopes(&self) -> Vec<TrackSlope> {
        self.prepared().track_slopes(&self.now.balance)
    }

    /// Leaves the tracks of the step that was taken.
    pub(super) fn leave_tracks(&mut self) {
        self.left.follow(&self.state, &self.now.wrench);
    }
}
