//! The linearised problem beside the accepted effects.

use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::screening::screen::Projection;
use crate::diagnosis::screening::system::System;
use crate::fit::problem::NoiseModel;

/// The linearised problem beside the coefficients that are on.
#[derive(Debug)]
pub struct View<'a, 'g> {
    /// The given model.
    pub problem: &'a Problem<'g>,
    /// The normal equations.
    pub system: &'a System,
    /// Soil and what is on, projected out.
    pub projection: Projection<'a>,
    /// The noise.
    pub noise: &'a NoiseModel,
    /// Coefficients that are on.
    pub on: &'a [usize],
}

impl<'a, 'g> View<'a, 'g> {
    /// Projects out soil and the coefficients that are on. `None` if numbers are not finite.
    #[must_use]
    pub fn new(
        problem: &'a Problem<'g>,
        system: &'a System,
        on: &'a [usize],
        noise: &'a NoiseModel,
    ) -> Option<Self> {
        let further: Vec<usize> = on.iter().flat_map(|k| system.unknowns(*k)).collect();
        let projection = Projection::over_all(system, &further)?;
        Some(Self {
            problem,
            system,
            projection,
            noise,
            on,
        })
    }
}
