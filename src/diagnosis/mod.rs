//! What physics did the model leave out?

mod candidate;
mod hypothesis;
mod likelihood;
mod outcome;
mod sensitivity;

pub use outcome::{
    Account, Candidate, Channel, Diagnosis, Errors, Finding, HeldOut, Interval, Manoeuvre,
    Quantity, ResidualTrace, RunTrace, Subject, Term, Verdict, WrenchTrace,
};
