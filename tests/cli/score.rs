//! `ugv score`: models judged by recordings.

use super::*;
use serde_json::Value;
use std::fmt::Write;

/// A drive of kinematics with r = 0.23 m and a track of 2 m, pose at 10 Hz, gyro at 20 Hz.
fn drive(seconds: f64) -> String {
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0);
    let mut text = String::from("time,omega_left,omega_right,x,y,heading,yaw_rate\n");
    for k in 0..=(seconds / 0.05) as usize {
        let time = 0.05 * k as f64;
        let turn: f64 = 1.2 * (0.83 * time).sin() + 0.8 * (1.37 * time + 1.0).sin();
        let (left, right): (f64, f64) = (4.0 - turn, 4.0 + turn);
        let yaw_rate = 0.23 * (right - left) / 2.0;
        let pose = if k % 2 == 0 {
            format!("{x},{y},{heading}")
        } else {
            ",,".into()
        };
        let _ = writeln!(text, "{time:.2},{left},{right},{pose},{yaw_rate}");
        heading += 0.05 * yaw_rate;
        x += 0.05 * 0.23 * 4.0 * heading.cos();
        y += 0.05 * 0.23 * 4.0 * heading.sin();
    }
    text
}

/// A recording, and its vehicle beside it.
fn write(bench: &Bench, name: &str, seconds: f64) {
    bench.write(&format!("{name}.csv"), drive(seconds));
    vehicle(bench, name);
}

fn vehicle(bench: &Bench, name: &str) {
    let vehicle = bench.stdout("vehicle");
    bench.write(
        &format!("{name}.json"),
        format!("{{\"vehicle\": {vehicle}}}"),
    );
}

fn json(bench: &Bench, arguments: &str) -> Value {
    serde_json::from_str(&bench.stdout(arguments)).unwrap()
}

fn model<'a>(recording: &'a Value, name: &str) -> &'a Value {
    let mut models = recording["models"].as_array().unwrap().iter();
    models.find(|model| model["model"] == name).unwrap()
}

#[test]
fn fitted_kinematics_predict_a_kinematic_world() {
    let bench = Bench::new();
    write(&bench, "world", 120.0);
    let score = json(&bench, "score world.csv --terrain dry_sand --json -");
    assert_eq!(score["format"], "ugv-score/1");
    formats::assert_documented(&score);
    assert_eq!(score["pooled"], Value::Null);
    let recording = &score["recordings"][0];
    let two = model(recording, "two_parameter");
    let track = &two["parameters"]["track_m"];
    assert!(
        (track["value"].as_f64().unwrap() - 2.0).abs() < 0.02,
        "{track}"
    );
    let of_track = |bound: &str| track[bound].as_f64().unwrap();
    assert!(of_track("low") < of_track("value") && of_track("value") < of_track("high"));
    assert!(of_track("high") - of_track("low") < 0.02, "{track}");
    let median = |name| {
        model(recording, name)["position_m"]["median"]["value"]
            .as_f64()
            .unwrap()
    };
    assert!(
        median("two_parameter") < 0.02,
        "{}",
        median("two_parameter")
    );
    assert!(median("no_slip") > 0.2, "{}", median("no_slip"));
    for name in ["three_parameter", "nominal_soil", "given_model"] {
        assert!(median(name).is_finite(), "{name}");
        assert_eq!(model(recording, name)["failed"], 0, "{name}");
    }
    let description = model(recording, "nominal_soil")["description"]
        .as_str()
        .unwrap();
    assert_contains(description, "clayed_soil by default");
    assert_eq!(
        model(recording, "given_model")["description"],
        "terrain dry_sand"
    );
}

