//! Levenberg–Marquardt within bounds.
//!
//! Damping after H. B. Nielsen, "Damping parameter in Marquardt's method" (IMM-REP-1999-05).
//! A step is also cut where it would carry a parameter too far at once, in units of its prior:
//! beyond lie soils on which the vehicle cannot drive, and nothing is learnt from those.
//! Steps are straight in what a parameter acts by (see [`ActsBy`](super::parameter::ActsBy)): with straight steps of the
//! coordinates, a fit to a minute of driving walked along a curved valley for 65 derivative passes in place of 22.
//! Steps stay within bounds, see [`step_within`]. Where it would end, segments that stand out have their starts
//! looked for anew (see [`super::restart`]). A search ends at the predictor's deadline with the best point so far.

use super::bounded::{room, step_within};
use super::normal::{Normal, Reduced, START};
use super::predictor::{PredictionError, Predictor};
use super::problem::{NoiseModel, Point, ShootingProblem, Tables};
use super::restart::{LEAST, moved, outlying_excess, outlying_restarted, settled};
use nalgebra::DVector;
use rayon::prelude::*;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Steps at most.
    pub steps: usize,
    /// The cost, a chi-square, need not fall by more than this any further.
    pub gain: f64,
    /// A cost that is not likely to come down to this is not worth going on with.
    pub cost_ceiling: f64,
    /// Starts are looked for anew so often at most.
    pub max_restarts: usize,
    /// Damping of the first step, as a share of the diagonal.
    pub first_damping: f64,
}

impl Stop {
    /// After so many steps, or where the cost falls by less than this.
    #[must_use]
    pub const fn after(steps: usize, gain: f64) -> Self {
        Self {
            steps,
            gain,
            cost_ceiling: f64::INFINITY,
            max_restarts: RENEWALS,
            first_damping: FIRST_DAMPING,
        }
    }

    /// With low damping at first, for parameters that are known only in combination.
    #[must_use]
    pub const fn with_low_damping(mut self) -> Self {
        self.first_damping = LOW_DAMPING;
        self
    }

    /// With the starts at the end of the steps.
    #[must_use]
    pub const fn without_renewals(mut self) -> Self {
        self.max_restarts = 0;
        self
    }

    /// Or where the cost is not likely to come down to this.
    #[must_use]
    pub const fn unless_above(mut self, cost_ceiling: f64) -> Self {
        self.cost_ceiling = cost_ceiling;
        self
    }
}

/// Where the search ended.
#[derive(Debug, Clone)]
pub struct Minimum {
    /// The cost there.
    pub cost: f64,
    /// How much it fell.
    pub gain: f64,
    /// How much the next step promises.
    pub predicted_reduction: f64,
    /// Steps taken or tried.
    pub steps: usize,
    /// Whether it stopped for want of gain, not of steps.
    pub converged: bool,
    /// Residuals and derivatives there.
    pub tables: Vec<Tables>,
}

const FIRST_DAMPING: f64 = 1e-3;
/// What soil parameters share is known to some 1e-5 of their own curvature: a damping of 1e-3 walked along that valley, and
/// a fit to a noise-free drive ended at a friction angle of 28.3 deg for 29. From 0.7 standard deviations of the priors
/// with pivots, 1e-6 leads astray.
const LOW_DAMPING: f64 = 1e-6;
const LARGEST_DAMPING: f64 = 1e8;
/// How far a first step may carry a parameter, in standard deviations of its prior, and any.
const FIRST_REACH: f64 = 1.0;
const LARGEST_REACH: f64 = 3.0;
/// A step that fails although it promises a gain, but less than so many times the least one worth a step, fails for
/// rounding. Only what the parameters are promised counts: of 16 fits to dry sand and to ruts half went on for twelve
/// turns because starts, which are less linear, were promised in vain; so all converge, in half the time.
const NEARLY: f64 = 5.0;
/// A step that gains less than this share of what it promised, and less than ends a search. After two of them in succession
/// a search ends, whatever the derivatives promise: in fits under their own noise these made a fifth of all steps, for a
/// gain of 0.02 each.
const VAIN: f64 = 0.1;
const VAIN_STEPS: usize = 2;
/// So often starts are looked for anew where the search would end; it goes on, with half of the steps at least, where the
/// cost falls by this share.
const RENEWALS: usize = 2;
const RENEWED: f64 = 0.05;
/// So many steps are tried before a search is given up as hopeless.
const TRIED: usize = 3;
/// Steps below this lead nowhere.
const SMALLEST_REACH: f64 = 1e-6;

