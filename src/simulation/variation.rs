//! How derivatives of the state are carried along with it.
//!
//! The variational equation dZ/dt = A Z + B belongs to the motion dy/dt = f(y, u, p), A = df/dy and
//! B = df/dp exact at both ends of each of the integrator's steps (by dual numbers and the implicit
//! function theorem) and linear in between. It is integrated by Alexander's L-stable SDIRK method of
//! order 2 (R. Alexander, SIAM J. Numer. Anal. 14 (1977)).

use super::linearised::{Columns, Derivatives, GAMMA, Linearised, share};
use super::settled::Settling;
use super::slope_history::SlopeHistory;
use super::{Simulation, State};
use crate::vehicle::{Differentiated, Direction, Directions};
use nalgebra::{DMatrix, Vector2};

#[derive(Debug, Clone)]
pub(super) struct Variation {
    pub directions: Directions,
    /// For each direction its places among the parameters, where it is one.
    pub places: Vec<Vec<usize>>,
    pub results: Vec<Differentiated>,
    pub columns: Columns,
    /// Derivatives of the state and what is remembered (rows) by the [`Columns`].
    pub by: DMatrix<f64>,
    /// Where the last step ended.
    pub last: Option<Linearised>,
    /// The last step's length \[s\] and the slopes of its two stages, in the columns then in use.
    pub length: f64,
    pub slopes: [DMatrix<f64>; 2],
    /// Of the tracks that the wheels left.
    pub left: SlopeHistory,
}

pub(super) fn identity(memory: usize, columns: &Columns) -> DMatrix<f64> {
    DMatrix::from_fn(State::COUNT + memory, columns.all(), |i, j| {
        f64::from(u8::from(i == j && j < State::COUNT))
    })
}

/// How the wheel speeds change with their delay: what came later came with the speed of before.
fn delayed(simulation: &Simulation) -> Vector2<f64> {
    let rates = simulation.input_rates();
    Vector2::new(-rates.left, -rates.right)
}

impl Variation {
    /// Linearises at the present state. The integrator does not use this Jacobian: trajectories with and without
    /// derivatives are bit-identical, and fits compare the two.
    pub fn linearise(&mut self, simulation: &mut Simulation) -> Linearised {
        simulation.differentiate(&mut self.directions, &mut self.results);
        let rows = self.by.nrows();
        let mut by_state = DMatrix::zeros(rows, rows);
        let mut by_speeds = DMatrix::zeros(rows, 2);
        let parameters = self.columns.throughout + self.columns.binned;
        let mut by_parameters = DMatrix::zeros(rows, parameters);
        let wheels = if simulation.model.has_ruts() {
            simulation.model.vehicle().wheel_count()
        } else {
            0
        };
        let mut depths = [
            DMatrix::zeros(wheels, rows),
            DMatrix::zeros(wheels, parameters),
        ];
        let kinematics = simulation.state().kinematic_jacobian().by_state;
        by_state
            .view_mut((0, 0), (State::COUNT, State::COUNT))
            .copy_from(&kinematics);
        let directions = self.directions.list().iter().zip(&self.places);
        for ((direction, places), result) in directions.zip(&self.results) {
            let wrench = &result.wrench;
            let change = [wrench.a_x, wrench.a_y, wrench.yaw_acceleration];
            let change = (3..).zip(change);
            let change = change.chain((State::COUNT..).zip(result.memory_rates.iter().copied()));
            let sunk = wrench.wheels.iter().map(|wheel| wheel.sinkage);
            let sunk = sunk.take(wheels).enumerate();
            let (target, column) = match *direction {
                Direction::Position(axis) => (&mut by_state, axis),
                Direction::Heading => (&mut by_state, 2),
                Direction::Velocity(axis) => (&mut by_state, 3 + axis),
                Direction::YawRate => (&mut by_state, 5),
                Direction::Memory(index) => (&mut by_state, State::COUNT + index),
                Direction::WheelSpeed(side) => (&mut by_speeds, side),
                Direction::Time => continue,
                Direction::Parameter(_) => {
                    for place in places {
                        for (row, value) in change.clone() {
                            by_parameters[(row, *place)] += value;
                        }
                        for (wheel, value) in sunk.clone() {
                            depths[1][(wheel, *place)] += value;
                        }
                    }
                    continue;
                }
            };
            if !matches!(direction, Direction::WheelSpeed(_)) {
                for (wheel, value) in sunk {
                    depths[0][(wheel, column)] += value;
                }
            }
            for (row, value) in change {
                target[(row, column)] += value;
            }
        }
        Linearised {
            by_state,
            by_speeds,
            by_parameters,
            by_tracks: self.left.rates(simulation, rows, self.columns.all()),
            depths,
        }
    }

