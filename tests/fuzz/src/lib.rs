//! What the fuzz targets share.

use std::path::PathBuf;

pub mod calls;
pub mod fmi2;
pub mod fmi3;

/// A file of this process in memory, for readers that want a path.
pub fn scratch(extension: &str) -> PathBuf {
    PathBuf::from(format!(
        "/dev/shm/ugv-fuzz-{}.{extension}",
        std::process::id()
    ))
}
