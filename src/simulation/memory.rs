//! What the vehicle and its ground remember, in the integrator: states that follow the motion,
//! eliminated from each stage's linear system.

use super::state::{State, StateMatrix, StateVector};
use crate::vehicle::{Differentiated, Direction, VehicleModel};
use nalgebra::{LU, SMatrix};

/// Tolerated error of a remembered number in one step: absolute part (metres, or metres per
/// radian of a wheel), and part of its magnitude.
const ABSOLUTE_TOLERANCE: f64 = 2e-5;
const RELATIVE_TOLERANCE: f64 = 1e-4;

type StateLu = LU<f64, nalgebra::Const<{ State::COUNT }>, nalgebra::Const<{ State::COUNT }>>;

/// How rates depend on what is remembered, and the other way round.
#[derive(Debug, Clone, Default)]
pub(super) struct MemoryJacobian {
    /// Accelerations and yaw acceleration by each remembered number.
    accelerations: Vec<[f64; 3]>,
    /// The rate of each remembered number by the state.
    by_state: Vec<[f64; State::COUNT]>,
    /// The same by the wheel speeds.
    by_input: Vec<[f64; 2]>,
    /// The rate of each remembered number by itself. (By the others it is left out: the method
    /// keeps its order with any matrix.)
    diagonal: Vec<f64>,
}

impl MemoryJacobian {
    /// No coupling yet, with room for so many numbers.
    pub fn new(count: usize) -> Self {
        Self {
            accelerations: vec![[0.0; 3]; count],
            by_state: vec![[0.0; State::COUNT]; count],
            by_input: vec![[0.0; 2]; count],
            diagonal: vec![0.0; count],
        }
    }

    /// Visits every number, for a snapshot.
    pub fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        self.accelerations
            .iter_mut()
            .flatten()
            .for_each(&mut *visit);
        self.by_state.iter_mut().flatten().for_each(&mut *visit);
        self.by_input.iter_mut().flatten().for_each(&mut *visit);
        self.diagonal.iter_mut().for_each(visit);
    }

    /// Takes the derivatives in the directions that [`directions`] lists.
    pub fn set(&mut self, list: &[Direction], results: &[Differentiated]) {
        let mut none = 0.0;
        self.visit(&mut |number| *number = std::mem::take(&mut none));
        for (direction, result) in list.iter().zip(results) {
            let rates = result.memory_rates.iter().enumerate();
            match *direction {
                Direction::Velocity(axis) => {
                    rates.for_each(|(index, rate)| self.by_state[index][3 + axis] = *rate);
                }
                Direction::YawRate => {
                    rates.for_each(|(index, rate)| self.by_state[index][5] = *rate);
                }
                Direction::Position(axis) => {
                    rates.for_each(|(index, rate)| self.by_state[index][axis] = *rate);
                }
                Direction::Heading => {
                    rates.for_each(|(index, rate)| self.by_state[index][2] = *rate);
                }
                Direction::WheelSpeed(side) => {
                    rates.for_each(|(index, rate)| self.by_input[index][side] = *rate);
                }
                Direction::Memory(index) => {
                    let wrench = &result.wrench;
                    self.accelerations[index] = [wrench.a_x, wrench.a_y, wrench.yaw_acceleration];
                    self.diagonal[index] = result.memory_rates[index];
                }
                Direction::Time | Direction::Parameter(_) => {}
            }
        }
    }

    /// Change of a number's rate with the wheel speeds.
    pub fn by_input(&self, index: usize, change: [f64; 2]) -> f64 {
        let [left, right] = self.by_input[index];
        left * change[0] + right * change[1]
    }

    /// Change of a number's rate with the state and the number itself.
    pub fn by_motion(&self, index: usize, state: &StateVector, own: f64) -> f64 {
        let by_state = self.by_state[index].iter().zip(state.iter());
        self.diagonal[index] * own + by_state.map(|(by, change)| by * change).sum::<f64>()
    }

    /// Adds the change of the accelerations with what is remembered to the rates of the state.
    pub fn add_accelerations(&self, changes: impl Iterator<Item = f64>, rates: &mut StateVector) {
        let mut sum = [0.0; 3];
        for (by, change) in self.accelerations.iter().zip(changes) {
            for axis in 0..3 {
                sum[axis] += by[axis] * change;
            }
        }
        for axis in 0..3 {
            rates[3 + axis] += sum[axis];
        }
    }
}

