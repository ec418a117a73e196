//! CSV files: one header line, then numbers in SI units. An empty cell of a measured column is a missing sample. Columns
//! stand in any order, and unknown columns are ignored.

mod drive;
mod error;
mod poses;
mod samples;
mod table;

pub use drive::read_drive;
pub(super) use error::malformed;
pub use error::{Cell, CsvError};
pub use poses::read_poses;
pub(super) use samples::{Occurrences, RawRun, RawSample, RawSamples, read_samples};
pub use table::read_bytes;
