//! Proposals of missing effects from screen, box scan and residual models, the likeliest first.

use super::view::View;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::screening::locate::{LocatedCandidate, locate, scanned};
use crate::diagnosis::screening::region::Region;
use crate::diagnosis::screening::residual_model::{ResidualModel, residual_model};
use crate::diagnosis::screening::screen::{Projected, Projection, Score};
use crate::diagnosis::screening::slow;
use crate::diagnosis::screening::system::System;
use nalgebra::DVector;

/// A proposed effect before its full fit.
#[derive(Debug, Clone)]
pub struct Proposal {
    /// What.
    pub subject: Subject,
    /// Its coefficients.
    pub coefficients: Vec<usize>,
    /// Its region, if it is local.
    pub extent: Option<Region>,
    /// Steps of its coefficients by the linearised problem.
    pub steps: Vec<(usize, DVector<f64>)>,
    /// Log Bayes factor by the linearised problem, less its price.
    pub evidence: f64,
    /// Price of the choice of its region, or what slow noise explains of it.
    pub price: f64,
    /// Stability of a residual model's terms.
    pub stability: Vec<f64>,
    /// Step of the soil that goes with those of its coefficients.
    pub soil: DVector<f64>,
    /// Whether it is proposed without evidence on the linearised problem.
    pub hidden: bool,
}

/// A screened candidate.
#[derive(Debug, Clone)]
pub struct ScreenedCandidate {
    /// What.
    pub subject: Subject,
    /// Its projected equations.
    pub projected: Projected,
    /// Its one-step fit.
    pub score: Score,
    /// Log Bayes factor of what slow noise explains of it.
    pub price: f64,
}

/// Proposals are fitted in full down to this share of the best of their kind, less this difference: throughout, where
/// the linearised problem may be far off, and local.
pub const BEHIND: [f64; 2] = [0.2, 0.6];
pub const FAR_BEHIND: f64 = 8.0;
/// Absorbed share from which an effect may be hidden.
const HIDDEN: f64 = 0.9;
/// Minimum evidence for a fit.
const FAINT: f64 = 0.5;
/// Local proposals must exceed their subject's evidence throughout by this.
const BETTER_LOCAL: f64 = 3.0;

/// Screens every candidate that is not on.
#[must_use]
pub fn screened(view: &View) -> Vec<ScreenedCandidate> {
    let View {
        problem,
        system,
        projection,
        noise,
        on,
        ..
    } = view;
    let subjects = problem.candidates.subjects.iter();
    subjects
        .filter_map(|subject| {
            let coefficients = problem.candidates.of(*subject);
            let coefficients: Vec<usize> = coefficients
                .filter(|coefficient| !on.contains(coefficient))
                .collect();
            let unknowns: Vec<usize> = coefficients
                .iter()
                .flat_map(|k| system.unknowns(*k))
                .collect();
            if unknowns.is_empty() {
                return None;
            }
            let projected = projection.of(&unknowns);
            let score = projection.score(&projected);
            Some(ScreenedCandidate {
                subject: *subject,
                price: slow::price(problem, system, &projected, noise),
                projected,
                score,
            })
        })
        .collect()
}

/// All proposals, the likeliest first.
#[must_use]
pub fn proposals(
    view: &View,
    screened: &[ScreenedCandidate],
    soil: &[f64],
    seed: u64,
) -> Vec<Proposal> {
    let View {
        problem,
        system,
        projection,
        on,
        ..
    } = view;
    let mut all: Vec<Proposal> = screened
        .iter()
        .map(|one| Proposal {
            steps: steps(problem, system, one),
            soil: soil_after(
                problem,
                projection,
                &one.projected.unknowns,
                &one.score.step,
            ),
            // The overdispersion is for the reader: residual models and local effects have none.
            evidence: projection.score_with(&one.projected, 1.0).evidence - one.price,
            price: one.price,
            ..Proposal::new(one.subject, problem.candidates.of(one.subject).collect())
        })
        .collect();
    place_load(problem, &mut all);
    let throughout = all.clone();
    if problem.nominal.effects.window.is_none() {
        let throughout = |subject: Subject| {
            let same = throughout.iter().find(|one| one.subject == subject);
            same.map_or(0.0, |one| one.evidence.max(0.0))
        };
        let found = locate(
            problem,
            system,
            projection,
            &scanned(problem, system, soil, on),
        );
        let mut found = placed_locally(problem, found);
        found.retain(|one| one.evidence > throughout(one.subject) + BETTER_LOCAL);
        all.extend(found);
    }
    if let Some(residual_model) = residual_model(problem, system, on, &view.exact, seed) {
        all.push(unnamed(view, residual_model));
    }
    all.retain(|proposal| proposal.evidence > FAINT);
    all.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    all
}

