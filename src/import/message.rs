//! The messages of a recording. Their definitions have not changed since 2010, except for the header's counter, which
//! ROS 2 dropped.

use super::px4::{self, PlanarMotion};
use super::wire::{DecodeError, Encoding, Wire};
use std::borrow::Cow;

/// What a topic's messages serve for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MessageKind {
    /// Wheel speeds.
    Joints,
    /// Pose, and velocities in `nav_msgs/Odometry`.
    Odometry,
    /// `sensor_msgs/Imu`: yaw rate, accelerations, attitude.
    Imu,
    /// `sensor_msgs/NavSatFix`: position on the earth.
    Fix,
    /// Velocities alone.
    Twist,
}

/// Name of each kind, and the type names of ROS 1 and PX4, the best first.
const KINDS: [(&str, &[&str]); 5] = [
    (
        "joints",
        &[
            "sensor_msgs/JointState",
            "clearpath_platform_msgs/Feedback",
            "jackal_msgs/Feedback",
            px4::WHEEL_ENCODERS,
        ],
    ),
    (
        "odometry",
        &[
            "nav_msgs/Odometry",
            "geometry_msgs/PoseWithCovarianceStamped",
            "geometry_msgs/PoseStamped",
            "geometry_msgs/TransformStamped",
            "tf2_msgs/TFMessage",
            "tf/tfMessage",
            px4::LOCAL_POSITION,
            px4::ODOMETRY,
        ],
    ),
    (
        "imu",
        &[
            "sensor_msgs/Imu",
            px4::ANGULAR_VELOCITY,
            px4::SENSOR_COMBINED,
            px4::ATTITUDE,
        ],
    ),
    ("fix", &["sensor_msgs/NavSatFix"]),
    (
        "twist",
        &[
            "geometry_msgs/TwistStamped",
            "geometry_msgs/TwistWithCovarianceStamped",
        ],
    ),
];

/// A type name of ROS 1 (`sensor_msgs/Imu`) from that or one of ROS 2 (`sensor_msgs/msg/Imu`).
fn ros1_name(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

impl MessageKind {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Joints,
        Self::Odometry,
        Self::Imu,
        Self::Fix,
        Self::Twist,
    ];

    /// Name in the options.
    #[must_use]
    pub fn name(self) -> &'static str {
        KINDS[self as usize].0
    }

    /// Type names of ROS 1 and PX4.
    #[must_use]
    pub fn message_types(self) -> &'static [&'static str] {
        KINDS[self as usize].1
    }

    /// From a type name of ROS 1, ROS 2 or PX4.
    #[must_use]
    pub fn of_type(name: &str) -> Option<Self> {
        let name = ros1_name(name);
        Self::ALL
            .into_iter()
            .find(|kind| kind.message_types().contains(&name.as_str()))
    }

    /// The place of a type among those of this kind; the first is the best.
    pub(super) fn place(self, name: &str) -> usize {
        let name = ros1_name(name);
        let mut types = self.message_types().iter();
        types.position(|known| *known == name).unwrap_or(usize::MAX)
    }
}

/// Whether messages of a type hold transforms between many frames.
pub(super) fn is_transforms(message_type: &str) -> bool {
    matches!(
        ros1_name(message_type).as_str(),
        "tf2_msgs/TFMessage" | "tf/tfMessage"
    )
}

/// Whether messages of a type have velocities beside the pose.
pub(super) fn has_twist(message_type: &str) -> bool {
    matches!(
        ros1_name(message_type).as_str(),
        "nav_msgs/Odometry" | px4::LOCAL_POSITION | px4::ODOMETRY
    )
}

/// Time and frame of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct MessageHeader<'a> {
    /// Time of measurement \[ns\] since 1970, or since the start of PX4; zero if the publisher did not set it.
    pub stamp: i64,
    /// The frame's name.
    pub frame: Cow<'a, str>,
}

impl<'a> MessageHeader<'a> {
    /// The header of a message of any kind: it is the first field of all.
    pub(super) fn decode(encoding: Encoding, bytes: &'a [u8]) -> Result<Self, DecodeError> {
        Self::read(&mut Wire::new(encoding, bytes)?)
    }

    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        let seconds = match wire.encoding() {
            Encoding::Ros1 => {
                let _counter = wire.u32()?;
                i64::from(wire.u32()?)
            }
            Encoding::Cdr => i64::from(wire.i32()?),
            Encoding::Ulog => {
                return Ok(Self {
                    stamp: wire.i64()?,
                    frame: "".into(),
                });
            }
        };
        let nanoseconds = i64::from(wire.u32()?);
        Ok(Self {
            stamp: seconds * 1_000_000_000 + nanoseconds,
            frame: wire.text()?,
        })
    }
}

