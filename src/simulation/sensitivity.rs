//! A drive with the exact derivatives of its motion: by the initial state, by parameters of the
//! vehicle, the soil and the effects, and by a delay of the wheel speeds.
//!
//! The variational equation dZ/dt = A Z + B belongs to the motion dy/dt = f(y, u, p), A = df/dy and
//! B = df/dp exact at both ends of each of the integrator's steps (by dual numbers and the implicit
//! function theorem) and linear in between. It is integrated by Alexander's L-stable SDIRK method of
//! order 2 (R. Alexander, SIAM J. Numer. Anal. 14 (1977)).

use super::last_step::{Derivatives, LastStep, share};
use super::linearised::{Columns, Linearised};
use super::memory::directions;
use super::settled::Settling;
use super::{Simulation, SimulationError, State, WheelSpeeds};
use crate::parameter::ParameterError;
use crate::vehicle::{
    Differentiated, Direction, Directions, Parameter, Specification, VehicleModel,
};
use nalgebra::{DMatrix, Vector2};

/// gamma = 1 - 1/sqrt(2) of the method.
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// A [`Simulation`] that carries the derivatives of its state along.
///
/// ```
/// use ugv_terrain::simulation::{SensitiveSimulation, WheelSpeeds};
/// use ugv_terrain::terrain::Terrain;
/// use ugv_terrain::vehicle::{Parameter, Specification, TerrainParameter, Vehicle};
///
/// let loam = Terrain::preset("sandy_loam").expect("one of the paper's terrains");
/// let model = Specification::plain(Vehicle::tran2007(), loam);
/// let friction = Parameter::Terrain(TerrainParameter::FrictionAngle);
/// let mut drive = SensitiveSimulation::new(&model, &[friction])?;
/// drive.drive(WheelSpeeds { left: 8.0, right: 6.0 }, WheelSpeeds::default())?;
/// drive.step(2.0)?;
/// // Of x, y, heading, v_x, v_y, yaw_rate by the angle: with more friction it comes further.
/// let [x, ..] = drive.derivatives().by_parameter(0);
/// assert!(x > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SensitiveSimulation {
    simulation: Simulation,
    variation: Variation,
}

