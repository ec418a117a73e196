//! Sensitivities of every prediction to soil, starts and all candidates, in one pass.
//!
//! Forward dual numbers carry the derivatives of the motion by the soil and by every effect that acts within short
//! time bins; their sum is the effect that acts throughout. Sensor faults follow from the motion. Effects without a
//! derivative while they are off are differenced with a drive in which they are on.

use crate::diagnosis::hypothesis::candidate::{CandidateParameter, Target, is_residual_model};
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::fit::deadline::Deadline;
use crate::fit::exact::ExactPredictor;
use crate::fit::observation::{Residuals, observe, observe_binned};
use crate::fit::predictor::PredictionError;
use crate::fit::problem::Tables;
use crate::fit::segment::Segment;
use crate::fit::sensor::{SensorParameter, SensorValues};
use crate::simulation::State;
use crate::vehicle::{ModelParameter, Specification};
use rayon::prelude::*;

/// Length of a time bin \[s\], about.
const GATE: f64 = 0.5;

/// The columns, equal for all segments: soil and coefficients; and, for each time bin, the soil and the coefficients
/// that have a derivative.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Number of the soil's columns.
    pub soil: usize,
    /// Number of coefficients.
    pub coefficients: usize,
    /// The coefficients that are binned.
    pub binned: Vec<usize>,
    /// Coefficients without bins: features of residual models, and effects that are on and have memory.
    throughout: Vec<usize>,
    /// Coefficients that are differenced with a drive in which they are on.
    secants: Vec<usize>,
    /// Length of a time bin \[s\], about.
    time_bin: f64,
    /// Number of whole columns that were appended to the linearised problem.
    pub appended: usize,
}

/// Residuals of a segment with derivatives by everything.
#[derive(Debug, Clone)]
pub struct SegmentTable {
    /// Residuals, and derivatives by the start, the soil and the coefficients, by channel.
    pub whole: Tables,
    /// Derivatives by the binned columns, bin by bin, for the same rows.
    pub binned: Vec<Vec<f64>>,
    /// Edges of the time bins \[s\].
    pub edges: Vec<f64>,
}

const START: usize = State::COUNT;
const SENSORS: usize = SensorParameter::ALL.len();

impl Layout {
    /// The columns if these coefficients are on.
    #[must_use]
    pub fn new(problem: &Problem, on: &[usize]) -> Self {
        let coefficients = &problem.candidates.coefficients;
        let mut layout = Self {
            soil: problem.soil.len(),
            coefficients: coefficients.len(),
            binned: Vec::new(),
            throughout: Vec::new(),
            secants: Vec::new(),
            time_bin: GATE,
            appended: 0,
        };
        for (place, coefficient) in coefficients.iter().enumerate() {
            if !matches!(coefficient.target, Target::Model(_)) {
                continue;
            }
            if is_residual_model(coefficient.effect) && coefficient.name != "constant" {
                layout.throughout.push(place);
            } else if coefficient.secant.is_none() {
                layout.binned.push(place);
            } else if on.contains(&place) {
                layout.throughout.push(place);
            } else {
                layout.secants.push(place);
            }
        }
        layout
    }

    /// The columns of some coefficients that are off, with a single bin in each segment: effects that act throughout,
    /// at a fraction of the cost. Columns of other coefficients, except the sensors', are zero.
    #[must_use]
    pub fn single_bin(problem: &Problem, coefficients: &[usize]) -> Self {
        let mut layout = Self::new(problem, &[]);
        let lists = [
            &mut layout.binned,
            &mut layout.throughout,
            &mut layout.secants,
        ];
        for list in lists {
            list.retain(|coefficient| coefficients.contains(coefficient));
        }
        layout.time_bin = f64::INFINITY;
        layout
    }

    /// The columns of the coefficients that are on, and of a force and moment in each time bin. Columns of other
    /// coefficients, except the sensors', are zero.
    #[must_use]
    pub fn beside(problem: &Problem, on: &[usize]) -> Self {
        let mut layout = Self::new(problem, on);
        let forces = problem.candidates.residual_models();
        let forces: Vec<usize> = forces.filter(|k| layout.binned.contains(k)).collect();
        layout
            .binned
            .retain(|k| on.contains(k) || forces.contains(k));
        layout.throughout.retain(|k| on.contains(k));
        layout.secants.clear();
        layout
    }

