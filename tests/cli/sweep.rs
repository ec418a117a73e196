//! One drive with many sets of parameters.

use super::*;

const VARIED: &str = "--vary soil.cohesion=log-normal:1040,1.5 --vary vehicle.mass=uniform:400,600 \
                      --vary effects.payload.mass=list:0,40";

fn cells<'a>(csv: &'a str, name: &str) -> Vec<&'a str> {
    let mut lines = csv.lines();
    let at = lines
        .next()
        .unwrap()
        .split(',')
        .position(|cell| cell == name)
        .unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap()).collect()
}

#[test]
fn a_drive_ends_where_simulate_ends() {
    let bench = Bench::new();
    let start = "--initial x=-3 no-slip --terrain dry_sand";
    let csv = bench.stdout(&format!(
        "sweep --input drive.csv --quiet {start} --vary soil.cohesion=list:1040,900"
    ));
    let expected = bench.stdout(&format!(
        "simulate --input drive.csv --output-step input --quiet {start}"
    ));
    for name in ["x", "y", "heading", "v_x", "v_y", "yaw_rate"] {
        assert_eq!(
            cells(&csv, name)[0],
            *cells(&expected, name).last().unwrap()
        );
    }
    assert_ne!(cells(&csv, "x")[0], cells(&csv, "x")[1]);
    assert_eq!(cells(&csv, "time"), ["0.65", "0.65"]);
    assert_eq!(cells(&csv, "error"), ["", ""]);
    let (east, north) = (column(&expected, "x"), column(&expected, "y"));
    let lengths = east.windows(2).zip(north.windows(2));
    let path: f64 = lengths.map(|(x, y)| (x[1] - x[0]).hypot(y[1] - y[0])).sum();
    let distance: f64 = cells(&csv, "distance")[0].parse().unwrap();
    // Rounding.
    assert!((distance - path).abs() < 1e-12 * path);
}

#[test]
fn parameters_mean_what_they_mean_in_a_model() {
    let bench = Bench::new();
    let csv = bench.stdout(
        "sweep --input drive.csv --quiet --terrain dry_sand --vary soil.friction_angle_deg=list:21.3 \
         --vary vehicle.mass=list:433.3 --vary effects.payload.mass=list:70 --vary initial.v_x=list:0.4",
    );
    let soil = bench.stdout("terrains dry_sand").replace("28.0", "21.3");
    let vehicle = bench.stdout("vehicle").replace("490.0", "433.3");
    assert!(soil.contains("21.3") && vehicle.contains("433.3"));
    bench.write("soil.json", soil);
    bench.write("vehicle.json", vehicle);
    bench.write(
        "effects.json",
        r#"{"format": "ugv-effects/1", "payload": {"mass": 70}}"#,
    );
    let expected = bench.stdout(
        "simulate --input drive.csv --output-step input --quiet --terrain soil.json --vehicle vehicle.json \
         --effects effects.json --initial v_x=0.4",
    );
    for name in ["x", "heading", "v_x"] {
        assert_eq!(
            cells(&csv, name)[0],
            *cells(&expected, name).last().unwrap()
        );
    }
}

#[test]
fn the_bits_do_not_depend_on_threads_nor_on_the_way_of_the_table() {
    let bench = Bench::new();
    let drawn = format!("{VARIED} --samples 25 --seed 3");
    let one = bench.stdout(&format!("sweep --input drive.csv --quiet --jobs 1 {drawn}"));
    assert_eq!(one.lines().count(), 1 + 2 * 25);
    let two = bench.stdout(&format!("sweep --input drive.csv --quiet --jobs 2 {drawn}"));
    assert_eq!(one, two);
    let table = bench.stdout(&format!("sweep --samples-only {drawn}"));
    assert_eq!(
        table.lines().next().unwrap(),
        "index,soil.cohesion,vehicle.mass,effects.payload.mass"
    );
    bench.write("samples.csv", &table);
    let read = bench.stdout("sweep --input drive.csv --quiet --table samples.csv");
    assert_eq!(one, read);
    // Rows keep their numbers.
    let rows: Vec<&str> = table.lines().collect();
    bench.write("some.csv", [rows[0], rows[8], rows[3]].join("\n"));
    let some = bench.stdout("sweep --input drive.csv --quiet --table some.csv");
    let all: Vec<&str> = one.lines().collect();
    assert_eq!(some.lines().collect::<Vec<_>>(), [all[0], all[8], all[3]]);
}

