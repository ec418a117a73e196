//! The fit as a whole: motion, noise and weights in turns until none of them moves.

use super::error::{FitError, LENGTHS, SHORTEST};
use super::identifiability::{Limit, limits};
use super::noise_estimate;
use super::noise_model::{NoiseEstimate, first_noise_model, noise_estimates, reweigh};
use super::optimiser::{Stop, minimise};
use super::options::{Options, Stage};
use super::parameter::FreeParameter;
use super::predictor::Predictor;
use super::problem::{NoiseModel, Point, ShootingProblem, Tables};
use super::segment::{Cut, cut};
use super::sensor::{SensorParameter, SensorValues, free_sensors};
use super::starts::{Starts, beginning, search};
use super::uncertainty::{Uncertainty, uncertainty};
use crate::recording::{Recording, different_names};

/// A fitted parameter; it never travels without its interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// What it is.
    pub parameter: FreeParameter,
    /// Where the fit began.
    pub nominal: f64,
    /// The fitted value.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Standard deviation of the coordinate over the prior's.
    pub posterior_prior_ratio: f64,
}

/// A finished fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// All parameters: the model's, then each recording's sensors'.
    pub estimates: Vec<Estimate>,
    /// Number of the model's.
    pub model_parameters: usize,
    /// Covariance and information, in coordinates.
    pub uncertainty: Uncertainty,
    /// Noise of every channel that has samples.
    pub noise: Vec<NoiseEstimate>,
    /// What the data leave open.
    pub limits: Vec<Limit>,
    /// What other starts led to.
    pub starts: Option<Starts>,
    /// Number of segments.
    pub segments: usize,
    /// Seconds that they cover.
    pub seconds: f64,
    /// Seconds left out because the wheels stand still.
    pub at_rest: f64,
    /// Seconds left out because wheel speeds or samples are missing.
    pub unusable: f64,
    /// Seconds left out because the model cannot drive there from where the sensors see it.
    pub undrivable: f64,
    /// Turns of motion, noise and weights.
    pub turns: usize,
    /// Whether the last turn moved nothing any more.
    pub converged: bool,
}

/// Turns at most.
const TURNS: usize = 12;
/// A turn that stops after lowering the cost, a chi-square, by less than this, and moves
/// no noise by more than this factor's logarithm, is the last.
const STILL: f64 = 0.5;
const STILL_NOISE: f64 = 0.1;
/// Steps of a turn: few, as noise and weights are still to come. A gain of 0.05 moves no
/// parameter by more than a quarter of its standard deviation.
const TURN: Stop = Stop::after(6, 0.05).with_low_damping();
/// The first turn goes all the way: noise estimated half way down would take the misfit for slow
/// noise, and hold the fit there.
const FIRST_TURN: Stop = Stop::after(40, 0.5).with_low_damping();
/// Samples go to other segments when the pose proves later by more than this \[s\].
const LATER: f64 = 0.03;

