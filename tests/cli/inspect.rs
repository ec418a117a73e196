//! Looking at recordings.

use super::*;
use predicates::str::contains;

/// A drive at 20 Hz whose pose, at 10 Hz, is 0.3 s late.
fn recording() -> String {
    let turn = |t: f64| 3.0 * (0.9 * t).sin() * (0.2 * t).cos();
    let yaw_rate = |t: f64| if t < 0.0 { 0.0 } else { 0.16 * turn(t) };
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0);
    let mut poses = vec![(x, y, heading)];
    let mut text = String::from("time,omega_left,omega_right,x,y,heading,yaw_rate,secret\n");
    for index in 0..1600 {
        let t = 0.05 * f64::from(index);
        heading += 0.05 * yaw_rate(t);
        x += 0.05 * 1.2 * f64::cos(heading);
        y += 0.05 * 1.2 * f64::sin(heading);
        poses.push((x, y, heading));
        let (a, b, c) = poses[(index as usize + 1).saturating_sub(6)];
        let pose = if index % 2 == 0 {
            format!("{a},{b},{c}")
        } else {
            ",,".into()
        };
        let (left, right) = (4.0 - turn(t) / 2.0, 4.0 + turn(t) / 2.0);
        text += &format!("{t:.2},{left},{right},{pose},{},never\n", yaw_rate(t));
    }
    text
}

#[test]
fn the_text_has_rates_and_delays() {
    let bench = Bench::new();
    bench.write("field.csv", recording());
    let text = bench.stdout("inspect field.csv");
    // The pose of this drive follows from its wheels, and the vehicle is not known.
    let first = "Fit for diagnosis: no, because ";
    assert!(text.starts_with(first), "{text}");
    assert_contains(
        &text,
        "heading follows from the difference of the wheel speeds",
    );
    assert_contains(&text, "\nfield: 1 run, 80.0 s, ");
    let line = |start: &str| text.lines().find(|line| line.starts_with(start)).unwrap();
    assert!(line("omega_left").contains(" 20.0 "), "{text}");
    assert!(line("heading ").contains(" 10.0 "), "{text}");
    let cells: Vec<&str> = line("heading behind yaw_rate").split_whitespace().collect();
    let seconds: f64 = cells[3].parse().unwrap();
    assert!((seconds - 0.3).abs() < 0.03, "{text}");
    assert!(
        text.lines()
            .all(|line| line.len() < 120 && line.trim_end() == line),
        "{text}"
    );
    assert!(
        !text.contains("secret") && !text.contains("warning"),
        "{text}"
    );
}

