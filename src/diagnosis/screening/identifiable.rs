//! Whether accepted effects keep their sizes beside a residual model.
//!
//! Where a residual model repeats an accepted effect, only the sum of both is known: a fit then moves the size from the
//! name to the residual model, whose prior costs less. So a residual model beside which an accepted effect of the
//! catalogue is not identifiable is none.

use super::screen::Projection;
use super::system::System;
use nalgebra::{DMatrix, DVector};

/// Minimum share of its information that an accepted effect keeps. Beside a drag and beside a tow of two development
/// drives, the terms that repeat them left 0.004 to 0.03, all others 0.30 or more.
const KEPT: f64 = 0.1;

/// Accepted effects, some of the nuisance that is projected out.
#[derive(Debug)]
pub struct Accepted {
    /// The unknowns that are determined by the data more than by their priors.
    each: Vec<Known>,
}

/// A determined unknown.
#[derive(Debug)]
struct Known {
    /// Its column of the nuisance's inverse matrix.
    column: DVector<f64>,
    variance: f64,
    /// Of its prior.
    precision: f64,
}

impl Known {
    /// What data say of it at this variance.
    fn information(&self, variance: f64) -> f64 {
        1.0 / variance - self.precision
    }
}

impl Accepted {
    /// These unknowns; those that are not projected out or not determined do not count.
    #[must_use]
    pub fn new(
        system: &System,
        projection: &Projection,
        unknowns: impl Iterator<Item = usize>,
    ) -> Self {
        let (inverse, _) = projection.inverse();
        let nuisance = projection.nuisance();
        let places = unknowns.filter_map(|unknown| nuisance.iter().position(|k| *k == unknown));
        let known = places.map(|place| Known {
            column: inverse.column(place).into_owned(),
            variance: inverse[(place, place)],
            precision: system.precision[nuisance[place]],
        });
        Self {
            each: known
                .filter(|one| one.information(one.variance) > one.precision)
                .collect(),
        }
    }

    /// Whether all keep their sizes beside further unknowns.
    #[must_use]
    pub fn keep_sizes_beside(&self, projection: &Projection, further: &[usize]) -> bool {
        let remainder = projection.with_prior(&projection.of(further));
        self.keep_sizes(&projection.cross(further), &remainder)
    }

    /// The same, where `cross` is the normal equations' block of these (columns) and the nuisance (rows), `remainder` that of
    /// these alone with their prior, the nuisance projected out.
    #[must_use]
    pub fn keep_sizes(&self, cross: &DMatrix<f64>, remainder: &DMatrix<f64>) -> bool {
        if self.each.is_empty() {
            return true;
        }
        let Some(factor) = remainder.clone().cholesky() else {
            return false;
        };
        self.each.iter().all(|one| {
            let moved = cross.tr_mul(&one.column);
            let wider = one.variance + moved.dot(&factor.solve(&moved));
            one.information(wider) >= KEPT * one.information(one.variance)
        })
    }
}
