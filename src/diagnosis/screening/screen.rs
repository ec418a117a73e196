//! Score test of every candidate on the linearised problem.
//!
//! With the normal equations (H, g) of soil N and a candidate C, the soil is projected out: H~ = H_CC - H_CN (H_NN +
//! P_N)^-1 H_NC, g~ = g_C - H_CN (H_NN + P_N)^-1 (g_N + pull_N). The score statistic is Q = g~^T (H~ + P_C)^-1 g~,
//! the one-step estimate (H~ + P_C)^-1 g~, the absorbed share 1 - H~/H. The log Bayes factor against the refitted
//! model is Q / (2 phi) - ln det(1 + P_C^-1 H~ / phi) / 2.
//!
//! The overdispersion phi >= 1 is the scatter of the segments' scores around the estimate, in units of what the noise
//! explains, with the covariance of adjacent segments (W. K. Newey & K. D. West, Econometrica 55 (1987)). So a single
//! badly fitting segment cannot carry a verdict.

use super::system::System;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// The soil and what else is always free, projected out.
#[derive(Debug)]
pub struct Projection<'a> {
    system: &'a System,
    nuisance: Vec<usize>,
    factor: Cholesky<f64, Dyn>,
    pull: DVector<f64>,
    /// Places of the segments that count, among the system's.
    segments: Vec<usize>,
}

/// A candidate's equations with the nuisance projected out.
#[derive(Debug, Clone)]
pub struct Projected {
    /// Its unknowns.
    pub unknowns: Vec<usize>,
    /// H~.
    pub matrix: DMatrix<f64>,
    /// g~.
    pub gradient: DVector<f64>,
    /// H, before projection.
    pub raw: DMatrix<f64>,
}

/// A candidate's one-step fit.
#[derive(Debug, Clone)]
pub struct Score {
    /// The estimate, a step in its coordinates; zero where only values beyond the range would help.
    pub step: DVector<f64>,
    /// Its standard deviations, with phi.
    pub deviation: DVector<f64>,
    /// Q / phi.
    pub chi_square: f64,
    /// Scatter of the blocks, phi.
    pub scatter: f64,
    /// Log Bayes factor against the model without it.
    pub evidence: f64,
    /// Share of its signal that the nuisance absorbs.
    pub absorbed: f64,
}

/// The prior of the overdispersion, 1, counts as much as this number of segments.
const EXPECTED_BLOCKS: f64 = 8.0;
/// Keeps the correlation matrix of similar candidates positive definite.
const RIDGE: f64 = 1e-6;
/// Smaller tail probabilities are not converted.
const SMALLEST_TAIL: f64 = 1e-280;

impl<'a> Projection<'a> {
    /// Projects some unknowns out of some segments. `None` where numbers are not finite.
    #[must_use]
    pub fn new(system: &'a System, nuisance: &[usize], segments: &[usize]) -> Option<Self> {
        let chosen = segments.iter().map(|k| &system.segments[*k]);
        let (mut matrix, mut pull) = system.sum(nuisance, chosen);
        for (k, unknown) in nuisance.iter().enumerate() {
            matrix[(k, k)] += system.precision[*unknown];
            pull[k] += system.pull[*unknown];
        }
        Some(Self {
            system,
            nuisance: nuisance.to_vec(),
            factor: matrix.cholesky()?,
            pull,
            segments: segments.to_vec(),
        })
    }

    /// Over all segments, the soil and these further unknowns projected out.
    #[must_use]
    pub fn over_all(system: &'a System, further: &[usize]) -> Option<Self> {
        let nuisance: Vec<usize> = system.soil().chain(further.iter().copied()).collect();
        let all: Vec<usize> = (0..system.segments.len()).collect();
        Self::new(system, &nuisance, &all)
    }

    /// What is projected out.
    #[must_use]
    pub fn nuisance(&self) -> &[usize] {
        &self.nuisance
    }

    /// The nuisance's inverse matrix, and its step to where the pulls vanish.
    #[must_use]
    pub fn inverse(&self) -> (DMatrix<f64>, DVector<f64>) {
        (self.factor.inverse(), self.factor.solve(&self.pull))
    }

