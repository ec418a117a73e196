//! Other mechanisms in the place of the likeliest.
//!
//! Which proposals are fitted first is decided beside a soil that imitates what is missing. The likeliest fit has
//! nearly the right soil and motion. There every mechanism is asked what it would do in the place of the likeliest
//! (see [`replacements`]), and the fits of those that come close start where the linearised problem puts them. So no
//! mechanism loses because its fit went elsewhere.

use super::initial_guess::after_steps;
use super::naming::{FittedCandidate, PartialFit, finish};
use super::own_noise::{OwnNoise, under_own_noise};
use super::proposal::{Proposal, ProposalKind};
use super::rerank::AT_STAKE;
use super::stage::Stage;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, LONG_PARTIAL_FIT, fit_until};
use crate::diagnosis::screening::replacement::{Replacement, replacements};
use crate::fit::optimiser::Stop;
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

/// Other mechanisms in the place of an accepted effect beside all others.
#[derive(Debug)]
pub struct RivalsInPlace {
    /// Fits under the noise that they leave, of those that the linearised problem puts near the effect.
    pub near: Vec<(Proposal, OwnNoise)>,
    /// Those that it puts far behind, and upper limits of their log odds relative to the effect.
    pub far: Vec<(Subject, f64)>,
}

/// Other mechanisms in the place of an accepted effect that acts throughout.
#[must_use]
pub fn rivals_in_place(stage: &Stage, effect: &Proposal, noise: &NoiseModel) -> RivalsInPlace {
    let Stage { problem, fit, .. } = stage;
    let own = &effect.coefficients;
    let (all, removed) = replacements(problem, fit, own, noise);
    let unsure = UNSURE + UNSURE_SHARE * removed.max(0.0);
    let others = all.iter().filter(|one| one.subject != effect.subject);
    let (near, far): (Vec<_>, Vec<_>) = others.partition(|one| one.odds > -unsure);
    let lost = fit.misfit + unsure;
    let stop = LONG_PARTIAL_FIT.unless_above(2.0 * (lost + UNSURE));
    let near = near.into_iter().take(MAX_FITS).filter_map(|one| {
        let (proposal, fit) = first_fit(problem, fit, own, one, noise, stop)?;
        let is_near = fit.misfit - fit.predicted_reduction < lost + UNSURE;
        is_near.then(|| (proposal, under_own_noise(problem, &fit, noise)))
    });
    let far = far.into_iter();
    RivalsInPlace {
        near: near.collect(),
        far: far.map(|one| (one.subject, one.odds + unsure)).collect(),
    }
}

/// First steps of a mechanism in the place of some coefficients of a fit, from where the linearised problem puts it.
fn first_fit(
    problem: &Problem,
    fit: &FittedHypothesis,
    own: &[usize],
    one: &Replacement,
    noise: &NoiseModel,
    stop: Stop,
) -> Option<(Proposal, FittedHypothesis)> {
    let proposal = Proposal {
        soil: one.soil.clone(),
        ..Proposal::new(one.subject, problem.candidates.of(one.subject).collect())
    };
    let others = fit.coefficients.iter().filter(|k| !own.contains(k));
    let coefficients: Vec<usize> = others.chain(&proposal.coefficients).copied().collect();
    let mut there = problem.turned_off(&fit.solution, own.iter().copied());
    for recording in &mut there.coefficients {
        for k in &proposal.coefficients {
            recording[*k] = problem.candidates[*k].typical;
        }
        for (k, at) in &one.coordinates {
            recording[*k] = *at;
        }
    }
    let start = after_steps(problem, &proposal, &there, 1.0);
    let fit = fit_until(problem, &coefficients, &start, noise, stop).ok()?;
    Some((proposal, fit))
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
    let own = &best.proposal.coefficients;
    let (proposal, fit) = first_fit(problem, &best.fit, own, one, noise, LONG_PARTIAL_FIT)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::search::naming::{ANY, partial_fit};
    use crate::diagnosis::testing::{driven, named, on, refitted, with_effects};

    #[test]
    fn likelier_names_are_found_in_the_place_of_a_wrong_one() {
        let nominal = on("sandy_loam");
        let truth = with_effects(&nominal, r#"{"drag": {"coefficient": 150}}"#);
        let recordings = [driven(&truth, "slalom")];
        let (mut stage, noise) = refitted(&nominal, &recordings);
        let proposed = |name: &str| {
            let coefficients = stage.problem.candidates.of(named(name)).collect();
            Proposal::new(named(name), coefficients)
        };
        let tow = proposed("drawbar");
        let wrong = partial_fit(&stage.problem, &tow, &stage.fit, &noise, 1.0, ANY).unwrap();
        let own = under_own_noise(&stage.problem, &wrong.fit, &noise);
        stage.fit = wrong.fit;
        let rivals = rivals_in_place(&stage, &tow, &noise);
        assert!(!rivals.near.is_empty() && !rivals.far.is_empty());
        for (one, with) in &rivals.near {
            assert_ne!(one.subject, tow.subject);
            assert!(with.evidence.negative_log < own.evidence.negative_log - 5.0);
        }
        assert!(rivals.far.iter().all(|(_, odds)| *odds <= 0.0));
    }
}