/// The directions of the integrator's Jacobian: the motion, place and heading where anything depends on them, and what
/// is remembered.
pub(super) fn directions(model: &VehicleModel) -> Vec<Direction> {
    let pose = Direction::POSE
        .into_iter()
        .filter(|_| !model.is_placeless());
    let motion = Direction::MOTION.into_iter().chain(pose);
    motion
        .chain(memory_directions(model.memory_count()))
        .collect()
}

/// Those of what is remembered alone.
pub(super) fn memory_directions(memory_count: usize) -> Vec<Direction> {
    (0..memory_count).map(Direction::Memory).collect()
}

/// The linear system of a stage, W = I - h d A, with what is remembered eliminated.
pub(super) struct StageSystem<'a> {
    lu: StateLu,
    memory: &'a MemoryJacobian,
    scale: f64,
}

impl<'a> StageSystem<'a> {
    /// With `scale` = h d.
    pub fn new(by_state: &StateMatrix, memory: &'a MemoryJacobian, scale: f64) -> Self {
        let mut matrix = StateMatrix::identity() - by_state * scale;
        for index in 0..memory.diagonal.len() {
            let inverse = 1.0 / (1.0 - scale * memory.diagonal[index]);
            let row = SMatrix::<f64, 1, { State::COUNT }>::from(memory.by_state[index]);
            for (axis, acceleration) in memory.accelerations[index].into_iter().enumerate() {
                let coupling = row * (scale * scale * acceleration * inverse);
                let mut changed = matrix.row_mut(3 + axis);
                changed -= coupling;
            }
        }
        Self {
            lu: matrix.lu(),
            memory,
            scale,
        }
    }

    /// Solves in place; NaN where the system is singular.
    pub fn solve(&self, mut state: StateVector, remembered: &mut [f64]) -> StateVector {
        let inverse = |index: usize| 1.0 / (1.0 - self.scale * self.memory.diagonal[index]);
        for (index, value) in remembered.iter().enumerate() {
            let onward = self.scale * inverse(index) * value;
            for (axis, acceleration) in self.memory.accelerations[index].into_iter().enumerate() {
                state[3 + axis] += onward * acceleration;
            }
        }
        if !self.lu.solve_mut(&mut state) {
            state.fill(f64::NAN);
        }
        for (index, value) in remembered.iter_mut().enumerate() {
            let by_state = &self.memory.by_state[index];
            let change: f64 = by_state.iter().zip(&state).map(|(by, s)| by * s).sum();
            *value = (*value + self.scale * change) * inverse(index);
        }
        state
    }
}

/// The largest error of the remembered numbers in units of its tolerance.
pub(super) fn worst_error(old: &[f64], new: &[f64], errors: impl Iterator<Item = f64>) -> f64 {
    let ratio = |((old, new), error): ((&f64, &f64), f64)| {
        error.abs() / (ABSOLUTE_TOLERANCE + RELATIVE_TOLERANCE * old.abs().max(new.abs()))
    };
    let worst = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
    old.iter().zip(new).zip(errors).map(ratio).fold(0.0, worst)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elimination_solves_the_whole_system() {
        let by_state = StateMatrix::from_fn(|i, j| 0.3 * ((i * 7 + j * 3) as f64).sin());
        let memory = MemoryJacobian {
            accelerations: vec![[3.0, -1.0, 2.0], [0.5, 4.0, -2.0]],
            by_state: vec![
                [0.1, 0.0, 0.2, 1.0, 0.3, -0.2],
                [0.0, 0.4, 0.0, -0.5, 1.0, 0.7],
            ],
            by_input: vec![[0.0; 2]; 2],
            diagonal: vec![-20.0, -3.0],
        };
        let scale = 0.03;
        let rhs = StateVector::from([1.0, -2.0, 0.5, 3.0, 0.2, -1.0]);
        let mut remembered = [0.7, -0.4];
        let system = StageSystem::new(&by_state, &memory, scale);
        let state = system.solve(rhs, &mut remembered);
        // Back into both equations.
        let mut residual = state - by_state * state * scale - rhs;
        for (index, value) in remembered.iter().enumerate() {
            for axis in 0..3 {
                residual[3 + axis] -= scale * memory.accelerations[index][axis] * value;
            }
            let by: f64 = memory.by_state[index]
                .iter()
                .zip(&state)
                .map(|(a, b)| a * b)
                .sum();
            let own = value - scale * (memory.diagonal[index] * value + by) - [0.7, -0.4][index];
            assert!(own.abs() < 1e-13, "{own}");
        }
        assert!(residual.amax() < 1e-13, "{residual}");
    }
}
