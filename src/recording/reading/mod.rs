//! From a file to a [`Recording`]: what is unambiguous is put right and noted, what is not is
//! refused with its place.

mod agreement;
mod clock;
mod error;
mod limits;
mod order;
mod signs;
mod turns;
mod units;

pub use error::RecordingError;

use super::csv::{Samples, read_bytes, read_samples};
use super::{About, Channel, CsvError, Note, NoteKind, Recording, Run, Series};
use crate::display::shortened;
use crate::json;
use crate::vehicle::Vehicle;
use std::fs::File;
use std::io;
use std::path::Path;

/// Reads `NAME.csv`, and `NAME.json` beside it where there is one.
///
/// # Errors
/// Files that cannot be read, and the first thing that makes them no recording.
pub fn read_recording(path: &Path) -> Result<Recording, RecordingError> {
    read_recording_of(path, None)
}

/// The same of a known vehicle, which tells units of wheel speeds where `NAME.json` tells none.
///
/// # Errors
/// As [`read_recording`].
pub fn read_recording_of(
    path: &Path,
    vehicle: Option<&Vehicle>,
) -> Result<Recording, RecordingError> {
    let file = path.display().to_string();
    let opened = File::open(path).map_err(|source| CsvError::Read {
        file: file.clone(),
        source,
    })?;
    let bytes = read_bytes(&file, opened)?;
    let about = read_about(&path.with_extension("json"))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(parse_recording(&file, &name, &bytes, about, vehicle)?)
}

fn read_about(path: &Path) -> Result<About, RecordingError> {
    let file = || path.display().to_string();
    match json::read_file(path) {
        Ok(text) => About::from_json(&text).map_err(|source| RecordingError::About {
            file: file(),
            source,
        }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(About::default()),
        Err(source) => Err(RecordingError::Csv(CsvError::Read {
            file: file(),
            source,
        })),
    }
}

/// Makes a recording from the text of a file.
fn parse_recording(
    file: &str,
    name: &str,
    bytes: &[u8],
    about: About,
    vehicle: Option<&Vehicle>,
) -> Result<Recording, CsvError> {
    let mut samples = read_samples(file, bytes)?;
    let mut notes = words(&samples);
    notes.extend(misnamed(&samples));
    notes.extend(restarts(&samples));
    notes.extend(order::settle(&mut samples)?);
    notes.extend(clock::to_seconds(&mut samples)?);
    notes.extend(clock::drop_strays(&mut samples));
    notes.extend(limits::drop_outliers(&mut samples, limits::ANY_UNIT));
    notes.extend(limits::drop_leaps(&mut samples));
    notes.extend(limits::drop_strays(&mut samples));
    notes.extend(units::convert(
        &mut samples,
        about.vehicle.as_ref().or(vehicle),
    ));
    notes.extend(limits::drop_outliers(&mut samples, 1.0));
    limits::check(&samples)?;
    notes.extend(signs::settle(&mut samples));
    notes.extend(turns::unwrap(&mut samples));
    let runs = samples.runs.iter().map(|raw| {
        let run = Run::new(raw.label.clone());
        Channel::ALL.into_iter().fold(run, |run, channel| {
            let samples = raw.channels[channel.index()].iter();
            let series: Series = samples.map(|sample| (sample.time, sample.value)).collect();
            run.with(channel, series)
        })
    });
    Ok(Recording {
        name: name.into(),
        runs: runs.collect(),
        about,
        notes,
    })
}

/// A note on something that happened, if it did: number of places, and the first one's line.
fn note(
    kind: NoteKind,
    channel: Option<Channel>,
    (count, line): (usize, usize),
    text: String,
) -> Option<Note> {
    (count > 0).then_some(Note {
        kind,
        channel,
        count,
        line,
        text,
    })
}

/// Number of a channel's samples, and the first one's line.
fn place(samples: &Samples, channel: Channel) -> (usize, usize) {
    let first = samples.of(channel).next().map_or(0, |sample| sample.line);
    (samples.of(channel).count(), first)
}

/// Cells that say that there is no number.
fn words(samples: &Samples) -> Vec<Note> {
    let of = |channel: Channel| {
        let (count, line) = samples.words[channel.index()]?;
        let text = format!("{count} cells say nan or the like; taken as missing");
        note(NoteKind::NotANumber, Some(channel), (count, line), text)
    };
    Channel::ALL.into_iter().filter_map(of).collect()
}

fn misnamed(samples: &Samples) -> Vec<Note> {
    let of = |(channel, name): &(Channel, String)| {
        let text = format!(
            "there is none, but a column `{}`, which is not read; name it `{}`",
            shortened(name),
            channel.name()
        );
        note(NoteKind::Suspicion, Some(*channel), (1, 1), text)
    };
    samples.misnamed.iter().filter_map(of).collect()
}

fn restarts(samples: &Samples) -> Option<Note> {
    let (count, line) = samples.restarts?;
    let text = format!("starts anew {count} times under the same run; taken as runs of their own");
    note(NoteKind::Restarted, None, (count, line), text)
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod test_drive;

#[cfg(test)]
mod repair_tests;

#[cfg(test)]
mod unit_tests;