    /// Number of whole columns, the residual and the start not counted.
    #[must_use]
    pub fn whole(&self) -> usize {
        self.soil + self.coefficients + self.appended
    }

    /// Number of binned columns of one time bin.
    #[must_use]
    pub fn per_bin(&self) -> usize {
        self.soil + self.binned.len()
    }
}

/// All segments in parallel; `None` for a segment that the model cannot follow.
#[must_use]
pub fn sensitivities(
    problem: &Problem,
    layout: &Layout,
    at: &Solution,
) -> Vec<Option<SegmentTable>> {
    let models: Vec<Option<RecordingModel>> = (0..problem.recordings.len())
        .map(|recording| RecordingModel::new(problem, layout, at, recording).ok())
        .collect();
    let one = |(segment, start): (&Segment, &[f64; 6])| {
        let model = models[segment.recording].as_ref()?;
        model.table(problem, layout, segment, start).ok()
    };
    problem
        .segments
        .par_iter()
        .zip(&at.starts)
        .map(one)
        .collect()
}

/// The models of a recording.
struct RecordingModel<'a> {
    predictor: ExactPredictor<'a>,
    secants: Vec<Option<Secant<'a>>>,
    sensors: SensorValues,
    /// Derivatives of values by coordinates: soil, then coefficients.
    slopes: Vec<f64>,
    throughout: Vec<f64>,
}

/// A model with an effect on, and the step of its coordinate.
struct Secant<'a> {
    coefficient: usize,
    predictor: ExactPredictor<'a>,
    step: f64,
}

impl<'a> RecordingModel<'a> {
    fn new(
        problem: &Problem<'a>,
        layout: &Layout,
        at: &Solution,
        recording: usize,
    ) -> Result<Self, crate::parameter::ParameterError> {
        let here = problem.specification(at, recording)?;
        let parameter = |place: &usize| match problem.candidates[*place].target {
            Target::Model(parameter) => Some(parameter),
            Target::Sensor(_) => None,
        };
        let throughout: Vec<ModelParameter> =
            layout.throughout.iter().filter_map(parameter).collect();
        let binned = layout.binned.iter().filter_map(parameter);
        let binned = problem.soil.iter().copied().chain(binned).collect();
        let coordinates = &at.coefficients[recording];
        let secant = |place: &usize| {
            let coefficient = &problem.candidates[*place];
            secant(
                coefficient,
                *place,
                &here,
                coordinates[*place],
                problem.deadline,
            )
        };
        let mut sensors = [0.0; SENSORS];
        for (coefficient, coordinate) in problem.candidates.coefficients.iter().zip(coordinates) {
            if let Target::Sensor(sensor) = coefficient.target {
                sensors[sensor.index()] = *coordinate;
            }
        }
        let soil = problem.soil_parameters();
        let soil = soil.iter().zip(&at.soil);
        let coefficients = problem
            .candidates
            .coefficients
            .iter()
            .map(|coefficient| &coefficient.parameter);
        let all = soil.chain(coefficients.zip(coordinates));
        Ok(Self {
            secants: layout.secants.iter().map(secant).collect(),
            sensors,
            slopes: all.map(|(p, at)| p.slope(p.value(*at))).collect(),
            throughout: throughout.iter().map(|p| p.get(&here)).collect(),
            predictor: ExactPredictor::new(here, throughout)
                .with_binned(binned)
                .with_coarse_derivatives()
                .with_tolerance(problem.tolerance)
                .with_deadline(problem.deadline),
        })
    }

