//! How the rates of a simulation change, at one instant, and by what.

use super::state::State;
use nalgebra::{Const, DMatrix, Dyn, OMatrix, SMatrix, Vector2};

/// gamma = 1 - 1/sqrt(2) of the SDIRK method (see `variation`).
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Derivatives of a state: a column by each component of the initial state, one by a delay of the
/// wheel speeds, and one by each parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives(pub(super) OMatrix<f64, Const<{ State::COUNT }>, Dyn>);

/// Column of the derivative by a delay of the wheel speeds.
pub(super) const DELAY: usize = State::COUNT;

impl Derivatives {
    /// By the state at the restart.
    #[must_use]
    pub fn by_initial(&self) -> SMatrix<f64, { State::COUNT }, { State::COUNT }> {
        self.0.fixed_columns::<{ State::COUNT }>(0).into()
    }

    /// By a delay of the wheel speeds \[per s\], as far as these change by their rates: what a jump from one call of
    /// [`SensitiveSimulation::drive`](super::SensitiveSimulation::drive) to the next would do later is not in it.
    #[must_use]
    pub fn by_wheel_delay(&self) -> [f64; State::COUNT] {
        self.0.column(DELAY).into_owned().into()
    }

    /// By each parameter: those that act throughout, then the binned ones, bin by bin.
    pub fn by_parameters(&self) -> impl Iterator<Item = [f64; State::COUNT]> + '_ {
        let columns = self.0.column_iter().skip(DELAY + 1);
        columns.map(|column| column.into_owned().into())
    }

    /// By one of the parameters, in the order of [`Derivatives::by_parameters`].
    #[must_use]
    pub fn by_parameter(&self, index: usize) -> [f64; State::COUNT] {
        self.0.column(DELAY + 1 + index).into_owned().into()
    }
}

/// What the derivatives are taken by: the initial state, the delay of the wheel speeds, the
/// parameters that act throughout, and those that act in one time bin after another, bin by bin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    pub throughout: usize,
    pub binned: usize,
    pub time_bins: usize,
    /// The time bin that is open.
    pub time_bin: usize,
}

impl Columns {
    /// First column of the parameters that act throughout, and of those of the time bin that is open.
    pub fn parameters(&self) -> [usize; 2] {
        let first = DELAY + 1;
        [first, first + self.throughout + self.time_bin * self.binned]
    }

    pub fn all(&self) -> usize {
        DELAY + 1 + self.throughout + self.binned * self.time_bins
    }

    /// Number of columns that are not zero yet: all before the next time bin's.
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
    /// By the parameters that act throughout, then by the binned ones: B.
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

/// Share of a step that has passed `back` seconds before its end.
pub(super) fn share(length: f64, back: f64) -> f64 {
    if length > 0.0 {
        (1.0 - back / length).clamp(0.0, 1.0)
    } else {
        1.0
    }
}

/// Adds what parameters do: those that act throughout, then the binned ones in the time bin that is open.
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
