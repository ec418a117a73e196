//! `ugv inspect`: whether a recording can be diagnosed, and its quality.

use super::columns::ColumnArgs;
use super::destination::{ForceArgs, JsonArgs};
use super::failure::Failure;
use super::log::LogArgs;
use super::model::load_vehicle;
use super::output::{Output, finish_all, notify_all, print_beside};
use super::recordings;
use crate::inspection::inspect;
use crate::report::inspection::{json, page, text};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  ugv inspect drive.csv
  ugv inspect drive.csv --vehicle mine.json
  ugv inspect drive.csv --report drive.html --json drive.inspection.json --quiet

Input:   CSV with time,omega_left,omega_right [s, rad/s] and any of x,y [m], heading [rad], v_x,v_y
         [m/s], yaw_rate [rad/s], a_x,a_y [m/s^2]. An empty cell or nan is a missing sample. A
         column `run` separates runs. Names and units in common use are known, such as yaw_deg
         or wl [rpm]; --column names others. Other columns are ignored. A log is imported first:
         MCAP, .db3, .bag, .ulg, the folder of a bag. drive.json beside drive.csv may hold
         vehicle, terrain and sensors.
Repairs: wrong units, swapped columns, late rows and wrapped headings are corrected if they are
         unambiguous, with a note. Otherwise the file is refused.
Doubts:  what is wrong with the data rather than with the model, each with its probability, evidence
         and remedy: mirrored sides, a wrong radius, gear, track or unit, a pose from the wheels,
         frozen or cut-off channels, jumps. The first line says whether the recording is fit for
         `ugv diagnose`. Without a vehicle, radius, gear and track cannot be judged.
Delays:  positive if the first signal is behind the second. A delay behind the wheels includes the
         response of the vehicle: up to 0.3 s in turns.";

/// Check a recording: whether it can be what it claims, rates, gaps, noise, delays between sensors.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The recording, or a robot's log
    #[arg(value_name = "REC.csv|LOG")]
    recording: PathBuf,

    /// Vehicle that drove: a file, tran2007, husky, jackal, warthog or scout [default: that of REC.json]
    #[arg(long, value_name = "NAME|FILE.json")]
    vehicle: Option<PathBuf>,

    #[command(flatten)]
    columns: ColumnArgs,

    #[command(flatten)]
    json: JsonArgs,

    /// Write a report with plots
    #[arg(long, alias = "page", value_name = "FILE.html")]
    report: Option<PathBuf>,

    #[command(flatten)]
    replace: ForceArgs,

    /// No text
    #[arg(long, short)]
    quiet: bool,

    #[command(flatten)]
    log: LogArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    // The name of a preset vehicle is not a file.
    let vehicle_file = args.vehicle.iter().filter(|path| path.exists());
    let inputs = || std::iter::once(&args.recording).chain(vehicle_file.clone());
    let force = args.replace.force;
    let json_file = args.json.output(inputs(), force)?;
    let report = args.report.as_deref();
    let report_file = report.map(|path| Output::from_inputs(Some(path), inputs(), force));
    let report_file = report_file.transpose()?;
    if let (Some(json), Some(report)) = (&json_file, &report_file) {
        json.check_distinct(report, "--json and --report")?;
    }
    let vehicle = args.vehicle.as_deref().map(load_vehicle).transpose()?;
    let vehicle = vehicle.as_ref();
    args.log.check(std::slice::from_ref(&args.recording))?;
    let (columns, log) = (&args.columns.columns, args.log.options());
    let (recording, notes) = recordings::read(&args.recording, vehicle, columns, &log)?;
    notify_all(&notes, args.quiet);
    let inspection = inspect(&recording, vehicle);
    let filled = [
        json_file.map(|file| file.with(&json(&recording, &inspection))),
        report_file.map(|file| file.with(&page(&recording, &inspection))),
    ];
    let filled: Result<Vec<_>, _> = filled.into_iter().flatten().collect();
    finish_all(filled?)?;
    if args.quiet {
        return Ok(());
    }
    let text = text(&recording, &inspection);
    print_beside(&text, &[args.json.place(), report])
}
