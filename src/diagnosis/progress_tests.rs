//! Time limits, by a clock that counts how often it is asked: once for each row of wheel speeds in each prediction.

use super::*;
use crate::diagnosis::hypothesis::prepare::tests::first;
use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
use crate::diagnosis::{Caution, Diagnosis, Insufficient, Options, Verdict, diagnose};
use crate::recording::Recording;
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};
use std::sync::atomic::AtomicU32;

/// A tick of the clock.
const TICK: Duration = Duration::from_millis(1);

fn on(soil: &str) -> Specification {
    Specification::plain(Vehicle::tran2007(), Terrain::preset(soil).unwrap())
}

/// The answer within so many ticks, and the ticks that it took.
fn within(
    recordings: &[Recording],
    nominal: &Specification,
    limit: Option<u32>,
) -> (Result<Diagnosis, DiagnosisError>, u32) {
    let ticks = AtomicU32::new(0);
    let clock = || TICK * ticks.fetch_add(1, Ordering::Relaxed);
    let mut progress = Progress::new(&|_| ()).by_clock(&clock);
    if let Some(limit) = limit {
        progress = progress.within(TICK * limit);
    }
    let answer = diagnose(recordings, nominal, &Options::default(), &progress);
    (answer, ticks.load(Ordering::Relaxed))
}

#[test]
fn an_answer_comes_in_time() {
    let nominal = on("dry_sand");
    let recordings = [first(&driven(&on("sandy_loam"), "spiral"), 15.0)];
    let (whole, _) = within(&recordings, &nominal, None);
    let whole = whole.unwrap();
    let (unhurried, all) = within(&recordings, &nominal, Some(u32::MAX));
    let mut unhurried = unhurried.unwrap();
    assert!(unhurried.cautions.is_empty());
    unhurried.account.steps.clone_from(&whole.account.steps);
    assert!(format!("{unhurried:?}") == format!("{whole:?}"));
    let mut last = None;
    for share in [0, 20, 300, 600] {
        let limit = all / 1000 * share;
        let (answer, took) = within(&recordings, &nominal, Some(limit));
        assert!(took <= limit + limit / 10 + 2000, "{took} of {limit}");
        last = Some(match answer {
            Err(error) => {
                assert_eq!(error, DiagnosisError::OutOfTime);
                assert!(last.is_none(), "more time, less of an answer: {share}");
                continue;
            }
            Ok(answer) => {
                assert!(answer.cautions.contains(&Caution::TimeUp));
                // That nothing is missing can only be said of what was tried.
                assert_ne!(answer.verdict, Verdict::NothingMissing);
                let silent = answer.findings.is_empty();
                assert_eq!(silent, answer.insufficient == Some(Insufficient::TimeUp));
                share
            }
        });
    }
    assert!(last.is_some());
}

#[test]
fn work_ends_soon_after_somebody_wants_it_to() {
    let recordings = [first(&driven(&on("sandy_loam"), "spiral"), 20.0)];
    let (ticks, stop) = (AtomicU32::new(0), AtomicBool::new(false));
    for until in [0, 100, 3000, 15_000] {
        ticks.store(0, Ordering::Relaxed);
        stop.store(false, Ordering::Relaxed);
        let clock = || {
            let now = ticks.fetch_add(1, Ordering::Relaxed);
            stop.fetch_or(now >= until, Ordering::Relaxed);
            TICK * now
        };
        let progress = Progress::new(&|_| ()).by_clock(&clock).stopped_by(&stop);
        // A limit that is far off has the clock asked.
        let progress = progress.within(TICK * u32::MAX);
        let found = diagnose(&recordings, &on("dry_sand"), &Options::default(), &progress);
        assert_eq!(found.err(), Some(DiagnosisError::Stopped));
        let after = ticks.load(Ordering::Relaxed) - until;
        assert!(after < 2000, "{after} after {until}");
    }
}
