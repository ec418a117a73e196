//! Hypotheses: the given model with its soil free and candidates on, and their solutions.

pub mod block;
pub mod candidate;
pub mod held_out;
mod hitch;
pub mod likelihood;
pub mod maps;
pub mod prepare;
pub mod subsample;
pub mod thin;

use crate::fit::catalogue::{DEFAULT_FREE, describe, find};
use crate::fit::deadline::Deadline;
use crate::fit::exact::ExactPredictor;
use crate::fit::parameter;
use crate::fit::problem::{NoiseModel, Point, ShootingProblem};
use crate::fit::segment::Segment;
use crate::fit::sensor::{SensorParameter, SensorValues, compared};
use crate::fit::signal::Signal;
use crate::parameter::ParameterError;
use crate::recording::Recording;
use crate::vehicle::{ModelParameter, Specification};
use candidate::{Candidates, Target};
use hitch::hitched;
use maps::Maps;
use nalgebra::DVector;

/// Integration tolerance, in units of the usual one, for sensors with at least this white noise: errors over a
/// segment reach a few tenths of a millimetre and a milliradian, and a fit takes two thirds of the time.
const TOLERANCE: f64 = 4.0;
const SCATTER: [(Signal, f64); 4] = [
    (Signal::X, 3e-3),
    (Signal::Heading, 1e-3),
    (Signal::VelocityForward, 3e-3),
    (Signal::YawRate, 1e-3),
];

/// The soil parameter that carries the vehicle.
const STIFFNESS: &str = "frictional_modulus";

/// The given model and recordings. A hypothesis with a region has a copy with that region in its model.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The given model; effects that are off may have their place set.
    pub nominal: Specification,
    /// The recordings.
    pub recordings: &'a [Recording],
    /// Their names.
    pub names: Vec<String>,
    /// The free soil parameters.
    pub soil: Vec<ModelParameter>,
    /// The candidates.
    pub candidates: Candidates,
    /// The recordings in segments of some seconds, each with a free start.
    pub segments: Vec<Segment>,
    /// Delays of pose and wheel speeds of each recording from cross-correlation; zero if unknown.
    pub late: Vec<SensorValues>,
    /// Which recordings share a map.
    pub maps: Maps,
    /// Initial factor on the frictional modulus: above 1 if the given soil cannot carry the vehicle.
    pub stiffening: f64,
    /// Reconstruction of the wheel speeds between samples; `None` for linear interpolation.
    pub wheels: Option<Wheels>,
    /// Errors of the integration in a step, in units of the usual ones.
    pub tolerance: f64,
    /// Deadline of all computations with it.
    pub deadline: Deadline<'a>,
}

/// Reconstruction of the wheel speeds between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheels {
    /// Whether samples are means over the sampling interval.
    pub counted: bool,
    /// Smoothing, see [`crate::recording::Drive::reconstructed`].
    pub smoothing: f64,
    /// Gain of log evidence over linear interpolation.
    pub likelier: f64,
}

/// Values of all unknowns: a point from which every hypothesis can start.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Coordinates of the soil parameters.
    pub soil: Vec<f64>,
    /// Coordinates of all coefficients for each recording.
    pub coefficients: Vec<Vec<f64>>,
    /// Start of each segment.
    pub starts: Vec<[f64; 6]>,
}

impl Solution {
    /// Takes the values of some coefficients from another one.
    pub fn take(&mut self, coefficients: &[usize], other: &Self) {
        for (values, others) in self.coefficients.iter_mut().zip(&other.coefficients) {
            for coefficient in coefficients {
                values[*coefficient] = others[*coefficient];
            }
        }
    }
}

impl<'a> Problem<'a> {
    /// The problem without segments and deadline.
    #[must_use]
    #[cfg(test)]
    pub fn new(nominal: &Specification, recordings: &'a [Recording]) -> Self {
        Self::until(nominal, recordings, Deadline::NEVER)
    }

    /// A solution with some coefficients off.
    #[must_use]
    pub fn turned_off(&self, at: &Solution, coefficients: impl Iterator<Item = usize>) -> Solution {
        let mut off = at.clone();
        for k in coefficients {
            for recording in &mut off.coefficients {
                recording[k] = self.candidates[k].off();
            }
        }
        off
    }