/// A message that can be decoded.
pub(super) trait Decode<'a>: Sized {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError>;

    fn decode(encoding: Encoding, bytes: &'a [u8]) -> Result<Self, DecodeError> {
        Self::decode_by(encoding, bytes, Self::read)
    }

    /// A message in another layout.
    fn decode_by(
        encoding: Encoding,
        bytes: &'a [u8],
        read: impl FnOnce(&mut Wire<'a>) -> Result<Self, DecodeError>,
    ) -> Result<Self, DecodeError> {
        let mut wire = Wire::new(encoding, bytes)?;
        let message = read(&mut wire)?;
        wire.finish()?;
        Ok(message)
    }
}

/// `nav_msgs/Odometry` without its covariances.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Odometry<'a> {
    pub header: MessageHeader<'a>,
    /// The frame of the velocities.
    pub child_frame: Cow<'a, str>,
    /// In the header's frame \[m\].
    pub position: [f64; 3],
    /// x, y, z, w: from the child's frame to the header's.
    pub orientation: [f64; 4],
    /// In the child's frame \[m/s\].
    pub velocity: [f64; 3],
    /// In the child's frame \[rad/s\].
    pub angular_velocity: [f64; 3],
}

impl<'a> Odometry<'a> {
    /// A message of one of the types with a pose and velocities.
    pub fn decode_type(
        message_type: &str,
        encoding: Encoding,
        bytes: &'a [u8],
    ) -> Result<Self, DecodeError> {
        Self::decode_by(encoding, bytes, |wire| match message_type {
            px4::LOCAL_POSITION => Self::px4(wire, px4::local_position),
            px4::ODOMETRY => Self::px4(wire, px4::odometry),
            _ => Self::read(wire),
        })
    }

    fn px4<const N: usize>(
        wire: &mut Wire<'a>,
        motion: fn([f64; N]) -> PlanarMotion,
    ) -> Result<Self, DecodeError> {
        let header = MessageHeader::read(wire)?;
        let motion = motion(wire.f64s()?);
        let ([x, y], [v_x, v_y]) = (motion.position, motion.velocity);
        Ok(Self {
            header,
            child_frame: "".into(),
            position: [x, y, 0.0],
            orientation: px4::attitude(motion.heading),
            velocity: [v_x, v_y, 0.0],
            angular_velocity: [0.0, 0.0, motion.yaw_rate],
        })
    }
}

impl<'a> Decode<'a> for Odometry<'a> {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        let (header, child_frame) = (MessageHeader::read(wire)?, wire.text()?);
        let (position, orientation) = (wire.f64s()?, wire.f64s()?);
        let _covariance: [f64; 36] = wire.f64s()?;
        let (velocity, angular_velocity) = (wire.f64s()?, wire.f64s()?);
        let _covariance: [f64; 36] = wire.f64s()?;
        Ok(Self {
            header,
            child_frame,
            position,
            orientation,
            velocity,
            angular_velocity,
        })
    }
}

/// `sensor_msgs/Imu`. A covariance with -1 as its first element marks a value as not measured.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Imu<'a> {
    pub header: MessageHeader<'a>,
    /// x, y, z, w: from the sensor's frame to one that is fixed to the earth.
    pub orientation: Option<[f64; 4]>,
    /// In the sensor's frame \[rad/s\].
    pub angular_velocity: Option<[f64; 3]>,
    /// Specific force in the sensor's frame: +9.81 upwards at rest \[m/s^2\].
    pub acceleration: Option<[f64; 3]>,
}

impl<'a> Imu<'a> {
    /// A message of one of the types with inertial measurements.
    pub fn decode_type(
        message_type: &str,
        encoding: Encoding,
        bytes: &'a [u8],
    ) -> Result<Self, DecodeError> {
        Self::decode_by(encoding, bytes, |wire| {
            if ![px4::ANGULAR_VELOCITY, px4::SENSOR_COMBINED, px4::ATTITUDE].contains(&message_type)
            {
                return Self::read(wire);
            }
            let vector = |wire: &mut Wire| wire.f64s().map(px4::forward_left_up);
            let mut message = Self {
                header: MessageHeader::read(wire)?,
                orientation: None,
                angular_velocity: None,
                acceleration: None,
            };
            if message_type == px4::ATTITUDE {
                message.orientation = Some(px4::level_attitude(wire.f64s()?));
            } else {
                message.angular_velocity = Some(vector(wire)?);
            }
            if message_type == px4::SENSOR_COMBINED {
                message.acceleration = Some(vector(wire)?);
            }
            Ok(message)
        })
    }
}

