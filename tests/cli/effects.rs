//! Model files and effects.

use super::*;
use predicates::prelude::*;
use predicates::str::contains;
use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects};
use ugv_terrain::vehicle::{Specification, Vehicle};

const SLOPE: &str = r#"{"grade": {"slope_east": 0.08}, "payload": {"mass": 60}}"#;

#[test]
fn the_list_names_every_effect_and_parameter() {
    let list = Bench::new().stdout("effects");
    for effect in CATALOGUE {
        assert!(list.contains(&format!("  {}: lifts {}", effect.name, effect.lifts)));
        for declared in effect.parameters {
            let line = list
                .lines()
                .find(|line| line.contains(declared.description))
                .unwrap();
            assert_contains(line, declared.name);
        }
    }
    for expected in [
        "-0.3 to 0.3 rad",
        "off at 2000000",
        "default 16000",
        "Measurement",
    ] {
        assert!(list.contains(expected), "{expected}");
    }
}

#[test]
fn an_effect_is_explained_and_printed_as_a_file_that_works() {
    let bench = Bench::new();
    let explanation = contains("equation: F = -k |V| V")
        .and(contains("source: quadratic drag"))
        .and(contains(
            "0 to 1000 N s^2/m^2, off at 0; prior when on 10 */ ",
        ));
    let assert = bench
        .ugv("effects drag grade")
        .assert()
        .success()
        .stderr(explanation);
    bench.write("effects.json", &assert.get_output().stdout);
    let effects = Effects::from_json(&bench.read("effects.json")).unwrap();
    let names: Vec<&str> = effects
        .on(EffectKind::Physics)
        .map(|effect| effect.name)
        .collect();
    assert_eq!(names, ["grade", "drag"]);
    let summary = contains("as fast as real time, effects: grade, drag\n");
    let assert = bench
        .ugv("simulate --input drive.csv --effects effects.json")
        .assert()
        .success()
        .stderr(summary);
    let plain = bench.stdout("simulate --input drive.csv");
    assert_ne!(assert.get_output().stdout, plain.as_bytes());
    let plain_again = bench.ugv("simulate --input drive.csv").assert();
    let summary = String::from_utf8(plain_again.get_output().stderr.clone()).unwrap();
    assert!(!summary.contains("effects"), "{summary}");
}

#[test]
fn a_model_file_is_vehicle_terrain_and_effects() {
    let bench = Bench::new();
    bench.write("effects.json", SLOPE);
    bench.write(
        "mine.json",
        bench.stdout("vehicle").replace("490.0", "470.0"),
    );
    let parts = "--vehicle mine.json --terrain dry_sand --effects effects.json";
    bench.write("model.json", bench.stdout(&format!("model {parts}")));
    let model = Specification::from_json(&bench.read("model.json")).unwrap();
    assert_eq!(model.vehicle.mass, 470.0);
    assert_eq!(model.effect_names(), ["grade", "payload"]);
    let of_parts = bench.stdout(&format!("simulate --input drive.csv {parts}"));
    let of_model = bench.stdout("simulate --input drive.csv --model model.json");
    assert_eq!(of_parts, of_model);
    // Printed again it is the same.
    assert_eq!(
        bench.stdout("model --model model.json"),
        bench.read("model.json")
    );
    let plain = Specification::from_json(&bench.stdout("model")).unwrap();
    assert_eq!(
        (plain.vehicle, plain.effects),
        (Vehicle::tran2007(), Effects::NONE)
    );
}

#[test]
fn effects_replace_those_of_a_model_with_a_note() {
    let bench = Bench::new();
    bench.write("effects.json", SLOPE);
    bench.write("model.json", bench.stdout("model --effects effects.json"));
    bench.write(
        "other.json",
        r#"{"drag": {"coefficient": 20}, "latency": {"pose": 0.2}}"#,
    );
    let notes =
        contains("note: the effects of other.json replace those of model.json (grade, payload)")
            .and(contains("not the motion, and are ignored here: latency\n"))
            .and(contains("effects: drag\n"));
    let assert = bench
        .ugv("simulate --input drive.csv --model model.json --effects other.json")
        .assert()
        .success()
        .stderr(notes);
    let expected = bench.stdout("simulate --input drive.csv --effects other.json");
    assert_eq!(assert.get_output().stdout, expected.as_bytes());
}

