//! Progress and time limit of a diagnosis.
//!
//! Work falls into three phases with a deadline each. The first screening (segments, refitted soil, score tests) may
//! use all of the time: without it there is no answer. The search ends early enough for the answer, by the measured
//! cost of a pass over the recordings. The answer ends at [`ANSWER`] of the limit; the rest is for the reports.

use super::DiagnosisError;
use crate::fit::deadline::{Deadline, Watch};
use crate::fit::predictor::PredictionError;
use std::fmt;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// The steps of a diagnosis, each with its work. The search repeats some work, as the noise's estimate beside each
/// accepted effect; it then belongs to the later step, so that the number of the step never decreases.
const STEPS: [(&str, &[&str]); 7] = [
    (
        "reading the recordings, doubts about the data",
        &["preparing the recordings", "doubts about the data"],
    ),
    ("first fit of the soil", &["refitting the soil"]),
    (
        "screening all candidates",
        &[
            "sensitivities to every candidate",
            "estimating the noise",
            "screening and scanning for regions",
        ],
    ),
    ("fitting the likeliest candidates", &["fitting candidates"]),
    (
        "further effects and rivals",
        &[
            "fitting further candidates",
            "removing redundant effects",
            "refitting close rivals",
        ],
    ),
    (
        "errors on held-out data, verdict",
        &["held-out comparison", "posterior and verdict"],
    ),
    (
        "next manoeuvre, results",
        &["ranking next manoeuvres", "collecting results"],
    ),
];

/// A step of a diagnosis, at the start of some work of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// Its number, from 1. It never decreases.
    pub number: usize,
    /// Number of all steps.
    pub count: usize,
    /// The step.
    pub name: &'static str,
    /// The work that starts.
    pub work: &'static str,
}

impl Step {
    /// The step of some work, not before another one.
    fn of(work: &'static str, before: usize) -> Self {
        let own = STEPS.iter().position(|(_, all)| all.contains(&work));
        debug_assert!(own.is_some(), "{work} belongs to no step");
        let place = own.unwrap_or(0).max(before);
        Self {
            number: place + 1,
            count: STEPS.len(),
            name: STEPS[place].0,
            work,
        }
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            number,
            count,
            name,
            ..
        } = self;
        write!(f, "step {number} of {count}: {name}")
    }
}

/// Share of a time limit by which the answer is computed.
const ANSWER: f64 = 0.95;
/// Maximum share of the limit that is reserved for the answer.
const MAX_RESERVED: f64 = 0.4;

/// Reports all work at its start, and records its duration.
pub struct Progress<'a> {
    report: &'a (dyn Fn(Step) + Sync),
    /// Index of the current step.
    place: AtomicUsize,
    steps: Mutex<Vec<(&'static str, Duration)>>,
    stop: Option<&'a AtomicBool>,
    clock: Clock<'a>,
    limit: Option<Duration>,
    reserved: Mutex<Duration>,
    pass: Mutex<Duration>,
    was_late: AtomicBool,
}

/// The source of time.
enum Clock<'a> {
    Real(Instant),
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "tests count work instead of time")
    )]
    Counted(&'a (dyn Fn() -> Duration + Sync)),
}

impl<'a> Progress<'a> {
    /// Reports all work through `report`. A time limit counts from here.
    #[must_use]
    pub fn new(report: &'a (dyn Fn(Step) + Sync)) -> Self {
        Self {
            report,
            place: AtomicUsize::new(0),
            steps: Mutex::new(Vec::new()),
            stop: None,
            clock: Clock::Real(Instant::now()),
            limit: None,
            reserved: Mutex::new(Duration::ZERO),
            pass: Mutex::new(Duration::ZERO),
            was_late: AtomicBool::new(false),
        }
    }

    /// Ends the diagnosis within this time, counted from [`Progress::new`], with the answer found so far; its
    /// [cautions](super::Diagnosis::cautions) say so. Where the limit is met, the answer depends on the machine.
    #[must_use]
    pub fn within(mut self, limit: Duration) -> Self {
        self.limit = Some(limit);
        self
    }

