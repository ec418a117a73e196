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
    /// For each of their unknowns its column of the nuisance's inverse matrix.
    columns: Vec<DVector<f64>>,
    /// Its variance, and the precision of its prior.
    spreads: Vec<(f64, f64)>,
}

impl Accepted {
    /// These unknowns; those that are not projected out do not count.
    #[must_use]
    pub fn new(
        system: &System,
        projection: &Projection,
        unknowns: impl Iterator<Item = usize>,
    ) -> Self {
        let (inverse, _) = projection.inverse();
        let mut places: Vec<usize> = unknowns
            .filter_map(|unknown| projection.nuisance().iter().position(|k| *k == unknown))
            .collect();
        places.sort_unstable();
        places.dedup();
        let spread = |place: &usize| {
            let unknown = projection.nuisance()[*place];
            (inverse[(*place, *place)], system.precision[unknown])
        };
        Self {
            spreads: places.iter().map(spread).collect(),
            columns: places
                .iter()
                .map(|place| inverse.column(*place).into_owned())
                .collect(),
        }
    }

    /// Whether all keep their sizes beside further unknowns.
    #[must_use]
    pub fn keep_sizes_beside(&self, projection: &Projection, further: &[usize]) -> bool {
        let remainder = projection.with_prior(&projection.of(further));
        self.keep_sizes(&projection.cross(further), &remainder)
    }

    /// The same from the normal equations: `cross` are the normal equations' block of these (columns) and
    /// the nuisance (rows), `remainder` that of these alone with their prior, the nuisance projected out.
    #[must_use]
    pub fn keep_sizes(&self, cross: &DMatrix<f64>, remainder: &DMatrix<f64>) -> bool {
        if self.columns.is_empty() {
            return true;
        }
        let Some(factor) = remainder.clone().cholesky() else {
            return false;
        };
        let pairs = self.columns.iter().zip(&self.spreads);
        let mut shares = pairs.map(|(column, (variance, precision))| {
            let moved = cross.tr_mul(column);
            let wider = variance + moved.dot(&factor.solve(&moved));
            let information = |variance: f64| 1.0 / variance - precision;
            information(wider) / information(*variance)
        });
        shares.all(|share| share >= KEPT)
    }
}
