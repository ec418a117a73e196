//! Each segment's likelihood at a fitted hypothesis, its start eliminated.

use crate::fit::normal::{Eliminated, Normal};
use crate::fit::optimiser::normals;
use crate::fit::predictor::Predictor;
use crate::fit::problem::{NoiseModel, Point, ShootingProblem, Tables};
use nalgebra::{DMatrix, DVector};

/// A segment's normal equations in a hypothesis' unknowns, its start eliminated.
#[derive(Debug, Clone)]
pub struct Block {
    /// H of the segment.
    pub matrix: DMatrix<f64>,
    /// g of the segment.
    pub gradient: DVector<f64>,
    /// Squared whitened residuals after elimination of the start.
    pub cost: f64,
    /// Log determinants of noise and start.
    pub log_determinant: f64,
    /// Number of samples.
    pub samples: usize,
}

impl Block {
    /// Log density of the segment's samples up to a common constant.
    #[must_use]
    pub fn log_density(&self) -> f64 {
        -0.5 * (self.cost + self.log_determinant)
    }

    /// Log predictive density, the unknowns integrated over their posterior from other segments: this precision, and
    /// the mean at `step` from here. `None` if the precision is not positive definite.
    #[must_use]
    pub fn predictive(&self, precision: &DMatrix<f64>, step: &DVector<f64>) -> Option<f64> {
        let along = &self.matrix * step;
        let cost = self.cost - (2.0 * &self.gradient - &along).dot(step);
        let gradient = &self.gradient - along;
        let both = (precision + &self.matrix).cholesky()?;
        let wider = both.ln_determinant() - precision.clone().cholesky()?.ln_determinant();
        let regained = gradient.dot(&both.solve(&gradient));
        Some(-0.5 * (cost - regained + self.log_determinant + wider))
    }
}

/// The segments of a fitted hypothesis. `None` where numbers are not finite.
#[must_use]
pub fn blocks<P: Predictor>(
    shooting: &ShootingProblem<P>,
    tables: &[Tables],
    point: &Point,
    noise: &NoiseModel,
) -> Option<Vec<Block>> {
    let normals = normals(shooting, tables, point, noise);
    let one = |(index, normal): (usize, &Normal)| {
        let eliminated = Eliminated::new(normal, 0.0)?;
        let segment = &shooting.segments[index];
        let mut block = Block {
            matrix: eliminated.matrix.clone(),
            gradient: eliminated.gradient.clone(),
            cost: normal.cost - eliminated.start_gain,
            log_determinant: eliminated.log_determinant(),
            samples: 0,
        };
        for deviation in segment.start_deviation {
            block.log_determinant += 2.0 * deviation.ln();
        }
        for (channel, data) in segment.samples.iter().enumerate() {
            let channel_noise = noise.noise[segment.recording][data.signal.group() as usize];
            let weights = &noise.weights[index][channel];
            block.log_determinant +=
                channel_noise.whiten(&data.time, weights, 1, &mut vec![0.0; data.time.len()]);
            block.samples += data.time.len();
        }
        Some(block)
    };
    normals.iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One segment and one unknown u: the density integrated over the posterior of u.
    #[test]
    fn predictions_integrate_what_the_others_leave_open() {
        let block = Block {
            matrix: DMatrix::from_element(1, 1, 9.0),
            gradient: DVector::from_element(1, -6.0),
            cost: 5.0,
            log_determinant: 0.4,
            samples: 1,
        };
        let (precision, step) = (2.5_f64, 0.8);
        let density = |u: f64| {
            let cost = block.cost - 2.0 * block.gradient[0] * u + block.matrix[(0, 0)] * u * u;
            (-0.5 * (cost + block.log_determinant)).exp()
        };
        let width = 1e-3;
        let each = (-20_000..20_000).map(|k| f64::from(k) * width).map(|off| {
            let known =
                (precision / std::f64::consts::TAU).sqrt() * (-0.5 * precision * off * off).exp();
            density(step + off) * known * width
        });
        let expected = each.sum::<f64>().ln();
        let known = |value| DMatrix::from_element(1, 1, value);
        let at = DVector::from_element(1, step);
        let predicted = block.predictive(&known(precision), &at).unwrap();
        assert!(
            (predicted - expected).abs() < 1e-9,
            "{predicted} {expected}"
        );
        // Without uncertainty: the density there.
        let sure = block.predictive(&known(1e12), &at).unwrap();
        assert!((sure - density(step).ln()).abs() < 1e-9, "{sure}");
        assert!(predicted > sure);
    }
}
