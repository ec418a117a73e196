//! What lies within the last step of the integrator: as exact as the step itself, without a step that
//! ends there.
//!
//! The motion by the method's own continuous extension (Shampine & Reichelt 1997, section 2.2), its
//! derivatives by the quadratic that has the stages' slopes where the stages are.

use super::linearised::{Derivatives, share};
use super::variation::Variation;
use super::{Simulation, SimulationError, State, StateVector};
use std::ops::ControlFlow;

/// The step that a simulation has just taken.
#[derive(Debug, Clone, Copy)]
pub struct LastStep<'a> {
    pub(super) simulation: &'a Simulation,
    pub(super) variation: Option<&'a Variation>,
    /// Its length \[s\]; 0 where another window of effects starts.
    pub(super) length: f64,
}

impl LastStep<'_> {
    /// How long it was \[s\]; 0 where another window of effects starts.
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
    /// As [`Simulation::step`], and [`SimulationError::StepBudget`] once a look breaks off.
    pub fn step_looking(
        &mut self,
        seconds: f64,
        mut look: impl FnMut(&LastStep) -> ControlFlow<()>,
    ) -> Result<(), SimulationError> {
        self.step_with(seconds, |simulation, length| {
            let step = LastStep {
                simulation,
                variation: None,
                length,
            };
            simulation.unless_broken(look(&step))
        })
    }

    /// What a look demands.
    pub(super) fn unless_broken(&self, look: ControlFlow<()>) -> Result<(), SimulationError> {
        let time = self.time;
        let go_on = look.is_continue();
        go_on
            .then_some(())
            .ok_or(SimulationError::StepBudget { time })
    }
}
