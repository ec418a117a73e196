//! Files as they are, files with faults that are corrected, and files with faults that are not.

use super::test_drive::{NAMES, Rows, assert_restored, drive, kinds, read, text, turning, with};
use super::*;
use crate::recording::note::NoteKind;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fs;

#[test]
fn every_channel_has_the_times_of_its_samples() {
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
fn every_run_has_a_clock() {
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
fn headings_are_unwrapped() {
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
fn a_clock_that_restarts_starts_another_run() {
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
    // Without that column nothing shows that this is another run.
    let error = read(&text.replace("run,", "other,"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("line 14, column 2 (time): found 0, expected a time later"),
        "{error}"
    );
}

#[test]
fn columns_of_other_names_and_units_are_taken_and_noted() {
    let recording = read(
        "time,omega_left,omega_right,x,y,Heading,yaw_rate [rad/s],V_X,v_x,heading_deviation\n0,1,1,0,0,0,0,1,1,0\n",
    );
    let notes = recording.unwrap().notes;
    let texts: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        texts,
        [
            "heading: taken from column `Heading`, without a unit, as [rad] (from line 1 on)",
            "yaw_rate: taken from column `yaw_rate [rad/s]` [rad/s] (from line 1 on)",
        ]
    );
    assert!(notes[0].kind.is_warning());
}

#[test]
fn a_drive_under_other_names_and_units_is_the_same_drive() {
    let good = drive(60.0, 3);
    let degrees = |angle: f64| angle.to_degrees();
    let rpm = |speed: f64| speed * 30.0 / std::f64::consts::PI;
    let same = |value: f64| value;
    type Unit<'u> = &'u dyn Fn(f64) -> f64;
    let cases: [(&str, [Unit; 7]); 3] = [
        (
            "t,wl,wr,pos_x,pos_y,yaw,wz",
            [&same, &same, &same, &same, &same, &same, &same],
        ),
        (
            "timestamp_ms,Left RPM [rpm],Right RPM [rpm],x [mm],y_mm,yaw_deg,gyro_z (deg/s)",
            [
                &|t| 1e3 * t,
                &rpm,
                &rpm,
                &|x| 1e3 * x,
                &|y| 1e3 * y,
                &degrees,
                &degrees,
            ],
        ),
        (
            "Time;omegaLeft [m/s];omegaRight [m/s];x;y;Heading [\u{b0}];yawRate",
            [
                &same,
                &|w| 0.3 * w,
                &|w| 0.3 * w,
                &same,
                &same,
                &degrees,
                &same,
            ],
        ),
    ];
    for (header, units) in cases {
        let with_semicolons = header.contains(';');
        let mut bad = header.to_owned() + "\n";
        for (time, values) in &good {
            let values = std::iter::once(time).chain(values).zip(units);
            let cells: Vec<String> = values
                .map(|(value, unit)| unit(*value).to_string())
                .collect();
            // A spreadsheet of a country with decimal commas.
            bad += &if with_semicolons {
                cells.join(";").replace('.', ",")
            } else {
                cells.join(",")
            };
            bad.push('\n');
        }
        let notes = |names: &[Option<Channel>]| -> Vec<_> {
            names.iter().map(|name| (NoteKind::Column, *name)).collect()
        };
        let expected = notes(&[
            None,
            Some(Channel::OmegaLeft),
            Some(Channel::OmegaRight),
            Some(Channel::X),
            Some(Channel::Y),
            Some(Channel::Heading),
            Some(Channel::YawRate),
        ]);
        let own = |note: &&(NoteKind, Option<Channel>)| {
            !(with_semicolons && matches!(note.1, Some(Channel::X | Channel::Y)))
        };
        let expected: Vec<_> = expected.iter().filter(own).copied().collect();
        assert_restored(&good, &bad, &expected);
    }
}

#[test]
fn dates_of_any_zone_are_times() {
    let good = drive(60.0, 5);
    let rows = text(&good);
    let mut bad = String::new();
    for (index, row) in rows.lines().enumerate() {
        let (_, cells) = row.split_once(',').unwrap();
        // 50 ms a row, over the end of summer time at 03:00.
        let milliseconds = 50 * index.saturating_sub(1);
        let (minute, second) = (59 + milliseconds / 60_000, milliseconds / 1000 % 60);
        let (hour, minute) = (2 + minute / 60, minute % 60);
        let rest = milliseconds % 1000;
        bad += &match index {
            0 => format!("stamp,{cells}\n"),
            _ => format!("2024-10-20T{hour:02}:{minute:02}:{second:02}.{rest:03},{cells}\n"),
        };
    }
    assert_restored(
        &good,
        &bad,
        &[(NoteKind::Column, None), (NoteKind::Column, None)],
    );
}

#[test]
fn a_column_that_looks_like_a_missing_quantity_is_named() {
    let found = read("time,omega_left,omega_right,x,y,azimuth,speed\n0,1,1,0,0,0,1\n").unwrap();
    let texts: Vec<String> = found.notes.iter().map(ToString::to_string).collect();
    assert!(
        texts[0].contains("`azimuth` looks like it and is not read"),
        "{texts:?}"
    );
    assert!(texts[0].contains("--column heading=azimuth"), "{texts:?}");
    assert!(texts[1].contains("--column v_x=speed"), "{texts:?}");
    assert_eq!(kinds(&found.notes), [NoteKind::Suspicion; 2]);
}

#[test]
fn a_good_drive_is_not_changed() {
    let good = drive(60.0, 1);
    assert_restored(&good, &text(&good), &[]);
}

#[test]
fn units_of_time_are_seen() {
    let good = drive(60.0, 4);
    for (factor, start) in [(1e3, 0.0), (1e3, 1.7e9), (1e6, 0.0), (1e9, 0.0)] {
        let bad = with(&good, |t, _| *t = ((*t + start) * factor).round());
        let recording = read(&bad).unwrap();
        assert_eq!(
            kinds(&recording.notes),
            [NoteKind::TimeUnit],
            "{:?}",
            recording.notes
        );
        let run = &recording.runs[0];
        assert!((run.duration() - 59.95).abs() < 1e-6 && (run.start() - start).abs() < 1e-6);
        // The wheels alone show the unit as well.
        let wheels: String = bad
            .lines()
            .map(|line| line.split(',').take(3).collect::<Vec<_>>().join(",") + "\n")
            .collect();
        assert!((read(&wheels).unwrap().runs[0].duration() - 59.95).abs() < 1e-6);
    }
    // A thousand times a second; a slow clock is noted.
    let wheels = |factor: f64| {
        let rows = good.iter().enumerate();
        let rows = rows.map(|(k, (_, v))| format!("{},{},{}\n", factor * k as f64, v[0], v[1]));
        format!("time,omega_left,omega_right\n{}", rows.collect::<String>())
    };
    let fast = read(&wheels(1e3)).unwrap();
    assert!((fast.runs[0].duration() - 1.199).abs() < 1e-9);
    let slow = read(&wheels(2.0)).unwrap();
    assert_eq!(
        kinds(&slow.notes),
        [NoteKind::Suspicion],
        "{:?}",
        slow.notes
    );
    let bad = with(&good, |t, _| *t *= 1.4e4);
    let error = read(&bad).unwrap_err().to_string();
    assert!(error.contains("the median interval is 700"), "{error}");
}

#[test]
fn swapped_columns_are_seen() {
    let good = drive(60.0, 5);
    let bad = with(&good, |_, v| v.swap(0, 1));
    assert_restored(
        &good,
        &bad,
        &[(NoteKind::SwappedWheels, Some(Channel::OmegaLeft))],
    );
    let bad = with(&good, |_, v| v.swap(2, 3));
    assert_restored(
        &good,
        &bad,
        &[(NoteKind::SwappedPosition, Some(Channel::X))],
    );
    let bad = with(&good, |_, v| v[5] = -v[5]);
    assert_restored(&good, &bad, &[(NoteKind::Sign, Some(Channel::YawRate))]);
    let bad = with(&good, |_, v| v[4] = FRAC_PI_2 - v[4]);
    assert_restored(&good, &bad, &[(NoteKind::Sign, Some(Channel::Heading))]);
    // Heading and gyro clockwise, as navigation has them: the wheels are right.
    let clockwise = |_: &mut f64, v: &mut [f64; 6]| (v[4], v[5]) = (FRAC_PI_2 - v[4], -v[5]);
    let signs = |channels: [Channel; 2]| channels.map(|one| (NoteKind::Sign, Some(one)));
    let found = signs([Channel::Heading, Channel::YawRate]);
    assert_restored(&good, &with(&good, clockwise), &found);
    // ... or clockwise from anywhere: an antenna across the vehicle, a heading that starts at 0.
    for from in [0.0, 1.1, -2.0] {
        let bad = with(&good, |_, v| (v[4], v[5]) = (from - v[4], -v[5]));
        let recording = read(&bad).unwrap();
        assert_eq!(
            kinds(&recording.notes),
            [NoteKind::Sign; 2],
            "{:?}",
            recording.notes
        );
        let series = recording.runs[0].series(Channel::Heading).unwrap();
        let error = |(time, v): &(f64, [f64; 6])| Some(series.at(*time)? - v[4]);
        let off = good.iter().find_map(error).unwrap();
        // The course shows the direction to a few hundredths, and up to whole turns.
        assert!(
            (off - (off / TAU).round() * TAU).abs() < 0.1,
            "{from}: {off}"
        );
        assert_eq!(
            recording.runs[0].series(Channel::OmegaLeft).unwrap().value[7],
            good[7].1[0]
        );
    }
    // Both wheels count backwards.
    let bad = with(&good, |_, v| (v[0], v[1]) = (-v[0], -v[1]));
    let found = signs([Channel::OmegaLeft, Channel::OmegaRight]);
    assert_restored(&good, &bad, &found);
    // Without a heading the course says which of gyro and wheels is right.
    let without = |text: String| {
        let cells = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            [&cells[..5], &cells[6..]].concat().join(",") + "\n"
        };
        text.lines().map(cells).collect::<String>()
    };
    let kinds = |text: &str| kinds(&read(text).unwrap().notes);
    let bad = without(with(&good, |_, v| v[5] = -v[5]));
    assert_eq!(kinds(&bad), [NoteKind::Sign]);
    let bad = without(with(&good, |_, v| v.swap(0, 1)));
    assert_eq!(kinds(&bad), [NoteKind::SwappedWheels]);
    assert!(kinds(&without(text(&good))).is_empty());
    // A slow vehicle that moves 0.3 m in some seconds shows its direction as well.
    let slow: Rows = drive(600.0, 5)
        .into_iter()
        .map(|(time, v)| (time, [v[0], v[1], 0.1 * v[2], 0.1 * v[3], v[4], v[5]]))
        .collect();
    let bad = with(&slow, |_, v| v[4] = FRAC_PI_2 - v[4]);
    assert_restored(&slow, &bad, &[(NoteKind::Sign, Some(Channel::Heading))]);
}

#[test]
fn clocks_that_stumble_are_settled() {
    let good = drive(60.0, 6);
    let mut late = good.clone();
    late.swap(100, 101);
    late.swap(500, 502);
    let columns = || {
        Channel::ALL
            .into_iter()
            .filter(|channel| NAMES.split(',').any(|name| name == channel.name()))
    };
    let all = |kind| -> Vec<(NoteKind, Option<Channel>)> {
        columns().map(|channel| (kind, Some(channel))).collect()
    };
    assert_restored(&good, &text(&late), &all(NoteKind::Reordered));
    let mut twice = good.clone();
    twice.insert(300, good[300]);
    assert_restored(&good, &text(&twice), &all(NoteKind::Repeated));
    // A clock that was set back: the later times lie between earlier ones.
    let bad = with(&good, |t, _| *t -= if *t > 30.0 { 0.33 } else { 0.0 });
    let error = read(&bad).unwrap_err().to_string();
    assert!(
        error.contains("line 603, column 1 (time): found 29.7"),
        "{error}"
    );
    // A clock that counts whole seconds.
    let bad = with(&good, |t, _| *t = t.floor());
    let error = read(&bad).unwrap_err().to_string();
    assert!(
        error.contains("for the second time with another value"),
        "{error}"
    );
}

#[test]
fn corrections_apply_to_all_runs() {
    let good = drive(40.0, 8);
    let mut text = format!("run,{NAMES}\n");
    for (index, (time, v)) in good.iter().enumerate() {
        let (run, time) = if index < 400 {
            ("a", *time)
        } else {
            ("b", *time - 20.0)
        };
        text += &format!(
            "{run},{time},{},{},{},{},{},{}\n",
            v[1], v[0], v[2], v[3], v[4], v[5]
        );
    }
    let recording = read(&text).unwrap();
    assert_eq!(kinds(&recording.notes), [NoteKind::SwappedWheels]);
    assert_eq!(recording.runs.len(), 2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn no_right_drive_is_changed(
        seed in 0u64..1_000_000,
        seconds in 1.0..80.0f64,
        sideways in -0.9..0.9f64,
        grip in 0.1..1.0f64,
        offset in -3.0..3.0f64,
        keep in 1usize..6,
    ) {
        // Slip, a slow drift, other rates and a turned frame are no reasons for a correction.
        let mut rows = turning(seconds, seed, 0.16 * grip);
        for (time, values) in &mut rows {
            values[4] += offset;
            values[2] += sideways * *time;
        }
        let rows: Rows = rows.into_iter().step_by(keep).collect();
        let recording = read(&text(&rows)).unwrap();
        prop_assert!(recording.notes.is_empty(), "{:?}", recording.notes);
        let wheels = recording.runs[0].series(Channel::OmegaLeft).unwrap();
        prop_assert_eq!(wheels.len(), rows.len());
    }

    #[test]
    fn any_text_is_read_or_refused(text in "(time|omega_left|omega_right|x|run|[0-9.,\n e-]|nan){0,60}") {
        let header = format!("time,omega_left,omega_right,x\n{text}");
        for text in [text, header] {
            if let Err(error) = read(&text) {
                prop_assert!(error.to_string().starts_with("drive.csv: line "), "{}", error);
            }
        }
    }
}

#[test]
fn a_side_that_counts_backwards_is_put_right() {
    for seed in 0..3 {
        let good = drive(60.0, seed);
        for (column, channel) in [(0, Channel::OmegaLeft), (1, Channel::OmegaRight)] {
            let bad = with(&good, |_, v| v[column] = -v[column]);
            assert_restored(&good, &bad, &[(NoteKind::Sign, Some(channel))]);
            let text = &read(&bad).unwrap().notes[0].text;
            assert!(text.contains("counted backwards"), "{text}");
        }
        // Without a pose it is left for the doubts about the recording.
        let bad = with(&good, |_, v| v[1] = -v[1]);
        let cells = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            [0, 1, 2, 6].map(|column| cells[column]).join(",")
        };
        let bad: Vec<String> = bad.lines().map(cells).collect();
        let notes = read(&bad.join("\n")).unwrap().notes;
        assert!(kinds(&notes).iter().all(|kind| *kind != NoteKind::Sign));
    }
}

#[test]
fn wheel_speeds_behind_a_gear_do_not_make_angles_degrees() {
    let good = drive(60.0, 1);
    for gear in [25.0, 38.3, 60.0] {
        let bad = with(&good, |_, v| {
            (v[0], v[1]) = (v[0] / gear, v[1] / gear);
        });
        let recording = read(&bad).unwrap();
        let found = kinds(&recording.notes);
        assert!(!found.contains(&NoteKind::Unit), "{:?}", recording.notes);
        assert!(found.contains(&NoteKind::Suspicion), "{gear}: {found:?}");
        let heading = recording.runs[0].series(Channel::Heading).unwrap();
        assert!((heading.at(30.0).unwrap() - good[600].1[4]).abs() < 0.1);
    }
}
