//! What physics did the model leave out?

mod answer;
mod caution;
mod diagnose;
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
    Account, Candidate, Channel, Diagnosis, Errors, Finding, HeldOut, Insufficient, Interval,
    Manoeuvre, Quantity, ResidualTrace, RunTrace, Subject, Term, Verdict, WrenchTrace,
};
pub use progress::Progress;

/// How to diagnose.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Length of a segment \[s\]. Where driving makes fewer than six, they are shorter, though not than 5 s; where 10 s or
    /// more make fewer than four of these, they are cut into four.
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
