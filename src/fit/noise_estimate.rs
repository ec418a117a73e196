//! The channels' noise from the data, by restricted maximum likelihood.
//!
//! Residuals of a fit are smaller than the noise: every free start and parameter swallows a
//! part of it, and of slow noise most. So the likelihood is integrated over starts and
//! parameters (of the linearised problem, with their priors), not taken at their best values:
//! minus twice its logarithm is
//! sum ln S_i + cost - g^T H^-1 g + ln det H
//! with the innovations' variances S_i, the gradient g and the matrix H of the normal equations
//! (H. D. Patterson & R. Thompson, "Recovery of inter-block information when block sizes are
//! unequal", Biometrika 58 (1971)).

use super::linearised::Linearised;
use super::noise::ChannelNoise;
use super::normal::{Eliminated, Normal, Reduced};
use super::problem::{NoiseModel, Tables};
use super::robust::penalty;
use super::signal::NoiseGroup;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Prior of the logarithms of white and coloured standard deviation and of the correlation
/// time, which is 1 s in the middle: only to keep what the data leave open from running away.
const SIZE_DEVIATION: f64 = 3.0;
const TIME_DEVIATION: f64 = 1.0;
/// Correlation times beyond these cannot be distinguished from white noise or from an offset \[s\].
const TIME_RANGE: (f64, f64) = (0.03, 10.0);
/// Smallest standard deviation, as a share of the first guess.
const SMALLEST: f64 = 1e-3;
/// Samples that weigh less are outliers: beyond 2.6 standard deviations.
const OUTLIER: f64 = 0.5;
/// First and last step of a search in the logarithms.
const FIRST_STEP: f64 = 0.6;
const LAST_STEP: f64 = 0.06;
/// The first is twice the change in the search before, within this and [`FIRST_STEP`]. With this from the second search on,
/// noise stayed in a local optimum, and a term that is zero in the world was sure.
const NEXT_STEP: f64 = 0.15;
/// The last where log likelihoods are compared: N samples whose noise is off by a share d lose N d^2, and a last step of
/// 0.06 left 9 units between two searches of one fit to 60 s.
const LAST_FINE_STEP: f64 = 0.01;

/// Estimates the noise of every channel of every recording anew, after a search with this change if there was one; returns
/// the largest change of a standard deviation or correlation time, as a logarithm. At the deadline channels keep what they
/// have.
pub fn update(
    problem: &Linearised,
    tables: &[Tables],
    by: &mut NoiseModel,
    before: Option<f64>,
) -> f64 {
    update_until(problem, tables, by, [first_step(before), LAST_STEP])
}

/// As [`update`], precise enough for [`restricted`].
pub fn update_finely(
    problem: &Linearised,
    tables: &[Tables],
    by: &mut NoiseModel,
    before: Option<f64>,
) -> f64 {
    update_until(problem, tables, by, [first_step(before), LAST_FINE_STEP])
}

fn first_step(before: Option<f64>) -> f64 {
    before.map_or(FIRST_STEP, |change| {
        (2.0 * change).clamp(NEXT_STEP, FIRST_STEP)
    })
}

fn update_until(
    problem: &Linearised,
    tables: &[Tables],
    by: &mut NoiseModel,
    steps: [f64; 2],
) -> f64 {
    let mut largest: f64 = 0.0;
    let mut plain = with_outliers_only(by);
    let mut others = Others::new(problem, tables, &plain);
    for recording in 0..problem.places.len() {
        for group in NoiseGroup::ALL {
            let part = Part {
                problem,
                tables,
                others: &others,
                recording,
                group,
            };
            if part.members().next().is_none() || problem.deadline.is_over() {
                continue;
            }
            let old = by.noise[recording][group as usize];
            let new = part.search(&plain, steps);
            by.noise[recording][group as usize] = new;
            plain.noise[recording][group as usize] = new;
            let moved = to_logarithms(&new).into_iter().zip(to_logarithms(&old));
            // What is small beside the other part may wander.
            let shares = [new.white, new.coloured, new.coloured].map(|part| part / new.total());
            for ((new, old), share) in moved.zip(shares) {
                largest = largest.max(share * (new - old).abs());
            }
        }
        others.renew(recording, problem, tables, &plain);
    }
    largest
}

