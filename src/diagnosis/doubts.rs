//! Doubts about the data, which go before the names of physics.

use super::caution::Caution;
use super::outcome::{Candidate, Diagnosis, Insufficient, Subject, Verdict};
use super::progress::Progress;
use crate::inspection::doubts::{PROBABLE, doubts_until, without};
use crate::inspection::{Doubt, DoubtKind};
use crate::recording::Recording;
use crate::vehicle::Vehicle;
use std::time::Duration;

/// Share of a time limit that the doubts may take. Their work is bounded, so that it matters for short limits and many
/// recordings alone.
const SHARE: f64 = 0.2;

/// What is missing if the time was up.
const UNFINISHED: &str = "There was no time to compare the wheel speeds with the motion on other soils: a wrong wheel radius, \
                          gear ratio or track is not ruled out (ugv inspect compares them).";

/// The doubts about each recording.
pub struct Doubts {
    /// The name of each recording with its doubts.
    each: Vec<(String, Vec<Doubt>)>,
    /// Whether there was time for all comparisons.
    is_whole: bool,
}

impl Doubts {
    /// Asks about every recording, within a share of the time limit.
    pub fn of(recordings: &[Recording], vehicle: &Vehicle, progress: &Progress) -> Self {
        let until = progress.limit().map(|limit| limit.mul_f64(SHARE));
        let is_late = || until.is_some_and(|until: Duration| progress.elapsed() > until);
        let is_over = || is_late() || progress.go_on().is_err();
        let cut_short = is_over();
        let found = Self::while_not(recordings, vehicle, &is_over);
        Self {
            is_whole: !cut_short && !is_late(),
            ..found
        }
    }

    /// Asks about every recording without a limit.
    pub fn whole(recordings: &[Recording], vehicle: &Vehicle) -> Self {
        Self::while_not(recordings, vehicle, &|| false)
    }

    /// Asks without comparing wheel speeds with soils, which takes time.
    pub fn quick(recordings: &[Recording], vehicle: &Vehicle) -> Self {
        let found = Self::while_not(recordings, vehicle, &|| true);
        Self {
            is_whole: false,
            ..found
        }
    }

    fn while_not(
        recordings: &[Recording],
        vehicle: &Vehicle,
        is_over: &(dyn Fn() -> bool + Sync),
    ) -> Self {
        let ask = |one: &Recording| (one.name.clone(), doubts_until(one, Some(vehicle), is_over));
        Self {
            each: recordings.iter().map(ask).collect(),
            is_whole: true,
        }
    }

    /// The recordings without the samples that are left out; `None` if all are used.
    pub fn remaining(&self, recordings: &[Recording]) -> Option<Vec<Recording>> {
        let mut all = self.each.iter().flat_map(|(_, doubts)| doubts);
        if !all.any(Doubt::is_left_out) {
            return None;
        }
        let pairs = recordings.iter().zip(&self.each);
        Some(
            pairs
                .map(|(one, (_, doubts))| without(one, doubts))
                .collect(),
        )
    }

    /// Puts the doubts before the answer.
    ///
    /// The likeliest doubt about data that are used competes with everything else: it takes its probability p, and all other
    /// probabilities shrink by 1 - p. From [`PROBABLE`] on the verdict is about it, and nothing else is claimed. Below, and
    /// where samples are left out, the headline of the verdict mentions it.
    pub fn put_before(&self, diagnosis: &mut Diagnosis) {
        let all = || {
            let each = self.each.iter();
            each.flat_map(|(name, doubts)| doubts.iter().map(move |doubt| (name, doubt)))
        };
        // What the reader and the importer noted may be harmless, and has a place among the notes.
        let is_shown = |doubt: &Doubt| doubt.is_left_out() || doubt.probability >= PROBABLE;
        let mut shown: Vec<(&String, &Doubt)> =
            all().filter(|(_, doubt)| is_shown(doubt)).collect();
        shown.sort_by(|a, b| {
            let used = a.1.is_left_out().cmp(&b.1.is_left_out());
            used.then(b.1.probability.total_cmp(&a.1.probability))
        });
        let cautions = shown
            .iter()
            .map(|(recording, doubt)| Caution::DoubtfulData {
                recording: (*recording).clone(),
                doubt: (*doubt).clone(),
            });
        diagnosis.cautions.splice(0..0, cautions);
        let minor = all().filter(|(_, doubt)| !is_shown(doubt) && doubt.kind != DoubtKind::Source);
        for (name, doubt) in minor {
            let percent = 100.0 * doubt.probability;
            let note = format!("{name}: {doubt} Probability: {percent:.0} %.");
            diagnosis.account.notes.push(note);
            diagnosis.minor_doubts.push(doubt.clone());
        }
        let by_probability = |a: &Doubt, b: &Doubt| b.probability.total_cmp(&a.probability);
        diagnosis.minor_doubts.sort_by(by_probability);
        if !self.is_whole {
            diagnosis.account.notes.push(UNFINISHED.into());
        }
        let used = shown.iter().find(|(_, doubt)| !doubt.is_left_out());
        if let Some((recording, doubt)) = used {
            lead(diagnosis, recording, doubt);
        }
    }
}

