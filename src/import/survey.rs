//! The topics of a file of messages.

use super::container::{self, Connection, Container, Ending, LogFile, ReadProgress};
use super::error::ImportError;
use super::message::{Joints, MessageHeader, MessageKind, Pose, UNNAMED, is_transforms};
use super::px4;
use super::wire::{Encoding, unpacked};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A topic.
#[derive(Debug, Clone, PartialEq)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// Type name of its messages.
    pub message_type: String,
    /// Name of their encoding.
    pub encoding: String,
    /// Number of messages.
    pub messages: u64,
    /// Earliest and latest time of logging \[ns\] since 1970.
    pub logged: [i64; 2],
    /// Frame of its first message, if the import supports it.
    pub frame: String,
    /// Its joints, if it has any.
    pub joints: BTreeSet<String>,
    /// Its transforms, from each child's frame to its parent's, with their numbers.
    pub transforms: BTreeMap<[String; 2], u64>,
}

/// Number of joints or frames beyond which a topic is not searched for more.
const MOST: usize = 10_000;

impl Topic {
    pub(super) fn new(channel: &Connection, time: i64) -> Self {
        Self {
            name: channel.topic.clone(),
            message_type: channel.message_type.clone(),
            encoding: channel.encoding.clone(),
            messages: 0,
            logged: [time; 2],
            frame: String::new(),
            joints: BTreeSet::new(),
            transforms: BTreeMap::new(),
        }
    }

    /// Whether its joints have no names.
    pub(super) fn has_unnamed_joints(&self) -> bool {
        self.joints.iter().any(|name| name.starts_with(UNNAMED))
    }

    /// Adds the names in a message. One that does not decode is reported when the topic is read.
    fn learn(&mut self, encoding: Encoding, data: &[u8]) {
        match self.kind() {
            Some(MessageKind::Joints) if self.joints.len() < MOST => {
                let joints = Joints::decode_type(&self.message_type, encoding, data);
                for name in joints.map_or(Vec::new(), |joints| joints.names) {
                    if !self.joints.contains(name.as_ref()) {
                        self.joints.insert(name.into_owned());
                    }
                }
            }
            Some(MessageKind::Odometry) if is_transforms(&self.message_type) => {
                let poses = Pose::decode_all(&self.message_type, encoding, data);
                for pose in poses.unwrap_or_default() {
                    let frames = [pose.child_frame, pose.header.frame];
                    let frames = frames.map(|frame| bare(&frame).to_owned());
                    if self.transforms.len() < MOST || self.transforms.contains_key(&frames) {
                        *self.transforms.entry(frames).or_default() += 1;
                    }
                }
            }
            _ => {}
        }
    }

    /// Kind of its messages, if the import supports it.
    #[must_use]
    pub fn kind(&self) -> Option<MessageKind> {
        let is_px4 = Encoding::of_name(&self.encoding)? == Encoding::Ulog;
        let is_fitting = px4::layout(&self.message_type).is_some() == is_px4;
        MessageKind::of_type(&self.message_type).filter(|_| is_fitting)
    }

    /// From the first message to the last \[s\].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        (self.logged[1] - self.logged[0]) as f64 * 1e-9
    }

    /// Messages per second; `None` with fewer than two.
    #[must_use]
    pub fn rate(&self) -> Option<f64> {
        let seconds = self.seconds();
        (seconds > 0.0).then(|| (self.messages - 1) as f64 / seconds)
    }
}

/// A frame's name without the slash that ROS 1 may put before it.
pub(super) fn bare(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

/// The content of a log.
#[derive(Debug, Clone)]
pub struct Survey {
    /// The format of its first file.
    pub container: Container,
    /// Its files.
    pub(super) files: Vec<LogFile>,
    /// What the choice of files needs to say.
    pub notes: Vec<String>,
    /// Its topics in alphabetical order.
    pub topics: Vec<Topic>,
    /// How the reading ended.
    pub ending: Ending,
}

impl Survey {
    /// Number of messages in all topics.
    #[must_use]
    pub fn messages(&self) -> u64 {
        self.topics.iter().map(|topic| topic.messages).sum()
    }

    /// First and last time of logging \[ns\] since 1970.
    #[must_use]
    pub fn logged(&self) -> Option<[i64; 2]> {
        let first = self.topics.iter().map(|topic| topic.logged[0]).min()?;
        let last = self.topics.iter().map(|topic| topic.logged[1]).max()?;
        Some([first, last])
    }
}

/// Reads a log for its topics: a file, or the folder of a bag.
///
/// # Errors
/// A file that cannot be read or is no file of messages. Damage is no error: the survey ends there.
pub fn survey(path: &Path, progress: &mut ReadProgress) -> Result<Survey, ImportError> {
    let (files, mut notes) = container::open(path)?;
    if files.iter().any(|file| file.container == Container::Ulog) {
        notes.extend(px4::NOTES.map(Into::into));
    }
    let mut topics: BTreeMap<Connection, Topic> = BTreeMap::new();
    let mut buffer = Vec::new();
    let ending = container::read(&files, progress, &mut |channel, time, data| {
        let encoding = Encoding::of_name(&channel.encoding);
        let is_known = MessageKind::of_type(&channel.message_type).is_some();
        let data = if is_known {
            unpacked(data, &mut buffer)
        } else {
            data
        };
        if !topics.contains_key(channel) {
            let mut topic = Topic::new(channel, time);
            if let (Some(_), Some(encoding)) = (topic.kind(), encoding)
                && !is_transforms(&topic.message_type)
                && let Ok(header) = MessageHeader::decode(encoding, data)
            {
                topic.frame = header.frame.into_owned();
            }
            topics.insert(channel.clone(), topic);
        }
        let Some(topic) = topics.get_mut(channel) else {
            return Ok(());
        };
        topic.messages += 1;
        topic.logged = [topic.logged[0].min(time), topic.logged[1].max(time)];
        if let Some(encoding) = encoding {
            topic.learn(encoding, data);
        }
        Ok(())
    })?;
    Ok(Survey {
        container: files.first().map_or(Container::Mcap, |file| file.container),
        files,
        notes,
        topics: topics.into_values().collect(),
        ending,
    })
}