/// Derivatives serve again after a step whose gain was as expected up to this share, so many times: they cost several times
/// as much as residuals.
const LINEAR: f64 = 0.25;
/// Once a step with old derivatives has failed, they serve again only where the last one carried no parameter farther than
/// this, in standard deviations of its prior: along a valley ten of eleven such steps led up after 0.09 or more.
const SHORT: f64 = 0.05;
const CHORDS: usize = 3;

/// Where a segment costs more than the linearised problem expects, by this share of the whole expected gain, its start
/// alone is fitted to the new parameters, if that concerns half of the segments at most: else the step is too long.
const EXCESS: f64 = 0.1;
/// What such a start's derivatives promise is counted on again after a step that left less than this share of the cost: from
/// soil 0.7 standard deviations of the priors off, a fit that did not ended after twelve steps 134 units too high.
const FALLING: f64 = 0.5;

/// A step and the gain that the linearised problem expects of it.
struct Step {
    point: Point,
    expected_gain: f64,
    /// How far it carries a parameter at most, in standard deviations of its prior.
    reach: f64,
    /// The cost that the linearised problem expects of each segment.
    segment_costs: Vec<f64>,
    /// The segments whose start was fitted alone since the search began, or last left less than [`FALLING`] of the cost.
    fitted_alone: Vec<bool>,
}

/// Where the search stands.
struct Stand {
    point: Point,
    tables: Vec<Tables>,
    normals: Vec<Normal>,
    cost: f64,
    /// Steps since the derivatives were taken.
    age: usize,
    /// The segments whose start was fitted alone on the way here. What their derivatives still promise, as on one side of a
    /// kink where a wheel's slip changes sign, is not counted on.
    fitted_alone: Vec<bool>,
}

impl Stand {
    fn new<P: Predictor>(
        problem: &ShootingProblem<P>,
        point: Point,
        tables: Vec<Tables>,
        by: &NoiseModel,
        fitted_alone: Vec<bool>,
    ) -> Self {
        let mut normals = normals(problem, &tables, &point, by);
        let marked = normals.iter_mut().zip(&fitted_alone);
        for (normal, _) in marked.filter(|(_, alone)| **alone) {
            normal.start_gradient.fill(0.0);
        }
        Self {
            fitted_alone,
            cost: total(problem, &normals, &point),
            point,
            tables,
            normals,
            age: 0,
        }
    }

    /// What segments that stand out cost more than others.
    fn excess<P: Predictor>(&self, problem: &ShootingProblem<P>) -> f64 {
        outlying_excess(problem, self.normals.iter().map(|normal| normal.cost))
    }

    /// After a step, with the derivatives of this point.
    fn moved<P: Predictor>(
        &self,
        problem: &ShootingProblem<P>,
        step: Step,
        residuals: &[Tables],
        by: &NoiseModel,
    ) -> Self {
        let pairs = self.tables.iter().zip(residuals);
        let tables = pairs.map(|(old, new)| old.with_residuals(new)).collect();
        Self {
            age: self.age + 1,
            ..Self::new(problem, step.point, tables, by, step.fitted_alone)
        }
    }
}

/// Lowers the cost from a point, which moves along.
///
/// # Errors
/// An initial point that cannot be predicted.
pub fn minimise<P: Predictor>(
    problem: &ShootingProblem<P>,
    point: &mut Point,
    by: &NoiseModel,
    stop: Stop,
) -> Result<Minimum, PredictionError> {
    let tables = problem.evaluate(point, true)?;
    Ok(minimise_from(problem, point, tables, by, stop))
}