#[test]
fn the_table_has_every_model() {
    let bench = Bench::new();
    write(&bench, "a", 40.0);
    write(&bench, "b", 50.0);
    let table = bench.stdout("score a.csv b.csv --json score.json");
    for word in [
        "a: ",
        "b: ",
        "no_slip",
        "two_parameter",
        "three_parameter",
        "nominal_soil",
        "median [m]",
        "latency removed: pose 0.0",
        "All 2 recordings",
    ] {
        assert_contains(&table, word);
    }
    assert!(!table.contains("given_model"), "{table}");
    let score: Value = serde_json::from_str(&bench.read("score.json")).unwrap();
    assert_eq!(score["pooled"].as_array().unwrap().len(), 4);
    assert_eq!(
        bench.files(),
        [
            "a.csv",
            "a.json",
            "b.csv",
            "b.json",
            "drive.csv",
            "score.json"
        ]
    );
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let bench = Bench::new();
    write(&bench, "a", 40.0);
    write(&bench, "b", 31.0);
    let with = |threads: &str| {
        let mut command = bench.ugv("score a.csv b.csv --terrain dry_sand --json -");
        command
            .env("RAYON_NUM_THREADS", threads)
            .assert()
            .success()
            .get_output()
            .stdout
            .clone()
    };
    assert!(with("1") == with("3"));
}

#[test]
fn vehicle_and_terrain_beside_the_recording_are_nominal() {
    let bench = Bench::new();
    write(&bench, "a", 30.0);
    let vehicle = bench.stdout("vehicle");
    bench.write(
        "a.json",
        format!("{{\"vehicle\": {vehicle}, \"terrain\": \"dry_clay\"}}"),
    );
    let score = json(&bench, "score a.csv --json -");
    let nominal = model(&score["recordings"][0], "nominal_soil");
    assert_eq!(nominal["description"], "the recording's vehicle, dry_clay");
}

#[test]
fn without_a_vehicle_beside_the_recording_all_models_have_the_given_one() {
    let bench = Bench::new();
    bench.write("a.csv", drive(30.0));
    let narrow = bench.stdout("vehicle").replace("0.61,", "0.5,");
    bench.write("narrow.json", &narrow);
    let score = json(&bench, "score a.csv --vehicle narrow.json --json -");
    let recording = &score["recordings"][0];
    let description = |name| model(recording, name)["description"].as_str().unwrap();
    assert_eq!(
        description("no_slip"),
        "r = 0.25 m, track = 1 m of the vehicle"
    );
    assert!(description("nominal_soil").starts_with("the given vehicle"));
}

#[test]
fn a_model_that_was_fitted_to_the_windows_causes_a_warning() {
    let bench = Bench::new();
    write(&bench, "a", 40.0);
    let fit = "fit a.csv --free friction_angle --sensors none --starts 0";
    bench.stdout(&format!("{fit} --output whole.json"));
    bench.stdout(&format!("{fit} --half --output half.json"));
    let score = |model: &str| {
        let mut command = bench.ugv(&format!("score a.csv --model {model}"));
        let output = command.unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (text(output.stdout), text(output.stderr))
    };
    let (table, warning) = score("whole.json");
    assert_contains(&warning, "fitted to all of a");
    assert_contains(&table, "fitted to these windows too");
    let (table, warning) = score("half.json");
    assert!(!warning.contains("fitted"), "{warning}");
    assert!(!table.contains("fitted to these windows"), "{table}");
    // Other windows overlap with the half of the fit.
    for other in ["--horizon 2", "--spacing 1", "--heading gyro"] {
        let (_, warning) = score(&format!("half.json {other}"));
        assert_contains(&warning, "fitted to one half of a");
    }
    // Of several drives every second one is judged, however they are cut.
    let drive = drive(40.0);
    let rows = |run: u8| {
        let rows = drive.lines().skip(1);
        rows.map(move |row| format!("{run},{row}\n"))
    };
    let header = drive.lines().next().unwrap();
    let rows: String = rows(1).chain(rows(2)).collect();
    bench.write("b.csv", format!("run,{header}\n{rows}"));
    vehicle(&bench, "b");
    bench.stdout(&format!(
        "{} --half --output half.json --force",
        fit.replace("a.csv", "b.csv")
    ));
    let warning = bench
        .ugv("score b.csv --model half.json --spacing 1")
        .unwrap()
        .stderr;
    let warning = String::from_utf8(warning).unwrap();
    assert!(!warning.contains("fitted to one half"), "{warning}");
}

