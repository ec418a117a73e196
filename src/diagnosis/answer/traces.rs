//! Plot data: paths, errors of the models, unmodelled wrench.

use super::errors::Comparison;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::FittedHypothesis;
use crate::diagnosis::outcome::{PredictedPath, ResidualTrace, RunTrace};
use crate::diagnosis::screening::wrench::smooth;
use crate::diagnosis::search::SearchResult;
use crate::fit::problem::NoiseModel;
use crate::fit::segment::Segment;
use crate::fit::signal::Signal;
use crate::recording::Channel;

/// Minimum size of the wrench's prior in plots, as a share of the weight.
const MIN_SIZE: f64 = 3e-3;

/// Traces of all runs with segments.
#[must_use]
pub fn traces(searched: &SearchResult, compared: Option<&Comparison>) -> Vec<RunTrace> {
    let problem = &searched.problem;
    let one = |(recording, run): (usize, usize)| {
        let (time, mismatch) =
            mismatch(problem, &searched.refitted, &searched.noise, recording, run);
        let data = &problem.recordings[recording].runs[run];
        let at = |channel, time| data.series(channel).and_then(|series| series.at(time));
        let place = |time: &f64| Some([at(Channel::X, *time)?, at(Channel::Y, *time)?]);
        let path: Vec<Option<[f64; 2]>> = time.iter().map(place).collect();
        let seen = |keep: &Vec<f64>| -> Vec<f64> {
            let pairs = keep.iter().zip(&path);
            pairs
                .filter(|(_, place)| place.is_some())
                .map(|(value, _)| *value)
                .collect()
        };
        let size = searched
            .first
            .latent_wrench
            .map_or([MIN_SIZE; 3], |w| w.size);
        let size = size.map(|s| s.max(MIN_SIZE));
        RunTrace {
            recording: problem.names[recording].clone(),
            run,
            label: problem.label_of(recording, run),
            time: seen(&time),
            mismatch: seen(&mismatch),
            path: path.iter().flatten().copied().collect(),
            predicted: compared.map_or_else(Vec::new, |compared| {
                predicted(problem, compared, recording, run)
            }),
            residuals: residuals(searched, compared, recording, run),
            wrench: smooth(problem, &searched.first.system, recording, run, size),
        }
    };
    problem.runs().into_iter().map(one).collect()
}

/// Root mean square of the whitened residuals, bin by bin.
fn mismatch(
    problem: &Problem,
    fit: &FittedHypothesis,
    noise: &NoiseModel,
    recording: usize,
    run: usize,
) -> (Vec<f64>, Vec<f64>) {
    let mut whitened: Vec<(f64, f64)> = Vec::new();
    for (index, segment) in segments(problem, recording, run) {
        for (channel, data) in segment.samples.iter().enumerate() {
            let channel_noise = noise.noise[recording][data.signal.group() as usize];
            let table = &fit.tables[index].channels[channel];
            let residual = table.iter().step_by(fit.tables[index].columns);
            let mut residual: Vec<f64> = residual.copied().collect();
            channel_noise.whiten(&data.time, &noise.weights[index][channel], 1, &mut residual);
            whitened.extend(data.time.iter().copied().zip(residual));
        }
    }
    whitened.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut time, mut size) = (Vec::new(), Vec::new());
    let mut rest = whitened.as_slice();
    while let Some((start, _)) = rest.first() {
        let end = rest.partition_point(|(at, _)| *at < start + BIN);
        let (now, later) = rest.split_at(end.max(1));
        let squares: f64 = now.iter().map(|(_, r)| r * r).sum();
        time.push(start + 0.5 * BIN);
        size.push((squares / now.len() as f64).sqrt());
        rest = later;
    }
    (time, size)
}

/// Length of a bin of one colour \[s\].
const BIN: f64 = 0.5;

/// Errors on held-out data; without a comparison the residuals of the fits.
fn residuals(
    searched: &SearchResult,
    compared: Option<&Comparison>,
    recording: usize,
    run: usize,
) -> Vec<ResidualTrace> {
    let of = |signal: Signal| {
        let (name, unit) = match signal {
            Signal::X => ("x", "m"),
            Signal::Y => ("y", "m"),
            Signal::Heading => ("heading", "rad"),
            Signal::VelocityForward => ("v_x", "m/s"),
            Signal::VelocityLeft => ("v_y", "m/s"),
            Signal::YawRate => ("yaw_rate", "rad/s"),
        };
        let mut trace = ResidualTrace {
            channel: name,
            unit,
            time: Vec::new(),
            errors: Default::default(),
        };
        for (index, segment) in segments(&searched.problem, recording, run) {
            let Some(channel) = segment.samples.iter().position(|s| s.signal == signal) else {
                continue;
            };
            let time = &segment.samples[channel].time;
            trace.time.extend(time);
            for (model, errors) in trace.errors.iter_mut().enumerate() {
                match (
                    compared,
                    [None, Some(&searched.refitted), Some(&searched.augmented)][model],
                ) {
                    (Some(compared), _) => match &compared.residuals[model][index] {
                        Some(residuals) => errors.extend(&residuals[channel]),
                        None => errors.extend(time.iter().map(|_| f64::NAN)),
                    },
                    (None, Some(fit)) => {
                        let table = &fit.tables[index];
                        let residuals = table.channels[channel].iter();
                        errors.extend(residuals.step_by(table.columns));
                    }
                    (None, None) => errors.extend(time.iter().map(|_| f64::NAN)),
                }
            }
        }
        (!trace.time.is_empty()).then_some(trace)
    };
    Signal::ALL.into_iter().filter_map(of).collect()
}

/// The segments of a run with their indices.
fn segments<'p>(
    problem: &'p Problem,
    recording: usize,
    run: usize,
) -> impl Iterator<Item = (usize, &'p Segment)> {
    let numbered = problem.segments.iter().enumerate();
    numbered.filter(move |(_, segment)| (segment.recording, segment.run) == (recording, run))
}

/// Held-out paths of the segments whose coordinates were measured at the same times.
fn predicted(
    problem: &Problem,
    compared: &Comparison,
    recording: usize,
    run: usize,
) -> Vec<PredictedPath> {
    let path = |(index, segment): (usize, &Segment)| {
        let at = |signal| segment.samples.iter().position(|s| s.signal == signal);
        let (east, north) = (at(Signal::X)?, at(Signal::Y)?);
        let (x, y) = (&segment.samples[east], &segment.samples[north]);
        if x.time != y.time {
            return None;
        }
        let measured: Vec<[f64; 2]> = x
            .value
            .iter()
            .zip(&y.value)
            .map(|(x, y)| [*x, *y])
            .collect();
        let predicted = [0, 1, 2].map(|model| {
            let Some(residuals) = &compared.residuals[model][index] else {
                return Vec::new();
            };
            let errors = residuals[east].iter().zip(&residuals[north]);
            let pairs = measured.iter().zip(errors);
            pairs.map(|([x, y], (dx, dy))| [x - dx, y - dy]).collect()
        });
        Some(PredictedPath {
            time: x.time.clone(),
            measured,
            predicted,
        })
    };
    segments(problem, recording, run).filter_map(path).collect()
}
