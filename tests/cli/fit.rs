//! `ugv fit`.

use crate::{Bench, assert_contains, formats};
use serde_json::Value;
use std::fmt::Write;

/// A turn at 10 Hz: wheel speeds, and a yaw rate and pose that some soil explains.
fn recording() -> String {
    let mut text = String::from("time,omega_left,omega_right,x,y,heading,yaw_rate\n");
    let (mut x, mut y, mut heading) = (0.0_f64, 0.0_f64, 0.0_f64);
    for k in 0..120 {
        let time = 0.1 * f64::from(k);
        let turn = (0.4 * time).sin();
        let (left, right) = (5.0 - turn, 5.0 + turn);
        let yaw_rate = 0.1 * (right - left);
        let _ = writeln!(
            text,
            "{time:.1},{left:.4},{right:.4},{x:.4},{y:.4},{heading:.5},{yaw_rate:.5}"
        );
        heading += 0.1 * yaw_rate;
        x += 0.12 * heading.cos();
        y += 0.12 * heading.sin();
    }
    text
}

#[test]
fn model_and_report_are_written_and_the_model_drives() {
    let bench = Bench::new();
    bench.write("rec.csv", recording());
    let summary = bench.stdout(
        "fit --vehicle tran2007 rec.csv --free friction_angle --starts 2 --output model.json --json fit.json",
    );
    for expected in [
        "friction_angle",
        "90 % interval",
        "random starts",
        "residual rms",
    ] {
        assert_contains(&summary, expected);
    }
    let report: Value = serde_json::from_str(&bench.read("fit.json")).unwrap();
    assert_eq!(report["format"], "ugv-fit/1");
    formats::assert_documented(&report);
    let parameter = &report["parameters"][0];
    let number = |key: &str| parameter[key].as_f64().unwrap();
    assert_eq!(parameter["name"], "friction_angle");
    assert!(number("low") < number("value") && number("value") < number("high"));
    assert_eq!(report["starts"]["tried"], 2);
    let model: Value = serde_json::from_str(&bench.read("model.json")).unwrap();
    let degrees = model["terrain"]["friction_angle_deg"].as_f64().unwrap();
    assert!((degrees.to_radians() - number("value")).abs() < 1e-9);
    bench.stdout("simulate --input drive.csv --vehicle model.json --terrain model.json");
}

#[test]
fn no_command_replaces_its_input() {
    let bench = Bench::new();
    bench.write("rec.csv", recording());
    bench.write("rec.json", r#"{"note": "kept"}"#);
    bench.write("mine.json", bench.stdout("vehicle"));
    bench.write("soil.json", bench.stdout("terrains dry_sand"));
    bench.write("drive.mcap", "precious");
    let files = [
        "rec.csv",
        "rec.json",
        "mine.json",
        "soil.json",
        "drive.mcap",
    ];
    let before = files.map(|name| bench.read(name));
    for command in [
        "fit --vehicle tran2007 rec.csv --output rec.json",
        "fit --vehicle tran2007 rec.csv --json ./rec.json",
        "score --vehicle tran2007 rec.csv --json rec.json",
        "simulate --input rec.csv --output rec.csv",
        "simulate --input rec.csv --plot rec.json",
        "sweep --input rec.csv --vary soil.cohesion=list:1000 --output rec.csv",
        "fit rec.csv --vehicle mine.json --output mine.json",
        "score --vehicle tran2007 rec.csv --terrain soil.json --json soil.json",
        "simulate --input rec.csv --vehicle mine.json --output ./mine.json",
        "sweep --input rec.csv --terrain soil.json --vary soil.cohesion=list:1000 --output soil.json",
        "package --vehicle mine.json --library linux64=rec.csv --output mine.json",
        "package --library linux64=rec.csv --output rec.csv",
        "inspect rec.csv --json rec.json",
        "inspect rec.csv --report ./rec.csv",
        "import drive.mcap --output drive.mcap",
    ] {
        let message = bench.fails(command, 2);
        assert_contains(&message, "is an input file");
    }
    bench.write("model.csv", recording());
    bench.fails("diagnose model.csv --vehicle tran2007 --output .", 2);
    for command in [
        "simulate --input rec.csv --output a.csv --plot ./a.csv",
        "inspect rec.csv --json same --report same",
        "fit --vehicle tran2007 rec.csv --output same --json same",
    ] {
        assert_contains(&bench.fails(command, 2), "have the same destination");
    }
    assert_eq!(before, files.map(|name| bench.read(name)));
    assert_eq!(
        bench.files(),
        [
            "drive.csv",
            "drive.mcap",
            "mine.json",
            "model.csv",
            "rec.csv",
            "rec.json",
            "soil.json"
        ]
    );
}

#[test]
fn a_recording_that_is_given_twice_does_not_count_twice() {
    let bench = Bench::new();
    bench.write("rec.csv", recording());
    for command in [
        "fit --vehicle tran2007 rec.csv rec.csv",
        "score --vehicle tran2007 rec.csv ./rec.csv",
    ] {
        let message = bench.fails(command, 2);
        assert!(
            message.contains("two recordings are called rec")
                && message.contains("name each file once"),
            "{command}: {message}"
        );
    }
}

#[test]
fn what_goes_to_standard_output_is_the_report_alone() {
    let bench = Bench::new();
    bench.write("rec.csv", recording());
    let report =
        bench.stdout("fit --vehicle tran2007 rec.csv --free friction_angle --starts 0 --json -");
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["parameters"].is_array(), "{report}");
}

