//! Drives that go well.

use super::*;
use predicates::str::contains;
use ugv_terrain::recording::{Drive, read_drive};
use ugv_terrain::simulation::{Simulation, State};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};

fn recording() -> Drive {
    read_drive("drive", DRIVE.as_bytes()).unwrap()
}

/// What the library computes, in the order of the tool's columns.
fn expected_rows(terrain: &str, state: State) -> Vec<Vec<f64>> {
    let recording = recording();
    let model = VehicleModel::new(Vehicle::tran2007(), Terrain::preset(terrain).unwrap()).unwrap();
    let mut simulation = Simulation::new(model);
    simulation.set_state(state).unwrap();
    let mut rows = Vec::new();
    for row in 0..recording.len() {
        let speeds = recording.wheel_speeds(row);
        simulation.set_wheel_speeds(speeds.into()).unwrap();
        simulation
            .set_wheel_accelerations(recording.wheel_accelerations(row).into())
            .unwrap();
        let mut values = vec![recording.time[row], speeds[0], speeds[1]];
        values.extend(simulation.state().to_array());
        let wrench = simulation.wrench().unwrap();
        values.extend([
            wrench.a_x,
            wrench.a_y,
            wrench.rolling_resistance,
            wrench.turning_resistance_moment,
            wrench.turning_moment,
            wrench.torque_left,
            wrench.torque_right,
            wrench.power,
        ]);
        for w in &wrench.wheels {
            values.extend([w.longitudinal_slip, w.lateral_slip, w.load, w.sinkage]);
            values.extend([w.entry_angle, w.force_x, w.force_y, w.torque]);
        }
        rows.push(values);
        if let Some(next) = recording.time.get(row + 1) {
            simulation.step(next - recording.time[row]).unwrap();
        }
    }
    rows
}

#[test]
fn columns_have_the_promised_names_and_order() {
    let csv = Bench::new().stdout("simulate --input drive.csv");
    let mut expected = String::from(
        "time,omega_left,omega_right,x,y,heading,v_x,v_y,yaw_rate,a_x,a_y,\
         rolling_resistance,turning_resistance_moment,turning_moment,\
         torque_left,torque_right,power",
    );
    for wheel in 1..=8 {
        for name in [
            "longitudinal_slip",
            "lateral_slip",
            "load",
            "sinkage",
            "entry_angle",
            "force_x",
            "force_y",
            "torque",
        ] {
            expected += &format!(",wheel[{wheel}].{name}");
        }
    }
    assert_eq!(csv.lines().next().unwrap(), expected);
}

#[test]
fn output_is_what_the_library_computes_to_the_last_digit() {
    let bench = Bench::new();
    let start = State {
        x: -3.0,
        heading: 0.3,
        v_x: 1.1,
        ..State::default()
    };
    for terrain in Terrain::PRESETS {
        let initial = "--initial v_x=1.1 x=-3 --initial heading=0.3";
        let csv = bench.stdout(&format!(
            "simulate --input drive.csv --output-step input --terrain {terrain} {initial}"
        ));
        assert_eq!(numbers(&csv), expected_rows(terrain, start), "{terrain}");
    }
    // Rest on clayed soil is the default.
    let csv = bench.stdout("simulate --input drive.csv --output-step input");
    assert_eq!(
        numbers(&csv),
        expected_rows("clayed_soil", State::default())
    );
}

#[test]
fn no_slip_starts_at_the_speed_of_the_wheels() {
    let bench = Bench::new();
    bench.write("turn.csv", "time,omega_left,omega_right\n1,4,8\n");
    let csv = bench.stdout("simulate --input turn.csv --initial no-slip y=2");
    let row = &numbers(&csv)[0];
    // r (4 + 8) / 2 and r (8 - 4) / (2 B).
    assert_eq!(
        row[..9],
        [1.0, 4.0, 8.0, 0.0, 2.0, 0.0, 1.5, 0.0, 1.0 / 1.22]
    );
}

