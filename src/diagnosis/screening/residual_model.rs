//! Empirical residual models: forces outside the catalogue as functions of the motion.
//!
//! A sparse regression on dimensionless features of the motion (the effects `residual_longitudinal`,
//! `residual_lateral`, `residual_yaw`), not of differentiated positions but of the predictions themselves. Features
//! are added one by one while the evidence grows by more than the choice among all features costs. A feature's
//! stability is the share of bootstrap samples of the segments in which it is selected (N. Meinshausen & P. Buhlmann,
//! "Stability selection", J. R. Stat. Soc. B 72 (2010)). The selected model is then refitted inside the motion.

use super::identifiable::Accepted;
use super::screen::Projection;
use super::system::System;
use crate::diagnosis::Channel;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::candidate::is_residual_model;
use crate::effects::{Acts, Axis, CATALOGUE};
use rayon::prelude::*;

/// A residual model of few terms.
#[derive(Debug, Clone)]
pub struct ResidualModel {
    /// Its coefficients, the strongest first.
    pub coefficients: Vec<usize>,
    /// Share of resampled data in which each was chosen.
    pub stability: Vec<f64>,
    /// Log Bayes factor, less the cost of the choice.
    pub evidence: f64,
}

/// Terms at most.
const MOST_TERMS: usize = 3;
/// Draws of the segments.
const DRAWS: usize = 40;
/// A further term must raise the evidence by more than this.
const WORTH: f64 = 3.0;

/// The residual model with the largest evidence beyond soil and the coefficients that are on, which are projected out.
/// Accepted effects of the catalogue keep their sizes beside it.
#[must_use]
pub fn residual_model(
    problem: &Problem,
    system: &System,
    on: &[usize],
    projection: &Projection,
    seed: u64,
) -> Option<ResidualModel> {
    let nuisance = projection.nuisance();
    let named = on
        .iter()
        .filter(|k| !is_residual_model(problem.candidates[**k].effect));
    let named = named.flat_map(|k| system.unknowns(*k));
    let is_off = |coefficient: &usize| {
        system
            .unknowns(*coefficient)
            .iter()
            .all(|u| !nuisance.contains(u))
    };
    // A feature of a windowed effect would act in that window only.
    let effects = &problem.nominal.effects;
    let confined =
        |coefficient: &usize| effects.is_windowed(problem.candidates[*coefficient].effect);
    let coefficients = problem.candidates.residual_models();
    let coefficients: Vec<usize> = coefficients.filter(|k| is_off(k) && !confined(k)).collect();
    let all: Vec<usize> = (0..system.segments.len()).collect();
    let choice = Choice {
        system,
        coefficients: &coefficients,
        whole: projection,
        accepted: Accepted::new(system, projection, named),
    };
    let (chosen, evidence) = choice.select(&all, MOST_TERMS)?;
    let mut random = fastrand::Rng::with_seed(seed);
    let draws: Vec<Vec<usize>> = (0..DRAWS)
        .map(|_| {
            let mut draw: Vec<usize> = all.iter().map(|_| random.usize(0..all.len())).collect();
            draw.sort_unstable();
            draw
        })
        .collect();
    let again = |draw: &Vec<usize>| {
        if problem.deadline.is_over() {
            return None;
        }
        choice.select(draw, chosen.len())
    };
    let again: Vec<_> = draws.par_iter().map(again).collect();
    let chosen_again = |coefficient: &usize| {
        let found = again
            .iter()
            .flatten()
            .filter(|(set, _)| set.contains(coefficient));
        found.count() as f64 / DRAWS as f64
    };
    Some(ResidualModel {
        stability: chosen.iter().map(chosen_again).collect(),
        coefficients: chosen,
        evidence,
    })
}

/// The choice of terms.
struct Choice<'a> {
    system: &'a System,
    coefficients: &'a [usize],
    /// Over all segments.
    whole: &'a Projection<'a>,
    accepted: Accepted,
}

impl Choice<'_> {
    /// Takes terms one by one. `None` where not even one is worth it.
    fn select(&self, segments: &[usize], max_terms: usize) -> Option<(Vec<usize>, f64)> {
        let projection = Projection::new(self.system, self.whole.nuisance(), segments)?;
        let (mut chosen, mut best): (Vec<usize>, f64) = (Vec::new(), 0.0);
        // Logarithm of the number of sets of so many terms.
        let mut price = 0.0;
        while chosen.len() < max_terms {
            let with = |coefficient: &usize| {
                let set: Vec<usize> = chosen
                    .iter()
                    .chain(std::iter::once(coefficient))
                    .copied()
                    .collect();
                let unknowns: Vec<usize> =
                    set.iter().flat_map(|k| self.system.unknowns(*k)).collect();
                let score = projection.score_with(&projection.of(&unknowns), 1.0);
                let keeps = self.accepted.keep_sizes_beside(self.whole, &unknowns);
                keeps.then_some((*coefficient, score.evidence))
            };
            let remaining = self.coefficients.iter();
            let remaining = remaining.filter(|coefficient| !chosen.contains(coefficient));
            let next = remaining.filter_map(with);
            let Some(next) = next.max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            let count = self.coefficients.len() - chosen.len();
            price += (count as f64 / (chosen.len() + 1) as f64).ln();
            let evidence = next.1 - price;
            if evidence < best + WORTH {
                break;
            }
            chosen.push(next.0);
            best = evidence;
        }
        (!chosen.is_empty()).then_some((chosen, best))
    }
}

