//! The diagnosis of drives whose truth is known.

#![cfg(feature = "cli")]

mod cases;

use cases::{Family, generate, write};
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use ugv_terrain::recording::{Channel, read_recording};

/// Texts of all files of a case by their names.
fn written(family: Family, seed: u64) -> HashMap<String, String> {
    let folder = tempfile::tempdir().unwrap();
    let case = generate(family, 1, seed).unwrap();
    write(&case, folder.path(), "a").unwrap();
    let mut texts = HashMap::new();
    let mut read = |folder: &Path| {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                let name = path.file_name().unwrap().to_string_lossy().into_owned();
                texts.insert(name, fs::read_to_string(path).unwrap());
            }
        }
    };
    read(folder.path());
    read(&folder.path().join("a"));
    texts
}

#[test]
fn cases_follow_from_their_seed() {
    let first = written(Family::Local, 7);
    assert_eq!(first.len(), 5);
    assert_eq!(first, written(Family::Local, 7));
    assert_ne!(first["drive.csv"], written(Family::Local, 8)["drive.csv"]);
}

#[test]
fn cases_are_recordings_as_they_stand() {
    let folder = tempfile::tempdir().unwrap();
    for (family, number) in Family::sequence(9) {
        let case = generate(family, number, 3).unwrap();
        write(&case, folder.path(), "a").unwrap();
        let recording = read_recording(&folder.path().join("a/drive.csv")).unwrap();
        assert!(recording.about.vehicle.is_some() && recording.about.terrain.is_some());
        let notes = &recording.notes;
        assert!(notes.is_empty(), "{} {notes:?}", family.name());
        let run = &recording.runs[0];
        assert!((39.0..91.0).contains(&run.duration()));
        for channel in [Channel::X, Channel::Heading, Channel::YawRate] {
            assert!(run.series(channel).is_some_and(|series| series.len() > 300));
        }
        let truth = fs::read_to_string(folder.path().join("a.truth.json")).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
        assert_eq!(truth["family"], family.name());
        assert!(
            truth["expected"]
                .as_array()
                .is_some_and(|all| !all.is_empty())
        );
    }
}

#[test]
fn a_set_holds_every_family() {
    let sequence = Family::sequence(50);
    for (family, share) in Family::ALL {
        let count = sequence.iter().filter(|(one, _)| *one == family).count();
        assert_eq!(count, share, "{}", family.name());
        assert_eq!(Family::find(family.name()), Some(family));
    }
}
