//! `ugv import`: makes a recording of a robot's log.

use super::output::{Output, finish_all, print};
use super::progress::Progress;
use super::{Failure, tell};
use serde_json::{Map, Value};
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};
use ugv_terrain::display::visible_line;
use ugv_terrain::import::{
    self, Clock, Ending, HeadingChoice, ImportOptions, Imported, MessageKind, PoseChoice, Survey,
    TopicRequest,
};
use ugv_terrain::json::read_file;

const EXAMPLES: &str = "\
Examples:
  ugv import drive.mcap --list
  ugv import drive.mcap --output drive.csv
  ugv import drive.bag --output drive.csv --topics odometry=/ins/odom imu=none
  ugv import drive.bag --output drive.csv --left fl,rl --right fr,rr --invert right

Input:   MCAP (ROS 2 or ROS 1 messages) or a ROS 1 bag, with any of
           joints    sensor_msgs/JointState  omega_left, omega_right (required)
           odometry  nav_msgs/Odometry       x, y, heading, v_x, v_y
           imu       sensor_msgs/Imu         yaw_rate, a_x, a_y
           fix       sensor_msgs/NavSatFix   x, y: metres east and north of the first fix
Output:  CSV in SI units and radians: time, omega_left, omega_right, then the other columns. It has a
         row for every time of a measurement; a cell without a measurement is empty. FILE.json beside
         FILE.csv gets the source of each column under `source` and `provenance`; its other keys stay.
Choice:  Of several topics of a type the best one is used, and the choice is reported. joints: with
         wheels among them. odometry: with GPS, INS, lidar or motion capture in the name; wheels go
         last. imu, fix: not raw; imu: not of a camera or lidar. Then the number of messages decides.
         The pose is from odometry unless that is wheel odometry and there are fixes, or its name does
         not show its source and the fixes are good to 0.1 m. The names of joints show the wheels;
         their velocities are used, or else the differences of their positions. yaw_rate is about the
         vertical, which gravity in the IMU's accelerations shows.";

