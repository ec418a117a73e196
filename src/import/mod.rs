//! Recordings from robots' logs: MCAP files and ROS 1 bags with joint states, odometry, inertial measurements and satellite
//! fixes.
//!
//! A file is read twice from front to back: first for its topics ([`survey()`]), then for the samples of the chosen ones
//! ([`import`]). Memory holds a chunk of the file and the samples.

mod attitude;
mod checks;
mod choose;
mod clock;
mod collect;
mod columns;
mod container;
mod convert;
mod error;
mod fixes;
mod geodesy;
mod message;
mod mounting;
mod options;
mod plan;
mod side;
mod survey;
mod table;
mod track;
mod twist;
mod wheels;
mod wire;

pub use choose::{TopicChoice, TopicRequest, choose};
pub use clock::Clock;
pub use columns::Column;
pub use container::{Container, Ending, ReadProgress};
pub use error::ImportError;
pub use message::MessageKind;
pub use options::{HeadingChoice, ImportOptions, PoseChoice};
pub use side::WheelJoints;
pub use survey::{Survey, Topic, survey};
pub use wire::{DecodeError, Encoding};

use collect::{Choices, collect};
use serde_json::{Value, json};
use std::io;
use std::path::Path;

/// A source topic of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct UsedTopic {
    /// Kind of its messages.
    pub kind: MessageKind,
    /// The topic.
    pub topic: Topic,
    /// The frame of its velocities, in odometry.
    pub child_frame: String,
}

/// A recording with its sources.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The columns except the time, including the two wheel speeds.
    pub columns: Vec<Column>,
    /// The time that counts as zero \[ns\] since 1970.
    pub start: i64,
    /// The clock of its times.
    pub clock: Clock,
    /// The topics.
    pub topics: Vec<UsedTopic>,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// Makes a recording from a surveyed file.
///
/// # Errors
/// No wheel speeds, missing topics or joints, messages that do not decode, and a damaged file unless the options allow it.
pub fn import(
    path: &Path,
    survey: &Survey,
    options: &ImportOptions,
    progress: &mut ReadProgress,
) -> Result<Imported, ImportError> {
    let mut notes = Vec::new();
    if let Ending::Broken { offset, reason } = &survey.ending {
        let error = ImportError::Broken {
            path: path.into(),
            offset: *offset,
            reason: reason.clone(),
            messages: survey.messages(),
            seconds: survey
                .logged()
                .map_or(0.0, |[first, last]| (last - first) as f64 * 1e-9),
        };
        if !options.partial || survey.messages() == 0 {
            return Err(error);
        }
        notes.push(format!("warning: {error}; these were imported"));
    }
    let choices = choices(survey, options)?;
    notes.extend(choices.all().filter_map(TopicChoice::note));
    let collected = collect(path, survey, &choices, progress)?;
    let child_frame = |kind| match &collected.odometry {
        Some(odometry) if kind == MessageKind::Odometry => odometry.child_frame.clone(),
        _ => String::new(),
    };
    let topics = choices.all().map(|choice| UsedTopic {
        kind: choice.kind,
        topic: choice.topic.clone(),
        child_frame: child_frame(choice.kind),
    });
    let topics = topics.collect();
    let converted = convert::convert(collected, options)?;
    notes.extend(converted.notes);
    let firsts = converted
        .columns
        .iter()
        .filter_map(|column| column.samples.first());
    Ok(Imported {
        start: firsts.map(|(time, _)| *time).min().unwrap_or(0),
        columns: converted.columns,
        clock: converted.clock,
        topics,
        notes,
    })
}

/// The topics of the recording.
fn choices<'s>(survey: &'s Survey, options: &ImportOptions) -> Result<Choices<'s>, ImportError> {
    let wheels = &options.wheels;
    let pick = |kind: MessageKind| {
        let wish = options.topics.get(&kind).unwrap_or(&TopicRequest::Any);
        choose(survey, kind, wish, wheels)
    };
    let Some(joints) = pick(MessageKind::Joints)? else {
        let describe = |topic: &Topic| match topic.kind() {
            None if MessageKind::of_type(&topic.message_type).is_some() => format!(
                "{} ({} in the encoding `{}`, which cannot be read)",
                topic.name, topic.message_type, topic.encoding
            ),
            _ => format!("{} ({})", topic.name, topic.message_type),
        };
        let topics = survey.topics.iter().map(describe).collect();
        return Err(ImportError::NoWheelSpeeds { topics });
    };
    Ok(Choices {
        wheels: choose::pick_wheels(joints.topic, wheels)?,
        joints,
        odometry: pick(MessageKind::Odometry)?,
        imu: pick(MessageKind::Imu)?,
        fix: pick(MessageKind::Fix)?,
    })
}

impl Imported {
    /// Writes the recording as CSV and returns the number of its rows.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, to: impl io::Write) -> io::Result<u64> {
        table::write(&self.columns, self.start, to)
    }

    /// From the first sample to the last \[s\].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        let lasts = self
            .columns
            .iter()
            .filter_map(|column| column.samples.last());
        let last = lasts.map(|(time, _)| *time).max().unwrap_or(self.start);
        (last - self.start) as f64 * 1e-9
    }

    /// The sources of everything, for the JSON file beside the recording.
    #[must_use]
    pub fn provenance(&self, path: &Path, survey: &Survey) -> Value {
        let topics: Vec<Value> = self.topics.iter().map(describe_topic).collect();
        let columns = self.columns.iter().map(|column| {
            let origin = json!({
                "topic": column.topic,
                "conversion": column.conversion,
                "unit": column.channel.unit(),
                "samples": column.samples.len(),
            });
            (column.channel.name().to_owned(), origin)
        });
        let name = path.file_name().unwrap_or(path.as_os_str());
        json!({
            "tool": concat!("ugv import ", env!("CARGO_PKG_VERSION")),
            "file": name.to_string_lossy(),
            "container": survey.container.name(),
            "damaged": survey.ending != Ending::Whole,
            "clock": self.clock.name(),
            "start_unix_s": table::seconds(self.start),
            "topics": topics,
            "columns": Value::Object(columns.collect()),
            "notes": self.notes,
        })
    }
}

fn describe_topic(used: &UsedTopic) -> Value {
    let mut topic = json!({
        "serves_as": used.kind.name(),
        "topic": used.topic.name,
        "type": used.topic.message_type,
        "encoding": used.topic.encoding,
        "messages": used.topic.messages,
        "frame": used.topic.frame,
    });
    if used.kind == MessageKind::Odometry {
        topic["child_frame"] = Value::String(used.child_frame.clone());
    }
    topic
}
