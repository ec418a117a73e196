//! The diagnosis of drives whose truth is known.

mod cases;
mod suite;
mod told;

use cases::{Family, generate, generate_lasting, write};
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

/// One of what the suite has a hundred of.
#[test]
fn a_steep_slope_is_named_and_measured() {
    let folder = tempfile::tempdir().unwrap();
    let case = generate_lasting([18.0, 20.0], Family::Single, 32, 1).unwrap();
    write(&case, folder.path(), "a").unwrap();
    assert_cmd::Command::new(env!("CARGO_BIN_EXE_ugv"))
        .current_dir(folder.path().join("a"))
        .args([
            "diagnose",
            "drive.csv",
            "--out",
            "out",
            "--within",
            "100000",
        ])
        .assert()
        .success()
        .stdout(predicates::str::contains("grade"));
    let read = |path: &str| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(folder.path().join(path)).unwrap()).unwrap()
    };
    let (said, truth) = (read("a/out/diagnosis.json"), read("a.truth.json"));
    assert_eq!(said["verdict"], "missing_physics");
    // A limit that is not met leaves no trace.
    assert!(!said.to_string().contains("ime was up"));
    let finding = &said["findings"][0];
    assert_eq!(finding["effect"], "grade");
    // The mended model has what was found and nothing else.
    let model = read("a/out/model.json");
    let effects: Vec<&String> = model["effects"].as_object().unwrap().keys().collect();
    assert_eq!(effects, ["grade"]);
    for name in ["slope_east", "slope_north"] {
        let [low, high] =
            ["low", "high"].map(|end| finding["parameters"][name][end].as_f64().unwrap());
        let true_slope = truth["effects"][0]["parameters"][name].as_f64().unwrap();
        assert!(
            low <= true_slope && true_slope <= high && high - low < 0.05,
            "{finding:#}"
        );
    }
    let candidates = said["candidates"].as_array().unwrap().iter();
    let sum: f64 = candidates
        .map(|one| one["probability"].as_f64().unwrap())
        .sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
}

/// Verdict, names, and whether the answer says that time was up.
fn within(family: Family, seconds: &str) -> (String, Vec<String>, bool) {
    let folder = tempfile::tempdir().unwrap();
    let case = generate_lasting([18.0, 20.0], family, 32, 1).unwrap();
    write(&case, folder.path(), "a").unwrap();
    assert_cmd::Command::new(env!("CARGO_BIN_EXE_ugv"))
        .current_dir(folder.path().join("a"))
        .args(["diagnose", "drive.csv", "--within", seconds])
        .assert()
        .success();
    let read = |name: &str| {
        let path = folder.path().join("a/diagnosis").join(name);
        fs::read_to_string(path).unwrap()
    };
    let told: serde_json::Value = serde_json::from_str(&read("diagnosis.json")).unwrap();
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_string();
    let findings = told["findings"].as_array().unwrap().iter();
    let names = findings.map(|one| text(&one["effect"])).collect();
    let is_told = told.to_string().contains("ime was up");
    assert_eq!(is_told, read("report.html").contains("ime was up"));
    (text(&told["verdict"]), names, is_told)
}

#[test]
fn without_time_there_is_no_verdict() {
    for family in [Family::Single, Family::Nothing] {
        let (verdict, names, is_told) = within(family, "0.001");
        assert_eq!(verdict, "insufficient_data", "{names:?}");
        assert!(names.is_empty() && is_told);
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
