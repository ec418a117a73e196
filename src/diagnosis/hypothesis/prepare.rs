//! Cuts recordings into segments that the given model can follow.

use super::Problem;
use super::held_out::SMALLEST_FOLD;
use super::thin::thin;
use crate::diagnosis::{DiagnosisError, Options, Progress};
use crate::fit::noise_model::first_noise_model;
use crate::fit::predictor::PredictionError;
use crate::fit::problem::{NoiseModel, Tables};
use crate::fit::segment::cut;
use crate::fit::sensor::SensorValues;
use crate::inspection::SHORTEST;
use crate::recording::{Channel, Recording};

/// Minimum number of segments: two to hold out, two to fit.
const FEWEST: usize = 2 * SMALLEST_FOLD;
/// Long segments contain more information, but few of them give neither overdispersion nor a held-out score: this
/// number is made if each is as long as this \[s\].
const FEW: usize = 3 * SMALLEST_FOLD;
const LONG_ENOUGH: f64 = 5.0;
/// Factor by which a soil that cannot carry the vehicle is stiffened, and the maximum in all.
const STIFFER: f64 = 4.0;
const STIFFEST: f64 = 1024.0;

/// What was used.
#[derive(Debug)]
pub struct Prepared {
    /// Seconds not used: at rest, without data, or with a motion that the model cannot follow.
    pub left_out: f64,
    /// Seconds within the time limit, and in total; `None` if all are used.
    pub part: Option<[f64; 2]>,
}

/// Cuts, subsamples within the time limit, drops what the model cannot follow, and returns the first noise model.
///
/// # Errors
/// Too little driving, a stop by the caller, or a time limit.
pub fn prepare(
    problem: &mut Problem,
    options: &Options,
    progress: &Progress,
) -> Result<(Prepared, NoiseModel), DiagnosisError> {
    // Samples belong to the segment of their true time. One with too early a time stamp would lie before the start of
    // its segment; too late a stamp does no harm.
    let late = problem
        .late
        .iter()
        .map(|late| late.map(|value| value.max(0.0)));
    let late: Vec<SensorValues> = late.collect();
    let mut found = cut(problem.recordings, &late, options.segment);
    problem.segments = std::mem::take(&mut found.segments);
    let mut driven: f64 = problem.seconds();
    let lengths = [
        // Shorter segments contain slightly less information; fewer allow no held-out score.
        (FEW, LONG_ENOUGH),
        (FEWEST, SHORTEST / FEWEST as f64),
    ];
    for (count, min_length) in lengths {
        let length = (driven / count as f64).max(min_length);
        if driven >= SHORTEST && problem.segments.len() < count && length < options.segment {
            found = cut(problem.recordings, &late, length);
            problem.segments = std::mem::take(&mut found.segments);
            driven = problem.seconds();
        }
    }
    if driven == 0.0 && found.at_rest > found.unusable {
        return Err(DiagnosisError::AtRest {
            moved: reach(problem.recordings),
        });
    }
    let part = thin(problem, progress)?;
    driven = problem.seconds();
    let tried = stiffened(problem, 0.5 * driven);
    progress.in_time(problem.deadline)?;
    let mut failed = None;
    let mut kept = Vec::new();
    for (segment, tried) in std::mem::take(&mut problem.segments).into_iter().zip(tried) {
        match tried {
            Ok(_) => kept.push(segment),
            Err(error) => {
                found.unusable += segment.end - segment.start;
                failed.get_or_insert(error);
            }
        }
    }
    problem.segments = kept;
    let seconds = problem.seconds();
    match failed {
        Some(error) if seconds < 0.5 * driven => Err(DiagnosisError::Undrivable(error)),
        _ if seconds < SHORTEST => Err(DiagnosisError::TooShort {
            seconds,
            needed: SHORTEST,
        }),
        _ => {
            let predictor = problem.predictor(&[]);
            let noise_model = first_noise_model(&problem.shooting(&predictor, &[]));
            let prepared = Prepared {
                left_out: found.at_rest + found.unusable,
                part,
            };
            Ok((prepared, noise_model))
        }
    }
}

