use super::*;
use std::fs;

fn read(text: &str) -> Result<Recording, CsvError> {
    parse_recording(
        "drive.csv",
        "drive",
        text.as_bytes(),
        About::default(),
        None,
    )
}

#[test]
fn every_channel_has_the_times_of_its_own_samples() {
    let recording = read(
        "x,time,secret,omega_left,omega_right,heading\n\
         0.5,1,7,2,3,\n,1.05,,,3,0.1\n0.6,1.1,word,2.5,NaN,0.2\n",
    )
    .unwrap();
    let run = &recording.runs[0];
    assert_eq!((recording.name.as_str(), run.label.as_str()), ("drive", ""));
    let series = |channel| run.series(channel).unwrap();
    assert_eq!(series(Channel::X).time, [1.0, 1.1]);
    assert_eq!(series(Channel::OmegaLeft).value, [2.0, 2.5]);
    assert_eq!(series(Channel::OmegaRight).time, [1.0, 1.05]);
    assert_eq!(series(Channel::Heading).value, [0.1, 0.2]);
    assert_eq!(run.channels().count(), 4);
    let [note] = &recording.notes[..] else {
        panic!("{:?}", recording.notes)
    };
    assert_eq!(
        (note.kind, note.count, note.line),
        (NoteKind::NotANumber, 1, 4)
    );
}

#[test]
fn runs_have_clocks_of_their_own() {
    let recording =
        read("run,time,omega_left,omega_right\na,0,1,1\na,1,2,2\nb,0,3,3\nb,0.5,4,4\n").unwrap();
    let labels: Vec<_> = recording
        .runs
        .iter()
        .map(|run| run.label.as_str())
        .collect();
    assert_eq!(labels, ["a", "b"]);
    assert_eq!(recording.runs[1].duration(), 0.5);
    assert!(recording.notes.is_empty());
    let error = read("run,time,omega_left,omega_right\n,0,1,1\n").unwrap_err();
    assert_eq!(
        error.to_string(),
        "drive.csv: line 2, column 1 (run): found an empty cell, expected the run's number or name"
    );
}

#[test]
fn headings_go_on_beyond_a_full_turn() {
    let mut text = String::from("time,omega_left,omega_right,heading\n");
    for step in 0..200 {
        let heading = 0.1 * f64::from(step);
        let wrapped = heading.sin().atan2(heading.cos());
        text += &format!("{step},1,2,{wrapped}\n");
    }
    let recording = read(&text).unwrap();
    let heading = recording.runs[0].series(Channel::Heading).unwrap();
    for (time, value) in heading.samples() {
        assert!((value - 0.1 * time).abs() < 1e-12, "{time}");
    }
    let note = &recording.notes[0];
    // At 31.4 s, which is row 32, in line 34; then every 62.8 s.
    assert_eq!(
        (note.kind, note.count, note.line),
        (NoteKind::Unwrapped, 3, 34)
    );
}

#[test]
fn faults_are_located() {
    for (rows, expected) in [
        (
            "0,1,1\n0.1,x,1\n",
            "line 3, column 2 (omega_left): found `x`, expected a number [rad/s]",
        ),
        (
            "0,1,inf\n",
            "line 2, column 3 (omega_right): found `inf`, expected a finite number [rad/s]",
        ),
        (
            "nan,1,1\n",
            "line 2, column 1 (time): found `nan`, expected a finite number [s]",
        ),
        (
            "0,,1\n",
            "line 2, column 2 (omega_left): found nothing but empty cells",
        ),
    ] {
        let error = read(&format!("time,omega_left,omega_right\n{rows}")).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn file_beside_the_recording_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("field.csv");
    fs::write(&path, "time,omega_left,omega_right\n0,1,1\n").unwrap();
    let recording = read_recording(&path).unwrap();
    assert_eq!(
        (recording.name.as_str(), recording.about),
        ("field", About::default())
    );
    fs::write(
        folder.path().join("field.json"),
        r#"{"terrain": "dry_clay"}"#,
    )
    .unwrap();
    let recording = read_recording(&path).unwrap();
    assert_eq!(recording.about.terrain_name.as_deref(), Some("dry_clay"));
    fs::write(folder.path().join("field.json"), r#"{"terrain": "dry_"}"#).unwrap();
    let error = read_recording(&path).unwrap_err().to_string();
    assert!(error.contains("field.json: terrain: found"), "{error}");
}

#[test]
fn clock_that_starts_anew_begins_another_run() {
    let mut text = String::from("run,time,omega_left,omega_right\n");
    for label in ["4", "4", "7", "4"] {
        for row in 0..12 {
            text += &format!("{label},0.{row:02},1,1\n");
        }
    }
    let recording = read(&text).unwrap();
    let labels: Vec<_> = recording
        .runs
        .iter()
        .map(|run| run.label.as_str())
        .collect();
    assert_eq!(labels, ["4", "4", "7", "4"]);
    let note = &recording.notes[0];
    assert_eq!(
        (note.kind, note.count, note.line),
        (NoteKind::Restarted, 2, 14)
    );
    // Without that column, nothing says that this is another run.
    let error = read(&text.replace("run,", "other,"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("line 14, column 2 (time): found 0, expected a time later"),
        "{error}"
    );
}

#[test]
fn columns_that_are_nearly_named_right_are_told() {
    let recording = read(
        "time,omega_left,omega_right,x,y,Heading,yaw_rate [rad/s],V_X,v_x,heading_deviation\n0,1,1,0,0,0,0,1,1,0\n",
    );
    let notes = recording.unwrap().notes;
    let told: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "heading: there is none, but a column `Heading`, which is not read; name it `heading` (from line 1 on)",
            "yaw_rate: there is none, but a column `yaw_rate [rad/s]`, which is not read; name it `yaw_rate` (from line 1 on)",
        ]
    );
    assert!(notes[0].kind.is_warning());
}