    fn table(
        &self,
        problem: &Problem,
        layout: &Layout,
        segment: &Segment,
        start: &[f64; 6],
    ) -> Result<SegmentTable, PredictionError> {
        let length = segment.end - segment.start;
        let time_bins = (length / layout.time_bin).round().max(1.0) as usize;
        let edge = |k: usize| segment.start + length * k as f64 / time_bins as f64;
        let edges: Vec<f64> = (0..=time_bins).map(edge).collect();
        let observed = observe_binned(
            &self.predictor,
            segment,
            start,
            &self.throughout,
            &self.sensors,
            true,
            &edges[1..time_bins],
        )?;
        let none = Vec::new();
        let secants = self.secants.iter().map(|secant| {
            let secant = secant.as_ref()?;
            let sensors = &self.sensors;
            let on = observe(&secant.predictor, segment, start, &none, sensors, false);
            Some((secant, on.ok()?))
        });
        let secants: Vec<_> = secants.collect();
        let mut table = SegmentTable {
            whole: Tables {
                channels: Vec::new(),
                columns: 1 + START + layout.whole(),
            },
            binned: Vec::new(),
            edges,
        };
        for (channel, residuals) in observed.iter().enumerate() {
            let (whole, binned) =
                self.channel(problem, layout, residuals, time_bins, |coefficient, row| {
                    let found = secants
                        .iter()
                        .flatten()
                        .find(|(s, _)| s.coefficient == coefficient);
                    // The residual falls as the prediction grows.
                    found.map_or(0.0, |(secant, on)| {
                        (residuals.residual[row] - on[channel].residual[row]) / secant.step
                    })
                });
            table.whole.channels.push(whole);
            table.binned.push(binned);
        }
        Ok(table)
    }

    /// Converts derivatives to coordinates, and sorts the columns.
    fn channel(
        &self,
        problem: &Problem,
        layout: &Layout,
        residuals: &Residuals,
        time_bins: usize,
        secant: impl Fn(usize, usize) -> f64,
    ) -> (Vec<f64>, Vec<f64>) {
        let (throughout, per_bin) = (layout.throughout.len(), layout.per_bin());
        let width = START + throughout + per_bin * time_bins + SENSORS;
        let (mut whole, mut binned) = (Vec::new(), Vec::new());
        for (index, row) in residuals.rows.chunks_exact(width).enumerate() {
            let (start, rest) = row.split_at(START);
            let (model, sensors) = rest.split_at(width - START - SENSORS);
            let (model, by_bin) = model.split_at(throughout);
            let first = binned.len();
            for time_bin in by_bin.chunks_exact(per_bin) {
                let (soil, coefficients) = time_bin.split_at(layout.soil);
                binned.extend(soil.iter().zip(&self.slopes).map(|(s, slope)| s * slope));
                let coefficients = coefficients.iter().zip(&layout.binned);
                binned.extend(coefficients.map(|(k, place)| k * self.slopes[layout.soil + place]));
            }
            let own = &binned[first..];
            let sum = |column: usize| own.iter().skip(column).step_by(per_bin).sum::<f64>();
            whole.push(residuals.residual[index]);
            whole.extend(start);
            whole.extend((0..layout.soil).map(sum));
            for (place, coefficient) in problem.candidates.coefficients.iter().enumerate() {
                let slope = self.slopes[layout.soil + place];
                let at = |list: &[usize]| list.iter().position(|other| *other == place);
                whole.push(
                    match (
                        coefficient.target,
                        at(&layout.binned),
                        at(&layout.throughout),
                    ) {
                        (Target::Sensor(sensor), ..) => sensors[sensor.index()],
                        (_, Some(column), _) => sum(layout.soil + column),
                        (_, None, Some(column)) => model[column] * slope,
                        (_, None, None) => secant(place, index),
                    },
                );
            }
        }
        (whole, binned)
    }
}

fn secant<'a>(
    coefficient: &CandidateParameter,
    place: usize,
    here: &Specification,
    at: f64,
    deadline: Deadline<'a>,
) -> Option<Secant<'a>> {
    let Target::Model(parameter) = coefficient.target else {
        return None;
    };
    let value = coefficient.secant?;
    let mut on = here.clone();
    parameter.set(&mut on, value).ok()?;
    Some(Secant {
        coefficient: place,
        predictor: ExactPredictor::new(on, Vec::new()).with_deadline(deadline),
        step: coefficient.parameter.coordinate(value) - at,
    })
}
