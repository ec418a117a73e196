//! Why a file cannot be made a recording.

use super::message::MessageKind;
use super::wire::DecodeError;
use crate::display;
use std::error::Error;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// What stops an import.
#[derive(Debug)]
pub enum ImportError {
    /// A file that cannot be read.
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file of another format.
    Format {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: String,
        /// What to do.
        remedy: String,
    },
    /// A file that ends too early or is damaged.
    Broken {
        /// The file.
        path: PathBuf,
        /// Where \[bytes\].
        offset: u64,
        /// What is wrong there.
        reason: String,
        /// Messages before.
        messages: u64,
        /// From the first message to the last before \[s\].
        seconds: f64,
    },
    /// A message that does not fit its type.
    Message {
        /// The topic.
        topic: String,
        /// The type.
        message_type: String,
        /// Counted from 1 in its topic.
        number: u64,
        /// What is wrong.
        source: DecodeError,
    },
    /// A topic that was asked for and is not there, or is of another type.
    Topic {
        /// What it was asked for as.
        kind: MessageKind,
        /// The topic.
        topic: String,
        /// What is wrong with it.
        reason: String,
        /// What to write instead.
        remedy: String,
    },
    /// No topic that has wheel speeds.
    NoWheelSpeeds {
        /// The topics with their types.
        topics: Vec<String>,
    },
    /// Joints whose sides cannot be told, or that are not there.
    Joints {
        /// The topic.
        topic: String,
        /// What is wrong.
        reason: String,
        /// The joints.
        found: Vec<String>,
    },
    /// Columns that were asked for and cannot be had.
    Missing {
        /// What cannot be had, and why.
        reason: String,
        /// What to do.
        remedy: String,
    },
}

impl ImportError {
    /// What the user can do about it.
    #[must_use]
    pub fn remedy(&self) -> Option<String> {
        match self {
            Self::Format { remedy, .. }
            | Self::Topic { remedy, .. }
            | Self::Missing { remedy, .. } => Some(remedy.clone()),
            Self::Broken { messages: 0, .. } => None,
            Self::Broken { .. } => Some("--partial imports what comes before".into()),
            Self::NoWheelSpeeds { .. } => Some(
                "wheel speeds are required: record a topic of sensor_msgs/JointState that has the \
                 wheels' joints"
                    .into(),
            ),
            Self::Joints { .. } => {
                Some("name the wheels' joints: --left NAME,... --right NAME,...".into())
            }
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

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { path, .. } => write!(f, "cannot read {}", path.display()),
            Self::Format { path, found, .. } => write!(f, "{} is {found}", path.display()),
            Self::Broken {
                path,
                offset,
                reason,
                messages,
                seconds,
            } => write!(
                f,
                "{} is damaged near byte {offset}: {reason}; {messages} messages over {seconds:.3} s \
                 come before",
                path.display()
            ),
            Self::Message {
                topic,
                message_type,
                number,
                ..
            } => write!(f, "message {number} of {topic} is no {message_type}"),
            Self::Topic {
                kind,
                topic,
                reason,
                ..
            } => write!(f, "topic {topic} cannot serve as {}: {reason}", kind.name()),
            Self::NoWheelSpeeds { topics } => write!(
                f,
                "no topic has wheel speeds (sensor_msgs/JointState); the file has {}",
                listed(topics.join(", "))
            ),
            Self::Joints {
                topic,
                reason,
                found,
            } => write!(
                f,
                "{topic}: {reason}; its joints are {}",
                listed(display::listed(found, ", "))
            ),
            Self::Missing { reason, .. } => reason.fmt(f),
        }
    }
}

impl Error for ImportError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Read { source, .. } => Some(source),
            Self::Message { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// Texts one after the other.
fn listed(texts: String) -> String {
    if texts.is_empty() {
        "none".into()
    } else {
        texts
    }
}
