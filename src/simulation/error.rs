//! Why a simulation cannot go on.

use crate::vehicle::{BalanceError, Unusual};
use thiserror::Error;

/// Why a simulation cannot go on.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The wheels find no balance at this time \[s\].
    #[error("at {time} s: {source}")]
    Balance {
        /// Simulated time \[s\].
        time: f64,
        /// What the wheels lack.
        source: BalanceError,
    },
    /// A step that is negative, not finite or longer than 1e6 s \[s\].
    #[error("cannot step by {0} s: a step lies between 0 and 1e6 s")]
    StepSize(f64),
    /// An input or state that is not finite.
    #[error("{what} = {value} is not finite")]
    NotFinite {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The error control asks for steps below the resolution of the time \[s\].
    #[error("at {time} s the motion changes faster than the smallest step can follow{}", doubt(suspect.as_ref()))]
    StepTooSmall {
        /// Simulated time \[s\].
        time: f64,
        /// The parameter farthest from its usual values, if one is outside of them.
        suspect: Option<Unusual>,
    },
    /// The motion changes so fast that a second of driving takes too many steps ([`Simulation::limit_work`](super::Simulation::limit_work)).
    #[error("at {time} s the motion changes so fast that one second of driving takes too many steps{}", doubt(suspect.as_ref()))]
    TooStiff {
        /// Simulated time \[s\].
        time: f64,
        /// The parameter farthest from its usual values, if one is outside of them.
        suspect: Option<Unusual>,
    },
    /// More steps are needed than [`Simulation::limit_steps`](super::Simulation::limit_steps) allows.
    #[error("at {time} s the number of steps that was set as a limit is used up")]
    StepBudget {
        /// Simulated time \[s\].
        time: f64,
    },
}

fn doubt(suspect: Option<&Unusual>) -> String {
    suspect.map_or(String::new(), |suspect| {
        format!("; the likely cause is {suspect}")
    })
}
