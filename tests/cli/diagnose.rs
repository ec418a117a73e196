//! `ugv diagnose`: its answers to short recordings, and what ends it early.

use crate::{Bench, UGV, assert_contains, column};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::fs;
use std::process::{Command, Stdio};

const FILES: [&str; 3] = ["diagnosis.json", "model.json", "report.html"];
const COLUMNS: &str = "time,omega_left,omega_right,x,y,heading,yaw_rate";

/// A recording at 20 Hz; a row from its time.
fn recording(columns: &str, seconds: f64, row: impl Fn(f64) -> String) -> String {
    let count = (20.0 * seconds) as usize;
    let rows = (0..=count).map(|k| {
        let time = 0.05 * k as f64;
        format!("{time:.2},{}\n", row(time))
    });
    format!("{columns}\n{}", rows.collect::<String>())
}

/// A drive through bends at a changing speed.
fn drive(seconds: f64) -> String {
    recording(COLUMNS, seconds, |time| {
        let (turn, speed) = (0.8 * (0.7 * time).sin(), 4.0 + (0.3 * time).sin());
        let heading = -0.2 * (0.7 * time).cos();
        let [left, right] = [speed - turn, speed + turn];
        let x = time - 0.3 * (0.3 * time).cos();
        format!(
            "{left:.4},{right:.4},{x:.4},0,{heading:.5},{:.5}",
            0.14 * (0.7 * time).sin()
        )
    })
}

/// Eleven seconds of the paper's vehicle on sandy loam at 5 Hz: its diagnosis takes seconds, while that of
/// [`drive`], which no soil explains, takes minutes.
fn simulated(bench: &Bench) -> String {
    bench.write("wheels.csv", drive(11.0));
    let motion = bench.stdout(
        "simulate --input wheels.csv --terrain sandy_loam --initial no-slip --output-step 0.2 --quiet",
    );
    let values = COLUMNS.split(',').map(|name| column(&motion, name));
    let values: Vec<Vec<f64>> = values.collect();
    let mut random = fastrand::Rng::with_seed(1);
    let rows = (0..values[0].len()).map(|row| {
        let mut noisy = |(index, series): (usize, &Vec<f64>)| {
            let noise = [0.0, 0.0, 0.0, 0.01, 0.01, 0.003, 0.003][index];
            format!("{:.5}", series[row] + noise * (2.0 * random.f64() - 1.0))
        };
        let cells: Vec<String> = values.iter().enumerate().map(&mut noisy).collect();
        cells.join(",") + "\n"
    });
    format!("{COLUMNS}\n{}", rows.collect::<String>())
}

/// Sensors' noise at a place.
fn at_rest(x: f64, time: f64) -> String {
    let noise = (37.0 * time).sin();
    format!("0,0,{:.4},2,0.3,{:.5}", x + 0.01 * noise, 0.002 * noise)
}

/// The files in a folder.
fn files_in(bench: &Bench, folder: &str) -> Vec<String> {
    let entries = fs::read_dir(bench.path(folder)).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn too_little_is_a_verdict() {
    let bench = Bench::new();
    bench.write(
        "rest.csv",
        recording(COLUMNS, 60.0, |time| at_rest(1.0, time)),
    );
    bench.write(
        "towed.csv",
        recording(COLUMNS, 60.0, |time| at_rest(time, time)),
    );
    bench.write("short.csv", drive(2.0));
    bench.write("moment.csv", drive(0.0));
    for (name, why) in [
        (
            "rest",
            "The wheels stand still throughout: nothing to diagnose.",
        ),
        (
            "towed",
            "The wheel speeds are zero throughout, but the positions reach over 60 m: the vehicle was towed, or \
             its wheel speeds were not recorded.",
        ),
        (
            "short",
            "2.0 s of usable driving are too short: a diagnosis needs 10 s.",
        ),
        (
            "moment",
            "0.0 s of usable driving are too short: a diagnosis needs 10 s.",
        ),
    ] {
        let text = bench.stdout(&format!(
            "diagnose --vehicle tran2007 {name}.csv --output {name}"
        ));
        assert!(
            text.starts_with("These recordings are not sufficient for a verdict.\n"),
            "{text}"
        );
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words(&text).contains(why), "{text}");
        assert!(!text.contains("probability "), "{text}");
        assert_eq!(files_in(&bench, name), FILES);
        let answer: Value =
            serde_json::from_str(&bench.read(&format!("{name}/diagnosis.json"))).unwrap();
        assert_eq!(answer["format"], "ugv-diagnosis/1");
        assert_eq!(answer["verdict"], "insufficient_data");
        assert_eq!(answer["statement"], why);
        assert_eq!(answer["findings"], Value::Array(Vec::new()));
        let candidates = answer["candidates"].as_array().unwrap().iter();
        let sum: f64 = candidates
            .map(|one| one["probability"].as_f64().unwrap())
            .sum();
        assert_eq!(sum, 1.0);
        assert!(
            bench
                .read(&format!("{name}/report.html"))
                .contains("not sufficient for a verdict")
        );
        bench.stdout(&format!(
            "simulate --input drive.csv --model {name}/model.json"
        ));
    }
}

