//! Removal of redundant effects.

use super::accepted::{AcceptedEffect, NOTHING, is_mended};
use super::proposal::{Proposal, ProposalKind};
use super::stage::Stage;
use super::trial::CLOSE;
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, fit_hypothesis, scattered};
use crate::diagnosis::hypothesis::{Problem, UnknownKind};
use crate::diagnosis::screening::screen::Projection;
use crate::diagnosis::screening::shape::gain_at;
use crate::fit::predictor::PredictionError;
use crate::fit::problem::NoiseModel;

/// Linearised loss, as a multiple of the price, above which an effect stays without a fit.
const SURELY: f64 = 3.0;
/// Minimum size of a residual model's term in standard errors.
const SURE_TERM: f64 = 2.0;

/// Removes effects that the others explain, or that only led to a better soil, and sorts the others by what they
/// explain beside the rest. `ratio` is the number of all segments over those of the stage. At the deadline the
/// remaining effects stay.
pub fn prune(
    stage: &mut Stage,
    accepted: &mut Vec<AcceptedEffect>,
    noise: &NoiseModel,
    ratio: f64,
) {
    if stage.problem.deadline.is_over() {
        return;
    }
    let mut index = 0;
    while index < accepted.len() {
        if is_mended(accepted, index) {
            // With another formula it explains what the residual model would imitate without it.
            index += 1;
            continue;
        }
        let removed = &accepted[index].proposal;
        let price = NOTHING - removed.log_prior() + removed.price;
        let loss = linear_loss(stage, &removed.coefficients);
        if loss > SURELY * price + CLOSE {
            // What another formula explains besides is lost as well.
            if accepted.len() > 1 && stage.fit.shape_gain <= 0.0 {
                // Later effects may explain most of it.
                let gain = ratio * loss - removed.price;
                accepted[index].gain = accepted[index].gain.min(gain);
            }
            index += 1;
            continue;
        }
        let (problem, without) = without(stage, removed, noise);
        if problem.deadline.is_over() {
            // A fit that was cut short understates what the rest explains.
            break;
        }
        match without {
            Ok(mut without) => {
                if stage.fit.shape_gain != 0.0 {
                    let FittedHypothesis {
                        coefficients,
                        solution,
                        ..
                    } = &without;
                    without.shape_gain = gain_at(&problem, coefficients, solution, noise);
                }
                let lost = without.with_neighbours() - stage.fit.with_neighbours();
                if lost < price {
                    accepted.remove(index);
                    stage.problem = problem;
                    stage.fit = without;
                    index = 0;
                } else {
                    accepted[index].gain = ratio * lost - removed.price;
                    index += 1;
                }
            }
            Err(_) => index += 1,
        }
    }
    // A subsample has larger standard errors.
    if ratio == 1.0 {
        trim_residual_models(stage, accepted, noise);
    }
    accepted.sort_by(|a, b| b.gain.total_cmp(&a.gain));
}

/// Removes small terms of residual models, in standard errors from the scatter of the segments: the likelihood takes
/// segments as independent, which overstates terms with opposite effects in different segments.
fn trim_residual_models(stage: &mut Stage, accepted: &mut Vec<AcceptedEffect>, noise: &NoiseModel) {
    let mut index = 0;
    while index < accepted.len() {
        let residual_model = &accepted[index].proposal;
        let doubtful = doubtful_term(&stage.problem, &stage.fit, residual_model, noise);
        let Some(place) = doubtful else {
            index += 1;
            continue;
        };
        let term = Proposal {
            coefficients: vec![residual_model.coefficients[place]],
            ..residual_model.clone()
        };
        let (problem, Ok(without)) = without(stage, &term, noise) else {
            index += 1;
            continue;
        };
        if problem.deadline.is_over() {
            break;
        }
        let lost = without.negative_log_evidence - stage.fit.negative_log_evidence;
        // Also if the fit without it failed.
        if lost.is_nan() || lost >= SURELY * (NOTHING - term.log_prior()) {
            index += 1;
            continue;
        }
        let effect = &mut accepted[index];
        effect.lose(lost + term.log_prior());
        effect.gain -= lost;
        effect.proposal.without_term(place);
        if effect.proposal.coefficients.is_empty() {
            accepted.remove(index);
        }
        stage.problem = problem;
        stage.fit = without;
    }
}

