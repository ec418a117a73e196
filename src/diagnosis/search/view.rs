//! The linearised problem beside the accepted effects.

use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::screening::screen::Projection;
use crate::diagnosis::screening::shape::Shapes;
use crate::diagnosis::screening::system::System;
use crate::fit::problem::NoiseModel;

/// The linearised problem beside the coefficients that are on.
#[derive(Debug)]
pub struct View<'a, 'g> {
    /// The given model.
    pub problem: &'a Problem<'g>,
    /// The normal equations.
    pub system: &'a System,
    /// Soil, what is on and the shapes of its formulas, projected out.
    pub projection: Projection<'a>,
    /// Soil and what is on, projected out: an empirical residual model may mend a formula.
    pub exact: Projection<'a>,
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
        shapes: &Shapes,
        noise: &'a NoiseModel,
    ) -> Option<Self> {
        let mut further: Vec<usize> = on.iter().flat_map(|k| system.unknowns(*k)).collect();
        let exact = Projection::over_all(system, &further)?;
        further.extend(&shapes.unknowns);
        let projection = Projection::over_all(system, &further)?;
        Some(Self {
            exact,
            problem,
            system,
            projection,
            noise,
            on,
        })
    }
}
