//! Makes the FMU: the model description, its documentation, and the archive of both with
//! the shared libraries; merges FMUs of one model with libraries for different platforms.

mod archive;
mod documentation;
mod library;
mod merge;
mod model_description;
mod model_description_3;
mod xml;

pub use archive::{PackageError, Platform, Standard, write_fmu};
pub use documentation::documentation;
pub use merge::{MergeError, merge_fmus};
pub use model_description::model_description;
pub use model_description_3::model_description_3;

/// The FMU's name: model, model identifier, and file name of the shared library.
pub const MODEL_IDENTIFIER: &str = "ugv";
