//! The choice of topics.

use super::error::ImportError;
use super::message::{MessageKind, is_transforms, unnamed};
use super::options::ImportOptions;
use super::request::TopicRequest;
use super::side::{Side, WheelJoints, guess, side};
use super::survey::{Survey, Topic};
use super::transforms;
use crate::spelling::nearest;
use std::cmp::Reverse;
use std::collections::BTreeSet;

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

    /// Why this topic serves.
    #[must_use]
    pub fn reason(&self) -> String {
        let (kind, topic) = (self.kind.name(), &self.topic.name);
        match (self.named, self.others.is_empty()) {
            (true, _) => format!("{kind}: {topic}, as requested"),
            (false, true) => format!("{kind}: {topic}, the only topic of its types"),
            (false, false) => format!(
                "{kind}: {topic}, {}; instead of {}",
                rule(self.kind),
                self.others.join(", ")
            ),
        }
    }
}

/// The order of preference, in words.
fn rule(kind: MessageKind) -> &'static str {
    match kind {
        MessageKind::Joints => "the topic with left and right wheels and the most messages",
        MessageKind::Odometry => {
            "names of GPS, INS, lidar or motion capture go first, those of wheels last, then the type \
             decides (Odometry, PoseWithCovarianceStamped, PoseStamped, TransformStamped, /tf), then the most \
             messages"
        }
        MessageKind::Imu => {
            "topics that are not raw go first, those of a camera or a lidar last, then the most messages \
             decide"
        }
        MessageKind::Fix => "raw and filtered data last, then the most messages decide",
        MessageKind::Twist => "the most messages decide",
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
const INDEPENDENT: &str = "amcl vrpn natnet qualisys totalstation theodolite truth gps gnss rtk ins lidar laser lio slam icp loam mocap vicon optitrack visual vio vo map total_station mapping";
/// The same for dead reckoning by wheels.
const WHEELS: &str = "wheel encoder diff_drive diffdrive controller chassis dead_reckoning";

/// The same for inertial sensors within another sensor, which may have any orientation.
const ELSEWHERE: &str = "camera realsense zed oak optical lidar livox ouster velodyne";

/// Words in names of topics that are commands or goals, not measurements.
const COMMANDS: &str =
    "cmd command commands goal initialpose target setpoint desired reference waypoint plan static";

/// Whether a topic has commands, goals or static transforms, by a whole word of its name.
fn is_command(topic: &Topic) -> bool {
    let name = topic.name.to_lowercase();
    let mut words = name.split(|letter: char| !letter.is_alphabetic());
    words.any(|word| COMMANDS.split(' ').any(|token| token == word))
}

/// Topics of a kind that are not taken unless requested, because their names are those of commands.
pub(super) fn set_aside(survey: &Survey, kind: MessageKind) -> Option<String> {
    let topics = survey.topics.iter();
    let topics = topics.filter(|topic| topic.kind() == Some(kind) && is_command(topic));
    let names: Vec<&str> = topics.map(|topic| topic.name.as_str()).collect();
    let first = names.first()?;
    Some(format!(
        "{kind}: {} not taken, by the name a command, a goal or static (--topics {kind}={first} takes it)",
        names.join(", "),
        kind = kind.name()
    ))
}

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

/// The same for a topic with its frames: transforms from the map are localisation, those from `odom` alone are not.
pub(super) fn source(topic: &Topic) -> Origin {
    // The estimator of PX4 takes its pose from satellites, inertial sensors and vision.
    if topic.encoding == "ulog" {
        return Origin::Independent;
    }
    if !is_transforms(&topic.message_type) {
        return origin(&topic.name);
    }
    // The frame is known once the transforms were read.
    let parent = match transforms::path(topic, None) {
        _ if !topic.frame.is_empty() => topic.frame.clone(),
        Ok(Some(path)) => path.parent(),
        _ => String::new(),
    };
    if has_word(&parent, INDEPENDENT) {
        Origin::Independent
    } else {
        Origin::Unknown
    }
}

/// Rank of a topic; a smaller one is better.
fn standing(kind: MessageKind, topic: &Topic, wheels: &WheelJoints) -> u8 {
    let name = topic.name.to_lowercase();
    match kind {
        MessageKind::Joints => {
            let options = ImportOptions {
                wheels: wheels.clone(),
                ..ImportOptions::default()
            };
            u8::from(pick_wheels([topic], &options).is_err())
        }
        MessageKind::Odometry => {
            let place = kind.place(&topic.message_type).min(15);
            16 * source(topic) as u8 + place as u8
        }
        MessageKind::Twist => u8::from(origin(&name) == Origin::Wheels),
        MessageKind::Imu => {
            let elsewhere = has_word(&name, ELSEWHERE) || has_word(&topic.frame, ELSEWHERE);
            let place = kind.place(&topic.message_type).min(15) as u8;
            32 * u8::from(elsewhere) + 16 * u8::from(name.contains("raw")) + place
        }
        MessageKind::Fix => u8::from(name.contains("raw") || name.contains("filtered")),
    }
}

/// The topic of a kind, if any: the requested one, that of the preset, or the best one that is no command.
///
/// # Errors
/// A named topic that is missing or has another type.
pub fn choose<'s>(
    survey: &'s Survey,
    kind: MessageKind,
    options: &ImportOptions,
) -> Result<Option<TopicChoice<'s>>, ImportError> {
    let wheels = &options.wheels;
    let mut fitting: Vec<&Topic> = survey.topics.iter().collect();
    fitting.retain(|topic| topic.kind() == Some(kind));
    fitting.sort_by_key(|topic| (standing(kind, topic, wheels), Reverse(topic.messages)));
    let of_preset = |topic: &Topic| options.preset?.place(kind, &topic.name);
    let wish = options.topics.get(&kind).unwrap_or(&TopicRequest::Any);
    let topic = match wish {
        TopicRequest::Without => None,
        TopicRequest::Any => {
            fitting.retain(|topic| !is_command(topic));
            let known = fitting.iter().copied();
            let known = known.filter_map(|topic| Some((of_preset(topic)?, topic)));
            let best = known.min_by_key(|(place, _)| *place);
            best.map(|(_, topic)| topic).or(fitting.first().copied())
        }
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

/// Topics with other wheels than the chosen one, such as those of the rear axle. A requested topic stands alone.
pub(super) fn joined<'s>(
    survey: &'s Survey,
    choice: &TopicChoice<'s>,
    wheels: &WheelJoints,
) -> Vec<&'s Topic> {
    let is_other = |topic: &&Topic| {
        topic.kind() == Some(MessageKind::Joints)
            && topic.name != choice.topic.name
            && topic.message_type == choice.topic.message_type
            && !is_command(topic)
            && !topic.has_unnamed_joints()
    };
    if choice.named || choice.topic.has_unnamed_joints() {
        return Vec::new();
    }
    let mut others: Vec<&Topic> = survey.topics.iter().filter(is_other).collect();
    others.sort_by_key(|topic| Reverse(topic.messages));
    let mut names: BTreeSet<String> = choice.topic.joints.clone();
    names.extend(others.iter().flat_map(|topic| topic.joints.iter().cloned()));
    let guessed = guess(&names);
    let all = [&guessed, wheels]
        .into_iter()
        .flat_map(|one| one.left.iter().chain(&one.right));
    let wanted: BTreeSet<&String> = all.collect();
    let mut taken: BTreeSet<&String> = choice.topic.joints.iter().collect();
    others.retain(|topic| {
        let has_wheels = topic.joints.iter().any(|joint| wanted.contains(joint));
        let is_new = topic
            .joints
            .is_disjoint(&taken.iter().map(|name| (*name).clone()).collect());
        if has_wheels && is_new {
            taken.extend(&topic.joints);
        }
        has_wheels && is_new
    });
    others
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
            "its encoding `{}` cannot be read, only cdr, ros1 and ulog",
            topic.encoding
        ),
        Some(topic) => format!("it is of type {}", topic.message_type),
    };
    let candidates = fitting.iter().map(|topic| topic.name.as_str());
    let remedy = nearest(name, candidates).map_or_else(
        || format!("no topic is of type {}", kind.message_types().join(" or ")),
        |near| format!("--topics {}={near}", kind.name()),
    );
    Err(ImportError::Topic {
        kind,
        topic: name.into(),
        reason,
        remedy,
    })
}

