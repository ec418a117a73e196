//! What lies within the last step of the integrator: as exact as the step itself, without a step that
//! ends there.
//!
//! The motion by the method's own continuous extension (Shampine & Reichelt 1997, section 2.2), its
//! derivatives by the quadratic that has the stages' slopes where the stages are.

use super::variation::Variation;
use super::{Simulation, State, StateVector};
use nalgebra::{Const, Dyn, OMatrix, SMatrix};

/// The step that a simulation has just taken.
#[derive(Debug, Clone, Copy)]
pub struct LastStep<'a> {
    pub(super) simulation: &'a Simulation,
    pub(super) variation: Option<&'a Variation>,
    /// Its length \[s\]; 0 where another window of effects begins.
    pub(super) length: f64,
}

/// Derivatives of a state: a column by each component of the initial state, one by a delay of the
/// wheel speeds, and one by each parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives(pub(super) OMatrix<f64, Const<{ State::COUNT }>, Dyn>);

/// Column of the derivative by a delay of the wheel speeds.
pub(super) const DELAY: usize = State::COUNT;

impl Derivatives {
    /// By the state at the restart.
    #[must_use]
    pub fn by_initial(&self) -> SMatrix<f64, { State::COUNT }, { State::COUNT }> {
        self.0.fixed_columns::<{ State::COUNT }>(0).into()
    }

    /// By a delay of the wheel speeds \[per s\], as far as these change by their rates: what a jump from one call of
    /// [`SensitiveSimulation::drive`](super::SensitiveSimulation::drive) to the next would do later is not in it.
    #[must_use]
    pub fn by_wheel_delay(&self) -> [f64; State::COUNT] {
        self.0.column(DELAY).into_owned().into()
    }

    /// By each parameter: those that act throughout, then the gated ones, gate by gate.
    pub fn by_parameters(&self) -> impl Iterator<Item = [f64; State::COUNT]> + '_ {
        let columns = self.0.column_iter().skip(DELAY + 1);
        columns.map(|column| column.into_owned().into())
    }

    /// By one of the parameters, in the order of [`Derivatives::by_parameters`].
    #[must_use]
    pub fn by_parameter(&self, index: usize) -> [f64; State::COUNT] {
        self.0.column(DELAY + 1 + index).into_owned().into()
    }
}

impl LastStep<'_> {
    /// How long it was \[s\]; 0 where another window of effects begins.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The state `back` seconds before the step's end, and its rate of change, in the order of
    /// [`State::to_array`].
    #[must_use]
    pub fn state(&self, back: f64) -> (State, [f64; State::COUNT]) {
        let (state, slope) = self.simulation.within(self.length, back);
        let state = State::from_array(state.into());
        let slope: [f64; State::COUNT] = slope.into();
        let (sin, cos) = state.heading.sin_cos();
        let rates = [
            state.v_x * cos - state.v_y * sin,
            state.v_x * sin + state.v_y * cos,
            state.yaw_rate,
            slope[3],
            slope[4],
            slope[5],
        ];
        (state, rates)
    }

    /// Derivatives of the state `back` seconds before the step's end, where the simulation carries
    /// them.
    #[must_use]
    pub fn derivatives(&self, back: f64) -> Option<Derivatives> {
        self.variation.map(|variation| variation.within(back))
    }
}

/// Share of a step that has passed `back` seconds before its end.
pub(super) fn share(length: f64, back: f64) -> f64 {
    if length > 0.0 {
        (1.0 - back / length).clamp(0.0, 1.0)
    } else {
        1.0
    }
}

impl Simulation {
    /// State and its slope `back` seconds before the end of the last step.
    fn within(&self, length: f64, back: f64) -> (StateVector, StateVector) {
        if length == 0.0 {
            // Behind an event: nothing has been driven yet with what holds from here on.
            return (self.state.to_array().into(), self.now.derivative);
        }
        self.work.stages.at(length, share(length, back))
    }

    /// As [`Simulation::step`], with a look at each step that the integrator takes.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step_looking(
        &mut self,
        seconds: f64,
        mut look: impl FnMut(&LastStep),
    ) -> Result<(), super::SimulationError> {
        self.step_with(seconds, |simulation, length| {
            look(&LastStep {
                simulation,
                variation: None,
                length,
            });
            Ok(())
        })
    }
}
