//! `ugv import`: makes a recording from a robot's log.

use super::destination::{ForceArgs, JsonArgs};
use super::failure::Failure;
use super::log::{LogArgs, choice};
use super::output::{Output, finish_all, is_stream, notify, print};
use super::progress::ProgressLine;
use crate::display::visible_line;
use crate::import::{
    self, Clock, Ending, HeadingChoice, ImportOptions, Imported, MessageKind, Preset, Survey,
};
use crate::json::read_file;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  ugv import drive.mcap --list
  ugv import drive.mcap --output drive.csv
  ugv import drive.bag --output drive.csv --topics odometry=/ins/odom,imu=none
  ugv import drive.bag --output drive.csv --left fl,rl --right fr,rr --invert right
  ugv import bag_folder --output drive.csv --preset husky --frames map,base_link

Input:   MCAP, a ROS 2 bag in SQLite (.db3), a ROS 1 bag or a log of PX4 (.ulg), packed with zstd
         or not. Or the folder of a bag, whose files are one recording. It may hold any of
           joints    sensor_msgs/JointState; Feedback of jackal_msgs, clearpath_platform_msgs
                     omega_left, omega_right (required), effort_* [N m] or current_* [A] of a side
           odometry  nav_msgs/Odometry: x, y, heading, v_x, v_y; without velocities:
                     geometry_msgs/PoseStamped, PoseWithCovarianceStamped, TransformStamped, /tf
           imu       sensor_msgs/Imu: yaw_rate, a_x, a_y
           fix       sensor_msgs/NavSatFix: x, y, metres east and north of the first fix
           twist     geometry_msgs/TwistStamped: v_x, v_y, yaw_rate, if odometry has none
         PX4: wheel_encoders (joints; actuator outputs are commands); vehicle_local_position,
         vehicle_odometry (odometry); vehicle_angular_velocity, sensor_combined, vehicle_attitude (imu)
Output:  CSV in SI units and radians: time, omega_left, omega_right, then the other columns. It has
         a row for every time with a measurement, and empty cells for the others. FILE.json beside
         FILE.csv gets the origin of each column under `source` and `provenance`, and keeps its
         other keys.
Choice:  of several topics of a type: one with wheels (joints); one whose name suggests GPS, INS,
         lidar or motion capture rather than wheels (odometry); one that is not raw (imu, fix) and
         not of a camera or lidar (imu); then the one with the most messages. Notes name the
         choice. The pose is from odometry, or from fixes if the odometry is of wheels, or of
         unknown origin while the fixes are good to 0.1 m. The names of joints identify the wheels;
         their velocities are used, or else the differences of their positions. yaw_rate is about
         the vertical, which follows from gravity in the accelerations of the IMU.";

/// Make a recording from a robot's log: a bag of ROS 1 or ROS 2 or a log of PX4 in, CSV out.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// MCAP file, ROS 2 bag in SQLite (.db3), ROS 1 bag or log of PX4 (.ulg), each perhaps packed with
    /// zstd; or the folder of a bag
    #[arg(value_name = "FILE")]
    input: PathBuf,

    /// List the topics with type, number of messages, rate, span and use
    #[arg(long, conflicts_with = "output")]
    list: bool,

    /// CSV file for the recording; - or no option writes to standard output, without the .json
    #[arg(long, short, value_name = "FILE.csv")]
    output: Option<PathBuf>,

    #[command(flatten)]
    json: JsonArgs,

    #[command(flatten)]
    replace: ForceArgs,

    /// Source of heading [default: odometry if x and y are from there]
    #[arg(long, value_name = "SOURCE", value_parser = choice(&HEADINGS))]
    heading: Option<HeadingChoice>,

    /// Source of time: the measurement, in each message's header, or the log
    #[arg(long, value_name = "CLOCK", default_value = "header", value_parser = choice(&CLOCKS))]
    time: Clock,

    /// The IMU's z axis points down, its x axis ahead: change the sign of yaw_rate and a_y
    #[arg(long)]
    imu_z_down: bool,

    /// Import what comes before the damage in a truncated or damaged file
    #[arg(long)]
    partial: bool,

    /// Neither notes nor progress
    #[arg(long, short)]
    quiet: bool,

    #[command(flatten)]
    log: LogArgs,
}

