//! Recordings from robots' logs: MCAP files, bags of ROS 1 and ROS 2 and logs of PX4, with wheel speeds, poses, inertial
//! measurements and satellite fixes.
//!
//! A log is read twice from front to back: first for its topics ([`survey()`]), then for the samples of the chosen ones
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
mod preset;
mod px4;
mod request;
mod sample;
mod side;
mod survey;
mod table;
mod track;
mod transforms;
mod twist;
mod wheels;
mod wire;

pub use choose::{TopicChoice, choose};
pub use clock::Clock;
pub use columns::Column;
pub use container::{Container, Ending, LOG_ENDINGS, ReadProgress, is_log};
pub use error::ImportError;
pub use message::MessageKind;
pub use options::{HeadingChoice, ImportOptions, PoseChoice};
pub use preset::Preset;
pub use request::TopicRequest;
pub use side::WheelJoints;
pub use survey::{Survey, Topic, survey};
pub use wire::{DecodeError, Encoding};

use crate::recording::IMPORT_WARNING;
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
    let mut notes = survey.notes.clone();
    if let Ending::Broken { place, reason } = &survey.ending {
        let error = ImportError::Broken {
            path: path.into(),
            place: place.clone(),
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
    notes.extend(choices.notes());
    let is_taken = |kind: MessageKind| choices.all().any(|choice| choice.kind == kind);
    let is_refused = |kind: &MessageKind| {
        !is_taken(*kind) && options.topics.get(kind) != Some(&TopicRequest::Without)
    };
    let missing = MessageKind::ALL.into_iter().filter(is_refused);
    notes.extend(missing.filter_map(|kind| choose::set_aside(survey, kind)));
    let collected = collect(survey, &choices, progress)?;
    let child_frame = |kind| match &collected.odometry {
        Some(odometry) if kind == MessageKind::Odometry => odometry.child_frame.clone(),
        _ => String::new(),
    };
    let joined = choices
        .joined
        .iter()
        .map(|topic| (MessageKind::Joints, *topic));
    let topics = choices.all().map(|choice| (choice.kind, choice.topic));
    let topics = topics.chain(joined).map(|(kind, topic)| UsedTopic {
        kind,
        topic: topic.clone(),
        child_frame: child_frame(kind),
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
    let pick = |kind: MessageKind| choose(survey, kind, options);
    let Some(joints) = pick(MessageKind::Joints)? else {
        let describe = |topic: &Topic| match topic.kind() {
            None if MessageKind::of_type(&topic.message_type).is_some() => format!(
                "{} ({} in the encoding `{}`, which cannot be read)",
                topic.name, topic.message_type, topic.encoding
            ),
            _ => format!("{} ({})", topic.name, topic.message_type),
        };
        let topics = survey.topics.iter().map(describe).collect();
        let is_px4 = survey.container == Container::Ulog;
        return Err(ImportError::NoWheelSpeeds { topics, is_px4 });
    };
    let joined = choose::joined(survey, &joints, &options.wheels);
    let topics = std::iter::once(joints.topic).chain(joined.iter().copied());
    let odometry = pick(MessageKind::Odometry)?;
    let path = odometry
        .as_ref()
        .map(|choice| transforms::path(choice.topic, options.frames.as_ref()));
    Ok(Choices {
        wheels: choose::pick_wheels(topics, options)?,
        joints,
        joined,
        path: path.transpose()?.flatten(),
        odometry,
        imu: pick(MessageKind::Imu)?,
        fix: pick(MessageKind::Fix)?,
        twist: pick(MessageKind::Twist)?,
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

    /// What its notes warn of.
    pub fn warnings(&self) -> impl Iterator<Item = &str> {
        let warnings = self.notes.iter();
        warnings.filter_map(|note| note.strip_prefix(IMPORT_WARNING))
    }

    /// The sources of everything, for the JSON file beside the recording.
    #[must_use]
    pub fn provenance(&self, path: &Path, survey: &Survey) -> Value {
        let topics: Vec<Value> = self.topics.iter().map(describe_topic).collect();
        let columns = self.columns.iter().map(|column| {
            let origin = json!({
                "topic": column.topic,
                "conversion": column.conversion,
                "unit": column.unit,
                "samples": column.samples.len(),
            });
            (column.name.to_owned(), origin)
        });
        let name = path.file_name().unwrap_or(path.as_os_str());
        let start = match survey.container {
            Container::Ulog => "start_since_boot_s",
            _ => "start_unix_s",
        };
        json!({
            "tool": concat!("ugv import ", env!("CARGO_PKG_VERSION")),
            "file": name.to_string_lossy(),
            "container": survey.container.name(),
            "damaged": survey.ending != Ending::Whole,
            "clock": self.clock.name(),
            start: table::seconds(self.start),
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
