//! The packaged FMU: its library, its header, its numbers beside the Rust library's.

#[path = "../common/skipped.rs"]
mod skipped;

mod endurance;
mod fmpy_equivalence;
mod header;
mod lean;
mod random_calls;
mod support;
