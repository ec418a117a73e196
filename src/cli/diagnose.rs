//! `ugv diagnose`: which physics does the model leave out?

use super::answer::{Answer, Caller};
use super::destination::{ForceArgs, JsonArgs};
use super::failure::Failure;
use super::jobs;
use super::nominal::{NominalArgs, fitted_to};
use super::output::{Output, finish_all, is_stream, notify_all, print_beside};
use super::progress::ProgressLine;
use crate::diagnosis::{
    Diagnosis, DiagnosisError, Options, Progress, Step, diagnose, insufficient,
};
use crate::display::visible_line;
use crate::import::is_log;
use crate::json::FittedTo;
use crate::recording::{Recording, Run};
use crate::report::diagnosis::{Input, command, json, page, text};
use crate::vehicle::Specification;
use rayon::ThreadPool;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

const EXAMPLES: &str = "\
Examples:
  ugv diagnose drive.csv --terrain sandy_loam --output diagnosis
  ugv diagnose there.csv back.csv --vehicle mine.json     # the way back separates slope from drag
  ugv simulate --input other.csv --model diagnosis/model.json --output motion.csv

Input:   CSV with a header time,omega_left,omega_right and any of x,y,heading,v_x,v_y,yaw_rate
         [s, m, rad], or logs (MCAP, .db3, .bag, .ulg, the folder of a bag). Several recordings share
         vehicle and soil; each has its slopes, latencies and biases. Best is a minute with turns
         both ways, straights and several speeds.
Output:  DIR/diagnosis.json (format ugv-diagnosis/1), DIR/model.json (the refitted soil with the
         findings, for `ugv simulate`, `score` and `package`), DIR/report.html, and a summary.
         The same seed gives the same answer with any number of threads. At a time limit the
         answer may differ; a caution then says so.";

/// Find the physics that the model leaves out: what, where, and with which probability.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Recordings, or logs, which are imported first; NAME.json beside NAME.csv may hold the vehicle
    #[arg(required = true, value_name = "REC.csv|LOG")]
    recordings: Vec<PathBuf>,

    #[command(flatten)]
    nominal: NominalArgs,

    /// Folder for diagnosis.json, model.json and report.html; created if it does not exist
    #[arg(
        long,
        short,
        alias = "out",
        value_name = "DIR",
        default_value = "diagnosis"
    )]
    output: PathBuf,

    #[command(flatten)]
    json: JsonArgs,

    #[command(flatten)]
    replace: ForceArgs,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Threads [default: one per processor]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(jobs::RANGE))]
    jobs: Option<u16>,

    /// Answer within this time, plus 10 % or 2 s, with what is found by then; cautions name what is
    /// missing. `none`: no limit [default: 600 s plus three times the length of the recordings]
    #[arg(long, value_name = "S|none", value_parser = limit)]
    within: Option<TimeLimit>,

    /// Neither summary nor progress
    #[arg(long, short)]
    quiet: bool,
}

/// The default time limit \[s\], and its growth with the length of the recordings.
const DEFAULT: f64 = 600.0;
const DEFAULT_PER_SECOND: f64 = 3.0;

/// The time that a diagnosis may take.
#[derive(Debug, Clone, Copy)]
enum TimeLimit {
    None,
    Within(Duration),
}

/// What is diagnosed.
struct Question {
    recordings: Vec<Recording>,
    nominal: Specification,
    options: Options,
    limit: TimeLimit,
    pool: ThreadPool,
    /// For the report.
    input: Input,
}

/// The diagnosis and the model with its findings.
struct Found {
    diagnosis: Diagnosis,
    fitted_to: Vec<FittedTo>,
    input: Input,
}

/// The files of a diagnosis.
const FILES: [&str; 3] = ["diagnosis.json", "model.json", "report.html"];

