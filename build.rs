//! Refuses files of `modelDescription/` that are not what the library expects of them, before anything embeds them, and
//! names the platform for `ugv --version`.

use serde_json::Value;
use std::{env, fs};

/// Embedded JSON files, and a key that each must have.
const JSON: [(&str, &str); 2] = [
    ("modelDescription/resources/vehicle.json", "mass"),
    ("modelDescription/resources/terrains.json", "dry_sand"),
];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    for (path, key) in JSON {
        println!("cargo:rerun-if-changed={path}");
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let content: Value =
            serde_json::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert!(
            content.get(key).is_some(),
            "{path}: the key `{key}` is missing"
        );
    }
    let target = env::var("TARGET").expect("cargo sets TARGET");
    println!("cargo:rustc-env=UGV_TARGET={target}");
}