    /// The normal equations' block of the nuisance (rows) and other unknowns (columns).
    #[must_use]
    pub fn cross(&self, unknowns: &[usize]) -> DMatrix<f64> {
        let together: Vec<usize> = self.nuisance.iter().chain(unknowns).copied().collect();
        let chosen = self.segments.iter().map(|k| &self.system.segments[*k]);
        let (matrix, _) = self.system.sum(&together, chosen);
        let (n, c) = (self.nuisance.len(), unknowns.len());
        matrix.view((0, n), (n, c)).into_owned()
    }

    /// How the nuisance follows a step of other unknowns.
    #[must_use]
    pub fn following(&self, unknowns: &[usize], step: &DVector<f64>) -> DVector<f64> {
        -self.factor.solve(&(self.cross(unknowns) * step))
    }

    /// A candidate's projected equations with its prior.
    #[must_use]
    pub fn with_prior(&self, candidate: &Projected) -> DMatrix<f64> {
        let precision = self.precisions(&candidate.unknowns);
        &candidate.matrix + DMatrix::from_diagonal(&DVector::from_vec(precision))
    }

    /// A candidate's projected equations.
    #[must_use]
    pub fn of(&self, unknowns: &[usize]) -> Projected {
        let together: Vec<usize> = self.nuisance.iter().chain(unknowns).copied().collect();
        let chosen = self.segments.iter().map(|k| &self.system.segments[*k]);
        let (matrix, gradient) = self.system.sum(&together, chosen);
        let (n, c) = (self.nuisance.len(), unknowns.len());
        let cross = matrix.view((0, n), (n, c)).into_owned();
        let raw = matrix.view((n, n), (c, c)).into_owned();
        let projected = &raw - cross.tr_mul(&self.factor.solve(&cross));
        let own = gradient.rows(n, c).into_owned();
        Projected {
            unknowns: unknowns.to_vec(),
            matrix: projected,
            gradient: own - cross.tr_mul(&self.factor.solve(&self.pull)),
            raw,
        }
    }

    /// A candidate's one-step fit, with the scatter of its own blocks.
    #[must_use]
    pub fn score(&self, candidate: &Projected) -> Score {
        let (step, quadratic) = self.step(candidate);
        let scatter = self.scatter(candidate, &step);
        self.judge(candidate, step, quadratic, scatter)
    }

    /// A candidate's one-step fit where the scatter is known.
    #[must_use]
    pub fn score_with(&self, candidate: &Projected, scatter: f64) -> Score {
        let (step, quadratic) = self.step(candidate);
        self.judge(candidate, step, quadratic, scatter)
    }

    /// The step within the range and the cost that it saves.
    fn step(&self, candidate: &Projected) -> (DVector<f64>, f64) {
        let precision = self.precisions(&candidate.unknowns);
        let unknowns = candidate.unknowns.iter();
        let pull: Vec<f64> = unknowns.map(|u| self.system.pull[*u]).collect();
        let free = self.inside(candidate, &precision, &pull);
        solve(candidate, &precision, &pull, &free)
    }

    /// Precisions of unknowns' priors.
    #[must_use]
    pub fn precisions(&self, unknowns: &[usize]) -> Vec<f64> {
        let each = unknowns.iter();
        each.map(|unknown| self.system.precision[*unknown])
            .collect()
    }

