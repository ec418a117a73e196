//! Files with a slip that is put right, and ones with a slip that is not.

use super::test_drive::{NAMES, Rows, assert_restored, drive, kinds, read, text, turning, with};
use super::*;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn good_drive_is_left_alone() {
    let good = drive(60.0, 1);
    assert_restored(&good, &text(&good), &[]);
}

/// 40 s straight on in this direction \[rad\], as its heading wavers by half a degree.
fn straight(direction: f64) -> Rows {
    let row = |index: usize| {
        let time = 0.05 * index as f64;
        let heading = direction + 0.5f64.to_radians() * (1.3 * time).sin();
        let way = 0.9 * time;
        let values = [
            4.0,
            4.0,
            way * direction.cos(),
            way * direction.sin(),
            heading,
            0.0,
        ];
        (time, values)
    };
    (0..800).map(row).collect()
}

#[test]
fn degrees_of_a_drive_straight_on_are_seen_by_its_course() {
    let heading = Some(Channel::Heading);
    for direction in [0.5 * PI, -0.9 * PI] {
        let good = straight(direction);
        let degrees = with(&good, |_, v| v[4] = v[4].to_degrees());
        assert_restored(&good, &degrees, &[(NoteKind::Unit, heading)]);
        // In reverse as well.
        let degrees = with(&good, |_, v| {
            [v[0], v[1]] = [-v[0], -v[1]];
            v[4] = (v[4] - direction.signum() * PI).to_degrees();
        });
        assert_eq!(read(&degrees).unwrap().notes[0].kind, NoteKind::Unit);
    }
    // Steadier than a sensor is: another zero of a heading in radians might look the same.
    let steady = with(&straight(0.5 * PI), |_, v| v[4] = 90.0);
    let notes = read(&steady).unwrap().notes;
    assert_eq!(
        (notes[0].kind, notes[0].channel),
        (NoteKind::Suspicion, heading),
        "{notes:?}"
    );
    assert!(notes[0].text.contains("may be degrees"), "{notes:?}");
    // Radians beyond a turn, and from another zero.
    for offset in [3.0 * TAU, 3.0 * TAU + 1.0] {
        let good = with(&straight(0.5 * PI), |_, v| v[4] += offset);
        assert!(read(&good).unwrap().notes.is_empty());
    }
}

#[test]
fn units_of_angles_are_seen() {
    let good = drive(60.0, 2);
    let unit = |channel| (NoteKind::Unit, Some(channel));
    let bad = with(&good, |_, v| v[4] = v[4].to_degrees());
    assert_restored(&good, &bad, &[unit(Channel::Heading)]);
    let bad = with(&good, |_, v| v[5] = v[5].to_degrees());
    assert_restored(&good, &bad, &[unit(Channel::YawRate)]);
    let bad = with(&good, |_, v| {
        [v[4], v[5]] = [v[4].to_degrees(), v[5].to_degrees()]
    });
    assert_restored(
        &good,
        &bad,
        &[unit(Channel::Heading), unit(Channel::YawRate)],
    );
    let unwrapped = (NoteKind::Unwrapped, Some(Channel::Heading));
    let bad = with(&good, |_, v| v[4] = (v[4] + PI).rem_euclid(TAU) - PI);
    assert_restored(&good, &bad, &[unwrapped]);
    let bad = with(&good, |_, v| v[4] = v[4].to_degrees().rem_euclid(360.0));
    assert_restored(&good, &bad, &[unit(Channel::Heading), unwrapped]);
    // A number that stands for a missing one hides neither.
    let outlier = (NoteKind::Outlier, Some(Channel::Heading));
    for missing in [-999.0, 9999.0] {
        let never = |t: f64, value: f64| {
            if t == 0.0 || t == 30.0 {
                missing
            } else {
                value
            }
        };
        let bad = with(&good, |t, v| {
            v[4] = never(*t, (v[4] + PI).rem_euclid(TAU) - PI)
        });
        assert_restored(&good, &bad, &[outlier, unwrapped]);
        let bad = with(&good, |t, v| {
            v[4] = never(*t, v[4].to_degrees().rem_euclid(360.0))
        });
        assert_restored(&good, &bad, &[outlier, unit(Channel::Heading), unwrapped]);
    }
    // Nor does one that is no heading of the turn they keep to.
    for missing in [-99.0, 10.0, 99.0] {
        let bad = with(&good, |t, v| {
            let wrapped = (v[4] + PI).rem_euclid(TAU) - PI;
            v[4] = if *t == 30.0 { missing } else { wrapped };
        });
        assert_restored(&good, &bad, &[outlier, unwrapped]);
    }
    let bad = with(&good, |t, v| {
        let wrapped = v[4].to_degrees().rem_euclid(360.0);
        v[4] = if *t == 30.0 { -100.0 } else { wrapped };
    });
    assert_restored(&good, &bad, &[outlier, unit(Channel::Heading), unwrapped]);
    // 90 less a compass, and a compass with its declination.
    let unit_and_more = [unit(Channel::Heading), unwrapped];
    let bad = with(&good, |_, v| {
        v[4] = (v[4].to_degrees() + 270.0).rem_euclid(360.0) - 270.0
    });
    assert_restored(&good, &bad, &unit_and_more);
    // Two antennas that were taken for each other once.
    let bad = with(&good, |t, v| {
        let turned = if *t == 30.0 { 180.0 } else { 0.0 };
        v[4] = (v[4].to_degrees() + turned).rem_euclid(360.0);
    });
    let notes = read(&bad).unwrap().notes;
    let is_unit = |note: &Note| (note.kind, note.channel) == unit(Channel::Heading);
    assert!(notes.iter().any(is_unit), "{notes:?}");
}

