//! `ugv simulate`: drives a vehicle with recorded or invented wheel speeds.

mod drive;
mod input;
mod table;

use super::initial::{Initial, initial_state};
use super::model::{ModelArgs, names};
use super::output::{Output, finish_all};
use super::plot::{self, Trace};
use super::progress::Progress;
use super::{Failure, tell};
pub use drive::Stop;
use drive::{Schedule, drive};
pub use input::{doubts, filled, read_file, read_input};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;
use ugv_terrain::effects::EffectKind;
use ugv_terrain::recording::{Drive, read_poses};
use ugv_terrain::simulation::{Simulation, SimulationError, State};
use ugv_terrain::vehicle::{VehicleModel, seen_from};

const EXAMPLES: &str = "\
Examples:
  ugv simulate --input drive.csv --output motion.csv --plot motion.svg
  ugv simulate --input drive.csv --terrain dry_sand --initial v_x=1.1 --output-step 0.05
  ugv simulate --input drive.csv --vehicle mine.json --initial no-slip heading=1.57 --output -
  ugv simulate --input drive.csv --effects effects.json --output motion.csv
  ugv simulate --input drive.csv --effects ruts.json --initial no-slip --settled --output motion.csv
  ugv simulate --input after.csv --effects ruts.json --initial x=4 v_x=1 --course before.csv
  ugv simulate --input drive.csv --model model.json --output motion.csv
  generate | ugv simulate --input - --quiet | plot

Input:   a header with time,omega_left,omega_right [s, rad/s], linear in between. Other columns are
         ignored; an empty cell of a wheel speed is a missing sample. Units, sides and times are taken
         as they stand: what `ugv inspect` puts right in a recording is not put right here.
Output:  wheel speeds, pose, velocities, accelerations, resistances and moments, then each wheel's
         slips, load, sinkage, entry angle and forces, in SI units and radians. When the vehicle
         cannot drive on to the end, nothing is written.";

/// Drive a vehicle over a terrain: wheel speeds in, motion and forces out.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// CSV file with the columns time,omega_left,omega_right; - reads standard input
    #[arg(long, value_name = "FILE.csv")]
    input: PathBuf,

    #[command(flatten)]
    model: ModelArgs,

    /// Where the vehicle starts and how fast: any of x, y, heading, v_x, v_y, yaw_rate, or
    /// no-slip for the velocities of rolling without slip at the first wheel speeds
    /// [default: at rest at the origin]
    #[arg(long, value_name = "KEY=VALUE|no-slip", num_args = 1..)]
    initial: Vec<Initial>,

    /// Begin in the midst of a drive: ruts and shear as if the initial motion had lasted, instead of on
    /// untouched ground
    #[arg(long)]
    settled: bool,

    /// As --settled, with the ruts of a vehicle that came to the initial pose over these: columns x,y,heading
    /// [m, m, rad], the oldest first
    #[arg(long, value_name = "FILE.csv")]
    course: Option<PathBuf>,

    /// CSV file for the motion; - or nothing writes to standard output
    #[arg(long, value_name = "FILE.csv")]
    output: Option<PathBuf>,

    /// Write a row every so many seconds and at the end, instead of one per row of the input
    #[arg(long, value_name = "S", value_parser = step)]
    output_step: Option<f64>,

    /// Draw path, speeds, slips, resistance and moments
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

