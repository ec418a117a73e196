//! `ugv fit`: soil parameters from recordings.

mod names;
mod results;
mod summary;

use super::answer::{Answer, Caller};
use super::destination::{ForceArgs, JsonArgs};
use super::doubts;
use super::failure::Failure;
use super::jobs;
use super::nominal::{NominalArgs, fitted_to};
use super::output::{Output, finish_all, notify_all, print_beside};
use super::progress::ProgressLine;
use crate::fit::{Fit, Fitted, Options, Stage, fit_model_until};
use crate::identification::{WindowOptions, fitted_part};
use crate::inspection::Doubt;
use crate::recording::Recording;
use crate::vehicle::{Specification, Vehicle};
use names::{FreeNames, print_names};
use rayon::ThreadPool;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  ugv fit drive.csv --output model.json --json fit.json
  ugv fit drive.csv --half --output half.json    # then: ugv score drive.csv --model half.json
  ugv fit monday.csv tuesday.csv --vehicle mine.json --terrain sandy_loam --json fit.json
  ugv fit drive.csv --free cohesion,friction_angle,wheel_radius --sensors pose_latency
  ugv fit --free help          # all parameters, with their priors

Input:   recordings with a header time,omega_left,omega_right and any of x,y,heading,v_x,v_y,
         yaw_rate [s, m, rad]. An empty cell is a missing sample. Several recordings share soil and
         vehicle; each has its latencies and biases.
Output:  the fitted model, for `ugv simulate --model FILE`. The JSON has the intervals and all other
         results, in SI units and radians.";

/// Fit soil parameters to recordings, with intervals.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Recordings, or robots' logs; NAME.json beside NAME.csv may hold the vehicle
    #[arg(value_name = "REC.csv|LOG")]
    recordings: Vec<PathBuf>,

    /// Parameters to fit, separated by commas, or help for a list
    /// [default: cohesion, friction_angle, frictional_modulus, sinkage_exponent, shear_modulus]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    free: Vec<String>,

    /// Sensor parameters to fit for each recording, separated by commas, or none
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "pose_latency,wheel_latency,yaw_rate_bias"
    )]
    sensors: Vec<String>,

    #[command(flatten)]
    nominal: NominalArgs,

    /// Fit the half of each recording that `ugv score` does not judge
    #[arg(long)]
    half: bool,

    /// Length of a segment; each has an initial state
    #[arg(long, value_name = "S", default_value_t = 5.0, value_parser = seconds)]
    segment: f64,

    /// Random starts in search of other solutions; 0 for none
    #[arg(long, value_name = "N", default_value_t = 20)]
    starts: usize,

    /// Seed of the random starts
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Weight outliers as all other samples
    #[arg(long)]
    not_robust: bool,

    /// Threads [default: one per processor]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(jobs::RANGE))]
    jobs: Option<u16>,

    /// File for the fitted model; - writes to standard output [default: none]
    #[arg(long, short, value_name = "FILE.json")]
    output: Option<PathBuf>,

    #[command(flatten)]
    json: JsonArgs,

    /// There is no report as HTML
    #[arg(long, hide = true, value_name = "FILE", num_args = 0..=1, value_parser = no_report)]
    report: Option<PathBuf>,

    #[command(flatten)]
    replace: ForceArgs,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

/// Refuses a report, which is HTML in other commands.
fn no_report(path: &str) -> Result<PathBuf, String> {
    Err(format!(
        "a fit has no report as HTML; --json {path} writes all results"
    ))
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (3.0..=8.0).contains(&seconds) => Ok(seconds),
        _ => Err(
            "expected 3 to 8 seconds: shorter segments have little information, longer ones drift"
                .into(),
        ),
    }
}

/// What is fitted.
struct Question {
    recordings: Vec<Recording>,
    /// Doubts about each recording.
    doubted: Vec<(String, Vec<Doubt>)>,
    nominal: Specification,
    free: FreeNames,
    options: Options,
    pool: ThreadPool,
}

/// The fit and its files.
struct Found {
    fit: Fit,
    model: String,
    results: String,
}

