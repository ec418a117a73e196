//! One thing after another: what is missing, and what else.
//!
//! Each round looks at everything with what was found so far inside (step 7: what is left over after
//! the winner decides whether the winner is adequate), and ends when nothing more is worth it.

use super::hypothesis::{Given, Solution};
use super::likelihood::{Tuned, own_noise, tune, tune_with_noise};
use super::naming::Named;
use super::proposal::{Kind, Proposal};
use super::prune::{prune, without};
use super::stage::{Looked, Stage, look, try_all};
use super::{DiagnosisError, Options, Progress, Subject};
use crate::fit::predictor::PredictionError;
use crate::fit::problem::Weighing;
use std::sync::Arc;

/// Something that was found.
#[derive(Debug, Clone)]
pub struct Member {
    /// What was proposed.
    pub proposal: Proposal,
    /// Log Bayes factor against the hypothesis without it.
    pub gain: f64,
    /// What else was fitted in its place, with log Bayes factors and priors.
    pub rivals: Vec<(Subject, f64)>,
}

/// Where the search ended.
#[derive(Debug)]
pub struct Searched<'a> {
    /// The given model.
    pub given: Given<'a>,
    /// Noise and weights.
    pub by: Weighing,
    /// The re-tuned model under the same noise.
    pub retuned: Tuned,
    /// The model with everything found.
    pub augmented: Tuned,
    /// The given model with the places of what was found.
    pub placed: Given<'a>,
    /// What was found.
    pub members: Vec<Member>,
    /// What was fitted and not taken in the last round, with log Bayes factors and priors.
    pub refused: Vec<(Subject, f64)>,
    /// Held-out gains of what was fitted first, by subject.
    pub gains: Vec<(Subject, (f64, f64))>,
    /// Whether there is enough to hold some of it out; without that nothing is named.
    pub tested: bool,
    /// Under the re-tuned model.
    pub first: Arc<Looked>,
    /// With everything found.
    pub last: Arc<Looked>,
}

impl Searched<'_> {
    /// Back to the re-tuned model: what was found predicts worse what it was not fitted to, so it is
    /// no likelier than nothing.
    pub fn withdraw(&mut self) {
        for member in self.members.drain(..) {
            self.refused.extend(member.rivals);
        }
        for (_, odds) in &mut self.refused {
            *odds = odds.min(0.0);
        }
        self.by = own_noise(&self.given, &self.retuned, &self.by);
        self.augmented = self.retuned.clone();
        self.placed = self.given.clone();
        self.last = Arc::clone(&self.first);
    }
}

/// Rounds at most.
const ROUNDS: usize = 4;
/// Where a law is likeliest, names are tried first as well if one has this share of its odds.
const GOOD_PART: f64 = 0.2;
/// Log odds that something must have over nothing more, its prior counted.
pub const TAKE: f64 = 0.5;
/// Logarithm of the prior of nothing (more) over that of one effect of the catalogue.
pub const NOTHING: f64 = 3.0;
/// Searches.
///
/// # Errors
/// A model that cannot even begin, numbers that are not finite.
pub fn search<'a>(
    given: &Given<'a>,
    mut by: Weighing,
    options: &Options,
    progress: &Progress,
) -> Result<Searched<'a>, DiagnosisError> {
    progress.step("re-tuning the soil");
    let begin = given.begin();
    let undrivable = DiagnosisError::Undrivable;
    let retuned = tune_with_noise(given, &[], &begin, &mut by).map_err(undrivable)?;
    let stage = look(given.clone(), retuned, &mut by, options, progress)?;
    let first = Arc::clone(&stage.looked);
    let tested = stage.scores.is_some();
    let baseline = stage.tuned.solution.clone();
    progress.step("naming");
    let fitted = try_all(&stage, &by);
    let gain = |n: &Named| Some((n.proposal.subject, held_out_gain(n, &stage)?));
    let gains = fitted.iter().filter_map(gain).collect();
    let start = Path {
        stage,
        by,
        members: Vec::new(),
        refused: Vec::new(),
    };
    let walk = |start: Path<'a>, fitted, first| start.walk(fitted, first, options, progress);
    let mut path = if worth_two_ways(&fitted, &start.stage) {
        let named = walk(start.clone(), fitted.clone(), Prefer::Names)?;
        walk(start, fitted, Prefer::Nothing)?.or(named)?
    } else {
        walk(start, fitted, Prefer::Nothing)?
    };
    let law = |member: &Member| member.proposal.kind() == Kind::Law;
    if let Some(law) = path.members.iter().position(law)
        && path.members.len() > 1
        && let Some(renamed) = path.renamed(law, options, progress)?
    {
        path = path.or(renamed)?;
    }
    let Path {
        stage,
        by,
        members,
        refused,
    } = path;
    let retuned = tune_again(given, &baseline, &stage.tuned.solution, &by).map_err(undrivable)?;
    Ok(Searched {
        given: given.clone(),
        by,
        retuned,
        placed: stage.given,
        augmented: stage.tuned,
        members,
        refused,
        gains,
        tested,
        first,
        last: stage.looked,
    })
}

