//! `ugv fit`: soil parameters from recordings.

mod names;
mod report;
mod summary;

use super::nominal::{NominalArgs, fitted_to};
use super::output::{Output, finish_all, print};
use super::progress::Progress;
use super::{Failure, tell};
use names::{Wanted, print_names};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;
use ugv_terrain::fit::{Fit, Fitted, Options, Stage, fit_model};
use ugv_terrain::identification::{WindowOptions, fitted_part};
use ugv_terrain::recording::Recording;

const EXAMPLES: &str = "\
Examples:
  ugv fit drive.csv --output model.json --report fit.json
  ugv fit drive.csv --half --output half.json    # then: ugv score drive.csv --model half.json
  ugv fit monday.csv tuesday.csv --vehicle mine.json --terrain sandy_loam --report fit.json
  ugv fit drive.csv --free cohesion,friction_angle,wheel_radius --sensors pose_latency
  ugv fit --free help          # all parameters, with their priors

Input:   recordings with a header time,omega_left,omega_right and any of x,y,heading,v_x,v_y,
         yaw_rate [s, m, rad]; an empty cell is a missing sample. Several recordings share soil and
         vehicle; latencies and biases are each recording's own.
Output:  the fitted model, which `ugv simulate --model FILE` reads. The report holds
         the intervals and everything else, in SI units and radians.";

/// Fit soil parameters to recordings, with their intervals.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Recordings; what NAME.json beside NAME.csv tells of the vehicle is used
    #[arg(value_name = "REC.csv")]
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

    /// What is not fitted stays as it is there
    #[command(flatten)]
    nominal: NominalArgs,

    /// Leave out the half of each recording by which `ugv score` judges
    #[arg(long)]
    half: bool,

    /// Length of a segment, each with a start of its own
    #[arg(long, value_name = "S", default_value_t = 5.0, value_parser = seconds)]
    segment: f64,

    /// Random starts that look for another answer; 0 for none
    #[arg(long, value_name = "N", default_value_t = 20)]
    starts: usize,

    /// Seed of the random starts
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Every sample counts alike, outliers too
    #[arg(long)]
    not_robust: bool,

    /// Threads [default: one per processor]; the result does not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// JSON file for the fitted model; - writes to standard output
    #[arg(long, value_name = "FILE.json")]
    output: Option<PathBuf>,

    /// JSON file for everything: intervals, correlations, noise, other answers
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (3.0..=8.0).contains(&seconds) => Ok(seconds),
        _ => Err("expected 3 to 8 seconds: shorter ones tell little, longer ones drift".into()),
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if args.free == ["help"] || args.sensors == ["help"] {
        // No recording can tell a vehicle here.
        return print_names(&args.nominal.load()?.nominal(&[], true)?);
    }
    if args.recordings.is_empty() {
        return Err(Failure::Argument {
            reason: "no recording to fit to".into(),
            hint: Some("ugv fit drive.csv --output model.json".into()),
        });
    }
    let named = args.nominal.load()?;
    let mut recordings = named.read(&args.recordings)?;
    for recording in &recordings {
        recording.warnings().for_each(|warning| tell(&warning));
    }
    if args.half {
        for recording in &mut recordings {
            *recording = fitted_part(recording, &WindowOptions::default())?;
        }
    }
    let nominal = named.nominal(&recordings, args.quiet)?;
    let wanted = Wanted::parse(&args.free, &args.sensors)?;
    let options = Options {
        sensors: wanted.sensors,
        segment: args.segment,
        starts: args.starts,
        seed: args.seed,
        robust: !args.not_robust,
    };
    let files = args.nominal.files();
    let own = |path: &Path| Output::of(Some(path), args.recordings.iter().chain(&files));
    let output = args.output.as_deref().map(own).transpose()?;
    let report = args.report.as_deref().map(own).transpose()?;
    if let (Some(output), Some(report)) = (&output, &report)
        && report.collides_with(output)
    {
        return Err(Failure::Argument {
            reason: "--report and --output lead to the same place".into(),
            hint: None,
        });
    }
    let started = Instant::now();
    let progress = Progress::steps(args.quiet);
    let pool = super::jobs::pool(args.jobs)?;
    let show = |stage| {
        progress.step(match stage {
            Stage::Turn(turn) => format!("fitting motion and noise, turn {turn}"),
            Stage::Start(start) => format!("random start {} of {}", start + 1, args.starts),
        });
    };
    let found = pool.install(|| fit_model(&nominal, &wanted.model, &recordings, &options, &show));
    let Fitted { model, fit: fitted } = found.map_err(Failure::Fit)?;
    progress.finish();
    let mut files = [&args.output, &args.report].into_iter().flatten();
    let to_stdout = files.any(|path| path.as_os_str() == "-");
    let model_text = || model.to_json_fitted(&fitted_to(&recordings, !args.half));
    let report_text = || report::to_json(&fitted, &model, &recordings, &options);
    let filled = [
        output.map(|output| output.with(&model_text())),
        report.map(|report| report.with(&report_text())),
    ];
    let filled: Result<Vec<_>, _> = filled.into_iter().flatten().collect();
    let written = filled.and_then(finish_all);
    if !args.quiet {
        // Where the disk is full, too: what took minutes to find is not lost.
        let text = summary::text(&fitted, &recordings, started.elapsed().as_secs_f64());
        if to_stdout {
            text.lines().for_each(super::tell);
        } else {
            print(&text)?;
        }
    }
    written
}

/// The name of a parameter; that of a recording's sensor without the recording, where there is but one.
fn short_name<'a>(name: &'a str, fitted: &Fit, recordings: &[Recording]) -> &'a str {
    let is_sensor = fitted.estimates[fitted.model_parameters..]
        .iter()
        .any(|estimate| estimate.parameter.name == name);
    match name.rsplit_once('.') {
        Some((_, short)) if is_sensor && recordings.len() == 1 => short,
        _ => name,
    }
}
