//! Options of an import.

use super::message::MessageKind;
use super::preset::Preset;
use super::request::TopicRequest;
use super::sample::Clock;
use super::side::WheelJoints;
use clap::ValueEnum;
use std::collections::BTreeMap;

/// Source of the pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PoseChoice {
    /// Odometry
    Odometry,
    /// Satellite fixes
    Fix,
}

/// Source of the heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HeadingChoice {
    /// The attitude in odometry
    Odometry,
    /// The attitude of the IMU
    Imu,
    /// No heading
    #[value(name = "none")]
    Without,
}

/// Options of an import; the default requests nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImportOptions {
    /// Requested topics; for other kinds the best one.
    pub topics: BTreeMap<MessageKind, TopicRequest>,
    /// The wheels' joints; a side without names is found by the joints' names.
    pub wheels: WheelJoints,
    /// Where the joints without names are, in their order: `FL,FR,RL,RR`.
    pub order: Vec<String>,
    /// The frames of the pose in topics of transforms: the parent and the child.
    pub frames: Option<[String; 2]>,
    /// A known vehicle, whose topics are preferred.
    pub preset: Option<Preset>,
    /// Whether the speeds of the left and the right wheels change their sign.
    pub invert: [bool; 2],
    /// Source of the pose; by default the best one.
    pub pose: Option<PoseChoice>,
    /// Source of the heading; by default that of the pose.
    pub heading: Option<HeadingChoice>,
    /// The clock of the samples.
    pub clock: Clock,
    /// Whether the z axis of the IMU points down.
    pub imu_z_down: bool,
    /// Whether a damaged file is imported up to the damage.
    pub partial: bool,
}