const HEADINGS: [(&str, HeadingChoice); 3] = [
    ("odometry", HeadingChoice::Odometry),
    ("imu", HeadingChoice::Imu),
    ("none", HeadingChoice::Without),
];
const CLOCKS: [(&str, Clock); 2] = [("header", Clock::Header), ("log", Clock::Log)];

impl Args {
    fn options(&self) -> ImportOptions {
        ImportOptions {
            heading: self.heading,
            clock: self.time,
            imu_z_down: self.imu_z_down,
            partial: self.partial,
            ..self.log.options()
        }
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let options = args.options();
    let json = args.json.output([&args.input], args.replace.force)?;
    let files = (!args.list).then(|| RecordingFiles::new(args, json.as_ref()));
    let files = files.transpose()?;
    let progress = ProgressLine::bytes(args.quiet);
    let survey = import::survey(&args.input, &mut |done, of| progress.reach(done, 2 * of))?;
    let Some(files) = files else {
        progress.finish();
        return list(args, &survey, &options, json);
    };
    let imported = import::import(&args.input, &survey, &options, &mut |done, of| {
        progress.reach(of + done, 2 * of);
    });
    progress.finish();
    let imported = imported?;
    let rows = files.write(&imported, args, &survey, json)?;
    if !args.quiet {
        summarise(&imported, rows);
    }
    Ok(())
}

/// The recording, and the JSON file beside it.
struct RecordingFiles {
    /// Missing where standard output has the JSON instead.
    table: Option<Output>,
    beside: Option<BesideFile>,
}

/// The JSON file beside a recording, with its former content.
struct BesideFile {
    output: Output,
    content: Map<String, Value>,
}

impl RecordingFiles {
    fn new(args: &Args, json: Option<&Output>) -> Result<Self, Failure> {
        let (path, inputs) = (args.output.as_deref(), [&args.input]);
        let force = args.replace.force;
        let table = args.json.table(path, inputs, force, json)?;
        let path = args.output.as_ref().filter(|path| !is_stream(path));
        let beside = path.map(|path| BesideFile::new(&path.with_extension("json")));
        let beside = beside.transpose()?;
        if let (Some(beside), Some(table)) = (&beside, &table) {
            beside
                .output
                .check_distinct(table, "the recording and the .json file beside it")
                .map_err(|failure| failure.with_remedy("--output FILE.csv"))?;
        }
        if let (Some(beside), Some(json)) = (&beside, json) {
            beside
                .output
                .check_distinct(json, "--json and the .json file beside the recording")
                .map_err(|failure| failure.with_remedy("take another name for --json"))?;
        }
        Ok(Self { table, beside })
    }

