//! Full fits of proposals.
//!
//! The best few candidates of the screen, of the box scan and of the residual models are fitted in full beside the
//! accepted effects. The one with the largest log odds is accepted if it exceeds the threshold and predicts held-out
//! data no worse (blocked cross-validation, see `held_out`). Then everything is screened again beside it.

use super::accepted::{NOTHING, TAKE};
use super::initial_guess::{LOST, after_steps, cheapest, compared, continued, settled};
use super::own_noise::OwnNoise;
use super::proposal::{Proposal, ProposalKind};
use crate::diagnosis::hypothesis::held_out::{Scores, scores};
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, LONG_PARTIAL_FIT, PARTIAL_FIT, fit_restarted, fit_until,
};
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::diagnosis::screening::region::Region;
use crate::diagnosis::screening::shape;
use crate::effects::{self, ParameterName, Window};
use crate::fit::optimiser::Stop;
use crate::fit::problem::NoiseModel;
use crate::fit::segment::CLOCK;

/// Two fits of one proposal this close are at one optimum.
const TWINS: f64 = 1.0;
/// A fit with less than this share of the predicted gain has failed as well.
const SHORT: f64 = 0.5;

/// A threshold of log odds that every fit exceeds.
#[cfg(test)]
pub const ANY: f64 = f64::NEG_INFINITY;
/// Difference of priors and determinants between two hypotheses, in log evidence.
const UNSURE: f64 = 15.0;

/// A proposal fitted in full beside the accepted effects.
#[derive(Debug, Clone)]
pub struct FittedCandidate<'a> {
    /// What was proposed.
    pub proposal: Proposal,
    /// The given model with the place where it acts.
    pub problem: Problem<'a>,
    /// The fit.
    pub fit: FittedHypothesis,
    /// How it predicts what it was not fitted to.
    pub scores: Option<Scores>,
    /// Log Bayes factor against the hypothesis without it, by the catalogue's formulas.
    pub gain: f64,
    /// What the shape freedom of all formulas adds to that; zero for an empirical residual model, which mends formulas.
    pub shape: f64,
    /// Whether it only mends the formulas of the effects accepted so far: their shape freedom explains it as well.
    pub mends: bool,
    /// Log odds as ranked, see [`super::rerank`].
    pub ranked: Option<f64>,
    /// Its fit under the noise that it leaves, for those that were ranked by it.
    pub own: Option<OwnNoise>,
}

impl FittedCandidate<'_> {
    /// Log odds against the hypothesis without it.
    #[must_use]
    pub fn odds(&self) -> f64 {
        self.ranked
            .unwrap_or_else(|| self.odds_under_common_noise())
    }

    /// The same under the noise that all candidates were fitted under.
    #[must_use]
    pub fn odds_under_common_noise(&self) -> f64 {
        self.gain + self.shape + self.proposal.log_prior()
    }

    /// Log Bayes factor against the hypothesis without it, by the catalogue's formulas or neighbours of them, as ranked.
    #[must_use]
    pub fn ranked_gain(&self) -> f64 {
        self.odds() - self.proposal.log_prior()
    }

    /// Judges its fit: what shape freedom adds, and how it predicts what it was not fitted to.
    fn judge(&mut self, before: &FittedHypothesis, noise: &NoiseModel) {
        let Self { problem, fit, .. } = self;
        fit.shape_gain = shape::gain_at(problem, &fit.coefficients, &fit.solution, noise);
        self.scores = scores(problem, fit, noise);
        let shape = fit.shape_gain - before.shape_gain;
        let is_residual_model = self.proposal.kind() == ProposalKind::ResidualModel;
        self.shape = if is_residual_model { 0.0 } else { shape };
        let odds = self.odds_under_common_noise();
        self.mends = is_residual_model && odds + shape < NOTHING + TAKE;
    }

    /// Takes another fit under the same noise.
    pub fn refit(&mut self, fit: FittedHypothesis, before: &FittedHypothesis, noise: &NoiseModel) {
        self.gain += self.fit.negative_log_evidence - fit.negative_log_evidence;
        self.fit = fit;
        self.judge(before, noise);
    }

    /// An unfinished candidate: it cannot be accepted, and is no likelier than the likeliest finished one.
    #[must_use]
    pub fn behind(self, likeliest: f64) -> Self {
        Self {
            gain: self
                .gain
                .min(likeliest - self.shape - self.proposal.log_prior()),
            scores: None,
            ..self
        }
    }
}

