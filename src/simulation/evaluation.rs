//! Forces and rates at one state and input.

use super::error::SimulationError;
use super::state::{State, StateVector};
use crate::vehicle::{Balance, Motion, Prepared, Tracks, Trend, VehicleModel, Wrench};

/// Forces and rates at one state and input.
#[derive(Debug, Clone, Default)]
pub(super) struct Evaluation {
    /// Whether the rest belongs to the current state and inputs.
    pub valid: bool,
    pub motion: Motion,
    pub balance: Balance,
    pub wrench: Wrench,
    pub derivative: StateVector,
    /// Rates of what is remembered.
    pub memory_rates: Vec<f64>,
    /// How far the state lies beside the one at which this was evaluated: a step of one evaluation is put right at its
    /// end.
    pub beside: StateVector,
    /// The same of what is remembered.
    pub memory_beside: Vec<f64>,
}

impl Evaluation {
    /// Solves for the forces at a state and motion, starting from the balance that it holds.
    pub fn solve(
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
        self.beside.fill(0.0);
        self.memory_beside.fill(0.0);
        let prepared = model.prepare(&motion, &state.surroundings(time, memory, tracks));
        model
            .solve_prepared(&motion, &prepared, &mut self.balance)
            .map_err(|source| SimulationError::Balance { time, source })?;
        self.finish(state, &prepared);
        self.valid = true;
        Ok(())
    }

    /// What follows from the balance.
    pub fn finish(&mut self, state: &State, prepared: &Prepared) {
        prepared.wrench(&self.balance, &mut self.wrench);
        prepared.memory_rates(&self.balance, &mut self.memory_rates);
        self.derivative = state.derivative(&self.wrench).into();
    }

    /// Takes another evaluation's balance as the first guess at a motion.
    pub fn guess_from(&mut self, other: &Self, trend: &Trend, motion: &Motion) {
        self.balance.copy_from(&other.balance);
        let (from, to) = (other.motion.to_array(), motion.to_array());
        let mut change = [0.0; 5];
        for k in 0..5 {
            change[k] = to[k] - from[k];
        }
        trend.predict(&mut self.balance, &change);
    }

    pub fn copy_from(&mut self, other: &Self) {
        self.valid = other.valid;
        self.motion = other.motion;
        self.balance.copy_from(&other.balance);
        self.wrench.copy_from(&other.wrench);
        self.derivative = other.derivative;
        self.memory_rates.copy_from_slice(&other.memory_rates);
        self.beside = other.beside;
        self.memory_beside.copy_from_slice(&other.memory_beside);
    }
}
