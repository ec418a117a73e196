//! Vehicles, terrains, effects and whole models as JSON, and the paper's ones.
//!
//! A file has exactly the keys of its kind. The key `assumed` is allowed and ignored: recordings list
//! there which of their values were not measured. Values in SI units, the friction angle in degrees.

mod effects;
mod error;
mod file;
mod object;
mod specification;
mod terrain;
mod unique;
mod vehicle;
mod window;

pub use error::JsonError;
pub use file::read_file;
#[cfg(feature = "analysis")]
pub(crate) use object::parse;
pub(crate) use object::parsed;
pub use object::{EFFECTS_FORMAT, MODEL_FORMAT};
pub use specification::FittedTo;
