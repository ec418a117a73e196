//! `ugv diagnose`: what physics did the model leave out?

mod folder;

use super::nominal::{NominalArgs, fitted_to};
use super::output::{Output, finish_all, print};
use super::progress::Progress as Terminal;
use super::{Failure, tell};
use folder::Folder;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;
use ugv_terrain::diagnosis::{Caution, DiagnosisError, Options, Progress, diagnose, insufficient};
use ugv_terrain::display::visible_line;
use ugv_terrain::recording::{Recording, Run};
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
         The same seed gives the same answer, whatever the number of threads, unless a time limit is
         met: then a caution says so.";

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

    /// Answer within so many seconds (and 10 % or 2 s more) with what has been found by then; cautions say what time did
    /// not allow. `none`: no limit [default: 600 s and three times the length of the recordings]
    #[arg(long, value_name = "S|none", value_parser = limit)]
    within: Option<Limit>,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

/// A time limit where none was named \[s\], and how many times the length of the recordings it is besides.
const DEFAULT: f64 = 600.0;
const DEFAULT_PER_SECOND: f64 = 3.0;

/// How long it may take.
#[derive(Debug, Clone, Copy)]
enum Limit {
    None,
    Within(Duration),
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let terminal = Terminal::steps(args.quiet);
    let show = |step| terminal.step(step);
    let mut progress = Progress::new(&show);
    let named = args.nominal.load()?;
    let recordings = named.read(&args.recordings)?;
    progress = match args.within.unwrap_or_else(|| default_limit(&recordings)) {
        Limit::None => progress,
        Limit::Within(limit) => progress.within(limit),
    };
    for recording in &recordings {
        recording.warnings().for_each(|warning| tell(&warning));
    }
    let assumed = named.lacks_vehicle(&recordings);
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
    let found = pool.install(|| diagnose(&recordings, &nominal, &options, &progress));
    terminal.finish();
    let mut to = fitted_to(&recordings, true);
    let mut diagnosis = match found {
        Err(
            error @ (DiagnosisError::AtRest { .. }
            | DiagnosisError::TooShort { .. }
            | DiagnosisError::OutOfTime),
        ) => {
            to.clear();
            let mut diagnosis = insufficient(&recordings, &nominal, &options, &error);
            diagnosis.account.steps = progress.seconds();
            diagnosis
        }
        other => other.map_err(Failure::Diagnosis)?,
    };
    if assumed {
        let caution = Caution::assumed(&nominal.vehicle);
        diagnosis.cautions.push(caution);
    }
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
fn limit(text: &str) -> Result<Limit, String> {
    if text == "none" {
        return Ok(Limit::None);
    }
    let seconds = text.parse().ok().filter(|seconds| *seconds > 0.0);
    let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    limit
        .map(Limit::Within)
        .ok_or_else(|| "not a number of seconds above 0; give 300, say, or none".into())
}

/// Long recordings take longer.
fn default_limit(recordings: &[Recording]) -> Limit {
    let runs = recordings.iter().flat_map(|recording| &recording.runs);
    let seconds = DEFAULT + DEFAULT_PER_SECOND * runs.map(Run::duration).sum::<f64>();
    Duration::try_from_secs_f64(seconds).map_or(Limit::None, Limit::Within)
}

/// Writes all texts or none: the files of a folder belong together.
fn write(outputs: Vec<Output>, texts: [String; 3]) -> Result<(), Failure> {
    let filled = outputs
        .into_iter()
        .zip(texts)
        .map(|(output, text)| output.with(&text));
    finish_all(filled.collect::<Result<Vec<_>, _>>()?)
}
