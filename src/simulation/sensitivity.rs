//! A drive with the exact derivatives of its motion: by the initial state, by parameters of the
//! vehicle, the soil and the effects, and by a delay of the wheel speeds.
//!
//! The variational equation dZ/dt = A Z + B belongs to the motion dy/dt = f(y, u, p), A = df/dy and
//! B = df/dp exact at both ends of each of the integrator's steps (by dual numbers and the implicit
//! function theorem) and linear in between. It is integrated by Alexander's L-stable SDIRK method of
//! order 2 (R. Alexander, SIAM J. Numer. Anal. 14 (1977)).

use super::memory::directions;
use super::{Simulation, SimulationError, State, WheelSpeeds};
use crate::parameter::ParameterError;
use crate::vehicle::{
    Differentiated, Direction, Directions, Parameter, Specification, VehicleModel,
};
use nalgebra::{DMatrix, SMatrix};

/// gamma = 1 - 1/sqrt(2) of the method.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// A [`Simulation`] that carries the derivatives of its state along.
#[derive(Debug, Clone)]
pub struct SensitiveSimulation {
    simulation: Simulation,
    variation: Variation,
}

#[derive(Debug, Clone)]
struct Variation {
    directions: Directions,
    /// For each direction its place among the parameters, where it is one.
    places: Vec<Option<usize>>,
    results: Vec<Differentiated>,
    columns: Columns,
    /// Derivatives of the state and what is remembered (rows) by what [`Columns`] tells.
    by: DMatrix<f64>,
    /// A and B where the last step ended; B has the columns in use, from the delay on.
    last: Option<(DMatrix<f64>, DMatrix<f64>)>,
}

/// What the derivatives are taken by: the initial state, the delay of the wheel speeds, the
/// parameters that act throughout, and those that act in one gate after another, gate by gate.
#[derive(Debug, Clone, Copy)]
struct Columns {
    throughout: usize,
    gated: usize,
    gates: usize,
    /// The gate that is open.
    gate: usize,
}

const DELAY: usize = State::COUNT;

impl Columns {
    /// Column of a parameter's derivative in the gate that is open.
    fn parameter(&self, index: usize) -> usize {
        let gate = if index < self.throughout {
            0
        } else {
            self.gate * self.gated
        };
        DELAY + 1 + gate + index
    }

    fn all(&self) -> usize {
        DELAY + 1 + self.throughout + self.gated * self.gates
    }

    /// Number of columns that are not zero yet: all before the next gate's.
    fn begun(&self) -> usize {
        DELAY + 1 + self.throughout + self.gated * (self.gate + 1)
    }
}

impl SensitiveSimulation {
    /// A vehicle at rest at the origin; derivatives by these parameters.
    ///
    /// # Errors
    /// The first parameter of the specification that lies outside its range.
    pub fn new(
        specification: &Specification,
        parameters: &[Parameter],
    ) -> Result<Self, ParameterError> {
        Self::with_gates(specification, parameters, &[], 1)
    }

    /// As [`SensitiveSimulation::new`], with derivatives besides by `gated` parameters as they act
    /// in each of so many gates, stretches of time that follow one another: see
    /// [`SensitiveSimulation::next_gate`]. Their sum is the derivative by a parameter that acts
    /// throughout.
    ///
    /// # Errors
    /// As [`SensitiveSimulation::new`].
    pub fn with_gates(
        specification: &Specification,
        parameters: &[Parameter],
        gated: &[Parameter],
        gates: usize,
    ) -> Result<Self, ParameterError> {
        let model = VehicleModel::alterable(specification)?;
        let (memory, placeless) = (model.memory_count(), model.is_placeless());
        let mut list = directions(memory);
        let mut varied = parameters.iter().chain(gated);
        if placeless && !varied.clone().any(|p| p.depends_on_place()) {
            list.retain(|direction| !Direction::POSE.contains(direction));
        }
        let varied: Vec<Direction> = varied.by_ref().map(|p| Direction::Parameter(*p)).collect();
        list.extend(&varied);
        // Those that do not reach the wheels are differentiated together, which costs little.
        list.sort_by_key(|direction| !direction.reaches_wheels());
        let place = |direction: &Direction| varied.iter().position(|other| other == direction);
        let places = list.iter().map(place).collect();
        let columns = Columns {
            throughout: parameters.len(),
            gated: gated.len(),
            gates,
            gate: 0,
        };
        let directions = model.directions(list);
        Ok(Self {
            simulation: Simulation::new(model),
            variation: Variation {
                directions,
                places,
                results: Vec::new(),
                columns,
                by: identity(memory, &columns),
                last: None,
            },
        })
    }

