//! Full fits of the proposals of a stage: first steps for all, the promising ones are finished.

use super::colocated::{beside_the_likeliest, fitted_there, join, likeliest, otherwise_confined};
use super::naming::{FittedCandidate, PartialFit, finish, partial_fit};
use super::proposal::{Proposal, ProposalKind};
use super::replaced::{replaced, take_over};
use super::rerank::{AT_STAKE, MAX_COMPARED, Ranking};
use super::stage::Stage;
use super::subsample_search::SubsampleSearch;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::FittedHypothesis;
use crate::diagnosis::{DiagnosisError, Progress};
use crate::fit::problem::NoiseModel;

/// Share of the best log odds that first steps need to be finished, and on a subsample to continue on all segments.
const NEAR: f64 = 0.75;
const NEAR_ON_A_PART: f64 = 0.5;
/// The same in the region of the likeliest, where the choice of the region does not differ.
const NEAR_THERE: f64 = 0.9;
pub const CLOSE: f64 = 5.0;
/// Share of a residual model's odds from which effects are followed: it may be two effects at once.
pub const GOOD_PART: f64 = 0.2;
/// Maximum ratio of a local effect's final to its linearised gain.
const LINEAR: f64 = 3.0;
/// Maximum number of finished fits.
const MOST: usize = 7;

/// Share of the remaining search time for first steps: without finished fits they are worth little.
const FIRST_STEPS: f64 = 0.6;

/// Fits the proposals: all take first steps, and those close to the best are finished. At the deadline partial fits
/// stay as they are, and cannot be accepted.
///
/// # Errors
/// The caller wants it to end.
pub fn try_all<'a>(
    stage: &Stage<'a>,
    noise: &NoiseModel,
    progress: &'a Progress,
) -> Result<Vec<FittedCandidate<'a>>, DiagnosisError> {
    let Stage {
        problem,
        fit,
        proposals,
        ..
    } = stage;
    let hasty = Problem {
        deadline: progress.share_of_search(FIRST_STEPS),
        ..problem.clone()
    };
    let subsample_search = SubsampleSearch::new(&hasty, fit, noise);
    let started = || {
        let mut started = match &subsample_search {
            Some(subsample_search) => subsampled(&hasty, stage, subsample_search, noise),
            None => all_partially_fitted(&hasty, proposals, fit, noise),
        };
        for partial_fit in &mut started {
            partial_fit.problem.deadline = problem.deadline;
        }
        promising(started, NEAR, MOST)
    };
    let best =
        |fitted: &[FittedCandidate]| fitted.iter().map(FittedCandidate::odds).fold(0.0, f64::max);
    let (mut fitted, mut unfinished) = (Vec::new(), Vec::new());
    for partial_fit in started() {
        progress.go_on()?;
        if progress.is_late() {
            unfinished.push(partial_fit.unfinished());
            continue;
        }
        let finished = finish(partial_fit, fit, noise);
        let list = if progress.is_late() {
            &mut unfinished
        } else {
            &mut fitted
        };
        list.extend(finished);
    }
    for where_else in [beside_the_likeliest, otherwise_confined] {
        progress.go_on()?;
        let likeliest = likeliest(&fitted).filter(|_| !progress.is_late());
        let Some((likeliest, _)) = likeliest else {
            break;
        };
        let there = where_else(stage, &fitted);
        let min_odds = NEAR_THERE * best(&fitted) - CLOSE;
        let there = fitted_there(stage, &there, likeliest, min_odds, noise);
        if !progress.is_late() {
            join(&mut fitted, there);
        }
    }
    if unfinished.is_empty() && !progress.is_late() {
        let mut ranking = Ranking::new(stage, noise);
        // What another noise explains as well is replaced in vain.
        ranking.rank(&mut fitted, 1);
        let other = replaced(stage, &fitted, noise);
        if !progress.is_late() {
            take_over(&mut fitted, other);
        }
        ranking.rank(&mut fitted, MAX_COMPARED);
    }
    let largest = best(&fitted);
    let unfinished = unfinished.into_iter();
    fitted.extend(unfinished.map(|candidate| candidate.behind(largest)));
    Ok(fitted)
}

