//! What was found, judged by folds that are fitted anew.
//!
//! While names are weighed, a fold's parameters follow from the whole fit by one Newton step (see
//! `held_out`). Where much is missing from a model, as from the one that is only re-tuned, that step may
//! lead far off; what is told in the end is therefore fitted without the fold indeed.

use super::Given;
use super::block::{Block, blocks};
use super::held_out::{Scores, folds, near, scores, told};
use super::likelihood::{SKETCH, Tuned};
use crate::fit::exact::ExactPredictor;
use crate::fit::normal::START;
use crate::fit::optimiser::minimise_from;
use crate::fit::problem::{Point, Problem, Weighing};
use crate::fit::restart::settled;
use nalgebra::DVector;
use rayon::prelude::*;

/// Judges a fitted hypothesis by fits without each fold; a fold without which it cannot be fitted
/// is judged by the step from the whole fit. `None` where there is too little to hold out.
#[must_use]
pub fn refitted(given: &Given, tuned: &Tuned, by: &Weighing) -> Option<Scores> {
    let mut scores = scores(given, tuned, by)?;
    let predictor = given.predictor(&tuned.knobs);
    let problem = given.problem(&predictor, &tuned.knobs);
    let point = given.point(&problem, &tuned.knobs, &tuned.solution);
    let fold = folds(&given.segments);
    for out in 0..=*fold.iter().max()? {
        let within = |index: usize| fold.get(index) == Some(&out);
        let apart = |index: &usize| !near(&given.segments, &fold, out, *index);
        let all = 0..fold.len();
        let mut kept = Part::new(&problem, &point, by, all.clone().filter(apart).collect());
        let tables = kept.indices.iter().map(|k| tuned.tables[*k].clone());
        let tables = tables.collect();
        let outcome = minimise_from(&kept.problem, &mut kept.point, tables, &kept.by, SKETCH);
        let Some(learnt) = blocks(&kept.problem, &outcome.tables, &kept.point, &kept.by) else {
            continue;
        };
        let (told, _) = told(&problem, &kept.point.coordinates, learnt.iter());
        let left = all.filter(|index| within(*index)).collect();
        let mut left = Part::new(&problem, &point, by, left);
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
struct Part<'p> {
    indices: Vec<usize>,
    problem: Problem<'p, ExactPredictor<'p>>,
    point: Point,
    by: Weighing,
}

impl<'p> Part<'p> {
    fn new(
        problem: &Problem<'p, ExactPredictor<'p>>,
        point: &Point,
        by: &Weighing,
        indices: Vec<usize>,
    ) -> Self {
        let segments = indices.iter().map(|k| problem.segments[*k].clone());
        Self {
            problem: problem.with_segments(segments.collect()),
            point: Point {
                coordinates: point.coordinates.clone(),
                starts: indices.iter().map(|k| point.starts[*k]).collect(),
            },
            by: by.of(&indices),
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
            let by = self.by.of(&[index]);
            settled(&self.problem, index, coordinates, *start, &by)
        };
        let starts: Option<Vec<_>> = starts.par_iter().enumerate().map(own).collect();
        self.point.starts = starts?;
        let tables = self.problem.evaluate(&self.point, true).ok()?;
        blocks(&self.problem, &tables, &self.point, &self.by)
    }
}
