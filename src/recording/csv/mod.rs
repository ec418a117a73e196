//! CSV files as programs and people write them: a header, then numbers, in SI units unless the header or the user names
//! another. An empty cell of a measured column is a missing sample. Columns stand in any order. Every column that is taken
//! under another name is noted; other columns are ignored.

mod calendar;
mod drive;
mod error;
mod layout;
mod naming;
mod poses;
mod request;
mod samples;
mod table;
mod unit;

pub use drive::{read_drive, read_drive_of};
pub(super) use error::malformed;
pub use error::{Cell, CsvError, FoundColumns};
pub use poses::read_poses;
pub use request::{ColumnRequest, TableOptions};
pub(super) use samples::{Occurrences, RawRun, RawSample, RawSamples, read_samples};
pub use table::read_bytes;