impl Question {
    /// Reads the files. What the user has to know is added to the notes.
    fn of(args: &Args, notes: &mut Vec<String>) -> Result<Self, Failure> {
        if args.recordings.is_empty() {
            return Err(Failure::argument("no recording to fit")
                .with_remedy("ugv fit drive.csv --output model.json"));
        }
        args.nominal.check(&args.recordings)?;
        let named = args.nominal.load()?;
        let mut recordings = named.read(&args.recordings, notes)?;
        named.check_vehicle(&recordings)?;
        let mut doubted = Vec::new();
        for recording in &mut recordings {
            let (rest, found) = doubts::settled(std::mem::take(recording), named.vehicle.as_ref());
            notes.extend(doubts::lines(&rest.name, &found));
            doubted.push((rest.name.clone(), found));
            *recording = rest;
        }
        if args.half {
            for recording in &mut recordings {
                *recording = fitted_part(recording, &WindowOptions::default())?;
            }
        }
        let nominal = named.nominal(&recordings, notes)?;
        let mut free = FreeNames::parse(&args.free, &args.sensors)?;
        Ok(Self {
            recordings,
            doubted,
            nominal,
            options: Options {
                sensors: std::mem::take(&mut free.sensors),
                segment: args.segment,
                starts: args.starts,
                seed: args.seed,
                robust: !args.not_robust,
            },
            free,
            pool: jobs::pool(args.jobs)?,
        })
    }

    fn answer(&self, args: &Args, caller: &Caller) -> Result<Found, Failure> {
        let Self {
            recordings,
            doubted,
            nominal,
            free,
            options,
            pool,
        } = self;
        let show = |stage| match stage {
            Stage::Turn(turn) => (caller.step)(&format!("fitting motion and noise, turn {turn}")),
            Stage::Start(start) => {
                (caller.step)(&format!("random start {} of {}", start + 1, args.starts));
            }
        };
        let deadline = caller.deadline();
        let fit = || fit_model_until(deadline, nominal, &free.model, recordings, options, &show);
        let Fitted { model, fit } = pool.install(fit)?;
        Ok(Found {
            model: model.to_json_fitted(&fitted_to(recordings, !args.half)),
            results: results::to_json(&fit, &model, recordings, options, doubted),
            fit,
        })
    }
}

/// The texts of a fit's files and its summary, for a caller that writes no files.
pub fn answer(args: &Args, caller: &Caller) -> Result<Answer, Failure> {
    let started = Instant::now();
    let mut notes = Vec::new();
    let question = Question::of(args, &mut notes)?;
    let found = question.answer(args, caller)?;
    let seconds = started.elapsed().as_secs_f64();
    let summary = summary::text(&found.fit, &question.recordings, seconds);
    let Found { model, results, .. } = found;
    let texts = vec![
        ("model.json", model),
        ("fit.json", results),
        ("summary", summary),
    ];
    Ok(Answer { texts, notes })
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if args.free == ["help"] || args.sensors == ["help"] {
        let mut named = args.nominal.load()?;
        named.vehicle.get_or_insert_with(Vehicle::tran2007);
        return print_names(&named.nominal(&[], &mut Vec::new())?);
    }
    let mut notes = Vec::new();
    let question = Question::of(args, &mut notes);
    notify_all(&notes, args.quiet);
    let question = question?;
    let files = args.nominal.files();
    let inputs = || args.recordings.iter().chain(&files);
    let force = args.replace.force;
    let file = |path: &Path| Output::from_inputs(Some(path), inputs(), force);
    let output = args.output.as_deref().map(file).transpose()?;
    let json = args.json.output(inputs(), force)?;
    if let (Some(output), Some(json)) = (&output, &json) {
        json.check_distinct(output, "--json and --output")?;
    }
    let started = Instant::now();
    let progress = ProgressLine::steps(args.quiet);
    let caller = Caller {
        step: &|name| progress.step(name),
        stop: &AtomicBool::new(false),
    };
    let found = question.answer(args, &caller)?;
    progress.finish();
    let filled = [
        output.map(|output| output.with(&found.model)),
        json.map(|json| json.with(&found.results)),
    ];
    let filled: Result<Vec<_>, _> = filled.into_iter().flatten().collect();
    let written = filled.and_then(finish_all);
    if !args.quiet {
        // Also after a failed write, so that minutes of work are not lost.
        let seconds = started.elapsed().as_secs_f64();
        let text = summary::text(&found.fit, &question.recordings, seconds);
        print_beside(&text, &[args.output.as_deref(), args.json.place()])?;
    }
    written
}
