//! How the rates of a simulation change, at one instant, and by what.

use super::last_step::DELAY;
use super::variation::GAMMA;
use nalgebra::{DMatrix, Vector2};

/// What the derivatives are taken by: the initial state, the delay of the wheel speeds, the
/// parameters that act throughout, and those that act in one gate after another, gate by gate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    pub throughout: usize,
    pub binned: usize,
    pub time_bins: usize,
    /// The gate that is open.
    pub time_bin: usize,
}

impl Columns {
    /// First column of the parameters that act throughout, and of those of the gate that is open.
    pub fn parameters(&self) -> [usize; 2] {
        let first = DELAY + 1;
        [first, first + self.throughout + self.time_bin * self.binned]
    }

    pub fn all(&self) -> usize {
        DELAY + 1 + self.throughout + self.binned * self.time_bins
    }

    /// Number of columns that are not zero yet: all before the next gate's.
    pub fn begun(&self) -> usize {
        DELAY + 1 + self.throughout + self.binned * (self.time_bin + 1)
    }
}

/// How the rates of the state and of what is remembered change, at one instant.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    /// By the state and what is remembered: A.
    pub by_state: DMatrix<f64>,
    /// By the left and right wheel speed.
    pub by_speeds: DMatrix<f64>,
    /// By the parameters that act throughout, then by the gated ones: B.
    pub by_parameters: DMatrix<f64>,
    /// Through the tracks that were left, by all that derivatives are taken by; empty where there are none.
    pub by_tracks: DMatrix<f64>,
    /// Of the depths at which the wheels stand: by the state and what is remembered, and by the parameters as above.
    pub depths: [DMatrix<f64>; 2],
}

impl Linearised {
    /// A share GAMMA of the way to the end of a step.
    pub fn mixed(&self, end: &Self) -> Self {
        let mix = |a: &DMatrix<f64>, b: &DMatrix<f64>| a * (1.0 - GAMMA) + b * GAMMA;
        Self {
            by_state: mix(&self.by_state, &end.by_state),
            by_speeds: mix(&self.by_speeds, &end.by_speeds),
            by_parameters: mix(&self.by_parameters, &end.by_parameters),
            by_tracks: mix(&self.by_tracks, &end.by_tracks),
            depths: self.depths.clone(),
        }
    }

    /// Adds what the delay and the parameters do besides to the rates of the derivatives.
    pub fn push(&self, rates: &mut DMatrix<f64>, columns: &Columns, delayed: &Vector2<f64>) {
        let mut delay = rates.column_mut(DELAY);
        delay += &self.by_speeds * delayed;
        add_parameters(rates, &self.by_parameters, columns);
        if !self.by_tracks.is_empty() {
            *rates += self.by_tracks.columns(0, rates.ncols());
        }
    }

    /// Derivatives of the depths at which the wheels stand, by all that derivatives are taken by.
    pub fn depths(&self, by: &DMatrix<f64>, columns: &Columns) -> DMatrix<f64> {
        let [by_state, by_parameters] = &self.depths;
        let mut depths = by_state * by;
        add_parameters(&mut depths, by_parameters, columns);
        depths
    }
}

/// Adds what parameters do: those that act throughout, then the gated ones in the gate that is open.
fn add_parameters(target: &mut DMatrix<f64>, by_parameters: &DMatrix<f64>, columns: &Columns) {
    let [throughout, open] = columns.parameters();
    let counts = [columns.throughout, columns.binned];
    let mut from = 0;
    for (first, count) in [throughout, open].into_iter().zip(counts) {
        let mut target = target.columns_mut(first, count);
        target += by_parameters.columns(from, count);
        from += count;
    }
}