/// Proposals of effects that have no derivative while they are off, and of which the refit of the soil absorbs nearly all:
/// it has gone far to imitate them, and the linearised problem does not see them. They are proposed at the expected size,
/// with the soil moved back by its imitation.
#[must_use]
pub fn hidden(view: &View, screened: &[ScreenedCandidate]) -> Vec<Proposal> {
    let View {
        problem,
        system,
        projection,
        ..
    } = view;
    let propose = |one: &ScreenedCandidate| {
        let coefficients: Vec<usize> = problem.candidates.of(one.subject).collect();
        let unknowns = &one.projected.unknowns;
        let absorbed = |coefficient: &usize| {
            let own = system.unknowns(*coefficient);
            let places = unknowns.iter().enumerate();
            let mut places = places.filter(|(_, unknown)| own.contains(unknown));
            places.any(|(place, _)| one.projected.absorbed(place) > HIDDEN)
        };
        let away = |coefficient: &usize| {
            let about = &problem.candidates[*coefficient];
            let hidden = about.secant.is_some() && absorbed(coefficient);
            if hidden {
                about.typical - about.off()
            } else {
                0.0
            }
        };
        if coefficients.iter().all(|k| away(k) == 0.0) {
            return None;
        }
        let steps = coefficients.iter().map(|coefficient| {
            let recordings = system.places.len();
            (*coefficient, DVector::repeat(recordings, away(coefficient)))
        });
        let steps: Vec<(usize, DVector<f64>)> = steps.collect();
        let moved = system.step(unknowns, &coefficients, |coefficient, recording| {
            let own = steps.iter().find(|(other, _)| *other == coefficient);
            own.map_or(0.0, |(_, step)| step[recording])
        });
        Some(Proposal {
            steps,
            price: one.price,
            soil: soil_after(problem, projection, unknowns, &moved),
            hidden: true,
            ..Proposal::new(one.subject, coefficients)
        })
    };
    screened.iter().filter_map(propose).collect()
}

/// Step of the soil that follows a step of some unknowns.
fn soil_after(
    problem: &Problem,
    projection: &Projection,
    unknowns: &[usize],
    step: &DVector<f64>,
) -> DVector<f64> {
    let follows = projection.following(unknowns, step);
    follows.rows(0, problem.soil.len()).into_owned()
}

/// A screened candidate's step by coefficient and recording.
fn steps(
    problem: &Problem,
    system: &System,
    one: &ScreenedCandidate,
) -> Vec<(usize, DVector<f64>)> {
    let at = |unknown: usize| {
        let place = one.projected.unknowns.iter().position(|u| *u == unknown);
        place.map_or(0.0, |place| one.score.step[place])
    };
    let coefficients = problem.candidates.of(one.subject);
    coefficients
        .map(|coefficient| {
            let column = system.layout.soil + coefficient;
            let each = system
                .places
                .iter()
                .map(|places| places[column].map_or(0.0, at));
            (coefficient, DVector::from_vec(each.collect()))
        })
        .collect()
}

/// Located candidates as proposals.
#[must_use]
pub fn placed_locally(problem: &Problem, found: Vec<LocatedCandidate>) -> Vec<Proposal> {
    let each = found.into_iter();
    let mut all: Vec<Proposal> = each.map(|one| local(one, problem.soil.len())).collect();
    place_load(problem, &mut all);
    all
}

