//! The FMU's variables from their one declaration: the rows of `table.rs`, and for the parameters of
//! effects those of [`crate::effects::CATALOGUE`].
//!
//! Value references, the model description, its documentation, the C header and the columns of the
//! simulation's CSV follow from them.

mod configuration;
mod dependencies;
mod effects;
mod log;
mod parameters;
mod resources;
mod row;
mod table;
mod variable;
mod variables;

pub use configuration::{Configuration, TERRAIN_TYPE, TERRAINS};
pub use dependencies::{DependencyKind, dependencies, initial_dependencies, initial_pose};
pub use log::{LOG_CATEGORIES, LogCategory};
pub use resources::{ConfigurationError, MARK, guid};
pub use row::{Attributes, Causality, Kind, Unit};
pub use table::UNITS;
pub use variable::{Quantity, Side, Variable};
pub use variables::{ArrayVariable, Elements, Naming, state_nominals, variables};
