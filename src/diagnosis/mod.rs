//! What physics did the model leave out?

mod outcome;

pub use outcome::{
    Account, Candidate, Channel, Diagnosis, Errors, Finding, HeldOut, Interval, Manoeuvre,
    Quantity, ResidualTrace, RunTrace, Subject, Term, Verdict, WrenchTrace,
};
