//! The augmented model: the given one with the findings.

use crate::diagnosis::DiagnosisError;
use crate::diagnosis::hypothesis::UnknownKind;
use crate::diagnosis::hypothesis::candidate::{Target, copy};
use crate::diagnosis::hypothesis::likelihood::FittedHypothesis;
use crate::diagnosis::search::SearchResult;
use crate::effects::{CATALOGUE, Effects, Extent, Window};
use crate::vehicle::Specification;

/// Minimum weight of a recording's separate value, as a share of the prior's precision.
const MIN_INFORMATION: f64 = 1e-3;

/// The augmented model, without effects of some seconds of one drive.
pub fn model(
    searched: &SearchResult,
    nominal: &Specification,
) -> Result<Specification, DiagnosisError> {
    let problem = &searched.placed;
    let mut model = problem
        .specification(&searched.augmented.solution, 0)
        .map_err(|_| DiagnosisError::NotFinite)?;
    let predictor = problem.predictor(&searched.augmented.coefficients);
    let shooting = problem.shooting(&predictor, &searched.augmented.coefficients);
    // Separate values of the recordings enter as their mean.
    let mut own: Vec<(usize, Vec<OwnValue>)> = Vec::new();
    let FittedHypothesis {
        coefficients,
        solution,
        covariance,
        ..
    } = &searched.augmented;
    problem.visit(&shooting, coefficients, |place, recording, what| {
        if let UnknownKind::CandidateParameter(coefficient) = what
            && problem.candidates[coefficient].own
        {
            let value = OwnValue {
                at: solution.coefficients[recording][coefficient],
                variance: covariance[(place, place)],
            };
            match own.iter_mut().find(|(other, _)| *other == coefficient) {
                Some((_, all)) => all.push(value),
                None => own.push((coefficient, vec![value])),
            }
        }
    });
    for (coefficient, all) in own {
        let about = &problem.candidates[coefficient];
        let coordinate = mean(&all, about.parameter.prior.deviation);
        if let Target::Model(parameter) = about.target {
            let value = about.parameter.value(coordinate);
            parameter
                .set(&mut model, value)
                .map_err(|_| DiagnosisError::NotFinite)?;
        }
    }
    without_seconds(&mut model.effects, &nominal.effects)?;
    // The places of effects that are off are those of the given model.
    for effect in 0..CATALOGUE.len() {
        if !model.effects.is_on(effect) {
            copy(&mut model.effects, effect, &nominal.effects)
                .map_err(|_| DiagnosisError::NotFinite)?;
        }
    }
    Ok(model)
}

/// A recording's separate value of a coordinate.
struct OwnValue {
    at: f64,
    variance: f64,
}

/// The mean over recordings, weighted by their information beyond the prior: a drive that never was in the region has
/// none.
fn mean(each: &[OwnValue], expected: f64) -> f64 {
    let known = expected.powi(-2);
    let weight = |value: &OwnValue| (value.variance.recip() - known).max(MIN_INFORMATION * known);
    let sum: f64 = each.iter().map(|value| weight(value) * value.at).sum();
    sum / each.iter().map(weight).sum::<f64>()
}

/// Turns off effects of some seconds of one drive. If the given model has a window, no other one is searched.
fn without_seconds(effects: &mut Effects, problem: &Effects) -> Result<(), DiagnosisError> {
    if problem.window.is_some() {
        return Ok(());
    }
    let seconds = |window: &mut Window| matches!(window.extent, Extent::Time { .. });
    if let Some(window) = effects.window.take_if(seconds) {
        for effect in window.effects {
            copy(effects, effect, &Effects::NONE).map_err(|_| DiagnosisError::NotFinite)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_that_was_never_there_does_not_count() {
        let value = |at, variance| OwnValue { at, variance };
        // Slope in a disc: 0.06 rad from a crossing; the prior of 0.1 rad from a drive elsewhere.
        let crossed = mean(&[value(0.06, 1e-4), value(0.0, 1e-2)], 0.1);
        assert!((crossed - 0.06).abs() < 1e-5, "{crossed}");
        let both = mean(&[value(0.06, 1e-4), value(0.04, 1e-4)], 0.1);
        assert!((both - 0.05).abs() < 1e-12);
    }

    #[test]
    fn a_window_that_was_given_stays() {
        let text =
            r#"{"drag": {"coefficient": 150}, "window": {"effects": ["drag"], "time": [12, 21]}}"#;
        let windowed = Effects::from_json(text).unwrap();
        let mut kept = windowed.clone();
        without_seconds(&mut kept, &windowed).unwrap();
        assert_eq!(kept, windowed);
        let mut found = windowed.clone();
        without_seconds(&mut found, &Effects::NONE).unwrap();
        assert_eq!(found, Effects::NONE);
    }
}
