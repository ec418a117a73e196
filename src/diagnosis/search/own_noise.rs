//! Fits under the noise that they leave.
//!
//! The noise that all candidates are fitted under contains a part of the missing effect, or is too small for the model
//! without it. Under its own noise a fit shows what it is worth by itself.

use super::accepted::CATALOGUED;
use super::proposal::{Proposal, ProposalKind};
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, OwnEvidence, evidence_under_own_noise, fit_with_noise, own_noise,
};
use crate::diagnosis::screening::shape::{mixed, sample_columns};
use crate::fit::problem::NoiseModel;

/// A fit under the noise that it leaves.
#[derive(Debug, Clone)]
pub struct OwnNoise {
    /// Negative log evidence by the catalogue's formulas.
    pub exact: f64,
    /// Evidence by the catalogue's formulas or by neighbours of them.
    pub evidence: OwnEvidence,
    /// The fit.
    pub fit: FittedHypothesis,
    /// Noise and weights.
    pub noise: NoiseModel,
    /// Held-out gain over the hypothesis without the candidate, each under its own noise, with the standard error.
    pub held_out: Option<(f64, f64)>,
}

impl OwnNoise {
    /// Log evidence of a proposal with its prior. A residual model may be what mends formulas, so it does without their
    /// shapes, and pays for naming no mechanism.
    #[must_use]
    pub fn worth(&self, proposal: &Proposal) -> f64 {
        let (catalogued, evidence) = match proposal.kind() {
            ProposalKind::ResidualModel => (CATALOGUED, self.exact),
            _ => (0.0, self.evidence.negative_log),
        };
        proposal.log_prior() - proposal.price - catalogued - evidence
    }

    /// Standard error of the difference of two log likelihoods, from its scatter between blocks of time (Q. Vuong,
    /// "Likelihood ratio tests for model selection and non-nested hypotheses", Econometrica 57 (1989)): around zero, as an
    /// effect may act in few blocks only. `None` where numbers were not finite.
    #[must_use]
    pub fn scatter(&self, other: &Self) -> Option<f64> {
        let (own, other) = (&self.evidence.blocks, &other.evidence.blocks);
        let squares = own.iter().zip(other).map(|(a, b)| (a - b).powi(2));
        let scatter = squares.sum::<f64>().sqrt();
        (!own.is_empty() && own.len() == other.len() && scatter.is_finite()).then_some(scatter)
    }
}

/// Continues a fit under the noise that it leaves, beginning with this.
#[must_use]
pub fn under_own_noise(problem: &Problem, fit: &FittedHypothesis, noise: &NoiseModel) -> OwnNoise {
    let mut own = own_noise(problem, fit, noise);
    let again = fit_with_noise(problem, &fit.coefficients, &fit.solution, &mut own);
    let again = again.unwrap_or_else(|_| fit.clone());
    let mut evidence = evidence_under_own_noise(problem, &again, None, &own);
    let exact = evidence.negative_log;
    if let Some(shapes) = sample_columns(problem, &again.coefficients, &again.solution) {
        let shaped = evidence_under_own_noise(problem, &again, Some(&shapes), noise);
        let negative_log = exact - mixed(exact - shaped.negative_log);
        if shaped.negative_log < exact {
            evidence = shaped;
        }
        evidence.negative_log = negative_log;
    }
    OwnNoise {
        exact,
        evidence,
        fit: again,
        noise: own,
        held_out: None,
    }
}
