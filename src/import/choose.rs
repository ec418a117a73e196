//! The choice of topics.

use super::error::ImportError;
use super::message::MessageKind;
use super::side::{WheelJoints, guess};
use super::survey::{Survey, Topic};
use crate::spelling::nearest;
use std::cmp::Reverse;

/// The topic that the user requests.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum TopicRequest {
    /// The best one.
    #[default]
    Any,
    /// No topic.
    Without,
    /// This one.
    Named(String),
}

/// The chosen topic of a kind, and the alternatives.
#[derive(Debug, Clone, PartialEq)]
pub struct TopicChoice<'s> {
    /// Kind of its messages.
    pub kind: MessageKind,
    /// The topic.
    pub topic: &'s Topic,
    /// Whether the user named it.
    pub named: bool,
    /// Other topics of its type.
    pub others: Vec<&'s str>,
}

impl TopicChoice<'_> {
    /// The reason for this topic, if there are alternatives.
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
            "names of GPS, INS, lidar or motion capture go first, those of wheels last, then the most \
             messages decide"
        }
        MessageKind::Imu => {
            "topics that are not raw go first, those of a camera or a lidar last, then the most messages \
             decide"
        }
        MessageKind::Fix => "raw and filtered data last, then the most messages decide",
    }
}

/// Source of an odometry topic's pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Origin {
    /// A sensor independent of the wheels.
    Independent,
    /// Unknown by name.
    Unknown,
    /// The wheels.
    Wheels,
}

/// Words in names of independent poses; words of four letters and more also count within other words.
const INDEPENDENT: &str = "truth gps gnss rtk ins lidar laser lio slam icp loam mocap vicon optitrack visual vio vo map total_station mapping";
/// The same for dead reckoning by wheels.
const WHEELS: &str = "wheel encoder diff_drive diffdrive controller chassis dead_reckoning";

/// The same for inertial sensors within another sensor, which may have any orientation.
const ELSEWHERE: &str = "camera realsense zed oak optical lidar livox ouster velodyne";

/// Whether a name has one of the words.
fn has_word(name: &str, tokens: &str) -> bool {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|letter: char| !letter.is_alphabetic()).collect();
    let has = |token: &str| words.contains(&token) || (token.len() > 3 && name.contains(token));
    tokens.split(' ').any(has)
}

/// Source of an odometry topic's pose, by its name.
pub(super) fn origin(topic: &str) -> Origin {
    match (has_word(topic, WHEELS), has_word(topic, INDEPENDENT)) {
        (true, _) => Origin::Wheels,
        (false, true) => Origin::Independent,
        (false, false) => Origin::Unknown,
    }
}

/// Rank of a topic; a smaller one is better.
fn standing(kind: MessageKind, topic: &Topic, wheels: &WheelJoints) -> u8 {
    let name = topic.name.to_lowercase();
    match kind {
        MessageKind::Joints => u8::from(pick_wheels(topic, wheels).is_err()),
        MessageKind::Odometry => origin(&name) as u8,
        MessageKind::Imu => {
            let elsewhere = has_word(&name, ELSEWHERE) || has_word(&topic.frame, ELSEWHERE);
            2 * u8::from(elsewhere) + u8::from(name.contains("raw"))
        }
        MessageKind::Fix => u8::from(name.contains("raw") || name.contains("filtered")),
    }
}