#[test]
fn wheel_speeds_that_cannot_be_are_converted_or_refused() {
    let good = drive(60.0, 3);
    let bad = with(&good, |_, v| {
        [v[0], v[1]] = [v[0].to_degrees(), v[1].to_degrees()]
    });
    assert_restored(&good, &bad, &[(NoteKind::Unit, Some(Channel::OmegaLeft))]);
    // Revolutions per minute that might be rad/s are told.
    let bad = with(&good, |_, v| {
        [v[0], v[1]] = [v[0], v[1]].map(|speed| speed * 30.0 / PI)
    });
    let notes = read(&bad).unwrap().notes;
    assert_eq!(kinds(&notes), [NoteKind::Suspicion], "{notes:?}");
    assert!(notes[0].text.contains("may be rpm"), "{notes:?}");
    // Rim speeds in metres per second of a narrow vehicle: it turns by 3.3 per metre that the rims differ.
    let narrow = turning(60.0, 3, 1.0);
    let bad = with(&narrow, |_, v| [v[0], v[1]] = [0.3 * v[0], 0.3 * v[1]]);
    assert_restored(&narrow, &bad, &[(NoteKind::Unit, Some(Channel::OmegaLeft))]);
    let recording = parse_recording("drive.csv", "drive", bad.as_bytes(), About::default(), None);
    let notes = recording.unwrap().notes;
    assert_eq!(kinds(&notes), [NoteKind::Suspicion], "{notes:?}");
    assert!(
        notes[0].text.contains("may be rim speeds in m/s"),
        "{notes:?}"
    );
    // A vehicle that is not told beside the recording, but to the program.
    let vehicle = Vehicle {
        wheel_radius: 0.3,
        ..Vehicle::tran2007()
    };
    let about = About::default();
    let recording = parse_recording("drive.csv", "drive", bad.as_bytes(), about, Some(&vehicle));
    assert_eq!(kinds(&recording.unwrap().notes), [NoteKind::Unit]);
    // One spike is left out.
    let bad = with(&good, |t, v| v[1] = if *t == 20.0 { 400.0 } else { v[1] });
    assert_restored(
        &good,
        &bad,
        &[(NoteKind::Outlier, Some(Channel::OmegaRight))],
    );
    let bad = with(&good, |_, v| [v[0], v[1]] = [40.0 * v[0], 40.0 * v[1]]);
    let error = read(&bad).unwrap_err().to_string();
    assert!(
        error.contains("(omega_") && error.contains("rpm or degrees per second"),
        "{error}"
    );
    let bad = with(&good, |t, v| v[1] = if *t > 20.0 { 400.0 } else { v[1] });
    let error = read(&bad).unwrap_err().to_string();
    let expected = "line 403, column 3 (omega_right): found 400, expected a value within 200 rad/s";
    assert!(error.contains(expected), "{error}");
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
        // The wheels alone tell as much.
        let wheels: String = bad
            .lines()
            .map(|line| line.split(',').take(3).collect::<Vec<_>>().join(",") + "\n")
            .collect();
        assert!((read(&wheels).unwrap().runs[0].duration() - 59.95).abs() < 1e-6);
    }
    // A thousand times a second; and what is slow is told.
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
    // ... or clockwise from anywhere: an antenna across the vehicle, a heading that begins at 0.
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
        // The direction is told by the course, to a few hundredths, and by whole turns.
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
    // A vehicle that comes 0.3 m in some seconds shows its direction as well.
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
    // A clock set back for good: from there on, the times lie between others.
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
fn runs_keep_what_they_have() {
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
    fn no_drive_is_repaired_that_is_right(
        seed in 0u64..1_000_000,
        seconds in 1.0..80.0f64,
        sideways in -0.9..0.9f64,
        grip in 0.1..1.0f64,
        offset in -3.0..3.0f64,
        keep in 1usize..6,
    ) {
        // Slip, a slow drift, other rates and a turned frame are no reasons to change anything.
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
