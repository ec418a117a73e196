//! Files with a slip that is put right, and ones with a slip that is not.

use super::test_drive::{NAMES, Rows, assert_restored, drive, kinds, read, text, turning, with};
use super::*;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

#[test]
fn good_drive_is_left_alone() {
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
