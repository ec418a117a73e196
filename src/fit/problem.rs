//! The unknowns, the segments, and the residuals at a point.

use super::linearised::{Linearised, add_segment};
pub use super::linearised::{NoiseModel, Tables};
use super::normal::{Normal, START};
use super::observation::{self, Residuals};
use super::parameter::FreeParameter;
use super::predictor::{PredictionError, Predictor};
use super::segment::Segment;
use super::sensor::{SensorParameter, SensorValues};
use nalgebra::DVector;
use rayon::prelude::*;

/// What is fitted to what.
#[derive(Debug)]
pub struct ShootingProblem<'a, P> {
    predictor: &'a P,
    /// All unknowns but the starts: the model's, then each recording's sensors'.
    pub parameters: Vec<FreeParameter>,
    /// Number of the model's.
    pub model_parameters: usize,
    /// For each recording the places of the predictor's parameters among all: the same for all
    /// recordings, but for parameters of which each has its own.
    model: Vec<Vec<usize>>,
    /// For each recording its free sensor parameters with their places among all.
    sensors: Vec<Vec<(SensorParameter, usize)>>,
    /// For each recording the values of those that are not free.
    held: Vec<SensorValues>,
    /// Names of the recordings.
    pub recordings: Vec<String>,
    /// What was measured.
    pub segments: Vec<Segment>,
}

/// Values of all unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Coordinates of the parameters.
    pub coordinates: DVector<f64>,
    /// Start of each segment.
    pub starts: Vec<[f64; START]>,
}

impl<'a, P: Predictor> ShootingProblem<'a, P> {
    /// Unknowns and data. `model` are the free parameters of the predictor, in its order;
    /// `sensors` the free ones of each recording.
    pub fn new(
        predictor: &'a P,
        model: Vec<FreeParameter>,
        recordings: Vec<String>,
        sensors: Vec<Vec<SensorParameter>>,
    ) -> Self {
        Self::with_own(predictor, model, &[], recordings, sensors)
    }

    /// As [`ShootingProblem::new`], with a value for each recording of those of the predictor's parameters
    /// whose places `own` lists: what is bound to the place of a drive.
    pub fn with_own(
        predictor: &'a P,
        model: Vec<FreeParameter>,
        own: &[usize],
        recordings: Vec<String>,
        sensors: Vec<Vec<SensorParameter>>,
    ) -> Self {
        debug_assert_eq!(predictor.parameters(), model.len());
        let count = model.len();
        let mut parameters = model;
        let mut each: Vec<Vec<usize>> = vec![(0..count).collect(); recordings.len()];
        for (name, places) in recordings.iter().zip(&mut each).skip(1) {
            for &place in own {
                places[place] = parameters.len();
                let mut copy = parameters[place].clone();
                copy.name = format!("{name}.{}", copy.name);
                parameters.push(copy);
            }
        }
        if let Some(first) = recordings.get(1).and(recordings.first()) {
            for &place in own {
                parameters[place].name = format!("{first}.{}", parameters[place].name);
            }
        }
        let model_parameters = parameters.len();
        let mut places = Vec::new();
        for (name, free) in recordings.iter().zip(&sensors) {
            let first = parameters.len();
            parameters.extend(free.iter().map(|sensor| sensor.parameter(name)));
            places.push(free.iter().copied().zip(first..).collect());
        }
        Self {
            predictor,
            parameters,
            model_parameters,
            model: each,
            sensors: places,
            held: vec![[0.0; SensorParameter::ALL.len()]; recordings.len()],
            recordings,
            segments: Vec::new(),
        }
    }

    /// The same unknowns with a part of the segments.
    #[must_use]
    pub fn with_segments(&self, segments: Vec<Segment>) -> Self {
        Self {
            predictor: self.predictor,
            parameters: self.parameters.clone(),
            model_parameters: self.model_parameters,
            model: self.model.clone(),
            sensors: self.sensors.clone(),
            held: self.held.clone(),
            recordings: self.recordings.clone(),
            segments,
        }
    }

