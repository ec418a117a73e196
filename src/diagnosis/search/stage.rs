//! A hypothesis with its screening, its proposals and its held-out score.

use super::proposal::{Proposal, ScreenedCandidate, hidden, proposals, screened, shortlist};
use super::view::View;
use crate::diagnosis::hypothesis::held_out::{Scores, scores};
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, fit_restarted};
use crate::diagnosis::hypothesis::subsample::Subsample;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::diagnosis::screening::noise;
use crate::diagnosis::screening::screen::chance;
use crate::diagnosis::screening::sensitivity::{Layout, sensitivities};
use crate::diagnosis::screening::shape;
use crate::diagnosis::screening::system::{System, linearise, weigh};
use crate::diagnosis::screening::wrench::{LatentWrench, latent_wrench};
use crate::diagnosis::{DiagnosisError, Options, Progress};
use crate::fit::problem::NoiseModel;
use std::sync::Arc;
use std::time::Duration;

/// The screening beside a hypothesis.
#[derive(Debug, Clone)]
pub struct Screening {
    /// The screened candidates.
    pub screened: Vec<ScreenedCandidate>,
    /// Threshold of chi-square, from simulated nulls.
    pub threshold: f64,
    /// The linearised problem.
    pub system: Arc<System>,
    /// A latent wrench; `None` also without time for it.
    pub latent_wrench: Option<LatentWrench>,
    /// Duration.
    pub took: Duration,
}

/// Number of simulated nulls, and the quantile of the threshold.
const NULLS: usize = 500;
const SHARE: f64 = 0.95;
/// Sensitivities are repeated if the soil moves by this share of its prior's deviation.
const MOVED: f64 = 0.02;
/// Sensitivities of a segment are repeated if its start moves by this: pose \[m, m, rad\], then velocities.
const MOVED_START: [f64; 6] = [0.2, 0.2, 0.05, 0.1, 0.1, 0.1];

/// A hypothesis and its screening.
#[derive(Debug, Clone)]
pub struct Stage<'a> {
    /// The given model with the regions of accepted effects.
    pub problem: Problem<'a>,
    /// The hypothesis, fitted.
    pub fit: FittedHypothesis,
    /// The screening beside it.
    pub screening: Arc<Screening>,
    /// Proposals of missing effects.
    pub proposals: Vec<Proposal>,
    /// Its held-out score.
    pub scores: Option<Scores>,
}

/// Screens beside a hypothesis, and updates noise and weights. Without accepted effects the proposals include those that
/// the refit of the soil may hide.
///
/// # Errors
/// A stop by the caller, the hypothesis' deadline (noise and weights are then as before), or numbers that are not finite.
pub fn screen<'a>(
    problem: Problem<'a>,
    fit: FittedHypothesis,
    noise: &mut NoiseModel,
    options: &Options,
    progress: &Progress,
) -> Result<Stage<'a>, DiagnosisError> {
    progress.step("sensitivities to every candidate")?;
    let began = progress.elapsed();
    let in_time = || progress.in_time(problem.deadline);
    let mut own = noise.clone();
    let on = fit.coefficients.clone();
    let layout = Layout::new(&problem, &on);
    let mut tables = sensitivities(&problem, &layout, &fit.solution);
    in_time()?;
    weigh(&problem, &on, &fit.tables, &mut own);
    progress.step("estimating the noise")?;
    let system = linearise(&problem, &layout, &tables, &fit.solution, &own);
    in_time()?;
    noise::update(&problem, &system, &tables, &fit.solution, &mut own);
    drop(system);
    in_time()?;
    progress.step("refitting the soil")?;
    let again = fit_restarted(&problem, &fit, &own);
    in_time()?;
    progress.step("sensitivities to every candidate")?;
    let mut at = fit.solution.clone();
    if moved(&problem, &at, &again.solution) > MOVED {
        at = again.solution.clone();
        // Both tables at once would need most of the memory of a diagnosis.
        drop(tables);
        tables = sensitivities(&problem, &layout, &at);
    } else if let Some(part) = moved_starts(&at, &again.solution) {
        for place in part.places() {
            at.starts[*place] = again.solution.starts[*place];
        }
        let anew = sensitivities(&part.problem(&problem), &layout, &part.solution(&at));
        for (place, table) in part.places().iter().zip(anew) {
            tables[*place] = table;
        }
    }
    in_time()?;
    let mut system = linearise(&problem, &layout, &tables, &at, &own);
    drop(tables);
    in_time()?;
    let shapes = shape::append(&problem, &on, &at, &mut system);
    let further: Vec<usize> = on.iter().flat_map(|k| system.unknowns(*k)).collect();
    let mut again = again;
    again.shape_gain = shapes.gain(&system, &further);
    let view = View::new(&problem, &system, &on, &shapes, &own).ok_or(DiagnosisError::NotFinite)?;
    progress.step("screening and scanning for regions")?;
    let screened = screened(&view);
    let equations: Vec<_> = screened.iter().map(|one| one.projected.clone()).collect();
    let threshold = chance(&view.projection, &equations, SHARE, NULLS, options.seed);
    let soil = &again.solution.soil;
    let seed = options.seed;
    let all = proposals(&view, &screened, soil, seed);
    in_time()?;
    let mut proposals: Vec<Proposal> = shortlist(&all).into_iter().cloned().collect();
    let latent_wrench = match shapes.followed(&system, &further) {
        Some(shaped) => latent_wrench(&problem, &shaped),
        None => latent_wrench(&problem, &system),
    };
    let took = progress.elapsed().saturating_sub(began);
    if on.is_empty() {
        proposals.extend(hidden(&view, &screened));
    }
    let scores = scores(&problem, &again, &own);
    *noise = own;
    Ok(Stage {
        screening: Arc::new(Screening {
            screened,
            threshold,
            system: Arc::new(system),
            latent_wrench,
            took,
        }),
        proposals,
        scores,
        fit: again,
        problem,
    })
}

