//! The unmodelled wrench over time.
//!
//! A latent dF_X, dF_Y, dM_Z in every time bin, with an Ornstein–Uhlenbeck process as its prior (correlation time
//! [`MEMORY`], size by maximum likelihood), observed through the motion that it causes: no position is
//! differentiated. The posterior, that of a Kalman filter and a Rauch–Tung–Striebel smoother (A. Gelb, "Applied
//! Optimal Estimation", 1974), is computed segment by segment together with both neighbours; farther segments are
//! neglected.

use super::sensitivity::Layout;
use super::system::{SegmentSystem, System};
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::outcome::WrenchTrace;
use crate::vehicle::GRAVITY;
use nalgebra::{DMatrix, DVector};

/// Correlation time of the latent wrench \[s\].
const MEMORY: f64 = 1.0;
/// Sizes that are tried, as shares of the weight.
const SIZES: [f64; 7] = [3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3];
/// Components of the wrench.
const COUNT: usize = 3;

/// A latent wrench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatentWrench {
    /// Standard deviation of each component, as a share of the weight (times the half track).
    pub size: [f64; COUNT],
    /// Log Bayes factor against none.
    pub evidence: f64,
}

/// Binned columns of the three components within a time bin.
#[must_use]
pub fn force_columns(problem: &Problem, layout: &Layout) -> Option<[usize; COUNT]> {
    let mut found = problem
        .candidates
        .residual_models()
        .filter_map(|coefficient| {
            let mut binned = layout.binned.iter();
            let binned = binned.position(|other| *other == coefficient)?;
            Some(layout.soil + binned)
        });
    Some([found.next()?, found.next()?, found.next()?])
}

/// A segment's equations by the wrench in its time bins, at held soil.
fn equations(
    system: &System,
    segment: &SegmentSystem,
    columns: [usize; COUNT],
) -> (DMatrix<f64>, DVector<f64>) {
    let layout = &system.layout;
    let place = |k: usize| layout.whole() + (k / COUNT) * layout.per_bin() + columns[k % COUNT];
    let size = COUNT * segment.time_bins();
    (
        DMatrix::from_fn(size, size, |i, j| segment.matrix[(place(i), place(j))]),
        DVector::from_fn(size, |i, _| segment.gradient[place(i)]),
    )
}

/// Precision of the process over so many time bins of a length.
fn process(size: [f64; COUNT], time_bins: usize, step: f64) -> DMatrix<f64> {
    let decay = (-step / MEMORY).exp();
    let fresh = 1.0 - decay * decay;
    DMatrix::from_fn(COUNT * time_bins, COUNT * time_bins, |i, j| {
        let (time_bin, other) = (i / COUNT, j / COUNT);
        if i % COUNT != j % COUNT {
            return 0.0;
        }
        let unit = size[i % COUNT].powi(-2) / fresh;
        match time_bin.abs_diff(other) {
            0 if time_bins == 1 => fresh * unit,
            0 if time_bin == 0 || time_bin + 1 == time_bins => unit,
            0 => (1.0 + decay * decay) * unit,
            1 => -decay * unit,
            _ => 0.0,
        }
    })
}

/// The size of the latent wrench with the largest evidence, and that evidence.
#[must_use]
pub fn latent_wrench(problem: &Problem, system: &System) -> Option<LatentWrench> {
    let columns = force_columns(problem, &system.layout)?;
    let each: Vec<_> = system
        .segments
        .iter()
        .map(|segment| (equations(system, segment, columns), segment))
        .collect();
    let evidence = |size: [f64; COUNT]| -> f64 {
        let of =
            |((matrix, gradient), segment): &((DMatrix<f64>, DVector<f64>), &SegmentSystem)| {
                let step = segment.edges[1] - segment.edges[0];
                let prior = process(size, segment.time_bins(), step);
                let (prior_factor, factor) =
                    match (prior.clone().cholesky(), (matrix + prior).cholesky()) {
                        (Some(a), Some(b)) => (a, b),
                        _ => return 0.0,
                    };
                let log = |l: &DMatrix<f64>| 2.0 * l.diagonal().map(f64::ln).sum();
                let determinant = log(factor.l_dirty()) - log(prior_factor.l_dirty());
                0.5 * (gradient.dot(&factor.solve(gradient)) - determinant)
            };
        each.iter().map(of).sum()
    };
    let mut size = [SIZES[0]; COUNT];
    let mut best = evidence(size);
    for _ in 0..2 {
        for component in 0..COUNT {
            for trial in SIZES {
                let mut other = size;
                other[component] = trial;
                let value = evidence(other);
                if value > best {
                    (size, best) = (other, value);
                }
            }
        }
    }
    Some(LatentWrench {
        size,
        evidence: best,
    })
}

/// The posterior wrench of one run at the middles of its time bins. `None` without time bins.
#[must_use]
pub fn smooth(
    problem: &Problem,
    system: &System,
    recording: usize,
    run: usize,
    size: [f64; COUNT],
) -> Option<WrenchTrace> {
    let columns = force_columns(problem, &system.layout)?;
    let own = |segment: &&SegmentSystem| {
        let data = &problem.segments[segment.index];
        (data.recording, data.run) == (recording, run)
    };
    let segments: Vec<&SegmentSystem> = system.segments.iter().filter(own).collect();
    let vehicle = &problem.nominal.vehicle;
    let weight = vehicle.mass * GRAVITY;
    let scale = [weight, weight, weight * vehicle.half_track];
    let mut trace = WrenchTrace {
        time: Vec::new(),
        value: Vec::new(),
        deviation: Vec::new(),
    };
    let joined = |a: usize, b: usize| segments[a].joins(segments[b]);
    for index in 0..segments.len() {
        let first = if index > 0 && joined(index - 1, index) {
            index - 1
        } else {
            index
        };
        let next = index + 1;
        let end = if next < segments.len() && joined(index, next) {
            next + 1
        } else {
            next
        };
        let step = segments[index].edges[1] - segments[index].edges[0];
        let time_bins: usize = segments[first..end].iter().map(|s| s.time_bins()).sum();
        let mut matrix = process(size, time_bins, step);
        let mut gradient = DVector::zeros(COUNT * time_bins);
        let (mut place, mut own) = (0, 0);
        for (k, segment) in segments[first..end].iter().enumerate() {
            if first + k == index {
                own = place;
            }
            let (block, pull) = equations(system, segment, columns);
            let count = pull.len();
            let mut corner = matrix.view_mut((place, place), (count, count));
            corner += block;
            gradient.rows_mut(place, count).copy_from(&pull);
            place += count;
        }
        let factor = matrix.cholesky()?;
        let mean = factor.solve(&gradient);
        let covariance = factor.inverse();
        for (time_bin, edges) in segments[index].edges.windows(2).enumerate() {
            let at = |k: usize| own + COUNT * time_bin + k;
            trace.time.push(0.5 * (edges[0] + edges[1]));
            trace
                .value
                .push(std::array::from_fn(|k| scale[k] * mean[at(k)]));
            let deviation = |k: usize| covariance[(at(k), at(k))].max(0.0).sqrt();
            trace
                .deviation
                .push(std::array::from_fn(|k| scale[k] * deviation(k)));
        }
    }
    (!trace.time.is_empty()).then_some(trace)
}
