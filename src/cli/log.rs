//! What a robot's log leaves open: topics, wheels, frames, and the source of the pose.

use super::failure::Failure;
use crate::import::{
    ImportOptions, MessageKind, PoseChoice, Preset, TopicRequest, WheelJoints, is_log,
};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;

/// The options stand apart in the help of commands that read tables, too.
const HEADING: &str = "Options of a robot's log";

/// Choices among what a log holds, as `ugv import` takes them.
#[derive(clap::Args)]
pub struct LogArgs {
    /// Topics for any of joints, odometry, imu, fix, twist; `none` omits a kind; repeatable
    #[arg(long, help_heading = HEADING, value_name = "KIND=TOPIC,...", value_delimiter = ',', value_parser = topic)]
    topics: Vec<(MessageKind, TopicRequest)>,

    /// Joints of the left wheels [default: by name]
    #[arg(long, help_heading = HEADING, value_name = "NAME,...", value_delimiter = ',')]
    left: Vec<String>,

    /// Joints of the right wheels [default: by name]
    #[arg(long, help_heading = HEADING, value_name = "NAME,...", value_delimiter = ',')]
    right: Vec<String>,

    /// Where the joints are, in their order, if they have no names: FL,FR,RL,RR; - for no wheel
    #[arg(long, help_heading = HEADING, value_name = "PLACE,...", value_delimiter = ',')]
    wheels: Vec<String>,

    /// Frames of a pose from transforms [default: from map, world or odom to base_link]
    #[arg(long, help_heading = HEADING, value_name = "PARENT,CHILD", value_parser = frames)]
    frames: Option<[String; 2]>,

    /// A known vehicle: prefer its topics and take its dimensions; `import` writes them to FILE.json
    #[arg(long, help_heading = HEADING, value_name = "NAME", value_parser = preset())]
    preset: Option<Preset>,

    /// Change the sign of mirrored wheel speeds
    #[arg(long, help_heading = HEADING, value_name = "SIDE", value_parser = choice(&SIDES))]
    invert: Option<[bool; 2]>,

    /// Source of x and y [default: odometry, or fixes if the odometry is of wheels, or of unknown
    /// origin while the fixes are precise]
    #[arg(long, help_heading = HEADING, value_name = "SOURCE", value_parser = choice(&POSES))]
    pose: Option<PoseChoice>,
}

/// Left and right, whether inverted.
const SIDES: [(&str, [bool; 2]); 3] = [
    ("left", [true, false]),
    ("right", [false, true]),
    ("both", [true; 2]),
];
const POSES: [(&str, PoseChoice); 2] =
    [("odometry", PoseChoice::Odometry), ("fix", PoseChoice::Fix)];
/// Parses one of these names.
pub fn choice<T: Copy + Send + Sync>(
    named: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    let names = PossibleValuesParser::new(named.iter().map(|(name, _)| *name));
    names.try_map(|text| {
        let found = named.iter().find(|(name, _)| *name == text);
        found.map(|(_, value)| *value).ok_or("an unknown name")
    })
}

/// Parses the name of a known vehicle.
fn preset() -> impl TypedValueParser<Value = Preset> {
    let names = PossibleValuesParser::new(Preset::NAMES);
    names.try_map(|text| Preset::of_name(&text).ok_or("an unknown name"))
}

fn frames(text: &str) -> Result<[String; 2], String> {
    match text.split(',').map(str::trim).collect::<Vec<_>>()[..] {
        [parent, child] if !parent.is_empty() && !child.is_empty() => {
            Ok([parent, child].map(|frame| frame.trim_start_matches('/').to_owned()))
        }
        _ => Err("expected PARENT,CHILD, such as map,base_link".into()),
    }
}

fn topic(text: &str) -> Result<(MessageKind, TopicRequest), String> {
    let names = MessageKind::ALL.map(MessageKind::name).join(", ");
    let expected = format!("expected KIND=TOPIC with a KIND of {names}");
    let (kind, topic) = text.split_once('=').ok_or(expected.as_str())?;
    let kind = MessageKind::ALL
        .into_iter()
        .find(|known| known.name() == kind);
    let wish = match topic {
        "" => return Err(expected),
        "none" => TopicRequest::Without,
        name => TopicRequest::Named(name.into()),
    };
    Ok((kind.ok_or(expected)?, wish))
}

impl LogArgs {
    /// The options of an import, which request nothing else.
    pub fn options(&self) -> ImportOptions {
        ImportOptions {
            topics: self.topics.iter().cloned().collect(),
            wheels: WheelJoints {
                left: self.left.clone(),
                right: self.right.clone(),
            },
            order: self.wheels.clone(),
            frames: self.frames.clone(),
            preset: self.preset,
            invert: self.invert.unwrap_or_default(),
            pose: self.pose,
            ..ImportOptions::default()
        }
    }

    /// The known vehicle.
    pub fn preset(&self) -> Option<Preset> {
        self.preset
    }

    /// Refuses options of a log where none of the files is one.
    ///
    /// # Errors
    /// Names the files.
    pub fn check(&self, files: &[PathBuf]) -> Result<(), Failure> {
        if self.options() == ImportOptions::default() || files.iter().any(|file| is_log(file)) {
            return Ok(());
        }
        let files: Vec<String> = files
            .iter()
            .map(|file| file.display().to_string())
            .collect();
        let reason = format!(
            "options of a robot's log do not apply to a table: {}",
            files.join(", ")
        );
        Err(Failure::argument(reason).with_remedy(
            "--column names the columns of a table; `ugv import LOG --output REC.csv` takes these options",
        ))
    }
}
