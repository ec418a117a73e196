//! The Python package `ugv_terrain`: this module is its native part, `ugv_terrain._native`; what its users see is written
//! in Python, in the folder `ugv_terrain` beside this file.
//!
//! Numbers cross as NumPy arrays of float64, descriptions as JSON, answers as the texts of the tool's files. Work runs
//! without the interpreter's lock.

mod batch;
mod command;
mod simulation;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::batch::{Batch, rollout};
    #[pymodule_export]
    use super::command::{answer, effects, terrain_presets};
    #[pymodule_export]
    use super::simulation::{Model, Simulation, SimulationError, terrain, tran2007, vehicle};
}