#[test]
fn a_drive_that_does_not_reach_the_end_is_kept() {
    let bench = Bench::new();
    bench.write(
        "long.csv",
        "time,omega_left,omega_right\n10,4,4\n11,4,4\n12,4,4\n13,4,4\n14,4,4\n",
    );
    let sweep = "sweep --input long.csv --output ends.csv --initial no-slip \
                 --vary effects.terrain_change.position=list:1e6,2 --vary vehicle.mass=list:490,1e5 \
                 --vary effects.terrain_change.stiffness_factor=list:0.02";
    let assert = bench.ugv(sweep).assert().success();
    let notes = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(
        notes.contains("3 of 4 drives did not reach the end")
            && notes.contains("the first is 1: at 0 s"),
        "{notes}"
    );
    let csv = bench.read("ends.csv");
    let errors = cells(&csv, "error");
    assert_eq!(errors[0], "");
    assert!(
        errors[1].starts_with("\"at 0 s: the vehicle is bogged"),
        "{}",
        errors[1]
    );
    assert!(errors[2].contains("bogged"), "{}", errors[2]);
    let time: Vec<f64> = cells(&csv, "time")
        .iter()
        .map(|t| t.parse().unwrap())
        .collect();
    // Seconds from the start, to the last row that was reached.
    assert_eq!((time[0], time[1]), (4.0, 0.0));
    assert!((1.0..=3.0).contains(&time[2]), "{}", time[2]);
    assert_eq!(cells(&csv, "mean_slip")[1], "");
    assert!(!csv.contains("NaN") && !csv.contains("inf"));
}

#[test]
fn wrong_sweeps_are_refused() {
    let bench = Bench::new();
    bench.write("bad.csv", "soil.cohesion\n5\nx\n");
    bench.write("crlf.csv", "soil.cohesion\r\n5\r\n\r\nx\r\n");
    bench.write("twice.csv", "soil.cohesion,soil.cohesion\n5,6\n");
    bench.write("light.csv", "vehicle.mass\n400\n-3\n");
    bench.write("empty.csv", "soil.cohesion\n");
    bench.write("one.csv", "time,omega_left,omega_right\n0,1,1\n");
    for (arguments, reason, remedy) in [
        (
            "--vary soil.cohesio=list:1",
            "`soil.cohesio` is not a parameter",
            "the nearest is soil.cohesion",
        ),
        ("--vary terrain=list:1", "`terrain` is not a parameter", ""),
        (
            "--vary effects.multipass.memory=list:1",
            "`effects.multipass.memory` is not a parameter",
            "must be on",
        ),
        (
            "--vary vehicle.mass=list:400,-3",
            "sample 1: mass = -3 kg",
            "bound the distribution",
        ),
        (
            "--vary vehicle.mass=list:4 --vary vehicle.mass=list:5",
            "--vary names vehicle.mass twice",
            "",
        ),
        (
            "--vary vehicle.mass=normal:4",
            "expected uniform:LOW,HIGH",
            "",
        ),
        (
            "--vary vehicle.mass=list:400 --samples 5",
            "--samples has no effect",
            "remove --samples",
        ),
        (
            "--vary initial.v_x=list:1 --initial no-slip",
            "initial.v_x differs",
            "remove one of them",
        ),
        (
            "--vary initial.x=list:1 --initial x=2",
            "initial.x differs",
            "remove one of them",
        ),
        (
            "--table bad.csv",
            "bad.csv, line 3, soil.cohesion: found `x`",
            "--samples-only",
        ),
        (
            "--table crlf.csv",
            "crlf.csv, line 4, soil.cohesion: found `x`",
            "",
        ),
        (
            "--table twice.csv",
            "twice.csv names soil.cohesion twice",
            "",
        ),
        ("--table empty.csv", "empty.csv: there is no row", ""),
        (
            "--table light.csv",
            "light.csv: sample 1: mass = -3 kg",
            "remove the row from the table",
        ),
        ("--table nowhere.csv", "cannot read nowhere.csv", ""),
        ("", "--vary", ""),
    ] {
        let message = bench.fails(
            &format!("sweep --input drive.csv --output ends.csv {arguments}"),
            2,
        );
        assert!(
            message.contains(reason) && message.contains(remedy),
            "{message}"
        );
    }
    let message = bench.fails("sweep --input one.csv --vary vehicle.mass=list:400", 2);
    assert_contains(&message, "the drive has one row");
    assert!(!bench.files().contains(&"ends.csv".to_owned()));
}

#[test]
fn all_drives_are_json_instead_of_the_table() {
    let bench = Bench::new();
    let sweep = "sweep --input drive.csv --quiet --vary soil.cohesion=list:1040,900";
    let table = bench.stdout(sweep);
    let results: serde_json::Value =
        serde_json::from_str(&bench.stdout(&format!("{sweep} --json"))).unwrap();
    formats::assert_documented(&results);
    let drives = results["drives"].as_array().unwrap();
    assert_eq!(drives.len(), 2);
    for (row, drive) in drives.iter().enumerate() {
        for name in ["x", "largest_slip", "resistance_work"] {
            let cell: f64 = cells(&table, name)[row].parse().unwrap();
            assert_eq!(drive[name].as_f64(), Some(cell), "{name}");
        }
    }
    assert_eq!(drives[1]["parameters"]["soil.cohesion"], 900.0);
    // Both at once, and neither replaces a file unasked.
    bench.stdout(&format!("{sweep} --output ends.csv --json ends.json"));
    assert_eq!(bench.read("ends.csv"), table);
    let message = bench.fails(&format!("{sweep} --json ends.json"), 2);
    assert_contains(&message, "ends.json exists");
}