    /// Ends the diagnosis with [`DiagnosisError::Stopped`] soon after `stop` is true; `report` may set it, or another
    /// thread.
    #[must_use]
    pub fn stopped_by(mut self, stop: &'a AtomicBool) -> Self {
        self.stop = Some(stop);
        self
    }

    /// Replaces the clock.
    #[cfg(test)]
    pub(crate) fn by_clock(mut self, clock: &'a (dyn Fn() -> Duration + Sync)) -> Self {
        self.clock = Clock::Counted(clock);
        self
    }

    /// Time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        match self.clock {
            Clock::Real(start) => start.elapsed(),
            Clock::Counted(clock) => clock(),
        }
    }

    /// The time limit, if any.
    pub(crate) fn limit(&self) -> Option<Duration> {
        self.limit
    }

    /// Reserves time for the answer.
    pub(crate) fn reserve(&self, wanted: Duration) {
        if let (Ok(mut reserved), Some(limit)) = (self.reserved.lock(), self.limit) {
            *reserved = wanted.min(limit.mul_f64(MAX_RESERVED));
        }
    }

    /// Records the duration of a pass over the recordings.
    pub(crate) fn measured(&self, took: Duration) {
        if let Ok(mut pass) = self.pass.lock() {
            *pass = took;
        }
    }

    /// Duration of passes over the recordings.
    pub(crate) fn passes(&self, count: u32) -> Duration {
        count * self.pass.lock().map_or(Duration::ZERO, |pass| *pass)
    }

    /// Deadline of the answer.
    pub(crate) fn answer_deadline(&self) -> Deadline<'_> {
        Deadline::new(self, self.answer_end())
    }

    /// Deadline of the search.
    pub(crate) fn search_deadline(&self) -> Deadline<'_> {
        Deadline::new(self, self.search_end())
    }

    /// Deadline at a share of the remaining search time.
    pub(crate) fn share_of_search(&self, share: f64) -> Deadline<'_> {
        let end = match self.limit {
            None => Duration::MAX,
            Some(_) => {
                let now = self.elapsed();
                now + self.search_end().saturating_sub(now).mul_f64(share)
            }
        };
        Deadline::new(self, end)
    }

    fn answer_end(&self) -> Duration {
        self.limit
            .map_or(Duration::MAX, |limit| limit.mul_f64(ANSWER))
    }

    fn search_end(&self) -> Duration {
        let reserved = self.reserved.lock().map_or(Duration::ZERO, |kept| *kept);
        self.answer_end().saturating_sub(reserved)
    }

    /// Whether the search must end.
    pub(crate) fn is_late(&self) -> bool {
        self.search_deadline().is_over()
    }

    /// Whether the search has less time than this; then the caller skips the work.
    pub(crate) fn lacks(&self, time: Duration) -> bool {
        let lacks = self.limit.is_some() && self.elapsed() + time > self.search_end();
        if lacks {
            self.was_late.store(true, Ordering::Relaxed);
        }
        lacks
    }

    /// Whether work was cut short or skipped.
    pub(crate) fn was_late(&self) -> bool {
        self.was_late.load(Ordering::Relaxed)
    }

    /// Whether somebody wants it to end.
    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// The next work.
    ///
    /// # Errors
    /// The caller wants it to end.
    pub(crate) fn step(&self, name: &'static str) -> Result<(), DiagnosisError> {
        let step = Step::of(name, self.place.load(Ordering::Relaxed));
        self.place.store(step.number - 1, Ordering::Relaxed);
        (self.report)(step);
        if let Ok(mut steps) = self.steps.lock() {
            steps.push((name, self.elapsed()));
        }
        self.go_on()
    }

    /// # Errors
    /// The caller wants it to end.
    pub(crate) fn go_on(&self) -> Result<(), DiagnosisError> {
        if self.is_stopped() {
            Err(DiagnosisError::Stopped)
        } else {
            Ok(())
        }
    }

    /// After work until a deadline: whether it was done.
    ///
    /// # Errors
    /// The caller wants it to end, or time was up.
    pub(crate) fn in_time(&self, deadline: Deadline) -> Result<(), DiagnosisError> {
        self.go_on()?;
        if deadline.is_over() {
            Err(DiagnosisError::OutOfTime)
        } else {
            Ok(())
        }
    }

    /// The error of a fit that cannot start.
    pub(crate) fn failure(&self, error: PredictionError) -> DiagnosisError {
        match (self.go_on(), error) {
            (Err(stopped), _) => stopped,
            (_, PredictionError::OutOfTime) => DiagnosisError::OutOfTime,
            (_, error) => DiagnosisError::Undrivable(error),
        }
    }

    /// Seconds of every step, in the order of their first start; steps of one name are summed.
    #[must_use]
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        let Ok(steps) = self.steps.lock() else {
            return Vec::new();
        };
        let ends = steps.iter().skip(1).map(|(_, start)| *start);
        let ends = ends.chain(std::iter::once(self.elapsed()));
        let mut all: Vec<(&'static str, f64)> = Vec::new();
        for ((name, start), end) in steps.iter().zip(ends) {
            let seconds = end.saturating_sub(*start).as_secs_f64();
            match all.iter_mut().find(|(other, _)| other == name) {
                Some((_, sum)) => *sum += seconds,
                None => all.push((name, seconds)),
            }
        }
        all
    }
}

