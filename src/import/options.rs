//! What a user may ask of an import.

use super::choose::Wish;
use super::clock::Clock;
use super::message::MessageKind;
use super::side::WheelJoints;
use std::collections::BTreeMap;

/// Where the pose comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pose {
    /// From odometry.
    Odometry,
    /// From satellite fixes.
    Fix,
}

/// Where the heading comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heading {
    /// From the attitude in odometry.
    Odometry,
    /// From the attitude of the IMU.
    Imu,
    /// There is to be none.
    Without,
}

/// What a user may ask of an import; the default asks for nothing.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Options {
    /// Topics; of kinds that are not there, any.
    pub topics: BTreeMap<MessageKind, Wish>,
    /// The wheels' joints; a side without names is found by the joints' names.
    pub wheels: WheelJoints,
    /// Whether the left and the right wheels' speeds change their sign.
    pub invert: [bool; 2],
    /// Where the pose comes from; nothing leaves it to what there is.
    pub pose: Option<Pose>,
    /// Where the heading comes from; nothing leaves it to where the pose comes from.
    pub heading: Option<Heading>,
    /// Which of a message's times counts.
    pub clock: Clock,
    /// Whether the z axis of the IMU points down.
    pub imu_z_down: bool,
    /// Whether what comes before the damage in a damaged file will do.
    pub partial: bool,
}
