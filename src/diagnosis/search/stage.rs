//! A hypothesis with everything that is known around it: what it leaves over, what may be missing,
//! how it predicts.

use super::choice::{Prefer, choose};
use super::company::{beside_the_likeliest, fitted_there, join, likeliest, otherwise_confined};
use super::contest::contend;
use super::edges::settle_edges;
use super::given_soil::{from_given_soil, seen_from_given_soil};
use super::naming::{Named, Sketch, finish, sketch};
use super::proposal::{Kind, Proposal, Screened, hidden, proposals, screened, shortlist};
use super::scout::Scouts;
use super::view::View;
use super::{NOTHING, TAKE};
use crate::diagnosis::hypothesis::held_out::{Scores, scores};
use crate::diagnosis::hypothesis::likelihood::{Tuned, tune_restarted};
use crate::diagnosis::hypothesis::part::Part;
use crate::diagnosis::hypothesis::{Given, Solution};
use crate::diagnosis::screening::noise;
use crate::diagnosis::screening::screen::chance;
use crate::diagnosis::screening::sensitivity::{Layout, sensitivities};
use crate::diagnosis::screening::system::{System, linearise, weigh};
use crate::diagnosis::screening::wrench::{Wandering, wandering};
use crate::diagnosis::{DiagnosisError, Options, Progress};
use crate::fit::problem::Weighing;
use std::sync::Arc;

/// What a candidate looked like under the re-tuned model.
#[derive(Debug, Clone)]
pub struct Looked {
    /// What the screen saw.
    pub screened: Vec<Screened>,
    /// The largest chi-square that chance alone gives.
    pub threshold: f64,
    /// The linearised problem.
    pub system: System,
    /// A wrench that comes and goes.
    pub wandering: Option<Wandering>,
}

/// Draws of simulated nulls, and the share of them below the threshold.
const NULLS: usize = 500;
const SHARE: f64 = 0.95;
/// Fits that are further behind after their first steps are not finished, or not widened to all stretches.
const NEAR: f64 = 0.75;
const NEAR_ON_A_PART: f64 = 0.5;
/// The same where the likeliest acts: they do not differ by where they were looked for.
const NEAR_THERE: f64 = 0.9;
pub const CLOSE: f64 = 5.0;
/// Where a law is likeliest, names lead on as well that have this share of its odds: a law may be two effects at once.
pub const GOOD_PART: f64 = 0.2;
/// What acts at some time or place only comes to at most so many times what the linearised problem promises.
const LINEAR: f64 = 3.0;
/// At most so many are finished.
const MOST: usize = 7;
/// A soil that moves by more than this share of its prior's deviation is looked at anew.
const MOVED: f64 = 0.02;
/// A start that moves by more than this is looked at anew: pose \[m, m, rad\], then velocities.
const ASTRAY: [f64; 6] = [0.2, 0.2, 0.05, 0.1, 0.1, 0.1];

/// A hypothesis and everything that is known with it inside.
#[derive(Debug, Clone)]
pub struct Stage<'a> {
    /// The given model with the places of what is on.
    pub given: Given<'a>,
    /// The hypothesis, fitted.
    pub tuned: Tuned,
    /// What everything else looks like beside it.
    pub looked: Arc<Looked>,
    /// What may be missing.
    pub proposals: Vec<Proposal>,
    /// How it predicts what it was not fitted to.
    pub scores: Option<Scores>,
}

