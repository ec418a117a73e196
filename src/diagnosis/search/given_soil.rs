//! Screening from the given soil, if the refitted one is far from it.
//!
//! Soil imitates a missing effect as far as it can, down to sand without friction. The linearised problem there
//! describes another vehicle on another soil: the right effect may be absent from the proposals or misplaced, without
//! a way back. So everything is screened once more from the given soil.

use super::initial_guess::on_given_soil;
use super::proposal::{Proposal, ProposalKind, proposals, screened, shortlist};
use super::view::View;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::FittedHypothesis;
use crate::diagnosis::screening::sensitivity::{Layout, sensitivities};
use crate::diagnosis::screening::shape::Shapes;
use crate::diagnosis::screening::system::linearise;
use crate::fit::problem::NoiseModel;

/// Distance of a soil parameter, in standard deviations of its prior, that counts as far.
const FAR: f64 = 1.5;
/// Maximum number of additional proposals that act throughout, and in a region.
const THROUGHOUT: usize = 3;
const LOCAL: usize = 3;

/// Proposals from the given soil, if the refitted one is far from it.
#[must_use]
pub fn seen_from_given_soil(
    problem: &Problem,
    fit: &FittedHypothesis,
    noise: &NoiseModel,
    known: &[Proposal],
    seed: u64,
) -> Vec<Proposal> {
    let at = on_given_soil(problem, fit);
    if !is_far(problem, &at.soil, &fit.solution.soil) {
        return Vec::new();
    }
    let on = &fit.coefficients;
    let layout = Layout::new(problem, on);
    let tables = sensitivities(problem, &layout, &at);
    let system = linearise(problem, &layout, &tables, &at, noise);
    drop(tables);
    let Some(view) = View::new(problem, &system, on, &Shapes::default(), noise) else {
        return Vec::new();
    };
    let screened = screened(&view);
    let all = proposals(&view, &screened, &at.soil, seed);
    let is_known = |one: &Proposal| {
        let same = |other: &Proposal| (one.subject, one.kind()) == (other.subject, other.kind());
        one.kind() == ProposalKind::Throughout && known.iter().any(same)
    };
    let list: Vec<&Proposal> = shortlist(&all);
    let of_kind = |kind, count| {
        let those = list.iter().filter(move |one| one.kind() == kind);
        those.filter(|one| !is_known(one)).take(count)
    };
    of_kind(ProposalKind::Throughout, THROUGHOUT)
        .chain(of_kind(ProposalKind::Local, LOCAL))
        .map(|one| Proposal {
            anew: true,
            ..(*one).clone()
        })
        .collect()
}

/// Whether a soil parameter is far from another solution.
fn is_far(problem: &Problem, from: &[f64], to: &[f64]) -> bool {
    let parameters = problem.soil_parameters();
    let mut pairs = from.iter().zip(to).zip(&parameters);
    pairs.any(|((a, b), parameter)| (a - b).abs() > FAR * parameter.prior.deviation)
}

#[cfg(test)]
mod tests {
    use super::super::naming::{ANY, partial_fit};
    use super::*;
    use crate::diagnosis::Options;
    use crate::diagnosis::testing::{driven, on, refitted_with};
    use crate::effects::ParameterName;

    #[test]
    #[ignore = "nightly: fits two recordings from two soils"]
    fn a_name_is_seen_from_the_given_soil_where_re_tuning_has_gone_far() {
        let mut nominal = on("sandy_loam");
        let mut truth = nominal.clone();
        for (name, value) in [("ahead", -0.25), ("left", 0.1)] {
            let parameter = ParameterName::find(&format!("com_shift.{name}")).unwrap();
            truth.effects.set(parameter, value).unwrap();
        }
        nominal.terrain.cohesion *= 1.5;
        nominal.terrain.frictional_modulus /= 1.5;
        let recordings = ["slalom", "spiral"].map(|name| driven(&truth, name));
        // In longer segments the effect also shows from the refitted soil.
        let options = Options {
            segment: 5.0,
            ..Options::default()
        };
        let (stage, noise) = refitted_with(&nominal, &recordings, &options);
        let (problem, fit) = (&stage.problem, &stage.fit);
        let initial = problem.initial();
        assert!(is_far(problem, &initial.soil, &fit.solution.soil));
        assert!(!is_far(problem, &initial.soil, &initial.soil));
        // From the imitating soil the shift does not show fully.
        let shifted = |one: &&Proposal| one.subject.name() == "com_shift";
        let proposal = stage.proposals.iter().find(shifted).unwrap();
        assert!(proposal.anew);
        let found = partial_fit(problem, proposal, fit, &noise, 1.0, ANY).unwrap();
        assert!(found.fit.negative_log_evidence < 0.5 * fit.negative_log_evidence);
    }
}
