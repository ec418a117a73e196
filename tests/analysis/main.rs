//! Recordings, fits, scores, diagnoses and their reports.

#[path = "../common/formats.rs"]
mod formats;
#[path = "../common/measured.rs"]
mod measured;
#[path = "../common/skipped.rs"]
mod skipped;

mod baselines;
mod diagnosis;
mod fit;
mod identification;
mod recordings;
mod report;
mod single_wheel;