/// As [`minimise`] where residuals and derivatives of the point are at hand.
#[must_use]
pub fn minimise_from<P: Predictor>(
    problem: &ShootingProblem<P>,
    point: &mut Point,
    tables: Vec<Tables>,
    by: &NoiseModel,
    stop: Stop,
) -> Minimum {
    let stand = |point: Point, fitted_alone: Vec<bool>| {
        let tables = problem.evaluate(&point, true)?;
        Ok(Stand::new(problem, point, tables, by, fitted_alone))
    };
    let none = vec![false; problem.segments.len()];
    let mut here = Stand::new(problem, point.clone(), tables, by, none);
    // Where derivatives were last taken, if not here.
    let mut sure = None;
    // With derivatives of this point; where there are none, the last one that had some.
    let renewed = |here: Stand, sure: &mut Option<Stand>| {
        let renewed = stand(here.point.clone(), here.fitted_alone.clone());
        renewed.unwrap_or_else(|_: PredictionError| sure.take().unwrap_or(here))
    };
    let first = here.cost;
    let (mut damping, mut growth) = (stop.first_damping, 2.0);
    let mut reach = FIRST_REACH;
    let (mut steps, mut max_restarts) = (0, 0);
    // Whether the last step gained too little although it promised enough, and the parameters have no more to gain.
    let mut settled = false;
    let mut vain = 0;
    // Whether old derivatives have misled.
    let mut curved = false;
    let (converged, predicted_reduction) = loop {
        let ended = steps >= stop.steps || damping >= LARGEST_DAMPING || reach <= SMALLEST_REACH;
        let step = propose(problem, &here, damping, reach);
        let little = settled || step.as_ref().is_some_and(|s| s.expected_gain < stop.gain);
        if problem.predictor().deadline().is_over() {
            break (false, step.map_or(0.0, |step| step.expected_gain));
        }
        if (ended || little) && here.age > 0 {
            // Only the derivatives at this point show whether it is the end.
            here = renewed(here, &mut sure);
            continue;
        }
        // As if every step left gained as much as this one promises, and segments that stand out were made like others.
        let left = stop.steps.saturating_sub(steps).max(1) as f64;
        let falls = left * step.as_ref().map_or(0.0, |step| step.expected_gain);
        let above = here.cost - falls - stop.cost_ceiling;
        if steps >= TRIED && above > 0.0 && above > here.excess(problem) {
            break (false, step.map_or(0.0, |step| step.expected_gain));
        }
        if (ended || little) && max_restarts < stop.max_restarts {
            max_restarts += 1;
            (settled, vain) = (false, 0);
            if let Some(there) = restarted(problem, &here, by) {
                if there.cost < (1.0 - RENEWED) * here.cost {
                    steps = steps.min(stop.steps / 2);
                    (damping, growth) = (stop.first_damping, 2.0);
                    reach = FIRST_REACH;
                }
                here = there;
                continue;
            }
        }
        if ended || little {
            break (little, step.map_or(0.0, |step| step.expected_gain));
        }
        steps += 1;
        let Some(mut step) = step else {
            damping *= 10.0;
            continue;
        };
        let mut trial = problem.evaluate_unless_one_fails(&step.point, false);
        let trial_cost = trial.as_mut().map_or(f64::INFINITY, |residuals| {
            let costs = fit_starts_alone(problem, &here, &mut step, residuals, by, stop.gain);
            costs.iter().sum::<f64>() + problem.prior_cost(&step.point.coordinates)
        });
        let gained = here.cost - trial_cost;
        // What is promised may be a loss, where starts fitted alone fall behind.
        let ratio = if step.expected_gain > 0.0 {
            gained / step.expected_gain
        } else {
            gained.signum()
        };
        let worth = if gained > 0.0 { 1.0 } else { NEARLY } * stop.gain;
        let in_vain = here.age == 0 && gained < stop.gain.min(VAIN * step.expected_gain);
        settled = in_vain && parameter_gain(problem, &here).is_some_and(|gain| gain < worth);
        // A step that leads up may be too long.
        vain = match gained {
            gained if gained < 0.0 => vain,
            _ if in_vain => vain + 1,
            _ => 0,
        };
        settled |= vain >= VAIN_STEPS;
        // Far from the end derivatives are soon others.
        if trial_cost < FALLING * here.cost {
            step.fitted_alone.fill(false);
        }
        let step_reach = step.reach;
        // A point whose neighbours cannot be predicted is as good as none.
        let moved = match trial {
            Some(residuals)
                if (ratio - 1.0).abs() < LINEAR
                    && (step_reach < SHORT || !curved)
                    && here.age < CHORDS =>
            {
                Some(here.moved(problem, step, &residuals, by))
            }
            Some(_) if ratio > 1e-4 => stand(step.point, step.fitted_alone).ok(),
            _ => None,
        };
        if let Some(there) = moved {
            let left = std::mem::replace(&mut here, there);
            if left.age == 0 {
                sure = Some(left);
            }
            damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).max(1.0 / 3.0);
            damping = damping.max(1e-9);
            growth = 2.0;
            if ratio > 0.5 {
                reach = (2.0 * reach).min(LARGEST_REACH);
            }
        } else if here.age > 0 {
            // Derivatives of another point may be what misled.
            curved = true;
            here = renewed(here, &mut sure);
        } else {
            reach = 0.3 * reach.min(step_reach);
            if trial_cost.is_finite() {
                damping *= growth;
                growth *= 2.0;
            }
        }
    };
    *point = here.point;
    Minimum {
        cost: here.cost,
        gain: first - here.cost,
        predicted_reduction,
        steps,
        converged,
        tables: here.tables,
    }
}