/// Minus twice the restricted log likelihood with Student's t weights (see [`super::robust`]), but for a constant that
/// noise and unknowns do not change. Infinite if numbers are not finite.
#[must_use]
pub fn restricted(
    problem: &Linearised,
    tables: &[Tables],
    prior_cost: f64,
    by: &NoiseModel,
) -> f64 {
    let mut value = prior_cost - problem.precision.iter().map(|p| p.ln()).sum::<f64>();
    let normals = problem.normals(tables, by);
    let Some(reduced) = Reduced::new(&normals, &problem.precision, &problem.pull, 0.0) else {
        return f64::INFINITY;
    };
    for (index, segment) in problem.segments.iter().enumerate() {
        let one = &reduced.each[index];
        value += normals[index].cost - one.start_gain + one.log_determinant();
        for (samples, weights) in segment.samples.iter().zip(&by.weights[index]) {
            let noise = by.noise[segment.recording][samples.signal.group() as usize];
            // The penalty has the weights' own part of the determinant.
            value += noise.whiten(&samples.time, &vec![1.0; weights.len()], 0, &mut []);
            value += weights.iter().map(|weight| penalty(*weight)).sum::<f64>();
        }
    }
    let Reduced {
        matrix, gradient, ..
    } = reduced;
    let Some(factor) = matrix.cholesky() else {
        return f64::INFINITY;
    };
    value - gradient.dot(&factor.solve(&gradient))
        + 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum()
}

/// Residuals of all segments after the likeliest step of starts and unknowns. `None` if numbers are not finite.
#[must_use]
pub fn residuals_after_step(
    problem: &Linearised,
    tables: &[Tables],
    by: &NoiseModel,
) -> Option<Vec<Tables>> {
    let normals = problem.normals(tables, by);
    let reduced = Reduced::new(&normals, &problem.precision, &problem.pull, 0.0)?;
    let step = reduced.matrix.cholesky()?.solve(&reduced.gradient);
    let after = tables
        .iter()
        .zip(normals.iter().zip(&reduced.each))
        .enumerate();
    let after = after.map(|(index, (table, (normal, one)))| {
        let places = &problem.places[problem.segments[index].recording];
        let own = one.start_step(normal, &step);
        let steps: Vec<f64> = own
            .into_iter()
            .chain(places.iter().map(|k| step[*k]))
            .collect();
        let rows = |channel: &Vec<f64>| -> Vec<f64> {
            let rows = channel.chunks_exact(table.columns);
            rows.map(|row| row[0] - row[1..].iter().zip(&steps).map(|(d, s)| d * s).sum::<f64>())
                .collect()
        };
        Tables {
            channels: table.channels.iter().map(rows).collect(),
            columns: 1,
        }
    });
    Some(after.collect())
}

/// Log likelihood of these residuals in each block of so many seconds of each segment, Student's t weights included, but
/// for a constant.
#[must_use]
pub fn blockwise(
    problem: &Linearised,
    residuals: &[Tables],
    by: &NoiseModel,
    seconds: f64,
) -> Vec<f64> {
    let each = problem
        .segments
        .iter()
        .enumerate()
        .flat_map(|(index, segment)| {
            let count = ((segment.end - segment.start) / seconds).ceil().max(1.0) as usize;
            let mut blocks = vec![0.0; count];
            for (channel, samples) in segment.samples.iter().enumerate() {
                let noise = by.noise[segment.recording][samples.signal.group() as usize];
                let weights = &by.weights[index][channel];
                let residuals = &residuals[index].channels[channel];
                let each = noise.log_likelihoods(&samples.time, weights, residuals);
                for ((time, weight), log_likelihood) in samples.time.iter().zip(weights).zip(each) {
                    let block = ((time - segment.start) / seconds).max(0.0) as usize;
                    blocks[block.min(count - 1)] += log_likelihood - 0.5 * penalty(*weight);
                }
            }
            blocks
        });
    each.collect()
}

/// The segments with their starts eliminated, for the recordings whose noise is not searched just then; none where there
/// is but one recording.
struct Others(Vec<Option<Eliminated>>);

