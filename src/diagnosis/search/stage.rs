//! A hypothesis with everything that is known around it: what it leaves over, what may be missing,
//! how it predicts.

use super::given_soil::seen_from_given_soil;
use super::proposal::{Proposal, ScreenedCandidate, hidden, proposals, screened, shortlist};
use super::view::View;
use crate::diagnosis::hypothesis::held_out::{Scores, scores};
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, fit_restarted};
use crate::diagnosis::hypothesis::subsample::Subsample;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::diagnosis::screening::noise;
use crate::diagnosis::screening::screen::chance;
use crate::diagnosis::screening::sensitivity::{Layout, sensitivities};
use crate::diagnosis::screening::system::{System, linearise, weigh};
use crate::diagnosis::screening::wrench::{LatentWrench, latent_wrench};
use crate::diagnosis::{DiagnosisError, Options, Progress};
use crate::fit::problem::NoiseModel;
use std::sync::Arc;
use std::time::Duration;

/// What a candidate looked like under the refitted model.
#[derive(Debug, Clone)]
pub struct Screening {
    /// What the screen saw.
    pub screened: Vec<ScreenedCandidate>,
    /// The largest chi-square that chance alone gives.
    pub threshold: f64,
    /// The linearised problem.
    pub system: Arc<System>,
    /// A latent wrench; `None` also where there was no time to look for it.
    pub latent_wrench: Option<LatentWrench>,
    /// How long it took.
    pub took: Duration,
}

/// Draws of simulated nulls, and the share of them below the threshold.
const NULLS: usize = 500;
const SHARE: f64 = 0.95;
/// A soil that moves by more than this share of its prior's deviation is screened again.
const MOVED: f64 = 0.02;
/// A start that moves by more than this is screened again: pose \[m, m, rad\], then velocities.
const ASTRAY: [f64; 6] = [0.2, 0.2, 0.05, 0.1, 0.1, 0.1];

/// A hypothesis and everything that is known with it inside.
#[derive(Debug, Clone)]
pub struct Stage<'a> {
    /// The given model with the places of what is on.
    pub problem: Problem<'a>,
    /// The hypothesis, fitted.
    pub fit: FittedHypothesis,
    /// What everything else looks like beside it.
    pub screening: Arc<Screening>,
    /// What may be missing.
    pub proposals: Vec<Proposal>,
    /// How it predicts what it was not fitted to.
    pub scores: Option<Scores>,
}

/// Looks at everything around a hypothesis; noise and weights move along. Beside nothing yet, effects that
/// the refit of the soil may hide are among the proposals.
///
/// # Errors
/// The caller wants it to end, the hypothesis' deadline has passed (noise and weights are then as before), numbers that are
/// not finite.
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
        // Both at once would be most of what a diagnosis needs of memory.
        drop(tables);
        tables = sensitivities(&problem, &layout, &at);
    } else if let Some(part) = strayed(&at, &again.solution) {
        for place in part.places() {
            at.starts[*place] = again.solution.starts[*place];
        }
        let anew = sensitivities(&part.problem(&problem), &layout, &part.solution(&at));
        for (place, table) in part.places().iter().zip(anew) {
            tables[*place] = table;
        }
    }
    in_time()?;
    let system = linearise(&problem, &layout, &tables, &at, &own);
    drop(tables);
    in_time()?;
    let view = View::new(&problem, &system, &on, &own).ok_or(DiagnosisError::NotFinite)?;
    progress.step("screening and scanning for regions")?;
    let screened = screened(&view);
    let equations: Vec<_> = screened.iter().map(|one| one.projected.clone()).collect();
    let threshold = chance(&view.projection, &equations, SHARE, NULLS, options.seed);
    let soil = &again.solution.soil;
    let seed = options.seed;
    let all = proposals(&view, &screened, soil, seed);
    in_time()?;
    let mut proposals: Vec<Proposal> = shortlist(&all).into_iter().cloned().collect();
    let latent_wrench = latent_wrench(&problem, &system);
    let took = progress.elapsed().saturating_sub(began);
    if on.is_empty() {
        proposals.extend(hidden(&view, &screened));
        if !progress.lacks(took) {
            let further = seen_from_given_soil(&problem, &again, &own, &proposals, seed);
            in_time()?;
            proposals.extend(further);
        }
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

/// As [`screen`] after another look. Where time is up, the hypothesis stands as it was fitted, and nothing is known of what
/// is left over beside it.
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

/// How far the soil moved, in standard deviations of its prior.
fn moved(problem: &Problem, from: &Solution, to: &Solution) -> f64 {
    let scales = problem.soil_parameters();
    let pairs = from.soil.iter().zip(&to.soil).zip(&scales);
    let each = pairs.map(|((a, b), scale)| (a - b).abs() / scale.prior.deviation);
    each.fold(0.0, f64::max)
}

/// The segments whose start was found elsewhere: what it leaves over there is another thing.
fn strayed(from: &Solution, to: &Solution) -> Option<Subsample> {
    let pairs = from.starts.iter().zip(&to.starts).enumerate();
    let strayed = pairs.filter(|(_, (a, b))| {
        let mut each = a.iter().zip(b.iter()).zip(ASTRAY);
        each.any(|((a, b), limit)| (a - b).abs() > limit)
    });
    let places = strayed.map(|(place, _)| place).collect();
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
        assert!(strayed(&before, &before).is_none());
        let mut after = before.clone();
        after.starts[0][0] = 0.1;
        after.starts[1][4] = -0.3;
        assert_eq!(strayed(&before, &after).unwrap().places(), [1]);
    }
}
