//! A constant error of a sensor, or slow noise?
//!
//! The likelihood takes noise as independent from segment to segment, with a correlation time from within them. An
//! error that outlasts segments, as a compass has, then looks as certain as many independent measurements of a
//! constant. Its duration is unknown, so "nothing missing" allows for a constant error of the size of the coloured
//! noise. Take an estimate x of deviation s and coloured noise of deviation c. This alternative has against none the
//! log Bayes factor x^2 / (2 s^2) c^2 / (s^2 + c^2) - ln(1 + c^2 / s^2) / 2, which an offset of heading or gyro pays.

use super::screen::Projected;
use super::system::System;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::candidate::Target;
use crate::fit::problem::NoiseModel;
use crate::fit::sensor::SensorParameter;
use crate::fit::signal::NoiseGroup;

/// Upper limit of the price: slow noise also explains a part of what other candidates do.
const MOST: f64 = 8.0;

/// The price of a candidate for what slow noise explains of it.
#[must_use]
pub fn price(problem: &Problem, system: &System, candidate: &Projected, noise: &NoiseModel) -> f64 {
    let each = candidate.unknowns.iter().enumerate();
    let paid = each.filter_map(|(place, unknown)| {
        let slow = slow_noise(problem, system, *unknown, noise)?;
        let (gradient, precision) = (candidate.gradient[place], candidate.matrix[(place, place)]);
        Some(explained(gradient, precision, slow))
    });
    paid.sum::<f64>().min(MOST)
}

/// Deviation of the slow noise that may imitate an unknown, if it is a constant error of heading or gyro.
fn slow_noise(
    problem: &Problem,
    system: &System,
    unknown: usize,
    noise: &NoiseModel,
) -> Option<f64> {
    let place = |places: &Vec<Option<usize>>| places.iter().position(|one| *one == Some(unknown));
    let mut recordings = system.places.iter().zip(&noise.noise);
    let (column, noise) = recordings.find_map(|(places, noise)| Some((place(places)?, noise)))?;
    let coefficient = column.checked_sub(system.layout.soil)?;
    let group = match problem.candidates.coefficients.get(coefficient)?.target {
        Target::Sensor(SensorParameter::HeadingOffset) => NoiseGroup::Heading,
        Target::Sensor(SensorParameter::YawRateBias) => NoiseGroup::YawRate,
        _ => return None,
    };
    Some(noise[group as usize].coloured)
}

/// Log Bayes factor of a constant error of this deviation against none.
fn explained(gradient: f64, precision: f64, deviation: f64) -> f64 {
    let ratio = precision * deviation.powi(2);
    let chi_square = gradient.powi(2) / precision;
    if ratio > 0.0 && chi_square.is_finite() {
        (0.5 * chi_square * ratio / (1.0 + ratio) - 0.5 * ratio.ln_1p()).max(0.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{Continuous, Normal};

    #[test]
    fn slow_noise_explains_what_two_normal_densities_say() {
        let (estimate, own, slow): (f64, f64, f64) = (0.0055, 0.0012, 0.002);
        let precision = own.powi(-2);
        let density = |deviation: f64| Normal::new(0.0, deviation).unwrap().ln_pdf(estimate);
        let expected = density(own.hypot(slow)) - density(own);
        let found = explained(estimate * precision, precision, slow);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        assert!(found > 6.0);
        // An error that slow noise makes no likelier has no price, nor has one without noise.
        assert_eq!(explained(0.0, precision, slow), 0.0);
        assert_eq!(explained(estimate * precision, precision, 0.0), 0.0);
        assert_eq!(explained(0.0, 0.0, slow), 0.0);
    }
}
