//! Models, recordings and refitted stages for the tests of the diagnosis.

use super::hypothesis::Problem;
use super::hypothesis::likelihood::{FittedHypothesis, fit_with_noise};
use super::hypothesis::prepare::prepare;
pub use super::manoeuvre::rehearsal::tests::driven;
use super::search::stage::{Stage, screen};
use super::{Options, Progress, Subject};
use crate::effects::{CATALOGUE, Effects};
use crate::fit::problem::NoiseModel;
use crate::recording::{Channel, Recording, Run, Series};
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};

/// The paper's vehicle on one of its terrains.
pub fn on(soil: &str) -> Specification {
    Specification::plain(Vehicle::tran2007(), Terrain::preset(soil).unwrap())
}

/// The same with effects, as the model file has them.
pub fn with_effects(nominal: &Specification, effects: &str) -> Specification {
    Specification {
        effects: Effects::from_json(effects).unwrap(),
        ..nominal.clone()
    }
}

/// An effect of the catalogue.
pub fn named(name: &str) -> Subject {
    Subject::Effect(CATALOGUE.iter().position(|one| one.name == name).unwrap())
}

/// A problem cut into segments, its soil refitted, and the noise.
pub fn fitted<'a>(
    nominal: &Specification,
    recordings: &'a [Recording],
    options: &Options,
) -> (Problem<'a>, FittedHypothesis, NoiseModel) {
    let mut problem = Problem::new(nominal, recordings);
    let (_, mut noise) = prepare(&mut problem, options, &Progress::new(&|_| ())).unwrap();
    let fit = fit_with_noise(&problem, &[], &problem.initial(), &mut noise).unwrap();
    (problem, fit, noise)
}

/// The model with the refitted soil, screened, and its noise.
pub fn refitted<'a>(
    nominal: &Specification,
    recordings: &'a [Recording],
) -> (Stage<'a>, NoiseModel) {
    refitted_with(nominal, recordings, &Options::default())
}

/// The same with other options.
pub fn refitted_with<'a>(
    nominal: &Specification,
    recordings: &'a [Recording],
    options: &Options,
) -> (Stage<'a>, NoiseModel) {
    let (problem, fit, mut noise) = fitted(nominal, recordings, options);
    let stage = screen(problem, fit, &mut noise, options, &Progress::new(&|_| ())).unwrap();
    (stage, noise)
}

/// The first seconds of a recording.
pub fn first(recording: &Recording, seconds: f64) -> Recording {
    let shortened = |run: &Run| {
        let mut short = Run::new("");
        for channel in Channel::ALL {
            if let Some(series) = run.series(channel) {
                let samples = series.samples().take_while(|(time, _)| *time <= seconds);
                let samples: Series = samples.collect();
                short = short.with(channel, samples);
            }
        }
        short
    };
    Recording {
        runs: recording.runs.iter().map(shortened).collect(),
        ..recording.clone()
    }
}
