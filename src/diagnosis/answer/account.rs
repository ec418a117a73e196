//! The account of a diagnosis: noise, thresholds, and remarks.

use super::posterior::pairs;
use crate::diagnosis::Options;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::Wheels;
use crate::diagnosis::hypothesis::maps::Maps;
use crate::diagnosis::outcome::Account;
use crate::diagnosis::search::SearchResult;
use crate::effects::Extent;
use crate::fit::noise_model::noise_estimates;
use crate::recording::Recording;
use crate::vehicle::Vehicle;

/// Noise, thresholds and remarks of a diagnosis.
#[must_use]
pub fn account(searched: &SearchResult, options: &Options, left_out: f64) -> Account {
    let problem = &searched.problem;
    let mut used = vec![0.0; problem.recordings.len()];
    for segment in &problem.segments {
        used[segment.recording] += segment.end - segment.start;
    }
    let predictor = problem.predictor(&searched.augmented.coefficients);
    let shooting = problem.shooting(&predictor, &searched.augmented.coefficients);
    let scatters = searched.last.screened.iter().map(|one| one.score.scatter);
    let mut scatters: Vec<f64> = scatters.collect();
    scatters.sort_by(f64::total_cmp);
    Account {
        seed: options.seed,
        segments: problem.segments.len(),
        seconds: problem.seconds(),
        used,
        left_out,
        noise: noise_estimates(&shooting, &searched.augmented.tables, &searched.noise),
        overdispersion: scatters.get(scatters.len() / 2).copied().unwrap_or(1.0),
        threshold: searched.first.threshold.sqrt(),
        refused: pairs(&searched.refused),
        steps: Vec::new(),
        notes: notes(searched),
    }
}

/// Implausible dimensions of the given vehicle: the answer is about that vehicle.
#[must_use]
pub fn doubts(vehicle: &Vehicle) -> Vec<String> {
    let doubts = vehicle.doubts().into_iter();
    doubts
        .map(|doubt| format!("The vehicle's numbers hardly belong together: {doubt}."))
        .collect()
}

/// Warnings of the importer about the recordings.
#[must_use]
pub fn read(recordings: &[Recording]) -> Vec<String> {
    let warnings = recordings.iter().flat_map(Recording::warnings);
    warnings.map(|warning| format!("{warning}.")).collect()
}

fn notes(searched: &SearchResult) -> Vec<String> {
    let mut notes = doubts(&searched.problem.nominal.vehicle);
    if searched.problem.stiffening > 1.0 {
        notes.push(format!(
            "The given terrain does not carry the vehicle through the whole recording; the fit of the soil starts from {} times its frictional modulus.",
            searched.problem.stiffening
        ));
    }
    notes.extend(searched.problem.wheels.as_ref().map(between_samples));
    if searched.problem.maps == Maps::OfRecordings {
        let note = "The recordings start at the same point, so each has a separate map, and effects tied to a place on the map are not searched for. If the drives share one frame, give their poses in it.";
        notes.push(note.into());
    }
    notes.extend(at_bounds(searched));
    let window = |problem: &Problem| problem.nominal.effects.window.clone();
    let found = window(&searched.placed).filter(|_| window(&searched.problem).is_none());
    if let Some(Extent::Time { .. }) = found.map(|window| window.extent) {
        let note = "The augmented model does not include what acts in one drive only or for some seconds of it.";
        notes.push(note.into());
    }
    notes.extend(read(searched.problem.recordings));
    notes
}

/// Soil parameters at their bounds: they may imitate something other than soil.
fn at_bounds(searched: &SearchResult) -> impl Iterator<Item = String> {
    let parameters = searched.problem.soil_parameters();
    let pairs = parameters
        .into_iter()
        .zip(&searched.augmented.solution.soil);
    pairs.filter_map(|(parameter, at)| {
        let (low, high) = parameter.bounds();
        let near = 1e-6 * (high - low);
        (*at <= low + near || *at >= high - near).then(|| {
            format!(
                "{} reached the end of its range, {:.3e} {}: it may imitate something other than soil. On firm ground that may be tyres, which the given model can include (tyre_compliance).",
                parameter.name,
                parameter.value(*at),
                parameter.unit
            )
        })
    })
}

/// The reconstruction of the wheel speeds, in words.
fn between_samples(wheels: &Wheels) -> String {
    let units = if wheels.likelier < 1.0 {
        "a fraction of a unit"
    } else {
        &format!("{:.0} units", wheels.likelier)
    };
    let how = match (wheels.counted, wheels.smoothing > 0.0) {
        (true, false) => "as means over each sampling interval, as encoders count",
        (true, true) => {
            "as means over each sampling interval, as encoders count, and smoothed, because the counts are noisy"
        }
        (false, _) => "smoothed, because their samples are noisy",
    };
    format!(
        "Wheel speeds are taken {how}. This raises the log evidence by {units} over linear interpolation between samples."
    )
}
