//! What was measured on a drive: series of samples, each channel with times of its own.
//!
//! [`Recording`] is one file: its runs, what the JSON beside it tells of vehicle and sensors,
//! and notes on everything that the reader changed. [`Drive`] is what a simulation needs of it:
//! both wheel speeds over common times. Frames and signs are those of [`crate::vehicle`].

mod about;
mod channel;
mod course;
#[cfg(feature = "analysis")]
mod csv;
mod cumulated;
mod drive;
mod fault;
mod moments;
mod note;
#[cfg(feature = "analysis")]
mod reading;
mod run;
mod series;
mod smoothing;
mod way;

pub use about::About;
pub use channel::Channel;
pub use course::Course;
#[cfg(feature = "analysis")]
pub use csv::{Cell, CsvError, read_bytes, read_drive, read_poses};
pub use cumulated::{Cumulated, Grid, longest_interval, stretches};
pub use drive::{Drive, fill_gaps};
pub use fault::{RecordingFault, SameName, SeriesFault, different_names};
pub use moments::Moments;
pub use note::{Note, NoteKind};
#[cfg(feature = "analysis")]
pub use reading::{RecordingError, read_recording, read_recording_of};
pub use run::{Recording, Run};
pub use series::{Series, upper_median};
pub use way::way_along;
