//! What may be missing, fitted beside a hypothesis: all start, the promising ones are finished.

use super::colocated::{beside_the_likeliest, fitted_there, join, likeliest, otherwise_confined};
use super::edges::settle_edges;
use super::given_soil::from_given_soil;
use super::naming::{FittedCandidate, PartialFit, finish, partial_fit};
use super::proposal::{Proposal, ProposalKind};
use super::rerank::rerank;
use super::stage::Stage;
use super::subsample_search::SubsampleSearch;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::{DiagnosisError, Progress};
use crate::fit::problem::NoiseModel;

/// Fits that are further behind after their first steps are not finished, or not widened to all segments.
const NEAR: f64 = 0.75;
const NEAR_ON_A_PART: f64 = 0.5;
/// The same where the likeliest acts: they do not differ by where they were looked for.
const NEAR_THERE: f64 = 0.9;
pub const CLOSE: f64 = 5.0;
/// Where a residual model is likeliest, names lead on as well that have this share of its odds: a residual model may be two effects at once.
pub const GOOD_PART: f64 = 0.2;
/// What acts at some time or place only comes to at most so many times what the linearised problem promises.
const LINEAR: f64 = 3.0;
/// At most so many are finished.
const MOST: usize = 7;

/// Of the time that the search still has, first steps may take this share: what has begun is worth little unless some of
/// it is finished.
const FIRST_STEPS: f64 = 0.6;

/// Fits what is worth it: all start, and those that are not far behind after some steps are finished. Where time is up,
/// what has begun stands as it is, and nothing can be named by it.
///
/// # Errors
/// The caller wants it to end.
pub fn try_all<'a>(
    stage: &Stage<'a>,
    noise: &NoiseModel,
    progress: &'a Progress,
) -> Result<Vec<FittedCandidate<'a>>, DiagnosisError> {
    let Stage { problem, fit, .. } = stage;
    let hasty = Problem {
        deadline: progress.share_of_search(FIRST_STEPS),
        ..problem.clone()
    };
    let mut started = match SubsampleSearch::new(&hasty, fit, noise) {
        Some(subsample_search) => subsampled(&hasty, stage, &subsample_search, noise),
        None => {
            let all = stage.proposals.iter();
            let all = all.take_while(|_| !hasty.deadline.is_over());
            partially_fitted(all, NEAR, |one, least| {
                partial_fit(&hasty, one, fit, noise, 1.0, least)
            })
        }
    };
    for partial_fit in &mut started {
        partial_fit.problem.deadline = problem.deadline;
    }
    let best =
        |fitted: &[FittedCandidate]| fitted.iter().map(FittedCandidate::odds).fold(0.0, f64::max);
    let (mut fitted, mut unfinished) = (Vec::new(), Vec::new());
    for partial_fit in promising(started, NEAR, MOST) {
        progress.go_on()?;
        if progress.is_late() {
            unfinished.push(partial_fit.unfinished());
            continue;
        }
        let finished = finish(from_given_soil(partial_fit, fit, noise), fit, noise);
        let list = if progress.is_late() {
            &mut unfinished
        } else {
            &mut fitted
        };
        list.extend(finished);
    }
    let largest = best(&fitted);
    settle_edges(&mut fitted, largest, noise);
    for where_else in [beside_the_likeliest, otherwise_confined] {
        progress.go_on()?;
        let likeliest = likeliest(&fitted).filter(|_| !progress.is_late());
        let Some((likeliest, _)) = likeliest else {
            break;
        };
        let there = where_else(stage, &fitted);
        let least = NEAR_THERE * best(&fitted) - CLOSE;
        let mut there = fitted_there(stage, &there, likeliest, least, noise);
        let largest = best(&fitted).max(best(&there));
        settle_edges(&mut there, largest, noise);
        if !progress.is_late() {
            join(&mut fitted, there);
        }
    }
    if unfinished.is_empty() {
        rerank(&mut fitted, noise);
    }
    let largest = best(&fitted);
    let unfinished = unfinished.into_iter();
    fitted.extend(unfinished.map(|candidate| candidate.behind(largest)));
    Ok(fitted)
}

