//! `ugv simulate`: drives a vehicle with given wheel speeds.

mod drive;
mod plot;
mod table;

use super::columns::ColumnArgs;
use super::destination::{ForceArgs, JsonArgs};
use super::failure::Failure;
use super::initial::{InitialArgument, initial_state};
use super::input::{doubts, filled, read_file, read_input};
use super::model::{ModelArgs, names};
use super::output::{Output, finish_all, notify};
use super::progress::ProgressLine;
use crate::effects::EffectKind;
use crate::recording::{Drive, read_poses};
use crate::simulation::{Simulation, SimulationError, State};
use crate::vehicle::{VehicleModel, seen_from};
use drive::{DrivePoint, Schedule, drive};
use plot::Trace;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  ugv simulate --input drive.csv --output motion.csv --plot motion.svg
  ugv simulate --input drive.csv --terrain dry_sand --initial v_x=1.1 --output-step input
  ugv simulate --input drive.csv --vehicle mine.json --initial no-slip heading=1.57 --output -
  ugv simulate --input drive.csv --effects effects.json --output motion.csv
  ugv simulate --input drive.csv --effects ruts.json --initial no-slip --settled --output motion.csv
  ugv simulate --input after.csv --effects ruts.json --initial x=4 v_x=1 --course before.csv
  ugv simulate --input drive.csv --model model.json --output motion.csv
  generate | ugv simulate --input - --quiet | plot

Input:   a header with time,omega_left,omega_right [s, rad/s], linear in between. Other columns are
         ignored. An empty cell of a wheel speed is a missing sample. Units, sides and times are
         used as they are: `ugv inspect` corrects a recording, this command does not.
Output:  wheel speeds, pose, velocities, accelerations, resistances and moments, torques and power
         of the axles, then each wheel's slips, load, sinkage, entry angle, forces and torque, in SI
         units and radians. If the vehicle cannot drive to the end, no file is written.";

/// Drive a vehicle over a terrain: wheel speeds in, motion and forces out.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// CSV file with the columns time,omega_left,omega_right; - reads standard input
    #[arg(long, value_name = "FILE.csv")]
    input: PathBuf,

    #[command(flatten)]
    columns: ColumnArgs,

    #[command(flatten)]
    model: ModelArgs,

    /// Initial state: any of x, y, heading, v_x, v_y, yaw_rate, or no-slip for the velocities of
    /// rolling without slip at the first wheel speeds [default: at rest at the origin]
    #[arg(long, value_name = "KEY=VALUE|no-slip", num_args = 1..)]
    initial: Vec<InitialArgument>,

    /// Start in the middle of a drive: with the ruts and shear of a steady motion in the initial
    /// state, instead of untouched ground
    #[arg(long)]
    settled: bool,

    /// As --settled, with the ruts of a vehicle that reached the initial pose over these poses:
    /// columns x,y,heading [m, m, rad], the oldest first
    #[arg(long, value_name = "FILE.csv")]
    course: Option<PathBuf>,

    /// CSV file for the motion; - or nothing writes to standard output
    #[arg(long, short, value_name = "FILE.csv")]
    output: Option<PathBuf>,

    /// Write a row at this interval and at the end; `input`: at the rows of the input
    #[arg(long, value_name = "S|input", default_value = "0.05", value_parser = step)]
    output_step: OutputStep,

    #[command(flatten)]
    json: JsonArgs,

    /// Draw path, speeds, slips, resistance and moments
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,

    #[command(flatten)]
    replace: ForceArgs,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

/// The interval between points of a plot \[s\]: a bend at full speed is smooth.
const PLOT_STEP: f64 = 0.05;

/// When rows of the output are due.
#[derive(Debug, Clone, Copy)]
enum OutputStep {
    /// At each row of the input.
    Input,
    /// At this interval \[s\].
    Seconds(f64),
}

impl OutputStep {
    fn seconds(self) -> Option<f64> {
        match self {
            Self::Input => None,
            Self::Seconds(step) => Some(step),
        }
    }

    /// Whether the rows draw smooth lines.
    fn is_dense(self) -> bool {
        self.seconds().is_some_and(|step| step <= PLOT_STEP)
    }
}

