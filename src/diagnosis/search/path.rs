//! The path from the refitted model to the augmented one, one effect after another.
//!
//! In a long recording, further effects are searched on a subsample, unless the first one is local. Then everything
//! is screened once more on the whole recording, which decides what is removed and what else is accepted.

use super::accepted::{AcceptedEffect, CATALOGUED, NOTHING, Rival};
use super::choice::{Prefer, choose, sound_odds, worth_two_ways};
use super::naming::FittedCandidate;
use super::own_noise::{OwnNoise, under_own_noise};
use super::proposal::ProposalKind;
use super::prune::{prune, without};
use super::replaced::{RivalsInPlace, rivals_in_place};
use super::stage::{Stage, screen_again};
use super::trial::try_all;
use super::unstuck::{AGAIN, unstuck};
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, fit_hypothesis, fit_with_noise};
use crate::diagnosis::hypothesis::subsample::Subsample;
use crate::diagnosis::screening::identifiable::Accepted;
use crate::diagnosis::screening::screen::Projection;
use crate::diagnosis::{DiagnosisError, Options, Progress, Subject};
use crate::fit::problem::NoiseModel;

/// Maximum number of rounds.
const ROUNDS: usize = 4;

/// A hypothesis with the effects accepted on the way to it.
#[derive(Debug, Clone)]
pub struct Path<'a> {
    /// The hypothesis.
    pub stage: Stage<'a>,
    /// Noise and weights.
    pub noise: NoiseModel,
    /// The accepted effects.
    pub accepted: Vec<AcceptedEffect>,
    /// Log odds of the candidates rejected in the last round.
    pub refused: Vec<Rival>,
    scope: Scope<'a>,
    /// Whether the noise is that of all accepted effects together.
    settled: bool,
}

