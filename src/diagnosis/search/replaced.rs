//! Other mechanisms in the place of the likeliest.
//!
//! Which proposals are fitted first is decided beside a soil that imitates what is missing. The likeliest fit has
//! nearly the right soil and motion. There every mechanism is asked what it would do in the place of the likeliest
//! (see [`replacements`]), and the fits of those that come close begin where the linearised problem puts them. So no
//! mechanism loses because its fit went elsewhere.

use super::naming::{FittedCandidate, PartialFit, finish};
use super::proposal::{Proposal, ProposalKind};
use super::rerank::AT_STAKE;
use super::stage::Stage;
use super::trial::CLOSE;
use crate::diagnosis::hypothesis::likelihood::{LONG_PARTIAL_FIT, fit_until};
use crate::diagnosis::hypothesis::Solution;
use crate::diagnosis::screening::replacement::{Replacement, replacements};
use crate::fit::problem::NoiseModel;

/// The linearised odds of a mechanism may miss its fit by this, and by this share of what the likeliest gains there.
const UNSURE: f64 = 15.0;
const UNSURE_SHARE: f64 = 0.05;
/// A fit begins at these multiples of the linearised amplitude: what the soil absorbs may be larger, and its fit has
/// several optima.
const FACTORS: [f64; 2] = [1.0, 2.0];
/// Maximum number of fits.
const MOST: usize = 3;

/// Fits of mechanisms in the place of the likeliest, if that acts throughout.
#[must_use]
pub fn replaced<'a>(
    stage: &Stage<'a>,
    fitted: &[FittedCandidate<'a>],
    noise: &NoiseModel,
) -> Vec<FittedCandidate<'a>> {
    let likelier = |a: &&FittedCandidate, b: &&FittedCandidate| a.odds().total_cmp(&b.odds());
    let Some(best) = fitted.iter().max_by(likelier) else {
        return Vec::new();
    };
    if best.odds() < AT_STAKE || best.proposal.kind() == ProposalKind::Local {
        return Vec::new();
    }
    let own = &best.proposal.coefficients;
    let (all, removed) = replacements(&best.problem, &best.fit, own, noise);
    let linearised = |one: &Replacement| best.gain + best.proposal.log_prior() + one.odds;
    if std::env::var_os("DEBUG_STEPS").is_some() {
        eprintln!("LEADER {} {:.1}", best.proposal.subject.name(), best.odds());
        for one in all.iter().take(8) { eprintln!("   REPL {} {:.1} {:?} soil {:.2?}", one.subject.name(), one.odds, one.coordinates, one.soil.as_slice()); }
    }
    let min_odds = best.odds() - UNSURE - UNSURE_SHARE * removed.max(0.0);
    let promising = all.iter().filter(|one| {
        let same = |other: &&FittedCandidate| {
            other.proposal.subject == one.subject && other.proposal.kind() != ProposalKind::Local
        };
        let known = fitted.iter().filter(same).map(FittedCandidate::odds);
        let known = known.fold(f64::NEG_INFINITY, f64::max);
        linearised(one) > min_odds && linearised(one) > known + 0.5 * CLOSE
    });
    let fits = promising
        .take(MOST)
        .filter_map(|one| in_place_of(stage, best, one, noise));
    fits.collect()
}

/// A mechanism's fit from where the linearised problem puts it.
fn in_place_of<'a>(
    stage: &Stage<'a>,
    best: &FittedCandidate<'a>,
    one: &Replacement,
    noise: &NoiseModel,
) -> Option<FittedCandidate<'a>> {
    let before = &stage.fit;
    let problem = &stage.problem;
    let proposal = Proposal {
        anew: true,
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
    let soil = there.soil.iter_mut().zip(problem.soil_parameters());
    for ((value, parameter), step) in soil.zip(one.soil.iter()) {
        let (low, high) = parameter.bounds();
        *value = (*value + step).clamp(low, high);
    }
    let starts = FACTORS.map(|factor| {
        let mut start = there.clone();
        for recording in &mut start.coefficients {
            for k in &proposal.coefficients {
                let about = &problem.candidates[*k];
                let (low, high) = about.parameter.bounds();
                if !about.is_shape() {
                    let away = factor * (recording[*k] - about.off());
                    recording[*k] = (about.off() + away).clamp(low, high);
                }
            }
        }
        start
    });
    let fits = starts.iter().filter_map(|start| {
        let fit = fit_until(problem, &coefficients, start, noise, LONG_PARTIAL_FIT);
        fit.ok().filter(|fit| fit.negative_log_evidence.is_finite())
    });
    let fit = fits.min_by(|a, b| a.negative_log_evidence.total_cmp(&b.negative_log_evidence))?;
    if std::env::var_os("DEBUG_STEPS").is_some() {
        eprintln!("  START {} gain {:.1} pred {:.1} {:?} soil {:.2?}", one.subject.name(), before.negative_log_evidence - fit.negative_log_evidence, fit.predicted_reduction, proposal.coefficients.iter().map(|k| fit.solution.coefficients[0][*k]).collect::<Vec<_>>(), fit.solution.soil);
    }
    let fit = finish(PartialFit::new(&proposal, problem, fit, before), before, noise)?;
    // All of them relative to the same.
    let without = best.gain + best.fit.negative_log_evidence + best.proposal.price;
    Some(FittedCandidate {
        gain: without - fit.fit.negative_log_evidence,
        ..fit
    })
}
