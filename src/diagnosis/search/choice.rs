//! The choice of the next effect.

use super::accepted::{NOTHING, TAKE};
use super::naming::FittedCandidate;
use super::proposal::ProposalKind;
use super::stage::Stage;
use super::trial::GOOD_PART;

/// The preference among several acceptable candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prefer {
    /// The likeliest.
    Nothing,
    /// Effects of the catalogue first: a residual model may be two effects at once.
    Names,
}

/// Held-out gain, with the standard error: each under its own noise, if it was ranked so. Under the common noise a fit may
/// be in a local optimum. That of a local effect is under the common noise: without its region it is unknown, and under
/// the small noise that it leaves its absence would count as a gross error.
pub fn held_out_gain(candidate: &FittedCandidate, stage: &Stage) -> Option<(f64, f64)> {
    if let Some(own) = &candidate.own
        && candidate.proposal.kind() != ProposalKind::Local
    {
        return own.held_out;
    }
    let pair = candidate.scores.as_ref().zip(stage.scores.as_ref());
    pair.map(|(with, without)| with.gain_over(without))
}

/// Log odds; a candidate that predicts held-out data worse is no likelier than "nothing".
pub fn sound_odds(candidate: &FittedCandidate, stage: &Stage) -> f64 {
    let sound = held_out_gain(candidate, stage).is_none_or(|(mean, error)| mean > -error);
    if sound {
        candidate.odds()
    } else {
        candidate.odds().min(0.0)
    }
}

/// Candidates above the threshold that do not predict worse.
fn worth_it<'n, 'a>(
    fitted: &'n [FittedCandidate<'a>],
    stage: &Stage,
) -> impl Iterator<Item = &'n FittedCandidate<'a>> {
    fitted.iter().filter(move |candidate| {
        let tested = held_out_gain(candidate, stage).is_some();
        tested && sound_odds(candidate, stage) > NOTHING + TAKE
    })
}

/// The next effect. `None` if no candidate is acceptable.
pub fn choose<'n, 'a>(
    fitted: &'n [FittedCandidate<'a>],
    stage: &Stage,
    prefer: Prefer,
) -> Option<&'n FittedCandidate<'a>> {
    let best = |names: bool| {
        worth_it(fitted, stage)
            .filter(|candidate| !names || candidate.proposal.kind() != ProposalKind::ResidualModel)
            .max_by(|a, b| a.odds().total_cmp(&b.odds()))
    };
    let candidate = (prefer == Prefer::Names).then(|| best(true)).flatten();
    candidate.or_else(|| best(false))
}

/// Whether a residual model is likeliest, and an effect explains a good share of the same.
pub fn worth_two_ways(fitted: &[FittedCandidate], stage: &Stage) -> bool {
    let first = |prefer| choose(fitted, stage, prefer);
    let pair = first(Prefer::Nothing).zip(first(Prefer::Names));
    pair.is_some_and(|(best, candidate)| {
        best.proposal.kind() == ProposalKind::ResidualModel
            && candidate.proposal.kind() != ProposalKind::ResidualModel
            && candidate.odds() > GOOD_PART * best.odds()
    })
}
