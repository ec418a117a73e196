use super::*;

fn fix(time: i64, status: i8, place: [f64; 3]) -> (i64, FixSample) {
    (time, FixSample { status, place })
}

#[test]
fn columns_stand_in_the_recordings_order_without_what_is_not_finite() {
    let mut columns = Columns::default();
    assert!(columns.push(
        "x",
        "/a",
        "",
        vec![(0, 1.0), (1, f64::NAN), (2, f64::INFINITY)]
    ));
    assert!(columns.push("omega_left", "/b", "", vec![(0, 1.0)]));
    assert!(!columns.push("y", "/a", "", vec![(0, f64::NAN)]));
    let (columns, notes) = columns.sorted();
    let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
    assert_eq!(names, ["omega_left", "x"]);
    assert_eq!(columns[1].samples, [(0, 1.0)]);
    assert!(notes[0].contains("x: 2 of 3 values"), "{notes:?}");
}

#[test]
fn zeros_throughout_are_no_measurement() {
    let sample = OdometrySample {
        position: [1.0, 2.0],
        yaw: Yaw::Of(0.0),
        velocity: [0.5, 0.0],
        yaw_rate: 0.0,
    };
    let mut columns = Columns::default();
    columns.twist("/odom", &[(0, sample.clone()), (1, sample)], true);
    let (columns, notes) = columns.sorted();
    let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
    assert_eq!((names, notes.len()), (vec!["v_x"], 2));
}

#[test]
fn fixes_count_from_the_first_that_is_valid() {
    let nan = f64::NAN;
    let samples = [
        fix(0, -1, [10.0, 20.0, 0.0]),
        fix(1, 0, [nan, 20.0, 0.0]),
        fix(2, 0, [48.0, 11.0, nan]),
        fix(3, 0, [48.0, 11.0, 500.0]),
        fix(4, 0, [48.0, 11.0, 510.0]),
        fix(5, 0, [91.0, 11.0, 510.0]),
    ];
    let mut columns = Columns::default();
    assert!(columns.fixes("/fix", &samples));
    let (columns, notes) = columns.sorted();
    let times: Vec<i64> = columns[0].samples.iter().map(|(time, _)| *time).collect();
    assert_eq!(times, [2, 3, 4]);
    assert!(columns[0].samples.iter().all(|(_, east)| east.abs() < 1e-6));
    assert!(notes[0].contains("3 of 6 fixes are invalid"), "{notes:?}");
    assert!(
        notes[1].contains("1 of 3 fixes have no altitude"),
        "{notes:?}"
    );
    assert!(!Columns::default().fixes("/fix", &samples[..2]));
}
