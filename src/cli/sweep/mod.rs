//! `ugv sweep`: one drive with many sets of parameters.

mod distribution;
mod drive;
mod parameters;
mod setup;

use super::columns::ColumnArgs;
use super::destination::{ForceArgs, JsonArgs};
use super::failure::Failure;
use super::initial::InitialArgument;
use super::input::{doubts, filled, read_input};
use super::jobs;
use super::model::ModelArgs;
use super::output::{Output, finish_all, notify};
use super::progress::ProgressLine;
use crate::recording::Drive;
use crate::simulation::batch::each;
use distribution::{VariedParameter, VariedValues};
use drive::{COLUMNS, DriveResult, drive};
use parameters::{ParameterRow, ParameterTable};
use serde_json::{Value, json};
use setup::Setup;
use std::io::Write;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Instant;

/// Drives between two writes: few enough for a small memory, enough to keep all threads busy.
const BLOCK: usize = 4096;

const EXAMPLES: &str = "\
Examples:
  ugv sweep --input drive.csv --terrain dry_sand --vary soil.cohesion=log-normal:1040,1.3 \\
      --vary soil.friction_angle_deg=normal:28,2.5,15,45 --samples 10000 --output ends.csv
  ugv sweep --input drive.csv --vary vehicle.mass=grid:400,600,5 --vary initial.v_x=list:0,1
  ugv sweep --vary soil.cohesion=uniform:500,2000 --samples 1000 --samples-only --output samples.csv
  ugv sweep --input drive.csv --table samples.csv --output ends.csv

Distributions:  uniform:LOW,HIGH   log-uniform:LOW,HIGH   list:A,B,...   grid:LOW,HIGH,COUNT
                normal:MEAN,SD     log-normal:MEDIAN,FACTOR (two thirds lie between MEDIAN / FACTOR
                and MEDIAN * FACTOR); an appended ,LOW,HIGH bounds the values
Parameters:     those of the FMU: soil.*, vehicle.*, initial.*, effects.* (effects.payload.mass), in
                SI units, or degrees if the name says so. The other parameters are the model's.
Output:         one row per drive: index; its parameters; duration (from the first row) and final
                pose and velocities; distance; largest and mean |longitudinal slip|, largest sinkage
                over wheels and rows; work against the rolling resistance [J]; and in `error` why it
                did not reach the end (a bogged vehicle, for example). The other columns are then
                those of the last row that it reached. The same bits for any --jobs.";

/// Drive the same wheel speeds with many sets of parameters: a table of where each drive ends.
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
    columns: ColumnArgs,

    #[command(flatten)]
    model: ModelArgs,

    /// Initial state, as for `ugv simulate` [default: at rest at the origin]
    #[arg(long, value_name = "KEY=VALUE|no-slip", num_args = 1..)]
    initial: Vec<InitialArgument>,

    /// A parameter that differs from drive to drive; repeatable
    #[arg(
        long,
        value_name = "NAME=DISTRIBUTION",
        required_unless_present = "table"
    )]
    vary: Vec<VariedParameter>,

    /// Number of samples of the distributions; each drives with every combination of the listed values
    #[arg(long, value_name = "N", default_value = "1")]
    samples: NonZeroUsize,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Take the parameters from a table, one row per drive, instead of --vary
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["vary", "samples", "seed", "samples_only"])]
    table: Option<PathBuf>,

    /// Write the table of parameters without driving
    #[arg(long, conflicts_with = "json")]
    samples_only: bool,

    /// CSV file for the table; - or nothing writes to standard output
    #[arg(long, short, value_name = "FILE.csv")]
    output: Option<PathBuf>,

    #[command(flatten)]
    json: JsonArgs,

    #[command(flatten)]
    replace: ForceArgs,

    /// Threads [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(jobs::RANGE))]
    jobs: Option<u16>,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let files = args.model.files();
    let inputs = || args.input.iter().chain(&args.table).chain(&files);
    let force = args.replace.force;
    let json = args.json.output(inputs(), force)?;
    let table = args.output.as_deref();
    let mut output = args.json.table(table, inputs(), force, json.as_ref())?;
    let samples = match &args.table {
        Some(path) => ParameterTable::read(path)?,
        None => draw(args)?,
    };
    let specification = args.model.specification()?;
    let drive = match &args.input {
        Some(path) => read_input(
            path,
            &args.columns,
            specification.vehicle.wheel_radius,
            args.quiet,
        )?,
        None => standstill(),
    };
    doubts(&drive).iter().for_each(|doubt| notify(doubt));
    if let Some(note) = filled(&drive)
        && !args.quiet
    {
        notify(&note);
    }
    let setup = Setup::new(specification, &args.initial, &drive, &samples.names)?;
    setup.check(&samples, args.table.as_deref())?;
    if let Some(mut output) = output.take_if(|_| args.samples_only) {
        samples
            .write(&mut output)
            .map_err(|source| output.failure(source))?;
        return output.finish();
    }
    if drive.len() < 2 {
        return Err(
            Failure::argument("the drive has one row").with_remedy("give --input two rows or more")
        );
    }
    let started = Instant::now();
    let mut results = json.is_some().then(Vec::new);
    let summary = sweep(args, &setup, &samples, output.as_mut(), results.as_mut())?;
    let elapsed = started.elapsed().as_secs_f64();
    let json = json.zip(results);
    let json = json.map(|(json, results)| json.with(&summary.json(&drive, results)));
    finish_all(output.into_iter().chain(json.transpose()?))?;
    if !args.quiet {
        summary.print(samples.rows.len(), drive.duration(), elapsed);
    }
    Ok(())
}

