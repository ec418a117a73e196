//! Makes the FMU: the model description, its documentation, and the archive of both with
//! the shared libraries; merges FMUs of one model with libraries for different platforms.

mod archive;
mod documentation;
mod merge;
mod model_description;

pub use archive::{PackageError, Platform, write_fmu};
pub use documentation::documentation;
pub use merge::{MergeError, merge_fmus};
pub use model_description::model_description;

/// The FMU's name: model, model identifier, and file name of the shared library.
pub const MODEL_IDENTIFIER: &str = "ugv";
