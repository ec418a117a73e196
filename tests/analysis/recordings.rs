//! The reader on every recording of the data folder.

use crate::measured::data;
use std::path::{Path, PathBuf};
use ugv_terrain::inspection::{Delay, MotionSignal, Quality, inspect};
use ugv_terrain::recording::{Channel, NoteKind, Recording, read_recording};

fn all(folder: &str) -> Vec<Recording> {
    let Some(data) = data("") else {
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

/// The warnings on a recording whose columns have other names.
fn warnings_after(path: &Path, rename: &[(&str, &str)]) -> Vec<NoteKind> {
    let text = std::fs::read_to_string(path).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let renamed = header.split(',').map(|name| {
        let other = rename.iter().find(|(from, _)| *from == name);
        other.map_or(name, |(_, to)| to)
    });
    let header = renamed.collect::<Vec<_>>().join(",");
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy.csv");
    std::fs::write(&copy, format!("{header}\n{rows}")).unwrap();
    let notes = read_recording(&copy).unwrap().notes;
    let warnings = notes.into_iter().filter(|note| note.kind.is_warning());
    warnings.map(|note| note.kind).collect()
}

#[test]
fn swapped_columns_of_real_recordings_are_seen() {
    const WHEELS: [(&str, &str); 2] =
        [("omega_left", "omega_right"), ("omega_right", "omega_left")];
    let Some(data) = data("") else { return };
    for name in [
        "c05_warthog_grass_2024-07-29_1404",
        "c10_warthog_grass_2024-08-08_1619",
        "s08_warthog_gravel",
    ] {
        let path = data.join(format!("recordings/{name}.csv"));
        let found = warnings_after(&path, &WHEELS);
        assert_eq!(found, [NoteKind::SwappedWheels], "{name}");
        // What is not there cannot vote.
        let found = warnings_after(&path, &[WHEELS[0], WHEELS[1], ("yaw_rate", "other")]);
        assert_eq!(found, [NoteKind::SwappedWheels], "{name}");
    }
    // Where it slides a lot, as on gravel at 4 m/s, the direction of travel proves nothing.
    for name in [
        "c05_warthog_grass_2024-07-29_1404",
        "c10_warthog_grass_2024-08-08_1619",
    ] {
        let path = data.join(format!("recordings/{name}.csv"));
        let found = warnings_after(&path, &[("x", "y"), ("y", "x")]);
        assert_eq!(found, [NoteKind::SwappedPosition], "{name}");
    }
}

#[test]
fn delays_of_real_recordings_are_those_known_of_them() {
    for recording in all("recordings") {
        let (name, inspection) = (&recording.name, inspect(&recording, None));
        let behind_gyro = |of: MotionSignal| -> &Delay {
            let mut pairs = inspection.delays.iter();
            let found = pairs
                .find(|delay| delay.pair.of == of && delay.pair.behind == MotionSignal::YawRate);
            found.expect("every recording has wheels, pose and gyro")
        };
        assert!(
            inspection.delays.iter().all(|delay| !delay.contradicts),
            "{name}"
        );
        let wheels = behind_gyro(MotionSignal::WheelDifference);
        if !name.contains("ice") {
            assert_eq!(wheels.quality, Quality::Clear, "{name}");
            assert!(
                (0.1..0.2).contains(&wheels.seconds.value),
                "{name}: {:?}",
                wheels.seconds
            );
        }
        let pose = behind_gyro(MotionSignal::Heading);
        assert_ne!(pose.quality, Quality::Unknown, "{name}");
        assert!(
            (0.2..0.8).contains(&pose.seconds.value),
            "{name}: {:?}",
            pose.seconds
        );
    }
}