/// The wheels' joints of topics: the requested ones, or by their names.
///
/// # Errors
/// A side without joints, joints that the topics lack, and joints without names whose order is unknown.
pub(super) fn pick_wheels<'t>(
    topics: impl IntoIterator<Item = &'t Topic>,
    options: &ImportOptions,
) -> Result<WheelJoints, ImportError> {
    let topics: Vec<&Topic> = topics.into_iter().collect();
    let names: Vec<&str> = topics.iter().map(|topic| topic.name.as_str()).collect();
    let joints: BTreeSet<String> = topics
        .iter()
        .flat_map(|topic| topic.joints.iter().cloned())
        .collect();
    let failed = |reason, remedy: &str| ImportError::Joints {
        topic: names.join(", "),
        reason,
        found: joints.iter().cloned().collect(),
        remedy: remedy.into(),
    };
    if topics.iter().any(|topic| topic.has_unnamed_joints()) {
        return by_order(joints.len(), &options.order)
            .map_err(|reason| failed(reason, "name their order: --wheels FL,FR,RL,RR"));
    }
    let name_them = "name the wheels' joints: --left NAME,... --right NAME,...";
    if !options.order.is_empty() {
        return Err(failed(
            "its joints have names, so that --wheels has no use".into(),
            name_them,
        ));
    }
    let named = &options.wheels;
    let mut wheels = guess(&joints);
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
        if let Some(joint) = side.iter().find(|joint| !joints.contains(*joint)) {
            return Err(failed(format!("it has no joint `{joint}`"), name_them));
        }
        if side.is_empty() {
            return Err(failed(
                format!("no joint has the name of a {name} wheel"),
                name_them,
            ));
        }
    }
    match wheels
        .left
        .iter()
        .find(|joint| wheels.right.contains(joint))
    {
        Some(joint) => Err(failed(
            format!("joint `{joint}` is named for both sides"),
            name_them,
        )),
        None => Ok(wheels),
    }
}

