//! Samples of the chosen topics, without conversion.

use super::attitude::{Yaw, yaw};
use super::choose::TopicChoice;
use super::container::{self, Connection, ReadProgress};
use super::error::ImportError;
use super::message::{
    Decode, Fix, Imu, Joints, Load, MessageHeader, MessageKind, Odometry, Pose, Twist, has_twist,
};
pub(super) use super::sample::StampedSample;
use super::side::WheelJoints;
use super::survey::{Survey, Topic, bare};
use super::transforms::{Planar, TransformPath, composed};
use super::wire::{DecodeError, Encoding, unpacked};

/// Times \[ns\] with values.
pub(super) type TimedValues = Vec<(i64, f64)>;

/// The samples of a topic.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stream<T> {
    pub topic: Topic,
    /// Other topics with the same kind of samples.
    pub joined: Vec<Topic>,
    /// The frame of its velocities, in odometry.
    pub child_frame: String,
    pub samples: Vec<StampedSample<T>>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct OdometrySample {
    pub position: [f64; 2],
    pub yaw: Yaw,
    pub velocity: [f64; 2],
    pub yaw_rate: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct ImuSample {
    pub yaw: Option<Yaw>,
    /// In the sensor's axes \[rad/s\].
    pub angular_velocity: Option<[f64; 3]>,
    /// In the sensor's axes \[m/s^2\].
    pub acceleration: Option<[f64; 3]>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct FixSample {
    pub status: i8,
    /// Latitude, longitude \[deg\], altitude \[m\].
    pub place: [f64; 3],
    /// The larger standard deviation of east and north \[m\], as stated by the receiver.
    pub deviation: Option<f64>,
}

/// A joint in a message; NaN for missing values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct JointSample {
    pub position: f64,
    pub velocity: f64,
    /// Effort \[N m\] or current \[A\].
    pub load: f64,
}

impl JointSample {
    /// Takes missing values from another message of the same time; returns whether there was any.
    pub fn fill_from(&mut self, other: &Self) -> bool {
        let mut filled = false;
        for (own, other) in [
            (&mut self.position, other.position),
            (&mut self.velocity, other.velocity),
            (&mut self.load, other.load),
        ] {
            if own.is_nan() && !other.is_nan() {
                *own = other;
                filled = true;
            }
        }
        filled
    }
}

/// Left joints, then right ones, in the order of [`WheelJoints`].
pub(super) type WheelSample = Box<[JointSample]>;

/// The samples of all chosen topics.
pub(super) struct Collected {
    pub joints: Stream<WheelSample>,
    pub wheels: WheelJoints,
    pub odometry: Option<Stream<OdometrySample>>,
    pub imu: Option<Stream<ImuSample>>,
    pub fix: Option<Stream<FixSample>>,
    /// Velocities of a topic without poses.
    pub twist: Option<Stream<OdometrySample>>,
    /// What the load of a joint is measured in.
    pub load: Load,
    /// The samples of each step of the transforms.
    pub steps: Vec<Vec<StampedSample<Planar>>>,
}

/// The chosen topics.
pub(super) struct Choices<'s> {
    pub joints: TopicChoice<'s>,
    /// Other topics with wheels.
    pub joined: Vec<&'s Topic>,
    pub wheels: WheelJoints,
    /// The frames of the odometry, if it comes from transforms.
    pub path: Option<TransformPath>,
    pub odometry: Option<TopicChoice<'s>>,
    pub imu: Option<TopicChoice<'s>>,
    pub fix: Option<TopicChoice<'s>>,
    pub twist: Option<TopicChoice<'s>>,
}

impl<'s> Choices<'s> {
    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &TopicChoice<'s>> {
        let others = [&self.odometry, &self.imu, &self.fix, &self.twist];
        std::iter::once(&self.joints).chain(others.into_iter().flatten())
    }

    /// What was combined.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.joined.is_empty() {
            let names: Vec<&str> = self
                .joined
                .iter()
                .map(|topic| topic.name.as_str())
                .collect();
            notes.push(format!(
                "joints from {} together with {}: each has other wheels (--topics joints=TOPIC takes one alone)",
                self.joints.topic.name,
                names.join(", ")
            ));
        }
        if let Some(path) = &self.path {
            let frames = path.steps.iter().rev().map(|[_, parent]| parent.as_str());
            let frames: Vec<&str> = frames.collect();
            notes.push(format!(
                "pose from the transforms {} -> {} (--frames PARENT,CHILD chooses others), composed in the plane",
                frames.join(" -> "),
                path.child()
            ));
        }
        notes
    }
}

