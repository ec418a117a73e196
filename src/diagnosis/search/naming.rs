//! Step 6: what it is called.
//!
//! The best few candidates of the screen, of the box scan and of the laws are fitted in full, each
//! beside what was found before; the one with the largest evidence is taken where that outweighs
//! chance and predicts better what it was not fitted to (blocked cross-validation, see
//! `held_out`). Then everything is looked at anew with it inside (step 7, `search`).

use super::proposal::Proposal;
use crate::diagnosis::hypothesis::candidate::Target;
use crate::diagnosis::hypothesis::held_out::{Scores, scores};
use crate::diagnosis::hypothesis::likelihood::{
    HELD, LONG_SKETCH, SKETCH, Tuned, cost, tune_on, tune_until,
};
use crate::diagnosis::hypothesis::{Given, Solution};
use crate::diagnosis::screening::locate::Extent;
use crate::effects::{self, ParameterName, Window};
use crate::fit::optimiser::Stop;
use crate::fit::problem::Weighing;
use crate::fit::segment::CLOCK;

/// A hidden effect that begins so much worse, in units of the log likelihood, leads nowhere.
const HOPELESS: f64 = 1000.0;

/// Shares of a proposal's steps that its fit may begin with: the cheapest is taken.
const SHARES: [f64; 3] = [1.0, 0.4, 0.15];
/// Steps on the way from off to the typical size, and how far the soil follows at each.
const WALK: u32 = 5;
const STROLL: Stop = Stop {
    steps: 3,
    gain: 1.0,
};
/// Two fits of the same thing that are so close have come to one place.
const TWINS: f64 = 1.0;
/// A fit that is so much worse than without the proposal, whose price for more numbers is less, has
/// lost its way.
pub const LOST: f64 = 5.0;
/// So has one that comes to less than this share of what the linearised problem promises.
const SHORT: f64 = 0.5;

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
    if proposal.hidden { LONG_SKETCH } else { SKETCH }
}

impl<'a> Sketch<'a> {
    /// A fit that has begun beside what was found before.
    pub fn new(proposal: &Proposal, given: &Given<'a>, tuned: Tuned, before: &Tuned) -> Self {
        Self {
            gain: before.surprise - tuned.surprise - proposal.looking,
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
}

/// Takes the first steps of fitting a proposal to this share of the recordings. `None` where the model cannot drive
/// with it.
#[must_use]
pub fn sketch<'a>(
    given: &Given<'a>,
    proposal: &Proposal,
    before: &Tuned,
    by: &Weighing,
    share: f64,
) -> Option<Sketch<'a>> {
    let given = placed(given, proposal)?;
    let mut knobs = before.knobs.clone();
    knobs.extend(&proposal.knobs);
    let cheapest = cheapest(&given, proposal, &knobs, before, by);
    let stop = first_steps(proposal);
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
    let tuned = each.min_by(likelier);
    let lost = |tuned: &Tuned| tuned.surprise > before.surprise + LOST;
    let promised = SHORT * share * proposal.evidence;
    let short = |tuned: &Tuned| before.surprise - tuned.surprise + tuned.promised < promised - LOST;
    let step_alone = Solution {
        knobs: begin(&given, proposal, &before.solution, 1.0).knobs,
        ..before.solution.clone()
    };
    let again = |tuned: Option<Tuned>, failed: &dyn Fn(&Tuned) -> bool, begin: &Solution| {
        if proposal.hidden || !tuned.as_ref().is_none_or(failed) {
            return tuned;
        }
        let other = tune_until(&given, &knobs, begin, by, LONG_SKETCH).ok();
        tuned.into_iter().chain(other).min_by(likelier)
    };
    let tuned = if is_unseen(&given, proposal) && tuned.as_ref().is_none_or(lost) {
        let begin = walked(&given, proposal, before, by);
        let other = begin.and_then(|begin| tune_until(&given, &knobs, &begin, by, stop).ok());
        tuned.into_iter().chain(other).min_by(likelier)
    } else {
        tuned
    };
    // Without it things were better: from there, then.
    let tuned = again(tuned, &lost, &before.solution);
    // A small step may cost less before the starts have followed, and lead elsewhere, and soil that follows
    // may be more than the vehicle can drive on.
    let tuned = again(tuned, &short, &step_alone);
    let tuned = tuned.filter(|tuned| tuned.surprise.is_finite())?;
    Some(Sketch::new(proposal, &given, tuned, before))
}

/// Where a proposal's fit begins: the cheapest of some shares of its steps. `None` where a hidden effect
/// leads nowhere.
fn cheapest(
    given: &Given,
    proposal: &Proposal,
    knobs: &[usize],
    before: &Tuned,
    by: &Weighing,
) -> Option<Solution> {
    let at = |share: f64| {
        let begin = begin(given, proposal, &before.solution, share);
        (cost(given, knobs, &begin, by), begin)
    };
    let cheaper = |a: &(f64, Solution), b: &(f64, Solution)| a.0.total_cmp(&b.0);
    if !proposal.hidden {
        return SHARES
            .map(at)
            .into_iter()
            .min_by(cheaper)
            .map(|best| best.1);
    }
    // What is hidden tells its sign no more than its size. Small steps come first: where those lead
    // nowhere, larger ones are hardly to be driven, which takes long.
    let hopeless = cost(given, knobs, &before.solution, by) + HOPELESS;
    let mut found = Vec::new();
    for sign in [1.0, -1.0] {
        for share in SHARES.iter().rev() {
            let begin = at(sign * share);
            if begin.0 > hopeless {
                break;
            }
            found.push(begin);
        }
    }
    found.into_iter().min_by(cheaper).map(|best| best.1)
}

