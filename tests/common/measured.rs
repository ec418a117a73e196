//! Where the measured data lies, which the project does not hold.

use crate::skipped::skipped;
use std::path::{Path, PathBuf};

/// A folder below the one that `UGV_DATA` names, or below the one beside the project; `None`, and says so, where it is not there.
pub fn data(name: &str) -> Option<PathBuf> {
    let named = std::env::var_os("UGV_DATA").map(PathBuf::from);
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folder = named.unwrap_or_else(beside).join(name);
    if !folder.is_dir() {
        let place = folder.display();
        skipped(&format!("there is no {place}; UGV_DATA names the folder"));
        return None;
    }
    Some(folder)
}
