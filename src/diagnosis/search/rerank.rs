//! Close candidates are ranked by their evidence under their own noise.
//!
//! All are fitted under one noise, which contains a part of the missing effect where the linearised problem does not
//! capture it: what only the right candidate explains then passes for slow noise and hardly counts. So noise and
//! weights are re-estimated for each candidate, and the restricted likelihoods decide, which a larger noise costs its
//! own share. The formulas' shape freedom (see [`crate::diagnosis::screening::shape`]) is integrated out in them: what
//! another formula explains is no noise. The log odds become the differences to the model without the candidates.

use super::accepted::{NOTHING, TAKE};
use super::naming::FittedCandidate;
use super::own_noise::{OwnNoise, under_own_noise};
use super::proposal::ProposalKind;
use super::stage::Stage;
use crate::diagnosis::hypothesis::held_out::scores;
use crate::diagnosis::hypothesis::likelihood::{HELD, continue_fit};
use crate::fit::problem::NoiseModel;

/// Close candidates are compared if the log odds are large enough for noise to contain a part.
pub const AT_STAKE: f64 = 20.0;
/// Candidates are close within this difference and share of the largest log odds: under the noise of the model without
/// them, a tow was 11 behind a wedge of 63, under the noise of each 2.
const CLOSE: f64 = 15.0;
const CLOSE_SHARE: f64 = 0.1;
/// Maximum number of compared candidates.
pub const MAX_COMPARED: usize = 4;

/// A candidate's fit must improve by this much to be taken, in log evidence.
const BETTER: f64 = 1.0;

/// Ranks close candidates beside a hypothesis.
#[derive(Debug)]
pub struct Ranking<'s, 'a> {
    stage: &'s Stage<'a>,
    noise: &'s NoiseModel,
    /// The hypothesis itself.
    without: Option<OwnNoise>,
}

impl<'s, 'a> Ranking<'s, 'a> {
    /// Beside the hypothesis of a stage, under whose noise the candidates were fitted.
    #[must_use]
    pub fn new(stage: &'s Stage<'a>, noise: &'s NoiseModel) -> Self {
        Self {
            stage,
            noise,
            without: None,
        }
    }

    /// Ranks up to so many of the candidates close to the likeliest. Fits that were cut short do not compare: at the
    /// deadline all keep their odds.
    pub fn rank(&mut self, fitted: &mut [FittedCandidate], max_compared: usize) {
        let odds = FittedCandidate::odds_under_common_noise;
        fitted.sort_by(|a, b| odds(b).total_cmp(&odds(a)));
        let best = fitted.first().map_or(0.0, odds);
        if best < AT_STAKE {
            return;
        }
        let near = best - CLOSE - CLOSE_SHARE * best;
        let mut subjects = Vec::new();
        let mut leads = vec![None; fitted.len()];
        for (candidate, lead) in fitted.iter_mut().zip(&mut leads) {
            // The same subject in another region is no rival.
            let known = subjects.contains(&candidate.proposal.subject);
            if odds(candidate) > near && !known && subjects.len() < max_compared {
                subjects.push(candidate.proposal.subject);
                *lead = Some(self.lead(candidate)).filter(|lead| lead.is_finite());
            }
        }
        let Some(leading) = leads.iter().flatten().copied().reduce(f64::max) else {
            return;
        };
        if self.stage.problem.deadline.is_over() {
            return;
        }
        // Under the common noise, which is small, all odds are larger.
        let scale = (leading / best).clamp(0.0, 1.0);
        for (candidate, lead) in fitted.iter_mut().zip(leads) {
            let others = || (scale * odds(candidate)).min(odds(candidate));
            candidate.ranked = Some(lead.unwrap_or_else(others));
        }
    }

    /// A candidate's log odds under its own noise. If its fit ends elsewhere there, and is better under the common noise
    /// too, it is taken: a small noise holds a fit in a local optimum.
    fn lead(&mut self, candidate: &mut FittedCandidate) -> f64 {
        let Self { stage, noise, .. } = self;
        let without = self
            .without
            .get_or_insert_with(|| under_own_noise(&stage.problem, &stage.fit, noise));
        let is_residual_model = candidate.proposal.kind() == ProposalKind::ResidualModel;
        if candidate.own.is_none() {
            let mut own = under_own_noise(&candidate.problem, &candidate.fit, noise);
            let moved = continue_fit(&candidate.problem, &own.fit, noise, HELD);
            if candidate.fit.negative_log_evidence - moved.negative_log_evidence > BETTER {
                candidate.refit(moved, &stage.fit, noise);
            }
            let with = scores(&candidate.problem, &own.fit, &own.noise);
            let without = scores(&stage.problem, &without.fit, &without.noise);
            own.held_out = with
                .zip(without)
                .map(|(with, without)| with.gain_over(&without));
            candidate.own = Some(own);
        }
        let Some(own) = &candidate.own else {
            return f64::NEG_INFINITY;
        };
        let worth = own.worth(&candidate.proposal);
        if is_residual_model {
            let shapes = own.exact - own.evidence.negative_log;
            let lead = without.evidence.negative_log + worth + shapes;
            candidate.mends = lead < NOTHING + TAKE;
            without.exact + worth
        } else {
            candidate.mends = false;
            without.evidence.negative_log + worth
        }
    }
}