/// Index of a residual model's least certain term, if it is below the limit.
fn doubtful_term(
    problem: &Problem,
    fit: &FittedHypothesis,
    residual_model: &Proposal,
    noise: &NoiseModel,
) -> Option<usize> {
    if residual_model.kind() != ProposalKind::ResidualModel {
        return None;
    }
    let covariance = scattered(problem, fit, noise);
    let predictor = problem.predictor(&fit.coefficients);
    let shooting = problem.shooting(&predictor, &fit.coefficients);
    let mut sure = vec![0.0_f64; residual_model.coefficients.len()];
    problem.visit(&shooting, &fit.coefficients, |unknown, recording, what| {
        let UnknownKind::CandidateParameter(coefficient) = what else {
            return;
        };
        let Some(place) = residual_model
            .coefficients
            .iter()
            .position(|other| *other == coefficient)
        else {
            return;
        };
        let off = problem.candidates[coefficient].off();
        let size = (fit.solution.coefficients[recording][coefficient] - off).abs();
        let errors = size / covariance[(unknown, unknown)].max(0.0).sqrt();
        sure[place] = sure[place].max(errors);
    });
    let smallest = (0..sure.len()).min_by(|a, b| sure[*a].total_cmp(&sure[*b]))?;
    (sure[smallest] < SURE_TERM).then_some(smallest)
}

/// The hypothesis without an effect, and the given model without its region.
pub fn without<'a>(
    stage: &Stage<'a>,
    removed: &Proposal,
    noise: &NoiseModel,
) -> (Problem<'a>, Result<FittedHypothesis, PredictionError>) {
    let coefficients = stage.fit.coefficients.iter().copied();
    let coefficients: Vec<usize> = coefficients
        .filter(|k| !removed.coefficients.contains(k))
        .collect();
    let mut problem = stage.problem.clone();
    if removed.kind() == ProposalKind::Local {
        problem.nominal.effects.window = None;
    }
    let mut initial = stage.fit.solution.clone();
    for recording in &mut initial.coefficients {
        for coefficient in &removed.coefficients {
            recording[*coefficient] = problem.candidates[*coefficient].off();
        }
    }
    let fit = fit_hypothesis(&problem, &coefficients, &initial, noise);
    (problem, fit)
}

/// Linearised loss of log likelihood when some coefficients are switched off.
fn linear_loss(stage: &Stage, coefficients: &[usize]) -> f64 {
    let system = &stage.screening.system;
    let others: Vec<usize> = stage
        .fit
        .coefficients
        .iter()
        .filter(|coefficient| !coefficients.contains(coefficient))
        .flat_map(|coefficient| system.unknowns(*coefficient))
        .collect();
    let Some(projection) = Projection::over_all(system, &others) else {
        return 0.0;
    };
    // A product of a size and a shape would count twice on the linearised problem.
    let all = &stage.problem.candidates.coefficients;
    let sizes = coefficients
        .iter()
        .copied()
        .filter(|coefficient| !all[*coefficient].is_shape());
    let sizes: Vec<usize> = sizes.collect();
    let unknowns: Vec<usize> = sizes.iter().flat_map(|k| system.unknowns(*k)).collect();
    let step = system.step(&unknowns, &sizes, |coefficient, recording| {
        let off = stage.problem.candidates[coefficient].off();
        stage.fit.solution.coefficients[recording][coefficient] - off
    });
    let matrix = projection.of(&unknowns).matrix;
    0.5 * step.dot(&(matrix * &step))
}

