//! `ugv sweep`: one drive with many sets of parameters.

mod distribution;
mod outcome;
mod samples;
mod setup;

use super::initial::Initial;
use super::jobs::pool;
use super::model::ModelArgs;
use super::output::Output;
use super::progress::Progress;
use super::simulate::{doubts, filled, read_input};
use super::{Failure, tell};
use distribution::{Values, Varied};
use outcome::{COLUMNS, DriveResult};
use rayon::prelude::*;
use samples::{Sample, Samples};
use setup::Setup;
use std::io::Write;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Instant;
use ugv_terrain::recording::Drive;

/// Drives between two writings: memory stays small, and no thread waits long for another.
const BLOCK: usize = 4096;

const EXAMPLES: &str = "\
Examples:
  ugv sweep --input drive.csv --terrain dry_sand --vary soil.cohesion=log-normal:1040,1.3 \\
      --vary soil.friction_angle_deg=normal:28,2.5,15,45 --samples 10000 --output ends.csv
  ugv sweep --input drive.csv --vary vehicle.mass=grid:400,600,5 --vary initial.v_x=list:0,1
  ugv sweep --vary soil.cohesion=uniform:500,2000 --samples 1000 --samples-only --output samples.csv
  ugv sweep --input drive.csv --table samples.csv --output ends.csv    # as scripts/sweep.py does

Distributions:  uniform:LOW,HIGH   log-uniform:LOW,HIGH   list:A,B,...   grid:LOW,HIGH,COUNT
                normal:MEAN,SD     log-normal:MEDIAN,FACTOR (two thirds lie between MEDIAN / FACTOR
                and MEDIAN * FACTOR); with ,LOW,HIGH behind them nothing lies beyond
Parameters:     the FMU's: soil.*, vehicle.*, initial.*, effects.* (effects.payload.mass), in SI
                units, or degrees where the name says so. The model gives those that are not varied.
Output:         one row per drive: index; its parameters; how long it drove (seconds from the first row); pose and
                velocities there; distance; largest and mean |longitudinal slip| and largest sinkage
                over wheels and rows; work against the rolling resistance [J]; and in `error` why it
                did not reach the end (a bogged vehicle, say): then the other columns tell of the
                last row that it reached. The same bits whatever --jobs.";

/// Drive the same wheel speeds with many sets of parameters; a table of where each drive ends.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// CSV file with the columns time,omega_left,omega_right; - reads standard input
    #[arg(
        long,
        value_name = "FILE.csv",
        required_unless_present = "samples_only"
    )]
    input: Option<PathBuf>,

    #[command(flatten)]
    model: ModelArgs,

    /// Where the vehicle starts and how fast, as for `ugv simulate` [default: at rest at the origin]
    #[arg(long, value_name = "KEY=VALUE|no-slip", num_args = 1..)]
    initial: Vec<Initial>,

    /// A parameter that differs from drive to drive; may be given several times
    #[arg(
        long,
        value_name = "NAME=DISTRIBUTION",
        required_unless_present = "table"
    )]
    vary: Vec<Varied>,

    /// How many samples of what is drawn; each is driven with every combination of what is listed
    #[arg(long, value_name = "N", default_value = "1")]
    samples: NonZeroUsize,

    /// Seed of what is drawn; the same seed, the same numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Take the parameters from a table, one row per drive, in place of --vary
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["vary", "samples", "seed", "samples_only"])]
    table: Option<PathBuf>,

    /// Write the table of parameters, and do not drive
    #[arg(long)]
    samples_only: bool,

    /// CSV file for the table; - or nothing writes to standard output
    #[arg(long, value_name = "FILE.csv")]
    output: Option<PathBuf>,

    /// Threads [default: one per processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let files = args.model.files();
    let sources = args.input.iter().chain(&args.table).chain(&files);
    let mut output = Output::of(args.output.as_deref(), sources)?;
    let samples = match &args.table {
        Some(path) => Samples::read(path)?,
        None => draw(args)?,
    };
    let specification = args.model.specification()?;
    let drive = match &args.input {
        Some(path) => read_input(path)?,
        None => standstill(),
    };
    doubts(&drive).for_each(|doubt| tell(&doubt));
    if drive.filled_rows > 0 && !args.quiet {
        tell(&filled(&drive));
    }
    let setup = Setup::new(specification, &args.initial, &drive, &samples.names)?;
    setup.check(&samples, args.table.as_deref())?;
    if args.samples_only {
        samples
            .write(&mut output)
            .map_err(|source| output.failure(source))?;
        return output.finish();
    }
    if drive.len() < 2 {
        return Err(Failure::Argument {
            reason: "a drive of one row leads nowhere".into(),
            hint: Some("give --input two rows or more".into()),
        });
    }
    let begin = Instant::now();
    let summary = sweep(args, &setup, &drive, &samples, &mut output)?;
    let elapsed = begin.elapsed().as_secs_f64();
    output.finish()?;
    if !args.quiet {
        summary.tell(samples.rows.len(), drive.duration(), elapsed);
    }
    Ok(())
}