#[test]
fn a_vehicle_whose_numbers_hardly_belong_together_is_doubted() {
    let bench = Bench::new();
    bench.write("short.csv", drive(2.0));
    bench.stdout("diagnose --vehicle tran2007 short.csv --output as_given");
    let given: Value = serde_json::from_str(&bench.read("as_given/model.json")).unwrap();
    let mut vehicle = given["vehicle"].clone();
    vehicle["yaw_inertia"] = (100.0 * vehicle["mass"].as_f64().unwrap()).into();
    bench.write("vehicle.json", vehicle.to_string());
    let note = "hardly belong together: yaw_inertia";
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = bench.stdout("diagnose short.csv --vehicle vehicle.json --output doubted");
    assert_contains(&words(&text), note);
    assert!(bench.read("doubted/report.html").contains(note));
    assert!(!bench.read("as_given/report.html").contains(note));
}

#[test]
fn nothing_to_compare_with_is_refused() {
    let bench = Bench::new();
    let wheels = "time,omega_left,omega_right";
    bench.write("wheels.csv", recording(wheels, 20.0, |_| "4,4".into()));
    let accelerations = format!("{wheels},a_x,a_y");
    bench.write(
        "shaken.csv",
        recording(&accelerations, 20.0, |_| "4,4,0,0".into()),
    );
    bench.write("well.csv", drive(20.0));
    for (files, bad) in [
        ("wheels.csv", "wheels"),
        ("shaken.csv", "shaken"),
        ("well.csv wheels.csv", "wheels"),
    ] {
        let message = bench.fails(
            &format!("diagnose --vehicle tran2007 {files} --output deep/down/out --quiet"),
            2,
        );
        let expected = format!("ugv: error: {bad} has neither pose nor yaw rate nor velocities");
        assert!(message.starts_with(&expected), "{message}");
        assert!(
            message.contains("ugv: hint: record a pose (x, y, heading) or at least the yaw rate")
        );
    }
    assert_eq!(
        bench.files(),
        ["drive.csv", "shaken.csv", "well.csv", "wheels.csv"]
    );
}

#[test]
fn recordings_must_have_different_names_and_one_vehicle() {
    let bench = Bench::new();
    fs::create_dir(bench.path("other")).unwrap();
    for name in ["a", "b", "other/a"] {
        bench.write(&format!("{name}.csv"), drive(20.0));
    }
    let message = bench.fails("diagnose --vehicle tran2007 a.csv b.csv other/a.csv", 2);
    assert!(
        message.starts_with("ugv: error: two recordings are called a\n"),
        "{message}"
    );
    assert_contains(
        &message,
        "ugv: hint: name each file once, and rename one of two",
    );
    for (name, mass) in [("a", "490.0"), ("b", "500.0")] {
        let vehicle = bench.stdout("vehicle").replace("490.0", mass);
        bench.write(
            &format!("{name}.json"),
            format!("{{\"vehicle\": {vehicle}}}"),
        );
    }
    let message = bench.fails("diagnose a.csv b.csv", 2);
    assert!(
        message.starts_with("ugv: error: a and b have different vehicles\n"),
        "{message}"
    );
    assert_contains(&message, "name the vehicle with --vehicle");
    bench.write("b.json", bench.read("a.json").replace("490.0", "-490.0"));
    let message = bench.fails("diagnose b.csv", 2);
    assert!(
        message.starts_with("ugv: error: b.json: mass = -490 kg"),
        "{message}"
    );
    assert!(!bench.path("diagnosis").exists());
}

