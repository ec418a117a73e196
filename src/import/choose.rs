//! Which topic serves as what.

use super::ImportError;
use super::message::MessageKind;
use super::side::{WheelJoints, guess};
use super::survey::{Survey, Topic};
use crate::spelling::nearest;
use std::cmp::Reverse;

/// Which topic somebody wants.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Wish {
    /// Whichever fits best.
    #[default]
    Any,
    /// None.
    Without,
    /// This one.
    Named(String),
}

/// A topic that serves as something, and those that could have.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice<'s> {
    /// What it serves as.
    pub kind: MessageKind,
    /// The topic.
    pub topic: &'s Topic,
    /// Whether it was named.
    pub named: bool,
    /// Other topics of its type.
    pub others: Vec<&'s str>,
}

impl Choice<'_> {
    /// Why this topic and not another, where there was another.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        if self.named || self.others.is_empty() {
            return None;
        }
        let kind = self.kind.name();
        Some(format!(
            "{kind} from {}, {}; also there: {} (choose with --topics {kind}=TOPIC)",
            self.topic.name,
            rule(self.kind),
            self.others.join(", ")
        ))
    }
}

/// The order of preference, in words.
fn rule(kind: MessageKind) -> &'static str {
    match kind {
        MessageKind::Joints => "the topic with left and right wheels and the most messages",
        MessageKind::Odometry => {
            "names that tell of GPS, INS, lidar or motion capture go first, those of wheels last, \
             then the most messages decide"
        }
        MessageKind::Imu => {
            "what is not raw goes first, what belongs to a camera or a lidar last, then the most messages \
             decide"
        }
        MessageKind::Fix => "raw and filtered data last, then the most messages decide",
    }
}

/// Where an odometry topic's pose comes from, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Origin {
    /// From a sensor that does not look at the wheels.
    Independent,
    /// The name does not tell.
    Unknown,
    /// From the wheels.
    Wheels,
}

/// Whole words and (from four letters on) parts of words in names of independent poses.
const INDEPENDENT: [&str; 20] = [
    "truth",
    "gps",
    "gnss",
    "rtk",
    "ins",
    "lidar",
    "laser",
    "lio",
    "slam",
    "icp",
    "loam",
    "mocap",
    "vicon",
    "optitrack",
    "visual",
    "vio",
    "vo",
    "map",
    "total_station",
    "mapping",
];
/// The same for dead reckoning by wheels.
const WHEELS: [&str; 7] = [
    "wheel",
    "encoder",
    "diff_drive",
    "diffdrive",
    "controller",
    "chassis",
    "dead_reckoning",
];

/// The same for inertial sensors that are part of another sensor, which may look anywhere.
const ELSEWHERE: [&str; 9] = [
    "camera",
    "realsense",
    "zed",
    "oak",
    "optical",
    "lidar",
    "livox",
    "ouster",
    "velodyne",
];

/// Whether a name has one of the words.
fn tells(name: &str, tokens: &[&str]) -> bool {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|letter: char| !letter.is_alphabetic()).collect();
    let has = |token: &&str| words.contains(token) || (token.len() > 3 && name.contains(*token));
    tokens.iter().any(has)
}

/// Where an odometry topic's pose comes from, by its name.
pub(super) fn origin(topic: &str) -> Origin {
    match (tells(topic, &WHEELS), tells(topic, &INDEPENDENT)) {
        (true, _) => Origin::Wheels,
        (false, true) => Origin::Independent,
        (false, false) => Origin::Unknown,
    }
}

/// Smaller is better.
fn standing(kind: MessageKind, topic: &Topic, wheels: &WheelJoints) -> u8 {
    let name = topic.name.to_lowercase();
    match kind {
        MessageKind::Joints => u8::from(pick_wheels(topic, wheels).is_err()),
        MessageKind::Odometry => origin(&name) as u8,
        MessageKind::Imu => {
            let elsewhere = tells(&name, &ELSEWHERE) || tells(&topic.frame, &ELSEWHERE);
            2 * u8::from(elsewhere) + u8::from(name.contains("raw"))
        }
        MessageKind::Fix => u8::from(name.contains("raw") || name.contains("filtered")),
    }
}

