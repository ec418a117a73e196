//! What can be left out again.

use super::proposal::{Kind, Proposal};
use super::stage::Stage;
use super::trial::CLOSE;
use super::{Member, NOTHING};
use crate::diagnosis::hypothesis::likelihood::{Tuned, scattered, tune};
use crate::diagnosis::hypothesis::{Given, What};
use crate::diagnosis::screening::screen::Projection;
use crate::fit::predictor::PredictionError;
use crate::fit::problem::Weighing;

/// What would cost so many times its price by the linearised problem stays without a further look.
const SURELY: f64 = 3.0;
/// A term of a law stays that is so many standard errors from none.
const SURE_TERM: f64 = 2.0;

/// Leaves out what the rest explains without it, or what gained by leading to a better soil, and puts what remains in
/// the order of what it explains beside the rest. All recordings are so many times what the stage was fitted to. Where time
/// is up, what was not yet looked at stays.
pub fn prune(stage: &mut Stage, members: &mut Vec<Member>, by: &Weighing, ratio: f64) {
    if stage.given.deadline.is_over() {
        return;
    }
    let mut index = 0;
    while index < members.len() {
        let gone = &members[index].proposal;
        let price = NOTHING - gone.log_prior() + gone.price;
        let loss = linear_loss(stage, &gone.knobs);
        if loss > SURELY * price + CLOSE {
            if members.len() > 1 {
                // What was found since may explain most of what it was taken for.
                let gain = ratio * loss - gone.price;
                members[index].gain = members[index].gain.min(gain);
            }
            index += 1;
            continue;
        }
        let (given, without) = without(stage, gone, by);
        if given.deadline.is_over() {
            // A fit that was ended early understates what the rest explains.
            break;
        }
        match without {
            Ok(without) if without.surprise - stage.tuned.surprise < price => {
                members.remove(index);
                stage.given = given;
                stage.tuned = without;
                index = 0;
            }
            Ok(without) => {
                let lost = without.surprise - stage.tuned.surprise;
                members[index].gain = ratio * lost - gone.price;
                index += 1;
            }
            Err(_) => index += 1,
        }
    }
    // A part tells less of how sure they are.
    if ratio == 1.0 {
        trim_laws(stage, members, by);
    }
    members.sort_by(|a, b| b.gain.total_cmp(&a.gain));
}

/// Takes terms out of laws that are less than so many standard errors from none. The likelihood takes segments for
/// independent; what pulls some of them one way and others the other is worth less than it says.
fn trim_laws(stage: &mut Stage, members: &mut Vec<Member>, by: &Weighing) {
    let mut index = 0;
    while index < members.len() {
        let law = &members[index].proposal;
        let doubtful = doubtful_term(&stage.given, &stage.tuned, law, by);
        let Some(place) = doubtful else {
            index += 1;
            continue;
        };
        let term = Proposal {
            knobs: vec![law.knobs[place]],
            ..law.clone()
        };
        let (given, Ok(without)) = without(stage, &term, by) else {
            index += 1;
            continue;
        };
        if given.deadline.is_over() {
            break;
        }
        let lost = without.surprise - stage.tuned.surprise;
        // So it is where the way without it gets lost.
        if lost.is_nan() || lost >= SURELY * (NOTHING - term.log_prior()) {
            index += 1;
            continue;
        }
        let member = &mut members[index];
        member.lose(lost + term.log_prior());
        member.gain -= lost;
        member.proposal.without_term(place);
        if member.proposal.knobs.is_empty() {
            members.remove(index);
        }
        stage.given = given;
        stage.tuned = without;
    }
}

/// Place of a law's term that is least sure, if it is not sure.
fn doubtful_term(given: &Given, tuned: &Tuned, law: &Proposal, by: &Weighing) -> Option<usize> {
    if law.kind() != Kind::Law {
        return None;
    }
    let covariance = scattered(given, tuned, by);
    let predictor = given.predictor(&tuned.knobs);
    let problem = given.problem(&predictor, &tuned.knobs);
    let mut sure = vec![0.0_f64; law.knobs.len()];
    given.visit(&problem, &tuned.knobs, |unknown, recording, what| {
        let What::Knob(knob) = what else { return };
        let Some(place) = law.knobs.iter().position(|other| *other == knob) else {
            return;
        };
        let off = given.candidates.knobs[knob].parameter.prior_coordinate();
        let size = (tuned.solution.knobs[recording][knob] - off).abs();
        let errors = size / covariance[(unknown, unknown)].max(0.0).sqrt();
        sure[place] = sure[place].max(errors);
    });
    let least = (0..sure.len()).min_by(|a, b| sure[*a].total_cmp(&sure[*b]))?;
    (sure[least] < SURE_TERM).then_some(least)
}