/// The same with other starts, where segments that stand out have better ones.
fn restarted<P: Predictor>(
    problem: &ShootingProblem<P>,
    here: &Stand,
    by: &NoiseModel,
) -> Option<Stand> {
    let costs = here.normals.iter().map(|normal| normal.cost);
    let starts = outlying_restarted(problem, &here.point, by, costs)?;
    let (point, tables) = moved(problem, &here.point, &here.tables, starts)?;
    let there = Stand::new(
        problem,
        point,
        tables,
        by,
        vec![false; here.fitted_alone.len()],
    );
    (there.cost < here.cost).then_some(there)
}

/// What the parameters could gain from here, the starts following them. `None` where the data do not determine them.
fn parameter_gain<P: Predictor>(problem: &ShootingProblem<P>, here: &Stand) -> Option<f64> {
    let (precision, pull) = problem.prior(&here.point.coordinates);
    let reduced = Reduced::new(&here.normals, &precision, &pull, 0.0)?;
    let Reduced {
        matrix, gradient, ..
    } = reduced;
    let room = room(&problem.parameters, &here.point.coordinates);
    let step = step_within(&matrix, &gradient, &room)?;
    Some(2.0 * gradient.dot(&step) - step.dot(&(&matrix * &step)))
}

/// Normal equations of all segments, computed side by side.
#[must_use]
pub fn normals<P: Predictor>(
    problem: &ShootingProblem<P>,
    tables: &[Tables],
    point: &Point,
    by: &NoiseModel,
) -> Vec<Normal> {
    let all = tables.par_iter().enumerate();
    all.map(|(index, tables)| problem.normal(index, tables, point, by))
        .collect()
}

fn total<P: Predictor>(problem: &ShootingProblem<P>, normals: &[Normal], point: &Point) -> f64 {
    normals.iter().map(|normal| normal.cost).sum::<f64>() + problem.prior_cost(&point.coordinates)
}

