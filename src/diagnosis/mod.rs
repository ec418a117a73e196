//! Diagnosis: which physics a model leaves out, found from recordings.

mod answer;
mod caution;
mod diagnose;
mod doubts;
mod error;
mod hypothesis;
mod manoeuvre;
mod outcome;
mod progress;
mod screening;
mod search;

pub use answer::words::phrase;
pub use caution::Caution;
pub use diagnose::{diagnose, insufficient};
pub use error::DiagnosisError;
pub use outcome::{
    Account, Candidate, Channel, Claim, ClaimLevel, Compared, Diagnosis, Errors, Finding, HeldOut,
    Insufficient, Interval, Manoeuvre, PredictedPath, Quantity, ResidualTrace, RunTrace, Subject,
    Term, Verdict, WrenchTrace,
};
pub use progress::{Progress, Step};

/// Options of a diagnosis.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Length of a segment \[s\]. Segments are shortened, down to 5 s, to have six of them; 10 s of driving or more
    /// are cut into at least four.
    pub segment: f64,
    /// Seed of everything random.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            segment: 7.5,
            seed: 1,
        }
    }
}

#[cfg(test)]
mod testing;
