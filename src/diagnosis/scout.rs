//! First steps of fits on a part of a long recording.
//!
//! Whether a proposal leads anywhere shows on a part of many minutes of driving as well: what acts
//! throughout is sketched on some stretches, spread evenly, and only what keeps its promise there goes on with
//! all of them. What acts at some time or place only is sketched with all at once.

use super::hypothesis::{Given, Solution};
use super::likelihood::{SKETCH, Tuned, tune_until};
use super::naming::{LOST, Sketch, first_steps, sketch};
use super::proposal::Proposal;
use crate::fit::problem::Weighing;

/// More stretches than this are many, and of those so many are enough.
const MANY: usize = 48;
const ENOUGH: usize = 32;

/// Some stretches, and the hypothesis fitted to them.
pub struct Scouts<'a> {
    places: Vec<usize>,
    given: Given<'a>,
    before: Tuned,
    by: Weighing,
    /// All over some.
    ratio: f64,
}

impl<'a> Scouts<'a> {
    /// `None` where there are not many.
    #[must_use]
    pub fn new(given: &Given<'a>, before: &Tuned, by: &Weighing) -> Option<Self> {
        let count = given.segments.len();
        if count <= MANY {
            return None;
        }
        let places: Vec<usize> = (0..ENOUGH).map(|k| k * count / ENOUGH).collect();
        let segments = places.iter().map(|k| given.segments[*k].clone());
        let given = Given {
            segments: segments.collect(),
            ..given.clone()
        };
        let by = by.of(&places);
        let begin = Solution {
            starts: places.iter().map(|k| before.solution.starts[*k]).collect(),
            ..before.solution.clone()
        };
        Some(Self {
            before: tune_until(&given, &before.knobs, &begin, &by, SKETCH).ok()?,
            ratio: count as f64 / places.len() as f64,
            places,
            given,
            by,
        })
    }

    /// As [`sketch`], what is gained told as if it were of all stretches.
    #[must_use]
    pub fn sketch(&self, proposal: &Proposal) -> Option<Sketch<'a>> {
        let mut sketch = sketch(&self.given, proposal, &self.before, &self.by)?;
        // Priors and determinants hardly grow with the data.
        sketch.gain += (self.ratio - 1.0) * (self.before.misfit - sketch.tuned.misfit);
        sketch.tuned.promised *= self.ratio;
        sketch.scale = self.ratio;
        Some(sketch)
    }

    /// Goes on with all stretches; from the beginning where they cannot be driven as it stands, or the way is
    /// lost.
    #[must_use]
    pub fn widened(
        &self,
        scouted: &Sketch<'a>,
        given: &Given<'a>,
        before: &Tuned,
        by: &Weighing,
    ) -> Option<Sketch<'a>> {
        let Sketch {
            proposal, tuned, ..
        } = scouted;
        // What else is on may not show on the part.
        let mut begin = before.solution.clone();
        begin.soil.clone_from(&tuned.solution.soil);
        begin.take(&proposal.knobs, &tuned.solution);
        for (place, start) in self.places.iter().zip(&tuned.solution.starts) {
            begin.starts[*place] = *start;
        }
        let widened = tune_until(given, &tuned.knobs, &begin, by, first_steps(proposal)).ok();
        let kept = widened.filter(|tuned| tuned.surprise <= before.surprise + LOST);
        match kept {
            Some(tuned) => Some(Sketch::new(proposal, given, tuned, before)),
            None => sketch(given, proposal, before, by),
        }
    }
}
