//! What the sensors report of a trajectory, and its derivatives.

use super::predictor::{PredictionError, Predictor, Request, Trajectory};
use super::segment::{Samples, Segment};
use super::sensor::{SensorParameter, SensorValues};
use super::signal::Signal;
use crate::simulation::State;

/// Number of derivatives besides those by the model's parameters: the start and the sensors.
const START: usize = State::COUNT;
const SENSORS: usize = SensorParameter::ALL.len();

/// Residuals of a channel, measured less predicted, and the prediction's derivatives.
#[derive(Debug, Clone, Default)]
pub struct Residuals {
    /// One per sample, in the channel's unit.
    pub residual: Vec<f64>,
    /// A row per sample: by the start, the model's parameters, all sensor parameters; how these move the course over which
    /// the vehicle came to the start is left out. Empty where only residuals were asked for.
    pub rows: Vec<f64>,
}

/// Number of derivatives in a row.
#[must_use]
pub fn columns(model_parameters: usize) -> usize {
    START + model_parameters + SENSORS
}

/// Where the state of a sample is found: place in the trajectory, and how much earlier than
/// there \[s\] (a sample that turned out to come from before the segment's start).
struct Place {
    index: usize,
    before: f64,
}

/// Predicts a segment and compares it with what was measured.
///
/// # Errors
/// As [`Predictor::predict`].
pub fn observe(
    predictor: &impl Predictor,
    segment: &Segment,
    start: &[f64; 6],
    parameters: &[f64],
    sensors: &SensorValues,
    derivatives: bool,
) -> Result<Vec<Residuals>, PredictionError> {
    observe_binned(
        predictor,
        segment,
        start,
        parameters,
        sensors,
        derivatives,
        &[],
    )
}

/// As [`observe`], with the derivatives by binned parameters after those by the parameters; see
/// [`Request::time_bins`].
///
/// # Errors
/// As [`Predictor::predict`].
pub fn observe_binned(
    predictor: &impl Predictor,
    segment: &Segment,
    start: &[f64; 6],
    parameters: &[f64],
    sensors: &SensorValues,
    derivatives: bool,
    time_bins: &[f64],
) -> Result<Vec<Residuals>, PredictionError> {
    let times = times(segment, sensors);
    let mut trajectory = Trajectory::default();
    let request = Request {
        parameters,
        start: &State::from_array(*start),
        course: &segment.course_here(sensors),
        clock: segment.clock,
        drive: &segment.drive,
        wheel_latency: sensors[SensorParameter::WheelLatency.index()],
        times: &times,
        time_bins,
        derivatives,
    };
    predictor.predict(&request, &mut trajectory)?;
    let sensor = Sensor {
        trajectory: &trajectory,
        parameters: trajectory.by_parameter.len() / times.len(),
        sensors,
    };
    let compare = |samples: &Samples| {
        let late = samples.signal.latency(sensors);
        let mut out = Residuals::default();
        for (time, value) in samples.time.iter().zip(&samples.value) {
            let place = place(&times, time - late);
            let predicted = sensor.report(samples.signal, &place, derivatives, &mut out.rows);
            out.residual.push(value - predicted);
        }
        out
    };
    Ok(segment.samples.iter().map(compare).collect())
}

/// The segment's start, and when each sample was true.
fn times(segment: &Segment, sensors: &SensorValues) -> Vec<f64> {
    let true_times = segment.samples.iter().flat_map(|samples| {
        let late = samples.signal.latency(sensors);
        samples.time.iter().map(move |time| time - late)
    });
    let later = true_times.filter(|time| *time > segment.start);
    let mut times: Vec<f64> = std::iter::once(segment.start).chain(later).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

fn place(times: &[f64], time: f64) -> Place {
    let index = times.partition_point(|t| *t < time);
    let index = index.min(times.len() - 1);
    Place {
        index,
        before: (times[index] - time).max(0.0),
    }
}

struct Sensor<'a> {
    trajectory: &'a Trajectory,
    parameters: usize,
    sensors: &'a SensorValues,
}

impl Sensor<'_> {
    /// What a sensor reports: a function of the state, whose gradient carries the
    /// trajectory's derivatives on, plus what the sensor itself adds.
    fn report(&self, signal: Signal, place: &Place, derivatives: bool, rows: &mut Vec<f64>) -> f64 {
        let rate = &self.trajectory.rates[place.index];
        let mut state = self.trajectory.states[place.index];
        for (value, rate) in state.iter_mut().zip(rate) {
            *value -= rate * place.before;
        }
        let (sin, cos) = state[2].sin_cos();
        let value = |parameter: SensorParameter| self.sensors[parameter.index()];
        let (ahead, left) = (
            value(SensorParameter::LeverArmX),
            value(SensorParameter::LeverArmY),
        );
        let mut gradient = [0.0; START];
        let mut own = [0.0; SENSORS];
        let reported = match signal {
            // Position of a point at the lever arm: p + R(psi) l.
            Signal::X => {
                gradient[0] = 1.0;
                gradient[2] = -ahead * sin - left * cos;
                own[SensorParameter::LeverArmX.index()] = cos;
                own[SensorParameter::LeverArmY.index()] = -sin;
                state[0] + ahead * cos - left * sin
            }
            Signal::Y => {
                gradient[1] = 1.0;
                gradient[2] = ahead * cos - left * sin;
                own[SensorParameter::LeverArmX.index()] = sin;
                own[SensorParameter::LeverArmY.index()] = cos;
                state[1] + ahead * sin + left * cos
            }
            Signal::Heading => {
                gradient[2] = 1.0;
                own[SensorParameter::HeadingOffset.index()] = 1.0;
                state[2] + value(SensorParameter::HeadingOffset)
            }
            Signal::VelocityForward => {
                gradient[3] = 1.0;
                state[3]
            }
            Signal::VelocityLeft => {
                gradient[4] = 1.0;
                state[4]
            }
            Signal::YawRate => {
                gradient[5] = 1.0;
                own[SensorParameter::YawRateBias.index()] = 1.0;
                state[5] + value(SensorParameter::YawRateBias)
            }
        };
        if derivatives {
            let along = |direction: &[f64; 6]| dot(&gradient, direction);
            if signal.is_pose() {
                own[SensorParameter::PoseLatency.index()] = -along(rate);
            }
            let by_wheels = &self.trajectory.by_wheel_latency[place.index];
            own[SensorParameter::WheelLatency.index()] = along(by_wheels);
            let first = place.index * self.parameters;
            let by_parameter = &self.trajectory.by_parameter[first..first + self.parameters];
            rows.extend(self.trajectory.by_start[place.index].iter().map(along));
            rows.extend(by_parameter.iter().map(along));
            rows.extend(own);
        }
        reported
    }
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
