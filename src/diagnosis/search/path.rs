//! The way from the refitted model to one with everything in it that is missing: one thing after another.
//!
//! Of a long recording, what else is missing besides the first thing is sought on a part, unless the first thing
//! acts at some time or place only. Then everything is looked at once more on all of it, which
//! decides what is left out again and what else there is.

use super::accepted::{AcceptedEffect, NOTHING};
use super::choice::{Prefer, choose, sound_odds, worth_two_ways};
use super::edges::settle_under_own_noise;
use super::naming::FittedCandidate;
use super::proposal::{Proposal, ProposalKind};
use super::prune::{prune, without};
use super::stage::{Stage, screen_again};
use super::trial::try_all;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, HELD, continue_fit, fit_hypothesis, fit_with_noise,
};
use crate::diagnosis::hypothesis::subsample::Subsample;
use crate::diagnosis::{DiagnosisError, Options, Progress, Subject};
use crate::fit::problem::NoiseModel;

/// Rounds at most.
const ROUNDS: usize = 4;

/// A hypothesis with what was found on the way to it.
#[derive(Debug, Clone)]
pub struct Path<'a> {
    /// The hypothesis.
    pub stage: Stage<'a>,
    /// Noise and weights.
    pub noise: NoiseModel,
    /// What was found.
    pub accepted: Vec<AcceptedEffect>,
    /// What was fitted and not taken in the last round, with log Bayes factors and priors.
    pub refused: Vec<(Subject, f64)>,
    scope: Scope<'a>,
}

