//! Files that are not what their names say, or mean harm: they cost little, and nothing of theirs reaches a terminal
//! or a browser as it stands.

use super::*;

/// Clears the screen, turns text round, and forges a line of the tool's.
const EVIL: &str = "a\u{1b}[2J\u{9b}1m\u{202e}b\u{2028}<i>\nugv: all is well";

/// A drive at 20 Hz through bends, too short for a diagnosis: that has a verdict at once.
fn recording(name: &str) -> String {
    let mut text = format!("time,omega_left,omega_right,x,y,heading,{name}\n");
    for row in 0..150 {
        let time = 0.05 * f64::from(row);
        let turn = (0.7 * time).sin();
        text += &format!(
            "{time:.2},{:.4},{:.4},{:.4},0,{:.4},1\n",
            4.0 - turn,
            4.0 + turn,
            1.1 * time,
            0.2 - 0.2 * (0.7 * time).cos()
        );
    }
    text
}

/// What is shown holds nothing that a terminal or browser obeys.
fn assert_visible(text: &str) {
    let obeyed = |c: char| (c.is_control() && c != '\n') || "\u{202e}\u{2028}".contains(c);
    let line = text.lines().find(|line| line.contains(obeyed));
    assert!(line.is_none(), "{line:?}");
}

/// Besides, no line of a message is a file's.
fn assert_harmless(text: &str) {
    assert_visible(text);
    let forged = text
        .lines()
        .any(|line| line.starts_with("ugv: all is well"));
    assert!(!forged, "{text}");
}

/// Besides, no element of a page is a file's.
fn assert_harmless_page(page: &str) {
    assert_visible(page);
    let line = page.lines().find(|line| line.contains("<i>"));
    assert!(line.is_none(), "{line:?}");
}

#[test]
fn nothing_of_a_csv_file_reaches_the_terminal_or_a_page_as_it_stands() {
    let bench = Bench::new();
    let header = "time\u{1b}]0;evil\u{7}\u{9b}31m\u{202e},omega_left,omega_right\n0,1,1\n";
    bench.write("header.csv", header);
    bench.write(
        "cell.csv",
        "time,omega_left,omega_right\n0,\u{1b}[31mred,1\n",
    );
    for command in ["inspect", "simulate --input", "diagnose", "fit", "score"] {
        for file in ["header.csv", "cell.csv"] {
            let message = bench.fails(&format!("{command} {file}"), 2);
            assert_harmless(&message);
            assert_contains(&message, "\\u{1b}");
        }
    }
    // A column that is meant for another one: its name stands in a note.
    bench.write("drive.csv", recording("\"V_X [m/s]\u{1b}[31m\""));
    let note = bench.stdout("inspect drive.csv --report page.html");
    assert_contains(&note, "V_X [m/s]\\u{1b}[31m");
    assert_harmless(&note);
    let page = bench.read("page.html");
    assert!(page.contains("V_X [m/s]\\u{1b}[31m"));
    assert_harmless_page(&page);
}

#[test]
fn nothing_of_a_json_file_reaches_the_terminal_or_a_page_as_it_stands() {
    let bench = Bench::new();
    let evil = serde_json::Value::from(EVIL);
    for text in [
        format!("{{{evil}: 1}}"),
        format!("{{\"format\": {evil}}}"),
        format!("{{\"drag\": {{{evil}: 1}}}}"),
        format!("{{\"drag\": {evil}}}"),
        format!("{{{evil}: 1, {evil}: 2}}"),
    ] {
        bench.write("effects.json", text);
        let message = bench.fails("simulate --input drive.csv --effects effects.json", 2);
        assert_harmless(&message);
        assert_contains(&message, "\\u{1b}");
        assert_eq!(message.lines().count(), 2, "{message}");
    }
    bench.write("field.csv", recording("v_x"));
    bench.write(
        "field.json",
        format!("{{\"note\": {evil}, \"source\": {evil}, \"licence\": {evil}}}"),
    );
    bench.stdout("inspect field.csv --report page.html --force");
    let page = bench.read("page.html");
    assert!(page.contains("Licence: a\\u{1b}[2J"));
    assert_harmless_page(&page);
}

#[test]
#[cfg(unix)]
fn nothing_of_a_file_s_name_reaches_the_terminal_or_a_page_as_it_stands() {
    let bench = Bench::new();
    // A slash is the one character that a name cannot have.
    bench.write(&format!("{EVIL}.csv"), recording("v_x"));
    let run = |arguments: &[&str]| {
        let mut command = bench.ugv(arguments[0]);
        let output = command.args(&arguments[1..]).output().unwrap();
        for stream in [output.stdout, output.stderr] {
            assert_harmless(&String::from_utf8(stream).unwrap());
        }
        output.status.success()
    };
    let file = format!("{EVIL}.csv");
    let nowhere = format!("{EVIL}.json");
    assert!(run(&["inspect", &file, "--report", "page.html"]));
    assert_harmless_page(&bench.read("page.html"));
    assert!(run(&[
        "diagnose",
        &file,
        "--vehicle",
        "tran2007",
        "--output",
        EVIL
    ]));
    assert_harmless_page(&bench.read(&format!("{EVIL}/report.html")));
    assert!(run(&[
        "simulate",
        "--input",
        &file,
        "--output",
        &file.replace("csv", "txt")
    ]));
    for arguments in [
        ["simulate", "--input", &nowhere],
        ["package", "--vehicle", &nowhere],
        ["package", "--terrain", &nowhere],
        ["import", "--list", &file],
    ] {
        assert!(!run(&arguments), "{arguments:?}");
    }
}

