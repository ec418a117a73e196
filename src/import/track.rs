//! Samples by time, and the wheel speeds among them.

use super::checks::mirrored;
use super::clock::{Clock, ordered};
use super::collect::{Stream, TimedValues, WheelSample};
use super::columns::ColumnBuilder;
use super::error::ImportError;
use super::side::WheelJoints;
use super::wheels::{JointSpeeds, Source, together, wheel_speeds};
use crate::recording::Channel;

/// A topic's samples by time.
pub(super) struct Track<T> {
    pub topic: String,
    pub samples: Vec<(i64, T)>,
}

impl<T> Track<T> {
    pub fn of(stream: Stream<T>, clock: Clock, notes: &mut Vec<String>) -> Self {
        Self::filling(stream, clock, notes, |_, _| false)
    }

    fn filling(
        stream: Stream<T>,
        clock: Clock,
        notes: &mut Vec<String>,
        fills: impl Fn(&mut T, &T) -> bool,
    ) -> Self {
        let topic = stream.topic.name.clone();
        let (samples, note) = ordered(stream, clock, fills);
        notes.extend(note);
        Self { topic, samples }
    }
}

impl Track<WheelSample> {
    /// Arm and wheels, or the two sides, may publish messages with equal times.
    pub fn of_joints(stream: Stream<WheelSample>, clock: Clock, notes: &mut Vec<String>) -> Self {
        let mut stream = stream;
        for joined in &stream.joined {
            stream.topic.name += &format!(", {}", joined.name);
        }
        Self::filling(stream, clock, notes, |first, other| {
            let pairs = first.iter_mut().zip(other);
            pairs.fold(false, |filled, (a, b)| a.fill_from(b) | filled)
        })
    }
}

/// Adds the wheel speeds, and returns them.
///
/// # Errors
/// A side without any.
pub(super) fn wheels(
    joints: &Track<WheelSample>,
    names: &WheelJoints,
    invert: [bool; 2],
    columns: &mut ColumnBuilder,
) -> Result<[TimedValues; 2], ImportError> {
    let topic = &joints.topic;
    let together = together(&joints.samples, names.left.len());
    if together.is_some() {
        columns.notes.push(format!(
            "{topic}: the wheels of a side come in separate messages; each is taken linear between its own, at the times \
             of all"
        ));
    }
    let speeds = wheel_speeds(
        together.as_ref().unwrap_or(&joints.samples),
        names.left.len(),
    );
    let JointSpeeds {
        left,
        right,
        source,
        dead_velocity,
        still,
    } = speeds.ok_or_else(|| ImportError::Joints {
        topic: topic.clone(),
        reason: "no message has the velocities, and no two the positions, of all wheels of a side"
            .into(),
        found: names.left.iter().chain(&names.right).cloned().collect(),
        remedy: "name the wheels' joints: --left NAME,... --right NAME,...".into(),
    })?;
    let all: Vec<&String> = names.left.iter().chain(&names.right).collect();
    let still: Vec<&str> = still.iter().map(|joint| all[*joint].as_str()).collect();
    if !still.is_empty() {
        columns.notes.push(format!(
            "warning: {topic}: the velocity of {} stays exactly at zero while others of its side turn, as \
             for a joint that is not measured; left out of the mean",
            still.join(", ")
        ));
    }
    let how = match source {
        Source::Velocity => "velocity",
        Source::Position { .. } => "velocity from differences of position",
    };
    if let Source::Position { wrapped } = source {
        let why = if dead_velocity {
            "a joint's velocity stays at zero while its position changes"
        } else {
            "the joints' velocity is not there"
        };
        let wrapped = if wrapped { ", after unwrapping" } else { "" };
        columns.notes.push(format!(
            "{topic}: {why}; wheel speeds are differences of positions{wrapped}, \
             at the times in the middle"
        ));
    }
    if mirrored(&left, &right) && invert[0] == invert[1] {
        columns.notes.push(
            "left and right wheels turn against each other nearly all the time: if the vehicle did not \
             pivot all the way, one side is mirrored; import with --invert right (or left)"
                .into(),
        );
    }
    let sides = [
        (Channel::OmegaLeft, left, &names.left, invert[0]),
        (Channel::OmegaRight, right, &names.right, invert[1]),
    ];
    Ok(sides.map(|(channel, mut series, joints, invert)| {
        if invert {
            for (_, speed) in &mut series {
                *speed = -*speed;
            }
        }
        let sign = if invert { ", negated" } else { "" };
        let joints = joints.iter().map(String::as_str);
        let joints: Vec<&str> = joints.filter(|joint| !still.contains(joint)).collect();
        let mean = if joints.len() > 1 { "mean of " } else { "" };
        let conversion = format!("{how}{sign}, {mean}{}", joints.join(", "));
        columns.push(channel, topic, &conversion, series.clone());
        series
    }))
}
