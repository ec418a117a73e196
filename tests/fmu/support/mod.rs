//! What the tests of the packaged FMU need from outside of cargo.

#![allow(dead_code, reason = "each test uses some of it")]

pub mod host;
pub mod outputs;

use crate::skipped::skipped;
use std::path::{Path, PathBuf};

/// The FMU under test: `UGV_FMU`, or what scripts/package.sh leaves.
pub fn fmu() -> Option<PathBuf> {
    let named = std::env::var_os("UGV_FMU").map(PathBuf::from);
    let path = named.unwrap_or_else(|| root().join("target/ugv.fmu"));
    if !path.is_file() {
        let path = path.display();
        skipped(&format!(
            "there is no FMU at {path}; scripts/package.sh builds it, UGV_FMU names another"
        ));
        return None;
    }
    Some(path)
}

/// The Python with fmpy that scripts/setup.sh installs.
pub fn python() -> Option<PathBuf> {
    let path = root().join("target/venv/bin/python");
    if !path.is_file() {
        let path = path.display();
        skipped(&format!("there is no {path}; scripts/setup.sh installs it"));
        return None;
    }
    Some(path)
}

/// The folder of the standard's C headers, which come with fmpy.
pub fn standard_headers() -> Option<PathBuf> {
    python()?;
    let library = root().join("target/venv/lib");
    let versions = std::fs::read_dir(&library).expect("a virtual environment has a lib folder");
    let found = versions
        .map(|entry| {
            entry
                .unwrap()
                .path()
                .join("site-packages/fmpy/c-code/fmi2Functions.h")
        })
        .find(|header| header.is_file());
    let header = found.expect("fmpy brings fmi2Functions.h along");
    header.parent().map(Path::to_owned)
}

/// Whether a program is there; says so if not.
pub fn has(program: &str, package: &str) -> bool {
    let found = std::process::Command::new(program)
        .arg("--version")
        .output()
        .is_ok();
    if !found {
        skipped(&format!(
            "{program} is missing (Debian: apt-get install {package})"
        ));
    }
    found
}

/// Reads a file of the FMU's archive.
pub fn member(fmu: &Path, name: &str) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(fmu).unwrap()).unwrap();
    let mut content = Vec::new();
    std::io::copy(&mut archive.by_name(name).unwrap(), &mut content).unwrap();
    content
}

/// The package's folder.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
