//! Box scan for the region in which an effect is missing.
//!
//! Every candidate, and an unmodelled force, is confined to one set of time bins: every interval of a run, every run,
//! every disc of the map. Sums over the bins' equations make each set equally cheap. The set with the largest
//! evidence is taken (a generalised likelihood ratio: D. O. Siegmund, "Sequential Analysis", 1985), less the
//! logarithm of the number of sets.

use super::identifiable::Accepted;
use super::region::Region;
use super::scan::{BinnedFit, Scan, discs};
use super::screen::{Projection, Score};
use super::system::System;
use super::time_bins::chains;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::candidate::{TERRAIN_CHANGE, is_residual_model};
use crate::effects::{CATALOGUE, Class};
use rayon::prelude::*;

/// The best region of a candidate.
#[derive(Debug, Clone)]
pub struct LocatedCandidate {
    /// What acts.
    pub subject: Subject,
    /// Where.
    pub extent: Region,
    /// The coefficients in the order of the score's step.
    pub coefficients: Vec<usize>,
    /// The one-step fit.
    pub score: Score,
    /// Log Bayes factor, less the logarithm of the number of regions.
    pub evidence: f64,
}

/// A candidate resolved in time bins.
#[derive(Debug, Clone)]
pub struct ScanTarget {
    /// What acts.
    pub subject: Subject,
    /// Its binned coefficients.
    pub coefficients: Vec<usize>,
    /// For each coefficient its binned column, and a factor.
    columns: Vec<(usize, f64)>,
    /// Unknowns of accepted effects that keep their sizes beside it.
    accepted: Vec<usize>,
}

impl ScanTarget {
    fn new(system: &System, subject: Subject, coefficients: &[usize]) -> Option<Self> {
        let binned = |coefficient: &usize| {
            system
                .layout
                .binned
                .iter()
                .position(|other| other == coefficient)
        };
        let (coefficients, columns): (Vec<_>, Vec<_>) = coefficients
            .iter()
            .filter_map(|coefficient| {
                Some((
                    *coefficient,
                    (system.layout.soil + binned(coefficient)?, 1.0),
                ))
            })
            .unzip();
        (!coefficients.is_empty()).then_some(Self {
            subject,
            coefficients,
            columns,
            accepted: Vec::new(),
        })
    }

    fn found(&self, extent: Region, score: Score, evidence: f64) -> LocatedCandidate {
        LocatedCandidate {
            subject: self.subject,
            extent,
            coefficients: self.coefficients.clone(),
            score,
            evidence,
        }
    }

    /// A change of soil: its factors act as the soil's parameters do. `None` if the given model has one.
    fn soil(problem: &Problem, soil: &[f64]) -> Option<Self> {
        let effect = CATALOGUE.iter().position(|e| e.name == TERRAIN_CHANGE)?;
        let angle = soil[problem.place_of_soil("friction_angle")?];
        // d phi = d(tan phi) cos^2 phi.
        let by_friction = angle.sin() * angle.cos();
        let (mut coefficients, mut columns) = (Vec::new(), Vec::new());
        for coefficient in problem.candidates.of(Subject::Effect(effect)) {
            let (number, factor) = match problem.candidates[coefficient].name {
                "cohesion_factor" => ("cohesion", 1.0),
                "friction_factor" => ("friction_angle", by_friction),
                "stiffness_factor" => ("frictional_modulus", 1.0),
                _ => ("shear_modulus", 1.0),
            };
            columns.push((problem.place_of_soil(number)?, factor));
            coefficients.push(coefficient);
        }
        (!coefficients.is_empty()).then_some(Self {
            subject: Subject::Effect(effect),
            coefficients,
            columns,
            accepted: Vec::new(),
        })
    }
}

/// Everything that can be scanned at a soil's coordinates: off effects with binned coefficients, a change of soil,
/// and an unmodelled force.
#[must_use]
pub fn scanned(problem: &Problem, system: &System, soil: &[f64], on: &[usize]) -> Vec<ScanTarget> {
    // A window confines an effect with all its parameters, also those that act throughout.
    let effect = |coefficient: &usize| problem.candidates[*coefficient].effect;
    let is_off = |coefficient: &usize| on.iter().all(|other| effect(other) != effect(coefficient));
    let off = |coefficients: Vec<usize>| -> Vec<usize> {
        coefficients.into_iter().filter(is_off).collect()
    };
    let subjects = problem.candidates.subjects.iter();
    let effects = subjects.filter_map(|subject| {
        let coefficients = off(problem.candidates.of(*subject).collect());
        ScanTarget::new(system, *subject, &coefficients)
    });
    let push = ScanTarget::new(
        system,
        Subject::Unknown,
        &off(problem.candidates.residual_models().collect()),
    );
    let named = on.iter().filter(|k| !is_residual_model(effect(k)));
    let push = push.map(|push| ScanTarget {
        accepted: named.flat_map(|k| system.unknowns(*k)).collect(),
        ..push
    });
    let change =
        ScanTarget::soil(problem, soil).filter(|s| !s.coefficients.iter().any(|k| on.contains(k)));
    effects.chain(push).chain(change).collect()
}