/// First steps of all proposals: those that act throughout, then the local ones that may come close, and hidden ones
/// unless one that acts throughout explains much. If one does, its fit has nearly the right motion, and there other
/// mechanisms take its place, hidden ones too (see [`replaced`]).
fn all_partially_fitted<'a>(
    problem: &Problem<'a>,
    proposals: &[Proposal],
    before: &FittedHypothesis,
    noise: &NoiseModel,
) -> Vec<PartialFit<'a>> {
    let in_time = |_: &&Proposal| !problem.deadline.is_over();
    let fit = |one: &Proposal, min_odds| partial_fit(problem, one, before, noise, 1.0, min_odds);
    let (hidden, seen): (Vec<_>, Vec<_>) = proposals.iter().partition(|p| p.hidden);
    let (local, throughout): (Vec<_>, Vec<_>) = seen
        .into_iter()
        .partition(|p| p.kind() == ProposalKind::Local);
    let throughout = throughout.into_iter().take_while(in_time);
    let mut started = partially_fitted(Vec::new(), throughout, NEAR, fit);
    let bar = OddsThreshold::of(&started);
    let local = local.into_iter().filter(|p| bar.may_be_near(p, NEAR));
    started = partially_fitted(started, local.take_while(in_time), NEAR, fit);
    let explains_much =
        |one: &PartialFit| one.proposal.kind() != ProposalKind::Local && one.odds() > AT_STAKE;
    if started.iter().any(explains_much) {
        return started;
    }
    partially_fitted(started, hidden.into_iter().take_while(in_time), NEAR, fit)
}

/// First steps on a long recording: effects that act throughout are fitted to a subsample, and to all segments if
/// their odds hold; local effects to all segments, if they may come close.
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
    let started = partially_fitted(Vec::new(), throughout, NEAR_ON_A_PART, |one, min_odds| {
        subsample_search.partial_fit(one, min_odds)
    });
    let near = promising(started, NEAR_ON_A_PART, 2 * MOST);
    let further = near
        .iter()
        .map(|partial_fit| subsample_search.further(partial_fit));
    let near = promising(further.collect(), NEAR_ON_A_PART, MOST);
    let bar = OddsThreshold::of(&near);
    let widened = near.iter().take_while(|_| in_time());
    let widened = widened.filter_map(|partial_fit| {
        let min_odds = bar.min_odds(partial_fit.proposal.kind(), NEAR);
        subsample_search.widened(partial_fit, problem, fit, noise, min_odds)
    });
    let local = local
        .into_iter()
        .filter(|p| bar.may_be_near(p, NEAR_ON_A_PART));
    let local = local.take_while(|_| in_time());
    let min_odds = |one: &Proposal| bar.min_odds(one.kind(), NEAR_ON_A_PART);
    let local = local.filter_map(|one| partial_fit(problem, one, fit, noise, 1.0, min_odds(one)));
    widened.chain(local).collect()
}

/// Adds the proposals whose fit succeeded. Each is followed as long as it may reach this share of the best so far.
fn partially_fitted<'a, 'p>(
    mut started: Vec<PartialFit<'a>>,
    proposals: impl Iterator<Item = &'p Proposal>,
    share: f64,
    fit: impl Fn(&Proposal, f64) -> Option<PartialFit<'a>>,
) -> Vec<PartialFit<'a>> {
    for proposal in proposals {
        let min_odds = OddsThreshold::of(&started).min_odds(proposal.kind(), share);
        started.extend(fit(proposal, min_odds));
    }
    started
}

/// Those that may reach this share of the best, the most promising first, up to a maximum number.
fn promising<'a>(
    mut fits: Vec<PartialFit<'a>>,
    share: f64,
    max_count: usize,
) -> Vec<PartialFit<'a>> {
    fits.sort_by(|a, b| b.promise().total_cmp(&a.promise()));
    // A proposal from the screen and as a hidden one at the same optimum is finished once.
    let mut once: Vec<PartialFit> = Vec::new();
    for partial_fit in fits {
        if !once.iter().any(|earlier| partial_fit.is_twin_of(earlier)) {
            once.push(partial_fit);
        }
    }
    let mut fits = once;
    let bar = OddsThreshold::of(&fits);
    fits.truncate(max_count);
    fits.retain(|partial_fit| {
        partial_fit.promise() > bar.min_odds(partial_fit.proposal.kind(), share)
    });
    fits
}

/// The largest log odds of residual models and of names, as a reference for the others.
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

    /// Whether a local proposal may come near by its linearised evidence.
    fn may_be_near(&self, proposal: &Proposal, share: f64) -> bool {
        LINEAR * proposal.evidence > self.min_odds(proposal.kind(), share)
    }

    /// Minimum log odds to continue. Names are compared with the best name, if that explains a good share of what a
    /// residual model does.
    fn min_odds(&self, kind: ProposalKind, share: f64) -> f64 {
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
            // Two effects at once: a residual model has nearly all of both, each name two thirds or less.
            let min_odds = bar(1000.0, 400.0).min_odds(kind, NEAR);
            assert!((300.0 - CLOSE - min_odds).abs() < 1e-9);
            // A name that explains nearly none of it is dropped, however good it is among names.
            let min_odds = bar(1000.0, 10.0).min_odds(kind, NEAR);
            assert!((GOOD_PART * 1000.0 - CLOSE - min_odds).abs() < 1e-9);
        }
        let min_odds = |residual_model, name| {
            bar(residual_model, name).min_odds(ProposalKind::ResidualModel, NEAR)
        };
        assert!((min_odds(1000.0, 400.0) - min_odds(400.0, 1000.0)).abs() < 1e-9);
    }
}
