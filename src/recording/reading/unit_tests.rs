//! Files in other units than the format's.

use super::test_drive::{Rows, assert_restored, drive, kinds, read, text, turning, with};
use super::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

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
    // A gyro that turns alike is in degrees, too; one in radians is left alone.
    let unit = |channel| (NoteKind::Unit, Some(channel));
    let good = with_rate(straight(0.5 * PI));
    let degrees = with(&good, |_, v| {
        (v[4], v[5]) = (v[4].to_degrees(), v[5].to_degrees())
    });
    let both = [unit(Channel::Heading), unit(Channel::YawRate)];
    assert_restored(&good, &degrees, &both);
    let degrees = with(&good, |_, v| v[4] = v[4].to_degrees());
    assert_restored(&good, &degrees, &both[..1]);
    // Radians beyond a turn, and from another zero.
    for offset in [3.0 * TAU, 3.0 * TAU + 1.0] {
        let good = with(&straight(0.5 * PI), |_, v| v[4] += offset);
        assert!(read(&good).unwrap().notes.is_empty());
    }
}

/// Whose gyro shows how the heading wavers.
fn with_rate(rows: Rows) -> Rows {
    let rate = |time: f64| 0.5f64.to_radians() * 1.3 * (1.3 * time).cos();
    let row = |(time, v): (f64, [f64; 6])| (time, [v[0], v[1], v[2], v[3], v[4], rate(time)]);
    rows.into_iter().map(row).collect()
}

#[test]
fn radians_that_count_clockwise_are_no_degrees() {
    // Clockwise from north, counted on past a turn; as degrees, too, it would go along with the course.
    let (mut x, mut y) = (0.0, 0.0);
    let row = |index: usize| {
        let time = 0.05 * index as f64;
        let heading = 7.72 + 0.3 * (0.3 * time).sin();
        x += 0.045 * (FRAC_PI_2 - heading).cos();
        y += 0.045 * (FRAC_PI_2 - heading).sin();
        let rate = 0.09 * (0.3 * time).cos();
        (time, [4.0, 4.0, x, y, heading, rate])
    };
    let rows: Rows = (0..1600).map(row).collect();
    let recording = read(&text(&rows)).unwrap();
    let is_unit = |note: &Note| note.kind == NoteKind::Unit;
    assert!(
        !recording.notes.iter().any(is_unit),
        "{:?}",
        recording.notes
    );
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