fn draw(args: &Args) -> Result<ParameterTable, Failure> {
    let is_drawn = |v: &VariedParameter| matches!(v.values, VariedValues::Drawn(_));
    if args.samples.get() > 1 && !args.vary.iter().any(is_drawn) {
        let reason = "--samples has no effect: every parameter of --vary is a list or a grid";
        return Err(Failure::argument(reason).with_remedy("remove --samples"));
    }
    ParameterTable::draw(&args.vary, args.samples.get(), args.seed)
}

/// The input of `--samples-only` without one.
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
    samples: &ParameterTable,
    mut output: Option<&mut Output>,
    mut results: Option<&mut Vec<Value>>,
) -> Result<SweepSummary, Failure> {
    let pool = jobs::pool(args.jobs)?;
    let progress = ProgressLine::counting(samples.rows.len() as u64, args.quiet);
    let one = |sample: &ParameterRow| -> Result<DriveResult, Failure> {
        let result = drive(&mut setup.rollout(sample)?);
        progress.count();
        Ok(result)
    };
    let mut summary = SweepSummary::default();
    if let Some(output) = &mut output {
        writeln!(output, "{},{COLUMNS}", samples.header()).map_err(|e| output.failure(e))?;
    }
    for block in samples.rows.chunks(BLOCK) {
        let driven = pool.install(|| each(block, one));
        for (sample, result) in block.iter().zip(driven) {
            let result = result?;
            if let Some(output) = &mut output {
                let written = sample.write(output).and_then(|()| result.write(output));
                written.map_err(|source| output.failure(source))?;
            }
            if let Some(results) = &mut results {
                let mut value = result.json();
                value["index"] = sample.index.into();
                let named = samples.names.iter().cloned();
                let named = named.zip(sample.values.iter().map(|value| json!(value)));
                value["parameters"] = Value::Object(named.collect());
                results.push(value);
            }
            summary.count(sample, &result);
        }
    }
    progress.finish();
    Ok(summary)
}

/// The sweep in one line, and its first failure.
#[derive(Default)]
struct SweepSummary {
    failed: usize,
    /// The first drive that did not reach the end, and why.
    first: Option<(u64, String)>,
}

impl SweepSummary {
    fn count(&mut self, sample: &ParameterRow, result: &DriveResult) {
        if let Some(error) = &result.error {
            self.failed += 1;
            self.first
                .get_or_insert_with(|| (sample.index, error.clone()));
        }
    }

    /// The sweep as JSON, format `ugv-drives/1`.
    fn json(&self, drive: &Drive, results: Vec<Value>) -> String {
        let document = json!({
            "format": "ugv-drives/1",
            "duration": drive.duration(),
            "failed": self.failed,
            "drives": results,
        });
        format!("{document:#}\n")
    }

    fn print(&self, drives: usize, seconds: f64, elapsed: f64) {
        if let Some((index, error)) = &self.first {
            let failed = self.failed;
            notify(&format!(
                "note: {failed} of {drives} drives did not reach the end (column error); the first is \
                 {index}: {error}"
            ));
        }
        let rate = drives as f64 / elapsed;
        notify(&format!(
            "{drives} drives of {seconds:.2} s in {elapsed:.2} s, {rate:.0} per second"
        ));
    }
}
