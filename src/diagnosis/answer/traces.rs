//! Plot data: path, residuals before and after, unmodelled wrench.

use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::likelihood::FittedHypothesis;
use crate::diagnosis::outcome::{ResidualTrace, RunTrace};
use crate::diagnosis::screening::wrench::smooth;
use crate::diagnosis::search::SearchResult;
use crate::fit::problem::NoiseModel;
use crate::fit::signal::Signal;
use crate::recording::Channel;

/// Minimum size of the wrench's prior in plots, as a share of the weight.
const MIN_SIZE: f64 = 3e-3;

/// Traces of all runs with segments.
#[must_use]
pub fn traces(searched: &SearchResult) -> Vec<RunTrace> {
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
            residuals: residuals(searched, recording, run),
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
    for (index, segment) in problem.segments.iter().enumerate() {
        if (segment.recording, segment.run) != (recording, run) {
            continue;
        }
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

fn residuals(searched: &SearchResult, recording: usize, run: usize) -> Vec<ResidualTrace> {
    let problem = &searched.problem;
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
            before: Vec::new(),
            after: Vec::new(),
        };
        for (index, segment) in problem.segments.iter().enumerate() {
            if (segment.recording, segment.run) != (recording, run) {
                continue;
            }
            let Some(channel) = segment.samples.iter().position(|s| s.signal == signal) else {
                continue;
            };
            let column = |fit: &FittedHypothesis| -> Vec<f64> {
                let tables = &fit.tables[index];
                tables.channels[channel]
                    .iter()
                    .step_by(tables.columns)
                    .copied()
                    .collect()
            };
            trace.time.extend(&segment.samples[channel].time);
            trace.before.extend(column(&searched.refitted));
            trace.after.extend(column(&searched.augmented));
        }
        (!trace.time.is_empty()).then_some(trace)
    };
    Signal::ALL.into_iter().filter_map(of).collect()
}