/// Looks at everything around a hypothesis; noise and weights move along. Beside nothing yet, effects that
/// re-tuning may hide are among the proposals.
pub fn look<'a>(
    given: Given<'a>,
    tuned: Tuned,
    by: &mut Weighing,
    options: &Options,
    progress: &Progress,
) -> Result<Stage<'a>, DiagnosisError> {
    progress.step("sensitivities to every candidate")?;
    let on = tuned.knobs.clone();
    let layout = Layout::new(&given, &on);
    let mut tables = sensitivities(&given, &layout, &tuned.solution);
    weigh(&given, &on, &tuned.tables, by);
    progress.step("noise")?;
    noise::update(
        &given,
        &linearise(&given, &layout, &tables, &tuned.solution, by),
        &tables,
        &tuned.solution,
        by,
    );
    progress.step("re-tuning the soil")?;
    let again = tune_restarted(&given, &tuned, by);
    progress.step("sensitivities to every candidate")?;
    let mut at = tuned.solution.clone();
    if moved(&given, &at, &again.solution) > MOVED {
        at = again.solution.clone();
        // Both at once would be most of what a diagnosis needs of memory.
        drop(tables);
        tables = sensitivities(&given, &layout, &at);
    } else if let Some(part) = strayed(&at, &again.solution) {
        for place in part.places() {
            at.starts[*place] = again.solution.starts[*place];
        }
        let anew = sensitivities(&part.given(&given), &layout, &part.solution(&at));
        for (place, table) in part.places().iter().zip(anew) {
            tables[*place] = table;
        }
    }
    let system = linearise(&given, &layout, &tables, &at, by);
    drop(tables);
    let view = View::new(&given, &system, &on, by).ok_or(DiagnosisError::NotFinite)?;
    progress.step("screening and locating")?;
    let screened = screened(&view);
    let equations: Vec<_> = screened.iter().map(|one| one.projected.clone()).collect();
    let threshold = chance(&view.projection, &equations, SHARE, NULLS, options.seed);
    let soil = &again.solution.soil;
    let seed = options.seed;
    let all = proposals(&view, &screened, soil, seed);
    let mut proposals: Vec<Proposal> = shortlist(&all).into_iter().cloned().collect();
    if on.is_empty() {
        proposals.extend(hidden(&view, &screened));
        let further = seen_from_given_soil(&given, &again, by, &proposals, seed);
        proposals.extend(further);
    }
    let wandering = wandering(&given, &system);
    let scores = scores(&given, &again, by);
    Ok(Stage {
        looked: Arc::new(Looked {
            screened,
            threshold,
            system,
            wandering,
        }),
        proposals,
        scores,
        tuned: again,
        given,
    })
}

/// How far the soil moved, in standard deviations of its prior.
fn moved(given: &Given, from: &Solution, to: &Solution) -> f64 {
    let scales = given.soil_parameters();
    let pairs = from.soil.iter().zip(&to.soil).zip(&scales);
    let each = pairs.map(|((a, b), scale)| (a - b).abs() / scale.prior.deviation);
    each.fold(0.0, f64::max)
}

/// The stretches whose start was found elsewhere: what it leaves over there is another thing.
fn strayed(from: &Solution, to: &Solution) -> Option<Part> {
    let pairs = from.starts.iter().zip(&to.starts).enumerate();
    let strayed = pairs.filter(|(_, (a, b))| {
        let mut each = a.iter().zip(b.iter()).zip(ASTRAY);
        each.any(|((a, b), limit)| (a - b).abs() > limit)
    });
    let places = strayed.map(|(place, _)| place).collect();
    Part::some(places, from.starts.len())
}

