//! How well a hypothesis predicts what it was not fitted to.
//!
//! Blocked cross-validation: the segments in some folds, each a stretch of neighbours; a fold is
//! judged by parameters from the others, its neighbours left out as a guard (H. Racine,
//! "Consistent cross-validatory model-selection for dependent data", J. Econometrics 99 (2000)).
//! The parameters without a fold follow from the whole fit by one Newton step (see `cross_validated` for what
//! is told in the end). The score is the log predictive density of each segment, its start and what the
//! others leave open of the parameters integrated out: where little is left to learn from, a model with more
//! to learn is less sure, not wrong.

use super::Problem;
use super::block::{Block, blocks};
use super::likelihood::FittedHypothesis;
use crate::fit::bounded::{room, step_within};
use crate::fit::exact::ExactPredictor;
use crate::fit::problem::{NoiseModel, ShootingProblem};
use crate::fit::segment::Segment;
use nalgebra::{DMatrix, DVector};

/// Folds at most, and segments of each at least.
const FOLDS: usize = 4;
pub(super) const SMALLEST_FOLD: usize = 2;
/// Log predictive densities of the segments, each judged by parameters from other folds.
#[derive(Debug, Clone)]
pub struct Scores {
    /// For each segment.
    pub log_density: Vec<f64>,
    /// Number of samples of each.
    pub samples: Vec<usize>,
    /// For each segment the parameters that it was judged by.
    pub coordinates: Vec<DVector<f64>>,
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
        let apart = |index: &usize| !near(&problem.segments, &fold, out, *index);
        let kept = (0..blocks.len()).filter(apart).map(|index| &blocks[index]);
        let (told, gradient) = told(&shooting, &point.coordinates, kept);
        let room = room(&shooting.parameters, &point.coordinates);
        let step = step_within(&told, &gradient, &room)?;
        for (index, block) in blocks.iter().enumerate().filter(|(k, _)| fold[*k] == out) {
            scores.log_density[index] = block.predictive(&told, &step)?;
            scores.coordinates[index] += &step;
        }
    }
    Some(scores)
}

/// What the prior and some segments tell of the unknowns: precision and gradient.
pub(super) fn told<'b>(
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
