//! Models that predict where a window ends.

use super::{Kinematics, Window};
use crate::simulation::{Simulation, SimulationError};
use crate::vehicle::VehicleModel;
use std::sync::Arc;

/// A model that predicts from a window's start and its wheel speeds.
#[derive(Debug, Clone)]
pub enum Predictor {
    /// Velocities follow from the wheel speeds alone.
    Kinematics(Kinematics),
    /// The wheel–terrain model.
    Soil(Arc<VehicleModel>),
}

impl Predictor {
    /// x \[m\], y \[m\] and heading \[rad\] at the end of a window.
    ///
    /// # Errors
    /// A vehicle that cannot drive on; times are from the window's start.
    pub fn predict(&self, window: &Window) -> Result<[f64; 3], SimulationError> {
        match self {
            Self::Kinematics(kinematics) => Ok(kinematics.predict(window)),
            Self::Soil(model) => simulate(model, window),
        }
    }
}

fn simulate(model: &Arc<VehicleModel>, window: &Window) -> Result<[f64; 3], SimulationError> {
    let mut simulation = Simulation::new(Arc::clone(model));
    simulation.set_state(window.state)?;
    let wheels = &window.wheels;
    for row in 0..wheels.len() - 1 {
        simulation.set_wheel_speeds(wheels.wheel_speeds(row).into())?;
        simulation.set_wheel_accelerations(wheels.wheel_accelerations(row).into())?;
        if row == 0 {
            // The window begins in the midst of a drive.
            simulation.settle_after(&window.course)?;
        }
        simulation.step(wheels.time[row + 1] - wheels.time[row])?;
    }
    let state = simulation.state();
    Ok([state.x, state.y, state.heading])
}
