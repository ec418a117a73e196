//! What may be missing, fitted beside a hypothesis: all begin, the promising ones are finished.

use super::company::{beside_the_likeliest, fitted_there, join, likeliest, otherwise_confined};
use super::contest::contend;
use super::edges::settle_edges;
use super::given_soil::from_given_soil;
use super::naming::{Named, Sketch, finish, sketch};
use super::proposal::{Kind, Proposal};
use super::scout::Scouts;
use super::stage::Stage;
use crate::diagnosis::hypothesis::Given;
use crate::diagnosis::{DiagnosisError, Progress};
use crate::fit::problem::Weighing;

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

/// Of the time that the search still has, first steps may take this share: what has begun is worth little unless some of
/// it is finished.
const FIRST_STEPS: f64 = 0.6;

/// Fits what is worth it: all begin, and those that are not far behind after some steps are finished. Where time is up,
/// what has begun stands as it is, and nothing can be named by it.
///
/// # Errors
/// Somebody wants it to end.
pub fn try_all<'a>(
    stage: &Stage<'a>,
    by: &Weighing,
    progress: &'a Progress,
) -> Result<Vec<Named<'a>>, DiagnosisError> {
    let Stage { given, tuned, .. } = stage;
    let hasty = Given {
        deadline: progress.share_of_search(FIRST_STEPS),
        ..given.clone()
    };
    let mut begun = match Scouts::new(&hasty, tuned, by) {
        Some(scouts) => scouted(&hasty, stage, &scouts, by),
        None => {
            let all = stage.proposals.iter();
            let all = all.take_while(|_| !hasty.deadline.is_over());
            sketched(all, NEAR, |one, least| {
                sketch(&hasty, one, tuned, by, 1.0, least)
            })
        }
    };
    for sketch in &mut begun {
        sketch.given.deadline = given.deadline;
    }
    let best = |fitted: &[Named]| fitted.iter().map(Named::odds).fold(0.0, f64::max);
    let (mut fitted, mut unfinished) = (Vec::new(), Vec::new());
    for sketch in promising(begun, NEAR, MOST) {
        progress.go_on()?;
        if progress.is_late() {
            unfinished.push(sketch.unfinished());
            continue;
        }
        let finished = finish(from_given_soil(sketch, tuned, by), tuned, by);
        let list = if progress.is_late() {
            &mut unfinished
        } else {
            &mut fitted
        };
        list.extend(finished);
    }
    let largest = best(&fitted);
    settle_edges(&mut fitted, largest, by);
    for where_else in [beside_the_likeliest, otherwise_confined] {
        progress.go_on()?;
        let likeliest = likeliest(&fitted).filter(|_| !progress.is_late());
        let Some((likeliest, _)) = likeliest else {
            break;
        };
        let there = where_else(stage, &fitted);
        let least = NEAR_THERE * best(&fitted) - CLOSE;
        let mut there = fitted_there(stage, &there, likeliest, least, by);
        let largest = best(&fitted).max(best(&there));
        settle_edges(&mut there, largest, by);
        if !progress.is_late() {
            join(&mut fitted, there);
        }
    }
    if unfinished.is_empty() {
        contend(&mut fitted, by);
    }
    let largest = best(&fitted);
    let unfinished = unfinished.into_iter();
    fitted.extend(unfinished.map(|named| named.behind(largest)));
    Ok(fitted)
}

/// The first steps on a long recording: what acts throughout takes them on a part, and on all of it where it
/// keeps its promise; what acts at some time or place only takes all, where it may come near.
fn scouted<'a>(
    given: &Given<'a>,
    stage: &Stage<'a>,
    scouts: &Scouts<'a>,
    by: &Weighing,
) -> Vec<Sketch<'a>> {
    let Stage {
        tuned, proposals, ..
    } = stage;
    let begins = || !given.deadline.is_over();
    let (throughout, local): (Vec<_>, Vec<_>) = proposals.iter().partition(|p| p.extent.is_none());
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
mod tests {
    use super::*;

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