fn local(found: LocatedCandidate, soil: usize) -> Proposal {
    let each = |(coefficient, step): (&usize, &f64)| (*coefficient, DVector::repeat(1, *step));
    let pairs = found.coefficients.iter().zip(found.score.step.iter());
    Proposal {
        steps: pairs.map(each).collect(),
        price: found.score.evidence - found.evidence,
        evidence: found.evidence,
        extent: Some(found.extent),
        // The rest of the drive determines the soil.
        soil: DVector::zeros(soil),
        ..Proposal::new(found.subject, found.coefficients)
    }
}

fn unnamed(view: &View, residual_model: ResidualModel) -> Proposal {
    let View {
        problem,
        system,
        exact: projection,
        ..
    } = view;
    let coefficients = residual_model.coefficients;
    let unknowns: Vec<usize> = coefficients
        .iter()
        .flat_map(|k| system.unknowns(*k))
        .collect();
    let score = projection.score_with(&projection.of(&unknowns), 1.0);
    let each = |(coefficient, step): (&usize, &f64)| (*coefficient, DVector::repeat(1, *step));
    let pairs = coefficients.iter().zip(score.step.iter());
    Proposal {
        steps: pairs.map(each).collect(),
        price: score.evidence - residual_model.evidence,
        evidence: residual_model.evidence,
        stability: residual_model.stability,
        soil: soil_after(problem, projection, &unknowns, &score.step),
        ..Proposal::new(Subject::Unknown, coefficients)
    }
}

/// The best few proposals of each kind.
#[must_use]
pub fn shortlist(proposals: &[Proposal]) -> Vec<&Proposal> {
    let mut list: Vec<&Proposal> = Vec::new();
    let [far, near] = BEHIND;
    for (kind, most, behind) in [
        (ProposalKind::Throughout, 6, far),
        (ProposalKind::Local, 8, near),
        (ProposalKind::ResidualModel, 1, near),
    ] {
        let of_kind = proposals.iter().filter(|p| p.kind() == kind);
        let best = of_kind.clone().map(|p| p.evidence).fold(0.0, f64::max);
        let mut taken: Vec<&Proposal> = Vec::new();
        for proposal in of_kind.filter(|p| p.evidence > behind * best - FAR_BEHIND) {
            let known = taken.iter().any(|other| other.subject == proposal.subject);
            if taken.len() < most && !known {
                taken.push(proposal);
            }
        }
        list.extend(taken);
    }
    list
}

/// The kind of a proposal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProposalKind {
    /// An effect that acts throughout.
    Throughout,
    /// An effect of a disc or time interval.
    Local,
    /// An empirical residual model.
    ResidualModel,
}

/// Prior cost of each term of a residual model: it can imitate many effects.
const TERM: f64 = 2.0;
/// Prior cost of a local effect besides the choice of its region.
const LOCAL: f64 = 1.0;

impl Proposal {
    /// A proposal that acts throughout, with neither steps nor evidence.
    #[must_use]
    pub fn new(subject: Subject, coefficients: Vec<usize>) -> Self {
        Self {
            subject,
            coefficients,
            extent: None,
            steps: Vec::new(),
            evidence: 0.0,
            price: 0.0,
            stability: Vec::new(),
            soil: DVector::zeros(0),
            hidden: false,
        }
    }

    /// Its kind.
    #[must_use]
    pub fn kind(&self) -> ProposalKind {
        match (&self.extent, self.subject) {
            // A boundary on the map is a change of terrain's own place.
            (Some(Region::Beyond { .. }), _) => ProposalKind::Throughout,
            (Some(_), _) => ProposalKind::Local,
            (None, Subject::Unknown) => ProposalKind::ResidualModel,
            (None, _) => ProposalKind::Throughout,
        }
    }

    /// Removes a term from a residual model.
    pub fn without_term(&mut self, place: usize) {
        let coefficient = self.coefficients.remove(place);
        self.stability.remove(place);
        self.steps.retain(|(other, _)| *other != coefficient);
    }

    /// Log prior relative to an effect of the catalogue.
    #[must_use]
    pub fn log_prior(&self) -> f64 {
        match self.kind() {
            ProposalKind::Throughout => 0.0,
            ProposalKind::Local if self.subject == Subject::Unknown => -LOCAL - TERM,
            ProposalKind::Local => -LOCAL,
            ProposalKind::ResidualModel => -TERM * self.coefficients.len() as f64,
        }
    }
}

