//! Held-out comparison of the given, the refitted and the augmented model.
//!
//! Each model is scored with parameters from other folds ([`cross_validated`]) and under the noise of the residuals that
//! it leaves: under the smaller noise of a better model its misfit would count more. Errors in metres and radians
//! follow a start that is fitted to the first second of a segment; the rest is predicted. They cover the segments
//! that all models can follow; the score covers all.

use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::block::{Block, blocks};
use crate::diagnosis::hypothesis::held_out::{Scores, cross_validated};
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, HELD, continue_fit, follow, own_noise,
};
use crate::diagnosis::outcome::{Errors, HeldOut};
use crate::diagnosis::search::SearchResult;
use crate::fit::exact::ExactPredictor;
use crate::fit::observation::observe;
use crate::fit::optimiser::{Stop, minimise};
use crate::fit::problem::{NoiseModel, Point, ShootingProblem};
use crate::fit::restart::{LEAST, settled};
use crate::fit::robust::penalty;
use crate::fit::segment::Segment;
use crate::fit::signal::Signal;
use nalgebra::DVector;
use rayon::prelude::*;

/// Time to which a start is fitted \[s\]; the rest is predicted.
const SEEN: f64 = 1.0;
/// The end of a fit of starts.
const START_STOP: Stop = Stop::after(10, 0.5);
/// Weight of held-out samples.
const UNSEEN: f64 = 1e-8;

/// The held-out comparison of the models.
pub struct Comparison {
    /// The errors.
    pub errors: HeldOut,
    /// Residuals of the given, the refitted and the mended model by segment; `None` if the model cannot follow a segment.
    pub residuals: [Vec<Option<Residuals>>; 3],
}

/// Measured less predicted, for each channel of a segment.
pub type Residuals = Vec<Vec<f64>>;

/// A model's held-out errors and scores.
struct HeldOutPrediction {
    /// For each segment; `None` if the model cannot follow it.
    errors: Vec<Option<(SquaredErrors, Residuals)>>,
    scores: Scores,
}

/// Compares the given, the refitted and the augmented model. `None` if there is too little data to hold out.
#[must_use]
pub fn compare(searched: &SearchResult) -> Option<Comparison> {
    let (problem, noise) = (&searched.problem, &searched.noise);
    let row = |problem, fit| {
        let own = own_noise(problem, fit, noise);
        fitted(problem, &continue_fit(problem, fit, &own, HELD), &own)
    };
    let refitted = row(problem, &searched.refitted)?;
    let augmented = if searched.accepted.is_empty() {
        None
    } else {
        Some(row(&searched.placed, &searched.augmented)?)
    };
    let nominal = nominal(problem, noise);
    let rows = [nominal.as_ref(), Some(&refitted), augmented.as_ref()];
    let is_followed = |index: usize| rows.iter().flatten().all(|row| row.errors[index].is_some());
    let by_all: Vec<bool> = (0..problem.segments.len()).map(is_followed).collect();
    let length = problem.segments.iter().map(|s| s.end - s.start);
    let best = augmented.as_ref().unwrap_or(&refitted);
    let errors = HeldOut {
        nominal: nominal
            .as_ref()
            .map_or(Errors::NONE, |row| row.sum_up(&by_all)),
        refitted: refitted.sum_up(&by_all),
        augmented: best.sum_up(&by_all),
        gain: augmented
            .as_ref()
            .map_or((0.0, 0.0), |row| row.scores.gain_over(&refitted.scores)),
        horizon: length.fold(0.0, f64::max) - SEEN,
        stretches: by_all.iter().filter(|all| **all).count(),
    };
    let residuals = |row: Option<HeldOutPrediction>| match row {
        Some(row) => {
            let each = row.errors.into_iter();
            each.map(|one| one.map(|(_, residuals)| residuals))
                .collect()
        }
        None => vec![None; by_all.len()],
    };
    let refitted = residuals(Some(refitted));
    let mended = augmented.map_or_else(|| refitted.clone(), |row| residuals(Some(row)));
    Some(Comparison {
        errors,
        residuals: [residuals(nominal), refitted, mended],
    })
}