impl<'a> Decode<'a> for Imu<'a> {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        fn measured<const N: usize>(wire: &mut Wire) -> Result<Option<[f64; N]>, DecodeError> {
            let value = wire.f64s()?;
            let covariance: [f64; 9] = wire.f64s()?;
            Ok((covariance[0] != -1.0).then_some(value))
        }
        Ok(Self {
            header: MessageHeader::read(wire)?,
            orientation: measured(wire)?,
            angular_velocity: measured(wire)?,
            acceleration: measured(wire)?,
        })
    }
}

/// Covariances of a `sensor_msgs/NavSatFix` that are not known.
const COVARIANCE_UNKNOWN: u8 = 0;

/// `sensor_msgs/NavSatFix`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fix<'a> {
    pub header: MessageHeader<'a>,
    /// Below zero: no fix.
    pub status: i8,
    /// WGS-84 \[deg\].
    pub latitude: f64,
    /// WGS-84 \[deg\].
    pub longitude: f64,
    /// Above the ellipsoid \[m\]; NaN if unknown.
    pub altitude: f64,
    /// East and north \[m^2\]; `None` if marked as unknown.
    pub variances: Option<[f64; 2]>,
}

impl<'a> Decode<'a> for Fix<'a> {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        let (header, status, _service) = (MessageHeader::read(wire)?, wire.i8()?, wire.u16()?);
        let [latitude, longitude, altitude] = wire.f64s()?;
        let covariance: [f64; 9] = wire.f64s()?;
        let is_known = wire.u8()? != COVARIANCE_UNKNOWN;
        Ok(Self {
            header,
            status,
            latitude,
            longitude,
            altitude,
            variances: is_known.then_some([covariance[0], covariance[4]]),
        })
    }
}

/// Passes over the covariance matrix behind a pose or a twist, if the type has one.
fn skip_covariance(message_type: &str, wire: &mut Wire) -> Result<(), DecodeError> {
    if message_type.contains("Covariance") {
        let _covariance: [f64; 36] = wire.f64s()?;
    }
    Ok(())
}

/// A pose, with the frames that it relates.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pose<'a> {
    pub header: MessageHeader<'a>,
    /// The frame at this pose; empty if the message does not name it.
    pub child_frame: Cow<'a, str>,
    /// In the header's frame \[m\].
    pub position: [f64; 3],
    /// x, y, z, w: from the child's frame to the header's.
    pub orientation: [f64; 4],
}

impl<'a> Pose<'a> {
    /// The poses in a message of one of the types without velocities.
    pub fn decode_all(
        message_type: &str,
        encoding: Encoding,
        bytes: &'a [u8],
    ) -> Result<Vec<Self>, DecodeError> {
        let mut wire = Wire::new(encoding, bytes)?;
        let name = ros1_name(message_type);
        let poses = match name.as_str() {
            "geometry_msgs/PoseStamped" | "geometry_msgs/PoseWithCovarianceStamped" => {
                let pose = Self {
                    header: MessageHeader::read(&mut wire)?,
                    child_frame: "".into(),
                    position: wire.f64s()?,
                    orientation: wire.f64s()?,
                };
                skip_covariance(&name, &mut wire)?;
                vec![pose]
            }
            "geometry_msgs/TransformStamped" => vec![Self::transform(&mut wire)?],
            _ => wire.list(Self::transform)?,
        };
        wire.finish()?;
        Ok(poses)
    }

    fn transform(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        Ok(Self {
            header: MessageHeader::read(wire)?,
            child_frame: wire.text()?,
            position: wire.f64s()?,
            orientation: wire.f64s()?,
        })
    }
}

/// `geometry_msgs/TwistStamped`, or with covariance.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Twist<'a> {
    pub header: MessageHeader<'a>,
    /// \[m/s\].
    pub velocity: [f64; 3],
    /// \[rad/s\].
    pub angular_velocity: [f64; 3],
}

impl<'a> Twist<'a> {
    pub fn decode_type(
        message_type: &str,
        encoding: Encoding,
        bytes: &'a [u8],
    ) -> Result<Self, DecodeError> {
        let mut wire = Wire::new(encoding, bytes)?;
        let twist = Self {
            header: MessageHeader::read(&mut wire)?,
            velocity: wire.f64s()?,
            angular_velocity: wire.f64s()?,
        };
        skip_covariance(message_type, &mut wire)?;
        wire.finish()?;
        Ok(twist)
    }
}

/// What a side's load is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Load {
    /// Torque, or force \[N m\].
    Effort,
    /// Current of the motor \[A\].
    Current,
}

