//! Recordings from the files that the user names: tables, or robots' logs.

use super::failure::Failure;
use crate::import::{self, ImportOptions};
use crate::recording::{ColumnRequest, Recording, read_recording_with, recording_of_table};
use crate::vehicle::Vehicle;
use std::path::Path;

/// Reads a recording. A robot's log is imported without options; notes say what was taken from where.
pub fn read(
    path: &Path,
    vehicle: Option<&Vehicle>,
    columns: &[ColumnRequest],
) -> Result<(Recording, Vec<String>), Failure> {
    if !import::is_log(path) {
        return Ok((read_recording_with(path, vehicle, columns)?, Vec::new()));
    }
    let survey = import::survey(path, &mut |_, _| {})?;
    let imported = import::import(path, &survey, &ImportOptions::default(), &mut |_, _| {})?;
    let mut table = Vec::new();
    imported
        .write_csv(&mut table)
        .map_err(Failure::read(path))?;
    let mut recording = recording_of_table(path, &table, vehicle)?;
    recording.about.import_warnings = imported.warnings().map(Into::into).collect();
    let columns = imported.columns.iter().map(|column| {
        format!(
            "{} from {}: {}",
            column.name, column.topic, column.conversion
        )
    });
    let from = format!(
        "imported by itself ({}; options of `ugv import` choose otherwise)",
        columns.collect::<Vec<_>>().join("; ")
    );
    let notes = std::iter::once(from).chain(imported.notes);
    let notes = notes
        .map(|note| format!("{}: {note}", recording.name))
        .collect();
    Ok((recording, notes))
}