    /// With derivatives from half the nodes in each direction of a contact: good to some 1e-3 of
    /// themselves, and two to three times as fast. The motion stays as it is.
    #[must_use]
    pub fn with_coarse_derivatives(mut self) -> Self {
        self.variation.directions.coarsen();
        self
    }

    /// As [`Simulation::limit_steps`].
    pub fn limit_steps(&mut self, most: u64) {
        self.simulation.limit_steps(most);
    }

    /// Begins anew at a time \[s\] and state, with nothing remembered.
    ///
    /// # Errors
    /// A value that is not finite; then nothing has changed.
    pub fn restart(&mut self, time: f64, state: State) -> Result<(), SimulationError> {
        self.simulation.set_state(state)?;
        self.simulation.forget();
        self.simulation.set_time(time);
        let memory = self.simulation.memory().len();
        self.variation.columns.gate = 0;
        self.variation.by = identity(memory, &self.variation.columns);
        self.variation.last = None;
        Ok(())
    }

    /// Sets the wheel speeds from now on and their rates within the next steps \[rad/s, rad/s^2\].
    ///
    /// # Errors
    /// A value that is not finite.
    pub fn drive(
        &mut self,
        speeds: WheelSpeeds,
        rates: WheelSpeeds,
    ) -> Result<(), SimulationError> {
        self.simulation.set_wheel_speeds(speeds)?;
        self.simulation.set_wheel_accelerations(rates)?;
        // B holds the rates.
        self.variation.last = None;
        Ok(())
    }

    /// Closes the open gate and opens the next one; the last one stays open.
    pub fn next_gate(&mut self) {
        let columns = &mut self.variation.columns;
        if columns.gate + 1 < columns.gates {
            columns.gate += 1;
            self.variation.last = None;
        }
    }

    /// Drives on for `seconds`.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step(&mut self, seconds: f64) -> Result<(), SimulationError> {
        let variation = &mut self.variation;
        if variation.last.is_none() {
            self.simulation.evaluate()?;
            variation.last = Some(variation.linearise(&self.simulation));
        }
        self.simulation.step_with(seconds, |simulation, step| {
            variation.advance(simulation, step);
            Ok(())
        })
    }

    /// Pose and velocities.
    #[must_use]
    pub fn state(&self) -> State {
        self.simulation.state()
    }

    /// Rate of change of the state, in the order of [`State::to_array`].
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn derivative(&mut self) -> Result<[f64; State::COUNT], SimulationError> {
        self.simulation.derivative()
    }

    /// Derivatives of the state by the state at the restart.
    #[must_use]
    pub fn by_initial(&self) -> SMatrix<f64, { State::COUNT }, { State::COUNT }> {
        self.variation
            .by
            .fixed_view::<{ State::COUNT }, { State::COUNT }>(0, 0)
            .into()
    }

    /// Derivative of the state by one of the parameters.
    #[must_use]
    pub fn by_parameter(&self, index: usize) -> [f64; State::COUNT] {
        let column = DELAY + 1 + index;
        std::array::from_fn(|row| self.variation.by[(row, column)])
    }

    /// Number of derivatives by parameters: those that act throughout, then the gated ones, gate
    /// by gate.
    #[must_use]
    pub fn parameter_count(&self) -> usize {
        self.variation.columns.all() - DELAY - 1
    }

    /// Derivative of the state by a delay of the wheel speeds \[per s\].
    #[must_use]
    pub fn by_wheel_delay(&self) -> [f64; State::COUNT] {
        std::array::from_fn(|row| self.variation.by[(row, DELAY)])
    }
}

