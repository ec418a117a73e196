//! One thing after another: what is missing, and what else.
//!
//! Each round looks at everything with what was found so far inside (step 7: what is left over after
//! the winner decides whether the winner is adequate), and ends when nothing more is worth it.

pub mod begins;
pub mod choice;
mod company;
pub mod contest;
pub mod edges;
pub mod given_soil;
pub mod load;
pub mod member;
pub mod naming;
pub mod path;
pub mod proposal;
pub mod prune;
pub mod scout;
pub mod stage;
pub mod trial;
pub mod view;
pub mod wheels;

use crate::diagnosis::hypothesis::likelihood::{
    HELD, LONG_SKETCH, Tuned, own_noise, tune, tune_on, tune_until, tune_with_noise,
};
use crate::diagnosis::hypothesis::{Given, Solution};
use crate::diagnosis::{DiagnosisError, Options, Progress, Subject};
use crate::fit::optimiser::Stop;
use crate::fit::predictor::PredictionError;
use crate::fit::problem::Weighing;
use choice::held_out_gain;
pub use member::Member;
use naming::Named;
use path::Path;
use stage::{Looked, Stage, look};
use std::sync::Arc;
use trial::try_all;
use wheels::reconstructed;

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
    /// Whether there was time to fit everything that may be missing.
    pub tried: bool,
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
        // Its intervals are those of the noise that is told.
        self.retuned = tune_on(&self.given, &self.retuned, &self.by, HELD);
        self.augmented = self.retuned.clone();
        self.placed = self.given.clone();
        self.last = Arc::clone(&self.first);
    }
}

/// Log odds that something must have over nothing more, its prior counted.
pub const TAKE: f64 = 0.5;
/// Logarithm of the prior of nothing (more) over that of one effect of the catalogue.
pub const NOTHING: f64 = 4.5;
/// Re-tuning is begun again where that gains so much \[log odds\], so many times at most.
const STUCK: f64 = 5.0;
const AGAIN: usize = 2;

/// Searches. From the first look on there is an answer: where the search has to end, it ends with what was found.
///
/// # Errors
/// A model that cannot even begin, numbers that are not finite, no time for a first look.
pub fn search<'a>(
    given: &Given<'a>,
    mut by: Weighing,
    options: &Options,
    progress: &'a Progress,
) -> Result<Searched<'a>, DiagnosisError> {
    progress.step("re-tuning the soil")?;
    let begin = given.begin();
    let undrivable = |error| progress.failure(error);
    let retuned = tune_with_noise(given, &[], &begin, &mut by).map_err(undrivable)?;
    progress.in_time(given.deadline)?;
    let (mut given, retuned) = reconstructed(given, retuned, &mut by, progress);
    progress.in_time(given.deadline)?;
    given.tolerate(&by);
    let mut stage = look(given.clone(), retuned, &mut by, options, progress)?;
    stage.given.deadline = progress.search_deadline();
    // To fall back on where there is no time to fit it under the noise at the end.
    let known = progress.limit().map(|_| stage.tuned.clone());
    progress.step("naming")?;
    let mut fitted = try_all(&stage, &by, progress)?;
    for _ in 0..AGAIN {
        if progress.is_late() {
            break;
        }
        let Some(better) = unstuck(&stage, &fitted, &by) else {
            break;
        };
        match look(stage.given.clone(), better, &mut by, options, progress) {
            Err(DiagnosisError::OutOfTime) => break,
            looked => stage = looked?,
        }
        progress.step("naming")?;
        fitted = try_all(&stage, &by, progress)?;
    }
    let first = Arc::clone(&stage.looked);
    let tested = stage.scores.is_some();
    let baseline = stage.tuned.solution.clone();
    let gain = |n: &Named| Some((n.proposal.subject, held_out_gain(n, &stage)?));
    let gains = fitted.iter().filter_map(gain).collect();
    let path = Path::new(stage, by).explored(fitted, options, progress)?;
    let Path {
        mut stage,
        by,
        members,
        refused,
        ..
    } = path;
    let tried = !progress.was_late();
    stage.given.deadline = given.deadline;
    let again = tune_again(&given, &baseline, &stage.tuned.solution, &by);
    let retuned = match (again, known) {
        (Err(PredictionError::OutOfTime), Some(known)) => {
            tune_on(&given, &known, &by, Stop::after(0, 0.0).without_renewals())
        }
        (again, _) => again.map_err(undrivable)?,
    };
    Ok(Searched {
        given,
        by,
        retuned,
        placed: stage.given,
        augmented: stage.tuned,
        members,
        refused,
        gains,
        tested,
        tried,
        first,
        last: stage.looked,
    })
}

/// The re-tuned model from where the likeliest of what was fitted beside it ended, without that: re-tuning may
/// have stuck on the way there. `None` where it is no better.
fn unstuck(stage: &Stage, fitted: &[Named], by: &Weighing) -> Option<Tuned> {
    let best = fitted.iter().max_by(|a, b| a.gain.total_cmp(&b.gain))?;
    if best.gain < STUCK {
        return None;
    }
    let mut begin = best.tuned.solution.clone();
    begin.take(&best.proposal.knobs, &stage.tuned.solution);
    let knobs = &stage.tuned.knobs;
    let again = tune_until(&stage.given, knobs, &begin, by, LONG_SKETCH).ok()?;
    (again.surprise < stage.tuned.surprise - STUCK).then_some(again)
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

#[cfg(test)]
mod tests {
    use super::stage::tests::retuned;
    use super::*;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};

    #[test]
    fn re_tuning_begins_again_where_another_way_led_further() {
        let on =
            |soil: &str| Specification::plain(Vehicle::tran2007(), Terrain::preset(soil).unwrap());
        let recordings = [driven(&on("sandy_loam"), "spiral")];
        let nominal = on("dry_sand");
        let (mut stage, by) = retuned(&nominal, &recordings);
        let given = stage.given.clone();
        let proposal = stage.proposals.first().cloned().unwrap();
        let gain = 10.0 * STUCK;
        let beside = Named {
            given: given.clone(),
            tuned: stage.tuned.clone(),
            scores: None,
            proposal,
            gain,
        };
        // As well as it can be: nothing to begin again for.
        assert!(unstuck(&stage, std::slice::from_ref(&beside), &by).is_none());
        // Stuck where it began.
        let still = Stop::after(0, 0.0);
        stage.tuned = tune_until(&given, &[], &given.begin(), &by, still).unwrap();
        assert!(stage.tuned.surprise > beside.tuned.surprise + STUCK);
        let found = unstuck(&stage, std::slice::from_ref(&beside), &by).unwrap();
        assert!((found.surprise - beside.tuned.surprise).abs() < 1.0);
        // What gains nothing does not tell of another way.
        assert!(
            unstuck(
                &stage,
                &[Named {
                    gain: 0.0,
                    ..beside
                }],
                &by
            )
            .is_none()
        );
    }
}
