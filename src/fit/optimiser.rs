//! Levenberg–Marquardt within bounds.
//!
//! Damping after H. B. Nielsen, "Damping parameter in Marquardt's method" (IMM-REP-1999-05).
//! A step is also cut where it would carry a parameter too far at once, in units of its prior:
//! beyond lie soils on which the vehicle cannot drive, and nothing is learnt from those.
//! Bounds by an active set: a parameter that stands on its bound and is pushed outward is
//! held for the step, and a step is cut at the bounds (D. P. Bertsekas' projection).

use super::normal::{Eliminated, Normal};
use super::predictor::{PredictionError, Predictor};
use super::problem::{Point, Problem, Tables, Weighing};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Steps at most.
    pub steps: usize,
    /// The cost, a chi-square, need not fall by more than this any further.
    pub gain: f64,
}

/// Where the search ended.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The cost there.
    pub cost: f64,
    /// How much it fell.
    pub gain: f64,
    /// Steps taken or tried.
    pub steps: usize,
    /// Whether it stopped for want of gain, not of steps.
    pub converged: bool,
    /// Residuals and derivatives there.
    pub tables: Vec<Tables>,
}

const FIRST_DAMPING: f64 = 1e-3;
const LARGEST_DAMPING: f64 = 1e8;
/// How far a first step may carry a parameter, in standard deviations of its prior, and any.
const FIRST_REACH: f64 = 1.0;
const LARGEST_REACH: f64 = 3.0;
/// A step that fails although it promises a gain, but less than so many times the least one
/// worth a step, fails for rounding.
const NEARLY: f64 = 5.0;
/// Steps below this lead nowhere.
const SMALLEST_REACH: f64 = 1e-6;

/// A step and the gain that the linearised problem expects of it.
struct Step {
    point: Point,
    expected_gain: f64,
    /// How far it carries a parameter at most, in standard deviations of its prior.
    reach: f64,
}

/// Lowers the cost from a point, which moves along.
///
/// # Errors
/// A point to begin with that cannot be predicted.
pub fn minimise<P: Predictor>(
    problem: &Problem<P>,
    point: &mut Point,
    by: &Weighing,
    stop: Stop,
) -> Result<Outcome, PredictionError> {
    let mut tables = problem.evaluate(point, true)?;
    let mut normals = normals(problem, &tables, point, by);
    let mut cost = total(problem, &normals, point);
    let first = cost;
    let (mut damping, mut growth) = (FIRST_DAMPING, 2.0);
    let mut reach = FIRST_REACH;
    let mut converged = false;
    let mut steps = 0;
    while steps < stop.steps && damping < LARGEST_DAMPING && reach > SMALLEST_REACH {
        steps += 1;
        let Some(step) = propose(problem, &normals, point, damping, reach) else {
            damping *= 10.0;
            continue;
        };
        if step.expected_gain < stop.gain {
            converged = true;
            break;
        }
        let trial = problem.evaluate(&step.point, false);
        let trial_cost = trial.map_or(f64::INFINITY, |t| problem.cost(&t, &step.point, by));
        let ratio = (cost - trial_cost) / step.expected_gain;
        // A point whose neighbours cannot be predicted is as good as none.
        let moved = (ratio > 1e-4).then(|| problem.evaluate(&step.point, true).ok());
        if let Some(Some(at)) = moved {
            *point = step.point;
            tables = at;
            normals = self::normals(problem, &tables, point, by);
            cost = total(problem, &normals, point);
            damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).max(1.0 / 3.0);
            damping = damping.max(1e-9);
            growth = 2.0;
            if ratio > 0.5 {
                reach = (2.0 * reach).min(LARGEST_REACH);
            }
        } else {
            if step.expected_gain < stop.gain * NEARLY {
                // So little is within the accuracy of the predictions.
                converged = true;
                break;
            }
            reach = 0.3 * reach.min(step.reach);
            if trial_cost.is_finite() {
                damping *= growth;
                growth *= 2.0;
            }
        }
    }
    Ok(Outcome {
        cost,
        gain: first - cost,
        steps,
        converged,
        tables,
    })
}

