//! What was found, judged by folds that are fitted anew.
//!
//! While names are weighed, a fold's parameters follow from the whole fit by one Newton step (see
//! `held_out`). Where much is missing from a model, as from the one that is only re-tuned, that step may
//! lead far off; what is told in the end is therefore fitted without the fold indeed.

use super::Problem;
use super::block::{Block, blocks};
use super::held_out::{Scores, folds, near, scores, told};
use super::likelihood::{FittedHypothesis, PARTIAL_FIT};
use crate::fit::exact::ExactPredictor;
use crate::fit::normal::START;
use crate::fit::optimiser::minimise_from;
use crate::fit::problem::{NoiseModel, Point, ShootingProblem};
use crate::fit::restart::settled;
use nalgebra::DVector;
use rayon::prelude::*;

/// Judges a fitted hypothesis by fits without each fold; a fold without which it cannot be fitted
/// is judged by the step from the whole fit. `None` where there is too little to hold out.
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
        let apart = |index: &usize| !near(&problem.segments, &fold, out, *index);
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
        let (told, _) = told(&shooting, &kept.point.coordinates, learnt.iter());
        let left = all.filter(|index| within(*index)).collect();
        let mut left = Fold::new(&shooting, &point, noise, left);
        left.point.coordinates = kept.point.coordinates;
        let still = DVector::zeros(left.point.coordinates.len());
        let Some(judged) = left.judged() else {
            continue;
        };
        for (index, block) in left.indices.iter().zip(judged) {
            if let Some(density) = block.predictive(&told, &still) {
                scores.log_density[*index] = density;
            }
            scores.coordinates[*index].clone_from(&left.point.coordinates);
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

    /// The segments with starts of their own at the parameters as they stand. `None` where they
    /// cannot be driven.
    fn judged(&mut self) -> Option<Vec<Block>> {
        let Point {
            coordinates,
            starts,
        } = &self.point;
        let own = |(index, start): (usize, &[f64; START])| {
            let noise = self.noise.of(&[index]);
            settled(&self.shooting, index, coordinates, *start, &noise)
        };
        let starts: Option<Vec<_>> = starts.par_iter().enumerate().map(own).collect();
        self.point.starts = starts?;
        let tables = self.shooting.evaluate(&self.point, true).ok()?;
        blocks(&self.shooting, &tables, &self.point, &self.noise)
    }
}