#[test]
fn pieces_of_a_drive_take_no_effects_that_depend_on_its_start() {
    let bench = Bench::new();
    for effects in [
        r#"{"grade": {"profile": {"over": "time", "points": [[0, 0, 0]]}}}"#,
        r#"{"terrain_change": {"cohesion_factor": 2, "over": "distance"}}"#,
        r#"{"drag": {"coefficient": 9}, "window": {"effects": ["drag"], "time": [1, 2]}}"#,
    ] {
        bench.write("over.json", effects);
        bench.write("model.json", bench.stdout("model --effects over.json"));
        for command in ["fit", "score"] {
            for named in ["effects over.json", "model model.json"] {
                let message = bench.fails(&format!("{command} drive.csv --{named}"), 2);
                assert_contains(&message, "which start anywhere");
            }
            let both = format!("{command} drive.csv --model model.json --terrain dry_sand");
            assert!(bench.fails(&both, 2).contains("cannot be used with"));
        }
    }
}

#[test]
fn a_window_limits_effects_in_time_and_place() {
    let bench = Bench::new();
    let text = bench.read("drive.csv");
    let times = text.lines().skip(1);
    let times = times.map(|row| row.split(',').next().unwrap().parse::<f64>().unwrap());
    let times: Vec<f64> = times.collect();
    let (first, last) = (times[0], times[times.len() - 1]);
    let half = 0.5 * (last - first);
    let driven = |window: &str| {
        let window = format!(r#", "window": {{"effects": ["drawbar"], {window}}}"#);
        let text = format!(r#"{{"drawbar": {{"force": 900}}{window}}}"#);
        bench.write("effects.json", text);
        bench.stdout("simulate --input drive.csv --effects effects.json")
    };
    let plain = bench.stdout("simulate --input drive.csv");
    let rows = |text: &str| -> Vec<Vec<f64>> {
        let rows = text.lines().skip(1).map(|row| {
            let cells = row.split(',').map(|cell| cell.parse().unwrap());
            cells.collect()
        });
        rows.collect()
    };
    let found = rows(&driven(&format!(r#""time": [{half}, 1e6]"#)));
    let plain = rows(&plain);
    assert_eq!(found.len(), plain.len());
    for (found, plain) in found.iter().zip(&plain) {
        let apart = found
            .iter()
            .zip(plain)
            .fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
        if found[0] < first + half {
            // Through the code that effects alter: other rules of quadrature.
            assert!(apart < 1.0, "{apart} at {}", found[0]);
        } else {
            assert!(apart > 10.0, "{apart} at {}", found[0]);
        }
    }
    let nowhere = rows(&driven(r#""place": {"x": 900, "y": 0, "radius": 1}"#));
    let end = |rows: &[Vec<f64>]| rows[rows.len() - 1][3];
    assert!((end(&nowhere) - end(&plain)).abs() < 1e-3);
}

#[test]
fn the_picture_is_headed_by_the_model() {
    let bench = Bench::new();
    bench.write("model.json", bench.stdout("model"));
    bench.stdout("simulate --input drive.csv --model model.json --plot p.svg");
    assert!(bench.read("p.svg").contains("model.json"));
}

#[test]
fn what_is_wrong_with_effects_or_a_model_is_named() {
    let bench = Bench::new();
    let model = bench.stdout("model");
    for (file, text, expected) in [
        (
            "effects",
            r#"{"grad": {}}"#.into(),
            "the nearest known one is `grade`",
        ),
        (
            "effects",
            "{\n  \"grade\": 1,\n}".into(),
            "line 3, column 1: not JSON",
        ),
        (
            "model",
            "{}".into(),
            "the model has no key `format`, expected \"ugv-model/1\"",
        ),
        (
            "model",
            model.replace("490.0", "-1"),
            "mass = -1 kg is outside its range",
        ),
    ] {
        bench.write("bad.json", text);
        for command in [
            "simulate --input drive.csv",
            "model",
            "package --output new.fmu",
        ] {
            let message = bench.fails(&format!("{command} --{file} bad.json"), 2);
            assert!(message.starts_with("ugv: error: bad.json: "), "{message}");
            assert_contains(&message, expected);
            assert_contains(&message, "ugv: hint: ");
        }
    }
    for (arguments, expected) in [
        (
            "model --model m.json --vehicle v.json",
            "cannot be used with",
        ),
        (
            "simulate --input drive.csv --model m.json --terrain dry_sand",
            "cannot be used with",
        ),
        (
            "package --model m.json --terrain dry_sand",
            "cannot be used with",
        ),
        ("model --model nowhere.json", "cannot read nowhere.json: "),
        ("model --effects nowhere.json", "cannot read nowhere.json: "),
        ("effects grad", "'grade'"),
    ] {
        let message = bench.fails(arguments, 2);
        assert_contains(&message, expected);
    }
    assert_eq!(bench.files(), ["bad.json", "drive.csv"]);
}
