use super::*;

// As the Python package rosbags 0.11.9 writes them: ROS 1, CDR of both byte orders.
const FIX: [(Encoding, &str); 3] = [
    (
        Encoding::Ros1,
        "0700000000f153650500000003000000677073ff0100000000000040484000000000008026c00000\
         00000041804000000000000000000000000000000000000000000000000000000000000000000000\
         000000000000000000000000000000000000000000000000000000000000000000000000000002",
    ),
    (
        Encoding::Cdr,
        "0001000000f15365050000000400000067707300ff00010000000000000000000040484000000000\
         008026c0000000000041804000000000000000000000000000000000000000000000000000000000\
         00000000000000000000000000000000000000000000000000000000000000000000000000000000\
         0000000002",
    ),
    (
        Encoding::Cdr,
        "000000006553f100000000050000000467707300ff000001000000004048400000000000c0268000\
         00000000408041000000000000000000000000000000000000000000000000000000000000000000\
         00000000000000000000000000000000000000000000000000000000000000000000000000000000\
         0000000002",
    ),
];
const JOINTS: [(Encoding, &str); 3] = [
    (
        Encoding::Ros1,
        "0700000000f15365050000000000000002000000040000006c656674050000007269676874020000\
         00000000000000d03f000000000000e03f02000000000000000000f83f00000000000004c0000000\
         00",
    ),
    (
        Encoding::Cdr,
        "0001000000f1536505000000010000000000000002000000050000006c6566740000000006000000\
         726967687400000002000000000000000000d03f000000000000e03f020000000000000000000000\
         0000f83f00000000000004c000000000",
    ),
    (
        Encoding::Cdr,
        "000000006553f10000000005000000010000000000000002000000056c6566740000000000000006\
         7269676874000000000000023fd00000000000003fe000000000000000000002000000003ff80000\
         00000000c00400000000000000000000",
    ),
];
/// 1.7e9 s and 5 ns.
const STAMP: i64 = 1_700_000_000_000_000_005;

fn bytes(hexadecimal: &str) -> Vec<u8> {
    let pair = |place| u8::from_str_radix(&hexadecimal[place..place + 2], 16).unwrap();
    (0..hexadecimal.len()).step_by(2).map(pair).collect()
}

#[test]
fn types_of_both_systems_are_the_same() {
    assert_eq!(
        MessageKind::of_type("sensor_msgs/Imu"),
        Some(MessageKind::Imu)
    );
    assert_eq!(
        MessageKind::of_type("sensor_msgs/msg/Imu"),
        Some(MessageKind::Imu)
    );
    assert_eq!(MessageKind::of_type("sensor_msgs/msg/Image"), None);
    for kind in MessageKind::ALL {
        assert_eq!(MessageKind::of_type(kind.message_type()), Some(kind));
    }
}

#[test]
fn fixes_of_another_writer() {
    for (encoding, text) in FIX {
        let bytes = bytes(text);
        let fix = Fix::decode(encoding, &bytes).unwrap();
        let header = Header {
            stamp: STAMP,
            frame: "gps".into(),
        };
        let expected = Fix {
            header,
            status: -1,
            latitude: 48.5,
            longitude: -11.25,
            altitude: 520.125,
            variances: Some([0.0; 2]),
        };
        assert_eq!(fix, expected, "{text}");
    }
}

#[test]
fn variances_of_a_fix_stand_on_the_diagonal_unless_they_are_not_known() {
    let mut bytes = bytes(FIX[0].1);
    let covariance = bytes.len() - 1 - 9 * 8;
    for (place, variance) in [(0, 0.04_f64), (1, 7.0), (4, 0.09), (8, 1.0)] {
        let at = covariance + 8 * place;
        bytes[at..at + 8].copy_from_slice(&variance.to_le_bytes());
    }
    let variances = |bytes: &[u8]| Fix::decode(Encoding::Ros1, bytes).unwrap().variances;
    assert_eq!(variances(&bytes), Some([0.04, 0.09]));
    *bytes.last_mut().unwrap() = 0;
    assert_eq!(variances(&bytes), None);
}

#[test]
fn a_header_is_that_of_any_kind() {
    for (encoding, text) in FIX {
        let bytes = bytes(text);
        let header = Header::decode(encoding, &bytes).unwrap();
        assert_eq!((header.stamp, &*header.frame), (STAMP, "gps"));
    }
}

#[test]
fn joint_states_of_another_writer() {
    for (encoding, text) in JOINTS {
        let bytes = bytes(text);
        let joints = Joints::decode(encoding, &bytes).unwrap();
        assert_eq!((joints.header.stamp, &*joints.header.frame), (STAMP, ""));
        assert_eq!(joints.names, ["left", "right"]);
        assert_eq!(joints.positions, [0.25, 0.5]);
        assert_eq!(joints.velocities, [1.5, -2.5]);
    }
}

#[test]
fn no_part_of_a_message_decodes_nor_another_kind() {
    for (encoding, text) in FIX {
        let bytes = bytes(text);
        for length in 0..bytes.len() {
            assert!(Fix::decode(encoding, &bytes[..length]).is_err(), "{length}");
        }
        assert!(Imu::decode(encoding, &bytes).is_err());
        assert!(Odometry::decode(encoding, &bytes).is_err());
        assert!(Joints::decode(encoding, &bytes).is_err());
    }
}
