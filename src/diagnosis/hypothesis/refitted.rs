//! What was found, judged by folds that are fitted anew.
//!
//! While names are weighed, a fold's parameters follow from the whole fit by one Newton step (see
//! `held_out`). Where much is missing from a model, as from the one that is only re-tuned, that step may
//! lead far off; what is told in the end is therefore fitted without the fold indeed.

use super::Given;
use super::held_out::{Scores, folds, near, scores, told};
use super::likelihood::{Block, SKETCH, Tuned, blocks};
use crate::fit::exact::ExactPredictor;
use crate::fit::normal::Eliminated;
use crate::fit::optimiser::{minimise, normals};
use crate::fit::problem::{Point, Problem, Weighing};
use nalgebra::DVector;

/// Steps that fit the starts of what was left out.
const START_STEPS: usize = 2;

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
        let Ok(outcome) = minimise(&kept.problem, &mut kept.point, &kept.by, SKETCH) else {
            continue;
        };
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
    problem: Problem<'p, ExactPredictor>,
    point: Point,
    by: Weighing,
}

impl<'p> Part<'p> {
    fn new(
        problem: &Problem<'p, ExactPredictor>,
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
        let still = DVector::zeros(self.problem.parameters.len());
        for _ in 0..START_STEPS {
            let tables = self.problem.evaluate(&self.point, true).ok()?;
            let each = normals(&self.problem, &tables, &self.point, &self.by);
            for (start, normal) in self.point.starts.iter_mut().zip(&each) {
                let step = Eliminated::new(normal, 0.0)?.start_step(normal, &still);
                for (value, step) in start.iter_mut().zip(step) {
                    *value += step;
                }
            }
        }
        let tables = self.problem.evaluate(&self.point, true).ok()?;
        blocks(&self.problem, &tables, &self.point, &self.by)
    }
}
