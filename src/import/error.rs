//! Why a file cannot be made a recording.

use super::message::MessageKind;
use super::px4;
use super::wire::DecodeError;
use crate::display;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why an import fails.
#[derive(Debug, Error)]
pub enum ImportError {
    /// A file that cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A file of another format.
    #[error("{} is {found}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// A truncated or damaged file.
    #[error(
        "{} is damaged {place}: {reason}; {messages} messages over {seconds:.3} s come before",
        path.display()
    )]
    Broken {
        /// The file.
        path: PathBuf,
        /// Where.
        place: String,
        /// The damage.
        reason: String,
        /// Number of messages before it.
        messages: u64,
        /// From the first of them to the last \[s\].
        seconds: f64,
    },
    /// A message that does not fit its type.
    #[error("message {number} of {topic} is no {message_type}")]
    Message {
        /// The topic.
        topic: String,
        /// The type.
        message_type: String,
        /// Its number in the topic, from 1.
        number: u64,
        /// The fault.
        source: DecodeError,
    },
    /// A requested topic that is missing, or has another type.
    #[error("topic {topic} cannot serve as {}: {reason}", kind.name())]
    Topic {
        /// The requested use.
        kind: MessageKind,
        /// The topic.
        topic: String,
        /// Why it cannot serve.
        reason: String,
        /// What to do.
        remedy: String,
    },
    /// No topic has wheel speeds.
    #[error(
        "no topic has wheel speeds ({}); the file has {}",
        MessageKind::Joints.message_types().join(", "),
        or_none(topics.join(", "))
    )]
    NoWheelSpeeds {
        /// The topics with their types.
        topics: Vec<String>,
        /// Whether the log is one of PX4.
        is_px4: bool,
    },
    /// Joints of an unknown side, or missing joints.
    #[error(
        "{topic}: {reason}; its joints are {}",
        or_none(display::listed(found, ", "))
    )]
    Joints {
        /// The topic.
        topic: String,
        /// The fault.
        reason: String,
        /// The joints.
        found: Vec<String>,
        /// What to do.
        remedy: String,
    },
    /// Requested columns that are not available.
    #[error("{reason}")]
    Missing {
        /// What is missing, and why.
        reason: String,
        /// What to do.
        remedy: String,
    },
}

impl ImportError {
    /// What to do.
    #[must_use]
    pub fn remedy(&self) -> Option<String> {
        match self {
            Self::Format { remedy, .. }
            | Self::Topic { remedy, .. }
            | Self::Joints { remedy, .. }
            | Self::Missing { remedy, .. } => Some(remedy.clone()),
            Self::Broken { messages: 0, .. } => None,
            Self::Broken { .. } => Some("--partial imports what comes before".into()),
            Self::NoWheelSpeeds { is_px4: true, .. } => Some(format!(
                "wheel speeds are required: log the topic {}; actuator outputs and setpoints are commands, no measured \
                 speeds",
                px4::WHEEL_ENCODERS
            )),
            Self::NoWheelSpeeds { .. } => Some(
                "wheel speeds are required: record a topic of sensor_msgs/JointState that has the \
                 wheels' joints"
                    .into(),
            ),
            Self::Message { message_type, .. } => {
                let kind = MessageKind::of_type(message_type)
                    .filter(|kind| *kind != MessageKind::Joints)?;
                Some(format!(
                    "--topics {}=none leaves its topic out",
                    kind.name()
                ))
            }
            Self::Read { .. } => None,
        }
    }
}

fn or_none(text: String) -> String {
    if text.is_empty() { "none".into() } else { text }
}
