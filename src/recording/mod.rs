//! Measurements of a drive: a series of samples per channel, each with the times of its samples.
//!
//! [`Recording`] is one file: its runs, the metadata from the JSON file beside it, and notes on every change that the
//! reader made. [`Drive`] is the input of a simulation: both wheel speeds over common times. Frames and signs are those
//! of [`crate::vehicle`].

mod about;
mod by_sides;
mod channel;
mod csv;
mod cumulated;
mod drive;
mod fault;
mod note;
mod pose_history;
mod reading;
mod run;
mod series;
mod smoothing;
mod statistics;

pub use about::About;
#[cfg(feature = "cli")]
pub(crate) use about::IMPORT_WARNING;
pub(crate) use by_sides::{BySides, SideMotion};
pub use channel::Channel;
pub use csv::{
    Cell, ColumnRequest, CsvError, FoundColumns, TableOptions, read_bytes, read_drive,
    read_drive_of, read_poses,
};
pub use cumulated::{Cumulated, TimeGrid, longest_interval, stretches};
pub(crate) use cumulated::{DELAY_STEP, SENSOR_DELAYS};
pub use drive::Drive;
pub use fault::{RecordingFault, SameName, SeriesFault, different_names};
pub use note::{Note, NoteKind};
pub use pose_history::{PoseHistory, distance_along_heading};
pub use reading::{
    RecordingError, read_recording, read_recording_of, read_recording_with, recording_of_table,
};
pub use run::{Recording, Run};
pub use series::Series;
pub use statistics::{
    IntervalEstimate, Moments, SplitMix64, median, nearest_rank, quantile, upper_median,
};
pub(crate) use statistics::{MIN_BLOCKS, range};
