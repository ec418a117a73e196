//! The way from the re-tuned model to one with everything in it that is missing: one thing after another.
//!
//! Of a long recording, what else is missing besides the first thing is sought on a part, unless the first thing
//! acts at some time or place only. Then everything is looked at once more on all of it, which
//! decides what is left out again and what else there is.

use super::choice::{Prefer, choose, sound_odds, worth_two_ways};
use super::edges::settle_under_own_noise;
use super::naming::Named;
use super::proposal::{Kind, Proposal};
use super::prune::{prune, without};
use super::stage::{Stage, look_again};
use super::trial::try_all;
use super::{Member, NOTHING};
use crate::diagnosis::hypothesis::Given;
use crate::diagnosis::hypothesis::likelihood::{HELD, Tuned, tune, tune_on, tune_with_noise};
use crate::diagnosis::hypothesis::part::Part;
use crate::diagnosis::{DiagnosisError, Options, Progress, Subject};
use crate::fit::problem::Weighing;

/// Rounds at most.
const ROUNDS: usize = 4;

/// A hypothesis with what was found on the way to it.
#[derive(Debug, Clone)]
pub struct Path<'a> {
    /// The hypothesis.
    pub stage: Stage<'a>,
    /// Noise and weights.
    pub by: Weighing,
    /// What was found.
    pub members: Vec<Member>,
    /// What was fitted and not taken in the last round, with log Bayes factors and priors.
    pub refused: Vec<(Subject, f64)>,
    reach: Reach<'a>,
}