/// Errors of a fitted hypothesis.
fn fitted(
    problem: &Problem,
    fit: &FittedHypothesis,
    noise: &NoiseModel,
) -> Option<HeldOutPrediction> {
    let scores = cross_validated(problem, fit, noise)?;
    let predictor = problem.predictor(&fit.coefficients);
    let shooting = problem.shooting(&predictor, &fit.coefficients);
    Some(HeldOutPrediction::new(
        &shooting,
        &fit.solution.starts,
        scores,
        noise,
    ))
}

/// Errors of the given model. `None` if it cannot follow the recordings.
fn nominal(problem: &Problem, noise: &NoiseModel) -> Option<HeldOutPrediction> {
    let predictor =
        ExactPredictor::new(problem.nominal.clone(), Vec::new()).with_deadline(problem.deadline);
    let none = vec![Vec::new(); problem.recordings.len()];
    let mut shooting = ShootingProblem::new(&predictor, Vec::new(), problem.names.clone(), none);
    shooting.segments.clone_from(&problem.segments);
    let mut point = Point {
        coordinates: DVector::zeros(0),
        starts: shooting.measured_starts(),
    };
    let mut own = noise.clone();
    let outcome = minimise(&shooting, &mut point, noise, START_STOP).ok()?;
    follow(&shooting, &point, &outcome.tables, &mut own);
    let blocks = blocks(&shooting, &outcome.tables, &point, &own)?;
    let scores = Scores {
        log_density: blocks.iter().map(Block::log_density).collect(),
        samples: blocks.iter().map(|block| block.samples).collect(),
        coordinates: vec![DVector::zeros(0); blocks.len()],
    };
    Some(HeldOutPrediction::new(
        &shooting,
        &point.starts,
        scores,
        &own,
    ))
}

impl HeldOutPrediction {
    fn new(
        shooting: &ShootingProblem<ExactPredictor>,
        starts: &[[f64; 6]],
        scores: Scores,
        noise: &NoiseModel,
    ) -> Self {
        let one = |(index, segment): (usize, &Segment)| {
            let at = &scores.coordinates[index];
            predicted(shooting, index, segment, at, starts[index], noise)
        };
        let errors = shooting.segments.par_iter().enumerate().map(one).collect();
        let mut scores = scores;
        for (density, weights) in scores.log_density.iter_mut().zip(&noise.weights) {
            *density -= 0.5 * price(weights.iter().flatten());
        }
        Self { errors, scores }
    }

    /// Errors over these segments; the score over all.
    fn sum_up(&self, counted: &[bool]) -> Errors {
        let mut all = SquaredErrors::default();
        let pairs = self.errors.iter().zip(counted);
        let counted = pairs.filter_map(|(one, counts)| one.as_ref().filter(|_| *counts));
        for (sums, _) in counted {
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
            log_score: self.scores.mean(),
        }
    }
}

/// The penalty of the outliers' weights, which differ between models: with it the density is Student's.
fn price<'w>(weights: impl Iterator<Item = &'w f64>) -> f64 {
    // The determinant of the noise has the logarithm already.
    weights.map(|weight| penalty(*weight) + weight.ln()).sum()
}

/// Sums of squares and numbers of samples: position (two coordinates make one sample), heading, yaw rate.
#[derive(Debug, Clone, Copy, Default)]
struct SquaredErrors([(f64, usize); 3]);

/// Errors after a start that is fitted to the first second, and residuals. `None` if the model cannot follow.
fn predicted(
    shooting: &ShootingProblem<ExactPredictor>,
    index: usize,
    segment: &Segment,
    at: &DVector<f64>,
    start: [f64; 6],
    noise: &NoiseModel,
) -> Option<(SquaredErrors, Residuals)> {
    let values = shooting.model_values(segment.recording, at);
    let sensors = shooting.sensor_values(segment.recording, at);
    let seen = segment.start + SEEN;
    let mut own = noise.of(&[index]);
    for (data, weights) in segment.samples.iter().zip(&mut own.weights[0]) {
        let late = data.signal.latency(&sensors);
        for (time, weight) in data.time.iter().zip(weights) {
            if time - late > seen {
                *weight = UNSEEN;
            }
        }
    }
    let start = settled(shooting, index, at, start, &own, LEAST)?;
    let observed = observe(
        shooting.predictor(),
        segment,
        &start,
        &values,
        &sensors,
        false,
    )
    .ok()?;
    let mut sums = SquaredErrors::default();
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
    let residuals = observed.into_iter().map(|one| one.residual).collect();
    Some((sums, residuals))
}
