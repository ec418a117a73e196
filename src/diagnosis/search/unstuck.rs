//! A hypothesis that is stuck in a local optimum shows where a candidate's fit leaves it.

use super::naming::FittedCandidate;
use super::own_noise::under_own_noise;
use super::stage::Stage;
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, LONG_PARTIAL_FIT, fit_until};
use crate::fit::problem::NoiseModel;

/// The fit is repeated if that gains this much \[log odds\], and at most this often.
const STUCK: f64 = 5.0;
pub const AGAIN: usize = 2;

/// The hypothesis refitted from where the likeliest candidate's fit ended, without the candidate: its fit may be in a
/// local optimum, and to leave that is not the candidate's merit. `None` if it is no better, also under its own noise if
/// the candidate was ranked so: under the common noise a misfit of thousands of units differs by thousands between two
/// optima that are alike under theirs.
#[must_use]
pub fn unstuck(
    stage: &Stage,
    fitted: &[FittedCandidate],
    noise: &NoiseModel,
) -> Option<FittedHypothesis> {
    let best = fitted.iter().max_by(|a, b| a.odds().total_cmp(&b.odds()))?;
    if best.odds() < STUCK {
        return None;
    }
    let mut initial = best.fit.solution.clone();
    initial.take(&best.proposal.coefficients, &stage.fit.solution);
    let coefficients = &stage.fit.coefficients;
    let again = fit_until(
        &stage.problem,
        coefficients,
        &initial,
        noise,
        LONG_PARTIAL_FIT,
    )
    .ok()?;
    if again.negative_log_evidence > stage.fit.negative_log_evidence - STUCK {
        return None;
    }
    let own = |fit| {
        under_own_noise(&stage.problem, fit, noise)
            .evidence
            .negative_log
    };
    let better = best.own.is_none() || own(&again) < own(&stage.fit) - STUCK;
    better.then_some(again)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::testing::{driven, on, refitted};
    use crate::fit::optimiser::Stop;

    #[test]
    fn re_tuning_begins_again_where_another_way_led_further() {
        let recordings = [driven(&on("sandy_loam"), "spiral")];
        let nominal = on("dry_sand");
        let (mut stage, noise) = refitted(&nominal, &recordings);
        let problem = stage.problem.clone();
        let proposal = stage.proposals.first().cloned().unwrap();
        let gain = 10.0 * STUCK;
        let beside = FittedCandidate {
            problem: problem.clone(),
            fit: stage.fit.clone(),
            scores: None,
            proposal,
            gain,
            shape: 0.0,
            mends: false,
            ranked: None,
            own: None,
        };
        // Already optimal: no reason to repeat.
        assert!(unstuck(&stage, std::slice::from_ref(&beside), &noise).is_none());
        // Not moved from the initial guess.
        let still = Stop::after(0, 0.0);
        stage.fit = fit_until(&problem, &[], &problem.initial(), &noise, still).unwrap();
        assert!(stage.fit.negative_log_evidence > beside.fit.negative_log_evidence + STUCK);
        let found = unstuck(&stage, std::slice::from_ref(&beside), &noise).unwrap();
        assert!((found.negative_log_evidence - beside.fit.negative_log_evidence).abs() < 1.0);
        // Under its own noise the hypothesis gets there by itself.
        let ranked = FittedCandidate {
            own: Some(under_own_noise(&problem, &beside.fit, &noise)),
            ..beside.clone()
        };
        assert!(unstuck(&stage, &[ranked], &noise).is_none());
        // A candidate without gain is no better way.
        assert!(
            unstuck(
                &stage,
                &[FittedCandidate {
                    gain: 0.0,
                    ..beside
                }],
                &noise
            )
            .is_none()
        );
    }
}