const MASS: &str = "payload.mass";
/// The place of a load, and the equivalent shift of the centre of mass.
const SHIFTS: [(&str, &str); 2] = [
    ("payload.ahead", "com_shift.ahead"),
    ("payload.left", "com_shift.left"),
];
/// Maximum initial load as a share of the vehicle's mass.
const HEAVIEST: f64 = 0.2;

/// If a shifted centre of mass is likelier, the load starts where it causes the same shift: throughout, and in single
/// runs. A load that is on is not proposed again.
pub fn place_load(problem: &Problem, proposals: &mut Vec<Proposal>) {
    let shifts = proposals.iter().filter(|one| {
        let whole = matches!(one.extent, None | Some(Region::Run(_)));
        whole && step(problem, one, SHIFTS[0].1).is_some()
    });
    let shifts: Vec<Proposal> = shifts.cloned().collect();
    for shift in shifts {
        place_load_as(problem, proposals, shift);
    }
}

/// A proposal's step of a coefficient.
fn step(problem: &Problem, proposal: &Proposal, name: &str) -> Option<f64> {
    let coefficient = problem.candidates.find(name)?;
    let (_, step) = proposal
        .steps
        .iter()
        .find(|(other, _)| *other == coefficient)?;
    step.get(0).copied()
}

/// The load with the same shift of the centre of mass as a proposal.
fn place_load_as(problem: &Problem, proposals: &mut Vec<Proposal>, shift: Proposal) {
    let Some(mass) = problem.candidates.find(MASS) else {
        return;
    };
    let subject = Subject::Effect(problem.candidates[mass].effect);
    if !proposals.iter().any(|one| one.subject == subject) {
        return;
    }
    let here = |one: &Proposal| one.subject == subject && one.extent == shift.extent;
    let load = proposals.iter().position(here);
    if load.is_some_and(|load| shift.evidence <= proposals[load].evidence) {
        return;
    }
    let vehicle = &problem.nominal.vehicle;
    let typical = problem.candidates[mass].typical;
    let loaded = typical.min(HEAVIEST * vehicle.mass);
    let lever = (vehicle.mass + loaded) / loaded;
    let place = |(own, other): &(&str, &str), vehicles: f64| {
        let away = vehicles + lever * step(problem, &shift, other)?;
        Some((problem.candidates.find(own)?, DVector::repeat(1, away)))
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
    use crate::diagnosis::screening::region::RunInterval;
    use crate::diagnosis::testing::named;
    use crate::terrain::Terrain;
    use crate::vehicle::{ModelParameter, Specification, Vehicle};

    #[test]
    fn what_is_hidden_begins_within_its_range() {
        let loam = Terrain::preset("sandy_loam").unwrap();
        let nominal = Specification::plain(Vehicle::tran2007(), loam);
        let problem = Problem::new(&nominal, &[]);
        let all = problem.candidates.coefficients.iter();
        let hidden: Vec<_> = all.filter(|one| one.secant.is_some()).collect();
        assert!(hidden.iter().any(|one| one.name == "pressure"));
        for one in hidden {
            let (low, high) = one.parameter.bounds();
            assert!((low..=high).contains(&one.typical), "{}", one.name);
            assert_ne!(one.typical, one.off(), "{}", one.name);
        }
    }

    #[test]
    fn the_load_shifts_the_centre_of_mass_as_much() {
        let vehicle = Vehicle::tran2007();
        let (own, offset) = (vehicle.mass, vehicle.com_offset);
        let nominal = Specification::plain(vehicle, Terrain::preset("sandy_loam").unwrap());
        let problem = Problem::new(&nominal, &[]);
        let propose = |name: &str, steps: &[f64], evidence: f64| {
            let subject = named(name);
            let coefficients: Vec<usize> = problem.candidates.of(subject).collect();
            let steps: Vec<_> = coefficients
                .iter()
                .zip(steps)
                .map(|(k, s)| (*k, DVector::repeat(1, *s)))
                .collect();
            Proposal {
                steps,
                evidence,
                soil: DVector::zeros(problem.soil.len()),
                ..Proposal::new(subject, coefficients)
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
                problem.candidates[*k].target
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
            extent: Some(Region::Run(RunInterval {
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
