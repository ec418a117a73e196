//! What is seen from the soil that was given, where re-tuning has gone far from it.
//!
//! What is missing is imitated by soil as far as that goes, which may be to sand without friction. What the linearised
//! problem shows there is of another vehicle on another soil: the right name may not be among the proposals, its place
//! not where it is, and no way may lead back. So all is looked at once more from the given soil.

use super::begins::begin;
use super::naming::Sketch;
use super::proposal::{Kind, Proposal, proposals, screened, shortlist};
use super::view::View;
use crate::diagnosis::hypothesis::likelihood::{LONG_SKETCH, Tuned, cost, tune_from_afar};
use crate::diagnosis::hypothesis::{Given, Solution};
use crate::diagnosis::screening::sensitivity::{Layout, sensitivities};
use crate::diagnosis::screening::system::linearise;
use crate::fit::problem::Weighing;

/// A soil is far from the given one where one of its numbers is so many standard deviations of its prior away.
const FAR: f64 = 1.5;
/// At most so many that act throughout, and so many that act at some time or place, are proposed besides.
const THROUGHOUT: usize = 3;
const LOCAL: usize = 3;

/// A hypothesis with the given soil in place of its own.
#[must_use]
pub fn on_given_soil(given: &Given, tuned: &Tuned) -> Solution {
    Solution {
        soil: given.begin().soil,
        ..tuned.solution.clone()
    }
}

/// What is seen beside the given soil alone where the re-tuned one is far from it.
#[must_use]
pub fn seen_from_given_soil(
    given: &Given,
    tuned: &Tuned,
    by: &Weighing,
    known: &[Proposal],
    seed: u64,
) -> Vec<Proposal> {
    let at = on_given_soil(given, tuned);
    if !is_far(given, &at.soil, &tuned.solution.soil) {
        return Vec::new();
    }
    let on = &tuned.knobs;
    let layout = Layout::new(given, on);
    let tables = sensitivities(given, &layout, &at);
    let system = linearise(given, &layout, &tables, &at, by);
    drop(tables);
    let Some(view) = View::new(given, &system, on, by) else {
        return Vec::new();
    };
    let screened = screened(&view);
    let all = proposals(&view, &screened, &at.soil, seed);
    let is_known = |one: &Proposal| {
        let same = |other: &Proposal| (one.subject, one.kind()) == (other.subject, other.kind());
        one.kind() == Kind::Throughout && known.iter().any(same)
    };
    let list: Vec<&Proposal> = shortlist(&all);
    let of_kind = |kind, most| {
        let those = list.iter().filter(move |one| one.kind() == kind);
        those.filter(|one| !is_known(one)).take(most)
    };
    of_kind(Kind::Throughout, THROUGHOUT)
        .chain(of_kind(Kind::Local, LOCAL))
        .map(|one| Proposal {
            anew: true,
            ..(*one).clone()
        })
        .collect()
}

/// Begins a fit anew on the given soil where the re-tuned one is far from it. The likelier one stays.
#[must_use]
pub fn from_given_soil<'a>(sketch: Sketch<'a>, before: &Tuned, by: &Weighing) -> Sketch<'a> {
    let (given, fitted) = (&sketch.given, &sketch.tuned);
    let base = on_given_soil(given, before);
    if sketch.proposal.anew || !is_far(given, &base.soil, &before.solution.soil) {
        return sketch;
    }
    let as_seen = begin(given, &sketch.proposal, &before.solution, 1.0);
    let begins = [&before.solution, &as_seen, &fitted.solution].map(|with| {
        let begin = Solution {
            knobs: with.knobs.clone(),
            ..base.clone()
        };
        (cost(given, &fitted.knobs, &begin, by), begin)
    });
    let cheapest = begins.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let again = cheapest
        .and_then(|(_, begin)| tune_from_afar(given, &fitted.knobs, &begin, by, LONG_SKETCH).ok());
    match again.filter(|again| again.surprise < fitted.surprise) {
        Some(again) => Sketch {
            gain: sketch.gain + fitted.surprise - again.surprise,
            tuned: again,
            proposal: Proposal {
                anew: true,
                ..sketch.proposal
            },
            ..sketch
        },
        None => sketch,
    }
}

/// Whether one of the soil's numbers lies far from another.
fn is_far(given: &Given, from: &[f64], to: &[f64]) -> bool {
    let parameters = given.soil_parameters();
    let mut pairs = from.iter().zip(to).zip(&parameters);
    pairs.any(|((a, b), parameter)| (a - b).abs() > FAR * parameter.prior.deviation)
}

#[cfg(test)]
mod tests {
    use super::super::naming::{ANY, sketch};
    use super::super::stage::tests::retuned_with;
    use super::*;
    use crate::diagnosis::Options;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::effects::ParameterName;
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};

    #[test]
    #[ignore = "nightly: fits two recordings from two soils"]
    fn a_name_is_seen_from_the_given_soil_where_re_tuning_has_gone_far() {
        let mut nominal =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("sandy_loam").unwrap());
        let mut truth = nominal.clone();
        for (name, value) in [("ahead", -0.25), ("left", 0.1)] {
            let parameter = ParameterName::find(&format!("com_shift.{name}")).unwrap();
            truth.effects.set(parameter, value).unwrap();
        }
        nominal.terrain.cohesion *= 1.5;
        nominal.terrain.frictional_modulus /= 1.5;
        let recordings = ["slalom", "spiral"].map(|name| driven(&truth, name));
        // In longer stretches it is seen from the re-tuned soil as well.
        let options = Options {
            segment: 5.0,
            ..Options::default()
        };
        let (stage, by) = retuned_with(&nominal, &recordings, &options);
        let (given, tuned) = (&stage.given, &stage.tuned);
        let begin = given.begin();
        assert!(is_far(given, &begin.soil, &tuned.solution.soil));
        assert!(!is_far(given, &begin.soil, &begin.soil));
        // From the soil that imitates it the shift is not seen whole.
        let shifted = |one: &&Proposal| one.subject.name() == "com_shift";
        let proposal = stage.proposals.iter().find(shifted).unwrap();
        assert!(proposal.anew);
        let found = sketch(given, proposal, tuned, &by, 1.0, ANY).unwrap();
        assert!(found.tuned.surprise < 0.5 * tuned.surprise);
        let stuck = Proposal {
            anew: false,
            ..proposal.clone()
        };
        let stuck = sketch(given, &stuck, tuned, &by, 1.0, ANY).unwrap();
        let odds = stuck.odds();
        let again = from_given_soil(stuck, tuned, &by);
        assert!(again.odds() > odds + 100.0, "{} {odds}", again.odds());
    }
}