#[test]
fn the_vehicle_is_that_of_the_recording() {
    let bench = Bench::new();
    bench.write("a.csv", drive(2.0));
    let vehicle = bench.stdout("vehicle").replace("490.0", "612.5");
    bench.write("a.json", format!("{{\"vehicle\": {vehicle}}}"));
    let mass = || {
        let model: Value = serde_json::from_str(&bench.read("diagnosis/model.json")).unwrap();
        model["vehicle"]["mass"].as_f64().unwrap()
    };
    bench.stdout("diagnose a.csv");
    assert_eq!(mass(), 612.5);
    bench.write("v.json", bench.stdout("vehicle"));
    bench.stdout("diagnose a.csv --vehicle v.json --force");
    assert_eq!(mass(), 490.0);
    bench.stdout("diagnose a.csv --vehicle husky --force");
    assert_eq!(mass(), 56.6);
}

/// A wrong vehicle looks like missing physics.
#[test]
fn no_command_assumes_the_vehicle_of_a_recording() {
    let bench = Bench::new();
    bench.write("a.csv", drive(20.0));
    for command in ["diagnose", "fit", "score"] {
        let message = bench.fails(&format!("{command} a.csv"), 2);
        for expected in [
            "no vehicle: there is no --vehicle or --model, and no a.json with the key `vehicle`",
            "`ugv vehicle > mine.json`",
            "--vehicle tran2007|husky|jackal|warthog|scout",
            "\"half_track\": ..",
        ] {
            assert_contains(&message, expected);
        }
        let message = bench.fails(&format!("{command} a.csv --vehicle huskey"), 2);
        assert_contains(&message, "the nearest preset is --vehicle husky");
    }
    assert_eq!(bench.files(), ["a.csv", "drive.csv"]);
    // The vehicle of one recording is not that of another one.
    bench.write("b.csv", drive(20.0));
    bench.write(
        "b.json",
        format!("{{\"vehicle\": {}}}", bench.stdout("vehicle")),
    );
    let message = bench.fails("score b.csv a.csv", 2);
    assert_contains(&message, "no a.json with the key `vehicle`");
}

#[test]
fn an_answer_is_replaced_by_force_alone() {
    let bench = Bench::new();
    bench.write("short.csv", drive(2.0));
    let command = "diagnose short.csv --vehicle tran2007 --output out";
    bench.stdout(command);
    bench.write("out/model.json", "mine");
    let message = bench.fails(command, 2);
    assert_contains(&message, "ugv: error: out/diagnosis.json exists\n");
    assert_contains(&message, "--force replaces it");
    assert_eq!(bench.read("out/model.json"), "mine");
    // The old name of the option.
    bench.stdout(&format!("{} --force", command.replace("--output", "--out")));
    assert_ne!(bench.read("out/model.json"), "mine");
    // Other files of the folder do not matter.
    bench.write("out2.txt", "mine");
    bench.stdout("diagnose short.csv --vehicle tran2007 --output .");
}

#[test]
fn the_answer_goes_to_standard_output_alone() {
    let bench = Bench::new();
    bench.write("short.csv", drive(2.0));
    let done = bench
        .ugv("diagnose short.csv --vehicle tran2007 --json")
        .assert()
        .success()
        .stderr(contains("too short").and(contains("written to diagnosis")));
    let answer: Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    assert_eq!(answer["format"], "ugv-diagnosis/1");
    let file: Value = serde_json::from_str(&bench.read("diagnosis/diagnosis.json")).unwrap();
    assert_eq!(answer, file);
}