/// The first steps on a long recording: what acts throughout takes them on a part, and on all of it where it
/// keeps its promise; what acts at some time or place only takes all, where it may come near.
fn subsampled<'a>(
    problem: &Problem<'a>,
    stage: &Stage<'a>,
    subsample_search: &SubsampleSearch<'a>,
    noise: &NoiseModel,
) -> Vec<PartialFit<'a>> {
    let Stage { fit, proposals, .. } = stage;
    let in_time = || !problem.deadline.is_over();
    let (throughout, local): (Vec<_>, Vec<_>) = proposals.iter().partition(|p| p.extent.is_none());
    let throughout = throughout.into_iter().take_while(|_| in_time());
    let started = partially_fitted(throughout, NEAR_ON_A_PART, |one, least| {
        subsample_search.partial_fit(one, least)
    });
    let near = promising(started, NEAR_ON_A_PART, 2 * MOST);
    let further = near
        .iter()
        .map(|partial_fit| subsample_search.further(partial_fit));
    let near = promising(further.collect(), NEAR_ON_A_PART, MOST);
    let bar = OddsThreshold::of(&near);
    let widened = near.iter().take_while(|_| in_time());
    let widened = widened.filter_map(|partial_fit| {
        let least = bar.least(partial_fit.proposal.kind(), NEAR);
        subsample_search.widened(partial_fit, problem, fit, noise, least)
    });
    let may_be_near = |p: &&Proposal| LINEAR * p.evidence > bar.least(p.kind(), NEAR_ON_A_PART);
    let local = local.into_iter().filter(may_be_near);
    let local = local.take_while(|_| in_time());
    let least = |one: &Proposal| bar.least(one.kind(), NEAR_ON_A_PART);
    let local = local.filter_map(|one| partial_fit(problem, one, fit, noise, 1.0, least(one)));
    widened.chain(local).collect()
}

/// Those whose fit could start. Each is followed as far as it may come to this share of the best so far.
fn partially_fitted<'a, 'p>(
    proposals: impl Iterator<Item = &'p Proposal>,
    share: f64,
    fit: impl Fn(&Proposal, f64) -> Option<PartialFit<'a>>,
) -> Vec<PartialFit<'a>> {
    let mut started = Vec::new();
    for proposal in proposals {
        let least = OddsThreshold::of(&started).least(proposal.kind(), share);
        started.extend(fit(proposal, least));
    }
    started
}

/// Those that may come to this share of the best, the most promising first, at most so many.
fn promising<'a>(mut fits: Vec<PartialFit<'a>>, share: f64, most: usize) -> Vec<PartialFit<'a>> {
    fits.sort_by(|a, b| b.promise().total_cmp(&a.promise()));
    // What was proposed twice, as seen and as hidden, and came to the same is finished once.
    let mut once: Vec<PartialFit> = Vec::new();
    for partial_fit in fits {
        if !once.iter().any(|earlier| partial_fit.is_twin_of(earlier)) {
            once.push(partial_fit);
        }
    }
    let mut fits = once;
    let bar = OddsThreshold::of(&fits);
    fits.truncate(most);
    fits.retain(|partial_fit| {
        partial_fit.promise() > bar.least(partial_fit.proposal.kind(), share)
    });
    fits
}

/// The largest log odds of residual models and of names, by which the others are measured.
struct OddsThreshold {
    residual_model: f64,
    name: f64,
}

impl OddsThreshold {
    fn of(fits: &[PartialFit]) -> Self {
        let is_residual_model =
            |partial_fit: &&PartialFit| partial_fit.proposal.kind() == ProposalKind::ResidualModel;
        let (residual_models, names): (Vec<&PartialFit>, Vec<&PartialFit>) =
            fits.iter().partition(is_residual_model);
        let best = |of: Vec<&PartialFit>| of.into_iter().map(PartialFit::odds).fold(0.0, f64::max);
        Self {
            residual_model: best(residual_models),
            name: best(names),
        }
    }

    /// What comes to less is not gone on with: less than this share of the best. Of what has a name the best with a
    /// name counts, where that explains a good part of what a residual model does.
    fn least(&self, kind: ProposalKind, share: f64) -> f64 {
        let best = match kind {
            ProposalKind::ResidualModel => share * self.residual_model.max(self.name),
            _ => (share * self.name).max(GOOD_PART * self.residual_model),
        };
        best - CLOSE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_does_not_set_the_bar_for_names() {
        let bar = |residual_model, name| OddsThreshold {
            residual_model,
            name,
        };
        for kind in [ProposalKind::Throughout, ProposalKind::Local] {
            // Two effects at once: a residual model has the most of both, each name two thirds or less.
            let least = bar(1000.0, 400.0).least(kind, NEAR);
            assert!((300.0 - CLOSE - least).abs() < 1e-9);
            // A name that explains next to nothing of it leads nowhere, however good it is among names.
            let least = bar(1000.0, 10.0).least(kind, NEAR);
            assert!((GOOD_PART * 1000.0 - CLOSE - least).abs() < 1e-9);
        }
        let least = |residual_model, name| {
            bar(residual_model, name).least(ProposalKind::ResidualModel, NEAR)
        };
        assert!((least(1000.0, 400.0) - least(400.0, 1000.0)).abs() < 1e-9);
    }
}