impl Others {
    fn new(problem: &Linearised, tables: &[Tables], by: &NoiseModel) -> Self {
        let count = if problem.places.len() > 1 {
            problem.segments.len()
        } else {
            0
        };
        let one = |index: usize| eliminated(problem, tables, by, index);
        Self((0..count).into_par_iter().map(one).collect())
    }

    /// After the noise of a recording has changed.
    fn renew(
        &mut self,
        recording: usize,
        problem: &Linearised,
        tables: &[Tables],
        by: &NoiseModel,
    ) {
        let segments = self.0.par_iter_mut().enumerate();
        segments
            .filter(|(index, _)| problem.segments[*index].recording == recording)
            .for_each(|(index, known)| *known = eliminated(problem, tables, by, index));
    }
}

fn eliminated(
    problem: &Linearised,
    tables: &[Tables],
    by: &NoiseModel,
    index: usize,
) -> Option<Eliminated> {
    Eliminated::new(&problem.normal(index, &tables[index], by), 0.0)
}

/// Outliers keep their small weights, everything else counts alike: weights that follow from one
/// split into white and coloured noise would hold the search at that split.
fn with_outliers_only(by: &NoiseModel) -> NoiseModel {
    let mut plain = by.clone();
    for weight in plain.weights.iter_mut().flatten().flatten() {
        if *weight > OUTLIER {
            *weight = 1.0;
        }
    }
    plain
}

/// Directions of the search: each logarithm, slow noise that keeps its rate s_u^2 / T, and noise
/// that changes from white to coloured.
const DIRECTIONS: [[f64; 3]; 5] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.5, 1.0],
    [1.0, -0.3, 1.0],
];

/// The segments of a recording, and the channels of a group.
struct Part<'a, 'b> {
    problem: &'a Linearised<'b>,
    tables: &'a [Tables],
    others: &'a Others,
    recording: usize,
    group: NoiseGroup,
}