/// A proposal after the first steps of its fit.
#[derive(Debug)]
pub struct PartialFit<'a> {
    /// What was proposed.
    pub(super) proposal: Proposal,
    /// The given model with the place where it acts.
    pub(super) problem: Problem<'a>,
    /// The fit so far.
    pub(super) fit: FittedHypothesis,
    /// Log Bayes factor against the hypothesis without it, as far as it has come.
    pub(super) gain: f64,
    /// What the shape freedom of all formulas adds to that, see [`FittedCandidate::shape`].
    pub(super) shape: f64,
    /// Factor of the gain, if the fit is to a subsample.
    pub(super) scale: f64,
}

/// The end of a proposal's first steps.
pub fn first_steps(proposal: &Proposal) -> Stop {
    if proposal.hidden {
        LONG_PARTIAL_FIT
    } else {
        PARTIAL_FIT
    }
}

impl<'a> PartialFit<'a> {
    /// A partial fit beside the accepted effects.
    pub fn new(
        proposal: &Proposal,
        problem: &Problem<'a>,
        fit: FittedHypothesis,
        before: &FittedHypothesis,
    ) -> Self {
        Self {
            gain: before.negative_log_evidence - fit.negative_log_evidence - proposal.price,
            proposal: proposal.clone(),
            problem: problem.clone(),
            fit,
            shape: 0.0,
            scale: 1.0,
        }
    }

    /// With the shape freedom of the formulas that are on.
    #[must_use]
    pub fn shaped(mut self, before: &FittedHypothesis, noise: &NoiseModel) -> Self {
        // Where it does nothing, there is nothing to shape.
        let acts = self.gain + self.fit.predicted_reduction > 0.0;
        if acts && self.proposal.kind() != ProposalKind::ResidualModel {
            let FittedHypothesis {
                coefficients,
                solution,
                ..
            } = &self.fit;
            let gain = shape::gain_at(&self.problem, coefficients, solution, noise);
            self.shape = gain - before.shape_gain;
        }
        self
    }

    /// Log odds against the hypothesis without it, as far as it has come.
    #[must_use]
    pub fn odds(&self) -> f64 {
        self.gain + self.shape + self.proposal.log_prior()
    }

    /// Whether it is the same proposal at the same optimum.
    #[must_use]
    pub fn is_twin_of(&self, other: &Self) -> bool {
        (self.proposal.subject, &self.proposal.extent)
            == (other.proposal.subject, &other.proposal.extent)
            && (self.odds() - other.odds()).abs() < TWINS * self.scale
    }

    /// Log odds after the predicted gain of the next step.
    #[must_use]
    pub fn promise(&self) -> f64 {
        self.odds() + self.fit.predicted_reduction
    }

    /// The unfinished candidate with its predicted odds.
    pub fn unfinished(self) -> FittedCandidate<'a> {
        FittedCandidate {
            gain: self.promise() - self.shape - self.proposal.log_prior(),
            shape: self.shape,
            mends: false,
            ranked: None,
            own: None,
            proposal: self.proposal,
            problem: self.problem,
            fit: self.fit,
            scores: None,
        }
    }
}

/// First steps of a proposal's fit to this share of the recordings, as long as it may reach `min_odds` there. `None`
/// if the model cannot follow it.
#[must_use]
pub fn partial_fit<'a>(
    problem: &Problem<'a>,
    proposal: &Proposal,
    before: &FittedHypothesis,
    noise: &NoiseModel,
    share: f64,
    min_odds: f64,
) -> Option<PartialFit<'a>> {
    // Coefficients cost evidence besides their gain.
    let useful = before.misfit - (min_odds + proposal.price - proposal.log_prior());
    let useful = 2.0 * (useful + UNSURE);
    let problem = placed(problem, proposal)?;
    let mut coefficients = before.coefficients.clone();
    coefficients.extend(&proposal.coefficients);
    let cheapest = cheapest(&problem, proposal, &coefficients, &before.solution, noise);
    let stop = first_steps(proposal).unless_above(useful);
    // Delays from cross-correlation cost much until the starts follow: they have a separate fit.
    let initials = cheapest
        .into_iter()
        .chain(compared(&problem, proposal, &before.solution))
        .chain(settled(&problem, proposal, before, noise));
    let each = initials.filter_map(|initial| {
        let fit = fit_until(&problem, &coefficients, &initial, noise, stop);
        fit.ok().filter(|fit| fit.negative_log_evidence.is_finite())
    });
    let likelier = |a: &FittedHypothesis, b: &FittedHypothesis| {
        a.negative_log_evidence.total_cmp(&b.negative_log_evidence)
    };
    let mut fit = each.min_by(likelier);
    let lost =
        |fit: &FittedHypothesis| fit.negative_log_evidence > before.negative_log_evidence + LOST;
    let predicted_reduction = SHORT * share * proposal.evidence;
    let short = |fit: &FittedHypothesis| {
        before.negative_log_evidence - fit.negative_log_evidence + fit.predicted_reduction
            < predicted_reduction - LOST
    };
    let also = |fit: Option<FittedHypothesis>, initial: &Solution| {
        let other = fit_until(
            &problem,
            &coefficients,
            initial,
            noise,
            LONG_PARTIAL_FIT.unless_above(useful),
        )
        .ok();
        fit.into_iter().chain(other).min_by(likelier)
    };
    // After failures: continuation from "off".
    if proposal.hidden
        && fit.as_ref().is_none_or(lost)
        && let Some(initial) = continued(&problem, proposal, before, noise)
    {
        fit = also(fit, &initial);
    }
    if !proposal.hidden && fit.as_ref().is_none_or(lost) {
        // Without the proposal the cost was lower: from there.
        fit = also(fit, &before.solution);
    }
    if !proposal.hidden && fit.as_ref().is_none_or(short) {
        // A small step may cost less until the starts follow, and lead elsewhere; and the vehicle may not move on the
        // following soil.
        let coefficients = after_steps(&problem, proposal, &before.solution, 1.0).coefficients;
        let rest = before.solution.clone();
        fit = also(
            fit,
            &Solution {
                coefficients,
                ..rest
            },
        );
    }
    let fit = fit.filter(|fit| fit.negative_log_evidence.is_finite())?;
    Some(PartialFit::new(proposal, &problem, fit, before).shaped(before, noise))
}