impl<T> Stream<T> {
    /// The stream with other values.
    pub fn map<U>(&self, value: impl Fn(&T) -> U) -> Stream<U> {
        let samples = self.samples.iter().map(|sample| StampedSample {
            stamp: sample.stamp,
            logged: sample.logged,
            value: value(&sample.value),
        });
        Stream {
            topic: self.topic.clone(),
            joined: self.joined.clone(),
            child_frame: self.child_frame.clone(),
            samples: samples.collect(),
        }
    }

    fn new(choice: &TopicChoice) -> Self {
        Self {
            topic: choice.topic.clone(),
            joined: Vec::new(),
            child_frame: String::new(),
            samples: Vec::new(),
        }
    }

    fn carries(&self, channel: &Connection) -> bool {
        let is = |topic: &Topic| {
            topic.name == channel.topic
                && topic.message_type == channel.message_type
                && topic.encoding == channel.encoding
        };
        is(&self.topic) || self.joined.iter().any(is)
    }

    fn push(&mut self, header: &MessageHeader, logged: i64, value: T) {
        self.samples.push(StampedSample {
            stamp: header.stamp,
            logged,
            value,
        });
    }

    /// The error of the message after the last one.
    fn refuse(&self, source: DecodeError) -> ImportError {
        ImportError::Message {
            topic: self.topic.name.clone(),
            message_type: self.topic.message_type.clone(),
            number: self.samples.len() as u64 + 1,
            source,
        }
    }
}

/// Reads the chosen topics.
///
/// # Errors
/// A file that cannot be read, and a message that does not decode. A damaged file is read up to the damage.
pub(super) fn collect(
    survey: &Survey,
    choices: &Choices,
    progress: &mut ReadProgress,
) -> Result<Collected, ImportError> {
    let mut all = Collected {
        joints: Stream {
            joined: choices
                .joined
                .iter()
                .map(|topic| (*topic).clone())
                .collect(),
            ..Stream::new(&choices.joints)
        },
        wheels: choices.wheels.clone(),
        odometry: choices.odometry.as_ref().map(Stream::new),
        imu: choices.imu.as_ref().map(Stream::new),
        fix: choices.fix.as_ref().map(Stream::new),
        twist: choices.twist.as_ref().map(Stream::new),
        load: Load::Effort,
        steps: vec![Vec::new(); choices.path.as_ref().map_or(0, |path| path.steps.len())],
    };
    let mut buffer = Vec::new();
    container::read(&survey.files, progress, &mut |channel, time, data| {
        let Some(encoding) = Encoding::of_name(&channel.encoding) else {
            return Ok(());
        };
        if MessageKind::of_type(&channel.message_type).is_none() {
            return Ok(());
        }
        let data = unpacked(data, &mut buffer);
        all.take(channel, choices.path.as_ref(), encoding, time, data)
    })?;
    if let (Some(path), Some(odometry)) = (&choices.path, &mut all.odometry) {
        odometry.child_frame = path.child();
        odometry.topic.frame = path.parent();
        let poses = composed(std::mem::take(&mut all.steps)).into_iter();
        odometry.samples = poses
            .map(|pose| StampedSample {
                stamp: pose.stamp,
                logged: pose.logged,
                value: pose_sample([pose.value[0], pose.value[1]], yaw_of(pose.value[2])),
            })
            .collect();
    }
    Ok(all)
}

