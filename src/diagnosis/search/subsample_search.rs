//! Fits of proposals on a subsample of a long recording.
//!
//! Effects that act throughout are fitted to some segments first, and only those with good odds there continue on all
//! of them. Local effects are fitted to all segments at once.

use super::initial_guess::LOST;
use super::naming::{PartialFit, first_steps, partial_fit};
use super::proposal::Proposal;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, HELD, PARTIAL_FIT, continue_fit, fit_until,
};
use crate::diagnosis::hypothesis::subsample::Subsample;
use crate::fit::problem::NoiseModel;

/// A subsample, and the hypothesis fitted to it.
pub struct SubsampleSearch<'a> {
    part: Subsample,
    problem: Problem<'a>,
    before: FittedHypothesis,
    noise: NoiseModel,
}

impl<'a> SubsampleSearch<'a> {
    /// `None` for a short recording.
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

    /// As [`partial_fit`], with the gain scaled to all segments.
    #[must_use]
    pub fn partial_fit(&self, proposal: &Proposal, min_odds: f64) -> Option<PartialFit<'a>> {
        let share = 1.0 / self.part.ratio();
        let (problem, before, noise) = (&self.problem, &self.before, &self.noise);
        let partial_fit = partial_fit(problem, proposal, before, noise, share, share * min_odds)?;
        Some(self.scaled(partial_fit))
    }

    /// Continues on the subsample.
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

    /// Continues on all segments; from a new initial guess if the model cannot follow, or the fit has failed. `None`
    /// if that fails as well.
    #[must_use]
    pub fn widened(
        &self,
        subsampled: &PartialFit<'a>,
        problem: &Problem<'a>,
        before: &FittedHypothesis,
        noise: &NoiseModel,
        min_odds: f64,
    ) -> Option<PartialFit<'a>> {
        let PartialFit { proposal, fit, .. } = subsampled;
        // Other coefficients may be undetermined on the subsample.
        let (fitted, own) = (&fit.solution, &proposal.coefficients);
        let initial = self.part.widened(fitted, own, &before.solution);
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
            None => partial_fit(problem, proposal, before, noise, 1.0, min_odds),
        }
    }
}