#[test]
fn repairs_are_noted_and_faults_refused() {
    let bench = Bench::new();
    bench.write(
        "field.csv",
        recording().replacen("omega_left,omega_right", "omega_right,omega_left", 1),
    );
    let text = bench.stdout("inspect field.csv");
    assert_contains(
        &text,
        "warning: omega_left: left and right wheel speeds taken as swapped",
    );
    bench.write("field.csv", "time,omega_left,omega_right\n0,1,1\n5,1,x\n");
    let message = bench.fails("inspect field.csv", 2);
    assert!(
        message.starts_with("ugv: error: field.csv: line 3, column 3 (omega_right): found `x`"),
        "{message}"
    );
    assert_contains(&message, "or an empty cell where nothing was measured");
    bench.write(
        "field.csv",
        "time,omega_left,omega_right\n5,1,1\n4,1,1\n3,1,1\n",
    );
    assert_contains(
        &bench.fails("inspect field.csv", 2),
        "sort the rows by time",
    );
    bench.write(
        "field.csv",
        "time,omega_left,omega_right,heading [Grad]\n0,1,1,0\n5,1,1,0\n",
    );
    // These are degrees in German, and a four-hundredth of a turn in English.
    assert_contains(
        &bench.stdout("inspect field.csv"),
        "`heading [Grad]` looks like it and is not read",
    );
    for name in ["field.mcap", "field.db3", "field.bag", "field.ulg"] {
        bench.write(name, "\u{1}\u{2} no log of any kind");
        let message = bench.fails(&format!("inspect {name}"), 2);
        assert_contains(&message, "is no MCAP file, no bag of ROS 1");
    }
    bench.write("field.csv", DRIVE);
    bench.write("field.json", r#"{"terrain": "moon"}"#);
    let message = bench.fails("inspect field.csv", 2);
    assert_contains(&message, "field.json: terrain: found the text \"moon\"");
    let message = bench.fails("inspect nowhere.csv", 2);
    assert!(
        message.starts_with("ugv: error: cannot read nowhere.csv: "),
        "{message}"
    );
}

#[test]
fn json_and_page_are_whole() {
    let bench = Bench::new();
    bench.write("field.csv", recording());
    let quiet = bench.stdout("inspect field.csv --json out.json --report out.html --quiet");
    assert_eq!(quiet, "");
    let json: serde_json::Value = serde_json::from_str(&bench.read("out.json")).unwrap();
    assert_eq!(json["format"], "ugv-inspection/1");
    formats::assert_documented(&json);
    let delay = &json["delays"][1];
    assert_eq!(
        (&delay["of"], &delay["behind"]),
        (&"heading".into(), &"yaw_rate".into())
    );
    let seconds = |key: &str| delay["seconds"][key].as_f64().unwrap();
    assert!(seconds("low") <= seconds("value") && seconds("value") <= seconds("high"));
    let page = bench.read("out.html");
    assert_eq!(
        page.matches("<figure>").count(),
        page.matches("</figure>").count()
    );
    assert!(page.matches("<figure>").count() >= 6);
    assert!(
        page.contains("prefers-color-scheme:dark")
            && !page.contains("NaN")
            && !page.contains("http")
    );
    bench
        .ugv("inspect field.csv --json -")
        .assert()
        .success()
        .stdout(contains("ugv-inspection/1"))
        .stderr(contains("ugv: field: 1 run"));
    assert_eq!(
        bench.files(),
        ["drive.csv", "field.csv", "out.html", "out.json"]
    );
}

#[test]
fn short_recordings_have_no_delays() {
    let bench = Bench::new();
    let text = bench.stdout("inspect drive.csv --report page.html");
    assert!(
        text.contains("\ndrive: 1 run, 0.7 s") && !text.contains("behind"),
        "{text}"
    );
    assert!(bench.read("page.html").contains("Wheel speeds"));
    let recording = recording();
    let start: Vec<&str> = recording.lines().take(100).collect();
    bench.write("field.csv", start.join("\n"));
    let text = bench.stdout("inspect field.csv");
    let first = "Fit for diagnosis: no, because it lasts 4.9 s: a diagnosis needs 10 s of driving";
    assert!(text.starts_with(first), "{text}");
}

/// The size of wheel speeds does not tell degrees per second from a motor in front of a gear.
#[test]
fn wheel_speeds_are_converted_only_where_the_header_has_their_unit() {
    let bench = Bench::new();
    bench.write(
        "wheels.csv",
        "time,omega_left,omega_right\n0,0,0\n2,6,6\n8,6,4\n12,4,7\n16,7,5\n20,0,0\n",
    );
    let motion = bench.stdout("simulate --input wheels.csv --terrain dry_sand --quiet");
    let [time, left, right, x, y, heading] =
        ["time", "omega_left", "omega_right", "x", "y", "heading"]
            .map(|name| column(&motion, name));
    let recording = |unit: &str, factor: f64| {
        let mut text = format!("time,omega_left{unit},omega_right{unit},x,y,heading\n");
        for k in 0..time.len() {
            let wheels = [factor * left[k], factor * right[k]];
            text += &format!(
                "{},{},{},{},{},{}\n",
                time[k], wheels[0], wheels[1], x[k], y[k], heading[k]
            );
        }
        text
    };
    let degrees = 180.0 / std::f64::consts::PI;
    for factor in [38.0, degrees] {
        bench.write("field.csv", recording("", factor));
        let text = bench.stdout("inspect field.csv --vehicle tran2007");
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(!words.contains("converted"), "{words}");
        assert!(words.starts_with("Fit for diagnosis: no"), "{words}");
        for expected in [
            "gear ratio, ticks per turn",
            "in front of a gear",
            "names a unit",
        ] {
            assert_contains(&words, expected);
        }
    }
    bench.write("field.csv", recording(" [deg/s]", degrees));
    let text = bench.stdout("inspect field.csv --vehicle tran2007");
    assert_contains(
        &text,
        "omega_left: taken from column `omega_left [deg/s]` [deg/s]",
    );
    assert!(!text.contains("gear"), "{text}");
}
