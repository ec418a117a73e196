//! The topics of a file of messages.

use super::container::{self, Connection, Container, Ending, ReadProgress};
use super::error::ImportError;
use super::message::{Decode, Joints, MessageHeader, MessageKind};
use super::wire::Encoding;
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
}

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
        }
    }

    /// Kind of its messages, if the import supports it.
    #[must_use]
    pub fn kind(&self) -> Option<MessageKind> {
        Encoding::of_name(&self.encoding)?;
        MessageKind::of_type(&self.message_type)
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

/// The content of a file of messages.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The file's format.
    pub container: Container,
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

/// Reads a file for its topics.
///
/// # Errors
/// A file that cannot be read or is no file of messages. Damage is no error: the survey ends there.
pub fn survey(path: &Path, progress: &mut ReadProgress) -> Result<Survey, ImportError> {
    let container = container::container(path)?;
    let mut topics: BTreeMap<Connection, Topic> = BTreeMap::new();
    let ending = container::read(path, container, progress, &mut |channel, time, data| {
        if !topics.contains_key(channel) {
            let mut topic = Topic::new(channel, time);
            if let (Some(_), Some(encoding)) = (topic.kind(), Encoding::of_name(&topic.encoding))
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
        if let (Some(MessageKind::Joints), Some(encoding)) =
            (topic.kind(), Encoding::of_name(&topic.encoding))
        {
            // A message that does not decode is reported when the topic is read.
            for name in Joints::decode(encoding, data).map_or(Vec::new(), |joints| joints.names) {
                if !topic.joints.contains(name.as_ref()) {
                    topic.joints.insert(name.into_owned());
                }
            }
        }
        Ok(())
    })?;
    Ok(Survey {
        container,
        topics: topics.into_values().collect(),
        ending,
    })
}