/// A hypothesis with what was found on the way to it.
#[derive(Debug, Clone)]
struct Path<'a> {
    stage: Stage<'a>,
    by: Weighing,
    members: Vec<Member>,
    refused: Vec<(Subject, f64)>,
}

/// What is taken first where several things are worth it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Prefer {
    /// The likeliest.
    Nothing,
    /// What has a name, the likeliest first: a law may be two effects at once.
    Names,
}

impl<'a> Path<'a> {
    /// Takes one thing after another, what was fitted beside the start first, and leaves out what
    /// is not needed in the end.
    fn walk(
        mut self,
        mut fitted: Vec<Named<'a>>,
        prefer: Prefer,
        options: &Options,
        progress: &Progress,
    ) -> Result<Self, DiagnosisError> {
        for round in self.members.len() + 1..=ROUNDS {
            let rival = |n: &Named| (n.proposal.subject, sound_odds(n, &self.stage));
            let rivals = fitted.iter().map(rival).collect();
            let Some(best) = choose(&fitted, &self.stage, prefer) else {
                self.refused = rivals;
                break;
            };
            self.members.push(Member {
                proposal: best.proposal.clone(),
                gain: best.gain,
                rivals,
            });
            let (placed, tuned) = (best.given.clone(), best.tuned.clone());
            self.stage = look(placed, tuned, &mut self.by, options, progress)?;
            if round < ROUNDS {
                progress.step("what else");
                fitted = try_all(&self.stage, &self.by);
            }
        }
        progress.step("what can be left out again");
        prune(&mut self.stage, &mut self.members, &self.by);
        Ok(self)
    }

    /// What was found besides a law may have hidden the names of what it stands for: the path
    /// without it, with names in its place. `None` where nothing can be driven or named.
    fn renamed(
        &self,
        law: usize,
        options: &Options,
        progress: &Progress,
    ) -> Result<Option<Self>, DiagnosisError> {
        let mut path = self.clone();
        let gone = path.members.remove(law).proposal;
        let (given, tuned) = without(&path.stage, &gone, &path.by);
        let Ok(tuned) = tuned else { return Ok(None) };
        path.stage = look(given, tuned, &mut path.by, options, progress)?;
        progress.step("what else");
        let mut fitted = try_all(&path.stage, &path.by);
        fitted.retain(|named| named.proposal.kind() != Kind::Law);
        if choose(&fitted, &path.stage, Prefer::Names).is_none() {
            return Ok(None);
        }
        path.walk(fitted, Prefer::Names, options, progress)
            .map(Some)
    }

    /// The better of two paths by the evidence, the other one with names in the place of a law.
    fn or(self, mut named: Self) -> Result<Self, DiagnosisError> {
        let advantage = named.advantage(&self).map_err(DiagnosisError::Undrivable)?;
        if advantage < 0.0 {
            return Ok(self);
        }
        for member in &mut named.members {
            member.outdo_law(advantage);
        }
        Ok(named)
    }