/// Fits a model's free parameters to recordings.
///
/// `model` are the predictor's parameters, in its order, and `nominal` their initial values. For a vehicle on a soil
/// [`fit_model`](super::fit_model) puts these together.
///
/// # Errors
/// Recordings without information, a model that cannot drive from its initial values, a length of segments out of range, another
/// number of parameters or values than the predictor has.
pub fn fit<P: Predictor>(
    predictor: &P,
    model: Vec<FreeParameter>,
    nominal: &[f64],
    recordings: &[Recording],
    options: &Options,
    progress: &(dyn Fn(Stage) + Sync),
) -> Result<Fit, FitError> {
    if !LENGTHS.contains(&options.segment) {
        return Err(FitError::SegmentLength(options.segment));
    }
    let parameters = predictor.parameters();
    if let Some(values) = [model.len(), nominal.len()]
        .into_iter()
        .find(|n| *n != parameters)
    {
        return Err(FitError::Values { parameters, values });
    }
    different_names(recordings.iter().map(|one| one.name.as_str())).map_err(FitError::SameName)?;
    for recording in recordings {
        recording.check().map_err(FitError::Recording)?;
    }
    let sensors = recordings
        .iter()
        .map(|recording| free_sensors(recording, &options.sensors))
        .collect::<Result<_, _>>()?;
    let names = recordings.iter().map(|r| r.name.clone()).collect();
    let mut problem = ShootingProblem::new(predictor, model, names, sensors);
    let begin = beginning(&problem, nominal, recordings);
    let left_out = take_segments(&mut problem, recordings, &begin, options)?;
    let mut state = State {
        point: Point {
            starts: problem.measured_starts(),
            coordinates: begin.clone(),
        },
        by: first_noise_model(&problem),
        left_out,
    };
    let mut turned = turns(&mut problem, recordings, options, &mut state, progress)?;
    let mut doubt = doubts(&problem, &turned, &state, options.robust)?;
    let mut starts = None;
    if options.starts > 0 {
        let found = search(&problem, &state.point, &state.by, &doubt, options, progress);
        if let Some(better) = &found.better {
            let cut_for = latencies(&problem, &state);
            state.point = better.clone();
            if is_later(&latencies(&problem, &state), &cut_for) {
                recut(&mut problem, recordings, options, &mut state)?;
            }
            turned = turns(&mut problem, recordings, options, &mut state, progress)?;
            doubt = doubts(&problem, &turned, &state, options.robust)?;
        }
        starts = Some(found);
    }
    let point = &state.point;
    let estimate = |(k, parameter): (usize, &FreeParameter)| {
        let (low, high) = parameter.interval(point.coordinates[k], doubt.half_width(k));
        Estimate {
            parameter: parameter.clone(),
            nominal: parameter.value(begin[k]),
            value: parameter.value(point.coordinates[k]),
            low,
            high,
            posterior_prior_ratio: doubt.deviation(k) / parameter.prior.deviation,
        }
    };
    let coordinates = point.coordinates.as_slice();
    Ok(Fit {
        estimates: problem
            .parameters
            .iter()
            .enumerate()
            .map(estimate)
            .collect(),
        model_parameters: problem.model_parameters,
        limits: limits(
            &problem.parameters,
            problem.model_parameters,
            coordinates,
            &doubt,
        ),
        noise: noise_estimates(&problem, &turned.tables, &state.by),
        uncertainty: doubt,
        starts,
        segments: problem.segments.len(),
        seconds: seconds(&problem),
        at_rest: state.left_out.at_rest,
        unusable: state.left_out.unusable,
        undrivable: state.left_out.undrivable,
        turns: turned.turns,
        converged: turned.converged,
    })
}

/// Where the fit stands.
struct State {
    point: Point,
    by: NoiseModel,
    left_out: LeftOut,
}

/// Seconds that are not fitted, of the last cut.
struct LeftOut {
    at_rest: f64,
    unusable: f64,
    undrivable: f64,
}

/// What the turns ended with.
struct Turned {
    tables: Vec<Tables>,
    turns: usize,
    converged: bool,
}

/// Motion, noise and weights in turns.
fn turns<P: Predictor>(
    problem: &mut ShootingProblem<P>,
    recordings: &[Recording],
    options: &Options,
    state: &mut State,
    progress: &(dyn Fn(Stage) + Sync),
) -> Result<Turned, FitError> {
    let mut cut_for = latencies(problem, state);
    leave_out_undrivable(problem, state)?;
    for turn in 1.. {
        progress(Stage::Turn(turn));
        let State { point, by, .. } = state;
        let stop = if turn == 1 { FIRST_TURN } else { TURN };
        let outcome = minimise(problem, point, by, stop).map_err(FitError::Start)?;
        let change = noise_estimate::update(&problem.linearised(point), &outcome.tables, by, None);
        if options.robust {
            reweigh(problem, &outcome.tables, by);
        }
        let still = outcome.converged && outcome.gain < STILL && change < STILL_NOISE;
        if still || turn == TURNS {
            return Ok(Turned {
                tables: outcome.tables,
                turns: turn,
                converged: still,
            });
        }
        let now = latencies(problem, state);
        if is_later(&now, &cut_for) {
            cut_for = now;
            recut(problem, recordings, options, state)?;
            leave_out_undrivable(problem, state)?;
        }
    }
    Err(FitError::NotFinite)
}