    fn judge(
        &self,
        candidate: &Projected,
        step: DVector<f64>,
        quadratic: f64,
        scatter: f64,
    ) -> Score {
        let precision = self.precisions(&candidate.unknowns);
        let count = step.len();
        let scaled = DMatrix::from_fn(count, count, |i, j| {
            let moves = step[i] != 0.0 && step[j] != 0.0;
            let shared = if moves {
                candidate.matrix[(i, j)] / (scatter * (precision[i] * precision[j]).sqrt())
            } else {
                0.0
            };
            shared + f64::from(u8::from(i == j))
        });
        let log_determinant = scaled.determinant().max(1.0).ln();
        let precision = DMatrix::from_diagonal(&DVector::from_vec(precision));
        let posterior = &candidate.matrix / scatter + precision;
        let covariance = posterior.cholesky().map(|factor| factor.inverse());
        let deviation = covariance.map_or_else(
            || DVector::repeat(count, f64::INFINITY),
            |covariance| covariance.diagonal().map(f64::sqrt),
        );
        let signal = (step.transpose() * &candidate.matrix * &step)[0];
        let whole = (step.transpose() * &candidate.raw * &step)[0];
        Score {
            deviation,
            chi_square: quadratic / scatter,
            scatter,
            evidence: 0.5 * (quadratic / scatter - log_determinant),
            absorbed: absorbed_share(signal, whole).unwrap_or_else(|| candidate.absorbed(0)),
            step,
        }
    }

    /// The unknowns that a step may move: those that it would carry beyond the bound at "off" stay.
    fn inside(&self, candidate: &Projected, precision: &[f64], pull: &[f64]) -> Vec<usize> {
        let mut free: Vec<usize> = (0..precision.len()).collect();
        loop {
            let (step, _) = solve(candidate, precision, pull, &free);
            let outward = |k: &usize| {
                let parameter = &self.system.parameters[candidate.unknowns[*k]];
                let (low, high) = parameter.bounds();
                let off = parameter.prior_coordinate();
                let near = 1e-9 * (high - low);
                (off <= low + near && step[*k] < 0.0) || (off >= high - near && step[*k] > 0.0)
            };
            let Some(held) = free.iter().position(outward) else {
                return free;
            };
            free.remove(held);
        }
    }

    /// Overdispersion of the segments' scores along a step.
    fn scatter(&self, candidate: &Projected, step: &DVector<f64>) -> f64 {
        let norm = (step.transpose() * &candidate.matrix * step)[0];
        if norm <= 0.0 {
            return 1.0;
        }
        let together: Vec<usize> = self
            .nuisance
            .iter()
            .chain(&candidate.unknowns)
            .copied()
            .collect();
        let n = self.nuisance.len();
        // The candidate's direction with the nuisance following it, and the whole step.
        let chosen = self.segments.iter().map(|k| &self.system.segments[*k]);
        let (matrix, _) = self.system.sum(&together, chosen);
        let cross = matrix.view((0, n), (n, step.len())).into_owned();
        let following = -self.factor.solve(&(&cross * step));
        let settled = self.factor.solve(&self.pull);
        let mut direction = DVector::zeros(together.len());
        direction.rows_mut(0, n).copy_from(&following);
        direction.rows_mut(n, step.len()).copy_from(step);
        let mut taken = direction.clone();
        let mut nuisance = taken.rows_mut(0, n);
        nuisance += settled;
        let pulls: Vec<f64> = self
            .segments
            .iter()
            .map(|k| {
                let one = std::iter::once(&self.system.segments[*k]);
                let (matrix, gradient) = self.system.sum(&together, one);
                direction.dot(&(gradient - matrix * &taken))
            })
            .collect();
        let mut sum: f64 = pulls.iter().map(|pull| pull * pull).sum();
        let neighbours = self.segments.windows(2).zip(pulls.windows(2));
        for (pair, pulls) in neighbours {
            let [a, b] = [pair[0], pair[1]].map(|k| &self.system.segments[k]);
            if a.recording == b.recording && a.joins(b) {
                sum += pulls[0] * pulls[1];
            }
        }
        let blocks = self.segments.len() as f64;
        let found = sum.max(0.0) / norm * blocks / (blocks - 1.0).max(1.0);
        let shrunk = (blocks * found + EXPECTED_BLOCKS) / (blocks + EXPECTED_BLOCKS);
        shrunk.max(1.0)
    }
}

impl Projected {
    /// Share that the nuisance absorbs of one unknown's signal.
    #[must_use]
    pub fn absorbed(&self, place: usize) -> f64 {
        let (remainder, raw) = (self.matrix[(place, place)], self.raw[(place, place)]);
        absorbed_share(remainder, raw).unwrap_or(1.0)
    }
}

