//! `ugv score`: how well models predict recordings.

mod comparison;
mod entries;
mod json;
mod table;

use super::model::{
    check_piecewise, load_effects, load_fitted, load_terrain, load_vehicle, without_sensors,
};
use super::output::{Output, print};
use super::progress::Progress;
use super::{Failure, tell};
use comparison::{Comparison, ModelScore, pool};
use entries::Entry;
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use ugv_terrain::effects::Effects;
use ugv_terrain::identification::{
    HeadingSource, Latencies, Signals, WindowOptions, cut, heading_noise, split,
};
use ugv_terrain::json::FittedTo;
use ugv_terrain::recording::{Recording, different_names, read_recording_of};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle, VehicleModel};

/// Recorded headings that stray further from the gyro's within a second are worth less than
/// its integral \[rad\].
const POOR_HEADING: f64 = 0.1;

const EXAMPLES: &str = "\
Examples:
  ugv score drive.csv
  ugv score recordings/*.csv --terrain dry_sand --json score.json
  ugv score drive.csv --vehicle mine.json --terrain soil.json --horizon 3
  ugv score drive.csv --model model.json    # as ugv fit leaves it

Recordings:  time,omega_left,omega_right,x,y,heading and, better, yaw_rate; NAME.json beside NAME.csv
             may tell vehicle and terrain.
Windows:     each starts at the recorded state; a model gets the recorded wheel speeds and predicts the
             pose at the end. Constant latencies of pose and wheels are estimated and removed first.
             Of a single run the second half is judged, of several runs every second one; the
             kinematic models are fitted on the rest, and so is a soil by `ugv fit --half`.
             In brackets: 90 % intervals, from four pieces of the drive on.";

/// Compare how well models predict recordings: kinematics, nominal soil, a soil of your own.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Recordings (CSV)
    #[arg(required = true, value_name = "REC.csv")]
    recordings: Vec<PathBuf>,

    /// Vehicle of the model to judge beside the nominal one [default: the recording's]
    #[arg(long, value_name = "FILE.json")]
    vehicle: Option<PathBuf>,

    /// Terrain of the model to judge beside the nominal one, a preset or a file
    /// [default: the recording's]
    #[arg(long, value_name = "NAME|FILE.json")]
    terrain: Option<PathBuf>,

    /// Model to judge beside the nominal one, as `ugv fit` and `ugv model` print it
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["vehicle", "terrain"])]
    model: Option<PathBuf>,

    /// Effects of the model to judge, as `ugv effects NAME` prints it [default: the model's]
    #[arg(long, value_name = "FILE.json")]
    effects: Option<PathBuf>,

    /// Predict so many seconds ahead
    #[arg(long, value_name = "S", default_value_t = WindowOptions::default().horizon)]
    horizon: f64,

    /// Start a window every so many seconds
    #[arg(long, value_name = "S", default_value_t = WindowOptions::default().spacing)]
    spacing: f64,

    /// Compare the heading with the recorded one or with the integrated yaw rate; auto takes
    /// the yaw rate where the recorded heading is poor
    #[arg(long, value_enum, default_value_t = Heading::Auto)]
    heading: Heading,

    /// Write everything to a file (format ugv-score/1); - writes it to standard output
    /// instead of the table
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,

    /// Threads [default: one per processor]; the result does not depend on it
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,

    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Heading {
    Auto,
    Pose,
    Gyro,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let files = [&args.vehicle, &args.terrain, &args.model, &args.effects];
    // The name of a preset is no path.
    let files = || files.into_iter().flatten().filter(|path| path.exists());
    let json = args
        .json
        .as_deref()
        .map(|path| Output::of(Some(path), args.recordings.iter().chain(files())))
        .transpose()?;
    let given = ComparedModels::load(args)?;
    let threads = super::jobs::pool(args.jobs)?;
    let prepared = |path: &PathBuf| -> Result<(Vec<String>, Comparison), Failure> {
        let recording = read_recording_of(path, given.vehicle.as_ref())?;
        let comparison = prepare(args, &recording, &given)?;
        let warnings = recording
            .warnings()
            .chain(given.doubt(&recording, &comparison));
        Ok((warnings.collect(), comparison))
    };
    // Collected in the order of the arguments, so the first error is always the same.
    let prepared: Vec<_> = threads.install(|| args.recordings.par_iter().map(prepared).collect());
    let mut contests = Vec::new();
    for recording in prepared {
        let (notes, comparison) = recording?;
        notes.iter().for_each(|note| tell(note));
        contests.push(comparison);
    }
    different_names(contests.iter().map(|one| one.name.as_str())).map_err(Failure::SameName)?;
    let progress = Progress::counting(contests.iter().map(Comparison::work).sum(), args.quiet);
    let run = || contests.iter().map(|c| c.run(|| progress.count()));
    let outcomes: Vec<ModelScore> = threads.install(|| run().collect());
    progress.finish();
    let pooled = pool(&outcomes);
    if args
        .json
        .as_deref()
        .is_none_or(|path| path.as_os_str() != "-")
    {
        print(&table::render(args.horizon, &outcomes, pooled.as_ref()))?;
    }
    if let Some(output) = json {
        let text = json::render(args.horizon, args.spacing, &outcomes, pooled.as_ref());
        output.with(&text)?.finish()?;
    }
    Ok(())
}

fn prepare(
    args: &Args,
    recording: &Recording,
    given: &ComparedModels,
) -> Result<Comparison, Failure> {
    let mut runs = Signals::of(recording)?;
    let latencies = Latencies::estimate(&runs);
    for run in &mut runs {
        run.remove(&latencies);
    }
    let noise = heading_noise(&runs);
    let heading = match (args.heading, noise) {
        (Heading::Auto, Some(noise)) if noise > POOR_HEADING => HeadingSource::Gyro,
        (Heading::Auto | Heading::Pose, _) => HeadingSource::Pose,
        (Heading::Gyro, Some(_)) => HeadingSource::Gyro,
        (Heading::Gyro, None) => {
            return Err(Failure::Argument {
                reason: format!("--heading gyro: {} has no yaw_rate", recording.name),
                hint: Some("take --heading pose".into()),
            });
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
    let entries = Entry::all(&set.windows, &halves.fitted, nominal, given);
    Ok(Comparison {
        name: recording.name.clone(),
        latencies,
        how,
        heading_noise: noise,
        set,
        halves,
        entries,
    })
}

/// A model with a few words on it.
type Described = (String, Arc<VehicleModel>);

/// What the arguments say of the model to judge.
struct ComparedModels {
    vehicle: Option<Vehicle>,
    terrain: Option<Terrain>,
    effects: Option<Effects>,
    words: String,
    fitted_to: Vec<FittedTo>,
}

impl ComparedModels {
    fn load(args: &Args) -> Result<Self, Failure> {
        let named = [
            ("vehicle", &args.vehicle),
            ("terrain", &args.terrain),
            ("model", &args.model),
            ("effects", &args.effects),
        ];
        let words = named
            .iter()
            .filter_map(|(key, path)| Some(format!("{key} {}", path.as_ref()?.display())));
        let mut given = Self {
            vehicle: args.vehicle.as_deref().map(load_vehicle).transpose()?,
            terrain: args.terrain.as_deref().map(load_terrain).transpose()?,
            effects: args.effects.as_deref().map(load_effects).transpose()?,
            words: words.collect::<Vec<_>>().join(", "),
            fitted_to: Vec::new(),
        };
        if let Some(path) = &args.model {
            let (model, fitted_to) = load_fitted(path)?;
            given.fitted_to = fitted_to;
            given.vehicle = Some(model.vehicle);
            given.terrain = Some(model.terrain);
            given.effects.get_or_insert(model.effects);
        }
        if let Some(effects) = &mut given.effects {
            check_piecewise(effects)?;
            without_sensors(effects)?;
        }
        Ok(given)
    }

    /// Whether the model has learned from the windows by which it is judged.
    fn is_fitted_to_all_of(&self, recording: &Recording) -> bool {
        let mut to = self.fitted_to.iter();
        to.any(|to| to.whole && to.recording == recording.name)
    }

    /// What is doubtful about judging the model by a recording's windows.
    fn doubt(&self, recording: &Recording, comparison: &Comparison) -> Option<String> {
        let name = &recording.name;
        if self.is_fitted_to_all_of(recording) {
            return Some(format!(
                "warning: the given model was fitted to all of {name}, also to the windows that judge it here; \
                 judge it by another recording, or one by `ugv fit --half`"
            ));
        }
        let is_half = self.fitted_to.iter().any(|to| to.recording == *name);
        // Whole runs are judged or not, however they are cut.
        let is_cut_anew =
            comparison.halves.within_a_run && comparison.how != WindowOptions::default();
        (is_half && is_cut_anew).then(|| {
            format!(
                "warning: the given model was fitted to a half of {name} that windows of {} s every {} s and the \
                 recorded heading part; cut otherwise, as here, the other half may hold some of what it has seen",
                WindowOptions::default().horizon,
                WindowOptions::default().spacing
            )
        })
    }

    /// The nominal model of a recording, and the one that the arguments ask for.
    fn models(&self, recording: &Recording) -> Result<(Described, Option<Described>), Failure> {
        const TERRAIN: &str = "clayed_soil";
        let about = &recording.about;
        let (mut words, vehicle) = match (&about.vehicle, &self.vehicle) {
            (Some(told), _) => ("the recording's vehicle, ".to_string(), told.clone()),
            (None, Some(given)) => (
                "the given vehicle (none is told beside the recording), ".into(),
                given.clone(),
            ),
            (None, None) => (
                "the paper's vehicle (none is told beside the recording), ".into(),
                Vehicle::tran2007(),
            ),
        };
        let terrain = match (&about.terrain, &about.terrain_name) {
            (Some(terrain), name) => {
                words += name.as_deref().unwrap_or("the recording's terrain");
                *terrain
            }
            (None, _) => {
                words += TERRAIN;
                words += " by default (no terrain is told beside the recording)";
                Terrain::preset(TERRAIN).expect("a preset")
            }
        };
        let model = |specification: &Specification| {
            let model = VehicleModel::from_specification(specification);
            model.map(Arc::new).map_err(Failure::Model)
        };
        let told = Specification::plain(vehicle, terrain);
        let nominal = (words, model(&told)?);
        if self.vehicle.is_none() && self.terrain.is_none() && self.effects.is_none() {
            return Ok((nominal, None));
        }
        let given = Specification {
            vehicle: self.vehicle.clone().unwrap_or(told.vehicle),
            terrain: self.terrain.unwrap_or(told.terrain),
            effects: self.effects.clone().unwrap_or_default(),
        };
        let mut words = self.words.clone();
        if self.is_fitted_to_all_of(recording) {
            words += ", fitted to these windows too";
        }
        Ok((nominal, Some((words, model(&given)?))))
    }
}