/// Makes the answer one about the data.
fn lead(diagnosis: &mut Diagnosis, recording: &str, doubt: &Doubt) {
    let physics = 1.0 - doubt.probability;
    for finding in &mut diagnosis.findings {
        finding.probability *= physics;
    }
    for claim in &mut diagnosis.claims {
        claim.probability *= physics;
    }
    for candidate in &mut diagnosis.candidates {
        candidate.probability *= physics;
    }
    diagnosis.candidates.push(Candidate {
        probability: doubt.probability,
        ..super::answer::candidates::empty(Subject::Data)
    });
    let by_probability = |a: &Candidate, b: &Candidate| b.probability.total_cmp(&a.probability);
    diagnosis.candidates.sort_by(by_probability);
    let otherwise = std::mem::take(&mut diagnosis.statement);
    let otherwise = match (otherwise.is_empty(), diagnosis.insufficient) {
        (true, _) => String::new(),
        (false, Some(Insufficient::TimeUp)) => format!(" {otherwise}"),
        (false, _) => format!(" If the data are right: {otherwise}"),
    };
    diagnosis.statement = format!("{recording}: {}.{otherwise}", doubt.remedy);
    diagnosis.verdict = Verdict::Sensor;
    diagnosis.insufficient = None;
    diagnosis.leading = None;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::{DiagnosisError, Options, insufficient};
    use crate::effects::Effects;
    use crate::inspection::Span;
    use crate::terrain::Terrain;
    use crate::vehicle::Specification;

    /// A diagnosis with doubts of these kinds and probabilities, frozen ones left out.
    fn doubted(doubts: &[(DoubtKind, f64)]) -> Diagnosis {
        let nominal = Specification {
            vehicle: Vehicle::tran2007(),
            terrain: Terrain::preset("dry_sand").unwrap(),
            effects: Effects::default(),
        };
        let span = Span {
            run: 0,
            start: 0.0,
            end: 1.0,
        };
        let error = DiagnosisError::OutOfTime;
        let mut diagnosis = insufficient(&[], &nominal, &Options::default(), &error);
        let doubts = doubts.iter().map(|(kind, probability)| Doubt {
            kind: *kind,
            channels: Vec::new(),
            span: None,
            probability: *probability,
            left_out: if *kind == DoubtKind::Frozen {
                vec![span]
            } else {
                Vec::new()
            },
            evidence: String::new(),
            remedy: String::new(),
        });
        let each = vec![("drive".into(), doubts.collect())];
        let is_whole = true;
        Doubts { each, is_whole }.put_before(&mut diagnosis);
        diagnosis
    }

    #[test]
    fn every_doubt_has_its_place() {
        let found = doubted(&[
            (DoubtKind::Frozen, 0.97),
            (DoubtKind::Jump, 0.3),
            (DoubtKind::Quantised, 0.4),
            (DoubtKind::Source, 0.3),
        ]);
        assert_eq!(found.verdict, Verdict::InsufficientData);
        let minor: Vec<DoubtKind> = found.minor_doubts.iter().map(|doubt| doubt.kind).collect();
        assert_eq!(minor, [DoubtKind::Quantised, DoubtKind::Jump]);
        let is_data = |one: &&Caution| matches!(one, Caution::DoubtfulData { .. });
        assert_eq!(found.cautions.iter().filter(is_data).count(), 1);
        // A probable doubt about data that are used is the verdict.
        let found = doubted(&[(DoubtKind::Jump, 0.6), (DoubtKind::Quantised, 0.4)]);
        assert_eq!(found.verdict, Verdict::Sensor);
        assert_eq!(found.minor_doubts.len(), 1);
    }
}
