//! A simulation's state as plain numbers, to be stored and taken up elsewhere.

use super::Simulation;
use crate::vehicle::{Balance, Motion};
use std::f64::consts::PI;
use thiserror::Error;

/// Numbers that are no snapshot of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// Another number of them than this model's snapshots have.
    #[error("{found} numbers are no snapshot of this model, which has {expected}")]
    Count {
        /// How many this model's snapshots have.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A step of the integrator, an entry angle, a state or a time that no simulation has.
    #[error("these numbers are none of a simulation")]
    Numbers,
}

impl Simulation {
    /// Everything that determines how the simulation goes on, as numbers; the model is not
    /// among them.
    #[must_use]
    pub fn snapshot(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.clone().visit(&mut |number| numbers.push(*number));
        numbers
    }

    /// Takes up the state of another simulation of the same model.
    ///
    /// # Errors
    /// Another number of numbers than this model's snapshots have, or numbers with which it could not go on; then nothing
    /// has changed.
    pub fn restore(&mut self, snapshot: &[f64]) -> Result<(), SnapshotError> {
        let mut expected = 0;
        self.visit(&mut |_| expected += 1);
        if snapshot.len() != expected {
            return Err(SnapshotError::Count {
                expected,
                found: snapshot.len(),
            });
        }
        let mut numbers = snapshot.iter();
        let mut restored = self.clone();
        restored.visit(&mut |number| *number = numbers.next().copied().unwrap_or_default());
        if !restored.is_sound() {
            return Err(SnapshotError::Numbers);
        }
        *self = restored;
        Ok(())
    }

    /// Whether steps can end from here on: every number is finite (but those of a solution that was not found), the
    /// step is one, and so are the entry angles.
    fn is_sound(&self) -> bool {
        let mut numbers = self.clone();
        if !numbers.now.valid {
            numbers.now = numbers.anchor.clone();
        }
        let angles = |balance: &Balance| {
            let mut wheels = balance.wheels.iter();
            wheels.all(|wheel| (0.0..=PI).contains(&wheel.entry_angle))
        };
        let balances = [&numbers.anchor.balance, &numbers.now.balance];
        let drives = balances.into_iter().all(angles) && numbers.integrator.next_step > 0.0;
        let mut finite = true;
        numbers.visit(&mut |number| finite &= number.is_finite());
        drives && finite
    }

    fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        visit(&mut self.time);
        let mut state = self.state.to_array();
        state.iter_mut().for_each(&mut *visit);
        self.state = super::State::from_array(state);
        self.memory.iter_mut().for_each(&mut *visit);
        self.left.visit(visit);
        for speeds in [&mut self.inputs, &mut self.input_rates] {
            visit(&mut speeds.left);
            visit(&mut speeds.right);
        }
        for evaluation in [&mut self.anchor, &mut self.now] {
            evaluation.balance.visit(visit);
            let mut motion = evaluation.motion.to_array();
            motion.iter_mut().for_each(&mut *visit);
            evaluation.motion = Motion::from_array(motion);
            evaluation.derivative.iter_mut().for_each(&mut *visit);
            evaluation.memory_rates.iter_mut().for_each(&mut *visit);
            evaluation.beside.iter_mut().for_each(&mut *visit);
            evaluation.memory_beside.iter_mut().for_each(&mut *visit);
            visit_flag(&mut evaluation.valid, visit);
        }
        // A step that was taken with one evaluation ends a little beside the state whose forces these are.
        self.now.wrench.visit(visit);
        self.trend.visit(visit);
        let integrator = &mut self.integrator;
        visit(&mut integrator.next_step);
        visit(&mut integrator.short_error);
        visit(&mut integrator.owed);
        visit(&mut integrator.jacobian_lag);
        visit(&mut integrator.linear.seconds);
        visit(&mut integrator.linear.trend.left);
        visit(&mut integrator.linear.trend.right);
        integrator.by_state.iter_mut().for_each(&mut *visit);
        integrator.by_input.iter_mut().for_each(&mut *visit);
        integrator.memory.visit(visit);
        let mut age = f64::from(integrator.jacobian_age);
        visit(&mut age);
        integrator.jacobian_age = age as u32;
        let counters = &mut integrator.counters;
        for count in [
            &mut counters.steps,
            &mut counters.rejected,
            &mut counters.evaluations,
            &mut counters.jacobians,
        ] {
            // Exact up to 2^53 steps.
            let mut number = *count as f64;
            visit(&mut number);
            *count = number as u64;
        }
    }
}

pub(crate) fn visit_flag(flag: &mut bool, visit: &mut impl FnMut(&mut f64)) {
    let mut number = f64::from(u8::from(*flag));
    visit(&mut number);
    *flag = number != 0.0;
}