impl Collected {
    fn take(
        &mut self,
        channel: &Connection,
        path: Option<&TransformPath>,
        encoding: Encoding,
        logged: i64,
        data: &[u8],
    ) -> Result<(), ImportError> {
        if self.joints.carries(channel) {
            let stream = &mut self.joints;
            let message = Joints::decode_type(&channel.message_type, encoding, data)
                .map_err(|error| stream.refuse(error))?;
            self.load = message.load;
            let value = wheel_sample(&message, &self.wheels);
            stream.push(&message.header, logged, value);
        } else if let Some(stream) = carrying(&mut self.odometry, channel)
            && !has_twist(&channel.message_type)
        {
            let poses = Pose::decode_all(&channel.message_type, encoding, data)
                .map_err(|error| stream.refuse(error))?;
            for pose in poses {
                let [x, y, _] = pose.position;
                match path {
                    None => {
                        if stream.samples.is_empty() {
                            stream.child_frame = pose.child_frame.clone().into_owned();
                        }
                        let value = pose_sample([x, y], yaw(pose.orientation));
                        stream.push(&pose.header, logged, value);
                    }
                    Some(path) => {
                        let frames = [bare(&pose.child_frame), bare(&pose.header.frame)];
                        let step = path.steps.iter().position(|step| step[..] == frames);
                        if let (Some(step), Yaw::Of(yaw) | Yaw::Normalised(yaw)) =
                            (step, yaw(pose.orientation))
                        {
                            self.steps[step].push(StampedSample {
                                stamp: pose.header.stamp,
                                logged,
                                value: [x, y, yaw],
                            });
                        }
                    }
                }
            }
        } else if let Some(stream) = carrying(&mut self.twist, channel) {
            let message = Twist::decode_type(&channel.message_type, encoding, data)
                .map_err(|error| stream.refuse(error))?;
            let [v_x, v_y, _] = message.velocity;
            let value = OdometrySample {
                velocity: [v_x, v_y],
                yaw_rate: message.angular_velocity[2],
                ..pose_sample([f64::NAN; 2], Yaw::None)
            };
            stream.push(&message.header, logged, value);
        } else if let Some(stream) = carrying(&mut self.odometry, channel) {
            let message = Odometry::decode_type(&channel.message_type, encoding, data)
                .map_err(|error| stream.refuse(error))?;
            if stream.samples.is_empty() {
                stream.child_frame = message.child_frame.clone().into_owned();
            }
            let [x, y, _] = message.position;
            let [v_x, v_y, _] = message.velocity;
            let value = OdometrySample {
                position: [x, y],
                yaw: yaw(message.orientation),
                velocity: [v_x, v_y],
                yaw_rate: message.angular_velocity[2],
            };
            stream.push(&message.header, logged, value);
        } else if let Some(stream) = carrying(&mut self.imu, channel) {
            let message = Imu::decode_type(&channel.message_type, encoding, data)
                .map_err(|error| stream.refuse(error))?;
            let value = ImuSample {
                yaw: message.orientation.map(yaw),
                angular_velocity: message.angular_velocity,
                acceleration: message.acceleration,
            };
            stream.push(&message.header, logged, value);
        } else if let Some(stream) = carrying(&mut self.fix, channel) {
            let message = Fix::decode(encoding, data).map_err(|error| stream.refuse(error))?;
            let value = FixSample {
                status: message.status,
                place: [message.latitude, message.longitude, message.altitude],
                deviation: message.variances.and_then(deviation),
            };
            stream.push(&message.header, logged, value);
        }
        Ok(())
    }
}

/// A pose without velocities.
fn pose_sample(position: [f64; 2], yaw: Yaw) -> OdometrySample {
    OdometrySample {
        position,
        yaw,
        velocity: [f64::NAN; 2],
        yaw_rate: f64::NAN,
    }
}

/// A heading within (-pi, pi\].
fn yaw_of(heading: f64) -> Yaw {
    Yaw::Of(heading.sin().atan2(heading.cos()))
}

/// The larger of two standard deviations; publishers that do not know them send zeros.
fn deviation([east, north]: [f64; 2]) -> Option<f64> {
    let known = [east, north]
        .iter()
        .all(|variance| *variance > 0.0 && variance.is_finite());
    known.then(|| east.max(north).sqrt())
}

fn carrying<'a, T>(
    stream: &'a mut Option<Stream<T>>,
    channel: &Connection,
) -> Option<&'a mut Stream<T>> {
    stream.as_mut().filter(|stream| stream.carries(channel))
}

fn wheel_sample(message: &Joints, wheels: &WheelJoints) -> WheelSample {
    let sample = |wanted: &String| {
        let place = message.names.iter().position(|name| name == wanted);
        let value = |values: &[f64]| {
            // The values of a shorter list cannot be assigned to names.
            let whole = values.len() == message.names.len();
            place
                .filter(|_| whole)
                .map_or(f64::NAN, |place| values[place])
        };
        JointSample {
            position: value(&message.positions),
            velocity: value(&message.velocities),
            load: value(&message.loads),
        }
    };
    wheels
        .left
        .iter()
        .chain(&wheels.right)
        .map(sample)
        .collect()
}