#[test]
fn wrong_arguments_and_files_are_refused() {
    let bench = Bench::new();
    bench.write("a.csv", drive(2.0));
    bench.write(
        "bad.csv",
        "time,omega_left,omega_right,x\n0,1,1,0\n0.1,1,x,0\n",
    );
    for (arguments, expected) in [
        ("diagnose", "<REC.csv|LOG>..."),
        ("diagnose --vehicle tran2007 nowhere.csv", "nowhere.csv"),
        (
            "diagnose --vehicle tran2007 bad.csv",
            "bad.csv: line 3, column 3 (omega_right): found `x`",
        ),
        (
            "diagnose --vehicle tran2007 a.csv --terrain dry_sadn",
            "dry_sand",
        ),
        (
            "diagnose a.csv --vehicle nowhere.json",
            "cannot read nowhere.json",
        ),
        (
            "diagnose a.csv --model m.json --terrain dry_sand",
            "cannot be used with",
        ),
        (
            "diagnose --vehicle tran2007 a.csv --output -",
            "--json writes diagnosis.json to standard output",
        ),
        ("diagnose --vehicle tran2007 a.csv --seed one", "--seed"),
        ("diagnose --vehicle tran2007 a.csv --jobs two", "--jobs"),
        (
            "diagnose --vehicle tran2007 a.csv --within 0",
            "a number of seconds above 0",
        ),
        (
            "diagnose --vehicle tran2007 a.csv --within nan",
            "a number of seconds above 0",
        ),
    ] {
        let message = bench.fails(arguments, 2);
        let error = message.lines().any(|line| line.starts_with("ugv: error: "));
        assert!(error && message.contains(expected), "{message}");
    }
    assert_eq!(bench.files(), ["a.csv", "bad.csv", "drive.csv"]);
}

