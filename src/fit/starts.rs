//! The same fit from random starts: is there another answer?

use super::descent::{Answer, Descent, close, descend, descend_past, group};
use super::options::{Options, Stage};
use super::parameter::FreeParameter;
use super::predictor::Predictor;
use super::problem::{NoiseModel, Point, ShootingProblem};
use super::sensor::{SensorParameter, compared};
use super::uncertainty::Uncertainty;
use crate::recording::Recording;
use nalgebra::DVector;
use std::f64::consts::TAU;

/// What random starts led to.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    /// Number of starts.
    pub tried: usize,
    /// Of these, how many the model could not drive from.
    pub failed: usize,
    /// How many led to the answer.
    pub agreed: usize,
    /// Other answers, the best first.
    pub others: Vec<OtherMinimum>,
    /// A better answer than that from the nominal model: it became the answer.
    pub better: Option<Point>,
}

/// Another minimum.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherMinimum {
    /// How many starts led there.
    pub count: usize,
    /// How much higher its objective, a chi-square, is than the answer's.
    pub above: f64,
    /// Values of the model's parameters there.
    pub values: Vec<f64>,
}

impl OtherMinimum {
    /// Whether the data rule it out: a difference that chance would give once in a hundred.
    #[must_use]
    pub fn ruled_out(&self) -> bool {
        self.above > 9.2
    }
}

/// Where a fit begins: the model's parameters at these values, latencies from correlating the sensors.
#[must_use]
pub fn beginning<P: Predictor>(
    problem: &ShootingProblem<P>,
    nominal: &[f64],
    recordings: &[Recording],
) -> DVector<f64> {
    let mut begin = problem.coordinates(nominal);
    for (index, recording) in recordings.iter().enumerate() {
        let late = compared(recording);
        for (sensor, late) in SensorParameter::ALL.into_iter().zip(late) {
            let free = problem.sensor_place(index, sensor);
            if let Some(place) = free.filter(|_| late != 0.0) {
                let parameter = &problem.parameters[place];
                begin[place] = parameter.coordinate(late.clamp(parameter.low, parameter.high));
            }
        }
    }
    begin
}

/// Segments that starts are tried on; answers are then polished on all.
const SCREEN: usize = 12;
/// Answers polished at most.
const POLISHED: usize = 4;
/// An answer is better where its cost is lower by this.
const BETTER: f64 = 1.0;

/// Tries random starts from the prior.
pub fn search<P: Predictor>(
    problem: &ShootingProblem<P>,
    found: &Point,
    by: &NoiseModel,
    doubt: &Uncertainty,
    options: &Options,
    progress: &(dyn Fn(Stage) + Sync),
) -> Starts {
    let stride = problem.segments.len().div_ceil(SCREEN);
    let pick = |index: &usize| index % stride == stride / 2;
    let picked: Vec<usize> = (0..problem.segments.len()).filter(pick).collect();
    let segments = picked.iter().map(|k| problem.segments[*k].clone());
    let screen = problem.with_segments(segments.collect());
    let part = by.of(&picked);
    let mut random = fastrand::Rng::with_seed(options.seed);
    let mut starts = Starts {
        tried: options.starts,
        failed: 0,
        agreed: 0,
        others: Vec::new(),
        better: None,
    };
    // The answer from the nominal model is known, though no start has led there yet.
    let told = Point {
        coordinates: found.coordinates.clone(),
        starts: picked.iter().map(|k| found.starts[*k]).collect(),
    };
    let told = descend(&screen, told, &part, options.robust);
    let told = told.map(|told| Answer { count: 0, ..told });
    let mut answers = Vec::from_iter(told.clone());
    for start in 0..options.starts {
        progress(Stage::Start(start));
        let point = Point {
            coordinates: draw(&problem.parameters, &mut random),
            starts: screen.measured_starts(),
        };
        match descend_past(&answers, &screen, point, &part, options.robust) {
            Some(Descent::Joins(known)) => answers[known].count += 1,
            Some(Descent::Ends(answer)) => answers.push(answer),
            None => starts.failed += 1,
        }
    }
    let deviations = (0..problem.parameters.len()).map(|k| doubt.deviation(k));
    let deviations = DVector::from_iterator(problem.parameters.len(), deviations);
    let mut minima: Vec<Answer> = Vec::new();
    for answer in group(answers) {
        if answer.count == 0 {
            continue;
        }
        if told
            .as_ref()
            .is_some_and(|told| is_that_of(told, found, &answer))
        {
            starts.agreed += answer.count;
            continue;
        }
        if minima.len() == POLISHED {
            // Too high to be worth more work: known by its cost on the screen alone.
            continue;
        }
        let point = Point {
            coordinates: answer.point.coordinates,
            starts: found.starts.clone(),
        };
        let Some(mut polished) = descend(problem, point, by, options.robust) else {
            starts.failed += answer.count;
            continue;
        };
        polished.count = answer.count;
        match minima
            .iter_mut()
            .find(|m| close(&m.point, &polished.point, &deviations))
        {
            Some(same) => {
                same.count += polished.count;
                if polished.cost < same.cost {
                    (same.point, same.cost) = (polished.point, polished.cost);
                }
            }
            None => minima.push(polished),
        }
    }
    if minima.is_empty() {
        return starts;
    }
    verdict(
        problem,
        found,
        by,
        minima,
        &deviations,
        starts,
        options.robust,
    )
}

