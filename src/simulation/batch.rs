//! Many simulations in one call, on all threads.

use super::{Simulation, SimulationError, State, WheelSpeeds};
use rayon::prelude::*;
use std::sync::Arc;
use thiserror::Error;

/// Wheel speeds over time, linear in between; at least one row.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelSpeedTable {
    time: Vec<f64>,
    speeds: Vec<WheelSpeeds>,
}

/// Why rows are no table of wheel speeds.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TableError {
    /// There is no row.
    #[error("the table of wheel speeds has no row")]
    Empty,
    /// Another number of times than of wheel speeds.
    #[error("the table of wheel speeds has {times} times and {speeds} rows of wheel speeds")]
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of wheel speeds.
        speeds: usize,
    },
    /// A time that is not finite, or not after the one before \[s\].
    #[error(
        "row {row} of the wheel speeds: time {time} s is not finite, or not after the row before"
    )]
    Time {
        /// Row, from 0.
        row: usize,
        /// Its time \[s\].
        time: f64,
    },
    /// A wheel speed that is not finite \[rad/s\].
    #[error("row {row} of the wheel speeds: {left} and {right} rad/s are not both finite")]
    Speed {
        /// Row, from 0.
        row: usize,
        /// Speed of the left wheels \[rad/s\].
        left: f64,
        /// Speed of the right wheels \[rad/s\].
        right: f64,
    },
}

impl WheelSpeedTable {
    /// From the time \[s\] and the wheel speeds \[rad/s\] of each row. Only differences of the times count.
    ///
    /// # Errors
    /// No row, columns of different lengths, times that do not increase, or a value that is not finite.
    pub fn new(time: Vec<f64>, speeds: Vec<WheelSpeeds>) -> Result<Self, TableError> {
        if time.len() != speeds.len() {
            return Err(TableError::Lengths {
                times: time.len(),
                speeds: speeds.len(),
            });
        }
        if time.is_empty() {
            return Err(TableError::Empty);
        }
        for (row, (&now, WheelSpeeds { left, right })) in time.iter().zip(&speeds).enumerate() {
            if !now.is_finite() || row > 0 && now <= time[row - 1] {
                return Err(TableError::Time { row, time: now });
            }
            if !(left.is_finite() && right.is_finite()) {
                let (left, right) = (*left, *right);
                return Err(TableError::Speed { row, left, right });
            }
        }
        Ok(Self { time, speeds })
    }

    /// Time of each row \[s\], increasing.
    #[must_use]
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Wheel speeds in each row \[rad/s\].
    #[must_use]
    pub fn wheel_speeds(&self) -> &[WheelSpeeds] {
        &self.speeds
    }

    /// Time from the first row to this one \[s\].
    fn since_start(&self, row: usize) -> f64 {
        self.time[row] - self.time[0]
    }

    /// Rates of the wheel speeds from this row to the next \[rad/s^2\].
    fn rates(&self, row: usize) -> WheelSpeeds {
        let seconds = self.time[row + 1] - self.time[row];
        let (from, to) = (self.speeds[row], self.speeds[row + 1]);
        WheelSpeeds {
            left: (to.left - from.left) / seconds,
            right: (to.right - from.right) / seconds,
        }
    }
}

/// A simulation and the wheel speeds that drive it: a member of a batch.
#[derive(Debug, Clone)]
pub struct Rollout {
    /// Where it starts; after the drive, where it stands.
    pub simulation: Simulation,
    /// Wheel speeds from its present time on; members may share them.
    pub inputs: Arc<WheelSpeedTable>,
}

impl Rollout {
    /// Drives to the end of the wheel speeds as an importer steps the FMU: at each row it sets the wheel speeds and
    /// their rates, and steps to the next. `visit` sees the number of each row from 0, and the simulation there.
    ///
    /// # Errors
    /// As [`Simulation::step`], or the error of `visit`. The simulation stands at the last point that it reached.
    pub fn run(
        &mut self,
        mut visit: impl FnMut(usize, &mut Simulation) -> Result<(), SimulationError>,
    ) -> Result<(), SimulationError> {
        let (simulation, inputs) = (&mut self.simulation, &self.inputs);
        let start = simulation.time();
        simulation.set_wheel_speeds(inputs.speeds[0])?;
        visit(0, simulation)?;
        for row in 1..inputs.time.len() {
            simulation.set_wheel_speeds(inputs.speeds[row - 1])?;
            simulation.set_time(start + inputs.since_start(row - 1))?;
            simulation.set_wheel_accelerations(inputs.rates(row - 1))?;
            simulation.step(inputs.time[row] - inputs.time[row - 1])?;
            visit(row, simulation)?;
        }
        Ok(())
    }

