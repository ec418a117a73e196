//! Most of the way of fits on a part of a long recording.
//!
//! What acts throughout is fitted to some stretches first, and only what keeps its promise there goes on with
//! all of them. What acts at some time or place only is fitted to all at once.

use super::begins::LOST;
use super::naming::{Sketch, first_steps, sketch};
use super::proposal::Proposal;
use crate::diagnosis::hypothesis::Given;
use crate::diagnosis::hypothesis::likelihood::{HELD, SKETCH, Tuned, tune_on, tune_until};
use crate::diagnosis::hypothesis::part::Part;
use crate::fit::problem::Weighing;

/// Some stretches, and the hypothesis fitted to them.
pub struct Scouts<'a> {
    part: Part,
    given: Given<'a>,
    before: Tuned,
    by: Weighing,
}

impl<'a> Scouts<'a> {
    /// `None` where there are not many.
    #[must_use]
    pub fn new(given: &Given<'a>, before: &Tuned, by: &Weighing) -> Option<Self> {
        let part = Part::of(given)?;
        let (given, by) = (part.given(given), part.weighing(by));
        let begin = part.solution(&before.solution);
        Some(Self {
            before: tune_until(&given, &before.knobs, &begin, &by, SKETCH).ok()?,
            part,
            given,
            by,
        })
    }

    /// As [`sketch`], what is gained told as if it were of all stretches.
    #[must_use]
    pub fn sketch(&self, proposal: &Proposal, least: f64) -> Option<Sketch<'a>> {
        let share = 1.0 / self.part.ratio();
        let (given, before, by) = (&self.given, &self.before, &self.by);
        let sketch = sketch(given, proposal, before, by, share, share * least)?;
        Some(self.scaled(sketch))
    }

    /// Goes on with the part.
    #[must_use]
    pub fn further(&self, sketch: &Sketch<'a>) -> Sketch<'a> {
        let tuned = tune_on(&sketch.given, &sketch.tuned, &self.by, HELD);
        let further = Sketch::new(&sketch.proposal, &sketch.given, tuned, &self.before);
        self.scaled(further)
    }

    fn scaled(&self, mut sketch: Sketch<'a>) -> Sketch<'a> {
        let ratio = self.part.ratio();
        // Priors and determinants hardly grow with the data.
        sketch.gain += (ratio - 1.0) * (self.before.misfit - sketch.tuned.misfit);
        sketch.tuned.promised *= ratio;
        sketch.scale = ratio;
        sketch
    }

    /// Goes on with all stretches; from the beginning where they cannot be driven as it stands, or the way is
    /// lost. `None` where that cannot be driven either.
    #[must_use]
    pub fn widened(
        &self,
        scouted: &Sketch<'a>,
        given: &Given<'a>,
        before: &Tuned,
        by: &Weighing,
        least: f64,
    ) -> Option<Sketch<'a>> {
        let Sketch {
            proposal, tuned, ..
        } = scouted;
        // What else is on may not show on the part.
        let (told, own) = (&tuned.solution, &proposal.knobs);
        let begin = self.part.widened(told, own, &before.solution);
        let widened = tune_until(given, &tuned.knobs, &begin, by, first_steps(proposal)).ok();
        let kept = widened.filter(|tuned| tuned.surprise <= before.surprise + LOST);
        match kept {
            Some(tuned) => Some(Sketch::new(proposal, given, tuned, before)),
            None => sketch(given, proposal, before, by, 1.0, least),
        }
    }
}