/// `sensor_msgs/JointState`, or the feedback of two drives. A list that was not measured is empty.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Joints<'a> {
    pub header: MessageHeader<'a>,
    pub names: Vec<Cow<'a, str>>,
    /// \[rad\].
    pub positions: Vec<f64>,
    /// \[rad/s\].
    pub velocities: Vec<f64>,
    pub loads: Vec<f64>,
    pub load: Load,
}

impl<'a> Joints<'a> {
    /// A message of one of the types with wheel speeds. Joints without names are called by their number.
    pub fn decode_type(
        message_type: &str,
        encoding: Encoding,
        bytes: &'a [u8],
    ) -> Result<Self, DecodeError> {
        let mut wire = Wire::new(encoding, bytes)?;
        let header = MessageHeader::read(&mut wire)?;
        let joints = match ros1_name(message_type).as_str() {
            "jackal_msgs/Feedback" => Self::drives(header, &mut wire, 2)?,
            "clearpath_platform_msgs/Feedback" => Self::drives(header, &mut wire, 0)?,
            px4::WHEEL_ENCODERS => Self::encoders(header, wire.f64s()?, wire.f64s()?),
            _ => Self::states(header, &mut wire)?,
        };
        wire.finish()?;
        Ok(joints)
    }

    fn states(header: MessageHeader<'a>, wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        let mut names = wire.list(Wire::text)?;
        let (positions, velocities) = (wire.list(Wire::f64)?, wire.list(Wire::f64)?);
        let loads = wire.list(Wire::f64)?;
        if names.is_empty() || names.iter().all(|name| name.is_empty()) {
            let count = positions.len().max(velocities.len());
            names = (0..count).map(|index| unnamed(index).into()).collect();
        }
        Ok(Self {
            header,
            names,
            positions,
            velocities,
            loads,
            load: Load::Effort,
        })
    }

    /// The encoders of PX4.
    fn encoders(header: MessageHeader<'a>, speeds: [f64; 2], angles: [f64; 2]) -> Self {
        Self {
            header,
            names: px4::WHEELS.map(Cow::from).into(),
            positions: angles.into(),
            velocities: speeds.into(),
            loads: Vec::new(),
            load: Load::Effort,
        }
    }

    /// The feedback of Clearpath's drives, left and right, with so many temperatures behind them (jackal_msgs,
    /// clearpath_platform_msgs).
    fn drives(
        header: MessageHeader<'a>,
        wire: &mut Wire<'a>,
        temperatures: usize,
    ) -> Result<Self, DecodeError> {
        let mut joints = Self {
            header,
            names: vec!["left_drive".into(), "right_drive".into()],
            positions: Vec::new(),
            velocities: Vec::new(),
            loads: Vec::new(),
            load: Load::Current,
        };
        for _ in 0..2 {
            joints.loads.push(wire.f32()?.into());
            for _duty_cycle_and_temperatures in 0..3 {
                wire.f32()?;
            }
            joints.velocities.push(wire.f32()?.into());
            joints.positions.push(wire.f32()?.into());
            let _fault = wire.u8()?;
        }
        for _ in 0..temperatures {
            wire.f32()?;
        }
        let (_commanded_mode, _actual_mode) = (wire.u8()?, wire.u8()?);
        Ok(joints)
    }
}

/// What a joint without a name is called, from its place.
pub(super) fn unnamed(index: usize) -> String {
    format!("{UNNAMED}{}", index + 1)
}

/// Start of the names of joints without a name.
pub(super) const UNNAMED: &str = "joint without name ";

#[cfg(test)]
mod tests {
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
            for name in kind.message_types() {
                assert_eq!(MessageKind::of_type(name), Some(kind));
            }
        }
    }

    #[test]
    fn fixes_of_another_writer() {
        for (encoding, text) in FIX {
            let bytes = bytes(text);
            let fix = Fix::decode(encoding, &bytes).unwrap();
            let header = MessageHeader {
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
    fn variances_of_a_fix_are_the_diagonal_unless_unknown() {
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
            let header = MessageHeader::decode(encoding, &bytes).unwrap();
            assert_eq!((header.stamp, &*header.frame), (STAMP, "gps"));
        }
    }

    #[test]
    fn joint_states_of_another_writer() {
        for (encoding, text) in JOINTS {
            let bytes = bytes(text);
            let joints = Joints::decode_type("sensor_msgs/JointState", encoding, &bytes).unwrap();
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
            assert!(Joints::decode_type("sensor_msgs/JointState", encoding, &bytes).is_err());
        }
    }
}