    /// Seconds that the segments cover.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        let each = self.segments.iter().map(|s| s.end - s.start);
        // A sum of nothing is -0.
        each.fold(0.0, |sum, length| sum + length)
    }

    /// The problem without segments.
    #[must_use]
    pub fn until(
        nominal: &Specification,
        recordings: &'a [Recording],
        deadline: Deadline<'a>,
    ) -> Self {
        let maps = Maps::of(recordings);
        let found = DEFAULT_FREE.iter().filter_map(|name| find(name).ok());
        let nominal = &hitched(nominal);
        Self {
            nominal: nominal.clone(),
            recordings,
            names: recordings.iter().map(|r| r.name.clone()).collect(),
            soil: found.collect(),
            candidates: Candidates::new(nominal, maps),
            segments: Vec::new(),
            late: recordings.iter().map(compared).collect(),
            maps,
            stiffening: 1.0,
            tolerance: 1.0,
            wheels: None,
            deadline,
        }
    }

    /// The initial solution: the given model (soil stiffened if needed), effects off, starts as measured.
    #[must_use]
    pub fn initial(&self) -> Solution {
        let soil = self.soil_parameters();
        let at = |(free, described): (&ModelParameter, &parameter::FreeParameter)| {
            let mut value = free.get(&self.nominal);
            if free.name() == STIFFNESS {
                value *= self.stiffening;
            }
            described.coordinate(value.clamp(described.low, described.high))
        };
        let off = self.candidates.coefficients.iter();
        let off: Vec<f64> = off.map(|coefficient| coefficient.off()).collect();
        Solution {
            soil: self.soil.iter().zip(&soil).map(at).collect(),
            coefficients: vec![off; self.recordings.len()],
            starts: self.segments.iter().map(|s| s.start_prior).collect(),
        }
    }

    /// Recording and run of all segments, each once.
    #[must_use]
    pub fn runs(&self) -> Vec<(usize, usize)> {
        let mut runs: Vec<(usize, usize)> =
            self.segments.iter().map(|s| (s.recording, s.run)).collect();
        runs.dedup();
        runs
    }

    /// Label of a run in a recording of several.
    #[must_use]
    pub fn label_of(&self, recording: usize, run: usize) -> String {
        let recording = &self.recordings[recording];
        match recording.runs.len() {
            1 => String::new(),
            _ => recording.label_of(run),
        }
    }

    /// The soil parameters with scales and priors.
    #[must_use]
    pub fn soil_parameters(&self) -> Vec<parameter::FreeParameter> {
        let soil = self.soil.iter();
        soil.map(|free| describe(*free, &self.nominal)).collect()
    }

    /// Index of a soil parameter among the free ones.
    #[must_use]
    pub fn place_of_soil(&self, name: &str) -> Option<usize> {
        self.soil.iter().position(|free| free.name() == name)
    }

    /// Of these coefficients those of the model.
    #[must_use]
    pub fn model_coefficients(&self, coefficients: &[usize]) -> Vec<usize> {
        let turns = |place: &&usize| matches!(self.candidates[**place].target, Target::Model(_));
        coefficients.iter().filter(turns).copied().collect()
    }

    /// Of these coefficients those of sensors that a recording can determine.
    #[must_use]
    pub fn sensor_coefficients(
        &self,
        recording: usize,
        coefficients: &[usize],
    ) -> Vec<SensorParameter> {
        let target = |place: &usize| match self.candidates[*place].target {
            Target::Sensor(sensor) if sensor.is_told_by(&self.recordings[recording]) => {
                Some(sensor)
            }
            _ => None,
        };
        coefficients.iter().filter_map(target).collect()
    }

    /// The model of a recording at a solution.
    ///
    /// # Errors
    /// A coefficient beyond its range.
    pub fn specification(
        &self,
        solution: &Solution,
        recording: usize,
    ) -> Result<Specification, ParameterError> {
        let mut specification = self.nominal.clone();
        let soil = self.soil.iter().zip(self.soil_parameters());
        for ((free, described), at) in soil.zip(&solution.soil) {
            free.set(&mut specification, described.value(*at))?;
        }
        let coefficients = self
            .candidates
            .coefficients
            .iter()
            .zip(&solution.coefficients[recording]);
        for (coefficient, at) in coefficients {
            if let Target::Model(parameter) = coefficient.target
                && *at != coefficient.off()
            {
                parameter.set(&mut specification, coefficient.parameter.value(*at))?;
            }
        }
        Ok(specification)
    }

    /// The predictor with the soil and these model coefficients free.
    #[must_use]
    pub fn predictor(&self, coefficients: &[usize]) -> ExactPredictor<'a> {
        let model = self.model_coefficients(coefficients);
        let turned = model.iter().map(|place| self.candidates[*place].target);
        let turned = turned.filter_map(|target| match target {
            Target::Model(parameter) => Some(parameter),
            Target::Sensor(_) => None,
        });
        let free = self.soil.iter().copied().chain(turned).collect();
        ExactPredictor::new(self.nominal.clone(), free)
            .with_coarse_derivatives()
            .with_tolerance(self.tolerance)
            .with_deadline(self.deadline)
    }

    /// Sets the tolerance of the integration to what the sensors of all recordings resolve.
    pub fn tolerate(&mut self, noise: &NoiseModel) {
        let mut pairs = self.recordings.iter().zip(&noise.noise);
        let is_coarse = pairs.all(|(recording, noise)| {
            let mut limits = SCATTER.iter();
            limits.all(|(signal, min_noise)| {
                let is_measured = recording.has(signal.channel());
                !is_measured || noise[signal.group() as usize].white >= *min_noise
            })
        });
        self.tolerance = if is_coarse { TOLERANCE } else { 1.0 };
    }

    /// The shooting problem with the soil and these coefficients free.
    #[must_use]
    pub fn shooting<'p>(
        &self,
        predictor: &'p ExactPredictor<'p>,
        coefficients: &[usize],
    ) -> ShootingProblem<'p, ExactPredictor<'p>> {
        let model = self.model_coefficients(coefficients);
        let mut parameters = self.soil_parameters();
        let soil = parameters.len();
        let described = model.iter().map(|place| &self.candidates[*place]);
        parameters.extend(described.map(|coefficient| coefficient.parameter.clone()));
        let own = model.iter().enumerate();
        let own = own.filter(|(_, place)| self.candidates[**place].own);
        let own: Vec<usize> = own.map(|(index, _)| soil + index).collect();
        let sensors = (0..self.recordings.len())
            .map(|recording| self.sensor_coefficients(recording, coefficients));
        let sensors = sensors.collect();
        let mut shooting =
            ShootingProblem::with_own(predictor, parameters, &own, self.names.clone(), sensors);
        shooting.segments.clone_from(&self.segments);
        shooting
    }

    /// The point of a problem at a solution.
    #[must_use]
    pub fn point<P: crate::fit::predictor::Predictor>(
        &self,
        shooting: &ShootingProblem<P>,
        coefficients: &[usize],
        solution: &Solution,
    ) -> Point {
        let mut coordinates = DVector::zeros(shooting.parameters.len());
        self.visit(shooting, coefficients, |place, recording, what| {
            let parameter = &shooting.parameters[place];
            let value = match what {
                UnknownKind::Soil(index) => solution.soil[index],
                UnknownKind::CandidateParameter(coefficient) => {
                    solution.coefficients[recording][coefficient]
                }
            };
            let (low, high) = parameter.bounds();
            coordinates[place] = value.clamp(low, high);
        });
        Point {
            coordinates,
            starts: solution.starts.clone(),
        }
    }

    /// Works on the shooting problem with these coefficients free, at the point of a solution.
    pub fn at<T>(
        &self,
        coefficients: &[usize],
        solution: &Solution,
        work: impl FnOnce(&ShootingProblem<'_, ExactPredictor<'_>>, Point) -> T,
    ) -> T {
        let predictor = self.predictor(coefficients);
        let shooting = self.shooting(&predictor, coefficients);
        let point = self.point(&shooting, coefficients, solution);
        work(&shooting, point)
    }

    /// The solution at a point; other coefficients keep their values.
    #[must_use]
    pub fn solution<P: crate::fit::predictor::Predictor>(
        &self,
        shooting: &ShootingProblem<P>,
        coefficients: &[usize],
        point: &Point,
        others: &Solution,
    ) -> Solution {
        let mut solution = others.clone();
        solution.starts.clone_from(&point.starts);
        self.visit(shooting, coefficients, |place, recording, what| {
            let at = point.coordinates[place];
            match what {
                UnknownKind::Soil(index) => solution.soil[index] = at,
                UnknownKind::CandidateParameter(coefficient) => {
                    solution.coefficients[recording][coefficient] = at
                }
            }
        });
        solution
    }

    /// Visits the unknowns that each recording depends on.
    pub fn visit<P: crate::fit::predictor::Predictor>(
        &self,
        shooting: &ShootingProblem<P>,
        coefficients: &[usize],
        mut visit: impl FnMut(usize, usize, UnknownKind),
    ) {
        let model = self.model_coefficients(coefficients);
        for recording in 0..self.recordings.len() {
            let places = shooting.places(recording);
            for (index, place) in places.iter().take(self.soil.len()).enumerate() {
                visit(*place, recording, UnknownKind::Soil(index));
            }
            let turned = places.iter().skip(self.soil.len());
            for (place, coefficient) in turned.zip(&model) {
                visit(
                    *place,
                    recording,
                    UnknownKind::CandidateParameter(*coefficient),
                );
            }
            for &coefficient in coefficients {
                if let Target::Sensor(sensor) = self.candidates[coefficient].target
                    && let Some(place) = shooting.sensor_place(recording, sensor)
                {
                    visit(
                        place,
                        recording,
                        UnknownKind::CandidateParameter(coefficient),
                    );
                }
            }
        }
    }
}

/// The kind of an unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnknownKind {
    /// A soil parameter, by its index.
    Soil(usize),
    /// A coefficient.
    CandidateParameter(usize),
}