/// How much of the recordings the next steps take.
#[derive(Debug, Clone)]
enum Scope<'a> {
    /// All.
    Whole,
    /// After the next finding a part.
    Narrowing(Subsample),
    /// A part; what was found first on all.
    Narrowed(Subsample, Box<(Problem<'a>, FittedHypothesis, NoiseModel)>),
}

impl<'a> Path<'a> {
    /// Nothing found yet.
    #[must_use]
    pub fn new(stage: Stage<'a>, noise: NoiseModel) -> Self {
        Self {
            stage,
            noise,
            accepted: Vec::new(),
            refused: Vec::new(),
            scope: Scope::Whole,
        }
    }

    /// Goes to the end, by names and by what is likeliest first where both may lead on. `fitted` is what was
    /// fitted beside the start.
    ///
    /// # Errors
    /// Numbers that are not finite, a hypothesis that cannot be driven again.
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
        let residual_model =
            |effect: &AcceptedEffect| effect.proposal.kind() == ProposalKind::ResidualModel;
        if let Some(residual_model) = path.accepted.iter().position(residual_model)
            && path.accepted.len() > 1
            && !progress.is_late()
            && let Some(renamed) = path.renamed(residual_model, options, progress)?
        {
            path = path.or(renamed);
        }
        path.widened(options, progress)?
            .settled(options, progress)?
            .exchanged(options, progress)
    }

    /// Takes one thing after another, what was fitted beside the start first, and leaves out what
    /// is not needed in the end.
    fn walk(
        mut self,
        mut fitted: Vec<FittedCandidate<'a>>,
        prefer: Prefer,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        while self.accepted.len() < self.rounds() {
            let Some(mut best) = choose(&fitted, &self.stage, prefer).cloned() else {
                self.refused = self.rivals(&fitted);
                break;
            };
            settle_under_own_noise(&mut best, &self.noise);
            self.accepted.push(AcceptedEffect {
                proposal: best.proposal,
                gain: self.on_all(best.gain),
                rivals: self.rivals(&fitted),
            });
            let (placed, fit) = self.narrowed(best.problem, best.fit);
            self.stage = self.looked_at(placed, fit, options, progress)?;
            fitted = self.what_else(progress)?;
        }
        progress.step("removing redundant effects")?;
        let ratio = self.on_all(1.0);
        let (before, coefficients) = (self.accepted.clone(), self.stage.fit.coefficients.clone());
        prune(&mut self.stage, &mut self.accepted, &self.noise, ratio);
        if self.accepted.is_empty() {
            let rivals = before.into_iter().flat_map(|effect| effect.rivals);
            let refused = rivals.map(|(subject, odds)| (subject, odds.min(0.0)));
            self.refused.extend(refused);
        }
        if self.stage.fit.coefficients != coefficients {
            let Stage { problem, fit, .. } = self.stage.clone();
            self.stage = self.looked_at(problem, fit, options, progress)?;
        }
        Ok(self)
    }

    /// A hypothesis with what is seen beside it.
    fn looked_at(
        &mut self,
        problem: Problem<'a>,
        fit: FittedHypothesis,
        options: &Options,
        progress: &Progress,
    ) -> Result<Stage<'a>, DiagnosisError> {
        let before = &self.stage.screening;
        screen_again(before, problem, fit, &mut self.noise, options, progress)
    }

    /// How many things may be found. Of what is found on a part, all of it has a word as well.
    fn rounds(&self) -> usize {
        match self.scope {
            Scope::Whole | Scope::Narrowing(_) => ROUNDS,
            Scope::Narrowed(..) => ROUNDS - 1,
        }
    }

    /// What was fitted, with log odds.
    fn rivals(&self, fitted: &[FittedCandidate]) -> Vec<(Subject, f64)> {
        let odds = |candidate: &FittedCandidate| self.on_all(sound_odds(candidate, &self.stage));
        let rivals = fitted.iter();
        rivals
            .map(|candidate| (candidate.proposal.subject, odds(candidate)))
            .collect()
    }

    /// Log odds on a part as all tells them.
    fn on_all(&self, odds: f64) -> f64 {
        match &self.scope {
            Scope::Narrowed(part, _) => odds * part.ratio(),
            Scope::Whole | Scope::Narrowing(_) => odds,
        }
    }

    /// Fits what may be missing beside what was found; nothing where no more may be found, or time is up.
    fn what_else(
        &mut self,
        progress: &'a Progress,
    ) -> Result<Vec<FittedCandidate<'a>>, DiagnosisError> {
        if self.accepted.len() >= self.rounds() || progress.is_late() {
            return Ok(Vec::new());
        }
        progress.step("fitting further candidates")?;
        if let Scope::Narrowed(..) = self.scope {
            // What acts for some seconds only may lie between the segments.
            let proposals = &mut self.stage.proposals;
            proposals.retain(|proposal| proposal.kind() != ProposalKind::Local);
        }
        try_all(&self.stage, &self.noise, progress)
    }

    /// What was found first, on a part where that is to be gone on with; noise and weights move along.
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

    /// Goes on with all of the recordings where it was on a part of them. What they cannot be driven with is
    /// dropped, but for what was found on all.
    fn widened(
        mut self,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        let Scope::Narrowed(part, whole) = std::mem::replace(&mut self.scope, Scope::Whole) else {
            return Ok(self);
        };
        let (first, fit, noise) = *whole;
        progress.step("fitting further candidates")?;
        self.noise.weights = noise.weights;
        let problem = Problem {
            segments: first.segments.clone(),
            ..self.stage.problem.clone()
        };
        let coefficients = &self.stage.fit.coefficients;
        // What was found first may be off by now.
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
        self.stage = self.looked_at(problem, fit, options, progress)?;
        let fitted = self.what_else(progress)?;
        self.walk(fitted, Prefer::Nothing, options, progress)
    }

    /// The noise that the last finding was judged by was that of the model without it: everything is looked at once
    /// more under what is left now, which tells what else there is and what can be left out.
    fn settled(
        mut self,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        if self.accepted.is_empty() || progress.is_late() {
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
        self.stage = self.looked_at(problem, fit, options, progress)?;
        let fitted = self.what_else(progress)?;
        self.walk(fitted, Prefer::Nothing, options, progress)
    }

    /// What was found first was named while the rest was missing. Where something else came close to it, both are
    /// fitted once more with the rest inside: how far they are apart then counts, and what is ahead then is taken.
    fn exchanged(
        mut self,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        let all = self.accepted.iter().map(|m| &m.proposal);
        let all: Vec<_> = all.map(|p| (p.subject, p.coefficients.clone())).collect();
        for (subject, coefficients) in all {
            // Two may be without a name, one of them with fewer terms than when it was found.
            let has = |proposal: &Proposal| {
                coefficients
                    .iter()
                    .all(|k| proposal.coefficients.contains(k))
            };
            let is = |proposal: &Proposal| {
                proposal.subject == subject && (subject != Subject::Unknown || has(proposal))
            };
            let mut accepted = self.accepted.iter();
            let place = accepted.position(|effect| is(&effect.proposal));
            let Some(index) = place.filter(|_| self.accepted.len() > 1) else {
                continue;
            };
            let close = self.accepted[index].close();
            if close.len() < 2 || progress.is_late() {
                continue;
            }
            progress.step("refitting close rivals")?;
            let Some(mut path) = self.opened(index, options, progress)? else {
                continue;
            };
            let proposals = &mut path.stage.proposals;
            proposals.retain(|proposal| close.contains(&proposal.subject));
            let fitted = try_all(&path.stage, &path.noise, progress)?;
            if progress.is_late() {
                break;
            }
            match choose(&fitted, &path.stage, Prefer::Nothing) {
                Some(best) if is(&best.proposal) => {
                    let rivals = path.rivals(&fitted);
                    self.accepted[index].stand_anew(&rivals);
                }
                Some(_) => {
                    let other = path.walk(fitted, Prefer::Nothing, options, progress)?;
                    let advantage = other.advantage(&self);
                    if advantage > 0.0 && !progress.is_late() {
                        self = other;
                    }
                }
                None => {}
            }
        }
        Ok(self)
    }

    /// What was found besides a residual model may have hidden the names of what it stands for: the path
    /// without it, with names in its place. `None` where nothing can be driven or named.
    fn renamed(
        &self,
        residual_model: usize,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Option<Self>, DiagnosisError> {
        let Some(mut path) = self.opened(residual_model, options, progress)? else {
            return Ok(None);
        };
        let mut fitted = path.what_else(progress)?;
        fitted.retain(|candidate| candidate.proposal.kind() != ProposalKind::ResidualModel);
        if choose(&fitted, &path.stage, Prefer::Names).is_none() {
            return Ok(None);
        }
        path.walk(fitted, Prefer::Names, options, progress)
            .map(Some)
    }

    /// The path without one of its findings, screened again. `None` where it cannot be driven so.
    fn opened(
        &self,
        index: usize,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Option<Self>, DiagnosisError> {
        let mut path = self.clone();
        let gone = path.accepted.remove(index).proposal;
        let (problem, fit) = without(&path.stage, &gone, &path.noise);
        let Ok(fit) = fit else { return Ok(None) };
        path.stage = path.looked_at(problem, fit, options, progress)?;
        Ok(Some(path))
    }

    /// The better of two paths by the evidence, the other one with names in the place of a residual model.
    fn or(self, mut candidate: Self) -> Self {
        let advantage = candidate.advantage(&self);
        let advantage = candidate.on_all(advantage);
        // Fits that were ended early do not compare.
        if advantage < 0.0 || self.stage.problem.deadline.is_over() {
            return self;
        }
        for effect in &mut candidate.accepted {
            effect.outdo_residual_model(advantage);
        }
        candidate
    }

    /// Log odds of this path over another, under the noise of both on average.
    fn advantage(&self, other: &Self) -> f64 {
        let price = |path: &Self| -> f64 {
            let accepted = path.accepted.iter().map(|effect| &effect.proposal);
            accepted.map(|m| NOTHING - m.log_prior() + m.price).sum()
        };
        let negative_log_evidence = |path: &Self, noise: &NoiseModel| -> f64 {
            let stage = &path.stage;
            continue_fit(&stage.problem, &stage.fit, noise, HELD).negative_log_evidence
                + price(path)
        };
        [&self.noise, &other.noise]
            .map(|noise| {
                0.5 * (negative_log_evidence(other, noise) - negative_log_evidence(self, noise))
            })
            .iter()
            .sum()
    }
}
