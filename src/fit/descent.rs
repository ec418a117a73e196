//! Ways down from a start, past answers that are known.

use super::noise_model::reweigh;
use super::normal::Reduced;
use super::optimiser::{Minimum, Stop, minimise, normals};
use super::predictor::Predictor;
use super::problem::{NoiseModel, Point, ShootingProblem, Tables};
use super::robust;
use nalgebra::DVector;

/// Answers are the same where no parameter differs by more of its standard deviations.
const SAME: f64 = 1.0;
const DESCENT: Stop = Stop::after(12, 0.1).with_low_damping();
/// Turns of motion and weights on the way down.
const TURNS: usize = 6;
/// Where the cost is looked at on the straight way to an answer that is known.
const WAY: [f64; 3] = [0.25, 0.5, 0.75];

/// A way down and where it ended.
#[derive(Clone)]
pub(super) struct Answer {
    pub point: Point,
    pub cost: f64,
    pub count: usize,
    /// Standard deviations of the parameters there, if the data determine all of them.
    pub deviations: Option<DVector<f64>>,
}

/// A way down past answers that are known.
pub(super) enum Descent {
    /// It comes so near to one, or the cost falls so steadily from it to one, that it leads there.
    Joins(usize),
    /// It has an end of its own.
    Ends(Answer),
}

/// Down to a minimum: motion and weights in turns, the noise held. `None` where the model
/// cannot drive.
pub(super) fn descend<P: Predictor>(
    problem: &ShootingProblem<P>,
    point: Point,
    by: &NoiseModel,
    robust: bool,
) -> Option<Answer> {
    match descend_past(&[], problem, point, by, robust)? {
        Descent::Ends(answer) => Some(answer),
        Descent::Joins(_) => None,
    }
}

/// [`descend`], unless it comes as near to an answer that is known as answers that are the same, or the cost falls all the
/// way to one.
pub(super) fn descend_past<P: Predictor>(
    known: &[Answer],
    problem: &ShootingProblem<P>,
    mut point: Point,
    by: &NoiseModel,
    robust: bool,
) -> Option<Descent> {
    let mut by = by.clone();
    if robust {
        by.weights.iter_mut().flatten().for_each(|w| w.fill(1.0));
    }
    let mut cost = f64::INFINITY;
    let mut turn = 0;
    loop {
        turn += 1;
        let outcome = minimise(problem, &mut point, &by, DESCENT).ok()?;
        let near = |answer: &Answer| {
            let deviations = answer.deviations.as_ref();
            deviations.is_some_and(|d| close(&answer.point, &point, d))
        };
        let falls = |answer: &Answer| falls_to(problem, &point, &outcome, answer, &by);
        if let Some(known) = known.iter().position(|one| near(one) || falls(one)) {
            return Some(Descent::Joins(known));
        }
        let penalty: f64 = by
            .weights
            .iter()
            .flatten()
            .flatten()
            .map(|w| robust::penalty(*w))
            .sum();
        let now = outcome.cost + penalty;
        let still = outcome.converged && cost - now < 0.3;
        cost = now;
        if still || turn == TURNS {
            return Some(Descent::Ends(Answer {
                deviations: deviations(problem, &outcome.tables, &point, &by),
                point,
                cost,
                count: 1,
            }));
        }
        if robust {
            reweigh(problem, &outcome.tables, &mut by);
        }
    }
}

/// Whether the cost falls all the way straight from `here` to an answer, and there below what the next step from `here`
/// promises, so that no better answer beside it is passed over. In a narrow valley that is seen long before steps along
/// its floor have come there.
fn falls_to<P: Predictor>(
    problem: &ShootingProblem<P>,
    here: &Point,
    outcome: &Minimum,
    answer: &Answer,
    by: &NoiseModel,
) -> bool {
    let cost = |share: f64| {
        let between = |from: f64, to: f64| from + share * (to - from);
        let starts = here.starts.iter().zip(&answer.point.starts);
        let point = Point {
            coordinates: here.coordinates.zip_map(&answer.point.coordinates, between),
            starts: starts
                .map(|(from, to)| std::array::from_fn(|k| between(from[k], to[k])))
                .collect(),
        };
        let residuals = problem.evaluate_unless_one_fails(&point, false)?;
        Some(problem.cost(&residuals, &point, by))
    };
    let predicted_reduction = outcome.cost - outcome.predicted_reduction;
    let Some(end) = cost(1.0).filter(|end| *end <= predicted_reduction) else {
        return false;
    };
    let mut last = outcome.cost;
    let mut falls = |share| {
        let now = cost(share).filter(|now| *now <= last && *now >= end);
        now.is_some_and(|now| {
            last = now;
            true
        })
    };
    WAY.into_iter().all(&mut falls)
}

/// Answers that are the same become one, the best first.
pub(super) fn group(mut answers: Vec<Answer>) -> Vec<Answer> {
    answers.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let Some(deviations) = answers.first().and_then(|best| best.deviations.clone()) else {
        return answers;
    };
    let mut groups: Vec<Answer> = Vec::new();
    for answer in answers {
        match groups
            .iter_mut()
            .find(|g| close(&g.point, &answer.point, &deviations))
        {
            Some(same) => same.count += answer.count,
            None => groups.push(answer),
        }
    }
    groups
}

/// Standard deviations of the parameters.
fn deviations<P: Predictor>(
    problem: &ShootingProblem<P>,
    tables: &[Tables],
    point: &Point,
    by: &NoiseModel,
) -> Option<DVector<f64>> {
    let (precision, pull) = problem.prior(&point.coordinates);
    let normals = normals(problem, tables, point, by);
    let reduced = Reduced::new(&normals, &precision, &pull, 0.0)?;
    Some(
        reduced
            .matrix
            .cholesky()?
            .inverse()
            .diagonal()
            .map(f64::sqrt),
    )
}

pub(super) fn close(a: &Point, b: &Point, deviations: &DVector<f64>) -> bool {
    let apart = (&a.coordinates - &b.coordinates).component_div(deviations);
    apart.amax() < SAME
}