/// The hypothesis without something that was found, and the given model without its place.
pub fn without<'a>(
    stage: &Stage<'a>,
    gone: &Proposal,
    by: &Weighing,
) -> (Given<'a>, Result<Tuned, PredictionError>) {
    let knobs = stage.tuned.knobs.iter().copied();
    let knobs: Vec<usize> = knobs.filter(|k| !gone.knobs.contains(k)).collect();
    let mut given = stage.given.clone();
    if gone.kind() == Kind::Local {
        given.nominal.effects.window = None;
    }
    let mut begin = stage.tuned.solution.clone();
    for recording in &mut begin.knobs {
        for knob in &gone.knobs {
            recording[*knob] = given.candidates.knobs[*knob].parameter.prior_coordinate();
        }
    }
    let tuned = tune(&given, &knobs, &begin, by);
    (given, tuned)
}

/// What switching some knobs off costs of the log likelihood by the linearised problem.
fn linear_loss(stage: &Stage, knobs: &[usize]) -> f64 {
    let system = &stage.looked.system;
    let others: Vec<usize> = stage
        .tuned
        .knobs
        .iter()
        .filter(|knob| !knobs.contains(knob))
        .flat_map(|knob| system.unknowns(*knob))
        .collect();
    let Some(projection) = Projection::over_all(system, &others) else {
        return 0.0;
    };
    // Along a line a product of a size and a shape would be taken away twice.
    let all = &stage.given.candidates.knobs;
    let sizes = knobs.iter().copied().filter(|knob| !all[*knob].is_shape());
    let sizes: Vec<usize> = sizes.collect();
    let unknowns: Vec<usize> = sizes.iter().flat_map(|k| system.unknowns(*k)).collect();
    let step = system.step(&unknowns, &sizes, |knob, recording| {
        let off = stage.given.candidates.knobs[knob]
            .parameter
            .prior_coordinate();
        stage.tuned.solution.knobs[recording][knob] - off
    });
    let matrix = projection.of(&unknowns).matrix;
    0.5 * step.dot(&(matrix * &step))
}

#[cfg(test)]
mod tests {
    use super::super::stage::tests::retuned;
    use super::*;
    use crate::diagnosis::Subject;
    use crate::diagnosis::hypothesis::candidate::Knob;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::effects::{CATALOGUE, ParameterName};
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};
    use nalgebra::DVector;

    /// What stays of a finding of these numbers and so much gain on a drive of this model, and the numbers that are on.
    fn left(truth: &Specification, names: &[&str], gain: f64) -> (Vec<Member>, Vec<String>) {
        let nominal =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("sandy_loam").unwrap());
        let recordings = [driven(truth, "spiral")];
        let (mut stage, by) = retuned(&nominal, &recordings);
        let all = stage.given.candidates.knobs.clone();
        let whole = |knob: &Knob| format!("{}.{}", CATALOGUE[knob.effect].name, knob.name);
        let named = |name: &&str| all.iter().position(|knob| whole(knob) == *name).unwrap();
        let knobs: Vec<usize> = names.iter().map(named).collect();
        let law = names[0].starts_with("residual_");
        let subject = if law {
            Subject::Unknown
        } else {
            Subject::Effect(all[knobs[0]].effect)
        };
        stage.tuned = tune(&stage.given, &knobs, &stage.tuned.solution, &by).unwrap();
        let proposal = Proposal {
            subject,
            stability: vec![1.0; if law { knobs.len() } else { 0 }],
            knobs,
            extent: None,
            steps: Vec::new(),
            evidence: gain,
            price: 0.0,
            soil: DVector::zeros(0),
            hidden: false,
            anew: false,
        };
        let rivals = vec![(subject, gain)];
        let mut members = vec![Member {
            proposal,
            gain,
            rivals,
        }];
        prune(&mut stage, &mut members, &by, 1.0);
        let on = stage.tuned.knobs.iter().map(|knob| whole(&all[*knob]));
        (members, on.collect())
    }

    #[test]
    fn what_gained_by_another_soil_alone_is_left_out() {
        let plain =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("sandy_loam").unwrap());
        let ratio = "left_right_soil.ratio";
        let (members, knobs) = left(&plain, &[ratio], 26.0);
        assert!(members.is_empty() && knobs.is_empty());
        let mut truth = plain;
        let name = ParameterName::find(ratio).unwrap();
        truth.effects.set(name, 0.6).unwrap();
        let gain = 1e6;
        let (members, knobs) = left(&truth, &[ratio], gain);
        assert!(members.len() == 1 && !knobs.is_empty());
        // Nothing was found since that may explain a part of it.
        assert_eq!(members[0].gain, gain);
    }

    #[test]
    fn terms_of_a_law_that_are_not_sure_are_left_out() {
        let mut truth =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("sandy_loam").unwrap());
        let terms = [
            "residual_longitudinal.constant",
            "residual_yaw.speed_squared",
        ];
        let pull = ParameterName::find(terms[0]).unwrap();
        truth.effects.set(pull, 0.03).unwrap();
        let (members, knobs) = left(&truth, &terms, 1e6);
        assert_eq!(knobs, terms[..1]);
        assert_eq!(members[0].proposal.knobs.len(), 1);
        assert_eq!(members[0].proposal.stability.len(), 1);
        assert!(members[0].gain > 20.0);
    }
}
