//! Close candidates are ranked under the noise of each of them.
//!
//! All are fitted under one noise, which contains a part of the missing effect where the linearised problem does not
//! capture it: what only the right candidate explains then passes for slow noise and hardly counts. So noise and
//! weights are re-estimated with each candidate on, each candidate is fitted under every noise, and the mean log
//! evidence decides. The winner keeps its gain; the others follow at their distance.

use super::naming::FittedCandidate;
use crate::diagnosis::hypothesis::likelihood::{
    FittedHypothesis, PARTIAL_FIT, continue_fit, fit_with_noise, own_noise,
};
use crate::fit::problem::NoiseModel;

/// Close candidates are compared if the log odds are large enough for noise to contain a part.
pub const AT_STAKE: f64 = 20.0;
/// Candidates are close within this difference and share of the largest log odds: under the noise of the model without
/// them, a tow was 11 behind a wedge of 63, under the noise of each 2.
const CLOSE: f64 = 15.0;
const CLOSE_SHARE: f64 = 0.1;
/// Maximum share of the shape freedom in the log odds of a compared candidate. Its fit is without shapes, so what these
/// explain is noise to it, and under that noise nothing is far apart: the fit of a wedge in place of a drag left 2,565
/// of 2,994 to the shapes, and the drag lost 1,200 of 3,044 under its noise.
const MAX_SHAPE: f64 = 0.25;
/// Maximum number of compared candidates.
const MAX_COMPARED: usize = 3;

/// Ranks close candidates.
pub fn rerank(fitted: &mut [FittedCandidate], noise: &NoiseModel) {
    fitted.sort_by(|a, b| b.odds().total_cmp(&a.odds()));
    let best = fitted.first().map_or(0.0, FittedCandidate::odds);
    if best < AT_STAKE {
        return;
    }
    let near = |candidate: &FittedCandidate| {
        let odds = candidate.odds();
        odds > best - CLOSE - CLOSE_SHARE * best && candidate.shape < MAX_SHAPE * odds
    };
    let mut subjects = Vec::new();
    let mut close: Vec<&mut FittedCandidate> = Vec::new();
    for candidate in fitted.iter_mut() {
        // The same subject in another region is no rival.
        if near(candidate) && !subjects.contains(&candidate.proposal.subject) {
            subjects.push(candidate.proposal.subject);
            close.push(candidate);
        }
    }
    close.truncate(MAX_COMPARED);
    let count = close.len();
    if count < 2 {
        return;
    }
    // Noise and weights are re-estimated for each: those of the model without it absorb a part of its signal.
    let each: Vec<(FittedHypothesis, NoiseModel)> = close
        .iter()
        .map(|candidate| {
            let FittedCandidate { problem, fit, .. } = candidate;
            let mut own = own_noise(problem, fit, noise);
            let coefficients = &fit.coefficients;
            let again = fit_with_noise(problem, coefficients, &fit.solution, &mut own);
            (again.unwrap_or_else(|_| fit.clone()), own)
        })
        .collect();
    let total = |place: usize| {
        let candidate: &FittedCandidate = close[place];
        let under = |noise: &NoiseModel| {
            continue_fit(&candidate.problem, &each[place].0, noise, PARTIAL_FIT)
                .negative_log_evidence
        };
        let sum: f64 = each.iter().map(|(_, noise)| under(noise)).sum();
        sum / each.len() as f64 + candidate.proposal.price
            - candidate.proposal.log_prior()
            - candidate.shape
    };
    let totals: Vec<f64> = (0..count).map(total).collect();
    let places = (0..count).filter(|place| totals[*place].is_finite());
    let Some(winner) = places.min_by(|a, b| totals[*a].total_cmp(&totals[*b])) else {
        return;
    };
    if close[winner].problem.deadline.is_over() {
        // Fits that were cut short do not compare.
        return;
    }
    let odds = close[winner].odds();
    for (place, candidate) in close.iter_mut().enumerate() {
        let behind = totals[place] - totals[winner];
        candidate.gain = odds - behind.min(odds) - candidate.shape - candidate.proposal.log_prior();
    }
}