#[derive(Debug, Clone)]
pub(super) struct Variation {
    directions: Directions,
    /// For each direction its places among the parameters, where it is one.
    places: Vec<Vec<usize>>,
    results: Vec<Differentiated>,
    columns: Columns,
    /// Derivatives of the state and what is remembered (rows) by what [`Columns`] tells.
    by: DMatrix<f64>,
    /// Where the last step ended.
    last: Option<Linearised>,
    /// The last step's length \[s\] and the slopes of its two stages, in the columns then in use.
    length: f64,
    slopes: [DMatrix<f64>; 2],
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
    /// throughout. A parameter may be among both, or twice; without any gate there is one.
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
        for direction in &varied {
            if !list.contains(direction) {
                list.push(*direction);
            }
        }
        // Those that do not reach the wheels are differentiated together, which costs little.
        list.sort_by_key(|direction| !direction.reaches_wheels());
        let places = |direction: &Direction| {
            let columns = varied.iter().enumerate();
            columns
                .filter(|(_, other)| *other == direction)
                .map(|(column, _)| column)
                .collect()
        };
        let places = list.iter().map(places).collect();
        let columns = Columns {
            throughout: parameters.len(),
            gated: gated.len(),
            gates: gates.max(1),
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
                length: 0.0,
                slopes: [DMatrix::zeros(0, 0), DMatrix::zeros(0, 0)],
            },
        })
    }

    /// With derivatives from half the nodes in each direction of a contact: good to some 1e-3 of
    /// themselves, and two to three times as fast. The motion stays as it is within the integrator's
    /// tolerance.
    #[must_use]
    pub fn with_coarse_derivatives(mut self) -> Self {
        self.variation.directions.coarsen();
        self
    }

    /// As [`Simulation::limit_steps`].
    pub fn limit_steps(&mut self, most: u64) {
        self.simulation.limit_steps(most);
    }

    /// As [`Simulation::tolerate`].
    pub(crate) fn tolerate(&mut self, times: f64) {
        self.simulation.tolerate(times);
    }

    /// Begins anew at a time \[s\] and state, with nothing remembered.
    ///
    /// # Errors
    /// A value that is not finite; then nothing has changed.
    pub fn restart(&mut self, time: f64, state: State) -> Result<(), SimulationError> {
        let before = self.simulation.time();
        self.simulation.set_time(time)?;
        if let Err(error) = self.simulation.set_state(state) {
            self.simulation.set_time(before)?;
            return Err(error);
        }
        self.simulation.forget();
        let memory = self.simulation.memory().len();
        self.variation.columns.gate = 0;
        self.variation.by = identity(memory, &self.variation.columns);
        self.variation.last = None;
        self.variation.length = 0.0;
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
        if !speeds.is_nearly(self.simulation.wheel_speeds()) {
            self.variation.last = None;
        }
        self.simulation.set_wheel_speeds(speeds)?;
        self.simulation.set_wheel_accelerations(rates)
    }

    /// As [`Simulation::settle`].
    ///
    /// # Errors
    /// As [`Simulation::settle`].
    pub fn settle(&mut self) -> Result<(), SimulationError> {
        self.simulation.settle()?;
        if !self.simulation.memory().is_empty() {
            self.variation.settle(&mut self.simulation);
        }
        Ok(())
    }

    /// Closes the open gate and opens the next one; the last one stays open.
    pub fn next_gate(&mut self) {
        let columns = &mut self.variation.columns;
        if columns.gate + 1 < columns.gates {
            columns.gate += 1;
        }
    }

    /// Drives on for `seconds`.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step(&mut self, seconds: f64) -> Result<(), SimulationError> {
        self.step_looking(seconds, |_| ())
    }

    /// As [`SensitiveSimulation::step`], with a look at each step that the integrator takes.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step_looking(
        &mut self,
        seconds: f64,
        mut look: impl FnMut(&LastStep),
    ) -> Result<(), SimulationError> {
        let variation = &mut self.variation;
        if variation.last.is_none() {
            self.simulation.evaluate()?;
            variation.last = Some(variation.linearise(&mut self.simulation));
        }
        self.simulation.step_with(seconds, |simulation, length| {
            variation.advance(simulation, length);
            look(&LastStep {
                simulation,
                variation: Some(variation),
                length,
            });
            Ok(())
        })
    }

    /// Pose and velocities.
    #[must_use]
    pub fn state(&self) -> State {
        self.simulation.state()
    }

    /// The simulation that is driven.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Rate of change of the state, in the order of [`State::to_array`].
    ///
    /// # Errors
    /// As [`Simulation::wrench`].
    pub fn derivative(&mut self) -> Result<[f64; State::COUNT], SimulationError> {
        self.simulation.derivative()
    }

    /// Derivatives of the state.
    #[must_use]
    pub fn derivatives(&self) -> Derivatives {
        self.variation.within(0.0)
    }
}

fn identity(memory: usize, columns: &Columns) -> DMatrix<f64> {
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
    /// At the simulation's present state, for the integrator as well.
    fn linearise(&mut self, simulation: &mut Simulation) -> Linearised {
        simulation.differentiate(&self.directions, &mut self.results);
        simulation.take_jacobian(self.directions.list(), &self.results);
        let rows = self.by.nrows();
        let mut by_state = DMatrix::zeros(rows, rows);
        let mut by_speeds = DMatrix::zeros(rows, 2);
        let parameters = self.columns.throughout + self.columns.gated;
        let mut by_parameters = DMatrix::zeros(rows, parameters);
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
                    }
                    continue;
                }
            };
            for (row, value) in change {
                target[(row, column)] += value;
            }
        }
        Linearised {
            by_state,
            by_speeds,
            by_parameters,
        }
    }

    /// What is remembered follows the beginning's motion and the parameters: its rates stay zero.
    fn settle(&mut self, simulation: &mut Simulation) {
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
    }

    /// Follows one accepted step of the integrator.
    fn advance(&mut self, simulation: &mut Simulation, step: f64) {
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