    /// Drives to the end of the wheel speeds, and returns the states on the way.
    #[must_use]
    pub fn trajectory(&mut self) -> Trajectory {
        let mut trajectory = Trajectory::default();
        let inputs = self.inputs.clone();
        let driven = self.run(|row, simulation| {
            trajectory.time.push(inputs.since_start(row));
            trajectory.states.push(simulation.state());
            Ok(())
        });
        trajectory.error = driven.err();
        trajectory
    }
}

/// Pose and velocities at each row of the wheel speeds that a member of a batch reached.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectory {
    /// Time from the first row \[s\].
    pub time: Vec<f64>,
    /// Pose and velocities.
    pub states: Vec<State>,
    /// Why it ended before the last row, if it did.
    pub error: Option<SimulationError>,
}

/// Drives all members, and returns their trajectories in the order of the members.
///
/// The threads are those of rayon's current pool. The bits do not depend on their number, and equal those of one
/// member after the other. An error ends the drive of one member only. Afterwards each simulation stands at the last
/// point that it reached.
///
/// ```
/// use std::sync::Arc;
/// use ugv_terrain::simulation::batch::{Rollout, WheelSpeedTable, trajectories};
/// use ugv_terrain::simulation::{Simulation, WheelSpeeds};
/// use ugv_terrain::terrain::Terrain;
/// use ugv_terrain::vehicle::{Vehicle, VehicleModel};
///
/// // Straight ahead, then a turn to the left: times [s], wheel speeds [rad/s].
/// let speeds = [[0.0, 0.0], [6.0, 6.0], [5.0, 7.0]].map(WheelSpeeds::from);
/// let inputs = Arc::new(WheelSpeedTable::new(vec![0.0, 2.0, 4.0], speeds.to_vec())?);
/// let mut members = Vec::new();
/// for soil in Terrain::PRESETS {
///     let soil = Terrain::preset(soil).expect("one of the paper's terrains");
///     let simulation = Simulation::new(VehicleModel::new(Vehicle::tran2007(), soil)?);
///     members.push(Rollout { simulation, inputs: inputs.clone() });
/// }
/// for drive in trajectories(&mut members) {
///     let end = drive.states.last().expect("a state for each row");
///     println!("after {} s: {:.2} m east, {:.2} rad", drive.time[2], end.x, end.heading);
///     assert!(drive.error.is_none() && end.x > 1.0 && end.heading > 0.0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn trajectories(members: &mut [Rollout]) -> Vec<Trajectory> {
    members.par_iter_mut().map(Rollout::trajectory).collect()
}

/// As [`trajectories`], for members that are made where they are driven, and for other outputs than the states.
///
/// `drive` makes the [`Rollout`] of a member, runs it, and returns what is wanted of it. So a sweep of thousands needs
/// the memory of as many simulations as there are threads.
pub fn each<M: Sync, T: Send>(members: &[M], drive: impl Fn(&M) -> T + Sync) -> Vec<T> {
    members.par_iter().map(&drive).collect()
}

/// Steps all simulations by `seconds`, and returns their states in the same order. `control` gives the wheel speeds
/// \[rad/s\] that a simulation holds during the step, from its place in the batch and from what it reads there: the
/// policy of a learner.
///
/// Threads and bits are as with [`trajectories`].
///
/// # Errors
/// Each simulation has its result, [`SimulationError`] as of [`Simulation::step`] or of `control`; the others go on.
pub fn step(
    simulations: &mut [Simulation],
    seconds: f64,
    control: impl Fn(usize, &mut Simulation) -> Result<WheelSpeeds, SimulationError> + Sync,
) -> Vec<Result<State, SimulationError>> {
    let one = |(place, simulation): (usize, &mut Simulation)| {
        let speeds = control(place, simulation)?;
        simulation.set_wheel_speeds(speeds)?;
        simulation.set_wheel_accelerations(WheelSpeeds::default())?;
        simulation.step(seconds)?;
        Ok(simulation.state())
    };
    simulations.par_iter_mut().enumerate().map(one).collect()
}
