//! One thing after another: what is missing, and what else.
//!
//! Each round looks at everything with what was found so far inside (step 7: what is left over after
//! the winner decides whether the winner is adequate), and ends when nothing more is worth it.

use super::held_out::{Scores, scores};
use super::hypothesis::{Given, Solution};
use super::likelihood::{Tuned, tune, tune_with_noise};
use super::naming::{Named, Sketch, finish, sketch};
use super::noise;
use super::proposal::{Kind, Proposal, Screened, hidden, proposals, screened, shortlist};
use super::screen::{Projection, chance};
use super::sensitivity::{Layout, sensitivities};
use super::system::{System, linearise, weigh};
use super::wrench::{Wandering, wandering};
use super::{DiagnosisError, Options, Progress, Subject};
use crate::fit::predictor::PredictionError;
use crate::fit::problem::Weighing;
use std::sync::Arc;

/// Something that was found.
#[derive(Debug, Clone)]
pub struct Member {
    /// What was proposed.
    pub proposal: Proposal,
    /// Log Bayes factor against the hypothesis without it.
    pub gain: f64,
    /// What else was fitted in its place, with log Bayes factors and priors.
    pub rivals: Vec<(Subject, f64)>,
}

/// What a candidate looked like under the re-tuned model.
#[derive(Debug, Clone)]
pub struct Looked {
    /// What the screen saw.
    pub screened: Vec<Screened>,
    /// The largest chi-square that chance alone gives.
    pub threshold: f64,
    /// The linearised problem.
    pub system: System,
    /// A wrench that comes and goes.
    pub wandering: Option<Wandering>,
}

/// Where the search ended.
#[derive(Debug)]
pub struct Searched<'a> {
    /// The given model.
    pub given: Given<'a>,
    /// Noise and weights.
    pub by: Weighing,
    /// The re-tuned model under the same noise.
    pub retuned: Tuned,
    /// The model with everything found.
    pub augmented: Tuned,
    /// The given model with the places of what was found.
    pub placed: Given<'a>,
    /// What was found.
    pub members: Vec<Member>,
    /// What was fitted and not taken in the last round, with log Bayes factors and priors.
    pub refused: Vec<(Subject, f64)>,
    /// Held-out gains of what was fitted first, by subject.
    pub gains: Vec<(Subject, (f64, f64))>,
    /// Whether there is enough to hold some of it out; without that nothing is named.
    pub tested: bool,
    /// Under the re-tuned model.
    pub first: Arc<Looked>,
    /// With everything found.
    pub last: Arc<Looked>,
}

/// Rounds at most.
const ROUNDS: usize = 4;
/// Log odds that something must have over nothing more, its prior counted.
pub const TAKE: f64 = 0.5;
/// Logarithm of the prior of nothing (more) over that of one effect of the catalogue.
pub const NOTHING: f64 = 3.0;
/// Draws of simulated nulls, and the share of them below the threshold.
const NULLS: usize = 500;
const SHARE: f64 = 0.95;
/// Fits that are further behind after their first steps are not finished.
const NEAR: f64 = 0.75;
const CLOSE: f64 = 5.0;
/// At most so many are finished.
const MOST: usize = 7;
/// What would cost so many times its price by the linearised problem stays without a further look.
const SURELY: f64 = 3.0;
/// A soil that moves by more than this share of its prior's deviation is looked at anew.
const MOVED: f64 = 0.02;

/// A hypothesis and everything that is known with it inside.
struct Stage<'a> {
    given: Given<'a>,
    tuned: Tuned,
    looked: Arc<Looked>,
    proposals: Vec<Proposal>,
    scores: Option<Scores>,
}

