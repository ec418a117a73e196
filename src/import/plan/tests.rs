use super::*;
use crate::import::Clock;
use crate::import::attitude::Yaw;
use crate::import::collect::{FixSample, JointSample, WheelSample};
use crate::import::container::Connection;
use crate::import::convert::convert;
use crate::import::side::WheelJoints;
use crate::import::survey::Topic;

const STEP: i64 = 100_000_000;

/// Twenty seconds of a topic, logged as measured.
fn stream<T>(kind: MessageKind, name: &str, value: impl Fn(f64) -> T) -> Stream<T> {
    let channel = Connection {
        topic: name.into(),
        message_type: kind.message_type().into(),
        encoding: "cdr".into(),
    };
    let sample = |k: i64| Sample {
        stamp: k * STEP,
        logged: k * STEP,
        value: value(k as f64 * 0.1),
    };
    Stream {
        kind,
        topic: Topic::new(&channel, 0),
        child_frame: String::new(),
        samples: (1..200).map(sample).collect(),
    }
}

fn wheel_speed(time: f64) -> f64 {
    4.0 + time.sin()
}

/// Odometry whose speed is that of the wheels but for a share that comes and goes, and fixes of this deviation.
fn collected(odometry: &str, slip: f64, deviation: Option<f64>) -> Collected {
    let joints = |time| -> WheelSample {
        let joint = JointSample {
            position: f64::NAN,
            velocity: wheel_speed(time),
        };
        Box::new([joint; 2])
    };
    let speed = |time: f64| 0.15 * (wheel_speed(time) + slip * (0.7 * time).cos());
    Collected {
        joints: stream(MessageKind::Joints, "/joints", joints),
        wheels: WheelJoints {
            left: vec!["l".into()],
            right: vec!["r".into()],
        },
        odometry: Some(stream(MessageKind::Odometry, odometry, |time| {
            OdometrySample {
                position: [time, 0.0],
                yaw: Yaw::Of(0.0),
                velocity: [speed(time), 0.01],
                yaw_rate: 0.01,
            }
        })),
        imu: None,
        fix: Some(stream(MessageKind::Fix, "/fix", |_| FixSample {
            status: 0,
            place: [48.0, 11.0, 500.0],
            deviation,
        })),
    }
}

fn plan(all: &Collected, options: &Options) -> (Plan, Vec<String>) {
    let mut notes = Vec::new();
    let plan = Plan::of(all, options, &mut notes).unwrap();
    (plan, notes)
}

#[test]
fn precise_fixes_come_before_odometry_of_unknown_origin() {
    let any = Options::default();
    for (name, deviation, pose, velocities, warnings) in [
        ("/odom", Some(0.02), Pose::Fix, false, 1),
        ("/odom", Some(1.5), Pose::Odometry, true, 2),
        ("/odom", None, Pose::Odometry, true, 2),
        ("/ins/odom", Some(0.02), Pose::Odometry, true, 0),
        ("/wheel/odom", Some(1.5), Pose::Fix, false, 0),
    ] {
        let (plan, notes) = plan(&collected(name, 0.5, deviation), &any);
        assert_eq!(
            (plan.pose, plan.velocities),
            (Some(pose), velocities),
            "{name}: {notes:?}"
        );
        let warned = notes.iter().filter(|note| note.starts_with("warning: "));
        assert_eq!(warned.count(), warnings, "{name}: {notes:?}");
    }
    // What somebody asks for goes first, and its doubts are told.
    let asked = Options {
        pose: Some(Pose::Fix),
        ..Options::default()
    };
    let (plan, notes) = plan(&collected("/odom", 0.5, Some(1.5)), &asked);
    assert_eq!((plan.pose, plan.velocities), (Some(Pose::Fix), true));
    assert!(
        notes[0].starts_with("warning: the name of /odom"),
        "{notes:?}"
    );
}

#[test]
fn a_name_of_an_independent_pose_asks_for_better_evidence_against_it() {
    let any = Options::default();
    for (name, slip, pose) in [
        ("/odom", 0.0, Pose::Fix),
        ("/odom", 0.002, Pose::Fix),
        ("/ins/odom", 0.0, Pose::Fix),
        ("/ins/odom", 0.002, Pose::Odometry),
    ] {
        let (plan, notes) = plan(&collected(name, slip, Some(1.5)), &any);
        assert_eq!(plan.pose, Some(pose), "{name} {slip}: {notes:?}");
    }
}

#[test]
fn what_does_not_serve_has_no_say_in_the_clock() {
    let without_stamps = |name: &str| {
        let mut all = collected(name, 0.5, Some(1.5));
        for sample in &mut all.fix.as_mut().unwrap().samples {
            sample.stamp = 0;
        }
        convert(all, &Options::default()).unwrap()
    };
    let converted = without_stamps("/ins/odom");
    assert_eq!(converted.clock, Clock::Header, "{:?}", converted.notes);
    // Where the fixes serve, their times count.
    let converted = without_stamps("/wheel/odom");
    assert_eq!(converted.clock, Clock::Log, "{:?}", converted.notes);
    let names: Vec<&str> = converted.columns.iter().map(|column| column.name).collect();
    assert_eq!(names, ["omega_left", "omega_right", "x", "y"]);
}