fn step(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(step) if f64::is_finite(step) && step > 0.0 => Ok(step),
        _ => Err("expected a number of seconds above 0".into()),
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let specification = args.model.specification()?;
    let effects = names(&specification.effects, EffectKind::Physics);
    let model = VehicleModel::from_specification(&specification).map_err(Failure::Model)?;
    let recording = read_input(&args.input)?;
    doubts(&recording).for_each(|doubt| tell(&doubt));
    let state = initial_state(
        &args.initial,
        model.vehicle(),
        recording.wheel_speeds(0).into(),
    )?;
    let course = args.course.as_deref();
    let course = course.map(|path| read_file(path, read_poses)).transpose()?;
    let schedule = Schedule::new(&recording, args.output_step)?;
    let mut read = args.model.files();
    read.push(args.input.clone());
    read.extend(args.course.clone());
    let own = |path: Option<&Path>| Output::of(path, &read);
    let mut table = own(args.output.as_deref())?;
    let picture = args
        .plot
        .as_deref()
        .map(|path| picture(own(Some(path))?, &table))
        .transpose()?;

    let mut trace = picture
        .is_some()
        .then(|| Trace::new(model.vehicle(), state));
    let progress = Progress::counting(0, args.quiet);
    let mut simulation = Simulation::new(model);
    let midst = course.or(args.settled.then(Vec::new));
    begin(&mut simulation, &recording, state, midst.as_deref()).map_err(Failure::Simulation)?;
    let mut summary = Summary::new(&recording, simulation.state());
    let columns = table::columns(simulation.model().vehicle());
    table
        .write_all(table::header(&columns).as_bytes())
        .map_err(|source| table.failure(source))?;
    drive(&recording, schedule, &mut simulation, |stop| {
        summary.visit(stop);
        let share = (stop.time - recording.time[0]) / recording.duration();
        progress.reach((1e3 * share) as u64, 1000);
        if let Some(trace) = &mut trace {
            trace.visit(stop);
        }
        if stop.is_row {
            table::write_row(&mut table, &columns, stop).map_err(|source| table.failure(source))?;
        }
        Ok(())
    })?;
    progress.finish();
    let elapsed = summary.started.elapsed();

    let mut outputs = vec![table];
    if let (Some(trace), Some(picture)) = (&trace, picture) {
        let svg = plot::draw(trace, &args.model.ground());
        outputs.push(picture.with(&svg)?);
    }
    finish_all(outputs)?;
    if !args.quiet {
        summary.tell(&recording, effects.as_deref(), elapsed.as_secs_f64());
    }
    Ok(())
}

/// Places the vehicle where a recording begins, maybe in the midst of a drive that came over some poses to there.
fn begin(
    simulation: &mut Simulation,
    recording: &Drive,
    state: State,
    midst: Option<&[[f64; 3]]>,
) -> Result<(), SimulationError> {
    simulation.set_state(state)?;
    if let Some(course) = midst {
        simulation.set_wheel_speeds(recording.wheel_speeds(0).into())?;
        let here = [state.x, state.y, state.heading];
        let seen = course.iter().map(|pose| seen_from(*pose, here));
        simulation.settle_after(&seen.collect::<Vec<_>>())?;
    }
    Ok(())
}

fn picture(picture: Output, table: &Output) -> Result<Output, Failure> {
    if picture.collides_with(table) {
        return Err(Failure::Argument {
            reason: "--plot and --output lead to the same place".into(),
            hint: None,
        });
    }
    Ok(picture)
}

/// What the user is told in the end.
struct Summary {
    started: Instant,
    start: f64,
    last: State,
    distance: f64,
    warned: bool,
}

impl Summary {
    fn new(recording: &Drive, state: State) -> Self {
        Self {
            started: Instant::now(),
            start: recording.time[0],
            last: state,
            distance: 0.0,
            warned: false,
        }
    }

    fn visit(&mut self, stop: &Stop) {
        self.distance += (stop.state.x - self.last.x).hypot(stop.state.y - self.last.y);
        self.last = stop.state;
        let lifted = stop
            .wrench
            .wheels
            .iter()
            .position(|wheel| wheel.load <= 0.0);
        if let Some(wheel) = lifted
            && !self.warned
        {
            self.warned = true;
            tell(&format!(
                "warning: at {} s wheel {} lifts off the ground; the others carry its load",
                stop.time,
                wheel + 1
            ));
        }
    }

    fn tell(&self, recording: &Drive, effects: Option<&str>, elapsed: f64) {
        let seconds = recording.duration();
        let State { x, y, heading, .. } = self.last;
        let heading_deg = heading.to_degrees();
        if recording.filled_rows > 0 {
            tell(&filled(recording));
        }
        let effects = effects.map_or(String::new(), |names| format!(", effects: {names}"));
        tell(&format!(
            "simulated {seconds:.2} s from {} s on, drove {:.3} m to x {x:.3} m, y {y:.3} m, \
             heading {heading_deg:.2} deg, {:.0} times as fast as real time{effects}",
            self.start,
            self.distance,
            seconds / elapsed
        ));
    }
}
