//! The search: accepts missing effects one by one.
//!
//! Each round screens everything beside the effects accepted so far, and the search ends when no further effect is
//! worth it.

pub mod accepted;
pub mod choice;
mod colocated;
pub mod initial_guess;
pub mod naming;
pub mod own_noise;
pub mod path;
pub mod proposal;
pub mod prune;
mod replaced;
pub mod rerank;
pub mod stage;
pub mod subsample_search;
pub mod trial;
mod unstuck;
pub mod view;
pub mod wheels;

use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, HELD, continue_fit, fit_hypothesis, fit_with_noise, own_noise,
};
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::diagnosis::{DiagnosisError, Options, Progress, Subject};
use crate::fit::optimiser::Stop;
use crate::fit::predictor::PredictionError;
use crate::fit::problem::NoiseModel;
pub use accepted::{AcceptedEffect, Rival};
use choice::held_out_gain;
use naming::FittedCandidate;
use path::Path;
use proposal::ProposalKind;
use stage::{Screening, screen};
use std::sync::Arc;
use trial::try_all;
use unstuck::{AGAIN, unstuck};
use wheels::reconstructed;

/// The result of a search.
#[derive(Debug)]
pub struct SearchResult<'a> {
    /// The given model.
    pub problem: Problem<'a>,
    /// Noise and weights.
    pub noise: NoiseModel,
    /// The refitted model under the final noise.
    pub refitted: FittedHypothesis,
    /// The augmented model.
    pub augmented: FittedHypothesis,
    /// The given model with the regions of the accepted effects.
    pub placed: Problem<'a>,
    /// The accepted effects.
    pub accepted: Vec<AcceptedEffect>,
    /// Log odds of the candidates rejected in the last round.
    pub refused: Vec<Rival>,
    /// Held-out gains of the candidates of the first round.
    pub gains: Vec<(Subject, (f64, f64))>,
    /// Whether there is a held-out score; without it nothing is accepted.
    pub tested: bool,
    /// Whether all candidates were fitted within the time limit.
    pub tried: bool,
    /// The screening of the refitted model.
    pub first: Arc<Screening>,
    /// The screening of the augmented model.
    pub last: Arc<Screening>,
}

impl SearchResult<'_> {
    /// Whether all accepted effects act in a region only.
    #[must_use]
    pub fn is_local(&self) -> bool {
        let mut accepted = self.accepted.iter();
        accepted.all(|effect| effect.proposal.kind() == ProposalKind::Local)
    }

    /// Log Bayes factor of other formulas of the accepted effects, by what mends them or their shape freedom, against the
    /// catalogue's.
    #[must_use]
    pub fn other_formulas(&self) -> f64 {
        let mending = self.accepted.iter().filter(|effect| effect.mends);
        let mending: f64 = mending.map(|effect| effect.gain).sum();
        self.augmented.shape_gain + mending
    }

    /// Returns to the refitted model: the accepted effects predict held-out data worse, so they are no likelier than
    /// "nothing".
    pub fn withdraw(&mut self) {
        for effect in self.accepted.drain(..) {
            self.refused.extend(effect.rivals);
        }
        for rival in &mut self.refused {
            rival.odds = rival.odds.min(0.0);
        }
        self.noise = own_noise(&self.problem, &self.refitted, &self.noise);
        // The reported intervals belong to this noise.
        self.refitted = continue_fit(&self.problem, &self.refitted, &self.noise, HELD);
        self.augmented = self.refitted.clone();
        self.placed = self.problem.clone();
        self.last = Arc::clone(&self.first);
    }
}

/// Searches for missing effects. From the first screening on there is an answer: at the deadline the search returns it.
///
/// # Errors
/// A model that cannot follow the recordings, numbers that are not finite, a stop, or no time for a first screening.
pub fn search<'a>(
    problem: &Problem<'a>,
    mut noise: NoiseModel,
    options: &Options,
    progress: &'a Progress,
) -> Result<SearchResult<'a>, DiagnosisError> {
    progress.step("refitting the soil")?;
    let initial = problem.initial();
    let undrivable = |error| progress.failure(error);
    let refitted = fit_with_noise(problem, &[], &initial, &mut noise).map_err(undrivable)?;
    progress.in_time(problem.deadline)?;
    let (mut problem, refitted) = reconstructed(problem, refitted, &mut noise, progress);
    progress.in_time(problem.deadline)?;
    problem.tolerate(&noise);
    let mut stage = screen(problem.clone(), refitted, &mut noise, options, progress)?;
    stage.problem.deadline = progress.search_deadline();
    // The fallback if no time remains to fit it under the final noise.
    let known = progress.limit().map(|_| stage.fit.clone());
    progress.step("fitting candidates")?;
    let mut fitted = try_all(&stage, &noise, progress)?;
    for _ in 0..AGAIN {
        if progress.is_late() {
            break;
        }
        let Some(better) = unstuck(&stage, &fitted, &noise) else {
            break;
        };
        match screen(stage.problem.clone(), better, &mut noise, options, progress) {
            Err(DiagnosisError::OutOfTime) => break,
            screening => stage = screening?,
        }
        progress.step("fitting candidates")?;
        fitted = try_all(&stage, &noise, progress)?;
    }
    let first = Arc::clone(&stage.screening);
    let tested = stage.scores.is_some();
    let baseline = stage.fit.solution.clone();
    let gain = |n: &FittedCandidate| Some((n.proposal.subject, held_out_gain(n, &stage)?));
    let gains = fitted.iter().filter_map(gain).collect();
    let path = Path::new(stage, noise).explored(fitted, options, progress)?;
    let Path {
        mut stage,
        noise,
        accepted,
        refused,
        ..
    } = path;
    let tried = !progress.was_late();
    stage.problem.deadline = problem.deadline;
    let again = refit_soil(&problem, &baseline, &stage.fit.solution, &noise);
    let refitted = match (again, known) {
        (Err(PredictionError::OutOfTime), Some(known)) => continue_fit(
            &problem,
            &known,
            &noise,
            Stop::after(0, 0.0).without_renewals(),
        ),
        (again, _) => again.map_err(undrivable)?,
    };
    Ok(SearchResult {
        problem,
        noise,
        refitted,
        placed: stage.problem,
        augmented: stage.fit,
        accepted,
        refused,
        gains,
        tested,
        tried,
        first,
        last: stage.screening,
    })
}

/// The refitted model under the final noise and weights, from the final starts, or from the earlier ones if the model
/// cannot follow those.
fn refit_soil(
    problem: &Problem,
    baseline: &Solution,
    last: &Solution,
    noise: &NoiseModel,
) -> Result<FittedHypothesis, PredictionError> {
    let all = 0..problem.candidates.coefficients.len();
    let mut initial = problem.turned_off(last, all);
    initial.soil.clone_from(&baseline.soil);
    fit_hypothesis(problem, &[], &initial, noise)
        .or_else(|_| fit_hypothesis(problem, &[], baseline, noise))
}
