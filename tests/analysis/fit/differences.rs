//! Trajectories whose derivatives are central differences of simulations.

use std::sync::Arc;
use ugv_terrain::fit::predictor::{PredictionError, Predictor, Request, Trajectory};
use ugv_terrain::recording::Drive;
use ugv_terrain::simulation::{Simulation, State, WheelSpeeds};
use ugv_terrain::vehicle::{ModelParameter, Specification, VehicleModel};

/// Steps of the differences: velocities of the start \[m/s, rad/s\], and parameters (share of
/// the value, or of one where it is small). Large against the integrator's tolerance of 1e-4,
/// small against what the motion's curvature would notice.
const VELOCITY_STEP: f64 = 0.02;
const PARAMETER_STEP: f64 = 0.05;

/// Predicts by [`Simulation`], once for each derivative and side.
#[derive(Debug, Clone)]
pub struct DifferencePredictor {
    nominal: Specification,
    free: Vec<ModelParameter>,
}

impl DifferencePredictor {
    /// A model with free parameters, the check of the exact derivatives.
    #[must_use]
    pub fn new(nominal: Specification, free: Vec<ModelParameter>) -> Self {
        Self { nominal, free }
    }

    /// The model with other values of the free parameters.
    #[must_use]
    pub fn with(&self, values: &[f64]) -> Specification {
        let mut nominal = self.nominal.clone();
        for (parameter, &value) in self.free.iter().zip(values) {
            parameter.set(&mut nominal, value).unwrap();
        }
        nominal
    }

    fn model(&self, values: &[f64]) -> Result<Arc<VehicleModel>, PredictionError> {
        Ok(Arc::new(VehicleModel::from_specification(
            &self.with(values),
        )?))
    }
}

impl Predictor for DifferencePredictor {
    fn parameters(&self) -> usize {
        self.free.len()
    }

    fn held(&self, parameters: &[f64]) -> Result<Self, PredictionError> {
        Ok(Self::new(self.with(parameters), Vec::new()))
    }

    fn predict(&self, request: &Request, out: &mut Trajectory) -> Result<(), PredictionError> {
        out.clear();
        let model = self.model(request.parameters)?;
        simulate(&model, request, request.start, |simulation| {
            out.states.push(simulation.state().to_array());
            out.rates.push(simulation.derivative()?);
            Ok(())
        })?;
        if !request.derivatives {
            return Ok(());
        }
        self.by_start(&model, request, out)?;
        out.by_wheel_latency = (0..request.times.len())
            .map(|k| by_wheel_latency(out, k))
            .collect();
        self.by_parameter(request, out)
    }
}

impl DifferencePredictor {
    /// On flat, homogeneous ground the pose at the start moves and turns the whole path;
    /// only the velocities need differences.
    fn by_start(
        &self,
        model: &Arc<VehicleModel>,
        request: &Request,
        out: &mut Trajectory,
    ) -> Result<(), PredictionError> {
        let start = request.start.to_array();
        out.by_start.extend(out.states.iter().map(|state| {
            let mut columns = [[0.0; 6]; 6];
            columns[0][0] = 1.0;
            columns[1][1] = 1.0;
            columns[2] = [start[1] - state[1], state[0] - start[0], 1.0, 0.0, 0.0, 0.0];
            columns
        }));
        for component in 3..6 {
            let shifted = |step: f64| {
                let mut start = start;
                start[component] += step;
                states(model, request, &State::from_array(start))
            };
            let (above, below) = (shifted(VELOCITY_STEP)?, shifted(-VELOCITY_STEP)?);
            for (columns, (a, b)) in out.by_start.iter_mut().zip(above.iter().zip(&below)) {
                columns[component] = quotient(a, b, 2.0 * VELOCITY_STEP);
            }
        }
        Ok(())
    }

    fn by_parameter(&self, request: &Request, out: &mut Trajectory) -> Result<(), PredictionError> {
        let count = self.free.len();
        out.by_parameter = vec![[0.0; 6]; count * request.times.len()];
        for index in 0..count {
            let value = request.parameters[index];
            let step = PARAMETER_STEP * if value == 0.0 { 1.0 } else { value.abs() };
            let shifted = |step: f64| {
                let mut values = request.parameters.to_vec();
                values[index] += step;
                states(&self.model(&values)?, request, request.start)
            };
            let (above, below) = (shifted(step)?, shifted(-step)?);
            for (time, (a, b)) in above.iter().zip(&below).enumerate() {
                out.by_parameter[time * count + index] = quotient(a, b, 2.0 * step);
            }
        }
        Ok(())
    }
}

/// A model that knows no clock but the wheels' moves along the drive when the latency grows:
/// dx(t)/dL = dx/dt(t) - Phi(t, t0) dx/dt(t0), with the transition matrix Phi.
fn by_wheel_latency(out: &Trajectory, index: usize) -> [f64; 6] {
    let mut derivative = out.rates[index];
    for (column, rate) in out.by_start[index].iter().zip(out.rates[0]) {
        for (sum, slope) in derivative.iter_mut().zip(column) {
            *sum -= slope * rate;
        }
    }
    derivative
}

fn quotient(above: &[f64; 6], below: &[f64; 6], width: f64) -> [f64; 6] {
    std::array::from_fn(|k| (above[k] - below[k]) / width)
}

fn states(
    model: &Arc<VehicleModel>,
    request: &Request,
    start: &State,
) -> Result<Vec<[f64; 6]>, PredictionError> {
    let mut states = Vec::with_capacity(request.times.len());
    simulate(model, request, start, |simulation| {
        states.push(simulation.state().to_array());
        Ok(())
    })?;
    Ok(states)
}

/// Drives along the wheel speeds and looks at each of the times.
fn simulate(
    model: &Arc<VehicleModel>,
    request: &Request,
    start: &State,
    mut look: impl FnMut(&mut Simulation) -> Result<(), PredictionError>,
) -> Result<(), PredictionError> {
    let mut simulation = Simulation::new(model.clone());
    simulation.set_state(*start)?;
    let Some(&begin) = request.times.first() else {
        return Ok(());
    };
    let drive = request.drive;
    let mut now = begin + request.wheel_latency;
    let mut row = drive.time.partition_point(|time| *time <= now);
    for time in request.times {
        let target = time + request.wheel_latency;
        loop {
            let (speeds, rates) = wheels(drive, row, now);
            simulation.set_wheel_speeds(speeds)?;
            simulation.set_wheel_accelerations(rates)?;
            let next = drive.time.get(row).copied().unwrap_or(f64::INFINITY);
            if next > target {
                break;
            }
            simulation.step((next - now).max(0.0))?;
            now = next;
            row += 1;
        }
        simulation.step((target - now).max(0.0))?;
        now = target;
        look(&mut simulation)?;
    }
    Ok(())
}

/// Wheel speeds and their rates at a time between row - 1 and `row`.
fn wheels(drive: &Drive, row: usize, time: f64) -> (WheelSpeeds, WheelSpeeds) {
    let Some(before) = row.checked_sub(1) else {
        return (drive.wheel_speeds(0).into(), WheelSpeeds::default());
    };
    let rates = WheelSpeeds::from(drive.wheel_accelerations(before));
    let speeds = WheelSpeeds::from(drive.wheel_speeds(before));
    (speeds.after(rates, time - drive.time[before]), rates)
}