fn step(text: &str) -> Result<OutputStep, String> {
    if text == "input" {
        return Ok(OutputStep::Input);
    }
    match text.parse() {
        Ok(step) if f64::is_finite(step) && step > 0.0 => Ok(OutputStep::Seconds(step)),
        _ => Err("expected a number of seconds above 0, or input".into()),
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let specification = args.model.specification()?;
    let effects = names(&specification.effects, EffectKind::Physics);
    let model = VehicleModel::from_specification(&specification)?;
    let recording = read_input(
        &args.input,
        &args.columns,
        model.vehicle().wheel_radius,
        args.quiet,
    )?;
    let warnings = doubts(&recording);
    warnings.iter().for_each(|doubt| notify(doubt));
    let state = initial_state(
        &args.initial,
        model.vehicle(),
        recording.wheel_speeds(0).into(),
    )?;
    let course = args.course.as_deref();
    let course = course.map(|path| read_file(path, read_poses)).transpose()?;
    let course = course.or(args.settled.then(Vec::new));
    let schedule = Schedule::new(&recording, args.output_step.seconds())?;
    let mut inputs = args.model.files();
    inputs.push(args.input.clone());
    inputs.extend(args.course.clone());
    let force = args.replace.force;
    let json = args.json.output(&inputs, force)?;
    let output = args.output.as_deref();
    let mut table = args.json.table(output, &inputs, force, json.as_ref())?;
    let picture = args.plot.as_deref();
    let picture = picture.map(|path| Output::from_inputs(Some(path), &inputs, force));
    let picture = picture.transpose()?;
    for (other, names) in [
        (&table, "--plot and --output"),
        (&json, "--plot and --json"),
    ] {
        if let (Some(picture), Some(other)) = (&picture, other) {
            picture.check_distinct(other, names)?;
        }
    }

    let vehicle = model.vehicle().clone();
    let begin = || -> Result<Simulation, SimulationError> {
        let mut simulation = Simulation::new(model.clone());
        start(&mut simulation, &recording, state, course.as_deref())?;
        Ok(simulation)
    };
    let mut trace = picture.is_some().then(|| Trace::new(&vehicle, state));
    let progress = ProgressLine::counting(0, args.quiet);
    let mut simulation = begin()?;
    let mut summary = DriveSummary::new(&recording, simulation.state());
    let columns = table::columns(&vehicle);
    if let Some(table) = &mut table {
        table
            .write_all(table::header(&columns).as_bytes())
            .map_err(|source| table.failure(source))?;
    }
    drive(&recording, schedule, &mut simulation, |point| {
        summary.visit(point);
        let share = (point.time - recording.time[0]) / recording.duration();
        progress.reach((1e3 * share) as u64, 1000);
        if let Some(trace) = trace.as_mut().filter(|_| args.output_step.is_dense()) {
            trace.visit(point);
        }
        if let Some(table) = table.as_mut().filter(|_| point.is_row) {
            table::write_row(table, &columns, point).map_err(|source| table.failure(source))?;
        }
        Ok(())
    })?;
    if let Some(trace) = trace.as_mut().filter(|_| !args.output_step.is_dense()) {
        // A drive for the plot alone: stops in between would change the last bits of the table.
        let schedule = Schedule::new(&recording, Some(PLOT_STEP))?;
        drive(&recording, schedule, &mut begin()?, |point| {
            trace.visit(point);
            Ok(())
        })?;
    }
    progress.finish();
    let elapsed = summary.started.elapsed();

    let picture = picture.zip(trace.as_ref());
    let picture = picture.map(|(picture, trace)| picture.with(&trace.draw(&args.model.ground())));
    let effects = effects.as_deref();
    let json = json.map(|json| json.with(&summary.json(&recording, effects, &warnings)));
    let outputs = [table.map(Ok), picture, json];
    let outputs = outputs.into_iter().flatten();
    finish_all(outputs.collect::<Result<Vec<_>, _>>()?)?;
    if !args.quiet {
        summary.print(&recording, effects, elapsed.as_secs_f64());
    }
    Ok(())
}

/// Places the vehicle at the start of a recording; with a course in the middle of a drive that came over these poses.
fn start(
    simulation: &mut Simulation,
    recording: &Drive,
    state: State,
    course: Option<&[[f64; 3]]>,
) -> Result<(), SimulationError> {
    simulation.set_state(state)?;
    if let Some(course) = course {
        simulation.set_wheel_speeds(recording.wheel_speeds(0).into())?;
        let here = [state.x, state.y, state.heading];
        let seen = course.iter().map(|pose| seen_from(*pose, here));
        simulation.settle_after(&seen.collect::<Vec<_>>())?;
    }
    Ok(())
}

/// The drive in one line.
struct DriveSummary {
    started: Instant,
    start: f64,
    last: State,
    distance: f64,
    rows: u64,
    /// When a wheel first lifted off, and its number.
    lifted: Option<(f64, usize)>,
}

impl DriveSummary {
    fn new(recording: &Drive, state: State) -> Self {
        Self {
            started: Instant::now(),
            start: recording.time[0],
            last: state,
            distance: 0.0,
            rows: 0,
            lifted: None,
        }
    }

    fn visit(&mut self, point: &DrivePoint) {
        self.distance += (point.state.x - self.last.x).hypot(point.state.y - self.last.y);
        self.last = point.state;
        self.rows += u64::from(point.is_row);
        let mut wheels = point.wrench.wheels.iter();
        if let Some(wheel) = wheels.position(|wheel| wheel.load <= 0.0)
            && self.lifted.is_none()
        {
            self.lifted = Some((point.time, wheel + 1));
            notify(&format!(
                "warning: at {} s wheel {} lifts off the ground; the others carry its load",
                point.time,
                wheel + 1
            ));
        }
    }

    /// The drive as JSON, format `ugv-simulation/1`.
    fn json(&self, recording: &Drive, effects: Option<&str>, warnings: &[String]) -> String {
        let State {
            x,
            y,
            heading,
            v_x,
            v_y,
            yaw_rate,
        } = self.last;
        let document = json!({
            "format": "ugv-simulation/1",
            "start": self.start,
            "duration": recording.duration(),
            "rows": self.rows,
            "interpolated_rows": recording.filled_rows,
            "distance": self.distance,
            "end": {
                "x": x, "y": y, "heading": heading, "v_x": v_x, "v_y": v_y, "yaw_rate": yaw_rate,
            },
            "lift_off": self.lifted.map(|(time, wheel)| json!({ "time": time, "wheel": wheel })),
            "effects": effects.map_or_else(Vec::new, |names| names.split(", ").collect()),
            "warnings": warnings,
        });
        format!("{document:#}\n")
    }

    fn print(&self, recording: &Drive, effects: Option<&str>, elapsed: f64) {
        let seconds = recording.duration();
        let State { x, y, heading, .. } = self.last;
        let heading_deg = heading.to_degrees();
        filled(recording).iter().for_each(|note| notify(note));
        let effects = effects.map_or(String::new(), |names| format!(", effects: {names}"));
        notify(&format!(
            "simulated {seconds:.2} s from {} s on, drove {:.3} m to x {x:.3} m, y {y:.3} m, \
             heading {heading_deg:.2} deg, {:.0} times as fast as real time{effects}",
            self.start,
            self.distance,
            seconds / elapsed
        ));
    }
}