impl Watch for Progress<'_> {
    fn is_over(&self, end: Duration) -> bool {
        let is_late = end < Duration::MAX && self.elapsed() >= end;
        if is_late {
            self.was_late.store(true, Ordering::Relaxed);
        }
        is_late || self.is_stopped()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::testing::{driven, first, on};
    use crate::diagnosis::{Caution, Diagnosis, Insufficient, Options, Verdict, diagnose};
    use crate::recording::Recording;

    use crate::vehicle::Specification;
    use std::sync::atomic::AtomicU32;

    /// One reading of the clock. The tests' clock counts its readings, one for each step of the integrator
    /// in each prediction.
    const TICK: Duration = Duration::from_millis(1);

    /// The answer within this number of readings, and the readings used.
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
    fn repeated_work_belongs_to_the_later_step() {
        let seen = Mutex::new(Vec::new());
        let report = |step: Step| seen.lock().unwrap().push(step.to_string());
        let progress = Progress::new(&report);
        for work in [
            "preparing the recordings",
            "screening and scanning for regions",
            "refitting the soil",
            "collecting results",
            "doubts about the data",
        ] {
            progress.step(work).unwrap();
        }
        let numbers = seen.lock().unwrap();
        let numbers: Vec<&str> = numbers.iter().map(|line| &line[..11]).collect();
        assert_eq!(numbers, [1, 3, 3, 7, 7].map(|n| format!("step {n} of 7")));
    }

    #[test]
    fn all_work_is_reported_in_order() {
        let seen = Mutex::new(Vec::new());
        let report = |step: Step| seen.lock().unwrap().push(step);
        let recordings = [first(&driven(&on("sandy_loam"), "spiral"), 12.0)];
        let progress = Progress::new(&report);
        diagnose(&recordings, &on("dry_sand"), &Options::default(), &progress).unwrap();
        let seen = seen.lock().unwrap();
        assert!(seen.is_sorted_by_key(|step| step.number));
        let mut numbers: Vec<usize> = seen.iter().map(|step| step.number).collect();
        numbers.dedup();
        assert_eq!(numbers, (1..=STEPS.len()).collect::<Vec<_>>());
        assert!(
            seen.iter()
                .all(|step| STEPS.iter().any(|(_, all)| all.contains(&step.work)))
        );
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
                    // "Nothing missing" requires that all candidates were fitted.
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
            // A distant limit makes the work read the clock.
            let progress = progress.within(TICK * u32::MAX);
            let found = diagnose(&recordings, &on("dry_sand"), &Options::default(), &progress);
            assert_eq!(found.err(), Some(DiagnosisError::Stopped));
            let after = ticks.load(Ordering::Relaxed) - until;
            assert!(after < 2000, "{after} after {until}");
        }
    }
}
