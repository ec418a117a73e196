//! `ugv score`: how well models predict recordings.

mod comparison;
mod json;
mod models;
mod table;

use super::answer::{Answer, Caller};
use super::destination::{ForceArgs, JsonArgs};
use super::doubts;
use super::failure::Failure;
use super::jobs;
use super::nominal::NominalArgs;
use super::output::{notify_all, print_beside};
use super::progress::ProgressLine;
use super::recordings;
use crate::identification::{
    HeadingSource, Latencies, Signals, WindowOptions, cut, heading_noise, split,
};
use crate::recording::{Recording, different_names};
use comparison::{ComparisonResult, ModelComparison, pool};
use models::{ComparedModel, GivenModel};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::path::PathBuf;

/// A recorded heading that differs more from the gyro's within a second is worse than the gyro's
/// integral \[rad\].
const POOR_HEADING: f64 = 0.1;

const EXAMPLES: &str = "\
Examples:
  ugv score drive.csv
  ugv score recordings/*.csv --terrain dry_sand --json score.json
  ugv score drive.csv --vehicle mine.json --terrain soil.json --horizon 3
  ugv score drive.csv --model model.json    # of ugv fit

Recordings:  time,omega_left,omega_right,x,y,heading, and yaw_rate if possible; NAME.json beside
             NAME.csv may hold vehicle and terrain.
Models:      kinematics, the recording's vehicle on its nominal soil, and the model of --vehicle,
             --terrain, --model and --effects.
Windows:     each starts at the recorded state. A model predicts the pose at the end from the
             recorded wheel speeds. Constant latencies of pose and wheels are estimated and removed
             first. Of a single run the second half is judged, of several runs every second one. The
             kinematic models are fitted to the rest, and so is the soil of `ugv fit --half`.
             In brackets: 90 % intervals, for four or more pieces of the drive.";

/// Compare how well models predict recordings: kinematics, nominal soil, a given model.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Recordings, or robots' logs; NAME.json beside NAME.csv may hold the vehicle
    #[arg(required = true, value_name = "REC.csv|LOG")]
    recordings: Vec<PathBuf>,

    #[command(flatten)]
    model: NominalArgs,

    /// Length of a prediction
    #[arg(long, value_name = "S", default_value_t = WindowOptions::default().horizon)]
    horizon: f64,

    /// Interval between the starts of windows
    #[arg(long, value_name = "S", default_value_t = WindowOptions::default().spacing)]
    spacing: f64,

    /// Compare the heading with the recorded one or with the integrated yaw rate; auto takes
    /// the yaw rate where the recorded heading is poor
    #[arg(long, value_enum, default_value_t = HeadingChoice::Auto)]
    heading: HeadingChoice,

    #[command(flatten)]
    json: JsonArgs,

    #[command(flatten)]
    replace: ForceArgs,

    /// Threads [default: one per processor]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(jobs::RANGE))]
    jobs: Option<u16>,

    /// Neither table nor progress
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum HeadingChoice {
    Auto,
    Pose,
    Gyro,
}

/// Recordings prepared for all models.
struct Question {
    comparisons: Vec<ModelComparison>,
    threads: ThreadPool,
}

impl Question {
    /// Reads the files. What the user has to know is added to the notes.
    fn of(args: &Args, notes: &mut Vec<String>) -> Result<Self, Failure> {
        args.model.check(&args.recordings)?;
        let given = GivenModel::load(&args.model)?;
        let threads = jobs::pool(args.jobs)?;
        let prepared = |path: &PathBuf| -> Result<(Vec<String>, ModelComparison), Failure> {
            let named = &given.named;
            let vehicle = named.vehicle.as_ref();
            let (recording, notes) = recordings::read(path, vehicle, &named.columns, &named.log)?;
            named.check_vehicle([&recording])?;
            let (recording, found) = doubts::settled(recording, vehicle);
            let mut comparison = prepare(args, &recording, &given)?;
            let within_a_run = comparison.halves.within_a_run;
            let overlap = given.doubt(&recording, &comparison.cut, within_a_run);
            let warnings = notes.into_iter().chain(recording.warnings());
            let warnings = warnings.chain(doubts::lines(&recording.name, &found));
            let warnings = warnings.chain(overlap).collect();
            comparison.doubts = found;
            Ok((warnings, comparison))
        };
        // Collected in the order of the arguments, so that the first error is always the same.
        let all: Vec<_> = threads.install(|| args.recordings.par_iter().map(prepared).collect());
        let mut comparisons = Vec::new();
        for recording in all {
            let (warnings, comparison) = recording?;
            notes.extend(warnings);
            comparisons.push(comparison);
        }
        different_names(comparisons.iter().map(|one| one.name.as_str()))?;
        Ok(Self {
            comparisons,
            threads,
        })
    }

    fn answer(&self, done: impl Fn() + Sync) -> Vec<ComparisonResult<'_>> {
        let run = || self.comparisons.iter().map(|one| one.run(&done));
        self.threads.install(|| run().collect())
    }
}

/// The scores and their table, for a caller that writes no files.
pub fn answer(args: &Args, caller: &Caller) -> Result<Answer, Failure> {
    let mut notes = Vec::new();
    let question = Question::of(args, &mut notes)?;
    (caller.step)("predicting all windows");
    let results = question.answer(|| ());
    let pooled = pool(&results);
    let texts = vec![
        (
            "score.json",
            json::render(args.horizon, args.spacing, &results, pooled.as_deref()),
        ),
        (
            "summary",
            table::render(args.horizon, &results, pooled.as_deref()),
        ),
    ];
    Ok(Answer { texts, notes })
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let files = args.model.files();
    let inputs = || args.recordings.iter().chain(&files);
    let output = args.json.output(inputs(), args.replace.force)?;
    let mut notes = Vec::new();
    let question = Question::of(args, &mut notes);
    notify_all(&notes, args.quiet);
    let question = question?;
    let work = question.comparisons.iter().map(ModelComparison::work).sum();
    let progress = ProgressLine::counting(work, args.quiet);
    let results = question.answer(|| progress.count());
    progress.finish();
    let pooled = pool(&results);
    if !args.quiet {
        let table = table::render(args.horizon, &results, pooled.as_deref());
        print_beside(&table, &[args.json.place()])?;
    }
    if let Some(output) = output {
        let text = json::render(args.horizon, args.spacing, &results, pooled.as_deref());
        output.with(&text)?.finish()?;
    }
    Ok(())
}

fn prepare(
    args: &Args,
    recording: &Recording,
    given: &GivenModel,
) -> Result<ModelComparison, Failure> {
    let mut runs = Signals::of(recording)?;
    let latencies = Latencies::estimate(&runs);
    for run in &mut runs {
        run.remove(&latencies);
    }
    let noise = heading_noise(&runs);
    let heading = match (args.heading, noise) {
        (HeadingChoice::Auto, Some(noise)) if noise > POOR_HEADING => HeadingSource::Gyro,
        (HeadingChoice::Auto | HeadingChoice::Pose, _) => HeadingSource::Pose,
        (HeadingChoice::Gyro, Some(_)) => HeadingSource::Gyro,
        (HeadingChoice::Gyro, None) => {
            let reason = format!("--heading gyro: {} has no yaw_rate", recording.name);
            return Err(Failure::argument(reason).with_remedy("take --heading pose"));
        }
    };
    let how = WindowOptions {
        horizon: args.horizon,
        spacing: args.spacing,
        heading,
        ..WindowOptions::default()
    };
    let set = cut(&recording.name, &runs, &how)?;
    let halves = split(&runs, &set.windows);
    let (nominal, given) = given.models(recording)?;
    let models = ComparedModel::all(&set.windows, &halves.fitted, nominal, given);
    Ok(ModelComparison {
        name: recording.name.clone(),
        doubts: Vec::new(),
        latencies,
        cut: how,
        heading_noise: noise,
        set,
        halves,
        models,
    })
}