    /// Takes note of the tracks that were left where the last step ended.
    pub fn follow_tracks(&mut self, simulation: &Simulation) {
        if let Some(last) = &self.last {
            let depths = || last.depths(&self.by, &self.columns);
            self.left.follow(simulation, &self.by, depths);
        }
    }

    /// What is remembered follows the initial motion and the parameters: its rates stay zero.
    pub fn settle(&mut self, simulation: &mut Simulation) {
        let now = self.linearise(simulation);
        let memory = self.by.nrows() - State::COUNT;
        let block = (State::COUNT, State::COUNT);
        let whole = now.by_state.view(block, (memory, memory)).into_owned();
        let settling = Settling::new(simulation, &whole);
        let rows: Vec<usize> = settling.places.iter().map(|k| State::COUNT + k).collect();
        // By everything but what settles.
        let mut others = self.by.clone();
        for row in &rows {
            others.row_mut(*row).fill(0.0);
        }
        let mut change = &now.by_state * &others;
        now.push(&mut change, &self.columns, &delayed(simulation));
        if let Some(by) = settling.solve(&change.select_rows(&rows)) {
            for (place, row) in rows.iter().enumerate() {
                self.by.row_mut(*row).copy_from(&-by.row(place));
            }
        }
        self.last = None;
        if simulation.model.has_ruts() {
            let now = self.linearise(simulation);
            let depths = now.depths(&self.by, &self.columns);
            let (state, wrench) = (simulation.state, &simulation.now.wrench);
            let poses = simulation.left.came_slopes(&state);
            simulation.left.came_here(&state, wrench);
            self.left.came_here(simulation, &poses, &self.by, &depths);
        }
    }

    /// Follows one accepted step of the integrator.
    pub fn advance(&mut self, simulation: &mut Simulation, step: f64) {
        self.follow_tracks(simulation);
        let end = self.linearise(simulation);
        let begin = self.last.take();
        let begin = begin.as_ref().unwrap_or(&end);
        let delayed = delayed(simulation);
        let rows = self.by.nrows();
        let identity = DMatrix::<f64>::identity(rows, rows);
        let early = begin.mixed(&end);
        let columns = self.columns;
        let mut by = self.by.columns_mut(0, columns.begun());
        let mut k1 = &early.by_state * &by;
        early.push(&mut k1, &columns, &delayed);
        let system = &identity - &early.by_state * (GAMMA * step);
        let solved = system.lu().solve_mut(&mut k1);
        let mut k2 = &end.by_state * (&by + &k1 * ((1.0 - GAMMA) * step));
        end.push(&mut k2, &columns, &delayed);
        let system = identity - &end.by_state * (GAMMA * step);
        let solved = system.lu().solve_mut(&mut k2) && solved;
        by += (&k1 * (1.0 - GAMMA) + &k2 * GAMMA) * step;
        self.length = step;
        self.slopes = [k1, k2];
        if !solved {
            self.by.fill(f64::NAN);
        }
        self.last = Some(end);
    }

    /// Derivatives of the state `back` seconds before the end of the last step.
    pub fn within(&self, back: f64) -> Derivatives {
        let mut by = self.by.fixed_rows::<{ State::COUNT }>(0).into_owned();
        if back > 0.0 && self.length > 0.0 {
            let passed = share(self.length, back);
            // The quadratic whose slopes at GAMMA and at the end are those of the stages.
            let first = (passed - 0.5 * passed * passed) / (1.0 - GAMMA);
            let second = passed - first;
            let shares = [first - (1.0 - GAMMA), second - GAMMA];
            for (slope, share) in self.slopes.iter().zip(shares) {
                let mut begun = by.columns_mut(0, slope.ncols());
                begun += slope.fixed_rows::<{ State::COUNT }>(0) * (share * self.length);
            }
        }
        Derivatives(by)
    }
}