    /// Log odds of this path over another, under the noise of both on average.
    fn advantage(&self, other: &Self) -> Result<f64, PredictionError> {
        let price = |path: &Self| -> f64 {
            let members = path.members.iter().map(|member| &member.proposal);
            members.map(|m| NOTHING - m.log_prior() + m.looking).sum()
        };
        let surprise = |path: &Self, by: &Weighing| -> Result<f64, PredictionError> {
            let Tuned {
                knobs, solution, ..
            } = &path.stage.tuned;
            Ok(tune(&path.stage.given, knobs, solution, by)?.surprise + price(path))
        };
        let mut advantage = 0.0;
        for by in [&self.by, &other.by] {
            advantage += 0.5 * (surprise(other, by)? - surprise(self, by)?);
        }
        Ok(advantage)
    }
}

impl Member {
    /// A law that was ahead of a name has turned out to be behind by so much.
    fn outdo_law(&mut self, advantage: f64) {
        let subject = self.proposal.subject;
        if subject == Subject::Unknown {
            return;
        }
        let own = self.rivals.iter().filter(|(other, _)| *other == subject);
        let own = own.map(|(_, odds)| *odds).fold(f64::NEG_INFINITY, f64::max);
        for (other, odds) in &mut self.rivals {
            if *other == Subject::Unknown {
                *odds = odds.min(own - advantage);
            }
        }
    }
}

/// How much better it predicts what it was not fitted to, with the standard error.
fn held_out_gain(named: &Named, stage: &Stage) -> Option<(f64, f64)> {
    let pair = named.scores.as_ref().zip(stage.scores.as_ref());
    pair.map(|(with, without)| with.gain_over(without))
}

/// Log odds; what predicts worse what it was not fitted to is no likelier than nothing.
fn sound_odds(named: &Named, stage: &Stage) -> f64 {
    let sound = held_out_gain(named, stage).is_none_or(|(mean, error)| mean > -error);
    if sound {
        named.odds()
    } else {
        named.odds().min(0.0)
    }
}

/// What outweighs chance and does not predict worse.
fn worth_it<'n, 'a>(fitted: &'n [Named<'a>], stage: &Stage) -> impl Iterator<Item = &'n Named<'a>> {
    fitted.iter().filter(move |named| {
        let told = held_out_gain(named, stage).is_some();
        told && sound_odds(named, stage) > NOTHING + TAKE
    })
}

fn choose<'n, 'a>(fitted: &'n [Named<'a>], stage: &Stage, prefer: Prefer) -> Option<&'n Named<'a>> {
    let best = |names: bool| {
        worth_it(fitted, stage)
            .filter(|named| !names || named.proposal.kind() != Kind::Law)
            .max_by(|a, b| a.odds().total_cmp(&b.odds()))
    };
    let named = (prefer == Prefer::Names).then(|| best(true)).flatten();
    named.or_else(|| best(false))
}

/// Whether a law is the likeliest, and something with a name explains a good part of the same.
fn worth_two_ways(fitted: &[Named], stage: &Stage) -> bool {
    let first = |prefer| choose(fitted, stage, prefer);
    let pair = first(Prefer::Nothing).zip(first(Prefer::Names));
    pair.is_some_and(|(best, named)| {
        best.proposal.kind() == Kind::Law
            && named.proposal.kind() != Kind::Law
            && named.odds() > GOOD_PART * best.odds()
    })
}

/// The re-tuned model under the noise and weights at the end, its starts as they have become. On
/// some soils not every start can be driven: then those that it had.
fn tune_again(
    given: &Given,
    baseline: &Solution,
    last: &Solution,
    by: &Weighing,
) -> Result<Tuned, PredictionError> {
    let mut begin = back(given, last);
    begin.soil.clone_from(&baseline.soil);
    tune(given, &[], &begin, by).or_else(|_| tune(given, &[], baseline, by))
}

/// A solution with every effect off.
fn back(given: &Given, solution: &Solution) -> Solution {
    let mut back = solution.clone();
    for recording in &mut back.knobs {
        for (value, knob) in recording.iter_mut().zip(&given.candidates.knobs) {
            *value = knob.parameter.prior_coordinate();
        }
    }
    back
}