/// How much of the recordings the next steps take.
#[derive(Debug, Clone)]
enum Reach<'a> {
    /// All.
    Whole,
    /// After the next finding a part.
    Narrowing(Part),
    /// A part; what was found first on all.
    Narrowed(Part, Box<(Given<'a>, Tuned, Weighing)>),
}

impl<'a> Path<'a> {
    /// Nothing found yet.
    #[must_use]
    pub fn new(stage: Stage<'a>, by: Weighing) -> Self {
        Self {
            stage,
            by,
            members: Vec::new(),
            refused: Vec::new(),
            reach: Reach::Whole,
        }
    }

    /// Goes to the end, by names and by what is likeliest first where both may lead on. `fitted` is what was
    /// fitted beside the start.
    ///
    /// # Errors
    /// Numbers that are not finite, a hypothesis that cannot be driven again.
    pub fn explored(
        mut self,
        fitted: Vec<Named<'a>>,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        let firsts = [Prefer::Nothing, Prefer::Names].map(|p| choose(&fitted, &self.stage, p));
        let throughout = |named: &&Named| named.proposal.kind() != Kind::Local;
        if firsts.iter().flatten().all(throughout)
            && let Some(part) = Part::of(&self.stage.given)
        {
            self.reach = Reach::Narrowing(part);
        }
        let walk = |start: Self, fitted, first| start.walk(fitted, first, options, progress);
        let mut path = if worth_two_ways(&fitted, &self.stage) && !progress.is_late() {
            let named = walk(self.clone(), fitted.clone(), Prefer::Names)?;
            walk(self, fitted, Prefer::Nothing)?.or(named)
        } else {
            walk(self, fitted, Prefer::Nothing)?
        };
        let law = |member: &Member| member.proposal.kind() == Kind::Law;
        if let Some(law) = path.members.iter().position(law)
            && path.members.len() > 1
            && !progress.is_late()
            && let Some(renamed) = path.renamed(law, options, progress)?
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
        mut fitted: Vec<Named<'a>>,
        prefer: Prefer,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        while self.members.len() < self.rounds() {
            let Some(mut best) = choose(&fitted, &self.stage, prefer).cloned() else {
                self.refused = self.rivals(&fitted);
                break;
            };
            settle_under_own_noise(&mut best, &self.by);
            self.members.push(Member {
                proposal: best.proposal,
                gain: self.on_all(best.gain),
                rivals: self.rivals(&fitted),
            });
            let (placed, tuned) = self.narrowed(best.given, best.tuned);
            self.stage = self.looked_at(placed, tuned, options, progress)?;
            fitted = self.what_else(progress)?;
        }
        progress.step("what can be left out again")?;
        let ratio = self.on_all(1.0);
        let (before, knobs) = (self.members.clone(), self.stage.tuned.knobs.clone());
        prune(&mut self.stage, &mut self.members, &self.by, ratio);
        if self.members.is_empty() {
            let rivals = before.into_iter().flat_map(|member| member.rivals);
            let refused = rivals.map(|(subject, odds)| (subject, odds.min(0.0)));
            self.refused.extend(refused);
        }
        if self.stage.tuned.knobs != knobs {
            let Stage { given, tuned, .. } = self.stage.clone();
            self.stage = self.looked_at(given, tuned, options, progress)?;
        }
        Ok(self)
    }

    /// A hypothesis with what is seen beside it.
    fn looked_at(
        &mut self,
        given: Given<'a>,
        tuned: Tuned,
        options: &Options,
        progress: &Progress,
    ) -> Result<Stage<'a>, DiagnosisError> {
        let before = &self.stage.looked;
        look_again(before, given, tuned, &mut self.by, options, progress)
    }

    /// How many things may be found. Of what is found on a part, all of it has a word as well.
    fn rounds(&self) -> usize {
        match self.reach {
            Reach::Whole | Reach::Narrowing(_) => ROUNDS,
            Reach::Narrowed(..) => ROUNDS - 1,
        }
    }

    /// What was fitted, with log odds.
    fn rivals(&self, fitted: &[Named]) -> Vec<(Subject, f64)> {
        let odds = |named: &Named| self.on_all(sound_odds(named, &self.stage));
        let rivals = fitted.iter();
        rivals
            .map(|named| (named.proposal.subject, odds(named)))
            .collect()
    }

    /// Log odds on a part as all tells them.
    fn on_all(&self, odds: f64) -> f64 {
        match &self.reach {
            Reach::Narrowed(part, _) => odds * part.ratio(),
            Reach::Whole | Reach::Narrowing(_) => odds,
        }
    }

    /// Fits what may be missing beside what was found; nothing where no more may be found, or time is up.
    fn what_else(&mut self, progress: &'a Progress) -> Result<Vec<Named<'a>>, DiagnosisError> {
        if self.members.len() >= self.rounds() || progress.is_late() {
            return Ok(Vec::new());
        }
        progress.step("what else")?;
        if let Reach::Narrowed(..) = self.reach {
            // What acts for some seconds only may lie between the stretches.
            let proposals = &mut self.stage.proposals;
            proposals.retain(|proposal| proposal.kind() != Kind::Local);
        }
        try_all(&self.stage, &self.by, progress)
    }

    /// What was found first, on a part where that is to be gone on with; noise and weights move along.
    fn narrowed(&mut self, given: Given<'a>, tuned: Tuned) -> (Given<'a>, Tuned) {
        let Reach::Narrowing(part) = &self.reach else {
            return (given, tuned);
        };
        if given.deadline.is_over() {
            self.reach = Reach::Whole;
            return (given, tuned);
        }
        let (some, by) = (part.given(&given), part.weighing(&self.by));
        let begin = part.solution(&tuned.solution);
        let Ok(narrow) = tune(&some, &tuned.knobs, &begin, &by) else {
            self.reach = Reach::Whole;
            return (given, tuned);
        };
        let whole = std::mem::replace(&mut self.by, by);
        self.reach = Reach::Narrowed(part.clone(), Box::new((given, tuned, whole)));
        (some, narrow)
    }

    /// Goes on with all of the recordings where it was on a part of them. What they cannot be driven with is
    /// dropped, but for what was found on all.
    fn widened(
        mut self,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Self, DiagnosisError> {
        let Reach::Narrowed(part, whole) = std::mem::replace(&mut self.reach, Reach::Whole) else {
            return Ok(self);
        };
        let (first, tuned, by) = *whole;
        progress.step("what else")?;
        self.by.weights = by.weights;
        let given = Given {
            segments: first.segments.clone(),
            ..self.stage.given.clone()
        };
        let knobs = &self.stage.tuned.knobs;
        // What was found first may be off by now.
        let all: Vec<usize> = (0..given.candidates.knobs.len()).collect();
        let begin = part.widened(&self.stage.tuned.solution, &all, &tuned.solution);
        let (given, tuned) = match tune(&given, knobs, &begin, &self.by) {
            Ok(widened) => (given, widened),
            Err(_) => {
                self.members
                    .retain(|m| m.proposal.knobs.iter().all(|k| tuned.knobs.contains(k)));
                self.by.noise = by.noise;
                (first, tuned)
            }
        };
        self.stage = self.looked_at(given, tuned, options, progress)?;
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
        if self.members.is_empty() || progress.is_late() {
            return Ok(self);
        }
        progress.step("noise")?;
        let Stage { given, tuned, .. } = self.stage.clone();
        let mut own = self.by.clone();
        let settled = tune_with_noise(&given, &tuned.knobs, &tuned.solution, &mut own);
        if progress.is_late() {
            return Ok(self);
        }
        let tuned = match settled {
            Ok(settled) => {
                self.by = own;
                settled
            }
            Err(_) => tuned,
        };
        self.stage = self.looked_at(given, tuned, options, progress)?;
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
        let all = self.members.iter().map(|m| &m.proposal);
        let all: Vec<_> = all.map(|p| (p.subject, p.knobs.clone())).collect();
        for (subject, knobs) in all {
            // Two may be without a name, one of them with fewer terms than when it was found.
            let has = |proposal: &Proposal| knobs.iter().all(|k| proposal.knobs.contains(k));
            let is = |proposal: &Proposal| {
                proposal.subject == subject && (subject != Subject::Unknown || has(proposal))
            };
            let mut members = self.members.iter();
            let place = members.position(|member| is(&member.proposal));
            let Some(index) = place.filter(|_| self.members.len() > 1) else {
                continue;
            };
            let close = self.members[index].close();
            if close.len() < 2 || progress.is_late() {
                continue;
            }
            progress.step("what came close")?;
            let Some(mut path) = self.opened(index, options, progress)? else {
                continue;
            };
            let proposals = &mut path.stage.proposals;
            proposals.retain(|proposal| close.contains(&proposal.subject));
            let fitted = try_all(&path.stage, &path.by, progress)?;
            if progress.is_late() {
                break;
            }
            match choose(&fitted, &path.stage, Prefer::Nothing) {
                Some(best) if is(&best.proposal) => {
                    let rivals = path.rivals(&fitted);
                    self.members[index].stand_anew(&rivals);
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

    /// What was found besides a law may have hidden the names of what it stands for: the path
    /// without it, with names in its place. `None` where nothing can be driven or named.
    fn renamed(
        &self,
        law: usize,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Option<Self>, DiagnosisError> {
        let Some(mut path) = self.opened(law, options, progress)? else {
            return Ok(None);
        };
        let mut fitted = path.what_else(progress)?;
        fitted.retain(|named| named.proposal.kind() != Kind::Law);
        if choose(&fitted, &path.stage, Prefer::Names).is_none() {
            return Ok(None);
        }
        path.walk(fitted, Prefer::Names, options, progress)
            .map(Some)
    }

    /// The path without one of its findings, looked at anew. `None` where it cannot be driven so.
    fn opened(
        &self,
        index: usize,
        options: &Options,
        progress: &'a Progress,
    ) -> Result<Option<Self>, DiagnosisError> {
        let mut path = self.clone();
        let gone = path.members.remove(index).proposal;
        let (given, tuned) = without(&path.stage, &gone, &path.by);
        let Ok(tuned) = tuned else { return Ok(None) };
        path.stage = path.looked_at(given, tuned, options, progress)?;
        Ok(Some(path))
    }

    /// The better of two paths by the evidence, the other one with names in the place of a law.
    fn or(self, mut named: Self) -> Self {
        let advantage = named.advantage(&self);
        let advantage = named.on_all(advantage);
        // Fits that were ended early do not compare.
        if advantage < 0.0 || self.stage.given.deadline.is_over() {
            return self;
        }
        for member in &mut named.members {
            member.outdo_law(advantage);
        }
        named
    }

    /// Log odds of this path over another, under the noise of both on average.
    fn advantage(&self, other: &Self) -> f64 {
        let price = |path: &Self| -> f64 {
            let members = path.members.iter().map(|member| &member.proposal);
            members.map(|m| NOTHING - m.log_prior() + m.price).sum()
        };
        let surprise = |path: &Self, by: &Weighing| -> f64 {
            let stage = &path.stage;
            tune_on(&stage.given, &stage.tuned, by, HELD).surprise + price(path)
        };
        [&self.by, &other.by]
            .map(|by| 0.5 * (surprise(other, by) - surprise(self, by)))
            .iter()
            .sum()
    }
}