#[test]
fn a_drive_is_taken_up_in_its_midst_where_its_ruts_are() {
    let bench = Bench::new();
    bench.write(
        "straight.csv",
        "time,omega_left,omega_right\n0,6,6\n20,6,6\n",
    );
    let ruts = r#"{"format": "ugv-effects/1", "multipass": {"memory": 1}}"#;
    bench.write("ruts.json", ruts);
    let entry = |options: &str, row: fn(&[f64]) -> f64| {
        let csv = bench.stdout(&format!(
            "simulate --input straight.csv --effects ruts.json {options}"
        ));
        row(&column(&csv, "wheel[7].entry_angle"))
    };
    let long = entry("", |rows| rows[rows.len() - 1]);
    let untouched = entry("--initial no-slip", |rows| rows[0]);
    let settled = entry("--initial no-slip --settled", |rows| rows[0]);
    assert!(
        (settled / long - 1.0).abs() < 0.03 && untouched > 1.2 * long,
        "{long} {settled} {untouched}"
    );
    // Over a course: straight on is what a steady motion is taken to be; from aside it met no track.
    bench.write("straight_on.csv", "x,y,heading\n-4,0,0\n-0.1,0,0\n");
    let straight = entry("--initial no-slip --course straight_on.csv", |rows| rows[0]);
    assert!(
        (straight / settled - 1.0).abs() < 1e-3,
        "{straight} {settled}"
    );
    bench.write(
        "aside.csv",
        "x,y,heading,time\n0,-4,1.57,0\n0,-0.1,1.57,4\n",
    );
    let aside = entry("--initial no-slip --course aside.csv", |rows| rows[0]);
    assert!(aside > 1.1 * long, "{aside} {long}");
    let before = "simulate --input straight.csv --effects ruts.json --course";
    bench.write("half.csv", "x,y,heading\n1,2,\n");
    let error = bench.fails(&format!("{before} half.csv"), 2);
    assert_contains(&error, "half.csv: line 2, column 3 (heading)");
    let error = bench.fails(&format!("{before} nowhere.csv"), 2);
    assert_contains(&error, "nowhere.csv");
}

#[test]
fn what_a_drive_is_taken_up_with_counts_times_from_its_first_row() {
    let bench = Bench::new();
    let softens = r#"{"format": "ugv-effects/1", "multipass": {"memory": 1},
        "terrain_change": {"stiffness_factor": 0.3, "over": "time", "position": 5}}"#;
    bench.write("softens.json", softens);
    let [early, late] = [0, 100].map(|start| {
        let drive = format!(
            "time,omega_left,omega_right\n{start},6,6\n{},6,6\n",
            start + 2
        );
        bench.write("straight.csv", &drive);
        let command = "simulate --input straight.csv --effects softens.json --initial no-slip --output-step input";
        column(
            &bench.stdout(&format!("{command} --settled")),
            "wheel[7].sinkage",
        )
    });
    assert_eq!(early, late);
}

#[test]
fn output_step_sets_the_rows() {
    let bench = Bench::new();
    let csv = bench.stdout("simulate --input drive.csv --output-step 0.1");
    assert_eq!(
        column(&csv, "time"),
        [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.65]
    );
    // Stopping in between moves the integrator's steps, within its tolerance.
    let end = |csv: &str| *column(csv, "x").last().unwrap();
    let rows = bench.stdout("simulate --input drive.csv --output-step input");
    assert_eq!(column(&rows, "time"), [0.0, 0.1, 0.3, 0.65]);
    assert!((end(&csv) - end(&rows)).abs() < 1e-3);
    // The default.
    let csv = bench.stdout("simulate --input drive.csv");
    let expected: Vec<f64> = (0..14).map(|row| f64::from(row) / 20.0).collect();
    assert_eq!(column(&csv, "time"), expected);
    let csv = bench.stdout("simulate --input drive.csv --output-step 100");
    assert_eq!(column(&csv, "time"), [0.0, 0.65]);
    // 0.3 + (0.9 - 0.3) is above 0.9.
    bench.write(
        "late.csv",
        "time,omega_left,omega_right\n0.3,1,1\n0.6,1,1\n0.9,1,1\n",
    );
    let csv = bench.stdout("simulate --input late.csv --output-step 0.25");
    assert_eq!(column(&csv, "time"), [0.3, 0.55, 0.8, 0.9]);
}

#[test]
fn missing_samples_are_interpolated_with_a_note() {
    let bench = Bench::new();
    bench.write(
        "gaps.csv",
        "time,omega_left,omega_right\n0,1,1\n0.1,,2\n0.2,3,\n",
    );
    let assert = bench
        .ugv("simulate --input gaps.csv --output-step input")
        .assert()
        .success();
    let assert = assert.stderr(contains("2 of 3 rows lack a wheel speed"));
    let csv = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    assert_eq!(column(&csv, "omega_left"), [1.0, 2.0, 3.0]);
    assert_eq!(column(&csv, "omega_right"), [1.0, 2.0, 2.0]);
}