/// Absorbed share of a signal; `None` if there was none.
fn absorbed_share(remainder: f64, raw: f64) -> Option<f64> {
    (raw > 0.0).then(|| (1.0 - remainder / raw).clamp(0.0, 1.0))
}

/// The step of the free unknowns and the cost that it saves.
fn solve(
    candidate: &Projected,
    precision: &[f64],
    pull: &[f64],
    free: &[usize],
) -> (DVector<f64>, f64) {
    let count = free.len();
    let matrix = DMatrix::from_fn(count, count, |i, j| {
        let prior = if i == j { precision[free[i]] } else { 0.0 };
        candidate.matrix[(free[i], free[j])] + prior
    });
    let gradient = DVector::from_fn(count, |i, _| candidate.gradient[free[i]] + pull[free[i]]);
    let mut step = DVector::zeros(precision.len());
    let Some(factor) = matrix.cholesky() else {
        return (step, 0.0);
    };
    let solved = factor.solve(&gradient);
    for (place, value) in free.iter().zip(solved.iter()) {
        step[*place] = *value;
    }
    (step, gradient.dot(&solved))
}

/// Quantile at `share` of the largest statistic of all candidates under simulated nulls, as chi-square with one
/// degree of freedom.
#[must_use]
pub fn chance(
    projection: &Projection,
    candidates: &[Projected],
    share: f64,
    draws: usize,
    seed: u64,
) -> f64 {
    let all: Vec<usize> = candidates
        .iter()
        .flat_map(|c| c.unknowns.iter().copied())
        .collect();
    let joint = projection.of(&all);
    // In units of each unknown's information; those without information have no variance.
    let variance = joint.matrix.diagonal();
    let unit: Vec<f64> = variance.iter().map(|v| v.max(0.0).sqrt()).collect();
    let correlation = DMatrix::from_fn(all.len(), all.len(), |i, j| {
        let scale = unit[i] * unit[j];
        let off = if scale > 0.0 {
            joint.matrix[(i, j)] / scale
        } else {
            0.0
        };
        if i == j { 1.0 + RIDGE } else { off }
    });
    let Some(factor) = correlation.cholesky() else {
        return f64::INFINITY;
    };
    let lower = factor.l();
    let mut random = fastrand::Rng::with_seed(seed);
    let mut next = 0;
    let solvers: Vec<_> = candidates
        .iter()
        .filter_map(|candidate| {
            let count = candidate.unknowns.len();
            let first = next;
            next += count;
            let prior = DMatrix::from_fn(count, count, |i, j| {
                let own = projection.system.precision[candidate.unknowns[i]];
                if i == j { own } else { 0.0 }
            });
            Some((first, count, (&candidate.matrix + prior).cholesky()?))
        })
        .collect();
    let mut largest: Vec<f64> = (0..draws)
        .map(|_| {
            let noise = DVector::from_fn(all.len(), |_, _| normal(&mut random));
            let mut pulls = &lower * noise;
            for (pull, unit) in pulls.iter_mut().zip(&unit) {
                *pull *= unit;
            }
            let mut largest = 0.0_f64;
            for (first, count, solver) in &solvers {
                let pull = pulls.rows(*first, *count).into_owned();
                largest = largest.max(one_degree(pull.dot(&solver.solve(&pull)), *count));
            }
            largest
        })
        .collect();
    largest.sort_by(f64::total_cmp);
    let place = (share * (draws - 1) as f64).round() as usize;
    largest.get(place).copied().unwrap_or(f64::INFINITY)
}

/// A chi-square with some degrees of freedom as one with a single degree, equally improbable.
#[must_use]
pub fn one_degree(chi_square: f64, degrees: usize) -> f64 {
    if degrees <= 1 || chi_square <= 0.0 {
        return chi_square.max(0.0);
    }
    let tail = ChiSquared::new(degrees as f64).map_or(0.0, |law| law.sf(chi_square));
    if tail < SMALLEST_TAIL {
        return chi_square;
    }
    Normal::standard().inverse_cdf(0.5 * tail).powi(2)
}

/// A draw from the normal distribution (Box & Muller).
pub fn normal(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.f64()).cos()
}