fn seconds<P: Predictor>(problem: &ShootingProblem<P>) -> f64 {
    problem.segments.iter().map(|s| s.end - s.start).sum()
}

/// Leaves out segments that the model cannot drive from where the sensors see the vehicle: a
/// start read off a late pose may slide in a way that no soil bears. They come back with the
/// next cut.
fn leave_out_undrivable<P: Predictor>(
    problem: &mut ShootingProblem<P>,
    state: &mut State,
) -> Result<(), FitError> {
    let driven = problem.evaluate_each(&state.point, true);
    let kept: Vec<bool> = driven.iter().map(Result::is_ok).collect();
    if let Some(Err(error)) = driven.into_iter().find(Result::is_err)
        && 2 * kept.iter().filter(|kept| **kept).count() < kept.len()
    {
        return Err(FitError::Start(error));
    }
    let planned = seconds(problem);
    let mut each = kept.iter();
    problem.segments.retain(|_| *each.next().unwrap_or(&true));
    let mut each = kept.iter();
    state.point.starts.retain(|_| *each.next().unwrap_or(&true));
    let mut each = kept.iter();
    state.by.weights.retain(|_| *each.next().unwrap_or(&true));
    state.left_out.undrivable += planned - seconds(problem);
    Ok(())
}

fn latencies<P: Predictor>(problem: &ShootingProblem<P>, state: &State) -> Vec<f64> {
    let late = |recording| {
        let values = problem.sensor_values(recording, &state.point.coordinates);
        values[SensorParameter::PoseLatency.index()]
    };
    (0..problem.recordings.len()).map(late).collect()
}

/// Whether poses proved later, or less late, than segments were cut for.
fn is_later(now: &[f64], cut_for: &[f64]) -> bool {
    let mut pairs = now.iter().zip(cut_for);
    pairs.any(|(a, b)| (a - b).abs() > LATER)
}

/// Cuts anew; segments that are still there keep their starts.
fn recut<P: Predictor>(
    problem: &mut ShootingProblem<P>,
    recordings: &[Recording],
    options: &Options,
    state: &mut State,
) -> Result<(), FitError> {
    let old: Vec<_> = problem
        .segments
        .iter()
        .map(|s| (s.recording, s.run, s.start))
        .collect();
    state.left_out = take_segments(problem, recordings, &state.point.coordinates, options)?;
    let start = |segment: &super::segment::Segment| {
        let key = (segment.recording, segment.run, segment.start);
        let kept = old.iter().position(|other| *other == key);
        kept.map_or(segment.start_prior, |index| state.point.starts[index])
    };
    state.point.starts = problem.segments.iter().map(start).collect();
    let noise = std::mem::take(&mut state.by.noise);
    state.by = NoiseModel {
        noise,
        ..first_noise_model(problem)
    };
    Ok(())
}

fn take_segments<P: Predictor>(
    problem: &mut ShootingProblem<P>,
    recordings: &[Recording],
    coordinates: &nalgebra::DVector<f64>,
    options: &Options,
) -> Result<LeftOut, FitError> {
    let each = 0..recordings.len();
    let sensors: Vec<SensorValues> = each
        .map(|recording| problem.sensor_values(recording, coordinates))
        .collect();
    let Cut {
        segments,
        at_rest,
        unusable,
    } = cut(recordings, &sensors, options.segment);
    problem.segments = segments;
    let seconds = seconds(problem);
    if seconds >= SHORTEST {
        Ok(LeftOut {
            at_rest,
            unusable,
            undrivable: 0.0,
        })
    } else if at_rest > unusable + seconds {
        Err(FitError::AtRest)
    } else {
        let seconds = seconds + unusable;
        Err(FitError::TooShort { seconds })
    }
}

fn doubts<P: Predictor>(
    problem: &ShootingProblem<P>,
    turned: &Turned,
    state: &State,
    robust: bool,
) -> Result<Uncertainty, FitError> {
    let State { point, by, .. } = state;
    uncertainty(problem, &turned.tables, point, by, robust).ok_or(FitError::NotFinite)
}