#[test]
fn what_is_long_is_cut_in_messages() {
    let bench = Bench::new();
    let long = "x".repeat(900_000);
    bench.write("header.csv", format!("{long}\n0\n"));
    bench.write("columns.csv", format!("{}\n0\n", "x,".repeat(450_000)));
    bench.write(
        "cell.csv",
        format!("time,omega_left,omega_right\n0,{long},1\n"),
    );
    bench.write("key.json", format!("{{\"{long}\": 1}}"));
    bench.write("twice.json", format!("{{\"{long}\": 1, \"{long}\": 1}}"));
    bench.write("text.json", format!("{{\"drag\": \"{long}\"}}"));
    bench.write(
        "terrains.json",
        format!("{{\"{long}\": {{}}, \"b\": {{}}}}"),
    );
    bench.write("table.csv", format!("{long}\n0\n"));
    for arguments in [
        "simulate --input header.csv",
        "simulate --input columns.csv",
        "simulate --input cell.csv",
        "inspect header.csv",
        "inspect columns.csv",
        "simulate --input drive.csv --effects key.json",
        "simulate --input drive.csv --effects twice.json",
        "simulate --input drive.csv --effects text.json",
        "simulate --input drive.csv --vehicle key.json",
        "simulate --input drive.csv --terrain terrains.json",
        "sweep --input drive.csv --table table.csv",
    ] {
        let message = bench.fails(arguments, 2);
        assert!(message.len() < 1000, "{arguments}: {} bytes", message.len());
        assert!(message.contains("… ("), "{message}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_file_of_another_kind_is_not_read_to_its_end() {
    let bench = Bench::new();
    for arguments in [
        "simulate --input /dev/zero",
        "inspect /dev/zero",
        "sweep --input drive.csv --table /dev/zero",
    ] {
        let message = bench.fails(arguments, 2);
        let expected = "/dev/zero: line 1: found more than 1 MB without a line end";
        assert_contains(&message, expected);
    }
    for key in ["vehicle", "terrain", "effects", "model"] {
        let message = bench.fails(&format!("simulate --input drive.csv --{key} /dev/zero"), 2);
        let expected = "cannot read /dev/zero: it is larger than 64 MB";
        assert_contains(&message, expected);
    }
    let message = bench.fails("package --library linux64=/dev/zero", 2);
    assert_contains(&message, "it is larger than 256 MB");
}

#[test]
fn numbers_that_no_drive_has_are_refused_in_few_digits() {
    let bench = Bench::new();
    bench.write(
        "late.csv",
        "time,omega_left,omega_right\n0,1,1\n90000,1,1\n",
    );
    bench.write(
        "time.csv",
        "time,omega_left,omega_right\n0,1,1\n1e308,1,1\n",
    );
    bench.write(
        "field.csv",
        "time,omega_left,omega_right,x\n0,1,1,1e308\n1e308,1,1,1\n",
    );
    bench.write("drag.json", "{\"drag\": {\"coefficient\": 1e308}}");
    bench.write(
        "slope.json",
        "{\"grade\": {\"profile\": {\"over\": \"time\", \"points\": [[1e308, 1e308, 0]]}}}",
    );
    bench.write("start.csv", "initial.v_x\n1e150\n");
    for (arguments, expected) in [
        (
            "simulate --input late.csv",
            "a time within 86400 s of the one before",
        ),
        (
            "simulate --input time.csv",
            "found 1e308, expected a time within",
        ),
        ("inspect field.csv", "1e308"),
        (
            "simulate --input drive.csv --effects drag.json",
            "drag.coefficient = 1e308",
        ),
        (
            "simulate --input drive.csv --effects slope.json",
            "a slope of 1e308 rad",
        ),
        (
            "sweep --input drive.csv --table start.csv",
            "sample 0: v_x = 1e150 m/s is outside its range [-100, 100] m/s",
        ),
        (
            "sweep --vary soil.cohesion=uniform:1e308,0",
            "the low end 1e308",
        ),
        ("score field.csv --horizon 1e308", "1e308"),
        (
            "sweep --input drive.csv --vary soil.cohesion=list:1000 --jobs 100000",
            "100000 is not in 1..=1024",
        ),
    ] {
        let message = bench.fails(arguments, 2);
        assert_contains(&message, expected);
        assert!(!message.contains(&"0".repeat(20)), "{message}");
    }
}

/// An MCAP file with two messages of a topic.
fn mcap(topic: &str, message_type: &str, encoding: &str) -> Vec<u8> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let record = |opcode: u8, content: &[&[u8]]| {
        let content = content.concat();
        [
            &[opcode],
            &(content.len() as u64).to_le_bytes()[..],
            &content,
        ]
        .concat()
    };
    let message = record(5, &[&[2, 0], &[0; 20], b"data"]);
    [
        b"\x89MCAP0\r\n".to_vec(),
        record(1, &[&text(""), &text("")]),
        record(3, &[&[1, 0], &text(message_type), &text(""), &text("")]),
        record(4, &[&[2, 0, 1, 0], &text(topic), &text(encoding), &[0; 4]]),
        message.clone(),
        message,
        record(15, &[&[0; 4]]),
    ]
    .concat()
}

#[test]
fn nothing_of_a_robot_s_log_reaches_the_terminal_as_it_stands() {
    let bench = Bench::new();
    bench.write("drive.mcap", mcap(EVIL, EVIL, EVIL));
    let list = bench.stdout("import --list drive.mcap");
    assert_harmless(&list);
    assert_eq!(list.lines().count(), 2, "{list}");
    assert_contains(
        &list,
        "a\\u{1b}[2J\\u{9b}1m\\u{202e}b\\u{2028}<i>\\nugv: all",
    );
    let message = bench.fails("import drive.mcap", 2);
    assert_harmless(&message);
    assert_contains(&message, "a\\u{1b}[2J");
}
