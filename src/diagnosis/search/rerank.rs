//! Close candidates are ranked by their evidence under their own noise.
//!
//! All are fitted under one noise, which contains a part of the missing effect where the linearised problem does not
//! capture it: what only the right candidate explains then passes for slow noise and hardly counts. So noise and
//! weights are re-estimated for each candidate, and the restricted likelihoods decide, which a larger noise costs its
//! own share. The formulas' shape freedom (see [`crate::diagnosis::screening::shape`]) is integrated out in them: what
//! another formula explains is no noise. The log odds become the differences to the model without the candidates.

use super::accepted::{CATALOGUED, NOTHING, TAKE};
use super::naming::FittedCandidate;
use super::proposal::ProposalKind;
use super::stage::Stage;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, HELD, continue_fit, evidence_under_own_noise, fit_with_noise, own_noise,
};
use crate::diagnosis::screening::shape::{mixed, sample_columns};
use crate::fit::problem::NoiseModel;

/// Close candidates are compared if the log odds are large enough for noise to contain a part.
pub const AT_STAKE: f64 = 20.0;
/// Candidates are close within this difference and share of the largest log odds: under the noise of the model without
/// them, a tow was 11 behind a wedge of 63, under the noise of each 2.
const CLOSE: f64 = 15.0;
const CLOSE_SHARE: f64 = 0.1;
/// Maximum number of compared candidates.
const MAX_COMPARED: usize = 4;

/// A candidate's fit must improve by this much to be taken, in log evidence.
const BETTER: f64 = 1.0;

/// Ranks close candidates beside a hypothesis. Where a candidate's fit ends elsewhere under its own noise, and is better
/// there under this one too, it is taken: a small noise holds a fit in a local optimum.
pub fn rerank(fitted: &mut [FittedCandidate], stage: &Stage, noise: &NoiseModel) {
    fitted.sort_by(|a, b| b.odds().total_cmp(&a.odds()));
    let best = fitted.first().map_or(0.0, FittedCandidate::odds);
    if best < AT_STAKE {
        return;
    }
    let near = |candidate: &FittedCandidate| candidate.odds() > best - CLOSE - CLOSE_SHARE * best;
    let mut subjects = Vec::new();
    let mut compared = vec![false; fitted.len()];
    for (place, candidate) in fitted.iter().enumerate() {
        // The same subject in another region is no rival.
        let known = subjects.contains(&candidate.proposal.subject);
        if near(candidate) && !known && subjects.len() < MAX_COMPARED {
            subjects.push(candidate.proposal.subject);
            compared[place] = true;
        }
    }
    let without = under_own_noise(&stage.problem, &stage.fit, noise);
    let mut leads = vec![f64::NAN; fitted.len()];
    for place in (0..fitted.len()).filter(|place| compared[*place]) {
        let candidate = &mut fitted[place];
        let proposal = &candidate.proposal;
        let found = under_own_noise(&candidate.problem, &candidate.fit, noise);
        let is_residual_model = proposal.kind() == ProposalKind::ResidualModel;
        let catalogued = if is_residual_model { CATALOGUED } else { 0.0 };
        let beside = proposal.log_prior() - proposal.price - catalogued;
        let lead = without.evidence - found.evidence + beside;
        // A residual model may be what mends the formulas, so it does without their shapes.
        leads[place] = if is_residual_model {
            without.exact - found.exact + beside
        } else {
            lead
        };
        let moved = continue_fit(&candidate.problem, &found.fit, noise, HELD);
        if candidate.fit.negative_log_evidence - moved.negative_log_evidence > BETTER {
            candidate.refit(moved, &stage.fit, noise);
        }
        candidate.mends = is_residual_model && lead < NOTHING + TAKE;
        candidate.own = Some((found.fit, found.noise));
    }
    let leading = leads.iter().copied().filter(|lead| lead.is_finite());
    let Some(leading) = leading.reduce(f64::max) else {
        return;
    };
    if stage.problem.deadline.is_over() {
        // Fits that were cut short do not compare.
        return;
    }
    // Under the common noise, which is small, all odds are larger.
    let scale = (leading / best).clamp(0.0, 1.0);
    for (candidate, lead) in fitted.iter_mut().zip(leads) {
        let odds = if lead.is_nan() {
            (scale * candidate.odds()).min(candidate.odds())
        } else {
            lead
        };
        candidate.gain = odds - candidate.shape - candidate.proposal.log_prior();
    }
}

/// A fit under the noise that it leaves.
#[derive(Debug)]
pub struct OwnNoise {
    /// Negative log evidence by the catalogue's formulas.
    exact: f64,
    /// Negative log evidence by the catalogue's formulas or by neighbours of them.
    pub evidence: f64,
    /// The fit.
    pub fit: FittedHypothesis,
    /// Noise and weights.
    pub noise: NoiseModel,
}

/// Continues a fit under the noise that it leaves, beginning with this.
#[must_use]
pub fn under_own_noise(problem: &Problem, fit: &FittedHypothesis, noise: &NoiseModel) -> OwnNoise {
    let mut own = own_noise(problem, fit, noise);
    let again = fit_with_noise(problem, &fit.coefficients, &fit.solution, &mut own);
    let again = again.unwrap_or_else(|_| fit.clone());
    let exact = evidence_under_own_noise(problem, &again, None, &own);
    let shapes = sample_columns(problem, &again.coefficients, &again.solution);
    let evidence = shapes.map_or(exact, |shapes| {
        let shaped = evidence_under_own_noise(problem, &again, Some(&shapes), noise);
        exact - mixed(exact - shaped)
    });
    OwnNoise {
        exact,
        evidence,
        fit: again,
        noise: own,
    }
}
