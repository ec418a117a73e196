//! The four kinds of message that a recording is made from. Their definitions have not changed
//! since 2010 but for the header's counter, which ROS 2 dropped.

use super::wire::{DecodeError, Encoding, Wire};
use std::borrow::Cow;

/// What a topic carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MessageKind {
    /// `sensor_msgs/JointState`: wheel speeds.
    Joints,
    /// `nav_msgs/Odometry`: pose and velocities.
    Odometry,
    /// `sensor_msgs/Imu`: yaw rate, accelerations, attitude.
    Imu,
    /// `sensor_msgs/NavSatFix`: position on the earth.
    Fix,
}

impl MessageKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Joints, Self::Odometry, Self::Imu, Self::Fix];

    /// The name under which a user picks a topic.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Joints => "joints",
            Self::Odometry => "odometry",
            Self::Imu => "imu",
            Self::Fix => "fix",
        }
    }

    /// The type as ROS 1 writes it.
    #[must_use]
    pub fn message_type(self) -> &'static str {
        match self {
            Self::Joints => "sensor_msgs/JointState",
            Self::Odometry => "nav_msgs/Odometry",
            Self::Imu => "sensor_msgs/Imu",
            Self::Fix => "sensor_msgs/NavSatFix",
        }
    }

    /// Of a type as ROS 1 (`sensor_msgs/Imu`) or ROS 2 (`sensor_msgs/msg/Imu`) writes it.
    #[must_use]
    pub fn of_type(name: &str) -> Option<Self> {
        let name = name.replacen("/msg/", "/", 1);
        Self::ALL
            .into_iter()
            .find(|kind| kind.message_type() == name)
    }
}

/// When and in which frame something was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Header<'a> {
    /// Time of measurement \[ns\] since 1970; zero where the publisher did not set it.
    pub stamp: i64,
    /// The frame's name.
    pub frame: Cow<'a, str>,
}

impl<'a> Header<'a> {
    /// That of a message of any kind: all begin with it.
    pub(super) fn decode(encoding: Encoding, bytes: &'a [u8]) -> Result<Self, DecodeError> {
        Self::read(&mut Wire::new(encoding, bytes)?)
    }

    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        if wire.encoding() == Encoding::Ros1 {
            let _counter = wire.u32()?;
        }
        let seconds = match wire.encoding() {
            Encoding::Ros1 => i64::from(wire.u32()?),
            Encoding::Cdr => i64::from(wire.i32()?),
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
        let mut wire = Wire::new(encoding, bytes)?;
        let message = Self::read(&mut wire)?;
        wire.finish()?;
        Ok(message)
    }
}

/// `nav_msgs/Odometry` without its covariances.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Odometry<'a> {
    pub header: Header<'a>,
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

impl<'a> Decode<'a> for Odometry<'a> {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        let (header, child_frame) = (Header::read(wire)?, wire.text()?);
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

/// `sensor_msgs/Imu`; nothing where a covariance begins with -1, which says "not measured".
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Imu<'a> {
    pub header: Header<'a>,
    /// x, y, z, w: from the sensor's frame to one that is fixed to the earth.
    pub orientation: Option<[f64; 4]>,
    /// In the sensor's frame \[rad/s\].
    pub angular_velocity: Option<[f64; 3]>,
    /// Specific force in the sensor's frame: +9.81 upwards at rest \[m/s^2\].
    pub acceleration: Option<[f64; 3]>,
}

impl<'a> Decode<'a> for Imu<'a> {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        fn measured<const N: usize>(wire: &mut Wire) -> Result<Option<[f64; N]>, DecodeError> {
            let value = wire.f64s()?;
            let covariance: [f64; 9] = wire.f64s()?;
            Ok((covariance[0] != -1.0).then_some(value))
        }
        Ok(Self {
            header: Header::read(wire)?,
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
    pub header: Header<'a>,
    /// Below zero: no fix.
    pub status: i8,
    /// WGS-84 \[deg\].
    pub latitude: f64,
    /// WGS-84 \[deg\].
    pub longitude: f64,
    /// Above the ellipsoid \[m\]; NaN where there is none.
    pub altitude: f64,
    /// East and north \[m^2\]; nothing where the message says that they are not known.
    pub variances: Option<[f64; 2]>,
}

impl<'a> Decode<'a> for Fix<'a> {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        let (header, status, _service) = (Header::read(wire)?, wire.i8()?, wire.u16()?);
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

/// `sensor_msgs/JointState` without its efforts. A list that was not measured is empty.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Joints<'a> {
    pub header: Header<'a>,
    pub names: Vec<Cow<'a, str>>,
    /// \[rad\].
    pub positions: Vec<f64>,
    /// \[rad/s\].
    pub velocities: Vec<f64>,
}

impl<'a> Decode<'a> for Joints<'a> {
    fn read(wire: &mut Wire<'a>) -> Result<Self, DecodeError> {
        let (header, names) = (Header::read(wire)?, wire.list(Wire::text)?);
        let (positions, velocities) = (wire.list(Wire::f64)?, wire.list(Wire::f64)?);
        let _efforts = wire.list(Wire::f64)?;
        Ok(Self {
            header,
            names,
            positions,
            velocities,
        })
    }
}

#[cfg(test)]
mod tests;
