//! Trajectories with exact derivatives.

use super::deadline::Deadline;
use super::predictor::{PredictionError, Predictor, Request, Trajectory};
use crate::parameter::ParameterError;
use crate::recording::Drive;
use crate::simulation::{
    Derivatives, LastStep, SensitiveSimulation, Simulation, SimulationError, State, WheelSpeeds,
};
use crate::vehicle::{ModelParameter, Specification, VehicleModel};
use std::ops::ControlFlow;

/// Steps for each second of a drive, and in all, after which a model counts as one that cannot be driven:
/// less than a hundred are common.
const MOST_STEPS: f64 = 400.0;
const LEAST_STEPS: u64 = 1000;

/// Predicts by [`Simulation`], and by [`SensitiveSimulation`] where derivatives are wanted.
#[derive(Debug, Clone)]
pub struct ExactPredictor<'d> {
    nominal: Specification,
    free: Vec<ModelParameter>,
    /// Besides, derivatives are wanted by these as they act within each of the request's time bins.
    binned: Vec<ModelParameter>,
    coarse: bool,
    /// Errors of the integration, in units of the usual ones.
    tolerance: f64,
    deadline: Deadline<'d>,
}

impl<'d> ExactPredictor<'d> {
    /// A model with free parameters.
    #[must_use]
    pub fn new(nominal: Specification, free: Vec<ModelParameter>) -> Self {
        Self {
            nominal,
            free,
            binned: Vec::new(),
            coarse: false,
            tolerance: 1.0,
            deadline: Deadline::NEVER,
        }
    }

    /// With an end to all predictions.
    #[must_use]
    pub fn with_deadline(mut self, deadline: Deadline<'d>) -> Self {
        self.deadline = deadline;
        self
    }

    /// With derivatives by further parameters, which keep their values, as they act within each
    /// of a request's time bins.
    #[must_use]
    pub fn with_binned(mut self, binned: Vec<ModelParameter>) -> Self {
        self.binned = binned;
        self
    }

    /// With coarser and faster derivatives, see [`SensitiveSimulation::with_coarse_derivatives`].
    #[must_use]
    pub fn with_coarse_derivatives(mut self) -> Self {
        self.coarse = true;
        self
    }

    /// With errors of the integration that are so many times the usual ones.
    #[must_use]
    pub fn with_tolerance(mut self, times: f64) -> Self {
        self.tolerance = times;
        self
    }

    /// The model with other values of the free parameters.
    ///
    /// # Errors
    /// An effect's parameter out of its range.
    pub fn with(&self, values: &[f64]) -> Result<Specification, ParameterError> {
        let mut specification = self.nominal.clone();
        for (parameter, &value) in self.free.iter().zip(values) {
            parameter.set(&mut specification, value)?;
        }
        Ok(specification)
    }
}

impl Predictor for ExactPredictor<'_> {
    fn parameters(&self) -> usize {
        self.free.len()
    }

    fn held(&self, parameters: &[f64]) -> Result<Self, PredictionError> {
        Ok(Self {
            coarse: self.coarse,
            tolerance: self.tolerance,
            deadline: self.deadline,
            ..Self::new(self.with(parameters)?, Vec::new())
        })
    }

    fn deadline(&self) -> Deadline<'_> {
        self.deadline
    }

    fn predict(&self, request: &Request, out: &mut Trajectory) -> Result<(), PredictionError> {
        out.clear();
        if self.deadline.is_over() {
            return Err(PredictionError::OutOfTime);
        }
        let Some(&begin) = request.times.first() else {
            return Ok(());
        };
        let specification = self.with(request.parameters)?;
        let seconds = request.times.last().map_or(0.0, |end| end - begin);
        let most = LEAST_STEPS + (MOST_STEPS * seconds) as u64;
        if request.derivatives {
            let time_bins = request.time_bins.len() + 1;
            let mut simulation = SensitiveSimulation::with_time_bins(
                &specification,
                &self.free,
                &self.binned,
                time_bins,
            )?;
            if self.coarse {
                simulation = simulation.with_coarse_derivatives();
            }
            simulation.limit_steps(most);
            simulation.tolerate(self.tolerance);
            simulation.restart(request.clock + begin, *request.start)?;
            drive(&mut simulation, request, self.deadline, out)?;
        } else {
            let model = VehicleModel::from_specification(&specification)?;
            let mut simulation = Simulation::new(model);
            simulation.limit_steps(most);
            simulation.tolerate(self.tolerance);
            simulation.set_state(*request.start)?;
            simulation.set_time(request.clock + begin)?;
            drive(&mut simulation, request, self.deadline, out)?;
        }
        Ok(())
    }
}

impl Trajectory {
    fn push(&mut self, state: State, rates: [f64; State::COUNT], derivatives: Option<Derivatives>) {
        self.states.push(state.to_array());
        self.rates.push(rates);
        let Some(derivatives) = derivatives else {
            return;
        };
        let by_start = derivatives.by_initial();
        self.by_start.push(std::array::from_fn(|k| {
            by_start.column(k).into_owned().into()
        }));
        self.by_parameter.extend(derivatives.by_parameters());
        // A latency brings speeds earlier that a delay brings later.
        let by_delay = derivatives.by_wheel_delay();
        self.by_wheel_latency.push(by_delay.map(|slope| -slope));
    }
}