/// Whether an answer on the screen is that from the nominal model there (`told`), which is still at `found`; it then
/// needs no work on all segments.
fn is_that_of(told: &Answer, found: &Point, answer: &Answer) -> bool {
    told.deviations.as_ref().is_some_and(|deviations| {
        close(found, &told.point, deviations) && close(&answer.point, &told.point, deviations)
    }) && answer.cost > told.cost - BETTER
}

/// Compares answers of starts with that from the nominal model.
fn verdict<P: Predictor>(
    problem: &ShootingProblem<P>,
    found: &Point,
    by: &NoiseModel,
    mut minima: Vec<Answer>,
    deviations: &DVector<f64>,
    mut starts: Starts,
    robust: bool,
) -> Starts {
    let Some(mut answer) = descend(problem, found.clone(), by, robust) else {
        return starts;
    };
    minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    if let Some(lowest) = minima.first()
        && lowest.cost < answer.cost - BETTER
        && !close(&lowest.point, &answer.point, deviations)
    {
        starts.better = Some(lowest.point.clone());
        let nominal = std::mem::replace(
            &mut answer,
            descend(problem, lowest.point.clone(), by, robust).unwrap_or(Answer {
                point: found.clone(),
                cost: lowest.cost,
                count: 0,
                deviations: None,
            }),
        );
        // Who agreed with that from the nominal model agreed with another than the answer.
        let count = std::mem::take(&mut starts.agreed);
        let mut there = minima.iter_mut();
        match there.find(|m| close(&m.point, &nominal.point, deviations)) {
            Some(same) => same.count += count,
            None => minima.push(Answer { count, ..nominal }),
        }
    }
    for minimum in minima {
        if close(&minimum.point, &answer.point, deviations) {
            starts.agreed += minimum.count;
        } else {
            starts.others.push(OtherMinimum {
                count: minimum.count,
                above: minimum.cost - answer.cost,
                values: problem.model_values(0, &minimum.point.coordinates),
            });
        }
    }
    starts.others.sort_by(|a, b| a.above.total_cmp(&b.above));
    starts
}

/// A point drawn from the prior, within the bounds (Box & Muller's transform).
fn draw(parameters: &[FreeParameter], random: &mut fastrand::Rng) -> DVector<f64> {
    let coordinates = parameters.iter().map(|parameter| {
        let (low, high) = parameter.bounds();
        let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
        let normal = radius * (TAU * random.f64()).cos();
        let at = parameter.prior_coordinate() + parameter.prior.deviation * normal;
        at.clamp(low, high)
    });
    DVector::from_iterator(parameters.len(), coordinates)
}