fn draw(args: &Args) -> Result<Samples, Failure> {
    let drawn = |v: &Varied| matches!(v.values, Values::Drawn(_));
    if args.samples.get() > 1 && !args.vary.iter().any(drawn) {
        return Err(Failure::Argument {
            reason: "--samples draws nothing: every parameter of --vary is a list or a grid".into(),
            hint: Some("leave --samples out".into()),
        });
    }
    Samples::draw(&args.vary, args.samples.get(), args.seed)
}

/// Stands for the input where nothing is driven.
fn standstill() -> Drive {
    Drive {
        time: vec![0.0],
        omega_left: vec![0.0],
        omega_right: vec![0.0],
        filled_rows: 0,
    }
}

fn sweep(
    args: &Args,
    setup: &Setup,
    drive: &Drive,
    samples: &Samples,
    output: &mut Output,
) -> Result<Summary, Failure> {
    let pool = pool(args.jobs)?;
    let progress = Progress::counting(samples.rows.len() as u64, args.quiet);
    let one = |sample: &Sample| -> Result<DriveResult, Failure> {
        let (model, start) = setup.prepare(sample)?;
        let outcome = outcome::drive(drive, model, start);
        progress.count();
        Ok(outcome)
    };
    let mut summary = Summary::default();
    writeln!(output, "{},{COLUMNS}", samples.header()).map_err(|e| output.failure(e))?;
    for block in samples.rows.chunks(BLOCK) {
        let outcomes: Vec<_> = pool.install(|| block.par_iter().map(one).collect());
        for (sample, outcome) in block.iter().zip(outcomes) {
            let outcome = outcome?;
            let written = sample.write(output).and_then(|()| outcome.write(output));
            written.map_err(|source| output.failure(source))?;
            summary.count(sample, &outcome);
        }
    }
    progress.finish();
    Ok(summary)
}

/// What the user is told in the end.
#[derive(Default)]
struct Summary {
    failed: usize,
    /// The first drive that did not reach the end, and why.
    first: Option<(u64, String)>,
}

impl Summary {
    fn count(&mut self, sample: &Sample, outcome: &DriveResult) {
        if let Some(error) = &outcome.error {
            self.failed += 1;
            self.first
                .get_or_insert_with(|| (sample.index, error.clone()));
        }
    }

    fn tell(&self, drives: usize, seconds: f64, elapsed: f64) {
        if let Some((index, error)) = &self.first {
            let failed = self.failed;
            tell(&format!(
                "note: {failed} of {drives} drives did not reach the end (column error); the first is \
                 {index}: {error}"
            ));
        }
        let rate = drives as f64 / elapsed;
        tell(&format!(
            "{drives} drives of {seconds:.2} s in {elapsed:.2} s, {rate:.0} per second"
        ));
    }
}