#[test]
fn what_is_ignored_or_chosen_for_all_is_noted() {
    let bench = Bench::new();
    bench.write("rec.csv", recording());
    bench.write("other.csv", recording());
    bench.write("rec.json", r#"{"terrain": "dry_sand"}"#);
    bench.write("other.json", r#"{"terrain": "dry_clay"}"#);
    bench.write("offset.json", r#"{"heading_offset": {"offset": 0.1}}"#);
    let command = "fit --vehicle tran2007 rec.csv other.csv --free friction_angle --starts 0 --effects offset.json";
    let output = bench.ugv(command).assert().success();
    let notes = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    for expected in [
        "are ignored here: heading_offset",
        "rec and other have different terrains",
    ] {
        assert_contains(&notes, expected);
    }
}

#[test]
fn names_are_listed_and_typos_answered() {
    let bench = Bench::new();
    bench.write("rec.csv", recording());
    let names = bench.stdout("fit --vehicle tran2007 --free help");
    for expected in [
        "* cohesion",
        "grade.slope_east",
        "* pose_latency",
        "lever_arm_x",
    ] {
        assert_contains(&names, expected);
    }
    let message = bench.fails("fit --vehicle tran2007 rec.csv --free cohesoin", 2);
    assert_contains(&message, "no parameter `cohesoin`");
    assert_contains(&message, "the nearest is cohesion");
    let message = bench.fails("fit --vehicle tran2007 rec.csv --sensors pose_lag", 2);
    assert_contains(&message, "the nearest is pose_latency");
    // Those of sensors are named elsewhere, beside the others that are fitted.
    let message = bench.fails("fit --vehicle tran2007 rec.csv --free lever_arm_x", 2);
    let all = "--sensors pose_latency,wheel_latency,yaw_rate_bias,lever_arm_x";
    assert_contains(&message, all);
    let message = bench.fails(
        "fit --vehicle tran2007 rec.csv --free cohesion --sensors mass",
        2,
    );
    assert_contains(&message, "--free cohesion,mass");
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let bench = Bench::new();
    let message = bench.fails("fit", 2);
    assert_contains(&message, "no recording");
    let message = bench.fails("fit drive.csv --report fit.html", 2);
    assert_contains(&message, "--json fit.html writes all results");
    let message = bench.fails("fit --vehicle tran2007 drive.csv", 2);
    assert_contains(&message, "neither pose nor yaw rate");
    assert_contains(&message, "hint: record a pose");
    bench.write("rec.csv", recording());
    bench.write("other.csv", recording());
    let vehicle = |mass: &str| {
        let text = bench.stdout("vehicle");
        format!("{{\"vehicle\": {}}}", text.replace("490.0", mass))
    };
    bench.write("rec.json", vehicle("490.0"));
    bench.write("other.json", vehicle("500.0"));
    let message = bench.fails("fit rec.csv other.csv", 2);
    assert_contains(&message, "have different vehicles");
    let message = bench.fails("fit --vehicle tran2007 rec.csv --segment 20", 2);
    assert_contains(&message, "3 to 8 seconds");
    assert!(!bench.files().contains(&"model.json".to_owned()));
}