/// Normal equations of all segments, computed side by side.
#[must_use]
pub fn normals<P: Predictor>(
    problem: &Problem<P>,
    tables: &[Tables],
    point: &Point,
    by: &Weighing,
) -> Vec<Normal> {
    let all = tables.par_iter().enumerate();
    all.map(|(index, tables)| problem.normal(index, tables, point, by))
        .collect()
}

fn total<P: Predictor>(problem: &Problem<P>, normals: &[Normal], point: &Point) -> f64 {
    normals.iter().map(|normal| normal.cost).sum::<f64>() + problem.prior_cost(&point.coordinates)
}

fn propose<P: Predictor>(
    problem: &Problem<P>,
    normals: &[Normal],
    point: &Point,
    damping: f64,
    reach: f64,
) -> Option<Step> {
    let eliminated: Vec<Option<Eliminated>> = normals
        .par_iter()
        .map(|normal| Eliminated::new(normal, damping))
        .collect();
    let eliminated: Vec<Eliminated> = eliminated.into_iter().collect::<Option<_>>()?;
    let (precision, pull) = problem.prior(&point.coordinates);
    let mut matrix = DMatrix::from_diagonal(&precision);
    let mut gradient = pull;
    for one in &eliminated {
        matrix += &one.matrix;
        gradient += &one.gradient;
    }
    for k in 0..matrix.nrows() {
        matrix[(k, k)] *= 1.0 + damping;
    }
    hold_at_bounds(problem, point, &mut matrix, &mut gradient);
    let mut wanted = matrix.cholesky()?.solve(&gradient);
    let far = problem.parameters.iter().zip(wanted.iter());
    let far = far.map(|(p, step)| step.abs() / p.prior.deviation);
    let far = far.fold(0.0, f64::max);
    if far > reach {
        wanted *= reach / far;
    }
    let mut next = point.clone();
    for (k, parameter) in problem.parameters.iter().enumerate() {
        let (low, high) = parameter.bounds();
        next.coordinates[k] = (point.coordinates[k] + wanted[k]).clamp(low, high);
    }
    let taken = &next.coordinates - &point.coordinates;
    // What the linearised cost would fall by: the start's share, and that of the parameters,
    // of which damping leaves at least half.
    let mut expected_gain =
        2.0 * gradient.dot(&taken) - taken.dot(&(&matrix_of(&eliminated, &precision) * &taken));
    for (one, (normal, start)) in eliminated.iter().zip(normals.iter().zip(&mut next.starts)) {
        expected_gain += one.start_gain;
        for (value, step) in start.iter_mut().zip(one.start_step(normal, &taken)) {
            *value += step;
        }
    }
    let finite = next.starts.iter().flatten().all(|v| v.is_finite());
    (expected_gain.is_finite() && finite).then_some(Step {
        point: next,
        expected_gain,
        reach: far.min(reach),
    })
}

fn matrix_of(eliminated: &[Eliminated], precision: &DVector<f64>) -> DMatrix<f64> {
    let mut matrix = DMatrix::from_diagonal(precision);
    for one in eliminated {
        matrix += &one.matrix;
    }
    matrix
}

/// Takes parameters out of the system that stand on a bound and are pushed outward.
fn hold_at_bounds<P: Predictor>(
    problem: &Problem<P>,
    point: &Point,
    matrix: &mut DMatrix<f64>,
    gradient: &mut DVector<f64>,
) {
    for (k, parameter) in problem.parameters.iter().enumerate() {
        let (low, high) = parameter.bounds();
        let at = point.coordinates[k];
        if (at <= low && gradient[k] < 0.0) || (at >= high && gradient[k] > 0.0) {
            matrix.row_mut(k).fill(0.0);
            matrix.column_mut(k).fill(0.0);
            matrix[(k, k)] = 1.0;
            gradient[k] = 0.0;
        }
    }
}