impl Question {
    /// Reads the files. What the user has to know is added to the notes.
    fn of(args: &Args, notes: &mut Vec<String>) -> Result<Self, Failure> {
        args.nominal.check(&args.recordings)?;
        let named = args.nominal.load()?;
        let recordings = named.read(&args.recordings, notes)?;
        let limit = args.within.unwrap_or_else(|| default_limit(&recordings));
        let [vehicle, terrain] = args.nominal.sources(&recordings);
        let lengths = recordings.iter().map(length);
        let files = args
            .recordings
            .iter()
            .map(|path| path.display().to_string());
        let input = Input {
            recordings: files.zip(lengths).collect(),
            vehicle,
            terrain,
            limit: match limit {
                TimeLimit::Within(limit) => Some(limit),
                TimeLimit::None => None,
            },
            is_log: args.recordings.first().is_some_and(|path| is_log(path)),
            runs: recordings.first().map_or(0, |one| one.runs.len()),
            folder: args.output.display().to_string(),
            ..Input::default()
        };
        Ok(Self {
            nominal: named.nominal(&recordings, notes)?,
            limit,
            input,
            recordings,
            options: Options {
                seed: args.seed,
                ..Options::default()
            },
            pool: jobs::pool(args.jobs)?,
        })
    }

    fn answer(&self, arguments: &[String], progress: Progress) -> Result<Found, Failure> {
        let Self {
            recordings,
            nominal,
            options,
            ..
        } = self;
        let progress = match self.limit {
            TimeLimit::Within(limit) => progress.within(limit),
            TimeLimit::None => progress,
        };
        let found = || diagnose(recordings, nominal, options, &progress);
        let mut fitted_to = fitted_to(recordings, true);
        let diagnosis = match self.pool.install(found) {
            Err(
                error @ (DiagnosisError::AtRest { .. }
                | DiagnosisError::TooShort { .. }
                | DiagnosisError::OutOfTime),
            ) => {
                fitted_to.clear();
                let mut diagnosis = insufficient(recordings, nominal, options, &error);
                diagnosis.account.steps = progress.seconds();
                diagnosis
            }
            other => other?,
        };
        Ok(Found {
            diagnosis,
            fitted_to,
            input: Input {
                command: command(std::iter::once("ugv".into()).chain(arguments.iter().cloned())),
                reading: reading(arguments),
                ..self.input.clone()
            },
        })
    }
}

impl Found {
    /// The texts of [`FILES`].
    fn texts(&self) -> [String; 3] {
        let Self {
            diagnosis,
            fitted_to,
            input,
        } = self;
        [
            json(diagnosis),
            diagnosis.model.to_json_fitted(fitted_to),
            page(diagnosis, input),
        ]
    }
}

/// The texts of a diagnosis's files and its summary, for a caller that writes no files.
pub fn answer(args: &Args, caller: &Caller) -> Result<Answer, Failure> {
    let step = |step: Step| (caller.step)(&format!("{step} ({})", step.work));
    let progress = Progress::new(&step).stopped_by(caller.stop);
    let mut notes = Vec::new();
    let mut question = Question::of(args, &mut notes)?;
    question.input.hide_files(&question.recordings);
    let mut found = question.answer(&[], progress)?;
    found.input.command.clear();
    let mut texts: Vec<(&str, String)> = FILES.into_iter().zip(found.texts()).collect();
    texts.push(("summary", text(&found.diagnosis)));
    Ok(Answer { texts, notes })
}

/// Options that say how a recording is read.
const READING: [&str; 9] = [
    "--column", "--topics", "--left", "--right", "--wheels", "--frames", "--preset", "--invert",
    "--pose",
];

/// Those of the arguments, with their values.
fn reading(arguments: &[String]) -> Vec<String> {
    let mut found = Vec::new();
    let mut is_value = false;
    for argument in arguments {
        let name = argument.split('=').next().unwrap_or_default();
        if READING.contains(&name) {
            is_value = name == argument;
            found.push(argument.clone());
        } else if is_value && !argument.starts_with('-') {
            found.push(argument.clone());
            is_value = false;
        } else {
            is_value = false;
        }
    }
    found
}

