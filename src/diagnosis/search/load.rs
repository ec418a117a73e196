//! A load and its place.
//!
//! While its mass is zero, the place of a load has no derivative: the screen sees its weight in the middle
//! alone. Where a shifted centre of mass shows, a load that shifts it as much is proposed as well.

use super::proposal::Proposal;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::screening::locate::Extent;
use nalgebra::DVector;

const MASS: &str = "payload.mass";
/// The place of a load, and the shift of the centre of mass in that direction.
const SHIFTS: [(&str, &str); 2] = [
    ("payload.ahead", "com_shift.ahead"),
    ("payload.left", "com_shift.left"),
];
/// A load is tried with no more than this share of the vehicle's mass.
const HEAVIEST: f64 = 0.2;

/// Where a shifted centre of mass is likelier, the load begins where it shifts it as much: of what acts
/// throughout, and of what acts in one run alone. A load that is on is not proposed again.
pub fn place_load(problem: &Problem, proposals: &mut Vec<Proposal>) {
    let shifts = proposals.iter().filter(|one| {
        let whole = matches!(one.extent, None | Some(Extent::Run(_)));
        whole && step(problem, one, SHIFTS[0].1).is_some()
    });
    let shifts: Vec<Proposal> = shifts.cloned().collect();
    for shift in shifts {
        place_load_as(problem, proposals, shift);
    }
}

fn coefficient(problem: &Problem, name: &str) -> Option<usize> {
    let mut coefficients = problem.candidates.coefficients.iter();
    coefficients.position(|coefficient| coefficient.parameter.name == name)
}

/// A proposal's step of a knob.
fn step(problem: &Problem, proposal: &Proposal, name: &str) -> Option<f64> {
    let coefficient = coefficient(problem, name)?;
    let (_, step) = proposal
        .steps
        .iter()
        .find(|(other, _)| *other == coefficient)?;
    step.get(0).copied()
}

/// The load that shifts the centre of mass as this proposal does, where that does.
fn place_load_as(problem: &Problem, proposals: &mut Vec<Proposal>, shift: Proposal) {
    let Some(mass) = coefficient(problem, MASS) else {
        return;
    };
    let subject = Subject::Effect(problem.candidates.coefficients[mass].effect);
    if !proposals.iter().any(|one| one.subject == subject) {
        return;
    }
    let here = |one: &Proposal| one.subject == subject && one.extent == shift.extent;
    let load = proposals.iter().position(here);
    if load.is_some_and(|load| shift.evidence <= proposals[load].evidence) {
        return;
    }
    let vehicle = &problem.nominal.vehicle;
    let typical = problem.candidates.coefficients[mass].typical;
    let loaded = typical.min(HEAVIEST * vehicle.mass);
    let lever = (vehicle.mass + loaded) / loaded;
    let place = |(own, other): &(&str, &str), vehicles: f64| {
        let away = vehicles + lever * step(problem, &shift, other)?;
        Some((coefficient(problem, own)?, DVector::repeat(1, away)))
    };
    let middle = [vehicle.com_offset, 0.0];
    let places = SHIFTS.iter().zip(middle).filter_map(|(s, m)| place(s, m));
    let placed = Proposal {
        subject,
        coefficients: problem.candidates.of(subject).collect(),
        steps: std::iter::once((mass, DVector::repeat(1, loaded)))
            .chain(places)
            .collect(),
        ..shift
    };
    match load {
        Some(load) => proposals[load] = placed,
        None => proposals.push(placed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::screening::locate::Stretch;
    use crate::effects::CATALOGUE;
    use crate::terrain::Terrain;
    use crate::vehicle::{ModelParameter, Specification, Vehicle};

    #[test]
    fn the_load_shifts_the_centre_of_mass_as_much() {
        let vehicle = Vehicle::tran2007();
        let (own, offset) = (vehicle.mass, vehicle.com_offset);
        let nominal = Specification::plain(vehicle, Terrain::preset("sandy_loam").unwrap());
        let problem = Problem::new(&nominal, &[]);
        let propose = |name: &str, steps: &[f64], evidence: f64| {
            let effect = CATALOGUE.iter().position(|e| e.name == name).unwrap();
            let subject = Subject::Effect(effect);
            let coefficients: Vec<usize> = problem.candidates.of(subject).collect();
            let steps = coefficients.iter().zip(steps);
            Proposal {
                subject,
                extent: None,
                steps: steps.map(|(k, s)| (*k, DVector::repeat(1, *s))).collect(),
                evidence,
                price: 0.0,
                stability: Vec::new(),
                soil: DVector::zeros(problem.soil.len()),
                hidden: false,
                anew: false,
                coefficients,
            }
        };
        let [ahead, left] = [-0.012, 0.037];
        let mut all = vec![
            propose("payload", &[3.0, 0.0, 0.0], 2.0),
            propose("com_shift", &[ahead, left], 40.0),
        ];
        place_load(&problem, &mut all);
        let value = |name: &str| {
            let found = all[0].steps.iter().find(|(k, _)| {
                problem.candidates.coefficients[*k].target
                    == crate::diagnosis::hypothesis::candidate::Target::Model(
                        ModelParameter::find(name).unwrap(),
                    )
            });
            found.unwrap().1[0]
        };
        let mass = value("payload.mass");
        let moved = |place: f64| mass * place / (own + mass);
        assert!((moved(value("payload.ahead") - offset) - ahead).abs() < 1e-12);
        assert!((moved(value("payload.left")) - left).abs() < 1e-12);
        assert_eq!(all[0].evidence, 40.0);
        // A load that shows by itself stays as it was seen.
        let mut all = vec![propose("payload", &[3.0, 0.0, 0.0], 50.0), all[1].clone()];
        place_load(&problem, &mut all);
        assert_eq!(all[0].steps[0].1[0], 3.0);
        // What one run alone has may be a load as well.
        let shift = Proposal {
            extent: Some(Extent::Run(Stretch {
                recording: 1,
                run: 0,
                start: 0.0,
                end: 60.0,
            })),
            ..all[1].clone()
        };
        let mut all = vec![shift, propose("payload", &[3.0, 0.0, 0.0], 2.0)];
        let on = all[0].clone();
        place_load(&problem, &mut all);
        assert_eq!(all.len(), 3);
        assert_eq!(all[2].subject.name(), "payload");
        assert_eq!(all[2].extent, all[0].extent);
        // What is on is not among the proposals, and is not proposed again.
        for extent in [None, on.extent.clone()] {
            let mut all = vec![Proposal {
                extent,
                ..on.clone()
            }];
            place_load(&problem, &mut all);
            assert_eq!(all.len(), 1);
        }
    }
}
