//! Noise of a channel: white plus coloured, at sample times of any spacing.
//!
//! A residual is r_i = u_i + w_i. The coloured part u is a Gauss–Markov process (AR(1) where
//! samples are evenly spaced) of standard deviation s_u and correlation time T: the
//! correlation of samples d apart is exp(-d/T). The white part w has standard deviation
//! s_w / sqrt(lambda_i); the weights lambda make its tails heavy, see [`super::robust`].
//!
//! The Kalman filter of this one-state model whitens: its innovations, divided by their
//! standard deviations, are independent with variance one (A. C. Harvey, "Forecasting,
//! Structural Time Series Models and the Kalman Filter", 1989, section 3.4). The gains do not
//! depend on the residuals, so that the same filter whitens the derivatives; the cost is
//! linear in the number of samples.

/// Noise of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelNoise {
    /// Standard deviation of the white part, in the channel's unit.
    pub white: f64,
    /// Standard deviation of the coloured part, in the channel's unit.
    pub coloured: f64,
    /// Correlation time of the coloured part \[s\].
    pub correlation_time: f64,
}

/// What is known of the white part of a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WhitePart {
    /// Expected value, in the channel's unit.
    pub mean: f64,
    /// Variance.
    pub variance: f64,
}

impl WhitePart {
    /// Root of the expected square over a standard deviation.
    #[must_use]
    pub fn ratio(&self, deviation: f64) -> f64 {
        (self.mean * self.mean + self.variance).sqrt() / deviation
    }
}

/// The filter's quantities at one sample.
#[derive(Debug, Clone, Copy)]
struct Gain {
    /// Variance of the innovation.
    variance: f64,
    /// Share of the innovation that the coloured part takes.
    gain: f64,
    /// Correlation of the coloured part with its value at the next sample.
    decay: f64,
}

impl ChannelNoise {
    /// Calls `visit` with the filter's quantities at each sample.
    fn gains(&self, time: &[f64], weight: &[f64], mut visit: impl FnMut(usize, Gain)) {
        let (white, stationary) = (self.white.powi(2), self.coloured.powi(2));
        let mut variance = stationary;
        for (index, lambda) in weight.iter().enumerate() {
            let innovation = variance + white / lambda;
            let gain = variance / innovation;
            let step = time.get(index + 1).map_or(0.0, |next| next - time[index]);
            let decay = (-step / self.correlation_time).exp();
            let at = Gain {
                variance: innovation,
                gain,
                decay,
            };
            visit(index, at);
            variance *= 1.0 - gain;
            variance = decay * decay * (variance - stationary) + stationary;
        }
    }

    /// Whitens the columns of a table whose rows are samples, in place, and returns the
    /// logarithm of the noise's determinant. Minus half of it, less half the sum of the
    /// whitened residual's squares, is the log likelihood but for a constant.
    pub fn whiten(&self, time: &[f64], weight: &[f64], columns: usize, table: &mut [f64]) -> f64 {
        let mut expected = vec![0.0; columns];
        let mut log_determinant = 0.0;
        self.gains(time, weight, |index, at| {
            let row = &mut table[index * columns..(index + 1) * columns];
            let scale = 1.0 / at.variance.sqrt();
            for (cell, mean) in row.iter_mut().zip(&mut expected) {
                let innovation = *cell - *mean;
                *mean = at.decay * (*mean + at.gain * innovation);
                *cell = innovation * scale;
            }
            log_determinant += at.variance.ln();
        });
        log_determinant
    }

    /// Log likelihood of each residual given those before it, but for a constant.
    #[must_use]
    pub fn log_likelihoods(&self, time: &[f64], weight: &[f64], residual: &[f64]) -> Vec<f64> {
        let mut each = Vec::with_capacity(residual.len());
        let mut expected = 0.0;
        self.gains(time, weight, |index, at| {
            let innovation = residual[index] - expected;
            expected = at.decay * (expected + at.gain * innovation);
            each.push(-0.5 * (innovation * innovation / at.variance + at.variance.ln()));
        });
        each
    }