/// The wheels among joints without names, by where they are: `FL`, `rear_right`, `-` for none.
fn by_order(joints: usize, order: &[String]) -> Result<WheelJoints, String> {
    if order.is_empty() {
        return Err(format!("its {joints} joints have no names"));
    }
    if order.len() != joints {
        return Err(format!(
            "its {joints} joints have no names, and --wheels has {}",
            order.len()
        ));
    }
    let mut wheels = WheelJoints::default();
    for (index, place) in order.iter().enumerate() {
        let joint = unnamed(index);
        match side(place) {
            Some(Side::Left) => wheels.left.push(joint),
            Some(Side::Right) => wheels.right.push(joint),
            None if place == "-" => {}
            None => return Err(format!("`{place}` in --wheels is no left or right wheel")),
        }
    }
    if wheels.left.is_empty() || wheels.right.is_empty() {
        return Err("--wheels names one side only".into());
    }
    Ok(wheels)
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
            files: Vec::new(),
            notes: Vec::new(),
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

    fn requesting(kind: MessageKind, wish: &TopicRequest) -> ImportOptions {
        ImportOptions {
            topics: [(kind, wish.clone())].into(),
            ..ImportOptions::default()
        }
    }

    fn chosen(kind: MessageKind, wish: &TopicRequest) -> Option<String> {
        let survey = survey();
        let choice = choose(&survey, kind, &requesting(kind, wish)).unwrap();
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
            let choice = choose(survey, MessageKind::Imu, &ImportOptions::default()).unwrap();
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
        let kind = MessageKind::Odometry;
        let choice = choose(&survey, kind, &ImportOptions::default())
            .unwrap()
            .unwrap();
        let note = choice.note().unwrap();
        assert!(
            note.contains("also there: /odom/slow, /wheel/gps"),
            "{note}"
        );
        let named = TopicRequest::Named("/odom".into());
        let choice = choose(&survey, kind, &requesting(kind, &named))
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
        let pick = |wheels: WheelJoints| {
            let options = ImportOptions {
                wheels,
                ..ImportOptions::default()
            };
            pick_wheels([&topic], &options)
        };
        let wheels = pick(named(&[], &["l_b"])).unwrap();
        assert_eq!(wheels, named(&["l_a"], &["l_b"]));
        for wrong in [
            named(&[], &[]),
            named(&["y"], &["x"]),
            named(&["x"], &["x"]),
        ] {
            assert!(matches!(pick(wrong), Err(ImportError::Joints { .. })));
        }
    }
}