/// Fits what is worth it: all begin, and those that are not far behind after some steps are finished. Where time is up
/// nothing more begins, and what has begun stands as it is; but beside nothing yet all begin, and what may be worth
/// taking is finished until something is, for that nothing is missing can only be said of what was tried.
///
/// # Errors
/// Somebody wants it to end.
pub fn try_all<'a>(
    stage: &Stage<'a>,
    by: &Weighing,
    progress: &Progress,
) -> Result<Vec<Named<'a>>, DiagnosisError> {
    let Stage { given, tuned, .. } = stage;
    let first = tuned.knobs.is_empty();
    let begins = || !progress.is_stopped() && (first || !progress.is_late());
    let begun = match Scouts::new(given, tuned, by) {
        Some(scouts) => scouted(stage, &scouts, by, begins),
        None => {
            let all = stage.proposals.iter().take_while(|_| begins());
            sketched(all, NEAR, |one, least| {
                sketch(given, one, tuned, by, 1.0, least)
            })
        }
    };
    let best = |fitted: &[Named]| fitted.iter().map(Named::odds).fold(0.0, f64::max);
    let mut fitted = Vec::new();
    let mut left = promising(begun, NEAR, MOST).into_iter();
    // Late beside nothing yet: whether the most promising of what is left has to be known.
    let is_needed = |fitted: &[Named], left: &[Sketch]| {
        let may_be_taken = left.first().is_some_and(|s| s.promise() > NOTHING + TAKE);
        first && may_be_taken && choose(fitted, stage, Prefer::Nothing).is_none()
    };
    while left.len() > 0
        && !progress.is_stopped()
        && (!progress.is_late() || is_needed(&fitted, left.as_slice()))
    {
        let sketch = left.next().map(|one| from_given_soil(one, tuned, by));
        fitted.extend(sketch.and_then(|sketch| finish(sketch, tuned, by)));
    }
    let largest = best(&fitted);
    settle_edges(&mut fitted, largest, by);
    for where_else in [beside_the_likeliest, otherwise_confined] {
        if progress.is_stopped() {
            return Err(DiagnosisError::Stopped);
        }
        let likeliest = likeliest(&fitted).filter(|_| !progress.is_late());
        let Some((likeliest, _)) = likeliest else {
            break;
        };
        let there = where_else(stage, &fitted);
        let least = NEAR_THERE * best(&fitted) - CLOSE;
        let mut there = fitted_there(stage, &there, likeliest, least, by);
        let largest = best(&fitted).max(best(&there));
        settle_edges(&mut there, largest, by);
        join(&mut fitted, there);
    }
    if left.len() > 0 {
        let largest = best(&fitted);
        fitted.extend(left.map(|sketch| sketch.unfinished(largest)));
    } else {
        contend(&mut fitted, by);
    }
    Ok(fitted)
}

/// The first steps on a long recording: what acts throughout takes them on a part, and on all of it where it
/// keeps its promise; what acts at some time or place only takes all, where it may come near.
fn scouted<'a>(
    stage: &Stage<'a>,
    scouts: &Scouts<'a>,
    by: &Weighing,
    begins: impl Fn() -> bool,
) -> Vec<Sketch<'a>> {
    let Stage { given, tuned, .. } = stage;
    let proposals = stage.proposals.iter();
    let (throughout, local): (Vec<_>, Vec<_>) = proposals.partition(|p| p.extent.is_none());
    let throughout = throughout.into_iter().take_while(|_| begins());
    let begun = sketched(throughout, NEAR_ON_A_PART, |one, least| {
        scouts.sketch(one, least)
    });
    let near = promising(begun, NEAR_ON_A_PART, 2 * MOST);
    let further = near.iter().map(|sketch| scouts.further(sketch));
    let near = promising(further.collect(), NEAR_ON_A_PART, MOST);
    let bar = Bar::of(&near);
    let widened = near.iter().take_while(|_| begins());
    let widened = widened.filter_map(|sketch| {
        let least = bar.least(sketch.proposal.kind(), NEAR);
        scouts.widened(sketch, given, tuned, by, least)
    });
    let may_be_near = |p: &&Proposal| LINEAR * p.evidence > bar.least(p.kind(), NEAR_ON_A_PART);
    let local = local.into_iter().filter(may_be_near);
    let local = local.take_while(|_| begins());
    let least = |one: &Proposal| bar.least(one.kind(), NEAR_ON_A_PART);
    let local = local.filter_map(|one| sketch(given, one, tuned, by, 1.0, least(one)));
    widened.chain(local).collect()
}

/// Those whose fit could begin. Each is followed as far as it may come to this share of the best so far.
fn sketched<'a, 'p>(
    proposals: impl Iterator<Item = &'p Proposal>,
    share: f64,
    begin: impl Fn(&Proposal, f64) -> Option<Sketch<'a>>,
) -> Vec<Sketch<'a>> {
    let mut begun = Vec::new();
    for proposal in proposals {
        let least = Bar::of(&begun).least(proposal.kind(), share);
        begun.extend(begin(proposal, least));
    }
    begun
}

