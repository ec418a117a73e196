//! `ugv diagnose` on recordings of the independent generator (`tests/cases`); `scripts/prove.sh` judges many more.

use serde_json::Value;
use std::fs;
use std::path::Path;

/// The tool's answer to a case: standard output, and the folder with its files.
fn diagnose(case: &str, within: &str) -> (String, tempfile::TempDir) {
    let drive = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let drive = drive.join(case).join("drive.csv");
    let folder = tempfile::tempdir().unwrap();
    let output = assert_cmd::Command::new(env!("CARGO_BIN_EXE_ugv"))
        .current_dir(folder.path())
        .arg("diagnose")
        .arg(drive)
        .args(["--output", ".", "--within", within])
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    (String::from_utf8(output.stdout).unwrap(), folder)
}

fn json(folder: &tempfile::TempDir, name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.path().join(name)).unwrap()).unwrap()
}

/// Whether the answer and its report have the caution that time was up.
fn is_cut_short(folder: &tempfile::TempDir) -> bool {
    let is_cut_short = json(folder, "diagnosis.json")
        .to_string()
        .contains("ime was up");
    let report = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert_eq!(is_cut_short, report.contains("ime was up"));
    is_cut_short
}

#[test]
fn a_steep_slope_is_named_and_measured() {
    let (text, folder) = diagnose("slope", "100000");
    assert!(text.contains("grade"), "{text}");
    let answer = json(&folder, "diagnosis.json");
    assert_eq!(answer["verdict"], "missing_physics");
    let finding = &answer["findings"][0];
    assert_eq!(finding["effect"], "grade");
    // The mended model has what was found and nothing else.
    let model = json(&folder, "model.json");
    let effects: Vec<&String> = model["effects"].as_object().unwrap().keys().collect();
    assert_eq!(effects, ["grade"]);
    for (name, truth) in [("slope_east", -0.07928), ("slope_north", 0.05502)] {
        let [low, high] =
            ["low", "high"].map(|end| finding["parameters"][name][end].as_f64().unwrap());
        assert!(
            low <= truth && truth <= high && high - low < 0.05,
            "{finding:#}"
        );
    }
    let candidates = answer["candidates"].as_array().unwrap().iter();
    let sum: f64 = candidates
        .map(|one| one["probability"].as_f64().unwrap())
        .sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    assert!(!is_cut_short(&folder));
}

#[test]
fn without_time_there_is_no_verdict() {
    for case in ["slope", "nothing"] {
        let (_, folder) = diagnose(case, "0.001");
        let answer = json(&folder, "diagnosis.json");
        assert_eq!(answer["verdict"], "insufficient_data", "{answer:#}");
        assert_eq!(answer["findings"].as_array().map(Vec::len), Some(0));
        assert!(is_cut_short(&folder));
    }
}
