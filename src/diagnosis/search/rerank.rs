//! Names that are close to each other contend under the noise that each of them leaves.
//!
//! All are fitted under one noise, which holds a part of what is missing wherever the linearised
//! problem does not see all of it: what the right name explains and the others do not is then taken for
//! slow noise, and hardly counts. So noise and weights are estimated anew with each of them inside, each is
//! fitted under everyone's, and the mean of the log evidence over these decides. The winner keeps its
//! gain; the others stand behind it by so much.

use super::naming::FittedCandidate;
use crate::diagnosis::hypothesis::likelihood::{PARTIAL_FIT, continue_fit, own_noise};
use crate::fit::problem::NoiseModel;

/// They are close within so much and this share of the largest log odds ...
const CLOSE: f64 = 4.5;
const CLOSE_SHARE: f64 = 0.045;
/// ... and where so much is at stake that noise may hold a part of it \[log odds\].
pub const AT_STAKE: f64 = 20.0;
/// At most so many contend.
const MOST: usize = 3;

/// Log odds from which on something is close to what has these.
#[must_use]
pub fn close_to(best: f64) -> f64 {
    best - CLOSE - CLOSE_SHARE * best
}

/// Settles which of some fits is the likeliest where several are close.
pub fn rerank(fitted: &mut [FittedCandidate], noise: &NoiseModel) {
    fitted.sort_by(|a, b| b.odds().total_cmp(&a.odds()));
    let Some(best) = fitted.first().map(FittedCandidate::odds) else {
        return;
    };
    if best < AT_STAKE {
        return;
    }
    let near = |candidate: &&FittedCandidate| candidate.odds() > close_to(best);
    let count = fitted.iter().take(MOST).take_while(near).count();
    let close = &mut fitted[..count];
    if count < 2 {
        return;
    }
    let own = |candidate: &FittedCandidate| own_noise(&candidate.problem, &candidate.fit, noise);
    let noises: Vec<NoiseModel> = close.iter().map(own).collect();
    let total = |place: usize| {
        let candidate = &close[place];
        let under = |noise: &NoiseModel| {
            continue_fit(&candidate.problem, &candidate.fit, noise, PARTIAL_FIT)
                .negative_log_evidence
        };
        let sum: f64 = noises.iter().map(under).sum();
        sum / noises.len() as f64 + candidate.proposal.price - candidate.proposal.log_prior()
    };
    let totals: Vec<f64> = (0..count).map(total).collect();
    let places = (0..count).filter(|place| totals[*place].is_finite());
    let Some(winner) = places.min_by(|a, b| totals[*a].total_cmp(&totals[*b])) else {
        return;
    };
    if close[winner].problem.deadline.is_over() {
        // Fits that were ended early do not compare.
        return;
    }
    let odds = close[winner].odds();
    for (place, candidate) in close.iter_mut().enumerate() {
        let behind = totals[place] - totals[winner];
        candidate.gain = odds - behind.min(odds) - candidate.proposal.log_prior();
    }
}