#[test]
fn vehicle_may_stand_in_the_file_beside_a_recording() {
    let bench = Bench::new();
    bench.write(
        "recorded.json",
        r#"{"vehicle": {"mass": 470.0, "yaw_inertia": 165.0, "wheel_radius": 0.3, "wheel_width": 0.25,
            "row_positions": [0.457, -0.457], "half_track": 0.568, "com_offset": 0.0, "com_height": 0.45,
            "assumed": ["yaw_inertia"]}, "terrain_as_recorded": "grass", "sensors": {}, "note": ""}"#,
    );
    let csv = bench.stdout("simulate --input drive.csv --vehicle recorded.json");
    assert!(csv.lines().next().unwrap().ends_with("wheel[4].torque"));
    let loads: f64 = (1..=4)
        .map(|wheel| column(&csv, &format!("wheel[{wheel}].load"))[0])
        .sum();
    // The loads carry the weight, to rounding.
    assert!((loads - 470.0 * 9.81).abs() < 1e-9);
}

#[test]
fn presets_come_back_as_files() {
    let bench = Bench::new();
    bench.write("vehicle.json", bench.stdout("vehicle"));
    for terrain in Terrain::PRESETS {
        bench.write("soil.json", bench.stdout(&format!("terrains {terrain}")));
        let by_name = bench.stdout(&format!("simulate --input drive.csv --terrain {terrain}"));
        let by_file =
            bench.stdout("simulate --input drive.csv --vehicle vehicle.json --terrain soil.json");
        assert_eq!(by_name, by_file);
    }
    let plain = bench.stdout("simulate --input drive.csv");
    let named = bench.stdout("simulate --input drive.csv --vehicle tran2007");
    assert_eq!(named, plain);
    bench.stdout("vehicle tran2007 -o paper.json");
    assert_eq!(bench.read("paper.json"), bench.read("vehicle.json"));
    assert_contains(
        &bench.fails("vehicle -o paper.json", 2),
        "paper.json exists",
    );
    let husky = bench.stdout("simulate --input drive.csv --vehicle husky");
    bench.write("husky.json", bench.stdout("vehicle husky"));
    let by_file = bench.stdout("simulate --input drive.csv --vehicle husky.json");
    assert_eq!(husky, by_file);
    let all = Terrain::presets_from_json(&bench.stdout("terrains")).unwrap();
    assert_eq!(
        all.to_vec(),
        Terrain::PRESETS.map(|name| Terrain::preset(name).unwrap())
    );
    bench.write("all.json", bench.stdout("terrains"));
    let message = bench.fails("simulate --input drive.csv --terrain all.json", 2);
    assert_contains(&message, "all.json: found several terrains");
}

#[test]
fn picture_shows_four_panels() {
    let bench = Bench::new();
    bench
        .ugv("simulate --input drive.csv --output motion.csv --plot drive.svg")
        .assert()
        .success();
    let svg = bench.read("drive.svg");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for text in [
        "x, east [m]",
        "y, north [m]",
        "speed [m/s]",
        "slip [-]",
        "force [N], moment [N m]",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    // Lines are smooth whatever rows the table has, and the plot does not change the table.
    let table = bench.stdout("simulate --input drive.csv --output-step input");
    let plotted = bench.stdout("simulate --input drive.csv --output-step input --plot sparse.svg");
    assert_eq!(plotted, table);
    assert_eq!(bench.read("sparse.svg"), bench.read("drive.svg"));
    // Eleven lines of 14 points.
    assert!(svg.matches('L').count() >= 11 * 13);
    // One row leaves nothing but points to draw.
    bench.write("one.csv", "time,omega_left,omega_right\n0,1,1\n");
    bench
        .ugv("simulate --input one.csv --plot one.svg")
        .assert()
        .success();
    assert!(!bench.read("one.svg").contains("NaN"));
}

#[test]
fn the_drive_is_json_instead_of_the_table() {
    let bench = Bench::new();
    let done = bench.ugv("simulate --input drive.csv --json");
    let done = { done }
        .assert()
        .success()
        .stderr(contains("simulated 0.65 s"));
    let drive: serde_json::Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
    formats::assert_documented(&drive);
    assert_eq!(
        (drive["duration"].as_f64(), drive["rows"].as_u64()),
        (Some(0.65), Some(14))
    );
    bench.stdout("simulate --input drive.csv --json drive_result.json -o motion.csv");
    let written: serde_json::Value =
        serde_json::from_str(&bench.read("drive_result.json")).unwrap();
    assert_eq!(written, drive);
    let x = column(&bench.read("motion.csv"), "x");
    assert_eq!(x.last().copied(), drive["end"]["x"].as_f64());
    let message = bench.fails("simulate --input drive.csv --output - --json", 2);
    assert_contains(&message, "--json and --output have the same destination");
    let message = bench.fails("simulate --input drive.csv -o motion.csv", 2);
    assert_contains(&message, "motion.csv exists");
    assert_contains(&message, "--force replaces it");
    // A recording that lost its place.
    let message = bench.fails("inspect --json drive.csv", 2);
    assert_contains(&message, "a recording takes no results");
}