    /// The white part of residuals: at each sample its expected value w = R S^-1 r and its
    /// variance R - R (S^-1)_ii R, with the white part's covariance R and the whole noise's S. The
    /// filter gives L of S^-1 = L^T L; its adjoint runs backward (Bryson & Frazier's smoother; J.
    /// Durbin & S. J. Koopman, "Time Series Analysis by State Space Methods", section 4.5).
    #[must_use]
    pub fn white_part(&self, time: &[f64], weight: &[f64], residual: &[f64]) -> Vec<WhitePart> {
        let mut forward = Vec::with_capacity(residual.len());
        let mut expected = 0.0;
        self.gains(time, weight, |index, at| {
            let innovation = residual[index] - expected;
            expected = at.decay * (expected + at.gain * innovation);
            forward.push((innovation, at));
        });
        let nothing = WhitePart {
            mean: 0.0,
            variance: 0.0,
        };
        let mut white = vec![nothing; residual.len()];
        let (mut adjoint, mut precision) = (0.0, 0.0);
        for (index, (innovation, at)) in forward.into_iter().enumerate().rev() {
            let taken = at.decay * at.gain;
            let by_residual = innovation / at.variance + taken * adjoint;
            let diagonal = 1.0 / at.variance + taken * taken * precision;
            adjoint = at.decay * adjoint - by_residual;
            let kept = at.decay - taken;
            precision = 1.0 / at.variance + kept * kept * precision;
            let own = self.white.powi(2) / weight[index];
            white[index] = WhitePart {
                mean: own * by_residual,
                variance: (own - own * own * diagonal).max(0.0),
            };
        }
        white
    }

    /// Standard deviation of both parts together.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.white.hypot(self.coloured)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    const NOISE: ChannelNoise = ChannelNoise {
        white: 0.3,
        coloured: 0.7,
        correlation_time: 0.4,
    };
    const TIME: [f64; 7] = [0.0, 0.1, 0.15, 0.4, 0.5, 1.3, 1.35];
    const WEIGHT: [f64; 7] = [1.0, 1.2, 0.1, 1.0, 0.6, 1.0, 1.1];
    const RESIDUAL: [f64; 7] = [0.3, -0.5, 2.0, 0.1, 0.4, -1.0, -0.2];
    /// Rounding of seven steps.
    const TOLERANCE: f64 = 1e-12;

    fn covariance() -> DMatrix<f64> {
        DMatrix::from_fn(7, 7, |i, j| {
            let coloured = NOISE.coloured.powi(2)
                * (-(TIME[i] - TIME[j]).abs() / NOISE.correlation_time).exp();
            let white = if i == j {
                NOISE.white.powi(2) / WEIGHT[i]
            } else {
                0.0
            };
            coloured + white
        })
    }

    #[test]
    fn whitening_is_a_factor_of_the_inverse_covariance() {
        let mut table = DMatrix::<f64>::identity(7, 7).as_slice().to_vec();
        let log_determinant = NOISE.whiten(&TIME, &WEIGHT, 7, &mut table);
        let factor = DMatrix::from_row_slice(7, 7, &table);
        let whitened = &factor * covariance() * factor.transpose();
        assert!((whitened - DMatrix::identity(7, 7)).amax() < TOLERANCE);
        assert!((log_determinant - covariance().determinant().ln()).abs() < TOLERANCE);
    }

    #[test]
    fn white_part_is_what_the_dense_formula_gives() {
        let white = NOISE.white_part(&TIME, &WEIGHT, &RESIDUAL);
        let inverse = covariance().try_inverse().unwrap();
        let solved = &inverse * DVector::from_row_slice(&RESIDUAL);
        for (index, white) in white.into_iter().enumerate() {
            let own = NOISE.white.powi(2) / WEIGHT[index];
            assert!(
                (white.mean - own * solved[index]).abs() < TOLERANCE,
                "{index}"
            );
            let variance = own - own * own * inverse[(index, index)];
            assert!((white.variance - variance).abs() < TOLERANCE, "{index}");
        }
    }
}
