//! `ugv diagnose`: what physics did the model leave out?

mod folder;
mod progress;

use super::nominal::{NominalArgs, fitted_to};
use super::output::{Output, finish_all, print};
use super::{Failure, tell};
use folder::Folder;
use progress::Bar;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;
use ugv_terrain::diagnosis::{DiagnosisError, Options, Progress, diagnose, insufficient};
use ugv_terrain::display::visible_line;
use ugv_terrain::report::diagnosis::{json, page, text};

const EXAMPLES: &str = "\
Examples:
  ugv diagnose drive.csv --terrain sandy_loam --out diagnosis
  ugv diagnose there.csv back.csv --vehicle mine.json     # the way back separates slope from drag
  ugv simulate --input other.csv --model diagnosis/model.json --output motion.csv

Input:   recordings with a header time,omega_left,omega_right and any of x,y,heading,v_x,v_y,
         yaw_rate [s, m, rad]. Several recordings share vehicle and soil; slopes, latencies and biases are
         each recording's own. A minute with turns both ways, straights and several speeds tells
         most.
Output:  DIR/diagnosis.json (format ugv-diagnosis/1), DIR/model.json (the soil re-tuned, with what was
         found; `ugv simulate`, `score` and `package` take it), DIR/report.html, and a summary.
         The same seed gives the same answer, whatever the number of threads (but for --within).";

/// Tell what physics the model left out, where, and how sure that is.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Recordings; what NAME.json beside NAME.csv tells of the vehicle is used
    #[arg(required = true, value_name = "REC.csv")]
    recordings: Vec<PathBuf>,

    #[command(flatten)]
    nominal: NominalArgs,

    /// Folder for diagnosis.json, model.json and report.html; made if it is not there
    #[arg(
        long,
        visible_alias = "output",
        value_name = "DIR",
        default_value = "diagnosis"
    )]
    out: PathBuf,

    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Threads [default: one per processor]; the result does not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// Answer within about so many seconds with what has been found by then; what was not tried is told [default: no
    /// limit]
    #[arg(long, value_name = "S", value_parser = seconds)]
    within: Option<Duration>,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let named = args.nominal.load()?;
    let recordings = named.read(&args.recordings)?;
    for recording in &recordings {
        recording.warnings().for_each(|warning| tell(&warning));
    }
    let nominal = named.nominal(&recordings, args.quiet)?;
    let options = Options {
        seed: args.seed,
        ..Options::default()
    };
    let pool = super::jobs::pool(args.jobs)?;
    let _folder = Folder::make(&args.out).map_err(|source| Failure::Write {
        target: args.out.display().to_string(),
        source,
    })?;
    let files = ["diagnosis.json", "model.json", "report.html"];
    let read = args.nominal.files();
    let read = || args.recordings.iter().chain(&read);
    let outputs = files.map(|name| Output::of(Some(&args.out.join(name)), read()));
    let outputs = outputs.into_iter().collect::<Result<Vec<_>, _>>()?;
    let bar = Bar::new(args.quiet);
    let show = |step| bar.show(step);
    let mut progress = Progress::new(&show);
    if let Some(limit) = args.within {
        progress = progress.within(limit);
    }
    let found = pool.install(|| diagnose(&recordings, &nominal, &options, &progress));
    bar.finish();
    let mut to = fitted_to(&recordings, true);
    let diagnosis = match found {
        Err(error @ (DiagnosisError::AtRest { .. } | DiagnosisError::TooShort { .. })) => {
            to.clear();
            insufficient(&recordings, &nominal, &options, &error)
        }
        other => other.map_err(Failure::Diagnosis)?,
    };
    let texts = [
        json(&diagnosis),
        diagnosis.model.to_json_fitted(&to),
        page(&diagnosis),
    ];
    let written = write(outputs, texts);
    if !args.quiet {
        // Where the disk is full, too: what took minutes to find is not lost.
        print(&text(&diagnosis))?;
        if written.is_ok() {
            let (folder, files) = (args.out.display().to_string(), files.join(", "));
            print(&format!("written to {}: {files}\n", visible_line(&folder)))?;
        }
    }
    written
}

/// A time limit.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds| *seconds > 0.0);
    let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    limit.ok_or_else(|| "not a number of seconds above 0; give 300, say".into())
}

/// Writes all texts or none: the files of a folder belong together.
fn write(outputs: Vec<Output>, texts: [String; 3]) -> Result<(), Failure> {
    let filled = outputs
        .into_iter()
        .zip(texts)
        .map(|(output, text)| output.with(&text));
    finish_all(filled.collect::<Result<Vec<_>, _>>()?)
}
