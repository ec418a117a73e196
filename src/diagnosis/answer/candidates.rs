//! Results of all candidates.

use super::posterior::Posterior;
use crate::diagnosis::hypothesis::candidate::TERRAIN_CHANGE;
use crate::diagnosis::screening::screen::{Projection, one_degree};
use crate::diagnosis::search::SearchResult;
use crate::diagnosis::search::proposal::ScreenedCandidate;
use crate::diagnosis::{Candidate, DiagnosisError, Subject};
use crate::effects::CATALOGUE;
use crate::fit::parameter::NORMAL_95;
use crate::vehicle::Specification;
use nalgebra::{DMatrix, DVector};

/// Quantile of the normal distribution for a power of 90 % at the smallest detectable effect.
const POWER: f64 = 1.28;

/// Every screened candidate, and whether a plausible value would have been detected.
///
/// # Errors
/// Numbers that are not finite.
pub fn candidates(searched: &SearchResult) -> Result<Vec<(Candidate, bool)>, DiagnosisError> {
    let screening = &searched.first;
    let projection =
        Projection::over_all(&screening.system, &[]).ok_or(DiagnosisError::NotFinite)?;
    let alike = similar(&projection, &screening.screened);
    let one = |(screened, alike): (&ScreenedCandidate, Vec<(Subject, f64)>)| {
        let mut coefficients = searched.problem.candidates.of(screened.subject);
        // The coefficient that the results are about; others may have no information.
        let coefficient =
            coefficients.find(|coefficient| !screening.system.unknowns(*coefficient).is_empty());
        let coefficient = &searched.problem.candidates[coefficient?];
        let (projected, score) = (&screened.projected, &screened.score);
        let information = projected.matrix[(0, 0)] / score.scatter;
        let needed = screening.threshold.sqrt() + POWER;
        let smallest = needed / information.max(0.0).sqrt();
        let off = coefficient.off();
        let value = |step: f64| {
            let (low, high) = coefficient.parameter.bounds();
            if step.is_finite() && (low..=high).contains(&(off + step)) {
                coefficient.parameter.value(off + step)
            } else {
                f64::INFINITY
            }
        };
        // From "off" to the possible side.
        let upward = (value(smallest) - coefficient.parameter.value(off)).abs();
        let downward = (value(-smallest) - coefficient.parameter.value(off)).abs();
        let degrees = projected.unknowns.len();
        let gain = searched.gains.iter().find(|(s, _)| *s == screened.subject);
        let candidate = Candidate {
            absorbed: score.absorbed,
            significance: (one_degree(score.chi_square, degrees) / screening.threshold).sqrt(),
            smallest_detectable: upward.min(downward),
            parameter: coefficient.name,
            unit: coefficient.parameter.unit,
            estimate: coefficient.parameter.value(off + score.step[0]),
            interval: coefficient
                .parameter
                .interval(off + score.step[0], NORMAL_95 * score.deviation[0])
                .into(),
            held_out_gain: gain.map(|(_, gain)| *gain),
            alike,
            ..empty(screened.subject)
        };
        Some((candidate, smallest < coefficient.parameter.prior.deviation))
    };
    let pairs = screening.screened.iter().zip(alike);
    Ok(pairs.filter_map(one).collect())
}

/// A candidate without results.
#[must_use]
pub fn empty(subject: Subject) -> Candidate {
    Candidate {
        subject,
        probability: 0.0,
        absorbed: f64::NAN,
        significance: f64::NAN,
        smallest_detectable: f64::NAN,
        parameter: "",
        unit: "",
        estimate: f64::NAN,
        interval: [f64::NAN; 2],
        held_out_gain: None,
        alike: Vec::new(),
    }
}

/// Subjects with a probability that are not screened: nothing, unknown, a change of terrain.
#[must_use]
pub fn others(
    posterior: &Posterior,
    screened: &[Candidate],
    nominal: &Specification,
) -> Vec<Candidate> {
    let change = CATALOGUE
        .iter()
        .position(|e| e.name == TERRAIN_CHANGE)
        .filter(|effect| !nominal.effects.is_on(*effect));
    let mut subjects = vec![Subject::Nothing, Subject::Unknown];
    subjects.extend(change.map(Subject::Effect));
    subjects.retain(|subject| !screened.iter().any(|c| c.subject == *subject));
    let each = subjects.into_iter();
    each.map(|subject| Candidate {
        probability: posterior.of(subject),
        ..empty(subject)
    })
    .collect()
}

/// Smallest reported cosine.
const ALIKE: f64 = 0.8;

/// For each screened candidate those with a similar signal, with the cosine, the most similar first.
///
/// The angle between two candidates' signals after a refit of the soil: with H~ of both, the largest share of the one's
/// signal d (its one-step estimate, else its prior's deviation) that the other can imitate,
/// cos^2 = d^T H~_cd H~_dd^-1 H~_dc d / d^T H~_cc d.
fn similar(projection: &Projection, screened: &[ScreenedCandidate]) -> Vec<Vec<(Subject, f64)>> {
    let all: Vec<usize> = screened
        .iter()
        .flat_map(|one| one.projected.unknowns.iter().copied())
        .collect();
    let joint = projection.of(&all).matrix;
    let mut firsts = vec![0];
    for one in screened {
        firsts.push(firsts.last().copied().unwrap_or(0) + one.projected.unknowns.len());
    }
    let block = |a: usize, b: usize| -> DMatrix<f64> {
        let (rows, columns) = (firsts[a + 1] - firsts[a], firsts[b + 1] - firsts[b]);
        joint
            .view((firsts[a], firsts[b]), (rows, columns))
            .into_owned()
    };
    let one = |a: usize| {
        let signal = signal(projection, &screened[a]);
        let own = (signal.transpose() * block(a, a) * &signal)[0];
        let mut alike: Vec<(Subject, f64)> = (0..screened.len())
            .filter(|b| *b != a)
            .filter_map(|b| {
                let seen = block(b, a) * &signal;
                let mut other = block(b, b);
                let ridge = 1e-9 * other.diagonal().max();
                for k in 0..other.nrows() {
                    other[(k, k)] += ridge.max(1e-300);
                }
                let mimicked = seen.dot(&other.cholesky()?.solve(&seen));
                let cosine = (mimicked / own).max(0.0).sqrt().min(1.0);
                (cosine >= ALIKE).then_some((screened[b].subject, cosine))
            })
            .collect();
        alike.sort_by(|a, b| b.1.total_cmp(&a.1));
        alike
    };
    (0..screened.len()).map(one).collect()
}

fn signal(projection: &Projection, one: &ScreenedCandidate) -> DVector<f64> {
    if one.score.step.iter().any(|v| *v != 0.0) {
        return one.score.step.clone();
    }
    let precision = projection.precisions(&one.projected.unknowns);
    DVector::from_iterator(precision.len(), precision.iter().map(|p| p.sqrt().recip()))
}
