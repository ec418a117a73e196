//! Vehicles, terrains, effects and whole models as JSON, and the paper's ones.
//!
//! A file holds exactly the keys of its kind; `assumed` may stand beside them and is ignored
//! (recordings list there which of their values were not measured). Values in SI units, the
//! friction angle in degrees.

mod effects;
mod error;
mod file;
mod object;
mod specification;
mod terrain;
mod unique;
mod vehicle;
mod window;

pub use effects::EFFECTS_FORMAT;
pub use error::JsonError;
pub use file::read_file;
#[cfg(feature = "analysis")]
pub(crate) use object::parse;
pub use specification::{FittedTo, MODEL_FORMAT};