#[test]
fn windows_that_fail_are_counted() {
    let bench = Bench::new();
    write(&bench, "a", 30.0);
    let soil = bench.stdout("terrains dry_sand");
    let mut soft: Value = serde_json::from_str(&soil).unwrap();
    soft["frictional_modulus"] = 1e3.into();
    bench.write("soft.json", soft.to_string());
    let score = json(&bench, "score a.csv --terrain soft.json --json -");
    let recording = &score["recordings"][0];
    let given = model(recording, "given_model");
    assert_eq!(given["failed"], recording["judged"]);
    assert!(
        given["first_failure"].as_str().unwrap().contains("bogged"),
        "{given}"
    );
    assert_eq!(given["position_m"], Value::Null);
    // The others are judged all the same.
    assert_eq!(recording["counted"], recording["judged"]);
    assert!(model(recording, "no_slip")["position_m"].is_object());
    let table = bench.stdout("score a.csv --terrain soft.json");
    assert!(
        table.contains("no prediction") && table.contains("bogged"),
        "{table}"
    );
    // A model that is lost in one recording alone is missed in the table of all; failures are summed.
    write(&bench, "b", 40.0);
    let table = bench.stdout("score a.csv b.csv --terrain soft.json");
    let pooled = &table[table.find("All 2 recordings").unwrap()..];
    for name in ["a", "b"] {
        assert_contains(pooled, &format!("no prediction of {name}\n"));
    }
    let score = json(&bench, "score a.csv b.csv --terrain soft.json --json -");
    assert_eq!(score["pooled"][0]["failed"], 0, "{}", score["pooled"]);
}

#[test]
fn a_preset_is_no_file_that_would_be_overwritten() {
    let bench = Bench::new();
    write(&bench, "a", 30.0);
    bench.stdout("score a.csv --terrain dry_sand --json dry_sand.json");
    let again = bench.fails(
        "score a.csv --terrain dry_sand.json --json dry_sand.json",
        2,
    );
    assert_contains(&again, "dry_sand.json is an input file");
}

#[test]
fn short_recordings_are_judged_without_a_fit() {
    let bench = Bench::new();
    write(&bench, "a", 9.0);
    let score = json(&bench, "score a.csv --json -");
    let recording = &score["recordings"][0];
    assert_eq!(recording["fitted"], 0);
    let two = model(recording, "two_parameter");
    assert!(
        two["description"]
            .as_str()
            .unwrap()
            .starts_with("not fitted"),
        "{two}"
    );
    let median = &model(recording, "no_slip")["position_m"]["median"];
    // One piece of the drive gives no interval.
    assert!(
        median["value"].is_number() && median["low"].is_null(),
        "{median}"
    );
}

#[test]
fn what_cannot_be_judged_is_refused() {
    let bench = Bench::new();
    write(&bench, "a", 8.0);
    bench.write(
        "still.csv",
        "time,omega_left,omega_right,x,y,heading\n0,0,0,0,0,0\n\
        0.5,0,0,0,0,0\n1,0,0,0,0,0\n1.5,0,0,0,0,0\n2,0,0,0,0,0\n2.5,0,0,0,0,0\n",
    );
    for name in ["drive", "still"] {
        vehicle(&bench, name);
    }
    for (arguments, expected) in [
        ("score drive.csv", "drive: no sample of x, y, heading"),
        ("score a.csv --horizon 9", "less than the horizon of 9 s"),
        ("score a.csv --horizon 0", "horizon = 0: it must be between"),
        (
            "score a.csv --spacing=-1",
            "spacing = -1: it must be between",
        ),
        ("score a.csv --horizon NaN", "horizon = NaN"),
        ("score still.csv --horizon 1", "the vehicle stands still"),
        (
            "score still.csv --horizon 1 --heading gyro",
            "still has no yaw_rate",
        ),
        ("score none.csv", "none.csv"),
        ("score a.csv --terrain sand", "no preset terrain"),
        ("score", "REC.csv"),
    ] {
        let error = bench.fails(arguments, 2);
        assert_contains(&error, expected);
    }
    let error = bench.fails("score a.csv --json nowhere/score.json", 1);
    assert_contains(&error, "cannot write nowhere/score.json");
}
