//! Makes the FMU: the model description, its documentation, and the archive of both with
//! the shared libraries; merges FMUs of one model with libraries for different platforms.

mod archive;
mod documentation;
mod library;
mod merge;
mod model_description;
mod standard;

pub use archive::{PackageError, Platform, write_fmu};
pub use documentation::documentation;
pub use merge::{MergeError, merge_fmus};
pub use model_description::model_description;
pub use standard::{MODEL_IDENTIFIER, Standard};
