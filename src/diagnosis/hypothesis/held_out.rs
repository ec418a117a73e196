//! Held-out score of a hypothesis: blocked cross-validation.
//!
//! Segments fall into some folds, each a block of neighbours; a fold is scored with parameters from the others,
//! without its neighbours as a guard (H. Racine, "Consistent cross-validatory model-selection for dependent data", J.
//! Econometrics 99 (2000)). For the search the parameters without a fold follow from the whole fit by one Newton step
//! ([`scores`]). If much is missing from a model, that step may lead far off, so the final comparison fits every fold
//! ([`cross_validated`]). The score is the log predictive density of each segment, its start and the parameters'
//! posterior integrated out: with little data, a model with more parameters is less certain, not wrong.

use super::Problem;
use super::block::{Block, blocks};
use super::likelihood::{FittedHypothesis, PARTIAL_FIT};
use crate::fit::bounded::{room, step_within};
use crate::fit::exact::ExactPredictor;
use crate::fit::normal::START;
use crate::fit::optimiser::minimise_from;
use crate::fit::problem::{NoiseModel, Point, ShootingProblem};
use crate::fit::restart::{LEAST, settled};
use crate::fit::segment::Segment;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Maximum number of folds, and minimum of segments in each.
const FOLDS: usize = 4;
pub(super) const SMALLEST_FOLD: usize = 2;
/// Log predictive densities of the segments, each with parameters from other folds.
#[derive(Debug, Clone)]
pub struct Scores {
    /// For each segment.
    pub log_density: Vec<f64>,
    /// Number of samples of each.
    pub samples: Vec<usize>,
    /// For each segment the parameters of its score.
    pub coordinates: Vec<DVector<f64>>,
}

/// The fold of each segment. Each recording has segments in every fold, so that the others determine its separate
/// parameters (a slope, a latency).
#[must_use]
fn folds(segments: &[Segment]) -> Vec<usize> {
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
fn is_near(segments: &[Segment], fold: &[usize], out: usize, index: usize) -> bool {
    let ours = |other: usize| segments.get(other).map(|s| s.recording);
    (index.saturating_sub(1)..=index + 1)
        .any(|other| fold.get(other) == Some(&out) && ours(other) == ours(index))
}

/// Scores a fitted hypothesis. `None` if there is too little data to hold out.
#[must_use]
pub fn scores(problem: &Problem, fit: &FittedHypothesis, noise: &NoiseModel) -> Option<Scores> {
    let predictor = problem.predictor(&fit.coefficients);
    let shooting = problem.shooting(&predictor, &fit.coefficients);
    let point = problem.point(&shooting, &fit.coefficients, &fit.solution);
    let blocks = blocks(&shooting, &fit.tables, &point, noise)?;
    let fold = folds(&problem.segments);
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
        let apart = |index: &usize| !is_near(&problem.segments, &fold, out, *index);
        let kept = (0..blocks.len()).filter(apart).map(|index| &blocks[index]);
        let (information, gradient) = information(&shooting, &point.coordinates, kept);
        let room = room(&shooting.parameters, &point.coordinates);
        let step = step_within(&information, &gradient, &room)?;
        for (index, block) in blocks.iter().enumerate().filter(|(k, _)| fold[*k] == out) {
            scores.log_density[index] = block.predictive(&information, &step)?;
            scores.coordinates[index] += &step;
        }
    }
    Some(scores)
}

/// Precision and gradient of the unknowns from the prior and some segments.
fn information<'b>(
    shooting: &ShootingProblem<ExactPredictor>,
    coordinates: &DVector<f64>,
    blocks: impl Iterator<Item = &'b Block>,
) -> (DMatrix<f64>, DVector<f64>) {
    let (precision, mut gradient) = shooting.prior(coordinates);
    let mut matrix = DMatrix::from_diagonal(&precision);
    for block in blocks {
        matrix += &block.matrix;
        gradient += &block.gradient;
    }
    (matrix, gradient)
}

impl Scores {
    /// Gain per sample over another hypothesis, with the standard error.
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

/// Scores a fitted hypothesis by fits without each fold; a fold without which it cannot be fitted is scored by the
/// Newton step. `None` if there is too little data to hold out.
#[must_use]
pub fn cross_validated(
    problem: &Problem,
    fit: &FittedHypothesis,
    noise: &NoiseModel,
) -> Option<Scores> {
    let mut scores = scores(problem, fit, noise)?;
    let predictor = problem.predictor(&fit.coefficients);
    let shooting = problem.shooting(&predictor, &fit.coefficients);
    let point = problem.point(&shooting, &fit.coefficients, &fit.solution);
    let fold = folds(&problem.segments);
    for out in 0..=*fold.iter().max()? {
        let within = |index: usize| fold.get(index) == Some(&out);
        let apart = |index: &usize| !is_near(&problem.segments, &fold, out, *index);
        let all = 0..fold.len();
        let mut kept = Fold::new(
            &shooting,
            &point,
            noise,
            all.clone().filter(apart).collect(),
        );
        let tables = kept.indices.iter().map(|k| fit.tables[*k].clone());
        let tables = tables.collect();
        let outcome = minimise_from(
            &kept.shooting,
            &mut kept.point,
            tables,
            &kept.noise,
            PARTIAL_FIT,
        );
        let Some(learnt) = blocks(&kept.shooting, &outcome.tables, &kept.point, &kept.noise) else {
            continue;
        };
        let (information, _) = information(&shooting, &kept.point.coordinates, learnt.iter());
        let held = all.filter(|index| within(*index)).collect();
        let mut held = Fold::new(&shooting, &point, noise, held);
        held.point.coordinates = kept.point.coordinates;
        let still = DVector::zeros(held.point.coordinates.len());
        let Some(judged) = held.judged() else {
            continue;
        };
        for (index, block) in held.indices.iter().zip(judged) {
            if let Some(density) = block.predictive(&information, &still) {
                scores.log_density[*index] = density;
            }
            scores.coordinates[*index].clone_from(&held.point.coordinates);
        }
    }
    Some(scores)
}

/// Some of a problem's segments.
struct Fold<'p> {
    indices: Vec<usize>,
    shooting: ShootingProblem<'p, ExactPredictor<'p>>,
    point: Point,
    noise: NoiseModel,
}

impl<'p> Fold<'p> {
    fn new(
        shooting: &ShootingProblem<'p, ExactPredictor<'p>>,
        point: &Point,
        noise: &NoiseModel,
        indices: Vec<usize>,
    ) -> Self {
        let segments = indices.iter().map(|k| shooting.segments[*k].clone());
        Self {
            shooting: shooting.with_segments(segments.collect()),
            point: Point {
                coordinates: point.coordinates.clone(),
                starts: indices.iter().map(|k| point.starts[*k]).collect(),
            },
            noise: noise.of(&indices),
            indices,
        }
    }

    /// The segments with starts fitted at fixed parameters. `None` if the model cannot follow them.
    fn judged(&mut self) -> Option<Vec<Block>> {
        let Point {
            coordinates,
            starts,
        } = &self.point;
        let own = |(index, start): (usize, &[f64; START])| {
            let noise = self.noise.of(&[index]);
            settled(&self.shooting, index, coordinates, *start, &noise, LEAST)
        };
        let starts: Option<Vec<_>> = starts.par_iter().enumerate().map(own).collect();
        self.point.starts = starts?;
        let tables = self.shooting.evaluate(&self.point, true).ok()?;
        blocks(&self.shooting, &tables, &self.point, &self.noise)
    }
}
