//! The vehicle's motion in time.

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

pub use jacobian::Jacobian;
pub use last_step::{Derivatives, LastStep};
pub use rosenbrock::Counters;
#[cfg(feature = "fmu")]
pub(crate) use rosenbrock::LONGEST_CALL;
pub use sensitivity::SensitiveSimulation;
pub use snapshot::SnapshotError;
pub use state::{State, WheelSpeeds};

use crate::vehicle::{Balance, BalanceError, Motion, Trend, VehicleModel, Wrench};
use crate::vehicle::{Differentiated, Directions, Prepared, Tracks, Unusual};
use jacobian::Work;
use nalgebra::{SMatrix, SVector};
use rut_history::RutHistory;
use std::fmt;
use std::sync::Arc;

pub(crate) type StateVector = SVector<f64, { State::COUNT }>;
type StateMatrix = SMatrix<f64, { State::COUNT }, { State::COUNT }>;
type InputMatrix = SMatrix<f64, { State::COUNT }, 2>;

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
    /// Balance at the end of the last step: the first guess for whatever is asked next, so
    /// that what a caller reads between steps leaves no trace in the steps that follow.
    anchor: Balance,
    now: Evaluation,
    /// How the balance changed with the motion at the last Jacobian: improves the guesses.
    trend: Trend,
    integrator: rosenbrock::Integrator,
    work: Work,
}

/// Forces and rates at one state and input.
#[derive(Debug, Clone)]
struct Evaluation {
    /// Whether the rest belongs to the current state and inputs.
    valid: bool,
    motion: Motion,
    balance: Balance,
    wrench: Wrench,
    derivative: StateVector,
    /// Rates of what is remembered.
    memory_rates: Vec<f64>,
}

/// Why a simulation cannot go on.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// The wheels find no balance at this time \[s\].
    Balance {
        /// Simulated time \[s\].
        time: f64,
        /// What the wheels lack.
        source: BalanceError,
    },
    /// A step that is negative, not finite or longer than 1e6 s \[s\].
    StepSize(f64),
    /// An input or state that is not finite.
    NotFinite {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The error control asks for steps below the resolution of the time \[s\].
    StepTooSmall {
        /// Simulated time \[s\].
        time: f64,
        /// The parameter farthest from its usual values, if one is outside of them.
        suspect: Option<Unusual>,
    },
    /// The motion changes so fast that a second of driving takes too many steps ([`Simulation::limit_work`]).
    TooStiff {
        /// Simulated time \[s\].
        time: f64,
        /// The parameter farthest from its usual values, if one is outside of them.
        suspect: Option<Unusual>,
    },
    /// More steps are needed than [`Simulation::limit_steps`] allows.
    StepBudget {
        /// Simulated time \[s\].
        time: f64,
    },
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Balance { time, source } => write!(f, "at {time} s: {source}"),
            Self::StepSize(step) => {
                write!(
                    f,
                    "cannot step by {step} s: a step lies between 0 and 1e6 s"
                )
            }
            Self::NotFinite { what, value } => write!(f, "{what} = {value} is not finite"),
            Self::StepTooSmall { time, suspect } => {
                write!(
                    f,
                    "at {time} s the motion changes faster than the smallest step can follow"
                )?;
                doubt(f, suspect.as_ref())
            }
            Self::TooStiff { time, suspect } => {
                write!(
                    f,
                    "at {time} s the motion changes so fast that one second of driving takes too many steps"
                )?;
                doubt(f, suspect.as_ref())
            }
            Self::StepBudget { time } => write!(
                f,
                "at {time} s the number of steps that was set as a limit is used up"
            ),
        }
    }
}

fn doubt(f: &mut fmt::Formatter<'_>, suspect: Option<&Unusual>) -> fmt::Result {
    match suspect {
        Some(suspect) => write!(f, "; the likely cause is {suspect}"),
        None => Ok(()),
    }
}

impl std::error::Error for SimulationError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Balance { source, .. } => Some(source),
            _ => None,
        }
    }
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
            balance: balance.clone(),
            wrench: Wrench::for_model(&model),
            derivative: StateVector::zeros(),
            memory_rates: vec![0.0; model.memory_count()],
        };
        let trend = Trend::new(&model);
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
            anchor: balance,
            now,
            trend,
            integrator: rosenbrock::Integrator::new(memory_count),
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
        if time != self.time && self.model.altered().is_some() {
            self.now.valid = false;
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
            self.now.valid = false;
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
    /// zero at the beginning.
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

    /// Forgets what the vehicle and its ground remember.
    pub(crate) fn forget(&mut self) {
        self.memory.fill(0.0);
        self.left.clear();
        self.now.valid = false;
    }

    fn input_rates(&self) -> WheelSpeeds {
        self.input_rates
    }

    /// Differentiates in some directions at the present, evaluated state.
    fn differentiate(&self, directions: &Directions, results: &mut Vec<Differentiated>) {
        let surroundings = self
            .state
            .surroundings(self.time, &self.memory, self.left.tracks());
        if let Some(altered) = self.model.altered() {
            let (motion, balance) = (&self.now.motion, &self.now.balance);
            directions.differentiate(
                &self.model,
                altered,
                motion,
                &surroundings,
                balance,
                results,
            );
        }
    }

    fn evaluate(&mut self) -> Result<(), SimulationError> {
        if self.now.valid {
            return Ok(());
        }
        self.now.balance.copy_from(&self.anchor);
        let (time, motion) = (self.time, self.state.motion(self.inputs));
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

impl Evaluation {
    /// Solves for the forces at a state and motion, starting from the balance that it holds.
    fn solve(
        &mut self,
        model: &VehicleModel,
        state: &State,
        motion: Motion,
        time: f64,
        memory: &[f64],
        tracks: Tracks,
    ) -> Result<(), SimulationError> {
        self.valid = false;
        self.motion = motion;
        let prepared = model.prepare(&motion, &state.surroundings(time, memory, tracks));
        model
            .solve_prepared(&motion, prepared.as_ref(), &mut self.balance)
            .map_err(|source| SimulationError::Balance { time, source })?;
        self.finish(model, state, prepared.as_ref());
        self.valid = true;
        Ok(())
    }

    /// What follows from the balance.
    fn finish(&mut self, model: &VehicleModel, state: &State, prepared: Option<&Prepared>) {
        let (motion, balance) = (&self.motion, &self.balance);
        balance.wrench_of(model, motion, prepared, &mut self.wrench);
        balance.memory_rates(prepared, &mut self.memory_rates);
        self.derivative = state.derivative(&self.wrench).into();
    }

    /// Takes another evaluation's balance as the first guess at a motion.
    fn guess_from(&mut self, other: &Self, trend: &Trend, motion: &Motion) {
        self.balance.copy_from(&other.balance);
        let (from, to) = (other.motion.to_array(), motion.to_array());
        let mut change = [0.0; 5];
        for k in 0..5 {
            change[k] = to[k] - from[k];
        }
        self.balance.predict(trend, &change);
    }

    fn copy_from(&mut self, other: &Self) {
        self.valid = other.valid;
        self.motion = other.motion;
        self.balance.copy_from(&other.balance);
        self.wrench.copy_from(&other.wrench);
        self.derivative = other.derivative;
        self.memory_rates.copy_from_slice(&other.memory_rates);
    }
}
