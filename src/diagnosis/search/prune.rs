//! What can be left out again.

use super::proposal::{Kind, Proposal};
use super::stage::{CLOSE, Stage};
use super::{Member, NOTHING};
use crate::diagnosis::hypothesis::Given;
use crate::diagnosis::hypothesis::likelihood::{Tuned, tune};
use crate::diagnosis::screening::screen::Projection;
use crate::fit::predictor::PredictionError;
use crate::fit::problem::Weighing;

/// What would cost so many times its price by the linearised problem stays without a further look.
const SURELY: f64 = 3.0;

/// Leaves out what the rest explains without it, or what gained by leading to a better soil, and puts what remains in
/// the order of what it explains beside the rest. All recordings are so many times what the stage was fitted to.
pub fn prune(stage: &mut Stage, members: &mut Vec<Member>, by: &Weighing, ratio: f64) {
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
    members.sort_by(|a, b| b.gain.total_cmp(&a.gain));
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
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::effects::ParameterName;
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};
    use nalgebra::DVector;

    /// Soil that differs left and right as the only finding, said to have gained so much on a drive of this model.
    fn left(truth: &Specification, gain: f64) -> (Vec<Member>, Vec<usize>) {
        let nominal =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("sandy_loam").unwrap());
        let recordings = [driven(truth, "spiral")];
        let (mut stage, by) = retuned(&nominal, &recordings);
        let candidates = &stage.given.candidates;
        let is = |subject: &&crate::diagnosis::Subject| subject.name() == "left_right_soil";
        let subject = *candidates.subjects.iter().find(is).unwrap();
        let knobs: Vec<usize> = candidates.of(subject).collect();
        stage.tuned = tune(&stage.given, &knobs, &stage.tuned.solution, &by).unwrap();
        let proposal = Proposal {
            subject,
            knobs,
            extent: None,
            steps: Vec::new(),
            evidence: gain,
            price: 0.0,
            stability: Vec::new(),
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
        (members, stage.tuned.knobs)
    }

    #[test]
    fn what_gained_by_another_soil_alone_is_left_out() {
        let plain =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("sandy_loam").unwrap());
        let (members, knobs) = left(&plain, 26.0);
        assert!(members.is_empty() && knobs.is_empty());
        let mut truth = plain;
        let ratio = ParameterName::find("left_right_soil.ratio").unwrap();
        truth.effects.set(ratio, 0.6).unwrap();
        let gain = 1e6;
        let (members, knobs) = left(&truth, gain);
        assert!(members.len() == 1 && !knobs.is_empty());
        // Nothing was found since that may explain a part of it.
        assert_eq!(members[0].gain, gain);
    }
}
