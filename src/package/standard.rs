//! The versions of the standard.

use crate::declaration::Naming;

/// The FMU's name: model, model identifier, and file name of the shared library.
pub const MODEL_IDENTIFIER: &str = "ugv";

/// A version of the standard. One shared library serves both; only the archive differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

impl Standard {
    pub(super) const ALL: [Self; 2] = [Self::Fmi2, Self::Fmi3];

    /// Whether rows and wheels are scalars or arrays.
    pub(super) fn naming(self) -> Naming {
        match self {
            Self::Fmi2 => Naming::Scalars,
            Self::Fmi3 => Naming::Arrays,
        }
    }
}
