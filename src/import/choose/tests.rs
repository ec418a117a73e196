use super::*;
use crate::import::container::{Connection, Container, Ending};

fn topic(name: &str, message_type: &str, messages: u64, joints: &str) -> Topic {
    let channel = Connection {
        topic: name.into(),
        message_type: message_type.into(),
        encoding: "cdr".into(),
    };
    Topic {
        messages,
        joints: joints.split_whitespace().map(Into::into).collect(),
        ..Topic::new(&channel, 0)
    }
}

fn survey() -> Survey {
    let odometry = |name, messages| topic(name, "nav_msgs/msg/Odometry", messages, "");
    let joints = |name, messages, joints| topic(name, "sensor_msgs/JointState", messages, joints);
    Survey {
        container: Container::Mcap,
        topics: vec![
            joints("/arm", 900, "left_arm elbow"),
            joints("/wheels", 300, "fl fr"),
            odometry("/odom", 900),
            odometry("/odom/slow", 20),
            odometry("/wheel/gps", 999),
        ],
        ending: Ending::Whole,
    }
}

fn chosen(kind: MessageKind, wish: &Wish) -> Option<String> {
    let survey = survey();
    let choice = choose(&survey, kind, wish, &WheelJoints::default()).unwrap();
    choice.map(|choice| choice.topic.name.clone())
}

#[test]
fn names_tell_where_a_pose_is_from() {
    for name in [
        "/ins/odom",
        "/gps_odom",
        "/groundtruth",
        "/slam_toolbox/odom",
        "/vio",
    ] {
        assert_eq!(origin(name), Origin::Independent, "{name}");
    }
    for name in [
        "/wheel_odom",
        "/husky_velocity_controller/odom",
        "/wheels/gps_like",
    ] {
        assert_eq!(origin(name), Origin::Wheels, "{name}");
    }
    for name in [
        "/odom",
        "/odometry/filtered",
        "/inspector/odom",
        "/volvo/odom",
    ] {
        assert_eq!(origin(name), Origin::Unknown, "{name}");
    }
}

#[test]
fn the_order_of_preference() {
    // Wheels before more messages; no wheel odometry, then more messages.
    assert_eq!(
        chosen(MessageKind::Joints, &Wish::Any).as_deref(),
        Some("/wheels")
    );
    assert_eq!(
        chosen(MessageKind::Odometry, &Wish::Any).as_deref(),
        Some("/odom")
    );
    assert_eq!(chosen(MessageKind::Imu, &Wish::Any), None);
    assert_eq!(chosen(MessageKind::Odometry, &Wish::Without), None);
    let named = Wish::Named("odom/slow".into());
    assert_eq!(
        chosen(MessageKind::Odometry, &named).as_deref(),
        Some("/odom/slow")
    );
}

#[test]
fn inertial_sensors_of_cameras_and_lidars_go_last() {
    let imu = |name, messages, frame: &str| Topic {
        frame: frame.into(),
        ..topic(name, "sensor_msgs/Imu", messages, "")
    };
    let mut survey = survey();
    let chosen = |survey: &Survey| -> String {
        let choice = choose(
            survey,
            MessageKind::Imu,
            &Wish::Any,
            &WheelJoints::default(),
        )
        .unwrap();
        choice.unwrap().topic.name.clone()
    };
    survey.topics = vec![
        imu("/d435i/imu", 9000, "d435i_imu_optical_frame"),
        imu("/zed2i/imu", 8000, ""),
        imu("/Ouster/imu", 7000, "os_imu"),
    ];
    assert_eq!(chosen(&survey), "/d435i/imu", "there is nothing else");
    survey.topics.push(imu("/imu/raw", 20, "imu_link"));
    assert_eq!(chosen(&survey), "/imu/raw");
    // `zed` is a word, not a part of one.
    survey.topics.push(imu("/imu/normalized", 10, "imu_link"));
    assert_eq!(chosen(&survey), "/imu/normalized");
}

#[test]
fn a_choice_among_several_is_told() {
    let survey = survey();
    let none = WheelJoints::default();
    let choice = choose(&survey, MessageKind::Odometry, &Wish::Any, &none)
        .unwrap()
        .unwrap();
    let note = choice.note().unwrap();
    assert!(
        note.contains("also there: /odom/slow, /wheel/gps"),
        "{note}"
    );
    let named = Wish::Named("/odom".into());
    let choice = choose(&survey, MessageKind::Odometry, &named, &none)
        .unwrap()
        .unwrap();
    assert_eq!(choice.note(), None);
}

#[test]
fn a_name_for_one_side_is_not_guessed_for_the_other() {
    let topic = topic("/wheels", "sensor_msgs/JointState", 1, "l_a l_b x");
    let named = |left: &[&str], right: &[&str]| WheelJoints {
        left: left.iter().map(|name| (*name).into()).collect(),
        right: right.iter().map(|name| (*name).into()).collect(),
    };
    let wheels = pick_wheels(&topic, &named(&[], &["l_b"])).unwrap();
    assert_eq!(wheels, named(&["l_a"], &["l_b"]));
    for wrong in [
        named(&[], &[]),
        named(&["y"], &["x"]),
        named(&["x"], &["x"]),
    ] {
        assert!(matches!(
            pick_wheels(&topic, &wrong),
            Err(ImportError::Joints { .. })
        ));
    }
}