/// The topic of a kind, if any. `wheels` may name the wheels' joints.
///
/// # Errors
/// A named topic that is missing or has another type.
pub fn choose<'s>(
    survey: &'s Survey,
    kind: MessageKind,
    wish: &TopicRequest,
    wheels: &WheelJoints,
) -> Result<Option<TopicChoice<'s>>, ImportError> {
    let mut fitting: Vec<&Topic> = survey.topics.iter().collect();
    fitting.retain(|topic| topic.kind() == Some(kind));
    fitting.sort_by_key(|topic| (standing(kind, topic, wheels), Reverse(topic.messages)));
    let topic = match wish {
        TopicRequest::Without => None,
        TopicRequest::Any => fitting.first().copied(),
        TopicRequest::Named(name) => Some(named(survey, kind, name, &fitting)?),
    };
    Ok(topic.map(|topic| {
        let others = fitting.iter().map(|other| other.name.as_str());
        TopicChoice {
            kind,
            topic,
            named: matches!(wish, TopicRequest::Named(_)),
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

/// The wheels' joints of a topic: the requested ones, or by their names.
///
/// # Errors
/// A side without joints, or joints that the topic lacks.
pub(super) fn pick_wheels(topic: &Topic, named: &WheelJoints) -> Result<WheelJoints, ImportError> {
    let failed = |reason| ImportError::Joints {
        topic: topic.name.clone(),
        reason,
        found: topic.joints.iter().cloned().collect(),
    };
    let mut wheels = guess(&topic.joints);
    // A joint that is requested for one side is not guessed for the other.
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
            return Err(failed(format!("no joint has the name of a {name} wheel")));
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
mod tests {
    use super::*;
    use crate::import::container::{Connection, Container, Ending};

    fn topic(name: &str, message_type: &str, messages: u64, joints: &str) -> Topic {
        let channel = Connection {
            topic: name.into(),
            message_type: message_type.into(),
            encoding: "cdr".into(),
        };
        Topic {
            messages,
            joints: joints.split_whitespace().map(Into::into).collect(),
            ..Topic::new(&channel, 0)
        }
    }

    fn survey() -> Survey {
        let odometry = |name, messages| topic(name, "nav_msgs/msg/Odometry", messages, "");
        let joints =
            |name, messages, joints| topic(name, "sensor_msgs/JointState", messages, joints);
        Survey {
            container: Container::Mcap,
            topics: vec![
                joints("/arm", 900, "left_arm elbow"),
                joints("/wheels", 300, "fl fr"),
                odometry("/odom", 900),
                odometry("/odom/slow", 20),
                odometry("/wheel/gps", 999),
            ],
            ending: Ending::Whole,
        }
    }

    fn chosen(kind: MessageKind, wish: &TopicRequest) -> Option<String> {
        let survey = survey();
        let choice = choose(&survey, kind, wish, &WheelJoints::default()).unwrap();
        choice.map(|choice| choice.topic.name.clone())
    }

    #[test]
    fn names_show_the_source_of_a_pose() {
        for name in [
            "/ins/odom",
            "/gps_odom",
            "/groundtruth",
            "/slam_toolbox/odom",
            "/vio",
        ] {
            assert_eq!(origin(name), Origin::Independent, "{name}");
        }
        for name in [
            "/wheel_odom",
            "/husky_velocity_controller/odom",
            "/wheels/gps_like",
        ] {
            assert_eq!(origin(name), Origin::Wheels, "{name}");
        }
        for name in [
            "/odom",
            "/odometry/filtered",
            "/inspector/odom",
            "/volvo/odom",
        ] {
            assert_eq!(origin(name), Origin::Unknown, "{name}");
        }
    }

    #[test]
    fn the_order_of_preference() {
        // Wheels before more messages; no wheel odometry, then more messages.
        assert_eq!(
            chosen(MessageKind::Joints, &TopicRequest::Any).as_deref(),
            Some("/wheels")
        );
        assert_eq!(
            chosen(MessageKind::Odometry, &TopicRequest::Any).as_deref(),
            Some("/odom")
        );
        assert_eq!(chosen(MessageKind::Imu, &TopicRequest::Any), None);
        assert_eq!(chosen(MessageKind::Odometry, &TopicRequest::Without), None);
        let named = TopicRequest::Named("odom/slow".into());
        assert_eq!(
            chosen(MessageKind::Odometry, &named).as_deref(),
            Some("/odom/slow")
        );
    }

    #[test]
    fn inertial_sensors_of_cameras_and_lidars_go_last() {
        let imu = |name, messages, frame: &str| Topic {
            frame: frame.into(),
            ..topic(name, "sensor_msgs/Imu", messages, "")
        };
        let mut survey = survey();
        let chosen = |survey: &Survey| -> String {
            let choice = choose(
                survey,
                MessageKind::Imu,
                &TopicRequest::Any,
                &WheelJoints::default(),
            )
            .unwrap();
            choice.unwrap().topic.name.clone()
        };
        survey.topics = vec![
            imu("/d435i/imu", 9000, "d435i_imu_optical_frame"),
            imu("/zed2i/imu", 8000, ""),
            imu("/Ouster/imu", 7000, "os_imu"),
        ];
        assert_eq!(chosen(&survey), "/d435i/imu", "there is nothing else");
        survey.topics.push(imu("/imu/raw", 20, "imu_link"));
        assert_eq!(chosen(&survey), "/imu/raw");
        // `zed` counts as a whole word only.
        survey.topics.push(imu("/imu/normalized", 10, "imu_link"));
        assert_eq!(chosen(&survey), "/imu/normalized");
    }

    #[test]
    fn a_choice_among_several_is_noted() {
        let survey = survey();
        let none = WheelJoints::default();
        let choice = choose(&survey, MessageKind::Odometry, &TopicRequest::Any, &none)
            .unwrap()
            .unwrap();
        let note = choice.note().unwrap();
        assert!(
            note.contains("also there: /odom/slow, /wheel/gps"),
            "{note}"
        );
        let named = TopicRequest::Named("/odom".into());
        let choice = choose(&survey, MessageKind::Odometry, &named, &none)
            .unwrap()
            .unwrap();
        assert_eq!(choice.note(), None);
    }

    #[test]
    fn a_name_for_one_side_is_not_guessed_for_the_other() {
        let topic = topic("/wheels", "sensor_msgs/JointState", 1, "l_a l_b x");
        let named = |left: &[&str], right: &[&str]| WheelJoints {
            left: left.iter().map(|name| (*name).into()).collect(),
            right: right.iter().map(|name| (*name).into()).collect(),
        };
        let wheels = pick_wheels(&topic, &named(&[], &["l_b"])).unwrap();
        assert_eq!(wheels, named(&["l_a"], &["l_b"]));
        for wrong in [
            named(&[], &[]),
            named(&["y"], &["x"]),
            named(&["x"], &["x"]),
        ] {
            assert!(matches!(
                pick_wheels(&topic, &wrong),
                Err(ImportError::Joints { .. })
            ));
        }
    }
}
