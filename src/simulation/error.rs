//! Why a simulation cannot go on.

use crate::vehicle::{BalanceError, Unusual};
use std::fmt;

/// Why a simulation cannot go on.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// The wheels find no balance at this time \[s\].
    Balance {
        /// Simulated time \[s\].
        time: f64,
        /// What the wheels lack.
        source: BalanceError,
    },
    /// A step that is negative, not finite or longer than 1e6 s \[s\].
    StepSize(f64),
    /// An input or state that is not finite.
    NotFinite {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The error control asks for steps below the resolution of the time \[s\].
    StepTooSmall {
        /// Simulated time \[s\].
        time: f64,
        /// The parameter farthest from its usual values, if one is outside of them.
        suspect: Option<Unusual>,
    },
    /// The motion changes so fast that a second of driving takes too many steps ([`Simulation::limit_work`]).
    TooStiff {
        /// Simulated time \[s\].
        time: f64,
        /// The parameter farthest from its usual values, if one is outside of them.
        suspect: Option<Unusual>,
    },
    /// More steps are needed than [`Simulation::limit_steps`] allows.
    StepBudget {
        /// Simulated time \[s\].
        time: f64,
    },
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Balance { time, source } => write!(f, "at {time} s: {source}"),
            Self::StepSize(step) => {
                write!(
                    f,
                    "cannot step by {step} s: a step lies between 0 and 1e6 s"
                )
            }
            Self::NotFinite { what, value } => write!(f, "{what} = {value} is not finite"),
            Self::StepTooSmall { time, suspect } => {
                write!(
                    f,
                    "at {time} s the motion changes faster than the smallest step can follow"
                )?;
                doubt(f, suspect.as_ref())
            }
            Self::TooStiff { time, suspect } => {
                write!(
                    f,
                    "at {time} s the motion changes so fast that one second of driving takes too many steps"
                )?;
                doubt(f, suspect.as_ref())
            }
            Self::StepBudget { time } => write!(
                f,
                "at {time} s the number of steps that was set as a limit is used up"
            ),
        }
    }
}

fn doubt(f: &mut fmt::Formatter<'_>, suspect: Option<&Unusual>) -> fmt::Result {
    match suspect {
        Some(suspect) => write!(f, "; the likely cause is {suspect}"),
        None => Ok(()),
    }
}

impl std::error::Error for SimulationError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Balance { source, .. } => Some(source),
            _ => None,
        }
    }
}
