//! Step 5: where something is missing.
//!
//! A box scan: every candidate, and a push that no effect explains, acting in one set of gates only:
//! in every interval of a run, in every run, in every disc of the map. With the sums of the gates' equations each
//! set costs the same; the one with the largest evidence is taken (a generalised likelihood ratio: D.
//! O. Siegmund, "Sequential Analysis", 1985), less the logarithm of the number of sets
//! that were looked at.

use super::gates::chains;
use super::scan::{Gated, Scan, discs};
use super::screen::{Projection, Score};
use super::system::System;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::Given;
use crate::diagnosis::hypothesis::candidate::TERRAIN_CHANGE;
use crate::effects::CATALOGUE;
use rayon::prelude::*;

/// A part of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Recording.
    pub recording: usize,
    /// Run.
    pub run: usize,
    /// Beginning \[s\], by the run's clock.
    pub start: f64,
    /// End \[s\].
    pub end: f64,
}

/// A set of gates: where something acts.
#[derive(Debug, Clone, PartialEq)]
pub enum Extent {
    /// From gate to gate (exclusive) of a run's gates in their order.
    Time(Stretch),
    /// All of a run, of several.
    Run(Stretch),
    /// Where the vehicle is within a disc.
    Place {
        /// Centre, east and north, and radius \[m\].
        disc: [f64; 3],
    },
    /// Beyond a line on the map.
    Beyond {
        /// Direction across the line \[rad\], counter-clockwise from east.
        direction: f64,
        /// The line's distance from the origin in that direction \[m\].
        position: f64,
    },
}

/// The best set of gates for a candidate.
#[derive(Debug, Clone)]
pub struct Found {
    /// What acts.
    pub subject: Subject,
    /// Where.
    pub extent: Extent,
    /// The knobs that act, in the order of the score's step.
    pub knobs: Vec<usize>,
    /// The one-step fit.
    pub score: Score,
    /// Log Bayes factor, less the logarithm of the number of sets looked at.
    pub evidence: f64,
}

/// What is scanned: knobs of a subject that act gate by gate.
#[derive(Debug, Clone)]
pub struct Scanned {
    /// What acts.
    pub subject: Subject,
    /// Its gated knobs.
    pub knobs: Vec<usize>,
    /// For each knob the gated column that it acts by, and a factor.
    columns: Vec<(usize, f64)>,
}

impl Scanned {
    fn new(system: &System, subject: Subject, knobs: &[usize]) -> Option<Self> {
        let gated = |knob: &usize| system.layout.gated.iter().position(|other| other == knob);
        let (knobs, columns): (Vec<_>, Vec<_>) = knobs
            .iter()
            .filter_map(|knob| Some((*knob, (system.layout.soil + gated(knob)?, 1.0))))
            .unzip();
        (!knobs.is_empty()).then_some(Self {
            subject,
            knobs,
            columns,
        })
    }

    fn found(&self, extent: Extent, score: Score, evidence: f64) -> Found {
        Found {
            subject: self.subject,
            extent,
            knobs: self.knobs.clone(),
            score,
            evidence,
        }
    }

    /// A change of the soil: its factors act as the soil's numbers do. `None` where the given model has
    /// one.
    fn soil(given: &Given, soil: &[f64]) -> Option<Self> {
        let effect = CATALOGUE.iter().position(|e| e.name == TERRAIN_CHANGE)?;
        let angle = soil[given.place_of_soil("friction_angle")?];
        // d phi = d(tan phi) cos^2 phi.
        let by_friction = angle.sin() * angle.cos();
        let (mut knobs, mut columns) = (Vec::new(), Vec::new());
        for knob in given.candidates.of(Subject::Effect(effect)) {
            let (number, factor) = match given.candidates.knobs[knob].name {
                "cohesion_factor" => ("cohesion", 1.0),
                "friction_factor" => ("friction_angle", by_friction),
                "stiffness_factor" => ("frictional_modulus", 1.0),
                _ => ("shear_modulus", 1.0),
            };
            columns.push((given.place_of_soil(number)?, factor));
            knobs.push(knob);
        }
        (!knobs.is_empty()).then_some(Self {
            subject: Subject::Effect(effect),
            knobs,
            columns,
        })
    }
}

/// Everything that can be scanned at a soil's coordinates: effects with gated knobs that are not on
/// yet, a change of the soil, and a push.
#[must_use]
pub fn scanned(given: &Given, system: &System, soil: &[f64], on: &[usize]) -> Vec<Scanned> {
    // A window confines an effect with all its numbers: what acts throughout would end there as well.
    let effect = |knob: &usize| given.candidates.knobs[*knob].effect;
    let is_off = |knob: &usize| on.iter().all(|other| effect(other) != effect(knob));
    let off = |knobs: Vec<usize>| -> Vec<usize> { knobs.into_iter().filter(is_off).collect() };
    let subjects = given.candidates.subjects.iter();
    let effects = subjects.filter_map(|subject| {
        let knobs = off(given.candidates.of(*subject).collect());
        Scanned::new(system, *subject, &knobs)
    });
    let push = Scanned::new(
        system,
        Subject::Unknown,
        &off(given.candidates.laws().collect()),
    );
    let change = Scanned::soil(given, soil).filter(|s| !s.knobs.iter().any(|k| on.contains(k)));
    effects.chain(push).chain(change).collect()
}