/// Make a recording from a robot's log: MCAP or ROS 1 bag in, CSV out.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// MCAP file or ROS 1 bag
    #[arg(value_name = "FILE")]
    input: PathBuf,

    /// Show the topics with type, number of messages, rate and span, and mark those that would be used
    #[arg(long, conflicts_with = "output")]
    list: bool,

    /// CSV file for the recording; - or no option writes to standard output, without the .json
    #[arg(long, value_name = "FILE.csv")]
    output: Option<PathBuf>,

    /// Topics by kind: any of joints, odometry, imu, fix; `none` uses no topic of the kind
    #[arg(long, value_name = "KIND=TOPIC", num_args = 1.., value_parser = topic)]
    topics: Vec<(MessageKind, TopicRequest)>,

    /// Joints of the left wheels [default: by their names]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    left: Vec<String>,

    /// Joints of the right wheels [default: by their names]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    right: Vec<String>,

    /// Change the sign of wheel speeds that are reported mirrored
    #[arg(long, value_name = "SIDE")]
    invert: Option<Invert>,

    /// Source of x and y [default: odometry, unless there are fixes and it is wheel odometry, or of
    /// unknown source while the fixes are precise]
    #[arg(long, value_name = "SOURCE")]
    pose: Option<PoseChoice>,

    /// Source of the heading [default: odometry if x and y are from odometry]
    #[arg(long, value_name = "SOURCE")]
    heading: Option<HeadingChoice>,

    /// Clock of the samples
    #[arg(long, value_name = "CLOCK", default_value = "header")]
    time: Clock,

    /// The IMU's z axis points down, its x axis ahead: change the sign of yaw_rate and a_y
    #[arg(long)]
    imu_z_down: bool,

    /// Import a truncated or damaged file up to the damage
    #[arg(long)]
    partial: bool,

    /// Neither notes nor progress
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Invert {
    Left,
    Right,
    Both,
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

impl Args {
    fn options(&self) -> ImportOptions {
        ImportOptions {
            topics: self.topics.iter().cloned().collect(),
            wheels: import::WheelJoints {
                left: self.left.clone(),
                right: self.right.clone(),
            },
            invert: match self.invert {
                None => [false; 2],
                Some(Invert::Left) => [true, false],
                Some(Invert::Right) => [false, true],
                Some(Invert::Both) => [true; 2],
            },
            pose: self.pose,
            heading: self.heading,
            clock: self.time,
            imu_z_down: self.imu_z_down,
            partial: self.partial,
        }
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let options = args.options();
    let files = (!args.list).then(|| Files::new(args)).transpose()?;
    let progress = Progress::bytes(args.quiet);
    let surveyed = import::survey(&args.input, &mut |done, of| progress.reach(done, 2 * of));
    let survey = surveyed.map_err(Failure::Import)?;
    let Some(files) = files else {
        progress.finish();
        return list(&args.input, &survey, &options);
    };
    let imported = import::import(&args.input, &survey, &options, &mut |done, of| {
        progress.reach(of + done, 2 * of);
    });
    progress.finish();
    let imported = imported.map_err(Failure::Import)?;
    let rows = files.write(&imported, &args.input, &survey)?;
    if !args.quiet {
        summarise(&imported, rows);
    }
    Ok(())
}

/// The recording and its metadata.
struct Files {
    table: Output,
    beside: Option<Beside>,
}

/// The JSON file beside the recording, with its previous content.
struct Beside {
    output: Output,
    content: Map<String, Value>,
}

impl Files {
    fn new(args: &Args) -> Result<Self, Failure> {
        let table = Output::of(args.output.as_deref(), [&args.input])?;
        let path = args.output.as_ref().filter(|path| *path != Path::new("-"));
        let beside = path.map(|path| Beside::new(&path.with_extension("json")));
        let files = Self {
            table,
            beside: beside.transpose()?,
        };
        let collides = |beside: &Beside| beside.output.collides_with(&files.table);
        if files.beside.as_ref().is_some_and(collides) {
            return Err(Failure::Argument {
                reason: "--output is to be a CSV file; beside it goes one that ends in .json"
                    .into(),
                hint: Some("--output FILE.csv".into()),
            });
        }
        Ok(files)
    }

    /// Writes both and returns the number of rows.
    fn write(mut self, imported: &Imported, input: &Path, survey: &Survey) -> Result<u64, Failure> {
        let written = imported.write_csv(&mut self.table);
        let rows = written.map_err(|source| self.table.failure(source))?;
        let mut outputs = vec![self.table];
        if let Some(beside) = self.beside {
            outputs.push(beside.filled(imported.provenance(input, survey))?);
        }
        finish_all(outputs)?;
        Ok(rows)
    }
}

impl Beside {
    fn new(path: &Path) -> Result<Self, Failure> {
        let output = Output::to(Some(path))?;
        let content = match read_file(path) {
            Ok(text) => {
                serde_json::from_str(text.trim_start_matches('\u{feff}')).map_err(|error| {
                    Failure::Argument {
                        reason: format!(
                            "{} is there already and no JSON object: {error}",
                            path.display()
                        ),
                        hint: Some("move it away, or choose another name for --output".into()),
                    }
                })?
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Map::new(),
            Err(source) => {
                let path = path.into();
                return Err(Failure::Read { path, source });
            }
        };
        Ok(Self { output, content })
    }

    fn filled(mut self, provenance: Value) -> Result<Output, Failure> {
        let source = format!(
            "{} ({})",
            provenance["file"].as_str().unwrap_or_default(),
            provenance["container"].as_str().unwrap_or_default()
        );
        self.content.insert("source".into(), Value::String(source));
        self.content.insert("provenance".into(), provenance);
        let content = Value::Object(self.content);
        self.output.with(&format!("{content:#}\n"))
    }
}

/// Reports the columns with their sources.
fn summarise(imported: &Imported, rows: u64) {
    for column in &imported.columns {
        tell(&format!(
            "{:<11} {:>7} samples from {}: {}",
            column.channel.name(),
            column.samples.len(),
            column.topic,
            column.conversion
        ));
    }
    for note in &imported.notes {
        let prefix = if note.starts_with("warning: ") {
            ""
        } else {
            "note: "
        };
        tell(&format!("{prefix}{note}"));
    }
    tell(&format!("{rows} rows over {:.2} s", imported.seconds()));
}

/// Prints the topics; a star marks those that would serve.
fn list(input: &Path, survey: &Survey, options: &ImportOptions) -> Result<(), Failure> {
    let mut serving = Vec::new();
    for kind in MessageKind::ALL {
        let wish = options.topics.get(&kind).unwrap_or(&TopicRequest::Any);
        let choice =
            import::choose(survey, kind, wish, &options.wheels).map_err(Failure::Import)?;
        serving.extend(choice.map(|choice| (choice.topic, kind)));
    }
    let start = survey.logged().map_or(0, |[first, _]| first);
    let since = |time: i64| (time - start) as f64 * 1e-9;
    let width = |text: fn(&import::Topic) -> &str| {
        let widths = survey
            .topics
            .iter()
            .map(|topic| visible_line(text(topic)).chars().count());
        widths.max().unwrap_or(0)
    };
    let name_width = width(|topic| &topic.name).max(5);
    let type_width = width(|topic| &topic.message_type).max(4);
    let mut text = format!(
        "{:name_width$}  {:type_width$}  {:8}  {:>8}  {:>8}  {:>17}  serves as\n",
        "topic", "type", "encoding", "messages", "rate/Hz", "logged/s"
    );
    for topic in &survey.topics {
        let rate = topic.rate().map_or("-".into(), |rate| format!("{rate:.2}"));
        let [first, last] = topic.logged.map(since);
        let role = serving.iter().find(|(chosen, _)| *chosen == topic);
        let role = match (role, topic.kind()) {
            (Some((_, kind)), _) => format!("{} *", kind.name()),
            (None, Some(kind)) => kind.name().into(),
            (None, None) => "-".into(),
        };
        // A string takes everything.
        let _ = writeln!(
            text,
            "{:name_width$}  {:type_width$}  {:8}  {:>8}  {rate:>8}  {:>17}  {role}",
            visible_line(&topic.name),
            visible_line(&topic.message_type),
            visible_line(&topic.encoding),
            topic.messages,
            format!("{first:.2} .. {last:.2}"),
        );
        if !topic.joints.is_empty() {
            let joints: Vec<_> = topic.joints.iter().map(|name| visible_line(name)).collect();
            let _ = writeln!(text, "{:name_width$}  joints: {}", "", joints.join(", "));
        }
    }
    print(&text)?;
    if let Ending::Broken { offset, reason } = &survey.ending {
        tell(&format!(
            "warning: {} is damaged near byte {offset}: {reason}; the topics are those before",
            input.display()
        ));
    }
    Ok(())
}
