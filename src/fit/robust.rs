//! Heavy tails: each sample's weight under Student's t.
//!
//! The white part of the noise follows Student's t with [`DEGREES`] degrees of freedom, as a
//! normal distribution whose precision varies from sample to sample (K. Lange, R. Little,
//! J. Taylor, "Robust statistical modeling using the t distribution", JASA 84 (1989)).
//! Weights and motion are fitted in turns (expectation and maximisation): a weight follows the
//! expected square of the white part, not the square of its expected value, which is smaller.

use super::noise::ChannelNoise;

/// Degrees of freedom nu of Student's t: tails as of GPS and scan matching; on normal noise
/// it costs some 5 % of precision.
pub const DEGREES: f64 = 5.0;

/// The weight of a sample whose white part is so many standard deviations large.
#[must_use]
pub fn weight(ratio: f64) -> f64 {
    (DEGREES + 1.0) / (DEGREES + ratio * ratio)
}

/// What the objective gains from a weight: min over the weights of
/// lambda (w/s)^2 + penalty(lambda) is (nu + 1) ln(1 + (w/s)^2 / nu).
#[must_use]
pub fn penalty(weight: f64) -> f64 {
    let at_rest = |lambda: f64| DEGREES * lambda - (DEGREES + 1.0) * lambda.ln();
    at_rest(weight) - at_rest((DEGREES + 1.0) / DEGREES)
}

/// The slope of a sample's pull, its weighed residual: lambda (1 - 2 x^2 / (nu + x^2)). It is
/// the information of a sample on its mean, and less than its weight.
#[must_use]
pub fn curvature(ratio: f64) -> f64 {
    let square = ratio * ratio;
    weight(ratio) * (1.0 - 2.0 * square / (DEGREES + square))
}

/// Sets the weights to what the residuals ask for.
pub fn update(noise: &ChannelNoise, time: &[f64], residual: &[f64], weights: &mut [f64]) {
    let white = noise.white_part(time, weights, residual);
    for (lambda, white) in weights.iter_mut().zip(white) {
        *lambda = weight(white.ratio(noise.white));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_minimise_the_objective() {
        for ratio in [0.0, 0.5, 1.0, 3.0, 10.0_f64] {
            let objective = |lambda: f64| lambda * ratio * ratio + penalty(lambda);
            let best = weight(ratio);
            assert!(objective(best * 1.01) > objective(best));
            assert!(objective(best * 0.99) > objective(best));
            let expected = (DEGREES + 1.0) * (1.0 + ratio * ratio / DEGREES).ln();
            assert!((objective(best) - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn curvature_is_the_slope_of_the_weighted_residual() {
        let (ratio, h) = (1.3, 1e-6);
        let pull = |ratio: f64| weight(ratio) * ratio;
        let slope = (pull(ratio + h) - pull(ratio - h)) / (2.0 * h);
        assert!((slope - curvature(ratio)).abs() < 1e-9);
    }
}