/// Something that drives.
trait Driven {
    fn wheels(&mut self, speeds: WheelSpeeds, rates: WheelSpeeds) -> Result<(), SimulationError>;
    /// The drive starts in the middle of another.
    fn settle_after(&mut self, course: &[[f64; 3]]) -> Result<(), SimulationError>;
    fn advance(
        &mut self,
        seconds: f64,
        look: impl FnMut(&LastStep) -> ControlFlow<()>,
    ) -> Result<(), SimulationError>;
    /// The rate of change of the state, and its derivatives where they are carried.
    fn here(&mut self) -> Result<([f64; State::COUNT], Option<Derivatives>), SimulationError>;

    /// The next time bin opens.
    fn open_gate(&mut self) {}
}

impl Driven for Simulation {
    fn wheels(&mut self, speeds: WheelSpeeds, rates: WheelSpeeds) -> Result<(), SimulationError> {
        self.set_wheel_speeds(speeds)?;
        self.set_wheel_accelerations(rates)
    }

    fn settle_after(&mut self, course: &[[f64; 3]]) -> Result<(), SimulationError> {
        Self::settle_after(self, course)
    }

    fn advance(
        &mut self,
        seconds: f64,
        look: impl FnMut(&LastStep) -> ControlFlow<()>,
    ) -> Result<(), SimulationError> {
        self.step_looking(seconds, look)
    }

    fn here(&mut self) -> Result<([f64; State::COUNT], Option<Derivatives>), SimulationError> {
        Ok((self.derivative()?, None))
    }
}

impl Driven for SensitiveSimulation {
    fn wheels(&mut self, speeds: WheelSpeeds, rates: WheelSpeeds) -> Result<(), SimulationError> {
        self.drive(speeds, rates)
    }

    fn settle_after(&mut self, course: &[[f64; 3]]) -> Result<(), SimulationError> {
        Self::settle_after(self, course)
    }

    fn advance(
        &mut self,
        seconds: f64,
        look: impl FnMut(&LastStep) -> ControlFlow<()>,
    ) -> Result<(), SimulationError> {
        self.step_looking(seconds, look)
    }

    fn here(&mut self) -> Result<([f64; State::COUNT], Option<Derivatives>), SimulationError> {
        Ok((self.derivative()?, Some(self.derivatives())))
    }

    fn open_gate(&mut self) {
        self.next_time_bin();
    }
}

/// A time \[s\] so short that it is rounding.
const ROUNDING: f64 = 1e-9;

/// Drives along the wheel speeds and writes what it was like at each of the times. Only rows and
/// time bins end a step of the integrator; what lies within a step is interpolated.
fn drive<D: Driven>(
    simulation: &mut D,
    request: &Request,
    deadline: Deadline,
    out: &mut Trajectory,
) -> Result<(), PredictionError> {
    let Some((&begin, later)) = request.times.split_first() else {
        return Ok(());
    };
    let drive = request.drive;
    let mut time_bins = request
        .time_bins
        .iter()
        .map(|time_bin| time_bin + request.wheel_latency);
    let mut time_bin = time_bins.next();
    let mut now = begin + request.wheel_latency;
    let mut row = drive.time.partition_point(|time| *time <= now);
    let (speeds, rates) = wheels(drive, row, now);
    simulation.wheels(speeds, rates)?;
    simulation.settle_after(request.course)?;
    let (rates, derivatives) = simulation.here()?;
    out.push(*request.start, rates, derivatives);
    let mut wanted = later
        .iter()
        .map(|time| time + request.wheel_latency)
        .peekable();
    let end = later
        .last()
        .map_or(now, |time| time + request.wheel_latency);
    while now < end {
        let next_row = drive.time.get(row).copied().unwrap_or(f64::INFINITY);
        let next_time_bin = time_bin.unwrap_or(f64::INFINITY);
        let next = next_row.min(next_time_bin).min(end);
        // Since then: sums of steps on a clock that began in 1970 would round off more than the last sample's place.
        let mut reached = 0.0;
        let mut is_late = false;
        let advanced = simulation.advance((next - now).max(0.0), |step| {
            reached += step.length();
            let within = |time: &f64| *time - now <= reached + ROUNDING && step.length() > 0.0;
            while let Some(time) = wanted.next_if(within) {
                let back = (reached - (time - now)).max(0.0);
                let (state, rates) = step.state(back);
                out.push(state, rates, step.derivatives(back));
            }
            // Where wheels hardly find their balance, a row of wheel speeds takes minutes.
            is_late = deadline.is_over();
            if is_late {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        if is_late {
            return Err(PredictionError::OutOfTime);
        }
        advanced?;
        now = next;
        if next_time_bin <= next {
            simulation.open_gate();
            time_bin = time_bins.next();
        }
        if next_row <= next {
            row += 1;
            let (speeds, rates) = wheels(drive, row, now);
            simulation.wheels(speeds, rates)?;
        }
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
