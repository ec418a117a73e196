//! Recordings as CSV: one header line, then numbers in SI units; an empty cell of a measured
//! column is a missing sample. Columns stand in any order, and others may stand among them.

mod drive;
mod error;
mod poses;
mod samples;
mod table;

pub use drive::read_drive;
pub(super) use error::malformed;
pub use error::{Cell, CsvError};
pub use poses::read_poses;
pub(super) use samples::{RawRun, Sample, Samples, read_samples};
pub use table::read_bytes;

/// Marks separate drives, each with its own clock.
const RUN: &str = "run";
