//! The same fit from random starts: is there another answer?

use super::estimate::{Options, Stage};
use super::normal::Eliminated;
use super::optimiser::{Stop, minimise, normals};
use super::parameter::Parameter;
use super::predictor::Predictor;
use super::problem::{Point, Problem, Tables, Weighing};
use super::robust;
use super::sensor::{SensorParameter, compared};
use super::uncertainty::Uncertainty;
use super::weighing::reweigh;
use crate::recording::Recording;
use nalgebra::{DMatrix, DVector};
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

/// Where a fit begins: the model's parameters at these values, latencies at what comparing the curves tells.
#[must_use]
pub fn beginning<P: Predictor>(
    problem: &Problem<P>,
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
/// Answers are the same where no parameter differs by more of its standard deviations.
const SAME: f64 = 1.0;
const DESCENT: Stop = Stop::after(12, 0.1);
/// Turns of motion and weights on the way down.
const TURNS: usize = 6;

/// A way down and where it ended.
struct Answer {
    point: Point,
    cost: f64,
    count: usize,
    /// Standard deviations of the parameters there, if the data tell of all of them.
    deviations: Option<DVector<f64>>,
}

/// A way down past answers that are known.
enum Descent {
    /// It comes so near to one that it leads there.
    Joins(usize),
    /// It has an end of its own.
    Ends(Answer),
}

/// Tries random starts from the prior.
pub fn search<P: Predictor>(
    problem: &Problem<P>,
    found: &Point,
    by: &Weighing,
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
    let mut failed = 0;
    let mut answers: Vec<Answer> = Vec::new();
    for start in 0..options.starts {
        progress(Stage::Start(start));
        let point = Point {
            coordinates: draw(&problem.parameters, &mut random),
            starts: screen.measured_starts(),
        };
        match descend_past(&answers, &screen, point, &part, options.robust) {
            Some(Descent::Joins(known)) => answers[known].count += 1,
            Some(Descent::Ends(answer)) => answers.push(answer),
            None => failed += 1,
        }
    }
    let deviations = (0..problem.parameters.len()).map(|k| doubt.deviation(k));
    let deviations = DVector::from_iterator(problem.parameters.len(), deviations);
    let mut minima: Vec<Answer> = Vec::new();
    for answer in group(answers) {
        if minima.len() == POLISHED {
            // Too high to be worth more work: known by its cost on the screen alone.
            break;
        }
        let point = Point {
            coordinates: answer.point.coordinates,
            starts: found.starts.clone(),
        };
        let Some(mut polished) = descend(problem, point, by, options.robust) else {
            failed += answer.count;
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
    verdict(problem, found, by, minima, &deviations, failed, options)
}

fn verdict<P: Predictor>(
    problem: &Problem<P>,
    found: &Point,
    by: &Weighing,
    mut minima: Vec<Answer>,
    deviations: &DVector<f64>,
    failed: usize,
    options: &Options,
) -> Starts {
    let mut starts = Starts {
        tried: options.starts,
        failed,
        agreed: 0,
        others: Vec::new(),
        better: None,
    };
    let Some(mut answer) = descend(problem, found.clone(), by, options.robust) else {
        return starts;
    };
    minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    if let Some(lowest) = minima.first()
        && lowest.cost < answer.cost - 1.0
        && !close(&lowest.point, &answer.point, deviations)
    {
        starts.better = Some(lowest.point.clone());
        let nominal = std::mem::replace(
            &mut answer,
            descend(problem, lowest.point.clone(), by, options.robust).unwrap_or(Answer {
                point: found.clone(),
                cost: lowest.cost,
                count: 0,
                deviations: None,
            }),
        );
        if !minima
            .iter()
            .any(|m| close(&m.point, &nominal.point, deviations))
        {
            minima.push(Answer {
                count: 0,
                ..nominal
            });
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
    starts
}

/// A point drawn from the prior, within the bounds (Box & Muller's transform).
fn draw(parameters: &[Parameter], random: &mut fastrand::Rng) -> DVector<f64> {
    let coordinates = parameters.iter().map(|parameter| {
        let (low, high) = parameter.bounds();
        let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
        let normal = radius * (TAU * random.f64()).cos();
        let at = parameter.prior_coordinate() + parameter.prior.deviation * normal;
        at.clamp(low, high)
    });
    DVector::from_iterator(parameters.len(), coordinates)
}

/// Down to a minimum: motion and weights in turns, the noise held. `None` where the model
/// cannot drive.
fn descend<P: Predictor>(
    problem: &Problem<P>,
    point: Point,
    by: &Weighing,
    robust: bool,
) -> Option<Answer> {
    match descend_past(&[], problem, point, by, robust)? {
        Descent::Ends(answer) => Some(answer),
        Descent::Joins(_) => None,
    }
}

/// [`descend`], unless it comes as near to an answer that is known as answers that are the same.
fn descend_past<P: Predictor>(
    known: &[Answer],
    problem: &Problem<P>,
    mut point: Point,
    by: &Weighing,
    robust: bool,
) -> Option<Descent> {
    let mut by = by.clone();
    if robust {
        by.weights.iter_mut().flatten().for_each(|w| w.fill(1.0));
    }
    let mut cost = f64::INFINITY;
    let mut turn = 0;
    loop {
        turn += 1;
        let outcome = minimise(problem, &mut point, &by, DESCENT).ok()?;
        let near = |answer: &Answer| {
            let deviations = answer.deviations.as_ref();
            deviations.is_some_and(|d| close(&answer.point, &point, d))
        };
        if let Some(known) = known.iter().position(near) {
            return Some(Descent::Joins(known));
        }
        let penalty: f64 = by
            .weights
            .iter()
            .flatten()
            .flatten()
            .map(|w| robust::penalty(*w))
            .sum();
        let now = outcome.cost + penalty;
        let still = outcome.converged && cost - now < 0.3;
        cost = now;
        if still || turn == TURNS {
            return Some(Descent::Ends(Answer {
                deviations: deviations(problem, &outcome.tables, &point, &by),
                point,
                cost,
                count: 1,
            }));
        }
        if robust {
            reweigh(problem, &outcome.tables, &mut by);
        }
    }
}

/// Answers that are the same become one, the best first.
fn group(mut answers: Vec<Answer>) -> Vec<Answer> {
    answers.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let Some(deviations) = answers.first().and_then(|best| best.deviations.clone()) else {
        return answers;
    };
    let mut groups: Vec<Answer> = Vec::new();
    for answer in answers {
        match groups
            .iter_mut()
            .find(|g| close(&g.point, &answer.point, &deviations))
        {
            Some(same) => same.count += answer.count,
            None => groups.push(answer),
        }
    }
    groups
}

/// Standard deviations of the parameters.
fn deviations<P: Predictor>(
    problem: &Problem<P>,
    tables: &[Tables],
    point: &Point,
    by: &Weighing,
) -> Option<DVector<f64>> {
    let mut matrix = DMatrix::from_diagonal(&problem.prior(&point.coordinates).0);
    for normal in normals(problem, tables, point, by) {
        matrix += Eliminated::new(&normal, 0.0)?.matrix;
    }
    Some(matrix.cholesky()?.inverse().diagonal().map(f64::sqrt))
}

fn close(a: &Point, b: &Point, deviations: &DVector<f64>) -> bool {
    let apart = (&a.coordinates - &b.coordinates).component_div(deviations);
    apart.amax() < SAME
}
