//! How far a diagnosis has come.

use super::DiagnosisError;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Share of a time limit after which only what an answer needs is done: looking at what was found, leaving out,
/// holding out, and reporting take up to two fifths of what comes before.
const LATE: f64 = 0.6;

/// Tells of every step that begins, and keeps how long each took.
pub struct Progress<'a> {
    tell: &'a (dyn Fn(&'static str) + Sync),
    steps: Mutex<Vec<(&'static str, Instant)>>,
    stop: Option<&'a AtomicBool>,
    begin: Instant,
    late: Option<Duration>,
    was_late: AtomicBool,
}

impl<'a> Progress<'a> {
    /// Tells of steps by `tell`.
    #[must_use]
    pub fn new(tell: &'a (dyn Fn(&'static str) + Sync)) -> Self {
        Self {
            tell,
            steps: Mutex::new(Vec::new()),
            stop: None,
            begin: Instant::now(),
            late: None,
            was_late: AtomicBool::new(false),
        }
    }

    /// Has the diagnosis give the answer that it has come to within about this time: after three fifths of it, what has
    /// not begun is left out, and the answer says so. It depends on the machine then.
    #[must_use]
    pub fn within(mut self, limit: Duration) -> Self {
        self.late = Some(limit.mul_f64(LATE));
        self
    }

    /// Whether what an answer does not need is to be left out, for want of time. Whoever asks leaves it out.
    pub(crate) fn is_late(&self) -> bool {
        let is_late = self.late.is_some_and(|late| self.begin.elapsed() >= late);
        if is_late {
            self.was_late.store(true, Ordering::Relaxed);
        }
        is_late
    }

    /// Whether something was left out for want of time.
    pub(crate) fn was_late(&self) -> bool {
        self.was_late.load(Ordering::Relaxed)
    }

    /// Ends the diagnosis with [`DiagnosisError::Stopped`] within seconds after `stop` has become true; `tell` may
    /// set it, or another thread.
    #[must_use]
    pub fn stopped_by(mut self, stop: &'a AtomicBool) -> Self {
        self.stop = Some(stop);
        self
    }

    /// Whether somebody wants it to end.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// The next step begins.
    ///
    /// # Errors
    /// Somebody wants it to end.
    pub(crate) fn step(&self, name: &'static str) -> Result<(), DiagnosisError> {
        (self.tell)(name);
        if let Ok(mut steps) = self.steps.lock() {
            steps.push((name, Instant::now()));
        }
        if self.is_stopped() {
            Err(DiagnosisError::Stopped)
        } else {
            Ok(())
        }
    }

    /// Seconds that every step took, those of one name together, in the order of their first turns.
    #[must_use]
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        let Ok(steps) = self.steps.lock() else {
            return Vec::new();
        };
        let ends = steps.iter().skip(1).map(|(_, begin)| *begin);
        let ends = ends.chain(std::iter::once(Instant::now()));
        let mut all: Vec<(&'static str, f64)> = Vec::new();
        for ((name, begin), end) in steps.iter().zip(ends) {
            let seconds = (end - *begin).as_secs_f64();
            match all.iter_mut().find(|(other, _)| other == name) {
                Some((_, sum)) => *sum += seconds,
                None => all.push((name, seconds)),
            }
        }
        all
    }
}
