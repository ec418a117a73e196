//! How well the data fix the parameters.
//!
//! The covariance is H^-1 M H^-1 (P. J. Huber, "The behavior of maximum likelihood estimates
//! under nonstandard conditions", 1967): H is the matrix of the normal equations with the
//! starts eliminated, M what the segments' pulls on the parameters really scatter by. Where
//! the noise is as estimated M = H; noise that is longer correlated than its model, or physics
//! that the model lacks, pull segments apart and make M larger. With few segments their
//! scatter is itself uncertain, so M is drawn towards H.

use super::normal::{Eliminated, Normal};
use super::optimiser::normals;
use super::parameter::NORMAL_95;
use super::predictor::Predictor;
use super::problem::{NoiseModel, Point, ShootingProblem, Tables};
use super::robust;
use super::signal::NoiseGroup;
use nalgebra::{DMatrix, DVector};

/// M counts for as much as so many segments per parameter do.
const SEGMENTS_PER_PARAMETER: f64 = 2.0;

/// Covariance of the parameters' coordinates, and the matrices that it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Covariance of the coordinates.
    pub covariance: DMatrix<f64>,
    /// Information in the data alone, without the priors.
    pub information: DMatrix<f64>,
    /// How many times larger the segments' pulls scatter than the noise explains, as a mean
    /// over the directions that the data fix; 1 where noise and model are right.
    pub overdispersion: f64,
}

impl Uncertainty {
    /// Standard deviation of a coordinate.
    #[must_use]
    pub fn deviation(&self, index: usize) -> f64 {
        self.covariance[(index, index)].max(0.0).sqrt()
    }

    /// Half the width of the 90 % interval of a coordinate.
    #[must_use]
    pub fn half_width(&self, index: usize) -> f64 {
        NORMAL_95 * self.deviation(index)
    }

    /// Correlation of two coordinates.
    #[must_use]
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let product = self.deviation(a) * self.deviation(b);
        if product > 0.0 {
            self.covariance[(a, b)] / product
        } else {
            f64::from(u8::from(a == b))
        }
    }
}

/// The uncertainty at a fitted point, of a robust fit or of one in which all samples count alike. `None` where the numbers
/// are not finite.
#[must_use]
pub fn uncertainty<P: Predictor>(
    problem: &ShootingProblem<P>,
    tables: &[Tables],
    point: &Point,
    by: &NoiseModel,
    robust: bool,
) -> Option<Uncertainty> {
    let pulls: Vec<Eliminated> = eliminate(&normals(problem, tables, point, by))?;
    let curved = if robust {
        let flatter = with_curvature(problem, tables, by);
        &eliminate(&normals(problem, tables, point, &flatter))?
    } else {
        &pulls
    };
    let count = problem.parameters.len();
    let mut information = DMatrix::zeros(count, count);
    for one in curved {
        information += &one.matrix;
    }
    let (precision, _) = problem.prior(&point.coordinates);
    let precision = DMatrix::from_diagonal(&precision);
    let inverse = (&information + &precision).cholesky()?.inverse();
    let scatter = scatter(problem, &pulls, &information);
    let overdispersion = overdispersion(&information, &precision, &scatter)?;
    let covariance = &inverse * (&scatter + &precision) * &inverse;
    Some(Uncertainty {
        covariance: (&covariance + covariance.transpose()) * 0.5,
        information,
        overdispersion,
    })
}

fn eliminate(normals: &[Normal]) -> Option<Vec<Eliminated>> {
    let each = normals.iter().map(|normal| Eliminated::new(normal, 0.0));
    each.collect()
}

/// Scatter of the segments' pulls, neighbours in a run counted together (W. K. Newey &
/// K. D. West, Econometrica 55 (1987), lag 1), drawn towards the information where there are
/// few segments.
fn scatter<P: Predictor>(
    problem: &ShootingProblem<P>,
    pulls: &[Eliminated],
    information: &DMatrix<f64>,
) -> DMatrix<f64> {
    let count = pulls.len() as f64;
    let mean: DVector<f64> = pulls.iter().map(|p| &p.gradient).sum::<DVector<f64>>() / count;
    let pulls: Vec<DVector<f64>> = pulls.iter().map(|p| &p.gradient - &mean).collect();
    let mut scatter = DMatrix::zeros(information.nrows(), information.nrows());
    for (index, pull) in pulls.iter().enumerate() {
        scatter += pull * pull.transpose();
        let segments = &problem.segments;
        let neighbour = segments
            .get(index + 1)
            .filter(|next| next.follows(&segments[index]));
        if neighbour.is_some() {
            let product = pull * pulls[index + 1].transpose();
            scatter += (&product + product.transpose()) * 0.5;
        }
    }
    let parameters = information.nrows() as f64;
    // The fit itself removes as much scatter as it has parameters.
    let freedom = (count - parameters).max(1.0);
    let trust = freedom / (freedom + SEGMENTS_PER_PARAMETER * parameters);
    scatter * (trust * count / freedom) + information * (1.0 - trust)
}

/// trace(M H^-1) over trace(I H^-1), with the information I and H = I + prior.
fn overdispersion(
    information: &DMatrix<f64>,
    precision: &DMatrix<f64>,
    scatter: &DMatrix<f64>,
) -> Option<f64> {
    let factor = (information + precision).cholesky()?;
    let (found, expected) = (
        factor.solve(scatter).trace(),
        factor.solve(information).trace(),
    );
    Some(if expected > 0.0 {
        found / expected
    } else {
        1.0
    })
}

/// Weights whose information is the curvature of the objective: a sample's pull grows more
/// slowly than its weight, see [`robust::curvature`].
fn with_curvature<P: Predictor>(
    problem: &ShootingProblem<P>,
    tables: &[Tables],
    by: &NoiseModel,
) -> NoiseModel {
    let mut sums = vec![[(0.0, 0.0); NoiseGroup::ALL.len()]; problem.recordings.len()];
    for (index, segment) in problem.segments.iter().enumerate() {
        for (channel, samples) in segment.samples.iter().enumerate() {
            let group = samples.signal.group() as usize;
            let noise = &by.noise[segment.recording][group];
            let table = &tables[index].channels[channel];
            let residual: Vec<f64> = table
                .iter()
                .step_by(tables[index].columns)
                .copied()
                .collect();
            let white = noise.white_part(&samples.time, &by.weights[index][channel], &residual);
            let sum = &mut sums[segment.recording][group];
            for white in white {
                let ratio = white.ratio(noise.white);
                sum.0 += robust::curvature(ratio);
                sum.1 += robust::weight(ratio);
            }
        }
    }
    let mut flatter = by.clone();
    for (segment, weights) in problem.segments.iter().zip(&mut flatter.weights) {
        for (samples, weights) in segment.samples.iter().zip(weights) {
            let (curvature, weight) = sums[segment.recording][samples.signal.group() as usize];
            let share = (curvature / weight).clamp(0.2, 1.0);
            weights.iter_mut().for_each(|lambda| *lambda *= share);
        }
    }
    flatter
}
