//! Step 6: what it is called.
//!
//! The best few candidates of the screen, of the box scan and of the laws are fitted in full, each
//! beside what was found before; the one with the largest evidence is taken where that outweighs
//! chance and predicts better what it was not fitted to (blocked cross-validation, see
//! `held_out`). Then everything is looked at anew with it inside (step 7, `search`).

use super::begins::{LOST, begin, cheapest, compared, is_unseen, settled, walked};
use super::given_soil::on_given_soil;
use super::proposal::Proposal;
use crate::diagnosis::hypothesis::held_out::{Scores, scores};
use crate::diagnosis::hypothesis::likelihood::{
    LONG_SKETCH, SKETCH, Tuned, tune_restarted, tune_until,
};
use crate::diagnosis::hypothesis::{Given, Solution};
use crate::diagnosis::screening::locate::Extent;
use crate::effects::{self, ParameterName, Window};
use crate::fit::optimiser::Stop;
use crate::fit::problem::Weighing;
use crate::fit::segment::CLOCK;

/// Two fits of the same thing that are so close have come to one place.
const TWINS: f64 = 1.0;
/// A fit that comes to less than this share of what the linearised problem promises has lost its way as well.
const SHORT: f64 = 0.5;

/// Log odds that every fit is of use for.
#[cfg(test)]
pub const ANY: f64 = f64::NEG_INFINITY;
/// What priors and determinants may differ by between two hypotheses, in units of the log evidence.
const UNSURE: f64 = 15.0;

/// A proposal fitted in full beside what was found before.
#[derive(Debug, Clone)]
pub struct Named<'a> {
    /// What was proposed.
    pub proposal: Proposal,
    /// The given model with the place where it acts.
    pub given: Given<'a>,
    /// The fit.
    pub tuned: Tuned,
    /// How it predicts what it was not fitted to.
    pub scores: Option<Scores>,
    /// Log Bayes factor against the hypothesis without it.
    pub gain: f64,
}

impl Named<'_> {
    /// Log odds against the hypothesis without it.
    #[must_use]
    pub fn odds(&self) -> f64 {
        self.gain + self.proposal.log_prior()
    }

    /// One that was not finished: nothing can be named by it, and it is no likelier than the likeliest that was.
    #[must_use]
    pub fn behind(self, likeliest: f64) -> Self {
        Self {
            gain: self.gain.min(likeliest - self.proposal.log_prior()),
            scores: None,
            ..self
        }
    }
}

/// A proposal whose fit beside what is on has begun.
#[derive(Debug)]
pub struct Sketch<'a> {
    /// What was proposed.
    pub(super) proposal: Proposal,
    /// The given model with the place where it acts.
    pub(super) given: Given<'a>,
    /// The fit so far.
    pub(super) tuned: Tuned,
    /// Log Bayes factor against the hypothesis without it, as far as it has come.
    pub(super) gain: f64,
    /// By how much it was scaled up, where the fit is to a part of the recording.
    pub(super) scale: f64,
}

/// When the first steps of a proposal's fit end.
pub fn first_steps(proposal: &Proposal) -> Stop {
    if proposal.hidden || proposal.anew {
        LONG_SKETCH
    } else {
        SKETCH
    }
}

impl<'a> Sketch<'a> {
    /// A fit that has begun beside what was found before.
    pub fn new(proposal: &Proposal, given: &Given<'a>, tuned: Tuned, before: &Tuned) -> Self {
        Self {
            gain: before.surprise - tuned.surprise - proposal.price,
            proposal: proposal.clone(),
            given: given.clone(),
            tuned,
            scale: 1.0,
        }
    }

    /// Log odds against the hypothesis without it, as far as it has come.
    #[must_use]
    pub fn odds(&self) -> f64 {
        self.gain + self.proposal.log_prior()
    }

    /// Whether it is the same thing as another, fitted as far.
    #[must_use]
    pub fn is_twin_of(&self, other: &Self) -> bool {
        (self.proposal.subject, &self.proposal.extent)
            == (other.proposal.subject, &other.proposal.extent)
            && (self.odds() - other.odds()).abs() < TWINS * self.scale
    }

    /// The same with what the next step promises: so far it may come.
    #[must_use]
    pub fn promise(&self) -> f64 {
        self.odds() + self.tuned.promised
    }

    /// As it stands, as likely as it promises.
    pub fn unfinished(self) -> Named<'a> {
        Named {
            gain: self.promise() - self.proposal.log_prior(),
            proposal: self.proposal,
            given: self.given,
            tuned: self.tuned,
            scores: None,
        }
    }
}

