//! Most of the way of fits on a part of a long recording.
//!
//! What acts throughout is fitted to some segments first, and only what keeps its promise there goes on with
//! all of them. What acts at some time or place only is fitted to all at once.

use super::initial_guess::LOST;
use super::naming::{PartialFit, first_steps, partial_fit};
use super::proposal::Proposal;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, HELD, PARTIAL_FIT, continue_fit, fit_until,
};
use crate::diagnosis::hypothesis::subsample::Subsample;
use crate::fit::problem::NoiseModel;

/// Some segments, and the hypothesis fitted to them.
pub struct SubsampleSearch<'a> {
    part: Subsample,
    problem: Problem<'a>,
    before: FittedHypothesis,
    noise: NoiseModel,
}

impl<'a> SubsampleSearch<'a> {
    /// `None` where there are not many.
    #[must_use]
    pub fn new(
        problem: &Problem<'a>,
        before: &FittedHypothesis,
        noise: &NoiseModel,
    ) -> Option<Self> {
        let part = Subsample::of(problem)?;
        let (problem, noise) = (part.problem(problem), part.noise_model(noise));
        let initial = part.solution(&before.solution);
        Some(Self {
            before: fit_until(
                &problem,
                &before.coefficients,
                &initial,
                &noise,
                PARTIAL_FIT,
            )
            .ok()?,
            part,
            problem,
            noise,
        })
    }

    /// As [`partial_fit`], what is gained told as if it were of all segments.
    #[must_use]
    pub fn partial_fit(&self, proposal: &Proposal, least: f64) -> Option<PartialFit<'a>> {
        let share = 1.0 / self.part.ratio();
        let (problem, before, noise) = (&self.problem, &self.before, &self.noise);
        let partial_fit = partial_fit(problem, proposal, before, noise, share, share * least)?;
        Some(self.scaled(partial_fit))
    }

    /// Goes on with the part.
    #[must_use]
    pub fn further(&self, partial_fit: &PartialFit<'a>) -> PartialFit<'a> {
        let fit = continue_fit(&partial_fit.problem, &partial_fit.fit, &self.noise, HELD);
        let further = PartialFit::new(
            &partial_fit.proposal,
            &partial_fit.problem,
            fit,
            &self.before,
        );
        self.scaled(further)
    }

    fn scaled(&self, mut partial_fit: PartialFit<'a>) -> PartialFit<'a> {
        let ratio = self.part.ratio();
        // Priors and determinants hardly grow with the data.
        partial_fit.gain += (ratio - 1.0) * (self.before.misfit - partial_fit.fit.misfit);
        partial_fit.fit.predicted_reduction *= ratio;
        partial_fit.scale = ratio;
        partial_fit
    }

    /// Goes on with all segments; from the beginning where they cannot be driven as it stands, or the way is
    /// lost. `None` where that cannot be driven either.
    #[must_use]
    pub fn widened(
        &self,
        subsampled: &PartialFit<'a>,
        problem: &Problem<'a>,
        before: &FittedHypothesis,
        noise: &NoiseModel,
        least: f64,
    ) -> Option<PartialFit<'a>> {
        let PartialFit { proposal, fit, .. } = subsampled;
        // What else is on may not show on the part.
        let (told, own) = (&fit.solution, &proposal.coefficients);
        let initial = self.part.widened(told, own, &before.solution);
        let widened = fit_until(
            problem,
            &fit.coefficients,
            &initial,
            noise,
            first_steps(proposal),
        )
        .ok();
        let kept =
            widened.filter(|fit| fit.negative_log_evidence <= before.negative_log_evidence + LOST);
        match kept {
            Some(fit) => Some(PartialFit::new(proposal, problem, fit, before)),
            None => partial_fit(problem, proposal, before, noise, 1.0, least),
        }
    }
}
