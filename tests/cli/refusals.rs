//! Input and arguments that are wrong, and drives that fail.

use super::*;
use predicates::str::contains;

#[test]
fn malformed_input_is_located_and_touches_nothing() {
    let bench = Bench::new();
    bench.write("motion.csv", "precious");
    for (text, place, found, expected) in [
        ("", "line 1, column 1", "an empty file", "a header"),
        (
            "time,omega_left,omega_right\n",
            "line 2, column 1 (time)",
            "the end of the file",
            "at least one row",
        ),
        (
            "time,omega_left\n0,1\n",
            "line 1, column 3",
            "no column `omega_right`",
            "a header with time, omega_left",
        ),
        (
            "time,omega_left,omega_right\n0,1,2\n1,2\n",
            "line 3, column 3 (omega_right)",
            "2 cells",
            "3",
        ),
        (
            "time,omega_left,omega_right\n0,1,2,3\n",
            "line 2, column 4",
            "4 cells",
            "3",
        ),
        (
            "time,omega_left,omega_right\n0,abc,2\n",
            "line 2, column 2 (omega_left)",
            "`abc`",
            "a number [rad/s]",
        ),
        (
            "time,omega_left,omega_right\n0,1,NaN\n",
            "line 2, column 3 (omega_right)",
            "`NaN`",
            "a finite number",
        ),
        (
            "time,omega_left,omega_right\n-inf,1,2\n",
            "line 2, column 1 (time)",
            "`-inf`",
            "a finite number [s]",
        ),
        (
            "omega_left,time,omega_right\n1,1,1\n1,1,1\n",
            "line 3, column 2 (time)",
            "1",
            "a time later than 1 s",
        ),
        (
            "time;omega_left;v\n0;1;2\n",
            "line 1, column 4",
            "no column `omega_right`",
            "a header",
        ),
    ] {
        bench.write("bad.csv", text);
        let message = bench.fails(
            "simulate --input bad.csv --output motion.csv --plot new.svg --force",
            2,
        );
        assert!(
            message.starts_with(&format!("ugv: error: bad.csv: {place}")),
            "{message}"
        );
        assert_contains(&message, &format!("found {found}"));
        assert_contains(&message, &format!("expected {expected}"));
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    assert_eq!(bench.read("motion.csv"), "precious");
    assert_eq!(bench.files(), ["bad.csv", "drive.csv", "motion.csv"]);
    let mut command = bench.ugv("simulate --input -");
    let place = contains("standard input: line 2, column 2 (omega_left): found `x`");
    command
        .write_stdin("time,omega_left,omega_right\n0,x,1\n")
        .assert()
        .code(2)
        .stderr(place);
}

#[test]
fn malformed_json_is_explained() {
    let bench = Bench::new();
    let vehicle = bench.stdout("vehicle");
    let soil = bench.stdout("terrains dry_sand");
    for (file, text, expected) in [
        (
            "vehicle",
            vehicle.replacen("490.0,", "490.0", 1),
            "line 3, column 3: not JSON",
        ),
        (
            "vehicle",
            format!(r#"{{"format": "ugv-model/9", "vehicle": {vehicle}}}"#),
            "format: found the text \"ugv-model/9\", expected \"ugv-model/1\"",
        ),
        (
            "terrain",
            soil.replace("28.0", "95"),
            "friction_angle_deg = 95 deg is outside its range",
        ),
    ] {
        bench.write("bad.json", text);
        let message = bench.fails(
            &format!("simulate --input drive.csv --{file} bad.json --output motion.csv"),
            2,
        );
        assert!(message.starts_with("ugv: error: bad.json: "), "{message}");
        assert_contains(&message, expected);
    }
    assert_eq!(bench.files(), ["bad.json", "drive.csv"]);
}

#[test]
fn wrong_arguments_are_explained() {
    let bench = Bench::new();
    for (arguments, expected) in [
        (
            "simulate --input drive.csv --terrain dry_sadn",
            "the nearest preset is --terrain dry_sand",
        ),
        (
            "inspect drive.csv --preset tank",
            "husky, jackal, warthog, scout",
        ),
        (
            "simulate --input drive.csv --initial vx=1",
            "the nearest is `v_x`",
        ),
        (
            "simulate --input drive.csv --output-step 0",
            "expected a number of seconds above 0",
        ),
        (
            "simulate --input drive.csv --output-step 1e-30",
            "--output-step gives",
        ),
        ("simulate --input nowhere.csv", "cannot read nowhere.csv: "),
        ("simulate", "--input"),
        (
            "terrains moon",
            "dry_sand, sandy_loam, clayed_soil, dry_clay",
        ),
        ("simulat", "simulate"),
    ] {
        let message = bench.fails(arguments, 2);
        assert!(message.starts_with("ugv: error: "), "{message}");
        assert_contains(&message, expected);
    }
    assert!(bench.fails("", 2).contains("Usage"));
}

#[test]
fn bogged_vehicle_leaves_nothing_behind() {
    let bench = Bench::new();
    bench.write("tall.json", bench.stdout("vehicle").replace("0.35", "1.5"));
    bench.write(
        "soft.json",
        bench
            .stdout("terrains dry_sand")
            .replace("1528430.0", "300000"),
    );
    // Stops dead after two seconds, so that the front row takes the load.
    bench.write(
        "brake.csv",
        "time,omega_left,omega_right\n10,12,12\n12,12,12\n12.1,0,0\n14,0,0\n",
    );
    let arguments = "simulate --input brake.csv --vehicle tall.json --terrain soft.json";
    let message = bench.fails(&format!("{arguments} --output motion.csv --plot p.svg"), 1);
    let error = message
        .lines()
        .find(|line| line.starts_with("ugv: error: "))
        .unwrap();
    assert!(
        error.contains("at 12.0") && error.contains("bogged: wheel 1"),
        "{message}"
    );
    assert_contains(&message, "ugv: hint: take a firmer terrain");
    assert_eq!(
        message.matches("lifts off the ground").count(),
        1,
        "{message}"
    );
    assert_eq!(
        bench.files(),
        ["brake.csv", "drive.csv", "soft.json", "tall.json"]
    );
    bench.fails(arguments, 1);
}