/// Predicts all segments, on a stiffer soil if the given one does not carry the vehicle through them: it is a rough
/// initial guess, and the vehicle did not sink into it. The soil is stiffened while more segments succeed, and until
/// no more than `max_failed` seconds fail.
fn stiffened(problem: &mut Problem, max_failed: f64) -> Vec<Result<Tables, PredictionError>> {
    let mut best = (drive(problem), problem.stiffening);
    let mut remaining = failed(problem, &best.0);
    while remaining > 0.0 && problem.stiffening < STIFFEST {
        problem.stiffening *= STIFFER;
        let tried = drive(problem);
        let now = failed(problem, &tried);
        if now < remaining {
            (best, remaining) = ((tried, problem.stiffening), now);
        } else if remaining <= max_failed {
            break;
        }
    }
    problem.stiffening = best.1;
    best.0
}

/// Predicts all segments from their measured starts.
fn drive(problem: &Problem) -> Vec<Result<Tables, PredictionError>> {
    let predictor = problem.predictor(&[]);
    let shooting = problem.shooting(&predictor, &[]);
    let point = problem.point(&shooting, &[], &problem.initial());
    shooting.evaluate_each(&point, true)
}

/// Seconds of the segments without a prediction.
fn failed(problem: &Problem, tried: &[Result<Tables, PredictionError>]) -> f64 {
    let pairs = problem.segments.iter().zip(tried);
    let failed = pairs.filter(|(_, tried)| tried.is_err());
    failed.map(|(s, _)| s.end - s.start).sum()
}

/// Extent of the positions of a run, east or north \[m\].
fn reach(recordings: &[Recording]) -> f64 {
    let runs = recordings.iter().flat_map(|recording| &recording.runs);
    let series = runs.flat_map(|run| [Channel::X, Channel::Y].map(|channel| run.series(channel)));
    let reach = series.flatten().map(|series| {
        let values = || series.value.iter().copied();
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    });
    reach.fold(0.0, f64::max)
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::diagnosis::testing::{driven, first, on};
    use crate::fit::segment::Segment;
    use crate::fit::sensor::SensorParameter;

    #[test]
    fn a_short_drive_is_cut_so_that_some_can_be_held_out() {
        let model = on("sandy_loam");
        let whole = driven(&model, "spiral");
        let stretches = |seconds| {
            let recordings = [first(&whole, seconds)];
            let mut problem = Problem::new(&model, &recordings);
            let progress = Progress::new(&|_| {});
            prepare(&mut problem, &Options::default(), &progress)?;
            Ok(problem.segments)
        };
        // Two segments of 7.5 s would leave none to fit.
        let short = stretches(14.0).unwrap();
        assert_eq!(short.len(), FEWEST);
        assert!(short.iter().all(|one| one.end - one.start < 4.0));
        let longer = stretches(25.0).unwrap();
        let length = |one: &Segment| one.end - one.start;
        assert!(longer.iter().all(|one| (4.5..6.0).contains(&length(one))));
        assert!(matches!(
            stretches(8.0),
            Err(DiagnosisError::TooShort { .. })
        ));
    }

    #[test]
    fn a_soil_that_carries_the_vehicle_through_a_part_only_is_stiffened() {
        let sand = on("dry_sand");
        let recordings = [driven(&sand, "pivots")];
        let mut soft = sand.clone();
        soft.terrain.frictional_modulus /= 7.0;
        let mut problem = Problem::new(&soft, &recordings);
        let as_known = [[0.0; SensorParameter::ALL.len()]];
        let found = cut(&recordings, &as_known, Options::default().segment);
        let left_out = found.at_rest + found.unusable;
        problem.segments = found.segments;
        let (lost, all) = (failed(&problem, &drive(&problem)), problem.seconds());
        assert!(lost > 0.0 && lost < 0.5 * all, "{lost} s of {all} s");
        let progress = Progress::new(&|_| {});
        let (prepared, _) = prepare(&mut problem, &Options::default(), &progress).unwrap();
        assert!((problem.seconds() - all).abs() < 1e-9);
        assert_eq!(prepared.left_out, left_out);
        assert_eq!(problem.stiffening, STIFFER);
    }
}