/// Takes the first steps of fitting a proposal to this share of the recordings, as far as it is likely to come to the
/// least log odds there that are of use. `None` where the model cannot drive with it.
#[must_use]
pub fn sketch<'a>(
    given: &Given<'a>,
    proposal: &Proposal,
    before: &Tuned,
    by: &Weighing,
    share: f64,
    least: f64,
) -> Option<Sketch<'a>> {
    // A knob costs evidence besides what it gains.
    let useful = before.misfit - (least + proposal.price - proposal.log_prior());
    let useful = 2.0 * (useful + UNSURE);
    let given = placed(given, proposal)?;
    let mut knobs = before.knobs.clone();
    knobs.extend(&proposal.knobs);
    let cheapest = if proposal.anew {
        cheapest(&given, proposal, &knobs, &on_given_soil(&given, before), by)
    } else {
        cheapest(&given, proposal, &knobs, &before.solution, by)
    };
    let stop = first_steps(proposal).unless_above(useful);
    // What comparing curves tells costs much before the starts have followed: it has a fit of its own.
    let begins = cheapest
        .into_iter()
        .chain(compared(&given, proposal, &before.solution))
        .chain(settled(&given, proposal, before, by));
    let each = begins.filter_map(|begin| {
        let tuned = tune_until(&given, &knobs, &begin, by, stop);
        tuned.ok().filter(|tuned| tuned.surprise.is_finite())
    });
    let likelier = |a: &Tuned, b: &Tuned| a.surprise.total_cmp(&b.surprise);
    let mut tuned = each.min_by(likelier);
    let lost = |tuned: &Tuned| tuned.surprise > before.surprise + LOST;
    let promised = SHORT * share * proposal.evidence;
    let short = |tuned: &Tuned| before.surprise - tuned.surprise + tuned.promised < promised - LOST;
    let also = |tuned: Option<Tuned>, begin: &Solution| {
        let other = tune_until(&given, &knobs, begin, by, LONG_SKETCH.unless_above(useful)).ok();
        tuned.into_iter().chain(other).min_by(likelier)
    };
    // Where no way led, in small steps from off.
    if is_unseen(&given, proposal)
        && tuned.as_ref().is_none_or(lost)
        && let Some(begin) = walked(&given, proposal, before, by)
    {
        tuned = also(tuned, &begin);
    }
    if !proposal.hidden && tuned.as_ref().is_none_or(lost) {
        // Without it things were better: from there, then.
        tuned = also(tuned, &before.solution);
    }
    if !proposal.hidden && tuned.as_ref().is_none_or(short) {
        // A small step may cost less before the starts have followed, and lead elsewhere, and soil that follows
        // may be more than the vehicle can drive on.
        let knobs = begin(&given, proposal, &before.solution, 1.0).knobs;
        let rest = before.solution.clone();
        tuned = also(tuned, &Solution { knobs, ..rest });
    }
    let tuned = tuned.filter(|tuned| tuned.surprise.is_finite())?;
    Some(Sketch::new(proposal, &given, tuned, before))
}

/// Finishes a fit.
#[must_use]
pub fn finish<'a>(sketch: Sketch<'a>, before: &Tuned, by: &Weighing) -> Option<Named<'a>> {
    let Sketch {
        proposal, given, ..
    } = sketch;
    let tuned = tune_restarted(&given, &sketch.tuned, by);
    let without = surprise_without(&given, &proposal, &tuned, before, by);
    Some(Named {
        gain: without - tuned.surprise - proposal.price,
        scores: scores(&given, &tuned, by),
        proposal,
        given,
        tuned,
    })
}

/// Minus the log evidence without a proposal. One that began far off may have come to a better soil, which
/// is not its merit: then also from where it ended.
fn surprise_without(
    given: &Given,
    proposal: &Proposal,
    tuned: &Tuned,
    before: &Tuned,
    by: &Weighing,
) -> f64 {
    if !proposal.hidden && !proposal.anew {
        return before.surprise;
    }
    let mut begin = tuned.solution.clone();
    begin.take(&proposal.knobs, &before.solution);
    let without = tune_until(given, &before.knobs, &begin, by, LONG_SKETCH);
    let surprise = without.map_or(f64::INFINITY, |tuned| tuned.surprise);
    before.surprise.min(surprise)
}

/// The given model with the place where a proposal acts. `None` where it cannot act there.
#[must_use]
pub fn placed<'a>(given: &Given<'a>, proposal: &Proposal) -> Option<Given<'a>> {
    let mut given = given.clone();
    let Some(extent) = &proposal.extent else {
        return Some(given);
    };
    let mut effects: Vec<usize> = proposal
        .knobs
        .iter()
        .map(|knob| given.candidates.knobs[*knob].effect)
        .collect();
    effects.sort_unstable();
    effects.dedup();
    let model = &mut given.nominal.effects;
    let extent = match *extent {
        Extent::Beyond {
            direction,
            position,
        } => {
            let name = |name: &str| ParameterName::find(&format!("terrain_change.{name}"));
            model.set(name("direction")?, direction).ok()?;
            model.set(name("position")?, position).ok()?;
            return Some(given);
        }
        Extent::Time(at) | Extent::Run(at) => {
            let runs = |recording: usize| given.recordings[recording].runs.len();
            let before: usize = (0..at.recording).map(runs).sum::<usize>() + at.run;
            let clock = CLOCK * before as f64;
            effects::Extent::Time {
                start: clock + at.start,
                end: clock + at.end,
            }
        }
        Extent::Place {
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
    Some(given)
}

fn is_change(effect: usize) -> bool {
    effects::CATALOGUE[effect].name == crate::diagnosis::hypothesis::candidate::TERRAIN_CHANGE
}
