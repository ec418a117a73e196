//! What the fit asks of a model: trajectories with derivatives.

use super::deadline::Deadline;
use crate::parameter::ParameterError;
use crate::recording::Drive;
use crate::simulation::{SimulationError, State};
use thiserror::Error;

/// A trajectory that is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// The free parameters, in the predictor's order, in SI units.
    pub parameters: &'a [f64],
    /// The state at the first of the times.
    pub start: &'a State,
    /// Poses over which the vehicle came there, the oldest first, as
    /// [`Simulation::settle_after`](crate::simulation::Simulation::settle_after) takes them; without any its motion at the
    /// start is taken to have lasted.
    pub course: &'a [[f64; 3]],
    /// What the model's clock shows at time 0 \[s\].
    pub clock: f64,
    /// Recorded wheel speeds, linear between rows and held beyond the ends.
    pub drive: &'a Drive,
    /// The wheels at time t turn as recorded at t + `wheel_latency` \[s\].
    pub wheel_latency: f64,
    /// Times at which the state is wanted \[s\], increasing.
    pub times: &'a [f64],
    /// Times at which one time bin closes and the next opens \[s\], increasing, for derivatives by
    /// parameters as they act within each.
    pub time_bins: &'a [f64],
    /// Whether derivatives are wanted besides the states.
    pub derivatives: bool,
}

/// States over time, and their derivatives where those were asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectory {
    /// State at each time, in the order of [`State::to_array`].
    pub states: Vec<[f64; 6]>,
    /// Its rate of change.
    pub rates: Vec<[f64; 6]>,
    /// Derivatives by the start: for each time one state's worth per component of the start.
    pub by_start: Vec<[[f64; 6]; 6]>,
    /// Derivatives by the parameters: for each time one state's worth per parameter, all in
    /// one list; those by binned parameters follow, bin by bin.
    pub by_parameter: Vec<[f64; 6]>,
    /// Derivatives by the wheels' latency.
    pub by_wheel_latency: Vec<[f64; 6]>,
}

impl Trajectory {
    /// Makes room for another trajectory.
    pub fn clear(&mut self) {
        self.states.clear();
        self.rates.clear();
        self.by_start.clear();
        self.by_parameter.clear();
        self.by_wheel_latency.clear();
    }
}

/// A model whose parameters can be fitted.
pub trait Predictor: Send + Sync {
    /// Number of free parameters.
    fn parameters(&self) -> usize;

    /// The same with its parameters held at these values, none of them free.
    ///
    /// # Errors
    /// Parameters out of range.
    fn held(&self, parameters: &[f64]) -> Result<Self, PredictionError>
    where
        Self: Sized;

    /// When predictions have to end, and with them the fits that ask for them.
    fn deadline(&self) -> Deadline<'_> {
        Deadline::NEVER
    }

    /// States, rates and, where asked for, derivatives at the request's times.
    ///
    /// # Errors
    /// Parameters out of range, drives that the vehicle cannot follow with them, and the deadline.
    fn predict(&self, request: &Request, out: &mut Trajectory) -> Result<(), PredictionError>;
}

/// Why there is no trajectory for these parameters.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PredictionError {
    /// A parameter out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A drive that ends early.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The deadline has passed: see [`Predictor::deadline`].
    #[error("time was up")]
    OutOfTime,
}
