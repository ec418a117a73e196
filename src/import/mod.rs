//! Recordings from robots' logs: MCAP files and ROS 1 bags with joint states, odometry, inertial
//! measurements and satellite fixes become the columns of a recording.
//!
//! A file is read twice from front to back, first for its topics ([`survey()`]), then for the
//! samples of the chosen ones ([`import`]); memory holds a chunk of the file and the samples.

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

pub use choose::{Choice, Wish, choose};
pub use clock::Clock;
pub use columns::Column;
pub use container::{Container, Ending, ReadProgress};
pub use error::ImportError;
pub use message::MessageKind;
pub use options::{Heading, Options, Pose};
pub use side::{WheelJoints, guess};
pub use survey::{Survey, Topic, survey};
pub use wire::{DecodeError, Encoding};

use collect::{Choices, Stream, collect};
use serde_json::{Value, json};
use std::io;
use std::path::Path;

/// A topic that the recording was made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Used {
    /// What it served as.
    pub kind: MessageKind,
    /// The topic.
    pub topic: Topic,
    /// The frame of its velocities, in odometry.
    pub child_frame: String,
}

/// A recording, and how it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// Its columns but the time, at least the two wheel speeds.
    pub columns: Vec<Column>,
    /// The time that counts as zero \[ns\] since 1970.
    pub start: i64,
    /// Which of the messages' times counts.
    pub clock: Clock,
    /// The topics.
    pub topics: Vec<Used>,
    /// What the user ought to know.
    pub notes: Vec<String>,
}

/// Makes a recording of a file that was surveyed.
///
/// # Errors
/// No wheel speeds, topics or joints that are not there, messages that do not decode, and a
/// damaged file unless the options allow for it.
pub fn import(
    path: &Path,
    survey: &Survey,
    options: &Options,
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
    let all = [
        Some(&choices.joints),
        choices.odometry.as_ref(),
        choices.imu.as_ref(),
        choices.fix.as_ref(),
    ];
    notes.extend(all.into_iter().flatten().filter_map(Choice::note));
    let collected = collect(path, survey, &choices, progress)?;
    let mut topics = vec![used(&collected.joints)];
    topics.extend(collected.odometry.as_ref().map(used));
    topics.extend(collected.imu.as_ref().map(used));
    topics.extend(collected.fix.as_ref().map(used));
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

fn used<T>(stream: &Stream<T>) -> Used {
    Used {
        kind: stream.kind,
        topic: stream.topic.clone(),
        child_frame: stream.child_frame.clone(),
    }
}

/// The topics that serve.
fn choices<'s>(survey: &'s Survey, options: &Options) -> Result<Choices<'s>, ImportError> {
    let wheels = &options.wheels;
    let pick = |kind: MessageKind| {
        let wish = options.topics.get(&kind).unwrap_or(&Wish::Any);
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
    /// Whatever the writer refuses.
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

    /// Where everything comes from, for the file beside the recording.
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

fn describe_topic(used: &Used) -> Value {
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