    /// Writes all and returns the number of rows.
    fn write(
        self,
        imported: &Imported,
        args: &Args,
        survey: &Survey,
        json: Option<Output>,
    ) -> Result<u64, Failure> {
        let mut outputs = Vec::new();
        let rows = match self.table {
            Some(mut table) => {
                let written = imported.write_csv(&mut table);
                let rows = written.map_err(|source| table.failure(source))?;
                outputs.push(table);
                rows
            }
            None => imported
                .write_csv(&mut io::sink())
                .map_err(Failure::read(&args.input))?,
        };
        let provenance = imported.provenance(&args.input, survey);
        if let Some(json) = json {
            let document = json!({
                "format": "ugv-import/1",
                "rows": rows,
                "seconds": imported.seconds(),
                "provenance": provenance,
            });
            outputs.push(json.with(&format!("{document:#}\n"))?);
        }
        if let Some(beside) = self.beside {
            outputs.push(beside.filled(provenance, args.log.preset())?);
        }
        finish_all(outputs)?;
        Ok(rows)
    }
}

impl BesideFile {
    fn new(path: &Path) -> Result<Self, Failure> {
        let output = Output::to(Some(path))?;
        let content = match read_file(path) {
            Ok(text) => {
                let text = text.trim_start_matches('\u{feff}');
                serde_json::from_str(text).map_err(|error| {
                    let path = path.display();
                    Failure::argument(format!("{path} exists and is not a JSON object: {error}"))
                        .with_remedy("move it away, or choose another name for --output")
                })?
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Map::new(),
            Err(error) => return Err(Failure::read(path)(error)),
        };
        Ok(Self { output, content })
    }

    fn filled(mut self, provenance: Value, preset: Option<Preset>) -> Result<Output, Failure> {
        if let Some(preset) = preset
            && !self.content.contains_key("vehicle")
            && let Ok(vehicle) = serde_json::from_str(&preset.vehicle().to_json())
        {
            // One that stands there was measured, perhaps.
            self.content.insert("vehicle".into(), vehicle);
            self.content["vehicle"]["assumed"] = Value::String(preset.source().into());
        }
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

/// Prints the origin of each column.
fn summarise(imported: &Imported, rows: u64) {
    for column in &imported.columns {
        notify(&format!(
            "{:<11} {:>7} samples from {}: {}",
            column.name,
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
        notify(&format!("{prefix}{note}"));
    }
    notify(&format!("{rows} rows over {:.2} s", imported.seconds()));
}

/// Number of pairs of frames that a list shows.
const MOST_FRAMES: usize = 40;

/// Prints the topics; a star marks those that an import uses.
fn list(
    args: &Args,
    survey: &Survey,
    options: &ImportOptions,
    json: Option<Output>,
) -> Result<(), Failure> {
    let (mut used, mut reasons) = (Vec::new(), Vec::new());
    for kind in MessageKind::ALL {
        let choice = import::choose(survey, kind, options)?;
        if let Some(choice) = choice {
            used.push((choice.topic, kind));
            reasons.push(choice.reason());
        }
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
        "{:name_width$}  {:type_width$}  {:8}  {:>8}  {:>8}  {:>17}  use\n",
        "topic", "type", "encoding", "messages", "rate/Hz", "logged/s"
    );
    for topic in &survey.topics {
        let rate = topic.rate().map_or("-".into(), |rate| format!("{rate:.2}"));
        let [first, last] = topic.logged.map(since);
        let role = used.iter().find(|(chosen, _)| *chosen == topic);
        let role = match (role, topic.kind()) {
            (Some((_, kind)), _) => format!("{} *", kind.name()),
            (None, Some(kind)) => kind.name().into(),
            (None, None) => "-".into(),
        };
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
        if !topic.transforms.is_empty() {
            let pairs = topic.transforms.keys().take(MOST_FRAMES);
            let pairs = pairs.map(|[child, parent]| format!("{parent},{child}"));
            let pairs: Vec<String> = pairs.map(|pair| visible_line(&pair).into_owned()).collect();
            let _ = writeln!(text, "{:name_width$}  frames: {}", "", pairs.join(" "));
        }
    }
    for reason in reasons {
        let _ = writeln!(text, "{}", visible_line(&reason));
    }
    if let Some(json) = json {
        let topics = survey.topics.iter().map(|topic| {
            let role = used.iter().find(|(chosen, _)| *chosen == topic);
            json!({
                "topic": topic.name,
                "type": topic.message_type,
                "encoding": topic.encoding,
                "messages": topic.messages,
                "rate_hz": topic.rate(),
                "first_s": since(topic.logged[0]),
                "last_s": since(topic.logged[1]),
                "serves_as": topic.kind().map(MessageKind::name),
                "used": role.is_some(),
                "joints": topic.joints,
                "frames": topic.transforms.keys().map(|[child, parent]| [parent, child]).collect::<Vec<_>>(),
            })
        });
        let document = json!({ "format": "ugv-topics/1", "topics": topics.collect::<Vec<_>>() });
        json.with(&format!("{document:#}\n"))?.finish()?;
    }
    if !args.json.is_stdout() {
        print(&text)?;
    }
    survey
        .notes
        .iter()
        .for_each(|note| notify(&format!("note: {note}")));
    if let Ending::Broken { place, reason } = &survey.ending {
        notify(&format!(
            "warning: {} is damaged {place}: {reason}; the list has the topics before the damage",
            args.input.display()
        ));
    }
    Ok(())
}