#[test]
fn a_place_that_cannot_be_written_is_reported_before_the_work() {
    let bench = Bench::new();
    // Minutes of work, if it were done.
    bench.write("a.csv", drive(600.0));
    bench.write("taken", "precious");
    fs::create_dir_all(bench.path("out/model.json")).unwrap();
    bench.write("out/diagnosis.json", "precious");
    for (out, target) in [
        ("taken", "taken"),
        ("taken/deeper", "taken/deeper"),
        ("/proc/nowhere", "/proc/nowhere"),
        ("out", "out/model.json"),
    ] {
        let message = bench.fails(
            &format!("diagnose --vehicle tran2007 a.csv --quiet --force --output {out}"),
            1,
        );
        let expected = format!("ugv: error: cannot write {target}: ");
        assert!(message.starts_with(&expected), "{message}");
    }
    assert_eq!(bench.read("taken"), "precious");
    assert_eq!(bench.read("out/diagnosis.json"), "precious");
    assert_eq!(files_in(&bench, "out"), ["diagnosis.json", "model.json"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_loses_nothing() {
    let bench = Bench::new();
    bench.write("short.csv", drive(2.0));
    bench.write("shorter.csv", drive(1.0));
    bench.stdout("diagnose --vehicle tran2007 short.csv --output out");
    bench.write("out/notes.txt", "mine");
    let texts = || FILES.map(|name| bench.read(&format!("out/{name}")));
    let before = texts();
    let all = ["diagnosis.json", "model.json", "notes.txt", "report.html"];
    // A limit in kilobytes: with 4 the first two files fit, the page does not.
    for (kilobytes, failed) in [(0, FILES[0]), (4, FILES[2])] {
        let limited = format!("trap '' XFSZ; ulimit -f {kilobytes}; exec \"$0\" \"$@\"");
        let mut command = assert_cmd::Command::new("bash");
        command.current_dir(bench.path(""));
        // The summary is printed all the same.
        let summary =
            contains("too short: a diagnosis needs 10 s").and(contains("written to").not());
        let error = format!("ugv: error: cannot write out/{failed}: File too large");
        let temporary = contains(".ugv-").or(contains(".tmp"));
        command
            .args([
                "-c",
                &limited,
                UGV,
                "diagnose",
                "shorter.csv",
                "--vehicle",
                "tran2007",
                "--output",
                "out",
                "--force",
            ])
            .assert()
            .code(1)
            .stdout(summary)
            .stderr(contains(error).and(temporary.not()));
        assert_eq!(texts(), before);
        assert_eq!(files_in(&bench, "out"), all);
    }
    // With room all files are new, except the model: a short recording does not change it.
    bench.stdout("diagnose --vehicle tran2007 shorter.csv --output out --force");
    let after = texts();
    assert!([0, 2].into_iter().all(|file| after[file] != before[file]));
    assert_eq!(files_in(&bench, "out"), all);
    // A device that is always full, instead of one file.
    fs::remove_file(bench.path("out/diagnosis.json")).unwrap();
    std::os::unix::fs::symlink("/dev/full", bench.path("out/diagnosis.json")).unwrap();
    fs::remove_file(bench.path("out/model.json")).unwrap();
    let full = "ugv: error: cannot write out/diagnosis.json: No space left on device";
    bench
        .ugv("diagnose --vehicle tran2007 short.csv --output out --force")
        .assert()
        .code(1)
        .stderr(contains(full));
    // The other files would not match.
    assert!(!bench.path("out/model.json").exists());
}

#[test]
#[cfg(unix)]
fn an_interrupt_leaves_what_was_there() {
    use std::os::unix::process::ExitStatusExt;
    let bench = Bench::new();
    bench.write("a.csv", drive(120.0));
    fs::create_dir(bench.path("out")).unwrap();
    bench.write("out/diagnosis.json", "precious");
    let mut child = Command::new(UGV)
        .current_dir(bench.path(""))
        .args([
            "diagnose",
            "a.csv",
            "--vehicle",
            "tran2007",
            "--output",
            "out/new",
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // The folder is made when the work begins.
    while !bench.path("out/new").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let id = child.id().to_string();
    // Not an INT: a shell's background jobs are born ignoring it, tests in one too.
    assert!(
        Command::new("kill")
            .args(["-TERM", &id])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(15), "{:?}", output.status);
    assert_eq!(output.stdout, b"");
    assert_eq!(files_in(&bench, "out/new"), [""; 0]);
    assert_eq!(bench.read("out/diagnosis.json"), "precious");
}

/// The terrain is a guess; a vehicle that was recorded did not sink into it.
#[test]
fn a_terrain_that_cannot_carry_the_vehicle_is_but_a_start() {
    let bench = Bench::new();
    bench.write("a.csv", simulated(&bench));
    let terrain = bench.stdout("terrains sandy_loam");
    bench.write("mud.json", terrain.replace("1515040.0", "15000.0"));
    let sinks = contains("bogged");
    bench
        .ugv("simulate --input a.csv --terrain mud.json")
        .assert()
        .failure()
        .stderr(sinks);
    bench.stdout("diagnose --vehicle tran2007 a.csv --terrain mud.json");
    let answer: Value = serde_json::from_str(&bench.read("diagnosis/diagnosis.json")).unwrap();
    let note = answer["account"]["notes"][0].as_str().unwrap();
    assert_contains(note, "times its frictional modulus");
    let retuned = answer["fit"]["soil"].as_array().unwrap().iter();
    let modulus = retuned
        .clone()
        .find(|one| one["parameter"] == "frictional_modulus")
        .unwrap();
    assert_eq!(modulus["nominal"], 15000.0);
    assert!(modulus["retuned"]["value"].as_f64().unwrap() > 30000.0);
    assert!(bench.read("diagnosis/report.html").contains("cannot drive"));
}

#[test]
fn the_answer_does_not_depend_on_the_number_of_threads() {
    let bench = Bench::new();
    bench.write("a.csv", simulated(&bench));
    for jobs in ["1", "2"] {
        bench.stdout(&format!(
            "diagnose --vehicle tran2007 a.csv --terrain dry_clay --jobs {jobs} --output {jobs} --quiet"
        ));
    }
    for file in ["diagnosis.json", "model.json"] {
        let [one, two] = ["1", "2"].map(|jobs| bench.read(&format!("{jobs}/{file}")));
        assert_eq!(one, two, "{file}");
    }
    let answer: Value = serde_json::from_str(&bench.read("1/diagnosis.json")).unwrap();
    assert_ne!(answer["verdict"], "insufficient_data");
}

#[test]
fn without_a_terminal_each_step_is_a_line() {
    let bench = Bench::new();
    bench.write("a.csv", simulated(&bench));
    let diagnosed = |more: &str| {
        let arguments =
            format!("diagnose a.csv --vehicle tran2007 --terrain dry_clay --within 60{more}");
        let output = bench.ugv(&arguments).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let steps = diagnosed("");
    let steps = steps
        .lines()
        .filter_map(|line| line.strip_prefix("ugv: step "));
    let numbers: Vec<&str> = steps.filter_map(|line| line.split(':').next()).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6, 7].map(|n| format!("{n} of 7")));
    assert!(!diagnosed(" --quiet --force").contains("step"));
    let page = bench.read("diagnosis/report.html");
    let command = "<code>ugv diagnose a.csv --vehicle tran2007 --terrain dry_clay --within 60 --quiet --force</code>";
    assert_contains(&page, command);
    assert_contains(&page, "1, 60.0 s");
}

/// Standard error is gone by the time somebody reads the answer.
#[test]
fn what_the_reader_put_right_stands_in_the_answer() {
    let bench = Bench::new();
    for (name, rows) in [("short", drive(2.0)), ("long", simulated(&bench))] {
        let last = rows.lines().last().unwrap();
        bench.write(&format!("{name}.csv"), format!("{rows}{last}\n"));
        bench.stdout(&format!(
            "diagnose --vehicle tran2007 {name}.csv --output {name} --quiet"
        ));
        let json = bench.read(&format!("{name}/diagnosis.json"));
        let answer: Value = serde_json::from_str(&json).unwrap();
        let notes = answer["account"]["notes"].as_array().unwrap();
        let begin = format!("{name}: omega_left: 1 samples repeat a time");
        let line = format!("(from line {} on).", rows.lines().count() + 1);
        let is = |note: &str| note.starts_with(&begin) && note.ends_with(&line);
        assert!(
            notes.iter().any(|note| is(note.as_str().unwrap())),
            "{notes:?}"
        );
        assert!(
            bench
                .read(&format!("{name}/report.html"))
                .contains("samples repeat a time")
        );
    }
}

/// What the given model has is not asked about again.
#[test]
fn a_model_with_a_change_of_terrain_is_diagnosed() {
    let bench = Bench::new();
    bench.write("a.csv", simulated(&bench));
    bench.write(
        "change.json",
        r#"{"terrain_change": {"over": "place", "position": 4, "stiffness_factor": 2}}"#,
    );
    bench.stdout("diagnose --vehicle tran2007 a.csv --terrain sandy_loam --effects change.json");
    let answer: Value = serde_json::from_str(&bench.read("diagnosis/diagnosis.json")).unwrap();
    let mut asked = answer["candidates"].as_array().unwrap().iter();
    assert!(asked.all(|one| one["effect"] != "terrain_change"));
}

/// What a diagnosis may write into its model: laws without a name, and something on a patch.
#[test]
fn models_with_laws_and_patches_drive_are_scored_and_packaged() {
    let bench = Bench::new();
    let whole: Value = serde_json::from_str(&bench.stdout("model")).unwrap();
    let mut plain = None;
    for effects in [
        "{}",
        r#"{"residual_longitudinal": {"speed": 0.05}, "residual_lateral": {"speed_turning": -0.04}}"#,
        r#"{"drawbar": {"force": 300}, "window": {"effects": ["drawbar"], "place": {"x": 2, "y": 0, "radius": 1.5}}}"#,
    ] {
        let mut whole = whole.clone();
        whole["effects"] = serde_json::from_str(effects).unwrap();
        bench.write("m.json", whole.to_string());
        bench.write("a.csv", drive(12.0));
        let motion = bench.stdout("simulate --input a.csv --model m.json --quiet");
        bench.stdout("score a.csv --model m.json --quiet");
        // The tool has in it what marks a library of its version.
        let package = format!("package --model m.json --force --library linux64={UGV}");
        bench.ugv(&package).assert().success();
        assert_ne!(plain.as_ref(), Some(&motion), "{effects}");
        plain.get_or_insert(motion);
    }
}