/// The best interval, the best run and the best disc of each candidate.
#[must_use]
pub fn locate(
    problem: &Problem,
    system: &System,
    projection: &Projection,
    scanned: &[ScanTarget],
) -> Vec<LocatedCandidate> {
    let chains = chains(problem, system);
    let discs = discs(&chains);
    each(problem, system, projection, scanned, |one, scan| {
        let best = [
            scan.intervals(&chains),
            scan.runs(&chains),
            scan.discs(&chains, &discs),
            scan.boundary(&chains).filter(|_| is_change(one.subject)),
        ];
        best.into_iter().flatten()
    })
}

/// The best interval of each candidate.
#[must_use]
pub fn in_time(
    problem: &Problem,
    system: &System,
    projection: &Projection,
    scanned: &[ScanTarget],
) -> Vec<LocatedCandidate> {
    let chains = chains(problem, system);
    each(problem, system, projection, scanned, |_, scan| {
        scan.intervals(&chains)
    })
}

/// Each candidate in one given region, less the cost of its choice.
#[must_use]
pub fn located_at(
    problem: &Problem,
    system: &System,
    projection: &Projection,
    scanned: &[ScanTarget],
    (extent, price): (&Region, f64),
) -> Vec<LocatedCandidate> {
    let chains = chains(problem, system);
    each(problem, system, projection, scanned, |_, scan| {
        let score = scan.within(&chains, extent)?;
        let evidence = score.evidence - price;
        Some((extent.clone(), score, evidence))
    })
}

/// Scans every candidate in parallel; `best` are its best regions with score and evidence.
fn each<I: IntoIterator<Item = (Region, Score, f64)>>(
    problem: &Problem,
    system: &System,
    projection: &Projection,
    scanned: &[ScanTarget],
    best: impl Fn(&ScanTarget, &Scan) -> I + Sync,
) -> Vec<LocatedCandidate> {
    let (inverse, settled) = projection.inverse();
    let recordings = 0..problem.recordings.len();
    let nuisance: Vec<_> = recordings
        .map(|recording| system.columns(recording, projection.nuisance()))
        .collect();
    let scan = |one: &ScanTarget| {
        let coefficients = one.coefficients.iter();
        let unknowns =
            coefficients.filter_map(|coefficient| system.unknowns(*coefficient).first().copied());
        let accepted = Accepted::new(system, projection, one.accepted.iter().copied());
        let scan = Scan {
            system,
            accepted: &accepted,
            projection,
            nuisance: &nuisance,
            inverse: &inverse,
            settled: &settled,
            binned: BinnedFit {
                columns: one.columns.clone(),
                unknowns: unknowns.collect(),
            },
            of_vehicle: is_of_vehicle(one.subject),
            deadline: problem.deadline,
        };
        let found = best(one, &scan).into_iter();
        found
            .map(|(extent, score, evidence)| one.found(extent, score, evidence))
            .collect::<Vec<_>>()
    };
    scanned.par_iter().flat_map_iter(scan).collect()
}

/// Whether its cause belongs to the vehicle, as a load or a radius.
fn is_of_vehicle(subject: Subject) -> bool {
    match subject {
        Subject::Effect(effect) => {
            let class = CATALOGUE[effect].class;
            matches!(class, Class::Weight | Class::RollingRadius)
        }
        _ => false,
    }
}

fn is_change(subject: Subject) -> bool {
    subject.name() == TERRAIN_CHANGE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::search::stage::Stage;
    use crate::diagnosis::testing::{driven, named, on, refitted, with_effects};

    #[test]
    fn the_ends_of_an_interval_lie_within_gates() {
        let nominal = on("sandy_loam");
        for (start, end) in [(6.7, 12.15), (8.3, 11.9)] {
            let text = format!(
                r#"{{"drawbar": {{"force": 400}}, "window": {{"effects": ["drawbar"], "time": [{start}, {end}]}}}}"#
            );
            let towing = with_effects(&nominal, &text);
            let recordings = [driven(&towing, "slalom")];
            let (stage, _) = refitted(&nominal, &recordings);
            let Stage { problem, fit, .. } = &stage;
            let system = &stage.screening.system;
            let projection = Projection::over_all(system, &[]).unwrap();
            let asked = scanned(problem, system, &fit.solution.soil, &[]);
            let all = locate(problem, system, &projection, &asked);
            let found = all.iter().find_map(|one| match one.extent {
                Region::Time(at) if one.subject == Subject::Unknown => Some(at),
                _ => None,
            });
            let at = found.unwrap();
            assert!(
                (at.start - start).abs() < 0.12 && (at.end - end).abs() < 0.12,
                "{at:?}"
            );
            // A load neither comes with a place nor for some seconds.
            let bounds = problem.segments.iter().map(|one| [one.start, one.end]);
            let bounds = bounds
                .reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
                .unwrap();
            let lasts = |extent: &Region| match extent {
                Region::Time(at) => at.start < bounds[0] + 2.0 || at.end > bounds[1] - 2.0,
                _ => false,
            };
            for vehicle in ["com_shift", "payload", "wheel_radius"].map(named) {
                let of = all.iter().filter(|one| one.subject == vehicle);
                let regions: Vec<&Region> = of.map(|one| &one.extent).collect();
                assert!(!regions.is_empty(), "{vehicle:?}");
                assert!(regions.iter().all(|extent| lasts(extent)), "{regions:?}");
            }
        }
    }
}
