//! How well a hypothesis predicts what it was not fitted to.
//!
//! Blocked cross-validation: the segments in some folds, each a stretch of neighbours; a fold is
//! judged by parameters from the others, its neighbours left out as a guard (H. Racine,
//! "Consistent cross-validatory model-selection for dependent data", J. Econometrics 99 (2000)).
//! The parameters without a fold follow from the whole fit by one Newton step (see `refitted` for what
//! is told in the end). The score is the log
//! predictive density, starts integrated out; errors in metres come from starts fitted to the first
//! second of a segment alone, and what follows it is predicted.

use super::Errors;
use super::hypothesis::Given;
use super::likelihood::{Block, Tuned, blocks};
use crate::fit::bounded::{room, step_within};
use crate::fit::exact::ExactPredictor;
use crate::fit::normal::{Eliminated, Normal};
use crate::fit::observation::observe;
use crate::fit::optimiser::{Stop, minimise};
use crate::fit::problem::{Point, Problem, Weighing};
use crate::fit::segment::{Segment, Signal};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Folds at most, and segments of each at least.
const FOLDS: usize = 4;
const SMALLEST_FOLD: usize = 2;
/// A start is fitted to so many seconds; the rest is predicted.
pub const SEEN: f64 = 1.0;
/// Steps that fit it.
const STEPS: usize = 2;
/// When starts alone are fitted.
const START_STOP: Stop = Stop {
    steps: 10,
    gain: 0.5,
};
/// Weight of samples that are not seen.
const UNSEEN: f64 = 1e-8;

/// Log predictive densities of the segments, each judged by parameters from other folds.
#[derive(Debug, Clone)]
pub struct Scores {
    /// For each segment.
    pub log_density: Vec<f64>,
    /// Number of samples of each.
    pub samples: Vec<usize>,
    /// For each segment the parameters that it was judged by.
    pub(super) coordinates: Vec<DVector<f64>>,
}

/// Which fold each segment belongs to. Each recording has stretches in every fold, so that what is its
/// own (a slope, a latency) is told by the others as well.
#[must_use]
pub(super) fn folds(segments: &[Segment]) -> Vec<usize> {
    let folds = (segments.len() / SMALLEST_FOLD).clamp(1, FOLDS);
    let together = segments.chunk_by(|a, b| a.recording == b.recording);
    let of_recording = |(place, own): (usize, &[Segment])| -> Vec<usize> {
        let count = own.len();
        let fold = |index: usize| (index * folds / count + place) % folds;
        (0..count).map(fold).collect()
    };
    together.enumerate().flat_map(of_recording).collect()
}

/// Whether a segment or a neighbour of it in the same recording is in a fold.
#[must_use]
pub(super) fn near(segments: &[Segment], fold: &[usize], out: usize, index: usize) -> bool {
    let ours = |other: usize| segments.get(other).map(|s| s.recording);
    (index.saturating_sub(1)..=index + 1)
        .any(|other| fold.get(other) == Some(&out) && ours(other) == ours(index))
}

/// Judges a fitted hypothesis. `None` where there is too little to hold out.
#[must_use]
pub fn scores(given: &Given, tuned: &Tuned, by: &Weighing) -> Option<Scores> {
    let predictor = given.predictor(&tuned.knobs);
    let problem = given.problem(&predictor, &tuned.knobs);
    let point = given.point(&problem, &tuned.knobs, &tuned.solution);
    let blocks = blocks(&problem, &tuned.tables, &point, by)?;
    let fold = folds(&given.segments);
    let count = fold.iter().max()? + 1;
    if count < 2 {
        return None;
    }
    let mut scores = Scores {
        log_density: vec![0.0; blocks.len()],
        samples: blocks.iter().map(|block| block.samples).collect(),
        coordinates: vec![point.coordinates.clone(); blocks.len()],
    };
    for out in 0..count {
        let step = without(&problem, &point, &blocks, |index| {
            !near(&given.segments, &fold, out, index)
        })?;
        for (index, block) in blocks.iter().enumerate().filter(|(k, _)| fold[*k] == out) {
            let quadratic = step.dot(&(&block.matrix * &step));
            let cost = block.cost - 2.0 * block.gradient.dot(&step) + quadratic;
            scores.log_density[index] = -0.5 * (cost + block.log_determinant);
            scores.coordinates[index] += &step;
        }
    }
    Some(scores)
}

/// The step from the whole fit to that of some segments, within the ranges.
fn without(
    problem: &Problem<ExactPredictor>,
    point: &Point,
    blocks: &[Block],
    kept: impl Fn(usize) -> bool,
) -> Option<DVector<f64>> {
    let (precision, pull) = problem.prior(&point.coordinates);
    let mut matrix = DMatrix::from_diagonal(&precision);
    let mut gradient = pull;
    for (_, block) in blocks.iter().enumerate().filter(|(k, _)| kept(*k)) {
        matrix += &block.matrix;
        gradient += &block.gradient;
    }
    let room = room(&problem.parameters, &point.coordinates);
    step_within(&matrix, &gradient, &room)
}

impl Scores {
    /// How much better per sample than another hypothesis, with the standard error.
    #[must_use]
    pub fn gain_over(&self, other: &Self) -> (f64, f64) {
        let differences: Vec<f64> = self
            .log_density
            .iter()
            .zip(&other.log_density)
            .map(|(a, b)| a - b)
            .collect();
        let samples: usize = self.samples.iter().sum();
        let count = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / count;
        let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let samples = samples.max(1) as f64;
        (count * mean / samples, (count * variance).sqrt() / samples)
    }