#[cfg(test)]
mod tests {
    use super::super::accepted::Rival;
    use super::*;
    use crate::diagnosis::Subject;
    use crate::diagnosis::hypothesis::candidate::CandidateParameter;
    use crate::diagnosis::testing::{driven, on, refitted};
    use crate::effects::{CATALOGUE, ParameterName};

    use crate::vehicle::Specification;

    /// What remains of an effect with these parameters and gain on a drive of this model, and the coefficients that
    /// are on. Its neighbours are likelier than its formula by `shape`.
    fn remaining(
        truth: &Specification,
        names: &[&str],
        gain: f64,
        shape: f64,
    ) -> (Vec<AcceptedEffect>, Vec<String>) {
        let nominal = on("sandy_loam");
        let recordings = [driven(truth, "spiral")];
        let (mut stage, noise) = refitted(&nominal, &recordings);
        let all = stage.problem.candidates.coefficients.clone();
        let whole = |coefficient: &CandidateParameter| {
            format!(
                "{}.{}",
                CATALOGUE[coefficient.effect].name, coefficient.name
            )
        };
        let named = |name: &&str| {
            all.iter()
                .position(|coefficient| whole(coefficient) == *name)
                .unwrap()
        };
        let coefficients: Vec<usize> = names.iter().map(named).collect();
        let is_residual = names[0].starts_with("residual_");
        let subject = if is_residual {
            Subject::Unknown
        } else {
            Subject::Effect(all[coefficients[0]].effect)
        };
        stage.fit =
            fit_hypothesis(&stage.problem, &coefficients, &stage.fit.solution, &noise).unwrap();
        let proposal = Proposal {
            stability: vec![1.0; if is_residual { coefficients.len() } else { 0 }],
            evidence: gain,
            ..Proposal::new(subject, coefficients)
        };
        let rivals = vec![Rival::new(subject, gain)];
        let mut accepted = vec![AcceptedEffect {
            proposal,
            gain,
            rivals,
            mends: false,
        }];
        stage.fit.shape_gain = shape;
        prune(&mut stage, &mut accepted, &noise, 1.0);
        let on = stage
            .fit
            .coefficients
            .iter()
            .map(|coefficient| whole(&all[*coefficient]));
        (accepted, on.collect())
    }

    #[test]
    fn what_gained_by_another_soil_alone_is_left_out() {
        let plain = on("sandy_loam");
        let ratio = "left_right_soil.ratio";
        let (accepted, coefficients) = remaining(&plain, &[ratio], 26.0, 0.0);
        assert!(accepted.is_empty() && coefficients.is_empty());
        // Another formula may explain what the catalogue's does not.
        let (accepted, _) = remaining(&plain, &[ratio], 26.0, 100.0);
        assert!(accepted[0].gain > 80.0, "{}", accepted[0].gain);
        let mut truth = plain;
        let name = ParameterName::find(ratio).unwrap();
        truth.effects.set(name, 0.6).unwrap();
        let gain = 1e6;
        let (accepted, coefficients) = remaining(&truth, &[ratio], gain, 0.0);
        assert!(accepted.len() == 1 && !coefficients.is_empty());
        // No later effect may explain a part of it.
        assert_eq!(accepted[0].gain, gain);
    }

    #[test]
    fn terms_of_a_law_that_are_not_sure_are_left_out() {
        let mut truth = on("sandy_loam");
        let terms = [
            "residual_longitudinal.constant",
            "residual_yaw.speed_squared",
        ];
        let pull = ParameterName::find(terms[0]).unwrap();
        truth.effects.set(pull, 0.03).unwrap();
        let (accepted, coefficients) = remaining(&truth, &terms, 1e6, 0.0);
        assert_eq!(coefficients, terms[..1]);
        assert_eq!(accepted[0].proposal.coefficients.len(), 1);
        assert_eq!(accepted[0].proposal.stability.len(), 1);
        assert!(accepted[0].gain > 20.0);
    }
}
