//! The reader on every recording of the data folder.

#![cfg(feature = "cli")]

use std::io::Write;
use std::path::{Path, PathBuf};
use ugv_terrain::recording::{Channel, NoteKind, Recording, read_recording};

/// The folder of measured data: `UGV_DATA`, or beside the project.
fn data() -> Option<PathBuf> {
    let named = std::env::var_os("UGV_DATA").map(PathBuf::from);
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folder = named.unwrap_or_else(beside);
    if !folder.is_dir() {
        let place = folder.display();
        let message = format!("SKIPPED: there is no {place}; UGV_DATA names another folder");
        // Past the test harness, which would swallow it.
        writeln!(std::io::stderr(), "{message}").expect("stderr can be written");
        return None;
    }
    Some(folder)
}

fn all(folder: &str) -> Vec<Recording> {
    let Some(data) = data() else {
        return Vec::new();
    };
    let entries = std::fs::read_dir(data.join(folder)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "csv"));
    paths.sort();
    assert!(paths.len() >= 7, "{paths:?}");
    let read = |path: &PathBuf| read_recording(path).unwrap_or_else(|error| panic!("{error}"));
    paths.iter().map(read).collect()
}

#[test]
fn good_recordings_are_read_as_they_are() {
    let recordings = all("recordings").into_iter().chain(all("multibody"));
    for recording in recordings {
        let name = &recording.name;
        // Wrapped headings and clocks that start anew are what these files have.
        for note in &recording.notes {
            let known = matches!(note.kind, NoteKind::Unwrapped | NoteKind::Restarted);
            assert!(known, "{name}: {note}");
        }
        assert!(recording.about.vehicle.is_some(), "{name}");
        let steps = name.starts_with('s') && name.contains("warthog");
        let runs = match name.contains("ice") {
            true => 46,
            false if steps => 100,
            false => 1,
        };
        assert_eq!(recording.runs.len(), runs, "{name}");
        for run in &recording.runs {
            for channel in [Channel::X, Channel::Heading, Channel::YawRate] {
                assert!(run.series(channel).is_some(), "{name}: {channel}");
            }
            let heading = run.series(Channel::Heading).unwrap();
            let jumps = heading
                .value
                .windows(2)
                .map(|pair| (pair[1] - pair[0]).abs());
            assert!(jumps.fold(0.0, f64::max) < 3.2, "{name}");
        }
    }
}