/// Those that may come to this share of the best, the most promising first, at most so many.
fn promising<'a>(mut sketches: Vec<Sketch<'a>>, share: f64, most: usize) -> Vec<Sketch<'a>> {
    sketches.sort_by(|a, b| b.promise().total_cmp(&a.promise()));
    // What was proposed twice, as seen and as hidden, and came to the same is finished once.
    let mut once: Vec<Sketch> = Vec::new();
    for sketch in sketches {
        if !once.iter().any(|earlier| sketch.is_twin_of(earlier)) {
            once.push(sketch);
        }
    }
    let mut sketches = once;
    let bar = Bar::of(&sketches);
    sketches.truncate(most);
    sketches.retain(|sketch| sketch.promise() > bar.least(sketch.proposal.kind(), share));
    sketches
}

/// The largest log odds of laws and of names, by which the others are measured.
struct Bar {
    law: f64,
    name: f64,
}

impl Bar {
    fn of(sketches: &[Sketch]) -> Self {
        let is_law = |sketch: &&Sketch| sketch.proposal.kind() == Kind::Law;
        let (laws, names): (Vec<&Sketch>, Vec<&Sketch>) = sketches.iter().partition(is_law);
        let best = |of: Vec<&Sketch>| of.into_iter().map(Sketch::odds).fold(0.0, f64::max);
        Self {
            law: best(laws),
            name: best(names),
        }
    }

    /// What comes to less is not gone on with: less than this share of the best. Of what has a name the best with a
    /// name counts, where that explains a good part of what a law does.
    fn least(&self, kind: Kind, share: f64) -> f64 {
        let best = match kind {
            Kind::Law => share * self.law.max(self.name),
            _ => (share * self.name).max(GOOD_PART * self.law),
        };
        best - CLOSE
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::diagnosis::hypothesis::likelihood::tune_with_noise;
    use crate::diagnosis::hypothesis::prepare::prepare;
    use crate::recording::Recording;
    use crate::vehicle::Specification;

    /// The re-tuned model of recordings, looked at, and the noise that it leaves.
    pub fn retuned<'a>(
        nominal: &Specification,
        recordings: &'a [Recording],
    ) -> (Stage<'a>, Weighing) {
        retuned_with(nominal, recordings, &Options::default())
    }

    /// The same with other options.
    pub fn retuned_with<'a>(
        nominal: &Specification,
        recordings: &'a [Recording],
        options: &Options,
    ) -> (Stage<'a>, Weighing) {
        let mut given = Given::new(nominal, recordings);
        let (_, mut by) = prepare(&mut given, options).unwrap();
        let fitted = tune_with_noise(&given, &[], &given.begin(), &mut by).unwrap();
        let progress = Progress::new(&|_: &'static str| {});
        let stage = look(given, fitted, &mut by, options, &progress).unwrap();
        (stage, by)
    }

    #[test]
    fn stretches_whose_start_was_found_elsewhere_are_looked_at_anew() {
        let before = Solution {
            soil: Vec::new(),
            knobs: Vec::new(),
            starts: vec![[0.0; 6]; 3],
        };
        assert!(strayed(&before, &before).is_none());
        let mut after = before.clone();
        after.starts[0][0] = 0.1;
        after.starts[1][4] = -0.3;
        assert_eq!(strayed(&before, &after).unwrap().places(), [1]);
    }

    #[test]
    fn a_law_does_not_set_the_bar_for_names() {
        let bar = |law, name| Bar { law, name };
        for kind in [Kind::Throughout, Kind::Local] {
            // Two effects at once: a law has the most of both, each name two thirds or less.
            let least = bar(1000.0, 400.0).least(kind, NEAR);
            assert!((300.0 - CLOSE - least).abs() < 1e-9);
            // A name that explains next to nothing of it leads nowhere, however good it is among names.
            let least = bar(1000.0, 10.0).least(kind, NEAR);
            assert!((GOOD_PART * 1000.0 - CLOSE - least).abs() < 1e-9);
        }
        let least = |law, name| bar(law, name).least(Kind::Law, NEAR);
        assert!((least(1000.0, 400.0) - least(400.0, 1000.0)).abs() < 1e-9);
    }
}
