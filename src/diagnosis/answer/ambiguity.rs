//! Step 4: which candidates these recordings do not tell apart.
//!
//! The angle between what is left of two candidates' signals when soil is re-tuned: with H~ of both,
//! the largest share of the one's signal d (its one-step estimate, or its prior's width where there is
//! none) that the other can mimic, cos^2 = d^T H~_cd H~_dd^-1 H~_dc d / d^T H~_cc d.

use crate::diagnosis::Subject;
use crate::diagnosis::screening::screen::Projection;
use crate::diagnosis::search::proposal::ScreenedCandidate;
use nalgebra::{DMatrix, DVector};

/// Cosines from here on are told.
const ALIKE: f64 = 0.8;

/// For each screened candidate those that look like it, with the cosine, the most alike first.
#[must_use]
pub fn groups(projection: &Projection, screened: &[ScreenedCandidate]) -> Vec<Vec<(Subject, f64)>> {
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