/// The best interval, the best run and the best disc of each candidate.
#[must_use]
pub fn locate(
    given: &Given,
    system: &System,
    projection: &Projection,
    scanned: &[Scanned],
) -> Vec<Found> {
    let chains = chains(given, system);
    let discs = discs(&chains);
    let best = |one: &Scanned, scan: &Scan| {
        let best = [
            scan.intervals(&chains),
            scan.runs(&chains),
            scan.discs(&chains, &discs),
            scan.boundary(&chains).filter(|_| is_change(one.subject)),
        ];
        let best = best.into_iter().flatten();
        best.map(|(extent, score, evidence)| one.found(extent, score, evidence))
            .collect::<Vec<_>>()
    };
    let each = each(given, system, projection, scanned, best);
    each.into_iter().flatten().collect()
}

/// The best interval of each candidate.
#[must_use]
pub fn in_time(
    given: &Given,
    system: &System,
    projection: &Projection,
    scanned: &[Scanned],
) -> Vec<Found> {
    let chains = chains(given, system);
    let best = |one: &Scanned, scan: &Scan| {
        let (extent, score, evidence) = scan.intervals(&chains)?;
        Some(one.found(extent, score, evidence))
    };
    let each = each(given, system, projection, scanned, best);
    each.into_iter().flatten().collect()
}

/// Each candidate at one place or time, where looking has cost so much.
#[must_use]
pub fn located_at(
    given: &Given,
    system: &System,
    projection: &Projection,
    scanned: &[Scanned],
    (extent, looking): (&Extent, f64),
) -> Vec<Found> {
    let chains = chains(given, system);
    let there = |one: &Scanned, scan: &Scan| {
        let score = scan.within(&chains, extent)?;
        let evidence = score.evidence - looking;
        Some(one.found(extent.clone(), score, evidence))
    };
    let each = each(given, system, projection, scanned, there);
    each.into_iter().flatten().collect()
}

/// Does something with each candidate's scan.
fn each<T: Send>(
    given: &Given,
    system: &System,
    projection: &Projection,
    scanned: &[Scanned],
    work: impl Fn(&Scanned, &Scan) -> T + Sync,
) -> Vec<T> {
    let (inverse, settled) = projection.inverse();
    let recordings = 0..given.recordings.len();
    let nuisance: Vec<_> = recordings
        .map(|recording| system.columns(recording, projection.nuisance()))
        .collect();
    let scan = |one: &Scanned| {
        let knobs = one.knobs.iter();
        let unknowns = knobs.filter_map(|knob| system.unknowns(*knob).first().copied());
        let scan = Scan {
            system,
            projection,
            nuisance: &nuisance,
            inverse: &inverse,
            settled: &settled,
            gated: Gated {
                columns: one.columns.clone(),
                unknowns: unknowns.collect(),
            },
            deadline: given.deadline,
        };
        work(one, &scan)
    };
    scanned.par_iter().map(scan).collect()
}

fn is_change(subject: Subject) -> bool {
    subject.name() == TERRAIN_CHANGE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::diagnosis::search::stage::Stage;
    use crate::diagnosis::search::stage::tests::retuned;
    use crate::effects::Effects;
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};

    #[test]
    fn the_ends_of_an_interval_lie_within_gates() {
        let soil = Terrain::preset("sandy_loam").unwrap();
        let nominal = Specification::plain(Vehicle::tran2007(), soil);
        for (start, end) in [(6.7, 12.15), (8.3, 11.9)] {
            let text = format!(
                r#"{{"drawbar": {{"force": 400}}, "window": {{"effects": ["drawbar"], "time": [{start}, {end}]}}}}"#
            );
            let effects = Effects::from_json(&text).unwrap();
            let towing = Specification {
                effects,
                ..nominal.clone()
            };
            let recordings = [driven(&towing, "slalom")];
            let (stage, _) = retuned(&nominal, &recordings);
            let Stage { given, tuned, .. } = &stage;
            let system = &stage.looked.system;
            let projection = Projection::over_all(system, &[]).unwrap();
            let asked = scanned(given, system, &tuned.solution.soil, &[]);
            let found = locate(given, system, &projection, &asked);
            let found = found.iter().find_map(|one| match one.extent {
                Extent::Time(at) if one.subject == Subject::Unknown => Some(at),
                _ => None,
            });
            let at = found.unwrap();
            assert!(
                (at.start - start).abs() < 0.12 && (at.end - end).abs() < 0.12,
                "{at:?}"
            );
        }
    }
}