pub fn run(args: &Args) -> Result<(), Failure> {
    if is_stream(&args.output) {
        return Err(
            Failure::argument("--output -: a diagnosis is a folder of three files")
                .with_remedy("--output DIR; --json writes diagnosis.json to standard output"),
        );
    }
    let line = ProgressLine::steps(args.quiet);
    let show = |step: Step| line.numbered_step(&step.to_string(), step.work);
    let progress = Progress::new(&show);
    let mut notes = Vec::new();
    let question = Question::of(args, &mut notes);
    notify_all(&notes, args.quiet);
    let question = question?;
    let _folder = NewFolder::create(&args.output).map_err(|source| Failure::Write {
        target: args.output.display().to_string(),
        source,
    })?;
    let files = args.nominal.files();
    let inputs = || args.recordings.iter().chain(&files);
    let force = args.replace.force;
    let file = |name| Output::from_inputs(Some(&args.output.join(name)), inputs(), force);
    let outputs: [Result<Output, Failure>; 3] = FILES.map(file);
    let outputs = outputs.into_iter().collect::<Result<Vec<_>, _>>()?;
    let json = args.json.output(inputs(), force)?;
    for (name, output) in FILES.iter().zip(&outputs) {
        if let Some(json) = &json {
            json.check_distinct(output, &format!("--json and {name}"))?;
        }
    }
    let arguments = std::env::args_os().skip(1);
    let arguments = arguments.map(|argument| argument.to_string_lossy().into_owned());
    let found = question.answer(&arguments.collect::<Vec<_>>(), progress);
    line.finish();
    let found = found?;
    let texts = found.texts();
    let json = json.map(|json| json.with(&texts[0]));
    let filled = outputs.into_iter().zip(&texts);
    let filled = filled.map(|(output, text)| output.with(text)).chain(json);
    let written = filled.collect::<Result<Vec<_>, _>>().and_then(finish_all);
    if !args.quiet {
        // Also after a failed write, so that minutes of work are not lost.
        let mut summary = text(&found.diagnosis);
        if written.is_ok() {
            let (folder, files) = (args.output.display().to_string(), FILES.join(", "));
            summary += &format!("written to {}: {files}\n", visible_line(&folder));
        }
        print_beside(&summary, &[args.json.place()])?;
    }
    written
}

fn limit(text: &str) -> Result<TimeLimit, String> {
    if text == "none" {
        return Ok(TimeLimit::None);
    }
    let seconds = text.parse().ok().filter(|seconds| *seconds > 0.0);
    let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    limit
        .map(TimeLimit::Within)
        .ok_or_else(|| "expected a number of seconds above 0, or none".into())
}

/// Long recordings take longer.
fn default_limit(recordings: &[Recording]) -> TimeLimit {
    let seconds = DEFAULT + DEFAULT_PER_SECOND * recordings.iter().map(length).sum::<f64>();
    Duration::try_from_secs_f64(seconds).map_or(TimeLimit::None, TimeLimit::Within)
}

/// Seconds of a recording.
fn length(recording: &Recording) -> f64 {
    recording.runs.iter().map(Run::duration).sum()
}

/// The folders that were created for the files; those without files disappear at the end.
struct NewFolder {
    /// The innermost first.
    created: Vec<PathBuf>,
}

impl NewFolder {
    /// Creates a folder and its parents.
    ///
    /// # Errors
    /// Whatever the file system refuses.
    fn create(path: &Path) -> io::Result<Self> {
        let ancestors = path.ancestors().filter(|path| *path != Path::new(""));
        let missing = ancestors.take_while(|path| !path.exists());
        let created = missing.map(Path::to_owned).collect();
        // If the innermost cannot be created, its new parents disappear again.
        let folder = Self { created };
        fs::create_dir_all(path)?;
        Ok(folder)
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        for folder in &self.created {
            // A folder with files stays.
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_that_say_how_a_recording_is_read_are_known_again() {
        let read = |line: &str| {
            let words: Vec<String> = line.split(' ').map(Into::into).collect();
            reading(&words).join(" ")
        };
        assert_eq!(read("diagnose a.csv --seed 3 --output out"), "");
        assert_eq!(
            read("diagnose a.csv --column omega_left=wl:rpm --seed 3 --column=x=east"),
            "--column omega_left=wl:rpm --column=x=east"
        );
        assert_eq!(
            read("diagnose --topics imu=/i,fix=none a.mcap --invert left --force"),
            "--topics imu=/i,fix=none --invert left"
        );
        // A value is followed by what is none.
        assert_eq!(read("diagnose --left a,b a.mcap"), "--left a,b");
    }
}
