//! Many simulations in one call.

use super::simulation::{Model, failed, state, value};
use crate::declaration::Variable;
use crate::simulation::batch::{self, Rollout, WheelSpeedTable};
use crate::simulation::{Simulation, State, WheelSpeeds};
use numpy::{
    IntoPyArray, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

/// States and outputs of each member, row by row, and why members ended early.
type Driven<'py> = (
    Bound<'py, PyArray3<f64>>,
    Bound<'py, PyArray3<f64>>,
    Vec<Option<String>>,
);

/// States of all after a step, and why some could not go on.
type Stepped<'py> = (Bound<'py, PyArray2<f64>>, Vec<Option<String>>);

/// A member of a batch.
struct Member {
    simulation: Simulation,
    inputs: Arc<WheelSpeedTable>,
    outputs: Vec<Variable>,
}

/// Numbers of a member, row by row; rows that it did not reach stay as they are.
struct Rows {
    states: Vec<f64>,
    outputs: Vec<f64>,
    error: Option<String>,
}

/// Drives each model over wheel speeds: `time` (n), `speeds` (1 or m, n, 2), `initial` (m, 6).
#[pyfunction]
pub fn rollout<'py>(
    py: Python<'py>,
    models: Vec<Py<Model>>,
    time: PyReadonlyArray1<f64>,
    speeds: PyReadonlyArray3<f64>,
    initial: PyReadonlyArray2<f64>,
    outputs: Vec<String>,
) -> PyResult<Driven<'py>> {
    let time = time.as_slice()?.to_vec();
    let rows = time.len();
    let table = |place: usize| -> PyResult<Arc<WheelSpeedTable>> {
        let speeds = speeds.as_slice()?[2 * rows * place..][..2 * rows].chunks_exact(2);
        let speeds = speeds.map(|pair| WheelSpeeds::from([pair[0], pair[1]]));
        let table = WheelSpeedTable::new(time.clone(), speeds.collect());
        let table = table.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Arc::new(table))
    };
    let tables = (0..speeds.shape()[0])
        .map(table)
        .collect::<PyResult<Vec<_>>>()?;
    let mut members = Vec::new();
    for (place, model) in models.iter().enumerate() {
        let model = model.get();
        let mut simulation = Simulation::new(model.model.clone());
        let initial = state(&initial.as_slice()?[State::COUNT * place..][..State::COUNT])?;
        simulation
            .set_state(initial)
            .map_err(|error| failed(&error))?;
        members.push(Member {
            simulation,
            inputs: tables[place % tables.len()].clone(),
            outputs: model.named(&outputs)?,
        });
    }
    let driven = py.detach(|| batch::each(&members, |member| drive(member, rows)));
    let (mut states, mut values, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for member in driven {
        states.extend(member.states);
        values.extend(member.outputs);
        errors.push(member.error);
    }
    let count = models.len();
    Ok((
        states
            .into_pyarray(py)
            .reshape([count, rows, State::COUNT])?,
        values
            .into_pyarray(py)
            .reshape([count, rows, outputs.len()])?,
        errors,
    ))
}

fn drive(member: &Member, rows: usize) -> Rows {
    let count = member.outputs.len();
    let mut rollout = Rollout {
        simulation: member.simulation.clone(),
        inputs: member.inputs.clone(),
    };
    let mut driven = Rows {
        states: vec![f64::NAN; rows * State::COUNT],
        outputs: vec![f64::NAN; rows * count],
        error: None,
    };
    let end = rollout.run(|row, simulation| {
        let state = simulation.state().to_array();
        driven.states[row * State::COUNT..][..State::COUNT].copy_from_slice(&state);
        for (place, output) in member.outputs.iter().enumerate() {
            driven.outputs[row * count + place] = value(output, simulation)?;
        }
        Ok(())
    });
    driven.error = end.err().map(|error| error.to_string());
    driven
}

/// Simulations that are stepped together, as a learner does.
#[pyclass(module = "ugv_terrain._native")]
pub struct Batch {
    models: Vec<Py<Model>>,
    simulations: Vec<Simulation>,
}

#[pymethods]
impl Batch {
    #[new]
    fn new(models: Vec<Py<Model>>) -> Self {
        let new = |model: &Py<Model>| Simulation::new(model.get().model.clone());
        Self {
            simulations: models.iter().map(new).collect(),
            models,
        }
    }

    fn __len__(&self) -> usize {
        self.simulations.len()
    }

    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let states = self.simulations.iter();
        let states: Vec<f64> = states.flat_map(|one| one.state().to_array()).collect();
        states
            .into_pyarray(py)
            .reshape([self.simulations.len(), State::COUNT])
    }

    /// Steps all by `seconds` under the wheel speeds (m, 2), which are held. An error names those that could not go on.
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        seconds: f64,
        speeds: PyReadonlyArray2<f64>,
    ) -> PyResult<Stepped<'py>> {
        let speeds = speeds.as_slice()?.to_vec();
        let simulations = &mut self.simulations;
        let results = py.detach(|| {
            batch::step(simulations, seconds, |place, _| {
                Ok(WheelSpeeds::from([
                    speeds[2 * place],
                    speeds[2 * place + 1],
                ]))
            })
        });
        let errors = results.into_iter();
        let errors = errors.map(|result| result.err().map(|error| error.to_string()));
        Ok((self.states(py)?, errors.collect()))
    }

    /// Begins one anew, at rest on untouched ground in a state.
    fn restart(&mut self, place: usize, initial: PyReadonlyArray1<f64>) -> PyResult<()> {
        let Some(model) = self.models.get(place) else {
            let count = self.models.len();
            return Err(PyValueError::new_err(format!(
                "there is no simulation {place} among {count}"
            )));
        };
        let mut simulation = Simulation::new(model.get().model.clone());
        let initial = state(initial.as_slice()?)?;
        simulation
            .set_state(initial)
            .map_err(|error| failed(&error))?;
        self.simulations[place] = simulation;
        Ok(())
    }
}
