//! Recordings from the files that the user names: tables, or robots' logs.

use super::failure::Failure;
use crate::import::{self, ImportOptions, Preset};
use crate::recording::{ColumnRequest, Recording, read_recording_with, recording_of_table};
use crate::vehicle::Vehicle;
use std::path::Path;

/// Reads a recording. A robot's log is imported with the options; notes say what was taken from where. A known vehicle of
/// the options is the recording's, unless the JSON file beside the log has one.
pub fn read(
    path: &Path,
    vehicle: Option<&Vehicle>,
    columns: &[ColumnRequest],
    options: &ImportOptions,
) -> Result<(Recording, Vec<String>), Failure> {
    if !import::is_log(path) {
        return Ok((read_recording_with(path, vehicle, columns)?, Vec::new()));
    }
    let survey = import::survey(path, &mut |_, _| {})?;
    let imported = import::import(path, &survey, options, &mut |_, _| {})?;
    let mut table = Vec::new();
    imported
        .write_csv(&mut table)
        .map_err(Failure::read(path))?;
    let preset = options.preset.map(Preset::vehicle);
    let mut recording = recording_of_table(path, &table, vehicle.or(preset.as_ref()))?;
    if let Some(preset) = preset {
        recording.about.vehicle.get_or_insert(preset);
    }
    recording.about.import_warnings = imported.warnings().map(Into::into).collect();
    let columns = imported.columns.iter().map(|column| {
        format!(
            "{} from {}: {}",
            column.name, column.topic, column.conversion
        )
    });
    let from = format!(
        "note: imported by itself ({}; --topics, --left, --right, --invert and --pose choose otherwise)",
        columns.collect::<Vec<_>>().join("; ")
    );
    let notes = std::iter::once(from).chain(imported.notes);
    let name = &recording.name;
    let named = |note: String| match note.split_once(": ") {
        Some((kind @ ("note" | "warning"), text)) => format!("{kind}: {name}: {text}"),
        _ => format!("{name}: {note}"),
    };
    let notes = notes.map(named).collect();
    Ok((recording, notes))
}