/// Searches.
///
/// # Errors
/// A model that cannot even begin, numbers that are not finite.
pub fn search<'a>(
    given: &Given<'a>,
    mut by: Weighing,
    options: &Options,
    progress: &Progress,
) -> Result<Searched<'a>, DiagnosisError> {
    progress.step("re-tuning the soil");
    let begin = given.begin();
    let undrivable = DiagnosisError::Undrivable;
    let retuned = tune_with_noise(given, &[], &begin, &mut by).map_err(undrivable)?;
    let mut stage = look(given.clone(), retuned, &mut by, options, progress)?;
    let first = Arc::clone(&stage.looked);
    let tested = stage.scores.is_some();
    let baseline = stage.tuned.solution.clone();
    let (mut members, mut refused, mut gains): (Vec<Member>, _, Vec<_>) =
        (Vec::new(), Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        progress.step(if round == 0 { "naming" } else { "what else" });
        let fitted = try_all(&stage, round == 0, &by);
        let held_out = |named: &Named| {
            let pair = named.scores.as_ref().zip(stage.scores.as_ref());
            pair.map(|(with, without)| with.gain_over(without))
        };
        if round == 0 {
            let each = fitted.iter();
            gains = each
                .filter_map(|n| Some((n.proposal.subject, held_out(n)?)))
                .collect();
        }
        let odds = |named: &Named| named.gain + named.proposal.log_prior();
        let rivals: Vec<(Subject, f64)> = fitted
            .iter()
            .map(|n| (n.proposal.subject, odds(n)))
            .collect();
        let sound = |named: &&Named| held_out(named).is_some_and(|(mean, error)| mean > -error);
        let best = fitted
            .iter()
            .filter(sound)
            .max_by(|a, b| odds(a).total_cmp(&odds(b)));
        let Some(best) = best.filter(|n| odds(n) > NOTHING + TAKE) else {
            refused = rivals;
            break;
        };
        members.push(Member {
            proposal: best.proposal.clone(),
            gain: best.gain,
            rivals,
        });
        let (placed, tuned) = (best.given.clone(), best.tuned.clone());
        stage = look(placed, tuned, &mut by, options, progress)?;
    }
    progress.step("what can be left out again");
    prune(&mut stage, &mut members, &by);
    let retuned = tune_again(given, &baseline, &stage.tuned.solution, &by).map_err(undrivable)?;
    Ok(Searched {
        given: given.clone(),
        by,
        retuned,
        placed: stage.given,
        augmented: stage.tuned,
        members,
        refused,
        gains,
        tested,
        first,
        last: stage.looked,
    })
}

/// The re-tuned model under the noise and weights at the end, its starts as they have become. On
/// some soils not every start can be driven: then those that it had.
fn tune_again(
    given: &Given,
    baseline: &Solution,
    last: &Solution,
    by: &Weighing,
) -> Result<Tuned, PredictionError> {
    let mut begin = back(given, last);
    begin.soil.clone_from(&baseline.soil);
    tune(given, &[], &begin, by).or_else(|_| tune(given, &[], baseline, by))
}

/// Fits what is worth it: all begin, and those that are not far behind after some steps are finished.
/// At first, effects that re-tuning may hide are among them.
fn try_all<'a>(stage: &Stage<'a>, first: bool, by: &Weighing) -> Vec<Named<'a>> {
    let mut list: Vec<Proposal> = shortlist(&stage.proposals).into_iter().cloned().collect();
    if first {
        list.extend(hidden(&stage.given, &stage.looked.screened));
    }
    let begun = list
        .iter()
        .filter_map(|proposal| sketch(&stage.given, proposal, &stage.tuned, by));
    let mut begun: Vec<Sketch> = begun.collect();
    begun.sort_by(|a, b| b.odds().total_cmp(&a.odds()));
    let best = begun.first().map_or(0.0, |sketch| sketch.odds().max(0.0));
    begun
        .into_iter()
        .take(MOST)
        .filter(|sketch| sketch.odds() > NEAR * best - CLOSE)
        .filter_map(|sketch| finish(sketch, &stage.tuned, by))
        .collect()
}