/// The dimensionless group that a residual model's coefficient multiplies, as its effect's equation has it:
/// `|u| q` for `speed_turning`, 1 for a constant.
#[must_use]
pub fn group(effect: usize, name: &str) -> String {
    let equation = CATALOGUE[effect].equation;
    let sum = equation
        .split_once('(')
        .and_then(|(_, rest)| rest.split_once("), "))
        .map_or("", |(sum, _)| sum);
    let terms = sum.replace(" - ", " + -");
    let symbols = terms.split(" + ").find_map(|term| {
        let (sign, term) = term
            .strip_prefix('-')
            .map_or(("", term), |rest| ("-", rest));
        let (own, symbols) = term.split_once(' ')?;
        (own == name).then(|| format!("{sign}{symbols}"))
    });
    symbols.unwrap_or_else(|| "1".into())
}

/// The component of the wrench that a feature adds to.
#[must_use]
pub fn channel(effect: usize) -> Channel {
    match CATALOGUE[effect].acts {
        Acts::Residual(Axis::Longitudinal) => Channel::Longitudinal,
        Acts::Residual(Axis::Lateral) => Channel::Lateral,
        _ => Channel::Yaw,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::testing::{driven, on, refitted, with_effects};

    #[test]
    fn a_residual_model_leaves_an_accepted_effect_its_size() {
        let nominal = on("sandy_loam");
        let truth = with_effects(&nominal, r#"{"drag": {"coefficient": 150}}"#);
        let recordings = [driven(&truth, "slalom")];
        let (stage, _) = refitted(&nominal, &recordings);
        let (problem, system) = (&stage.problem, stage.screening.system.as_ref());
        let find = |name: &str| problem.candidates.find(name).unwrap();
        let drag = find("drag.coefficient");
        let along = ["speed", "speed_squared"];
        let along = along.map(|name| find(&format!("residual_longitudinal.{name}")));
        let repeats = |on: &[usize], projection: &Projection| {
            let found = residual_model(problem, system, on, projection, 1);
            found.is_some_and(|found| found.coefficients.iter().any(|k| along.contains(k)))
        };
        let soil_alone = Projection::over_all(system, &[]).unwrap();
        assert!(repeats(&[], &soil_alone));
        let unknowns = system.unknowns(drag);
        let beside = Projection::over_all(system, &unknowns).unwrap();
        assert!(!repeats(&[drag], &beside));
        let accepted = Accepted::new(system, &beside, unknowns.into_iter());
        let keeps = |name: &str| accepted.keep_sizes_beside(&beside, &system.unknowns(find(name)));
        assert!(!keeps("residual_longitudinal.speed_squared"));
        assert!(keeps("residual_lateral.sideways"));
        assert!(keeps("residual_yaw.constant"));
        // What the data do not determine cannot be lost: the lever of a force that is zero.
        let lever = system.unknowns(find("drawbar.hitch_behind"));
        let beside = Projection::over_all(system, &lever).unwrap();
        let accepted = Accepted::new(system, &beside, lever.into_iter());
        let term = system.unknowns(find("residual_yaw.constant"));
        assert!(accepted.keep_sizes_beside(&beside, &term));
    }

    #[test]
    fn every_term_of_a_law_has_its_group() {
        for (index, effect) in CATALOGUE.iter().enumerate() {
            if !matches!(effect.acts, Acts::Residual(_)) {
                continue;
            }
            for parameter in effect.parameters {
                let constant = parameter.name == "constant";
                assert_eq!(
                    group(index, parameter.name) == "1",
                    constant,
                    "{}",
                    parameter.name
                );
            }
        }
        let of = |effect: &str, name: &str| {
            let index = CATALOGUE.iter().position(|known| known.name == effect);
            group(index.expect("an effect"), name)
        };
        assert_eq!(of("residual_yaw", "speed_turning"), "|u| q");
        assert_eq!(of("residual_lateral", "east"), "-sin psi");
        assert_eq!(of("residual_longitudinal", "direction"), "s(V_X)");
    }
}