/// As [`screen`] after an earlier screening. At the deadline the hypothesis stays as it was fitted, without proposals.
///
/// # Errors
/// The caller wants it to end, numbers that are not finite.
pub fn screen_again<'a>(
    before: &Arc<Screening>,
    problem: Problem<'a>,
    fit: FittedHypothesis,
    noise: &mut NoiseModel,
    options: &Options,
    progress: &Progress,
) -> Result<Stage<'a>, DiagnosisError> {
    if progress.limit().is_none() {
        return screen(problem, fit, noise, options, progress);
    }
    if !progress.lacks(before.took) {
        match screen(problem.clone(), fit.clone(), noise, options, progress) {
            Err(DiagnosisError::OutOfTime) => {}
            screening => return screening,
        }
    }
    Ok(Stage {
        problem,
        fit,
        screening: Arc::new(Screening {
            latent_wrench: None,
            ..before.as_ref().clone()
        }),
        proposals: Vec::new(),
        scores: None,
    })
}

/// Movement of the soil, in standard deviations of its prior.
fn moved(problem: &Problem, from: &Solution, to: &Solution) -> f64 {
    let scales = problem.soil_parameters();
    let pairs = from.soil.iter().zip(&to.soil).zip(&scales);
    let each = pairs.map(|((a, b), scale)| (a - b).abs() / scale.prior.deviation);
    each.fold(0.0, f64::max)
}

/// The segments whose start has moved: their residuals differ.
fn moved_starts(from: &Solution, to: &Solution) -> Option<Subsample> {
    let pairs = from.starts.iter().zip(&to.starts).enumerate();
    let moved_starts = pairs.filter(|(_, (a, b))| {
        let mut each = a.iter().zip(b.iter()).zip(MOVED_START);
        each.any(|((a, b), limit)| (a - b).abs() > limit)
    });
    let places = moved_starts.map(|(place, _)| place).collect();
    Subsample::some(places, from.starts.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_whose_start_was_found_elsewhere_are_looked_at_anew() {
        let before = Solution {
            soil: Vec::new(),
            coefficients: Vec::new(),
            starts: vec![[0.0; 6]; 3],
        };
        assert!(moved_starts(&before, &before).is_none());
        let mut after = before.clone();
        after.starts[0][0] = 0.1;
        after.starts[1][4] = -0.3;
        assert_eq!(moved_starts(&before, &after).unwrap().places(), [1]);
    }
}
