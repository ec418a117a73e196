//! Fitting a model of a vehicle on a soil: what most want of [`fit`](super::fit).

use super::deadline::Deadline;
use super::estimate::{Fit, fit};
use super::exact::ExactPredictor;
use super::options::{Options, Stage};
use super::{FitError, catalogue};
use crate::recording::Recording;
use crate::vehicle::{ModelParameter, Specification};

/// A model and how it was found.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// The given model with the free parameters where they fit best.
    pub model: Specification,
    /// Estimates with intervals, noise, what the data leave open.
    pub fit: Fit,
}

/// Fits some numbers of a model, and each recording's own of its sensors ([`Options::sensors`]), to recordings.
///
/// The soil's priors hold whatever soil is given; others are around the given model's numbers: see
/// [`catalogue::describe`].
///
/// ```no_run
/// use ugv_terrain::fit::{Options, fit_model};
/// use ugv_terrain::recording::read_recording;
/// use ugv_terrain::terrain::Terrain;
/// use ugv_terrain::vehicle::{ModelParameter, Specification, TerrainParameter, Vehicle};
///
/// let recordings = [read_recording("drive.csv".as_ref())?];
/// let loam = Terrain::preset("sandy_loam").expect("one of the paper's terrains");
/// let nominal = Specification::plain(Vehicle::tran2007(), loam);
/// let free = [TerrainParameter::Cohesion, TerrainParameter::FrictionAngle].map(ModelParameter::Terrain);
/// let found = fit_model(&nominal, &free, &recordings, &Options::default(), &|_| ())?;
/// for one in &found.fit.estimates {
///     println!("{} {:.3e} ({:.3e} to {:.3e})", one.parameter.name, one.value, one.low, one.high);
/// }
/// std::fs::write("model.json", found.model.to_json())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`fit`]; a parameter that is named twice; a model whose effects depend on when a drive began, for segments start
/// anywhere.
pub fn fit_model(
    nominal: &Specification,
    free: &[ModelParameter],
    recordings: &[Recording],
    options: &Options,
    progress: &(dyn Fn(Stage) + Sync),
) -> Result<Fitted, FitError> {
    fit_model_until(
        Deadline::NEVER,
        nominal,
        free,
        recordings,
        options,
        progress,
    )
}

/// As [`fit_model`], with an end to the work.
///
/// # Errors
/// As [`fit_model`]. Soon after the deadline the work fails, or gives the best that was found by then.
pub fn fit_model_until(
    deadline: Deadline<'_>,
    nominal: &Specification,
    free: &[ModelParameter],
    recordings: &[Recording],
    options: &Options,
    progress: &(dyn Fn(Stage) + Sync),
) -> Result<Fitted, FitError> {
    if nominal.effects.depend_on_beginning() {
        return Err(FitError::DependsOnBeginning);
    }
    let twice = |(place, parameter): (usize, &ModelParameter)| {
        let again = free[..place].contains(parameter);
        again.then(|| parameter.name())
    };
    if let Some(name) = free.iter().enumerate().find_map(twice) {
        return Err(FitError::Twice { name });
    }
    let predictor = ExactPredictor::new(nominal.clone(), free.to_vec()).with_deadline(deadline);
    let parameters = free.iter().map(|one| catalogue::describe(*one, nominal));
    let values: Vec<f64> = free.iter().map(|one| one.get(nominal)).collect();
    let fitted = fit(
        &predictor,
        parameters.collect(),
        &values,
        recordings,
        options,
        progress,
    )?;
    let values = fitted.estimates[..fitted.model_parameters].iter();
    let values: Vec<f64> = values.map(|estimate| estimate.value).collect();
    let model = predictor
        .with(&values)
        .map_err(|error| FitError::Start(error.into()))?;
    Ok(Fitted { model, fit: fitted })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effects;
    use crate::recording::{Channel, Run, Series};
    use crate::terrain::Terrain;
    use crate::vehicle::{TerrainParameter, Vehicle};

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let soil = Terrain::preset("sandy_loam").unwrap();
        let nominal = Specification::plain(Vehicle::tran2007(), soil);
        let cohesion = ModelParameter::Terrain(TerrainParameter::Cohesion);
        let options = Options::default();
        let fitted = |nominal: &Specification,
                      free: &[ModelParameter],
                      recordings: &[Recording],
                      options: &Options| {
            fit_model(nominal, free, recordings, options, &|_| ()).map(|_| ())
        };
        let name = "cohesion".into();
        let twice = fitted(&nominal, &[cohesion, cohesion], &[], &options);
        assert_eq!(twice, Err(FitError::Twice { name }));
        for segment in [-5.0, f64::INFINITY] {
            let options = Options {
                segment,
                ..options.clone()
            };
            let refused = fitted(&nominal, &[cohesion], &[], &options);
            assert_eq!(refused, Err(FitError::SegmentLength(segment)));
        }
        let window =
            r#"{"drag": {"coefficient": 9}, "window": {"effects": ["drag"], "time": [1, 2]}}"#;
        let bound = Specification {
            effects: Effects::from_json(window).unwrap(),
            ..nominal.clone()
        };
        let refused = fitted(&bound, &[cohesion], &[], &options);
        assert_eq!(refused, Err(FitError::DependsOnBeginning));
        let back: Series = [(1.0, 3.0), (0.0, 3.0)].into_iter().collect();
        let recording = Recording {
            runs: vec![Run::new("").with(Channel::OmegaLeft, back)],
            ..Recording::default()
        };
        let refused = fitted(&nominal, &[cohesion], &[recording], &options);
        assert!(
            matches!(refused, Err(FitError::Recording(_))),
            "{refused:?}"
        );
    }
}
