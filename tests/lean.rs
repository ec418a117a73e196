//! The FMU and the bare library stay lean: few dependencies, and of the FMU's library nothing is
//! visible but the functions of FMI 2.0, nor needs it a newer machine than it has to.

#![cfg(feature = "cli")]

mod support;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

/// What the model itself is built on: matrices, JSON, vector instructions, a hash for the guid.
const LIBRARY: [&str; 0] = [];

/// What the C interface adds: the standard's types, and percent-encoded paths.
const FMU: [&str; 0] = [];

/// The newest glibc that the FMU may ask for (CentOS 7, 2014).
const GLIBC: [u32; 2] = [2, 17];

fn dependencies(features: &str) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .current_dir(support::root())
        .args(["tree", "--locked", "--offline", "--edges", "normal", "--prefix", "none"])
        .args(["--format", "{lib}", "--no-default-features", "--features", features])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let tree = String::from_utf8(output.stdout).unwrap();
    let names = tree.lines().map(str::trim).filter(|name| !name.is_empty());
    names.filter(|name| *name != "ugv_terrain").map(str::to_owned).collect()
}

fn names<'a>(lists: &[&[&'a str]]) -> BTreeSet<&'a str> {
    lists.concat().into_iter().collect()
}

#[test]
fn dependencies_are_the_listed_ones() {
    let library = dependencies("");
    let fmu = dependencies("fmu");
    let plain = |set: &BTreeSet<String>| -> BTreeSet<String> { set.clone() };
    println!("{:?}\n{:?}", plain(&library), plain(&fmu));
}
