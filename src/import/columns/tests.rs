use super::*;

fn fix(time: i64, status: i8, place: [f64; 3]) -> (i64, FixSample) {
    let sample = FixSample {
        status,
        place,
        deviation: None,
    };
    (time, sample)
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
    assert!(
        notes[0].contains("1 of 3 fixes have no altitude"),
        "{notes:?}"
    );
    assert!(!Columns::default().fixes("/fix", &samples[..2]));
}

#[test]
fn the_yaw_rate_of_a_camera_is_about_the_vertical() {
    // Its axes point to the right, down and ahead; the vehicle yaws at 0.5 and rolls at 0.1 rad/s.
    let sample = |time: i64| {
        let sample = ImuSample {
            yaw: None,
            angular_velocity: Some([f64::NAN, -0.5, 0.1]),
            acceleration: Some([0.2, -9.81, 0.3]),
        };
        (time, sample)
    };
    let samples: Vec<(i64, ImuSample)> = (0..9).map(sample).collect();
    let mounting = Mounting::Tilted {
        up: [0.0, -1.0, 0.0],
        degrees: 90.0,
        at_rest: true,
    };
    let mut columns = Columns::default();
    columns.imu("/camera/imu", &samples, mounting, false);
    let (columns, notes) = columns.sorted();
    assert_eq!(columns.len(), 1, "accelerations are left out");
    assert_eq!(columns[0].name, "yaw_rate");
    assert!(columns[0].samples.iter().all(|(_, rate)| *rate == 0.5));
    assert!(notes[0].starts_with("warning: "), "{notes:?}");
    // One that hangs upside down yaws the right way without being told.
    let mut columns = Columns::default();
    columns.imu("/imu", &samples, Mounting::Down, false);
    let (columns, _) = columns.sorted();
    assert_eq!((columns.len(), columns[0].samples[0].1), (1, -0.1));
    let mut columns = Columns::default();
    columns.imu("/imu", &samples, Mounting::Upright, false);
    assert_eq!(columns.sorted().0.len(), 3);
}
