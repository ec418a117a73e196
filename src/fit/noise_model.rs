//! Noise and weights: their initial values, how weights follow the residuals, and what is reported.

use super::noise::ChannelNoise;
use super::predictor::Predictor;
use super::problem::{NoiseModel, ShootingProblem, Tables};
use super::robust;
use super::segment::Segment;
use super::signal::NoiseGroup;

/// The noise of a recording's channels, and what is left of them.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseEstimate {
    /// Which recording.
    pub recording: usize,
    /// Which channels.
    pub group: NoiseGroup,
    /// White and coloured part.
    pub noise: ChannelNoise,
    /// Number of samples.
    pub samples: usize,
    /// Root mean square of the residuals, in the channel's unit.
    pub rms: f64,
    /// Share of samples that count less than a third: outliers.
    pub outliers: f64,
}

impl NoiseModel {
    /// That of some segments.
    #[must_use]
    pub fn of(&self, segments: &[usize]) -> Self {
        Self {
            noise: self.noise.clone(),
            weights: segments.iter().map(|k| self.weights[*k].clone()).collect(),
        }
    }
}

/// Noise as of a fair sensor and model, and every sample counting alike.
pub fn first_noise_model<P: Predictor>(problem: &ShootingProblem<P>) -> NoiseModel {
    let noise = NoiseGroup::ALL.map(|group| ChannelNoise {
        white: group.first_guess(),
        coloured: group.first_guess(),
        correlation_time: 1.0,
    });
    let ones = |segment: &Segment| {
        let samples = segment.samples.iter();
        samples
            .map(|samples| vec![1.0; samples.time.len()])
            .collect()
    };
    NoiseModel {
        noise: vec![noise; problem.recordings.len()],
        weights: problem.segments.iter().map(ones).collect(),
    }
}

/// Sets every sample's weight to what its residual asks for.
pub fn reweigh<P: Predictor>(problem: &ShootingProblem<P>, tables: &[Tables], by: &mut NoiseModel) {
    let parts = problem.segments.iter().zip(tables).zip(&mut by.weights);
    for ((segment, tables), weights) in parts {
        reweigh_segment(segment, tables, &by.noise[segment.recording], weights);
    }
}

/// The same for one segment.
pub fn reweigh_segment(
    segment: &Segment,
    tables: &Tables,
    noise: &[ChannelNoise; NoiseGroup::ALL.len()],
    weights: &mut [Vec<f64>],
) {
    let channels = segment.samples.iter().zip(&tables.channels).zip(weights);
    for ((samples, table), weights) in channels {
        let noise = &noise[samples.signal.group() as usize];
        let residual: Vec<f64> = table.iter().step_by(tables.columns).copied().collect();
        robust::update(noise, &samples.time, &residual, weights);
    }
}

/// The report on every recording's channels.
pub fn noise_estimates<P: Predictor>(
    problem: &ShootingProblem<P>,
    tables: &[Tables],
    by: &NoiseModel,
) -> Vec<NoiseEstimate> {
    let mut all = Vec::new();
    for recording in 0..problem.recordings.len() {
        for group in NoiseGroup::ALL {
            let (mut samples, mut squares, mut outliers) = (0, 0.0, 0);
            for (index, segment) in problem.segments.iter().enumerate() {
                for (channel, data) in segment.samples.iter().enumerate() {
                    if segment.recording != recording || data.signal.group() != group {
                        continue;
                    }
                    let table = &tables[index].channels[channel];
                    let residuals = table.iter().step_by(tables[index].columns);
                    squares += residuals.map(|r| r * r).sum::<f64>();
                    samples += data.time.len();
                    let weights = by.weights[index][channel].iter();
                    outliers += weights.filter(|weight| **weight < 1.0 / 3.0).count();
                }
            }
            if samples > 0 {
                all.push(NoiseEstimate {
                    recording,
                    group,
                    noise: by.noise[recording][group as usize],
                    samples,
                    rms: (squares / samples as f64).sqrt(),
                    outliers: outliers as f64 / samples as f64,
                });
            }
        }
    }
    all
}