/// The topic that serves as `kind`, if any. `wheels` names the wheels' joints, or nothing.
///
/// # Errors
/// A named topic that is not there or is of another type.
pub fn choose<'s>(
    survey: &'s Survey,
    kind: MessageKind,
    wish: &Wish,
    wheels: &WheelJoints,
) -> Result<Option<Choice<'s>>, ImportError> {
    let mut fitting: Vec<&Topic> = survey.topics.iter().collect();
    fitting.retain(|topic| topic.kind() == Some(kind));
    fitting.sort_by_key(|topic| (standing(kind, topic, wheels), Reverse(topic.messages)));
    let topic = match wish {
        Wish::Without => None,
        Wish::Any => fitting.first().copied(),
        Wish::Named(name) => Some(named(survey, kind, name, &fitting)?),
    };
    Ok(topic.map(|topic| {
        let others = fitting.iter().map(|other| other.name.as_str());
        Choice {
            kind,
            topic,
            named: matches!(wish, Wish::Named(_)),
            others: others.filter(|name| *name != topic.name).collect(),
        }
    }))
}

fn named<'s>(
    survey: &'s Survey,
    kind: MessageKind,
    name: &str,
    fitting: &[&'s Topic],
) -> Result<&'s Topic, ImportError> {
    let bare = name.trim_start_matches('/');
    let same = |topic: &&Topic| topic.name.trim_start_matches('/') == bare;
    if let Some(topic) = fitting.iter().copied().find(same) {
        return Ok(topic);
    }
    let reason = match survey.topics.iter().find(same) {
        None => "the file has no such topic".into(),
        Some(topic) if MessageKind::of_type(&topic.message_type) == Some(kind) => format!(
            "its encoding `{}` cannot be read, only cdr and ros1",
            topic.encoding
        ),
        Some(topic) => format!("it is of type {}", topic.message_type),
    };
    let candidates = fitting.iter().map(|topic| topic.name.as_str());
    let remedy = nearest(name, candidates).map_or_else(
        || format!("no topic is of type {}", kind.message_type()),
        |near| format!("--topics {}={near}", kind.name()),
    );
    Err(ImportError::Topic {
        kind,
        topic: name.into(),
        reason,
        remedy,
    })
}

/// The wheels' joints of a topic: those that are named, or by their names.
///
/// # Errors
/// A side without joints, or joints that the topic does not have.
pub(super) fn pick_wheels(topic: &Topic, named: &WheelJoints) -> Result<WheelJoints, ImportError> {
    let failed = |reason| ImportError::Joints {
        topic: topic.name.clone(),
        reason,
        found: topic.joints.iter().cloned().collect(),
    };
    let mut wheels = guess(&topic.joints);
    // A joint that was named for one side is not guessed for the other.
    wheels.left.retain(|joint| !named.right.contains(joint));
    wheels.right.retain(|joint| !named.left.contains(joint));
    for (side, name, named) in [
        (&mut wheels.left, "left", &named.left),
        (&mut wheels.right, "right", &named.right),
    ] {
        if !named.is_empty() {
            side.clone_from(named);
        }
        if let Some(joint) = side.iter().find(|joint| !topic.joints.contains(*joint)) {
            return Err(failed(format!("it has no joint `{joint}`")));
        }
        if side.is_empty() {
            return Err(failed(format!("no joint's name tells of a {name} wheel")));
        }
    }
    match wheels
        .left
        .iter()
        .find(|joint| wheels.right.contains(joint))
    {
        Some(joint) => Err(failed(format!("joint `{joint}` is named for both sides"))),
        None => Ok(wheels),
    }
}

#[cfg(test)]
mod tests;