/// Finishes a fit.
#[must_use]
pub fn finish<'a>(
    partial_fit: PartialFit<'a>,
    before: &FittedHypothesis,
    noise: &NoiseModel,
) -> Option<FittedCandidate<'a>> {
    let PartialFit {
        proposal, problem, ..
    } = partial_fit;
    let fit = fit_restarted(&problem, &partial_fit.fit, noise);
    let without = negative_log_evidence_without(&problem, &proposal, &fit, before, noise);
    let mut candidate = FittedCandidate {
        gain: without - fit.negative_log_evidence - proposal.price,
        shape: 0.0,
        mends: false,
        ranked: None,
        own: None,
        scores: None,
        proposal,
        problem,
        fit,
    };
    candidate.judge(before, noise);
    Some(candidate)
}

/// Negative log evidence without a proposal. A fit from afar may have reached a better soil, which is not the
/// proposal's merit: then also from where it ended.
fn negative_log_evidence_without(
    problem: &Problem,
    proposal: &Proposal,
    fit: &FittedHypothesis,
    before: &FittedHypothesis,
    noise: &NoiseModel,
) -> f64 {
    if !proposal.hidden {
        return before.negative_log_evidence;
    }
    let mut initial = fit.solution.clone();
    initial.take(&proposal.coefficients, &before.solution);
    let without = fit_until(
        problem,
        &before.coefficients,
        &initial,
        noise,
        LONG_PARTIAL_FIT,
    );
    let negative_log_evidence = without.map_or(f64::INFINITY, |fit| fit.negative_log_evidence);
    before.negative_log_evidence.min(negative_log_evidence)
}

/// The given model with a proposal's region. `None` if it cannot act there.
#[must_use]
pub fn placed<'a>(problem: &Problem<'a>, proposal: &Proposal) -> Option<Problem<'a>> {
    let mut problem = problem.clone();
    let Some(extent) = &proposal.extent else {
        return Some(problem);
    };
    let mut effects: Vec<usize> = proposal
        .coefficients
        .iter()
        .map(|coefficient| problem.candidates[*coefficient].effect)
        .collect();
    effects.sort_unstable();
    effects.dedup();
    let model = &mut problem.nominal.effects;
    let extent = match *extent {
        Region::Beyond {
            direction,
            position,
        } => {
            let name = |name: &str| ParameterName::find(&format!("terrain_change.{name}"));
            model.set(name("direction")?, direction).ok()?;
            model.set(name("position")?, position).ok()?;
            return Some(problem);
        }
        Region::Time(at) | Region::Run(at) => {
            let runs = |recording: usize| problem.recordings[recording].runs.len();
            let before: usize = (0..at.recording).map(runs).sum::<usize>() + at.run;
            let clock = CLOCK * before as f64;
            effects::Extent::Time {
                start: clock + at.start,
                end: clock + at.end,
            }
        }
        Region::Place {
            disc: [x, y, radius],
        } => effects::Extent::Place { x, y, radius },
    };
    if effects.iter().any(|effect| is_change(*effect)) {
        // The other soil fills the window.
        model
            .set(ParameterName::find("terrain_change.position")?, -1e6)
            .ok()?;
    }
    model.window = Some(Window { effects, extent });
    Some(problem)
}

fn is_change(effect: usize) -> bool {
    effects::CATALOGUE[effect].name == crate::diagnosis::hypothesis::candidate::TERRAIN_CHANGE
}