/// Finishes a fit.
#[must_use]
pub fn finish<'a>(sketch: Sketch<'a>, before: &Tuned, by: &Weighing) -> Option<Named<'a>> {
    let Sketch {
        proposal, given, ..
    } = sketch;
    let tuned = tune_on(&given, &sketch.tuned, by, HELD);
    let without = surprise_without(&given, &proposal, &tuned, before, by);
    Some(Named {
        gain: without - tuned.surprise - proposal.looking,
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
    if !proposal.hidden {
        return before.surprise;
    }
    let mut begin = tuned.solution.clone();
    begin.take(&proposal.knobs, &before.solution);
    let without = tune_until(given, &before.knobs, &begin, by, LONG_SKETCH);
    let surprise = without.map_or(f64::INFINITY, |tuned| tuned.surprise);
    before.surprise.min(surprise)
}

/// A share of a proposal's steps away from what was before.
fn begin(given: &Given, proposal: &Proposal, before: &Solution, share: f64) -> Solution {
    let mut begin = before.clone();
    let soil = begin.soil.iter_mut().zip(given.soil_parameters());
    for ((value, parameter), step) in soil.zip(proposal.soil.iter()) {
        let (low, high) = parameter.bounds();
        *value = (*value + share * step).clamp(low, high);
    }
    for (knob, steps) in &proposal.steps {
        let parameter = &given.candidates.knobs[*knob].parameter;
        let (low, high) = parameter.bounds();
        for (recording, knobs) in begin.knobs.iter_mut().enumerate() {
            let step = steps
                .get(recording)
                .or(steps.get(0))
                .copied()
                .unwrap_or(0.0);
            knobs[*knob] = (knobs[*knob] + share * step).clamp(low, high);
        }
    }
    begin
}

/// Where effects are proposed that have no derivative while they are off, as large as the catalogue expects
/// them, and what one run of several has, as large as it was seen: the soil fitted beside that from the given one.
/// The soil that re-tuning ended with imitates them; beside it, or freed at once, they would be turned off and stay
/// there.
fn settled(given: &Given, proposal: &Proposal, before: &Tuned, by: &Weighing) -> Option<Solution> {
    let of_a_run = matches!(proposal.extent, Some(Extent::Run(_)));
    if !of_a_run && !is_unseen(given, proposal) {
        return None;
    }
    let begin = Solution {
        knobs: begin(given, proposal, &before.solution, 1.0).knobs,
        ..given.begin()
    };
    Some(beside(given, proposal, begin, before, by, SKETCH)?.solution)
}

/// Where effects are proposed that have no derivative while they are off: the likeliest place on the way from off
/// to as large as the catalogue expects them, the soil following a little at each step. Re-tuning may have gone far to
/// imitate them (a rigid wheel on soil of three times the stiffness for a tyre): then one step is too long, and so is
/// the way from the given soil. `None` where the way leads up.
fn walked(given: &Given, proposal: &Proposal, before: &Tuned, by: &Weighing) -> Option<Solution> {
    let mut at = before.solution.clone();
    let mut best: Option<Tuned> = None;
    for step in 1..=WALK {
        let share = f64::from(step) / f64::from(WALK);
        at.knobs = begin(given, proposal, &before.solution, share).knobs;
        let Some(here) = beside(given, proposal, at, before, by, STROLL) else {
            break;
        };
        if here.surprise - here.promised > before.surprise + LOST {
            break;
        }
        at = here.solution.clone();
        if best.as_ref().is_none_or(|best| here.surprise < best.surprise) {
            best = Some(here);
        }
    }
    best.map(|best| best.solution)
}

/// Whether it is hidden and has no derivative while it is off.
fn is_unseen(given: &Given, proposal: &Proposal) -> bool {
    let mut own = proposal.knobs.iter();
    proposal.hidden && own.any(|knob| given.candidates.knobs[*knob].secant.is_some())
}

/// The fit of everything else beside a proposal whose knobs are held where they begin. `None` where that cannot be
/// driven.
fn beside(
    given: &Given,
    proposal: &Proposal,
    begin: Solution,
    before: &Tuned,
    by: &Weighing,
    stop: Stop,
) -> Option<Tuned> {
    let knobs = &given.candidates.knobs;
    let mut held = given.clone();
    for knob in &proposal.knobs {
        if let Target::Model(parameter) = knobs[*knob].target {
            let value = knobs[*knob].parameter.value(begin.knobs[0][*knob]);
            parameter.set(&mut held.nominal, value).ok()?;
        }
    }
    let fitted = tune_until(&held, &before.knobs, &begin, by, stop);
    fitted.ok().filter(|fitted| fitted.surprise.is_finite())
}

/// Where latencies are proposed: they are what comparing the curves tells. A search from zero may
/// end where motions are matched with their neighbours.
fn compared(given: &Given, proposal: &Proposal, before: &Solution) -> Option<Solution> {
    let mut begin = before.clone();
    let mut told = false;
    for knob in &proposal.knobs {
        let Target::Sensor(sensor) = given.candidates.knobs[*knob].target else {
            continue;
        };
        for (values, late) in begin.knobs.iter_mut().zip(&given.late) {
            values[*knob] += late[sensor.index()];
            told |= late[sensor.index()] != 0.0;
        }
    }
    told.then_some(begin)
}

/// The given model with the place where a proposal acts. `None` where it cannot act there.
fn placed<'a>(given: &Given<'a>, proposal: &Proposal) -> Option<Given<'a>> {
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
