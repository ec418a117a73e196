//! Vehicles and terrains as JSON, and the paper's ones.
//!
//! A file holds exactly the keys of its kind; `assumed` may stand beside them and is ignored
//! (recordings list there which of their values were not measured). Values in SI units, the
//! friction angle in degrees.

mod error;
mod object;
mod terrain;
mod vehicle;

pub use error::JsonError;
pub(crate) use object::parse;