    /// Mean log predictive density per sample.
    #[must_use]
    pub fn mean(&self) -> f64 {
        let samples: usize = self.samples.iter().sum();
        let constant = 0.5 * std::f64::consts::TAU.ln();
        self.log_density.iter().sum::<f64>() / samples.max(1) as f64 - constant
    }
}

/// Errors of a hypothesis' predictions, and its score.
#[must_use]
pub fn errors(given: &Given, tuned: &Tuned, scores: &Scores, by: &Weighing) -> Errors {
    let predictor = given.predictor(&tuned.knobs);
    let problem = given.problem(&predictor, &tuned.knobs);
    sum_up(&problem, &tuned.solution.starts, scores, by)
}

/// Errors of the model as it is given. `None` where it cannot drive.
#[must_use]
pub fn nominal_errors(given: &Given, by: &Weighing) -> Option<Errors> {
    let predictor = ExactPredictor::new(given.nominal.clone(), Vec::new());
    let none = vec![Vec::new(); given.recordings.len()];
    let mut problem = Problem::new(&predictor, Vec::new(), given.names.clone(), none);
    problem.segments.clone_from(&given.segments);
    let mut point = Point {
        coordinates: DVector::zeros(0),
        starts: problem.measured_starts(),
    };
    let outcome = minimise(&problem, &mut point, by, START_STOP).ok()?;
    let blocks = blocks(&problem, &outcome.tables, &point, by)?;
    let density = |block: &Block| -0.5 * (block.cost + block.log_determinant);
    let scores = Scores {
        log_density: blocks.iter().map(density).collect(),
        samples: blocks.iter().map(|block| block.samples).collect(),
        coordinates: vec![DVector::zeros(0); blocks.len()],
    };
    Some(sum_up(&problem, &point.starts, &scores, by))
}

fn sum_up(
    problem: &Problem<ExactPredictor>,
    starts: &[[f64; 6]],
    scores: &Scores,
    by: &Weighing,
) -> Errors {
    let one = |(index, segment): (usize, &Segment)| {
        let at = &scores.coordinates[index];
        predicted(problem, index, segment, at, starts[index], by)
    };
    let each: Vec<Option<Sums>> = problem.segments.par_iter().enumerate().map(one).collect();
    let mut all = Sums::default();
    for sums in each.into_iter().flatten() {
        for (total, part) in all.0.iter_mut().zip(sums.0) {
            total.0 += part.0;
            total.1 += part.1;
        }
    }
    let root = |sum: (f64, usize)| (sum.0 / sum.1 as f64).sqrt();
    Errors {
        position: root(all.0[0]),
        heading: root(all.0[1]),
        yaw_rate: root(all.0[2]),
        log_score: scores.mean(),
    }
}

/// Sums of squares and numbers of samples: position (two coordinates make one sample), heading, yaw
/// rate.
#[derive(Debug, Clone, Copy, Default)]
struct Sums([(f64, usize); 3]);

/// Fits a start to the first second and predicts the rest. `None` where the model cannot drive.
fn predicted(
    problem: &Problem<ExactPredictor>,
    index: usize,
    segment: &Segment,
    at: &DVector<f64>,
    mut start: [f64; 6],
    by: &Weighing,
) -> Option<Sums> {
    let values = problem.model_values(segment.recording, at);
    let sensors = problem.sensor_values(segment.recording, at);
    let seen = segment.start + SEEN;
    let mut observed = Vec::new();
    for step in 0..=STEPS {
        let last = step == STEPS;
        observed = observe(
            problem.predictor(),
            segment,
            &start,
            &values,
            &sensors,
            !last,
        )
        .ok()?;
        if last {
            break;
        }
        let mut normal = Normal::zeros(0);
        for (channel, data) in segment.samples.iter().enumerate() {
            let late = data.signal.latency(&sensors);
            let weights: Vec<f64> = data
                .time
                .iter()
                .zip(&by.weights[index][channel])
                .map(|(time, weight)| if time - late <= seen { *weight } else { UNSEEN })
                .collect();
            let residuals = &observed[channel];
            let width = residuals.rows.len() / residuals.residual.len().max(1);
            let rows = residuals
                .residual
                .iter()
                .zip(residuals.rows.chunks_exact(width));
            let mut table: Vec<f64> = rows
                .flat_map(|(residual, row)| {
                    std::iter::once(*residual).chain(row[..6].iter().copied())
                })
                .collect();
            let noise = by.noise[segment.recording][data.signal.group() as usize];
            noise.whiten(&data.time, &weights, 7, &mut table);
            normal.add(&table, &[]);
        }
        let missing = std::array::from_fn(|k| segment.start_prior[k] - start[k]);
        normal.add_start_prior(&missing, &segment.start_deviation);
        let step = Eliminated::new(&normal, 0.0)?.start_step(&normal, &DVector::zeros(0));
        for (value, step) in start.iter_mut().zip(step) {
            *value += step;
        }
    }
    let mut sums = Sums::default();
    for (data, residuals) in segment.samples.iter().zip(&observed) {
        let late = data.signal.latency(&sensors);
        let later = data.time.iter().zip(&residuals.residual);
        for (_, residual) in later.filter(|(time, _)| *time - late > seen) {
            let (place, counts) = match data.signal {
                Signal::X => (0, 1),
                Signal::Y => (0, 0),
                Signal::Heading => (1, 1),
                Signal::YawRate => (2, 1),
                Signal::VelocityForward | Signal::VelocityLeft => continue,
            };
            sums.0[place].0 += residual * residual;
            sums.0[place].1 += counts;
        }
    }
    Some(sums)
}
