//! Where the measured data lies, which the project does not hold.

use std::io::Write;
use std::path::{Path, PathBuf};

/// A part of the folder that `UGV_DATA` names, or of the one beside the project; `None`, and says so, where it is not there.
pub fn data(part: &str) -> Option<PathBuf> {
    let named = std::env::var_os("UGV_DATA").map(PathBuf::from);
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folder = named.unwrap_or_else(beside).join(part);
    if !folder.is_dir() {
        let place = folder.display();
        let message = format!("SKIPPED: there is no {place}; UGV_DATA names another folder");
        // Past the test harness, which would swallow it.
        writeln!(std::io::stderr(), "{message}").expect("stderr can be written");
        return None;
    }
    Some(folder)
}