/// The segments that the next steps use.
#[derive(Debug, Clone)]
enum Scope<'a> {
    /// All.
    Whole,
    /// A subsample after the next accepted effect.
    Narrowing(Subsample),
    /// A subsample; with the first effect's fit to all segments.
    Narrowed(Subsample, Box<(Problem<'a>, FittedHypothesis, NoiseModel)>),
}

impl<'a> Path<'a> {
    /// A path without accepted effects.
    #[must_use]
    pub fn new(stage: Stage<'a>, noise: NoiseModel) -> Self {
        Self {
            stage,
            noise,
            accepted: Vec::new(),
            refused: Vec::new(),
            scope: Scope::Whole,
            settled: false,
        }
    }

    /// Follows the path to its end, by effects of the catalogue and by the likeliest first if both may lead on. `fitted`
    /// are the fits beside the start.
    ///
    /// # Errors
    /// Numbers that are not finite, a hypothesis that the model cannot follow again.
    pub fn explored(
        mut self,
        fitted: Vec<FittedCandidate<'a>>,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        let firsts = [Prefer::Nothing, Prefer::Names].map(|p| choose(&fitted, &self.stage, p));
        let throughout =
            |candidate: &&FittedCandidate| candidate.proposal.kind() != ProposalKind::Local;
        if firsts.iter().flatten().all(throughout)
            && let Some(part) = Subsample::of(&self.stage.problem)
        {
            self.scope = Scope::Narrowing(part);
        }
        let walk = |start: Self, fitted, first| start.walk(fitted, first, options, progress);
        let mut path = if worth_two_ways(&fitted, &self.stage) && !progress.is_late() {
            let candidate = walk(self.clone(), fitted.clone(), Prefer::Names)?;
            walk(self, fitted, Prefer::Nothing)?.or(candidate)
        } else {
            walk(self, fitted, Prefer::Nothing)?
        };
        let residual_model = |effect: &AcceptedEffect| {
            effect.proposal.kind() == ProposalKind::ResidualModel && !effect.mends
        };
        if let Some(residual_model) = path.accepted.iter().position(residual_model)
            && path.accepted.len() > 1
            && !progress.is_late()
            && let Some(renamed) = path.renamed(residual_model, options, progress)?
        {
            path = path.or(renamed);
        }
        path.widened(options, progress)?
            .rescreened_under_final_noise(options, progress)?
            .exchanged(options, progress)
    }

    /// Accepts one effect after another, from the given fits first, and removes redundant ones in the end.
    fn walk(
        mut self,
        mut fitted: Vec<FittedCandidate<'a>>,
        prefer: Prefer,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        let mut restarts = 0;
        while self.accepted.len() < self.rounds() {
            // Before the first one the search has done so.
            if !self.accepted.is_empty()
                && restarts < AGAIN
                && !progress.is_late()
                && let Some(better) = unstuck(&self.stage, &fitted, &self.noise)
            {
                restarts += 1;
                let problem = self.stage.problem.clone();
                self.stage = self.rescreened(problem, better, options, progress)?;
                fitted = self.further_candidates(progress)?;
                continue;
            }
            let Some(mut best) = choose(&fitted, &self.stage, prefer).cloned() else {
                self.refused = self.rivals(&fitted, None);
                break;
            };
            let gain = best.ranked_gain();
            let rivals = self.rivals(&fitted, best.own.as_ref());
            self.settled = best.own.is_some();
            if let Some(own) = best.own.take() {
                (best.fit, self.noise) = (own.fit, own.noise);
            }
            self.accepted.push(AcceptedEffect {
                proposal: best.proposal,
                gain: self.on_whole(gain),
                rivals,
                mends: best.mends,
            });
            let (placed, fit) = self.narrowed(best.problem, best.fit);
            self.stage = self.rescreened(placed, fit, options, progress)?;
            if let Some(repeated) = self.repeated()
                && let Some(path) = self.without_effect(repeated, options, progress)?
            {
                self = path;
            }
            fitted = self.further_candidates(progress)?;
        }
        progress.step("removing redundant effects")?;
        let ratio = self.on_whole(1.0);
        let (before, coefficients) = (self.accepted.clone(), self.stage.fit.coefficients.clone());
        prune(&mut self.stage, &mut self.accepted, &self.noise, ratio);
        if self.accepted.is_empty() {
            let rivals = before.into_iter().flat_map(|effect| effect.rivals);
            let refused = rivals.map(|one| Rival::new(one.subject, one.odds.min(0.0)));
            self.refused.extend(refused);
        }
        if self.stage.fit.coefficients != coefficients {
            self.settled = false;
            let Stage { problem, fit, .. } = self.stage.clone();
            self.stage = self.rescreened(problem, fit, options, progress)?;
        }
        Ok(self)
    }

    /// An accepted residual model beside which an accepted effect of the catalogue is not identifiable.
    fn repeated(&self) -> Option<usize> {
        let system = self.stage.screening.system.as_ref();
        let unknowns = |effect: &AcceptedEffect| -> Vec<usize> {
            let coefficients = effect.proposal.coefficients.iter();
            coefficients.flat_map(|k| system.unknowns(*k)).collect()
        };
        let is_named = |effect: &&AcceptedEffect| effect.proposal.subject != Subject::Unknown;
        let named = self.accepted.iter().filter(is_named);
        let named: Vec<usize> = named.flat_map(unknowns).collect();
        let takes_place = |index: usize| {
            let others = self.accepted.iter().enumerate();
            let others = others.filter(|(other, _)| *other != index);
            let others: Vec<usize> = others.flat_map(|(_, effect)| unknowns(effect)).collect();
            let terms = unknowns(&self.accepted[index]);
            Projection::over_all(system, &others).is_some_and(|projection| {
                let accepted = Accepted::new(system, &projection, named.iter().copied());
                !accepted.keep_sizes_beside(&projection, &terms)
            })
        };
        (0..self.accepted.len())
            .find(|index| !is_named(&&self.accepted[*index]) && takes_place(*index))
    }

    /// A hypothesis, screened again.
    fn rescreened(
        &mut self,
        problem: Problem<'a>,
        fit: FittedHypothesis,
        options: &Options,
        progress: &Progress,
    ) -> Result<Stage<'a>, DiagnosisError> {
        let before = &self.stage.screening;
        screen_again(before, problem, fit, &mut self.noise, options, progress)
    }

    /// Maximum number of effects. Those from a subsample leave one for the whole recording.
    fn rounds(&self) -> usize {
        match self.scope {
            Scope::Whole | Scope::Narrowing(_) => ROUNDS,
            Scope::Narrowed(..) => ROUNDS - 1,
        }
    }

    /// Log odds of fitted candidates, and the scatter of their distances to the accepted one.
    fn rivals(&self, fitted: &[FittedCandidate], accepted: Option<&OwnNoise>) -> Vec<Rival> {
        let rivals = fitted.iter().map(|candidate| {
            let scatter = accepted.zip(candidate.own.as_ref());
            let scatter = scatter.and_then(|(accepted, own)| own.scatter(accepted));
            Rival {
                subject: candidate.proposal.subject,
                odds: self.on_whole(sound_odds(candidate, &self.stage)),
                // That of a sum grows with the root of its length.
                scatter: scatter.map(|scatter| scatter * self.on_whole(1.0).sqrt()),
            }
        });
        rivals.collect()
    }

    /// Log odds of a subsample, scaled to all segments.
    fn on_whole(&self, odds: f64) -> f64 {
        match &self.scope {
            Scope::Narrowed(part, _) => odds * part.ratio(),
            Scope::Whole | Scope::Narrowing(_) => odds,
        }
    }

    /// Fits further candidates; none at the limit of rounds or time.
    fn further_candidates(
        &mut self,
        progress: &'a Progress,
    ) -> Result<Vec<FittedCandidate<'a>>, DiagnosisError> {
        if self.accepted.len() >= self.rounds() || progress.is_late() {
            return Ok(Vec::new());
        }
        progress.step("fitting further candidates")?;
        if let Scope::Narrowed(..) = self.scope {
            // Effects of some seconds may lie between the segments.
            let proposals = &mut self.stage.proposals;
            proposals.retain(|proposal| proposal.kind() != ProposalKind::Local);
        }
        try_all(&self.stage, &self.noise, progress)
    }

    /// The first accepted effect on the subsample, with its noise and weights.
    fn narrowed(
        &mut self,
        problem: Problem<'a>,
        fit: FittedHypothesis,
    ) -> (Problem<'a>, FittedHypothesis) {
        let Scope::Narrowing(part) = &self.scope else {
            return (problem, fit);
        };
        if problem.deadline.is_over() {
            self.scope = Scope::Whole;
            return (problem, fit);
        }
        let (some, noise) = (part.problem(&problem), part.noise_model(&self.noise));
        let initial = part.solution(&fit.solution);
        let Ok(narrow) = fit_hypothesis(&some, &fit.coefficients, &initial, &noise) else {
            self.scope = Scope::Whole;
            return (problem, fit);
        };
        let whole = std::mem::replace(&mut self.noise, noise);
        self.scope = Scope::Narrowed(part.clone(), Box::new((problem, fit, whole)));
        (some, narrow)
    }

    /// Continues on the whole recording. Effects that the model cannot follow there are dropped, except the first.
    fn widened(
        mut self,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        let Scope::Narrowed(part, whole) = std::mem::replace(&mut self.scope, Scope::Whole) else {
            return Ok(self);
        };
        let (first, fit, noise) = *whole;
        self.settled = false;
        progress.step("fitting further candidates")?;
        self.noise.weights = noise.weights;
        let problem = Problem {
            segments: first.segments.clone(),
            ..self.stage.problem.clone()
        };
        let coefficients = &self.stage.fit.coefficients;
        // The first effect may have changed.
        let all: Vec<usize> = (0..problem.candidates.coefficients.len()).collect();
        let initial = part.widened(&self.stage.fit.solution, &all, &fit.solution);
        let (problem, fit) = match fit_hypothesis(&problem, coefficients, &initial, &self.noise) {
            Ok(widened) => (problem, widened),
            Err(_) => {
                self.accepted.retain(|m| {
                    m.proposal
                        .coefficients
                        .iter()
                        .all(|k| fit.coefficients.contains(k))
                });
                self.noise.noise = noise.noise;
                (first, fit)
            }
        };
        self.stage = self.rescreened(problem, fit, options, progress)?;
        let fitted = self.further_candidates(progress)?;
        self.walk(fitted, Prefer::Nothing, options, progress)
    }

    /// The last effect was judged under the noise of the model without it: everything is screened once more under the
    /// final noise, which decides what else is accepted and what is removed.
    fn rescreened_under_final_noise(
        mut self,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        if self.accepted.is_empty() || self.settled || progress.is_late() {
            return Ok(self);
        }
        progress.step("estimating the noise")?;
        let Stage { problem, fit, .. } = self.stage.clone();
        let mut own = self.noise.clone();
        let settled = fit_with_noise(&problem, &fit.coefficients, &fit.solution, &mut own);
        if progress.is_late() {
            return Ok(self);
        }
        let fit = match settled {
            Ok(settled) => {
                self.noise = own;
                settled
            }
            Err(_) => fit,
        };
        self.stage = self.rescreened(problem, fit, options, progress)?;
        let fitted = self.further_candidates(progress)?;
        self.walk(fitted, Prefer::Nothing, options, progress)
    }

    /// Early effects were accepted while others were missing. Other mechanisms are fitted in the place of each, beside all
    /// others: their distance then counts, and the likelier one is accepted.
    fn exchanged(
        mut self,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        // Beside what mends one formula, other names look alike.
        if self.accepted.len() < 2 || self.accepted.iter().any(|effect| effect.mends) {
            return Ok(self);
        }
        let all = self.accepted.iter().map(|effect| &effect.proposal);
        let all: Vec<Vec<usize>> = all.map(|one| one.coefficients.clone()).collect();
        for coefficients in all {
            let mut accepted = self.accepted.iter();
            let place = accepted.position(|effect| effect.proposal.coefficients == coefficients);
            let Some(index) = place else { continue };
            let proposal = self.accepted[index].proposal.clone();
            if proposal.kind() == ProposalKind::Local || progress.is_late() {
                continue;
            }
            progress.step("refitting close rivals")?;
            let RivalsInPlace { near, far } = rivals_in_place(&self.stage, &proposal, &self.noise);
            if progress.is_late() {
                break;
            }
            self.accepted[index].limit(&far);
            if near.is_empty() {
                continue;
            }
            let Stage { problem, fit, .. } = &self.stage;
            let own = under_own_noise(problem, fit, &self.noise);
            if progress.is_late() {
                break;
            }
            let odds = self.accepted[index].odds(proposal.subject);
            let rivals = near.iter().map(|(other, with)| Rival {
                subject: other.subject,
                odds: odds + with.worth(other) - own.worth(&proposal),
                scatter: with.scatter(&own),
            });
            let mut rivals: Vec<Rival> = rivals.collect();
            rivals.push(Rival::new(proposal.subject, odds));
            self.accepted[index].stand_anew(&rivals);
            let best = rivals.iter().zip(near);
            let best = best.max_by(|(a, _), (b, _)| a.odds.total_cmp(&b.odds));
            if let Some((rival, (other, with))) = best
                && rival.odds > odds
            {
                let mut path = self.clone();
                path.accepted[index].proposal = other;
                path.noise = with.noise;
                let problem = path.stage.problem.clone();
                path.stage = path.rescreened(problem, with.fit, options, progress)?;
                let fitted = path.further_candidates(progress)?;
                let path = path.walk(fitted, Prefer::Nothing, options, progress)?;
                if progress.is_late() {
                    break;
                }
                if path.advantage(&self) > 0.0 {
                    self = path;
                } else {
                    // Its own further effects are worth less.
                    self.accepted[index].limit(&[(rival.subject, 0.0)]);
                }
            }
        }
        Ok(self)
    }

    /// Other effects may have hidden the names behind a residual model: the path without it, with names in its place.
    /// `None` if the model cannot follow it or no name is acceptable.
    fn renamed(
        &self,
        residual_model: usize,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Option<Self>, DiagnosisError> {
        let Some(mut path) = self.without_effect(residual_model, options, progress)? else {
            return Ok(None);
        };
        let mut fitted = path.further_candidates(progress)?;
        fitted.retain(|candidate| candidate.proposal.kind() != ProposalKind::ResidualModel);
        if choose(&fitted, &path.stage, Prefer::Names).is_none() {
            return Ok(None);
        }
        path.walk(fitted, Prefer::Names, options, progress)
            .map(Some)
    }

    /// The path without one of its effects, screened again. `None` if the model cannot follow it.
    fn without_effect(
        &self,
        index: usize,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Option<Self>, DiagnosisError> {
        let mut path = self.clone();
        let removed = path.accepted.remove(index).proposal;
        path.settled = false;
        let (problem, fit) = without(&path.stage, &removed, &path.noise);
        let Ok(fit) = fit else { return Ok(None) };
        path.stage = path.rescreened(problem, fit, options, progress)?;
        Ok(Some(path))
    }

    /// The better of two paths by the evidence; the other one has names in place of a residual model.
    fn or(self, mut candidate: Self) -> Self {
        let advantage = candidate.advantage(&self);
        let advantage = candidate.on_whole(advantage);
        // Fits that were cut short do not compare.
        let advantage = advantage + CATALOGUED;
        if advantage < 0.0 || self.stage.problem.deadline.is_over() {
            return self;
        }
        for effect in &mut candidate.accepted {
            effect.outdo_residual_model(advantage);
        }
        candidate
    }

    /// Log odds of this path over another, each under its own noise.
    fn advantage(&self, other: &Self) -> f64 {
        let price = |path: &Self| -> f64 {
            let accepted = path.accepted.iter().map(|effect| &effect.proposal);
            accepted.map(|m| NOTHING - m.log_prior() + m.price).sum()
        };
        let negative_log_evidence = |path: &Self| -> f64 {
            let Stage { problem, fit, .. } = &path.stage;
            under_own_noise(problem, fit, &path.noise)
                .evidence
                .negative_log
                + price(path)
        };
        negative_log_evidence(other) - negative_log_evidence(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::search::proposal::Proposal;
    use crate::diagnosis::testing::{driven, on, refitted, with_effects};

    #[test]
    fn a_residual_model_that_repeats_a_later_name_is_found() {
        let nominal = on("sandy_loam");
        let truth = with_effects(&nominal, r#"{"drag": {"coefficient": 150}}"#);
        let recordings = [driven(&truth, "slalom")];
        let (stage, noise) = refitted(&nominal, &recordings);
        let candidates = stage.problem.candidates.clone();
        let accepted = |name: &str| {
            let k = candidates.find(name).unwrap();
            let subject = if name.starts_with("residual_") {
                Subject::Unknown
            } else {
                Subject::Effect(candidates[k].effect)
            };
            AcceptedEffect {
                proposal: Proposal::new(subject, vec![k]),
                gain: 100.0,
                rivals: Vec::new(),
                mends: false,
            }
        };
        let mut path = Path::new(stage, noise);
        let mut repeated = |names: [&str; 2]| {
            path.accepted = names.map(accepted).to_vec();
            path.repeated()
        };
        let along = "residual_longitudinal.speed_squared";
        assert_eq!(repeated([along, "drag.coefficient"]), Some(0));
        assert_eq!(repeated(["drag.coefficient", along]), Some(1));
        let aside = "residual_lateral.sideways";
        assert_eq!(repeated([aside, "drag.coefficient"]), None);
        // Two residual models have no name that could lose its size.
        assert_eq!(repeated([along, aside]), None);
    }
}
