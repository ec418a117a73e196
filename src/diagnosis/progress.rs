//! How far a diagnosis is, and when it has to end.
//!
//! Work falls into three phases with a deadline each. The first look (cut, refit the soil, screen) may take all of the
//! time: without it there is no answer. The search ends early enough for the answer, by what a pass over the recordings was
//! measured to cost. The answer itself ends at [`ANSWER`] of the limit; the rest is for the reports.

use super::DiagnosisError;
use crate::fit::deadline::{Deadline, Watch};
use crate::fit::predictor::PredictionError;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Share of a time limit by which the answer is computed.
const ANSWER: f64 = 0.95;
/// The answer takes no more than this share of the limit from the search.
const MOST_RESERVED: f64 = 0.4;

/// Reports every step when it starts, and keeps how long each took.
pub struct Progress<'a> {
    tell: &'a (dyn Fn(&'static str) + Sync),
    steps: Mutex<Vec<(&'static str, Duration)>>,
    stop: Option<&'a AtomicBool>,
    clock: Clock<'a>,
    limit: Option<Duration>,
    reserved: Mutex<Duration>,
    pass: Mutex<Duration>,
    was_late: AtomicBool,
}

/// What counts the time.
enum Clock<'a> {
    Real(Instant),
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "tests count work instead of time")
    )]
    Counted(&'a (dyn Fn() -> Duration + Sync)),
}

impl<'a> Progress<'a> {
    /// Reports steps by `tell`. A time limit counts from here.
    #[must_use]
    pub fn new(tell: &'a (dyn Fn(&'static str) + Sync)) -> Self {
        Self {
            tell,
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

    /// Ends the diagnosis with [`DiagnosisError::Stopped`] soon after `stop` has become true; `tell` may set it, or
    /// another thread.
    #[must_use]
    pub fn stopped_by(mut self, stop: &'a AtomicBool) -> Self {
        self.stop = Some(stop);
        self
    }

    /// Counts time by another clock.
    #[cfg(test)]
    pub(crate) fn by_clock(mut self, clock: &'a (dyn Fn() -> Duration + Sync)) -> Self {
        self.clock = Clock::Counted(clock);
        self
    }

    /// Time since the beginning.
    pub(crate) fn elapsed(&self) -> Duration {
        match self.clock {
            Clock::Real(begin) => begin.elapsed(),
            Clock::Counted(clock) => clock(),
        }
    }

    /// Where there is a time limit: what it is.
    pub(crate) fn limit(&self) -> Option<Duration> {
        self.limit
    }

    /// Keeps so much of the time for the answer.
    pub(crate) fn reserve(&self, wanted: Duration) {
        if let (Ok(mut reserved), Some(limit)) = (self.reserved.lock(), self.limit) {
            *reserved = wanted.min(limit.mul_f64(MOST_RESERVED));
        }
    }

    /// A pass over the recordings takes so long.
    pub(crate) fn measured(&self, took: Duration) {
        if let Ok(mut pass) = self.pass.lock() {
            *pass = took;
        }
    }

    /// So many passes over the recordings.
    pub(crate) fn passes(&self, count: u32) -> Duration {
        count * self.pass.lock().map_or(Duration::ZERO, |pass| *pass)
    }

    /// When the answer has to be there.
    pub(crate) fn answer_deadline(&self) -> Deadline<'_> {
        Deadline::new(self, self.answer_end())
    }

    /// When the search has to end.
    pub(crate) fn search_deadline(&self) -> Deadline<'_> {
        Deadline::new(self, self.search_end())
    }

    /// When so large a share of the time that the search still has is over.
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

    /// Whether the search has to end.
    pub(crate) fn is_late(&self) -> bool {
        self.search_deadline().is_over()
    }

    /// Whether the search has less time than this; where it has, what takes as long is left out.
    pub(crate) fn lacks(&self, time: Duration) -> bool {
        let lacks = self.limit.is_some() && self.elapsed() + time > self.search_end();
        if lacks {
            self.was_late.store(true, Ordering::Relaxed);
        }
        lacks
    }

    /// Whether something was ended or left out for want of time.
    pub(crate) fn was_late(&self) -> bool {
        self.was_late.load(Ordering::Relaxed)
    }

    /// Whether somebody wants it to end.
    fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// The next step.
    ///
    /// # Errors
    /// Somebody wants it to end.
    pub(crate) fn step(&self, name: &'static str) -> Result<(), DiagnosisError> {
        (self.tell)(name);
        if let Ok(mut steps) = self.steps.lock() {
            steps.push((name, self.elapsed()));
        }
        self.go_on()
    }

    /// # Errors
    /// Somebody wants it to end.
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
    /// Somebody wants it to end, or time was up.
    pub(crate) fn in_time(&self, deadline: Deadline) -> Result<(), DiagnosisError> {
        self.go_on()?;
        if deadline.is_over() {
            Err(DiagnosisError::OutOfTime)
        } else {
            Ok(())
        }
    }

    /// Why there is no fit to begin with.
    pub(crate) fn failure(&self, error: PredictionError) -> DiagnosisError {
        match (self.go_on(), error) {
            (Err(stopped), _) => stopped,
            (_, PredictionError::OutOfTime) => DiagnosisError::OutOfTime,
            (_, error) => DiagnosisError::Undrivable(error),
        }
    }

    /// Seconds that every step took, those of one name together, in the order of their first turns.
    #[must_use]
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        let Ok(steps) = self.steps.lock() else {
            return Vec::new();
        };
        let ends = steps.iter().skip(1).map(|(_, begin)| *begin);
        let ends = ends.chain(std::iter::once(self.elapsed()));
        let mut all: Vec<(&'static str, f64)> = Vec::new();
        for ((name, begin), end) in steps.iter().zip(ends) {
            let seconds = end.saturating_sub(*begin).as_secs_f64();
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
#[path = "progress_tests.rs"]
mod tests;
