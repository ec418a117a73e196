//! What physics did the model leave out?

mod account;
mod ambiguity;
mod candidate;
mod contest;
mod course;
mod diagnose;
mod error;
mod errors;
mod findings;
mod held_out;
mod hypothesis;
mod law;
mod likelihood;
mod load;
mod locate;
mod manoeuvre;
mod maps;
mod naming;
mod noise;
mod outcome;
mod part;
mod path;
mod prepare;
mod progress;
mod proposal;
mod prune;
mod refitted;
mod regime;
mod rehearsal;
mod scan;
mod scout;
mod screen;
mod search;
mod sensitivity;
mod separation;
mod stage;
mod system;
mod traces;
mod verdict;
mod words;
mod wrench;

pub use diagnose::{diagnose, insufficient};
pub use error::DiagnosisError;
pub use outcome::{
    Account, Candidate, Channel, Diagnosis, Errors, Finding, HeldOut, Interval, Manoeuvre,
    Quantity, ResidualTrace, RunTrace, Subject, Term, Verdict, WrenchTrace,
};
pub use progress::Progress;
pub use words::phrase;

/// How to diagnose.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Length of a segment \[s\].
    pub segment: f64,
    /// Seed of everything random.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            segment: 5.0,
            seed: 1,
        }
    }
}
