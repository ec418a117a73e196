//! Descriptions, models and single simulations.

use crate::declaration::{Causality, Configuration, Variable, variables};
use crate::json::JsonError;
use crate::simulation::{self, State, WheelSpeeds};
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle, VehicleModel};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

create_exception!(
    ugv_terrain,
    SimulationError,
    PyRuntimeError,
    "The vehicle cannot drive on: it sinks in, tips over, or the inputs are not finite."
);

/// The error of a description.
fn refused(error: &JsonError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The error of a drive; numbers that are not finite are wrong arguments.
pub fn failed(error: &simulation::SimulationError) -> PyErr {
    match error {
        simulation::SimulationError::NotFinite { .. } => PyValueError::new_err(error.to_string()),
        _ => SimulationError::new_err(error.to_string()),
    }
}

/// The vehicle of Tran et al. (2007) as JSON.
#[pyfunction]
pub fn tran2007() -> String {
    Vehicle::tran2007().to_json()
}

/// A vehicle's JSON, checked.
#[pyfunction]
pub fn vehicle(text: &str) -> PyResult<String> {
    let vehicle = Vehicle::from_json(text).map_err(|error| refused(&error))?;
    Ok(vehicle.to_json())
}

/// A terrain's JSON, or the name of one in quotes, checked.
#[pyfunction]
pub fn terrain(text: &str) -> PyResult<String> {
    let terrain = Terrain::from_json(text).map_err(|error| refused(&error))?;
    Ok(terrain.to_json())
}

/// A vehicle on a terrain with effects.
#[pyclass(frozen, module = "ugv_terrain._native")]
pub struct Model {
    pub specification: Specification,
    pub model: Arc<VehicleModel>,
    /// Inputs and outputs, as the FMU has them.
    outputs: Vec<Variable>,
}

#[pymethods]
impl Model {
    /// From JSON of the format `ugv-model/1`.
    #[new]
    fn new(text: &str) -> PyResult<Self> {
        let specification = Specification::from_json(text).map_err(|error| refused(&error))?;
        let model = VehicleModel::from_specification(&specification)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let configuration = Configuration {
            vehicle: specification.vehicle.clone(),
            ..Configuration::default()
        };
        let mut outputs = variables(&configuration);
        outputs.retain(|variable| variable.attributes.causality == Causality::Output);
        Ok(Self {
            model: Arc::new(model),
            specification,
            outputs,
        })
    }

    fn to_json(&self) -> String {
        self.specification.to_json()
    }

    /// Names of the outputs.
    pub fn outputs(&self) -> Vec<&str> {
        let names = self.outputs.iter();
        names.map(|variable| variable.name.as_str()).collect()
    }
}

impl Model {
    /// The outputs with these names.
    pub fn named(&self, names: &[String]) -> PyResult<Vec<Variable>> {
        let find = |name: &String| {
            let mut outputs = self.outputs.iter();
            let found = outputs.find(|variable| variable.name == *name).cloned();
            found.ok_or_else(|| {
                let all = self.outputs().join(", ");
                PyValueError::new_err(format!("there is no output `{name}`; there are {all}"))
            })
        };
        names.iter().map(find).collect()
    }
}

/// The value of an output.
pub fn value(
    output: &Variable,
    simulation: &mut simulation::Simulation,
) -> Result<f64, simulation::SimulationError> {
    let (speeds, state) = (simulation.wheel_speeds(), simulation.state());
    let wrench = simulation.wrench()?;
    Ok(output
        .quantity
        .output(speeds, state, wrench)
        .unwrap_or(f64::NAN))
}

/// Six numbers of a state.
pub fn state(numbers: &[f64]) -> PyResult<State> {
    let numbers: [f64; State::COUNT] = numbers.try_into().map_err(|_| {
        PyValueError::new_err(format!(
            "a state has 6 numbers (x, y, heading, v_x, v_y, yaw_rate), not {}",
            numbers.len()
        ))
    })?;
    Ok(State::from_array(numbers))
}

/// A drive, step by step.
#[pyclass(module = "ugv_terrain._native")]
pub struct Simulation {
    model: Py<Model>,
    simulation: simulation::Simulation,
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (model, initial = None))]
    fn new(model: Py<Model>, initial: Option<PyReadonlyArray1<f64>>) -> PyResult<Self> {
        let mut simulation = simulation::Simulation::new(model.get().model.clone());
        if let Some(initial) = initial {
            let initial = state(initial.as_slice()?)?;
            simulation
                .set_state(initial)
                .map_err(|error| failed(&error))?;
        }
        Ok(Self { model, simulation })
    }

    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    #[getter]
    fn time(&self) -> f64 {
        self.simulation.time()
    }

    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.simulation.state().to_array())
    }

    #[setter]
    fn set_state(&mut self, numbers: PyReadonlyArray1<f64>) -> PyResult<()> {
        let numbers = state(numbers.as_slice()?)?;
        let set = self.simulation.set_state(numbers);
        set.map_err(|error| failed(&error))
    }

    fn step<'py>(
        &mut self,
        py: Python<'py>,
        seconds: f64,
        speeds: [f64; 2],
        rates: [f64; 2],
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let simulation = &mut self.simulation;
        let stepped = py.detach(|| {
            simulation.set_wheel_speeds(WheelSpeeds::from(speeds))?;
            simulation.set_wheel_accelerations(WheelSpeeds::from(rates))?;
            simulation.step(seconds)
        });
        stepped.map_err(|error| failed(&error))?;
        Ok(self.state(py))
    }

    fn outputs<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = PyDict::new(py);
        for output in &self.model.get().outputs {
            let value = value(output, &mut self.simulation).map_err(|error| failed(&error))?;
            values.set_item(&output.name, value)?;
        }
        Ok(values)
    }

    fn copy(&self, py: Python<'_>) -> Self {
        Self {
            model: self.model.clone_ref(py),
            simulation: self.simulation.clone(),
        }
    }
}