/// Fits starts that are less linear than the parameters to these, as a lateral velocity that is gone after some tenths of
/// a second: one such start would hold up all parameters. A segment depends on no other start, so each is fitted alone
/// ("embedded point iterations" in Y. Jeong et al., "Pushing the envelope of modern methods for bundle adjustment",
/// 2012). Marks those, expects of them what they do, and returns the segments' costs.
fn fit_starts_alone<P: Predictor>(
    problem: &ShootingProblem<P>,
    here: &Stand,
    step: &mut Step,
    residuals: &mut [Tables],
    by: &NoiseModel,
    worth: f64,
) -> Vec<f64> {
    let mut costs = problem.segment_costs(residuals, &step.point, by);
    let tolerated = (EXCESS * step.expected_gain).max(worth);
    let exceeds = |index: &usize| costs[*index] - step.segment_costs[*index] > tolerated;
    let exceeding: Vec<usize> = (0..costs.len()).filter(exceeds).collect();
    if 2 * exceeding.len() > costs.len() {
        return costs;
    }
    let values = problem.values(&step.point);
    let alone = |index: &usize| {
        let cost_at = |start: &[f64; START]| {
            let pair = (&problem.segments[*index], start);
            let tables = problem.predicted(pair, &step.point, &values, false).ok()?;
            Some((problem.segment_cost(*index, &tables, start, by), tables))
        };
        let before = here.point.starts[*index];
        let kept = cost_at(&before).is_some_and(|(cost, _)| cost < costs[*index]);
        let from = if kept {
            before
        } else {
            step.point.starts[*index]
        };
        let start = settled(
            problem,
            *index,
            &step.point.coordinates,
            from,
            &by.of(&[*index]),
            worth.min(LEAST),
        )?;
        let (cost, tables) = cost_at(&start)?;
        (cost < costs[*index]).then_some((*index, start, cost, tables))
    };
    let found: Vec<_> = exceeding.par_iter().filter_map(alone).collect();
    for (index, start, cost, tables) in found {
        step.point.starts[index] = start;
        costs[index] = cost;
        residuals[index] = tables;
    }
    for index in exceeding {
        step.fitted_alone[index] = true;
        step.expected_gain -= costs[index] - step.segment_costs[index];
    }
    costs
}

fn propose<P: Predictor>(
    problem: &ShootingProblem<P>,
    here: &Stand,
    damping: f64,
    reach: f64,
) -> Option<Step> {
    let Stand { point, normals, .. } = here;
    let (precision, pull) = problem.prior(&point.coordinates);
    let Reduced {
        mut matrix,
        gradient,
        each,
    } = Reduced::new(normals, &precision, &pull, damping)?;
    for k in 0..matrix.nrows() {
        matrix[(k, k)] *= 1.0 + damping;
    }
    let room = room(&problem.parameters, &point.coordinates);
    let shortened = |mut wanted: DVector<f64>| {
        let far = problem.parameters.iter().zip(wanted.iter());
        let far = far.map(|(p, step)| step.abs() / p.prior.deviation);
        let far = far.fold(0.0, f64::max);
        if far > reach {
            wanted *= reach / far;
        }
        (wanted, far.min(reach))
    };
    let crosses = |wanted: &DVector<f64>| {
        let mut pairs = wanted.iter().zip(&room);
        pairs.any(|(step, (low, high))| step < low || step > high)
    };
    let (mut wanted, mut far) = shortened(matrix.clone().cholesky()?.solve(&gradient));
    if crosses(&wanted) {
        (wanted, far) = shortened(step_within(&matrix, &gradient, &room)?);
    }
    let mut next = point.clone();
    for (k, parameter) in problem.parameters.iter().enumerate() {
        let (low, high) = parameter.bounds();
        let at = point.coordinates[k];
        next.coordinates[k] = parameter.after(at, wanted[k]).clamp(low, high);
        wanted[k] = wanted[k].clamp(low - at, high - at);
    }
    let mut segment_costs = Vec::with_capacity(normals.len());
    for (one, (normal, start)) in each.iter().zip(normals.iter().zip(&mut next.starts)) {
        let step = one.start_step(normal, &wanted);
        segment_costs.push(normal.cost_after(&step, &wanted));
        for (value, step) in start.iter_mut().zip(step) {
            *value += step;
        }
    }
    let expected_cost = segment_costs.iter().sum::<f64>() + problem.prior_cost(&next.coordinates);
    let expected_gain = here.cost - expected_cost;
    let finite = next.starts.iter().flatten().all(|v| v.is_finite());
    (expected_gain.is_finite() && finite).then_some(Step {
        point: next,
        expected_gain,
        reach: far,
        segment_costs,
        fitted_alone: here.fitted_alone.clone(),
    })
}