    /// What predicts.
    #[must_use]
    pub fn predictor(&self) -> &'a P {
        self.predictor
    }

    /// The starts as the sensors show them.
    #[must_use]
    pub fn measured_starts(&self) -> Vec<[f64; START]> {
        self.segments.iter().map(|s| s.start_prior).collect()
    }

    /// Values of the predictor's parameters for a recording, in SI units.
    #[must_use]
    pub fn model_values(&self, recording: usize, coordinates: &DVector<f64>) -> Vec<f64> {
        let value = |place: &usize| self.parameters[*place].value(coordinates[*place]);
        self.model[recording].iter().map(value).collect()
    }

    /// Values of a recording's sensor parameters.
    #[must_use]
    pub fn sensor_values(&self, recording: usize, coordinates: &DVector<f64>) -> SensorValues {
        let mut values = self.held[recording];
        for &(sensor, place) in &self.sensors[recording] {
            values[sensor.index()] = self.parameters[place].value(coordinates[place]);
        }
        values
    }

    /// The place of a recording's sensor parameter among all, if it is free.
    #[must_use]
    pub fn sensor_place(&self, recording: usize, sensor: SensorParameter) -> Option<usize> {
        let free = self.sensors[recording].iter();
        free.clone().find(|(s, _)| *s == sensor).map(|(_, at)| *at)
    }

    /// Places of the parameters that a recording's segments depend on.
    #[must_use]
    pub fn places(&self, recording: usize) -> Vec<usize> {
        let sensors = self.sensors[recording].iter().map(|(_, place)| *place);
        let model = self.model[recording].iter().copied();
        model.chain(sensors).collect()
    }

    /// Residuals of all segments, computed side by side.
    ///
    /// # Errors
    /// The first segment that cannot be predicted.
    pub fn evaluate(
        &self,
        point: &Point,
        derivatives: bool,
    ) -> Result<Vec<Tables>, PredictionError> {
        self.evaluate_each(point, derivatives).into_iter().collect()
    }

    /// As [`ShootingProblem::evaluate`], `None` as soon as one segment cannot be predicted: what a vehicle that can
    /// hardly drive does takes long.
    #[must_use]
    pub fn evaluate_unless_one_fails(
        &self,
        point: &Point,
        derivatives: bool,
    ) -> Option<Vec<Tables>> {
        let values = self.values(point);
        let pairs = self.segments.par_iter().zip(&point.starts);
        pairs
            .map(|pair| self.predicted(pair, point, &values, derivatives).ok())
            .collect()
    }

    /// As [`ShootingProblem::evaluate`], for each segment whether the others can be predicted or not.
    #[must_use]
    pub fn evaluate_each(
        &self,
        point: &Point,
        derivatives: bool,
    ) -> Vec<Result<Tables, PredictionError>> {
        let values = self.values(point);
        let pairs = self.segments.par_iter().zip(&point.starts);
        pairs
            .map(|pair| self.predicted(pair, point, &values, derivatives))
            .collect()
    }

    /// The model's values for each recording.
    pub(super) fn values(&self, point: &Point) -> Vec<Vec<f64>> {
        let recordings = 0..self.recordings.len();
        recordings
            .map(|recording| self.model_values(recording, &point.coordinates))
            .collect()
    }

    pub(super) fn predicted(
        &self,
        (segment, start): (&Segment, &[f64; START]),
        point: &Point,
        values: &[Vec<f64>],
        derivatives: bool,
    ) -> Result<Tables, PredictionError> {
        let values = &values[segment.recording];
        let sensors = self.sensor_values(segment.recording, &point.coordinates);
        let observed = observation::observe(
            self.predictor,
            segment,
            start,
            values,
            &sensors,
            derivatives,
        )?;
        Ok(self.tables(segment.recording, values, &observed, derivatives))
    }

    /// Keeps the derivatives by what is free, and turns values into coordinates.
    fn tables(
        &self,
        recording: usize,
        values: &[f64],
        observed: &[Residuals],
        derivatives: bool,
    ) -> Tables {
        let sensors = &self.sensors[recording];
        let columns = if derivatives {
            1 + START + values.len() + sensors.len()
        } else {
            1
        };
        let width = observation::columns(values.len());
        let fill = |channel: &Residuals| {
            if !derivatives {
                return channel.residual.clone();
            }
            let mut table = Vec::with_capacity(columns * channel.residual.len());
            for (residual, row) in channel
                .residual
                .iter()
                .zip(channel.rows.chunks_exact(width))
            {
                let (start, rest) = row.split_at(START);
                let (model, own) = rest.split_at(values.len());
                table.push(*residual);
                table.extend(start);
                let slopes = self.model[recording].iter().zip(values).zip(model);
                table.extend(
                    slopes.map(|((p, value), slope)| self.parameters[*p].slope(*value) * slope),
                );
                table.extend(sensors.iter().map(|(sensor, _)| own[sensor.index()]));
            }
            table
        };
        Tables {
            channels: observed.iter().map(fill).collect(),
            columns,
        }
    }

    /// Normal equations of a segment, its start's prior among them.
    #[must_use]
    pub fn normal(&self, index: usize, tables: &Tables, point: &Point, by: &NoiseModel) -> Normal {
        let segment = &self.segments[index];
        let places = self.places(segment.recording);
        let mut normal = Normal::zeros(self.parameters.len());
        add_segment(&mut normal, segment, index, &places, tables, by);
        normal.add_start_prior(&self.start_missing(index, point), &segment.start_deviation);
        normal
    }

    /// What is left of the problem at a point where its derivatives are known.
    #[must_use]
    pub fn linearised(&self, point: &Point) -> Linearised<'_> {
        let (precision, pull) = self.prior(&point.coordinates);
        let recordings = 0..self.recordings.len();
        Linearised {
            segments: self.segments.iter().collect(),
            starts: point.starts.clone(),
            places: recordings.map(|recording| self.places(recording)).collect(),
            precision,
            pull,
            deadline: self.predictor.deadline(),
        }
    }

    /// Sum of the squares of all whitened residuals and of the distances from the priors.
    #[must_use]
    pub fn cost(&self, residuals: &[Tables], point: &Point, by: &NoiseModel) -> f64 {
        let costs = self.segment_costs(residuals, point, by);
        costs.iter().sum::<f64>() + self.prior_cost(&point.coordinates)
    }

    /// The share of each segment in the cost, its start's prior among it.
    #[must_use]
    pub fn segment_costs(&self, residuals: &[Tables], point: &Point, by: &NoiseModel) -> Vec<f64> {
        let all = residuals.par_iter().enumerate();
        all.map(|(index, tables)| self.segment_cost(index, tables, &point.starts[index], by))
            .collect()
    }

    /// The share of a segment with this start in the cost.
    #[must_use]
    pub fn segment_cost(
        &self,
        index: usize,
        residuals: &Tables,
        start: &[f64; START],
        by: &NoiseModel,
    ) -> f64 {
        let segment = &self.segments[index];
        let mut cost = 0.0;
        for (channel, samples) in segment.samples.iter().enumerate() {
            let mut table = residuals.channels[channel].clone();
            let noise = by.noise[segment.recording][samples.signal.group() as usize];
            noise.whiten(&samples.time, &by.weights[index][channel], 1, &mut table);
            cost += table.iter().map(|r| r * r).sum::<f64>();
        }
        let apart = segment.start_prior.iter().zip(start);
        let pairs = apart.zip(segment.start_deviation);
        cost + pairs
            .map(|((prior, at), d)| ((prior - at) / d).powi(2))
            .sum::<f64>()
    }

    fn start_missing(&self, index: usize, point: &Point) -> [f64; START] {
        let (prior, start) = (&self.segments[index].start_prior, &point.starts[index]);
        std::array::from_fn(|k| prior[k] - start[k])
    }

    /// Sum of the squared distances of the parameters from their priors.
    #[must_use]
    pub fn prior_cost(&self, coordinates: &DVector<f64>) -> f64 {
        let pairs = self.parameters.iter().zip(coordinates.iter());
        pairs
            .map(|(p, at)| ((p.prior_coordinate() - at) / p.prior.deviation).powi(2))
            .sum()
    }

    /// The parameters' priors: precisions, and pulls towards the medians.
    #[must_use]
    pub fn prior(&self, coordinates: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let precision = self.parameters.iter().map(|p| p.prior.deviation.powi(-2));
        let precision = DVector::from_iterator(self.parameters.len(), precision);
        let medians = self.parameters.iter().map(FreeParameter::prior_coordinate);
        let medians = DVector::from_iterator(self.parameters.len(), medians);
        let pull = (medians - coordinates).component_mul(&precision);
        (precision, pull)
    }

    /// Coordinates of a model, sensors without fault.
    #[must_use]
    pub fn coordinates(&self, model: &[f64]) -> DVector<f64> {
        let medians = self.parameters.iter().map(FreeParameter::prior_coordinate);
        let mut coordinates = DVector::from_iterator(self.parameters.len(), medians);
        for (value, place) in self
            .model
            .iter()
            .flat_map(|places| model.iter().zip(places))
        {
            let parameter = &self.parameters[*place];
            coordinates[*place] = parameter.coordinate(value.clamp(parameter.low, parameter.high));
        }
        coordinates
    }
}