impl Part<'_, '_> {
    /// Segments of the recording that have a channel of the group.
    fn members(&self) -> impl Iterator<Item = usize> + '_ {
        let segments = self.problem.segments.iter().enumerate();
        let ours = segments.filter(|(_, segment)| {
            let mut samples = segment.samples.iter();
            segment.recording == self.recording && samples.any(|s| s.signal.group() == self.group)
        });
        ours.map(|(index, _)| index)
    }

    /// Compass search in the three logarithms.
    fn search(&self, by: &NoiseModel, [first, last]: [f64; 2]) -> ChannelNoise {
        let rest = Rest::new(self, by);
        let guess = self.group.first_guess();
        let mut best = to_logarithms(&by.noise[self.recording][self.group as usize]);
        let objective = |at: &[f64; 3]| {
            let medians = [guess.ln(), guess.ln(), 0.0];
            let deviations = [SIZE_DEVIATION, SIZE_DEVIATION, TIME_DEVIATION];
            let prior: f64 = (0..3)
                .map(|k| ((at[k] - medians[k]) / deviations[k]).powi(2))
                .sum();
            let value = self.objective(&rest, &from_logarithms(at), by) + prior;
            if value.is_finite() {
                value
            } else {
                f64::INFINITY
            }
        };
        let mut lowest = objective(&best);
        let mut step = first;
        // The direction that is tried next, and how many have failed since the last move: none is tried twice in vain.
        let (mut next, mut failed) = (0, 0);
        while step > last {
            let direction = DIRECTIONS[next];
            next = (next + 1) % DIRECTIONS.len();
            failed += 1;
            if self.problem.deadline.is_over() {
                break;
            }
            for sign in [1.0, -1.0] {
                let trial: [f64; 3] = std::array::from_fn(|k| best[k] + sign * step * direction[k]);
                let inside = trial[0].min(trial[1]) > (SMALLEST * guess).ln()
                    && (TIME_RANGE.0.ln()..TIME_RANGE.1.ln()).contains(&trial[2]);
                if !inside {
                    continue;
                }
                let value = objective(&trial);
                if value < lowest {
                    (best, lowest, failed) = (trial, value, 0);
                    break;
                }
            }
            if failed == DIRECTIONS.len() {
                (step, next, failed) = (0.5 * step, 0, 0);
            }
        }
        from_logarithms(&best)
    }

    /// Minus twice the log likelihood with other noise in the group.
    fn objective(&self, rest: &Rest, noise: &ChannelNoise, by: &NoiseModel) -> f64 {
        let one = |(index, normal): &(usize, Normal)| {
            let mut normal = normal.clone();
            let log_determinant = self.add(*index, noise, by, true, &mut normal);
            let eliminated = Eliminated::new(&normal, 0.0)?;
            let value = log_determinant + normal.cost - eliminated.start_gain
                + eliminated.log_determinant();
            Some((value, eliminated))
        };
        let parts: Vec<Option<_>> = rest.normals.par_iter().map(one).collect();
        let mut value = rest.value;
        let (mut matrix, mut gradient) = (rest.matrix.clone(), rest.gradient.clone());
        for part in parts {
            let Some((one, eliminated)) = part else {
                return f64::INFINITY;
            };
            value += one;
            matrix += &eliminated.matrix;
            gradient += &eliminated.gradient;
        }
        match matrix.cholesky() {
            Some(factor) => {
                value - gradient.dot(&factor.solve(&gradient))
                    + 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum()
            }
            None => f64::INFINITY,
        }
    }

    /// Adds the group's channels to a segment's normal equations, or all but those.
    fn add(
        &self,
        index: usize,
        noise: &ChannelNoise,
        by: &NoiseModel,
        ours: bool,
        normal: &mut Normal,
    ) -> f64 {
        let segment = self.problem.segments[index];
        let places = &self.problem.places[segment.recording];
        let mut log_determinant = 0.0;
        for (channel, samples) in segment.samples.iter().enumerate() {
            let group = samples.signal.group();
            if (group == self.group) != ours {
                continue;
            }
            let noise = if ours {
                noise
            } else {
                &by.noise[segment.recording][group as usize]
            };
            let tables = &self.tables[index];
            let mut table = tables.channels[channel].clone();
            let weights = &by.weights[index][channel];
            log_determinant += noise.whiten(&samples.time, weights, tables.columns, &mut table);
            normal.add(&table, places);
        }
        log_determinant
    }
}

/// What does not change with the group's noise.
struct Rest {
    /// Normal equations of the recording's segments without the group's channels.
    normals: Vec<(usize, Normal)>,
    /// Everything of the other segments and of the prior.
    matrix: DMatrix<f64>,
    gradient: nalgebra::DVector<f64>,
    value: f64,
}

impl Rest {
    fn new(part: &Part, by: &NoiseModel) -> Self {
        let problem = part.problem;
        let members: Vec<usize> = part.members().collect();
        let without = |&index: &usize| {
            let mut normal = Normal::zeros(problem.precision.len());
            problem.add_start_prior(index, &mut normal);
            let noise = by.noise[part.recording][part.group as usize];
            part.add(index, &noise, by, false, &mut normal);
            (index, normal)
        };
        let normals: Vec<_> = members.par_iter().map(without).collect();
        let mut rest = Self {
            normals,
            matrix: DMatrix::from_diagonal(&problem.precision),
            gradient: problem.pull.clone(),
            value: 0.0,
        };
        for index in 0..problem.segments.len() {
            if members.binary_search(&index).is_ok() {
                continue;
            }
            let fresh;
            let known = if problem.segments[index].recording == part.recording {
                fresh = eliminated(problem, part.tables, by, index);
                fresh.as_ref()
            } else {
                part.others.0[index].as_ref()
            };
            if let Some(eliminated) = known {
                rest.matrix += &eliminated.matrix;
                rest.gradient += &eliminated.gradient;
            }
        }
        rest
    }
}

fn to_logarithms(noise: &ChannelNoise) -> [f64; 3] {
    [noise.white, noise.coloured, noise.correlation_time].map(f64::ln)
}

fn from_logarithms(logarithms: &[f64; 3]) -> ChannelNoise {
    let [white, coloured, correlation_time] = logarithms.map(f64::exp);
    ChannelNoise {
        white,
        coloured,
        correlation_time,
    }
}
