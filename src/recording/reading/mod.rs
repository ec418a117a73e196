//! From a file to a [`Recording`]: unambiguous faults are corrected and noted, others are refused with their place.

mod agreement;
mod clock;
mod limits;
mod order;
mod signs;
mod turns;
mod units;

use super::about::About;
use super::channel::Channel;
use super::csv::{ColumnRequest, CsvError, RawSamples, TableOptions, read_bytes, read_samples};
use super::note::NoteKind;
use super::run::{Recording, Run};
use crate::json::{self, JsonError};
use crate::vehicle::Vehicle;
use std::fs::File;
use std::io;
use std::path::Path;
use thiserror::Error;

/// Why a file, or the JSON file beside it, is no recording.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The measurements, or a file that cannot be read.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The metadata.
    #[error("{file}: {error}")]
    About {
        /// Name of the file.
        file: String,
        /// Its fault.
        error: JsonError,
    },
}

/// Reads `NAME.csv`, and `NAME.json` beside it if it exists.
///
/// # Errors
/// Files that cannot be read, and the first fault that makes them no recording.
pub fn read_recording(path: &Path) -> Result<Recording, RecordingError> {
    read_recording_of(path, None)
}

/// The same for a known vehicle, whose wheel radius shows the units of wheel speeds if `NAME.json` has no vehicle.
///
/// # Errors
/// As [`read_recording`].
pub fn read_recording_of(
    path: &Path,
    vehicle: Option<&Vehicle>,
) -> Result<Recording, RecordingError> {
    read_recording_with(path, vehicle, &[])
}

/// The same with columns that the user names.
///
/// # Errors
/// As [`read_recording`], and a named column that the file lacks.
pub fn read_recording_with(
    path: &Path,
    vehicle: Option<&Vehicle>,
    columns: &[ColumnRequest],
) -> Result<Recording, RecordingError> {
    let file = path.display().to_string();
    let opened = File::open(path).map_err(|source| CsvError::Read {
        file: file.clone(),
        source,
    })?;
    let bytes = read_bytes(&file, opened)?;
    let about = read_about(&path.with_extension("json"))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(parse_recording(
        &file, &name, &bytes, about, vehicle, columns,
    )?)
}

/// Makes a recording of the text of a table that was made from a log, and of `NAME.json` beside the log if it exists.
///
/// # Errors
/// As [`read_recording`].
pub fn recording_of_table(
    log: &Path,
    table: &[u8],
    vehicle: Option<&Vehicle>,
) -> Result<Recording, RecordingError> {
    let about = read_about(&log.with_extension("json"))?;
    let name = log.file_stem().unwrap_or_default().to_string_lossy();
    let file = log.display().to_string();
    Ok(parse_recording(&file, &name, table, about, vehicle, &[])?)
}

fn read_about(path: &Path) -> Result<About, RecordingError> {
    let file = path.display().to_string();
    match json::read_file(path) {
        Ok(text) => About::from_json(&text).map_err(|error| RecordingError::About { file, error }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(About::default()),
        Err(source) => Err(CsvError::Read { file, source }.into()),
    }
}

/// Makes a recording from the text of a file.
fn parse_recording(
    file: &str,
    name: &str,
    bytes: &[u8],
    about: About,
    vehicle: Option<&Vehicle>,
    columns: &[ColumnRequest],
) -> Result<Recording, CsvError> {
    let known = about.vehicle.as_ref().or(vehicle);
    let options = TableOptions {
        columns,
        wheel_radius: known.map(|vehicle| vehicle.wheel_radius),
    };
    let mut samples = read_samples(file, bytes, &options)?;
    note_oddities(&mut samples);
    order::settle(&mut samples)?;
    clock::to_seconds(&mut samples)?;
    clock::drop_strays(&mut samples);
    limits::drop_outliers(&mut samples, limits::ANY_UNIT);
    limits::drop_leaps(&mut samples);
    limits::drop_strays(&mut samples);
    units::convert(&mut samples, about.vehicle.as_ref().or(vehicle));
    limits::drop_outliers(&mut samples, 1.0);
    limits::check(&samples)?;
    signs::settle(&mut samples);
    turns::unwrap(&mut samples);
    let runs = samples.runs.iter().map(|raw| {
        let run = Run::new(raw.label.clone());
        Channel::ALL
            .into_iter()
            .fold(run, |run, channel| run.with(channel, raw.series(channel)))
    });
    Ok(Recording {
        name: name.into(),
        runs: runs.collect(),
        about,
        notes: samples.notes,
    })
}

/// Notes words for missing numbers and clocks that restart.
fn note_oddities(samples: &mut RawSamples) {
    for channel in Channel::ALL {
        let words = samples.words[channel.index()];
        let text = format!(
            "{} cells say nan or the like; taken as missing",
            words.count
        );
        samples.note(NoteKind::NotANumber, Some(channel), words, text);
    }
    let restarts = samples.restarts;
    let text = format!(
        "starts anew {} times under the same run; taken as separate runs",
        restarts.count
    );
    samples.note(NoteKind::Restarted, None, restarts, text);
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod test_drive;
