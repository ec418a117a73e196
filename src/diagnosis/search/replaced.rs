//! Other mechanisms in the place of the likeliest.
//!
//! Which proposals are fitted first is decided beside a soil that imitates what is missing. The likeliest fit has
//! nearly the right soil and motion. There every mechanism is asked what it would do in the place of the likeliest
//! (see [`replacements`]), and the fits of those that come close start where the linearised problem puts them. So no
//! mechanism loses because its fit went elsewhere.

use super::initial_guess::after_steps;
use super::naming::{FittedCandidate, PartialFit, finish};
use super::proposal::{Proposal, ProposalKind};
use super::rerank::AT_STAKE;
use super::stage::Stage;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::Solution;
use crate::diagnosis::hypothesis::likelihood::{LONG_PARTIAL_FIT, fit_until};
use crate::diagnosis::screening::replacement::{Replacement, replacements};
use crate::fit::problem::NoiseModel;

/// The linearised odds of a mechanism may miss its fit by this, and by this share of what the likeliest gains there.
const UNSURE: f64 = 15.0;
const UNSURE_SHARE: f64 = 0.05;
/// A fit whose odds the linearised ones exceed by less is as good.
const BETTER: f64 = 2.5;
/// Maximum number of fits.
const MAX_FITS: usize = 3;

/// The likeliest, if it acts throughout and its odds are high, also as ranked. All other odds here are under the common
/// noise.
fn replaceable<'n, 'a>(fitted: &'n [FittedCandidate<'a>]) -> Option<&'n FittedCandidate<'a>> {
    let odds = FittedCandidate::odds_under_common_noise;
    let best = fitted.iter().max_by(|a, b| odds(a).total_cmp(&odds(b)))?;
    let throughout = best.proposal.kind() != ProposalKind::Local;
    (throughout && best.odds() > AT_STAKE).then_some(best)
}

/// Adds these fits; each mechanism that acts throughout keeps its likelier one.
pub fn take_over<'a>(fitted: &mut Vec<FittedCandidate<'a>>, other: Vec<FittedCandidate<'a>>) {
    for one in other {
        match fitted
            .iter()
            .position(|known| is_of(known, one.proposal.subject))
        {
            Some(place)
                if fitted[place].odds_under_common_noise() >= one.odds_under_common_noise() => {}
            Some(place) => fitted[place] = one,
            None => fitted.push(one),
        }
    }
}

/// Whether a fit is of this mechanism, throughout.
fn is_of(fitted: &FittedCandidate, subject: Subject) -> bool {
    fitted.proposal.subject == subject && fitted.proposal.kind() != ProposalKind::Local
}

/// Fits of mechanisms in the place of the likeliest, if that acts throughout.
#[must_use]
pub fn replaced<'a>(
    stage: &Stage<'a>,
    fitted: &[FittedCandidate<'a>],
    noise: &NoiseModel,
) -> Vec<FittedCandidate<'a>> {
    let Some(best) = replaceable(fitted) else {
        return Vec::new();
    };
    let own = &best.proposal.coefficients;
    let (all, removed) = replacements(&best.problem, &best.fit, own, noise);
    let linearised = |one: &Replacement| best.gain + best.proposal.log_prior() + one.odds;
    let min_odds = best.odds_under_common_noise() - UNSURE - UNSURE_SHARE * removed.max(0.0);
    let promising = all.iter().filter(|one| {
        let same = fitted.iter().filter(|known| is_of(known, one.subject));
        let known = same.map(FittedCandidate::odds_under_common_noise);
        let known = known.fold(f64::NEG_INFINITY, f64::max);
        linearised(one) > min_odds && linearised(one) > known + BETTER
    });
    let fits = promising
        .take(MAX_FITS)
        .filter_map(|one| in_place_of(stage, best, one, min_odds, noise));
    fits.collect()
}

/// A mechanism's fit from where the linearised problem puts it, finished if it may reach `min_odds`.
fn in_place_of<'a>(
    stage: &Stage<'a>,
    best: &FittedCandidate<'a>,
    one: &Replacement,
    min_odds: f64,
    noise: &NoiseModel,
) -> Option<FittedCandidate<'a>> {
    let before = &stage.fit;
    let problem = &stage.problem;
    let proposal = Proposal {
        soil: one.soil.clone(),
        ..Proposal::new(one.subject, problem.candidates.of(one.subject).collect())
    };
    let mut coefficients = before.coefficients.clone();
    coefficients.extend(&proposal.coefficients);
    let mut there: Solution = best.fit.solution.clone();
    there.take(&best.proposal.coefficients, &before.solution);
    for recording in &mut there.coefficients {
        for k in &proposal.coefficients {
            recording[*k] = problem.candidates[*k].typical;
        }
        for (k, at) in &one.coordinates {
            recording[*k] = *at;
        }
    }
    let start = after_steps(problem, &proposal, &there, 1.0);
    let fit = fit_until(problem, &coefficients, &start, noise, LONG_PARTIAL_FIT).ok()?;
    // All of them relative to the same.
    let without = best.gain + best.fit.negative_log_evidence + best.proposal.price;
    let partial = PartialFit {
        gain: without - fit.negative_log_evidence,
        ..PartialFit::new(&proposal, problem, fit, before)
    };
    let partial = partial.shaped(before, noise);
    if partial.promise() < min_odds {
        return None;
    }
    let fit = finish(partial, before, noise)?;
    Some(FittedCandidate {
        gain: without - fit.fit.negative_log_evidence,
        ..fit
    })
}