/// Looks at everything around a hypothesis; noise and weights move along.
fn look<'a>(
    given: Given<'a>,
    tuned: Tuned,
    by: &mut Weighing,
    options: &Options,
    progress: &Progress,
) -> Result<Stage<'a>, DiagnosisError> {
    progress.step("sensitivities to every candidate");
    let on = tuned.knobs.clone();
    let layout = Layout::new(&given, &on);
    let tables = sensitivities(&given, &layout, &tuned.solution);
    weigh(&given, &on, &tuned.tables, by);
    let system = linearise(&given, &layout, &tables, &tuned.solution, by);
    progress.step("noise");
    noise::update(&given, &system, &tables, &tuned.solution, by);
    progress.step("re-tuning the soil");
    let again = tune(&given, &on, &tuned.solution, by).map_err(DiagnosisError::Undrivable)?;
    progress.step("sensitivities to every candidate");
    let system = if moved(&given, &tuned.solution, &again.solution) > MOVED {
        let tables = sensitivities(&given, &layout, &again.solution);
        linearise(&given, &layout, &tables, &again.solution, by)
    } else {
        linearise(&given, &layout, &tables, &tuned.solution, by)
    };
    let further: Vec<usize> = on.iter().flat_map(|k| system.unknowns(*k)).collect();
    let projection = Projection::over_all(&system, &further).ok_or(DiagnosisError::NotFinite)?;
    progress.step("screening and locating");
    let screened = screened(&given, &system, &projection, &on);
    let equations: Vec<_> = screened.iter().map(|one| one.projected.clone()).collect();
    let threshold = chance(&projection, &equations, SHARE, NULLS, options.seed);
    let soil = &again.solution.soil;
    let seed = options.seed;
    let proposals = proposals(&given, &system, &projection, &screened, &on, soil, seed);
    let wandering = wandering(&given, &system);
    let scores = scores(&given, &again, by);
    Ok(Stage {
        looked: Arc::new(Looked {
            screened,
            threshold,
            system,
            wandering,
        }),
        proposals,
        scores,
        tuned: again,
        given,
    })
}

/// How far the soil moved, in standard deviations of its prior.
fn moved(given: &Given, from: &Solution, to: &Solution) -> f64 {
    let scales = given.soil_parameters();
    let pairs = from.soil.iter().zip(&to.soil).zip(&scales);
    let each = pairs.map(|((a, b), scale)| (a - b).abs() / scale.prior.deviation);
    each.fold(0.0, f64::max)
}

/// Leaves out what the rest explains without it.
fn prune(stage: &mut Stage, members: &mut Vec<Member>, by: &Weighing) {
    let mut index = 0;
    while members.len() > 1 && index < members.len() {
        let gone = &members[index].proposal;
        let knobs = stage.tuned.knobs.iter().copied();
        let knobs: Vec<usize> = knobs.filter(|k| !gone.knobs.contains(k)).collect();
        let mut given = stage.given.clone();
        if gone.kind() == Kind::Local {
            given.nominal.effects.window = None;
        }
        let mut begin = stage.tuned.solution.clone();
        for recording in &mut begin.knobs {
            for knob in &gone.knobs {
                recording[*knob] = given.candidates.knobs[*knob].parameter.prior_coordinate();
            }
        }
        let price = NOTHING - gone.log_prior() + gone.looking;
        if linear_loss(stage, &gone.knobs) > SURELY * price + CLOSE {
            index += 1;
            continue;
        }
        let without = tune(&given, &knobs, &begin, by);
        match without {
            Ok(without) if without.surprise - stage.tuned.surprise < price => {
                members.remove(index);
                stage.given = given;
                stage.tuned = without;
                index = 0;
            }
            Ok(without) => {
                members[index].gain = without.surprise - stage.tuned.surprise - gone.looking;
                index += 1;
            }
            Err(_) => index += 1,
        }
    }
}

/// What switching some knobs off costs of the log likelihood by the linearised problem.
fn linear_loss(stage: &Stage, knobs: &[usize]) -> f64 {
    let system = &stage.looked.system;
    let others: Vec<usize> = stage
        .tuned
        .knobs
        .iter()
        .filter(|knob| !knobs.contains(knob))
        .flat_map(|knob| system.unknowns(*knob))
        .collect();
    let Some(projection) = Projection::over_all(system, &others) else {
        return 0.0;
    };
    let unknowns: Vec<usize> = knobs.iter().flat_map(|k| system.unknowns(*k)).collect();
    let mut step = nalgebra::DVector::zeros(unknowns.len());
    for (place, unknown) in unknowns.iter().enumerate() {
        for (recording, places) in system.places.iter().enumerate() {
            for knob in knobs {
                if places[system.layout.soil + knob] == Some(*unknown) {
                    let off = stage.given.candidates.knobs[*knob]
                        .parameter
                        .prior_coordinate();
                    step[place] = stage.tuned.solution.knobs[recording][*knob] - off;
                }
            }
        }
    }
    let matrix = projection.of(&unknowns).matrix;
    0.5 * step.dot(&(matrix * &step))
}

/// A solution with every effect off.
fn back(given: &Given, solution: &Solution) -> Solution {
    let mut back = solution.clone();
    for recording in &mut back.knobs {
        for (value, knob) in recording.iter_mut().zip(&given.candidates.knobs) {
            *value = knob.parameter.prior_coordinate();
        }
    }
    back
}