fn identity(memory: usize, columns: &Columns) -> DMatrix<f64> {
    DMatrix::from_fn(State::COUNT + memory, columns.all(), |i, j| {
        f64::from(u8::from(i == j && j < State::COUNT))
    })
}

impl Variation {
    /// A and B at the simulation's present state.
    fn linearise(&mut self, simulation: &Simulation) -> (DMatrix<f64>, DMatrix<f64>) {
        simulation.differentiate(&self.directions, &mut self.results);
        let rows = self.by.nrows();
        let mut a = DMatrix::zeros(rows, rows);
        let mut b = DMatrix::zeros(rows, self.columns.begun() - DELAY);
        let kinematics = simulation.state().kinematic_jacobian().by_state;
        a.view_mut((0, 0), (State::COUNT, State::COUNT))
            .copy_from(&kinematics);
        let rates = simulation.input_rates();
        let directions = self.directions.list().iter().zip(&self.places);
        for ((direction, place), result) in directions.zip(&self.results) {
            let wrench = &result.wrench;
            let change = [wrench.a_x, wrench.a_y, wrench.yaw_acceleration];
            let change = (3..).zip(change);
            let change = change.chain((State::COUNT..).zip(result.memory_rates.iter().copied()));
            let (target, column, weight) = match *direction {
                Direction::Position(axis) => (&mut a, axis, 1.0),
                Direction::Heading => (&mut a, 2, 1.0),
                Direction::Velocity(axis) => (&mut a, 3 + axis, 1.0),
                Direction::YawRate => (&mut a, 5, 1.0),
                Direction::Memory(index) => (&mut a, State::COUNT + index, 1.0),
                // What came later came with the speed of before.
                Direction::WheelSpeed(side) => (&mut b, 0, -[rates.left, rates.right][side]),
                Direction::Time => continue,
                Direction::Parameter(_) => match place {
                    Some(place) => (&mut b, self.columns.parameter(*place) - DELAY, 1.0),
                    None => continue,
                },
            };
            for (row, value) in change {
                target[(row, column)] += weight * value;
            }
        }
        (a, b)
    }

    /// Follows one accepted step of the integrator.
    fn advance(&mut self, simulation: &Simulation, step: f64) {
        let (a1, b1) = self.linearise(simulation);
        let (a0, b0) = self.last.take().unwrap_or_else(|| (a1.clone(), b1.clone()));
        let rows = self.by.nrows();
        let identity = DMatrix::<f64>::identity(rows, rows);
        let a = &a0 * (1.0 - GAMMA) + &a1 * GAMMA;
        let mut by = self.by.columns_mut(0, self.columns.begun());
        let pushed = DELAY..self.columns.begun();
        let mut k1 = &a * &by;
        let mut rates = k1.columns_range_mut(pushed.clone());
        rates += &b0 * (1.0 - GAMMA) + &b1 * GAMMA;
        let solved = (&identity - &a * (GAMMA * step)).lu().solve_mut(&mut k1);
        let mut k2 = &a1 * (&by + &k1 * ((1.0 - GAMMA) * step));
        let mut rates = k2.columns_range_mut(pushed);
        rates += &b1;
        let solved = (identity - &a1 * (GAMMA * step)).lu().solve_mut(&mut k2) && solved;
        by += (k1 * (1.0 - GAMMA) + k2 * GAMMA) * step;
        if !solved {
            self.by.fill(f64::NAN);
        }
        self.last = Some((a1, b1));
    }
}
