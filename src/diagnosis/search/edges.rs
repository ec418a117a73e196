//! Where and when exactly something acts.
//!
//! The box scan sees places and times through the linearised problem, gate by gate. What acts there hard on and off is felt
//! to a few hundredths of a second, and an edge that is off by a tenth costs all names alike more than what they differ
//! by. So the edges of what came close to the likeliest are moved in the full fit.

use super::contest::{AT_STAKE, close_to};
use super::naming::{Named, placed};
use super::proposal::{Kind, Proposal};
use crate::diagnosis::hypothesis::held_out::scores;
use crate::diagnosis::hypothesis::likelihood::{SKETCH, tune_until};
use crate::diagnosis::screening::locate::Extent;
use crate::fit::problem::Weighing;

/// Edges are moved by this share of the radius or of two seconds at first, and down to that one ...
const FIRST: f64 = 0.1;
const LAST: f64 = 0.015;
const SECONDS: f64 = 2.0;
/// ... while that gains more than so much of the log evidence; a move that gains less than so much is none, for fits end
/// half a unit from where they lead.
const WORTH: f64 = 1.0;
const LEAST: f64 = 0.5;
/// A disc has a place, two numbers, and a radius; an interval two ends.
const EDGES: usize = 3;

/// Moves the edges of what acts at some time or place and came close to the likeliest.
pub fn settle_edges(fitted: &mut [Named], by: &Weighing) {
    let best = fitted.iter().map(Named::odds).fold(0.0, f64::max);
    if best < AT_STAKE {
        return;
    }
    let close =
        |named: &&mut Named| named.proposal.kind() == Kind::Local && named.odds() > close_to(best);
    fitted
        .iter_mut()
        .filter(close)
        .for_each(|named| settle(named, by));
}

fn settle(named: &mut Named, by: &Weighing) {
    let (mut share, mut moved) = (FIRST, false);
    while share > LAST {
        let before = named.tuned.surprise;
        for edge in 0..EDGES {
            for way in [share, -share] {
                moved |= moved_to(named, nudged(named.proposal.extent.as_ref(), edge, way), by);
            }
        }
        let gained = before - named.tuned.surprise;
        if gained < WORTH {
            share *= 0.5;
        }
    }
    if moved {
        named.scores = scores(&named.given, &named.tuned, by);
    }
}

/// Takes another extent where it does better, and says whether.
fn moved_to(named: &mut Named, extent: Option<Extent>, by: &Weighing) -> bool {
    let Some(extent) = extent else { return false };
    let proposal = Proposal {
        extent: Some(extent),
        ..named.proposal.clone()
    };
    let Some(given) = placed(&named.given, &proposal) else {
        return false;
    };
    let (knobs, begin) = (&named.tuned.knobs, &named.tuned.solution);
    let Ok(tuned) = tune_until(&given, knobs, begin, by, SKETCH) else {
        return false;
    };
    let gain = named.tuned.surprise - tuned.surprise;
    if gain.is_nan() || gain < LEAST {
        return false;
    }
    named.gain += gain;
    (named.proposal, named.given, named.tuned) = (proposal, given, tuned);
    true
}

/// The extent with one of its edges moved by a share of its size; `None` where it has no such edge.
fn nudged(extent: Option<&Extent>, edge: usize, share: f64) -> Option<Extent> {
    match extent? {
        Extent::Place { disc } => {
            let mut disc = *disc;
            let step = share * disc[2];
            *disc.get_mut(edge)? += step;
            Some(Extent::Place { disc })
        }
        Extent::Time(at) => {
            let step = share * SECONDS;
            let mut at = *at;
            match edge {
                0 => at.start += step,
                1 => at.end += step,
                _ => return None,
            }
            Some(Extent::Time(at))
        }
        Extent::Run(_) | Extent::Beyond { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Subject;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::diagnosis::screening::locate::Stretch;
    use crate::diagnosis::search::naming::{finish, sketch};
    use crate::diagnosis::search::stage::tests::retuned;
    use crate::effects::{CATALOGUE, Effects};
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};
    use nalgebra::DVector;

    #[test]
    fn edges_move_to_where_something_acts() {
        let soil = Terrain::preset("sandy_loam").unwrap();
        let nominal = Specification::plain(Vehicle::tran2007(), soil);
        let text = r#"{"drag": {"coefficient": 150}, "window": {"effects": ["drag"], "time": [6.7, 12.15]}}"#;
        let slowed = Specification {
            effects: Effects::from_json(text).unwrap(),
            ..nominal.clone()
        };
        let recordings = [driven(&slowed, "slalom")];
        let (stage, by) = retuned(&nominal, &recordings);
        let drag = CATALOGUE.iter().position(|e| e.name == "drag").unwrap();
        let subject = Subject::Effect(drag);
        let knobs: Vec<usize> = stage.given.candidates.of(subject).collect();
        let proposal = Proposal {
            subject,
            extent: Some(Extent::Time(Stretch {
                recording: 0,
                run: 0,
                start: 6.9,
                end: 12.4,
            })),
            steps: vec![(knobs[0], DVector::repeat(1, 100.0))],
            evidence: 0.0,
            looking: 0.0,
            stability: Vec::new(),
            soil: DVector::zeros(stage.given.soil.len()),
            hidden: false,
            anew: false,
            knobs,
        };
        let begun = sketch(&stage.given, &proposal, &stage.tuned, &by, 1.0).unwrap();
        let mut fitted = [finish(begun, &stage.tuned, &by).unwrap()];
        let before = fitted[0].gain;
        settle_edges(&mut fitted, &by);
        let Some(Extent::Time(at)) = fitted[0].proposal.extent else {
            unreachable!()
        };
        assert!(
            (at.start - 6.7).abs() < 0.05 && (at.end - 12.15).abs() < 0.05,
            "{at:?}"
        );
        assert!(fitted[0].gain > before + 20.0);
    }

    #[test]
    fn each_edge_moves_alone() {
        let disc = Extent::Place {
            disc: [1.0, 2.0, 4.0],
        };
        let moved = |edge| match nudged(Some(&disc), edge, 0.1) {
            Some(Extent::Place { disc }) => disc,
            _ => unreachable!(),
        };
        assert_eq!(moved(0), [1.4, 2.0, 4.0]);
        assert_eq!(moved(1), [1.0, 2.4, 4.0]);
        assert_eq!(moved(2), [1.0, 2.0, 4.4]);
        assert_eq!(nudged(Some(&disc), 3, 0.1), None);
        assert_eq!(nudged(None, 0, 0.1), None);
    }
}
