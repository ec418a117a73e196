//! A drive with the exact derivatives of its motion: by the initial state, by parameters of the
//! vehicle, the soil and the effects, and by a delay of the wheel speeds.

use super::last_step::LastStep;
use super::linearised::Columns;
use super::linearised::Derivatives;
use super::memory::directions;
use super::settled::check_course;
use super::slope_history::SlopeHistory;
use super::variation::{Variation, identity};
use super::{Simulation, SimulationError, State, WheelSpeeds};
use crate::parameter::ParameterError;
use crate::vehicle::{Direction, Directions, ModelParameter, Specification, VehicleModel};
use nalgebra::DMatrix;
use std::ops::ControlFlow;

/// A [`Simulation`] that carries the derivatives of its state along.
///
/// What is remembered has derivatives where it is there: those by an effect that would add a memory of its own
/// (`multipass`, `transient_shear`, `terrain_change` over the distance) are zero while it is off.
///
/// ```
/// use ugv_terrain::simulation::{SensitiveSimulation, WheelSpeeds};
/// use ugv_terrain::terrain::Terrain;
/// use ugv_terrain::vehicle::{ModelParameter, Specification, TerrainParameter, Vehicle};
///
/// let loam = Terrain::preset("sandy_loam").expect("one of the paper's terrains");
/// let model = Specification::plain(Vehicle::tran2007(), loam);
/// let friction = ModelParameter::Terrain(TerrainParameter::FrictionAngle);
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

impl SensitiveSimulation {
    /// A vehicle at rest at the origin; derivatives by these parameters.
    ///
    /// # Errors
    /// The first parameter of the specification that lies outside its range.
    pub fn new(
        specification: &Specification,
        parameters: &[ModelParameter],
    ) -> Result<Self, ParameterError> {
        Self::with_time_bins(specification, parameters, &[], 1)
    }

    /// As [`SensitiveSimulation::new`], with derivatives besides by `binned` parameters as they act
    /// in each of so many time bins, stretches of time that follow one another: see
    /// [`SensitiveSimulation::next_time_bin`]. Their sum is the derivative by a parameter that acts
    /// throughout. A parameter may be among both, or twice; without any time bin there is one.
    ///
    /// # Errors
    /// As [`SensitiveSimulation::new`].
    pub fn with_time_bins(
        specification: &Specification,
        parameters: &[ModelParameter],
        binned: &[ModelParameter],
        time_bins: usize,
    ) -> Result<Self, ParameterError> {
        let model = VehicleModel::from_specification(specification)?;
        let memory = model.memory_count();
        let mut list = directions(&model);
        let mut varied = parameters.iter().chain(binned);
        if varied.clone().any(|p| p.depends_on_place()) {
            let missing = Direction::POSE
                .into_iter()
                .filter(|pose| !list.contains(pose));
            list = list.iter().copied().chain(missing).collect();
        }
        let varied: Vec<Direction> = varied.by_ref().map(|p| Direction::Parameter(*p)).collect();
        for direction in &varied {
            if !list.contains(direction) {
                list.push(*direction);
            }
        }
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
            binned: binned.len(),
            time_bins: time_bins.max(1),
            time_bin: 0,
        };
        let directions = Directions::new(&model, list);
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
                left: SlopeHistory::default(),
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
    #[cfg(feature = "analysis")]
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
        self.variation.columns.time_bin = 0;
        self.variation.by = identity(memory, &self.variation.columns);
        self.variation.last = None;
        self.variation.length = 0.0;
        self.variation.left.clear();
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
            self.variation.follow_tracks(&self.simulation);
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
        self.settle_after(&[])
    }

    /// As [`Simulation::settle_after`]; the course is the same whatever the derivatives are by, but for the pose that it
    /// leads to.
    ///
    /// # Errors
    /// As [`Simulation::settle_after`].
    pub fn settle_after(&mut self, course: &[[f64; 3]]) -> Result<(), SimulationError> {
        check_course(course)?;
        if self.simulation.memory().is_empty() {
            return Ok(());
        }
        if let Err(error) = self.simulation.settle_arriving(course) {
            self.simulation.left.clear();
            return Err(error);
        }
        self.variation.settle(&mut self.simulation);
        Ok(())
    }

    /// Closes the open time bin and opens the next one; the last one stays open.
    pub fn next_time_bin(&mut self) {
        let columns = &mut self.variation.columns;
        if columns.time_bin + 1 < columns.time_bins {
            columns.time_bin += 1;
        }
    }

    /// Drives on for `seconds`.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step(&mut self, seconds: f64) -> Result<(), SimulationError> {
        self.step_looking(seconds, |_| ControlFlow::Continue(()))
    }

    /// As [`SensitiveSimulation::step`], with a look at each step that the integrator takes.
    ///
    /// # Errors
    /// As [`Simulation::step_looking`].
    pub fn step_looking(
        &mut self,
        seconds: f64,
        mut look: impl FnMut(&LastStep) -> ControlFlow<()>,
    ) -> Result<(), SimulationError> {
        let variation = &mut self.variation;
        if variation.last.is_none() {
            self.simulation.evaluate()?;
            variation.last = Some(variation.linearise(&mut self.simulation));
        }
        self.simulation.step_with(seconds, |simulation, length| {
            variation.advance(simulation, length);
            let step = LastStep {
                simulation,
                variation: Some(variation),
                length,
            };
            simulation.unless_broken(look(&step))
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
