//! The FMU and the bare library stay lean: few dependencies, and of the FMU's library nothing is
//! visible but the functions of FMI 2.0 and 3.0, nor needs it a newer machine than it has to.

use crate::support;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

/// What the model itself is built on: nalgebra, `serde_json`, `serde_core`, `fearless_simd`, `strsim`, `thiserror`,
/// `uuid`, and theirs.
const LIBRARY: &[&str] = &[
    "approx",
    "bytemuck",
    "fearless_simd",
    "itoa",
    "matrixmultiply",
    "memchr",
    "nalgebra",
    "num_complex",
    "num_integer",
    "num_rational",
    "num_traits",
    "proc_macro2",
    "quote",
    "rawpointer",
    "safe_arch",
    "serde_core",
    "serde_json",
    "sha1_smol",
    "simba",
    "strsim",
    "syn",
    "thiserror",
    "thiserror_impl",
    "typenum",
    "unicode_ident",
    "uuid",
    "wide",
    "zmij",
];

/// What batches add: `rayon`, and its dependencies.
const BATCH: &[&str] = &[
    "crossbeam_deque",
    "crossbeam_epoch",
    "crossbeam_utils",
    "either",
    "rayon",
    "rayon_core",
];

/// What fitting and diagnosing add to batches: `csv`, `encoding_rs`, `fastrand`, `jiff`, `statrs`, `textwrap`, and
/// theirs; no argument parsing, plots or C.
const ANALYSIS: &[&str] = &[
    "cfg_if",
    "core_detect",
    "csv",
    "csv_core",
    "encoding_rs",
    "fastrand",
    "jiff",
    "jiff_core",
    "libm",
    "multiversion_no_op",
    "ryu",
    "scopeguard",
    "simdutf8",
    "statrs",
    "textwrap",
];

/// What the C interface adds: the standard's types (`fmi_sys`, and theirs), percent-encoded paths.
const FMU: &[&str] = &[
    "cfg_if",
    "document_features",
    "fmi_sys",
    "libloading",
    "litrs",
    "log",
    "percent_encoding",
];

/// The newest glibc that the FMU may ask for (of 2012, as in `CentOS` 7).
const GLIBC: [u32; 2] = [2, 17];

fn dependencies(features: &str) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .current_dir(support::root())
        .args([
            "tree",
            "--locked",
            "--no-dedupe",
            "--offline",
            "--edges",
            "normal",
            "--prefix",
            "none",
        ])
        .args([
            "--format",
            "{lib}",
            "--no-default-features",
            "--features",
            features,
        ])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let tree = String::from_utf8(output.stdout).unwrap();
    let names = tree.lines().map(str::trim).filter(|name| !name.is_empty());
    names
        .filter(|name| *name != "ugv_terrain")
        .map(str::to_owned)
        .collect()
}

fn allowed(lists: &[&[&str]]) -> BTreeSet<String> {
    lists.concat().into_iter().map(str::to_owned).collect()
}

#[test]
fn the_library_has_the_dependencies_that_are_listed() {
    assert_eq!(dependencies(""), allowed(&[LIBRARY]));
}

#[test]
fn batches_have_the_dependencies_that_are_listed() {
    assert_eq!(dependencies("batch"), allowed(&[LIBRARY, BATCH]));
}

#[test]
fn fitting_and_diagnosing_have_the_dependencies_that_are_listed() {
    assert_eq!(
        dependencies("analysis"),
        allowed(&[LIBRARY, BATCH, ANALYSIS])
    );
}

#[test]
fn the_fmu_has_the_dependencies_that_are_listed() {
    assert_eq!(dependencies("fmu"), allowed(&[LIBRARY, FMU]));
}

/// The packaged shared library as a file.
struct Library {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Library {
    fn new() -> Option<Self> {
        let fmu = support::fmu()?;
        if !(support::has("nm", "binutils") && support::has("objdump", "binutils")) {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ugv.so");
        let content = support::member(&fmu, "binaries/linux64/ugv.so");
        std::fs::write(&path, content).unwrap();
        Some(Self {
            _folder: folder,
            path,
        })
    }

    fn ask(&self, tool: &str, options: &[&str]) -> String {
        let mut command = Command::new(tool);
        let output = command.args(options).arg(&self.path).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    }
}

#[test]
fn the_fmus_library_exports_the_functions_of_both_standards_and_nothing_else() {
    let (Some(library), Some(standard)) = (Library::new(), support::standard_headers()) else {
        return;
    };
    let headers = [2, 3].map(|version| {
        let name = format!("fmi{version}Functions.h");
        std::fs::read_to_string(standard.join(name)).unwrap()
    });
    let declared: BTreeSet<&str> = headers
        .iter()
        .flat_map(|header| header.lines())
        .filter(|line| line.contains("FMI2_Export fmi2") || line.contains("FMI3_Export fmi3"))
        .filter_map(|line| line.trim_end().trim_end_matches(';').rsplit(' ').next())
        .collect();
    assert_eq!(declared.len(), 44 + 75);
    let symbols = library.ask("nm", &["--dynamic", "--defined-only"]);
    let exported: BTreeSet<&str> = symbols
        .lines()
        .filter_map(|line| line.rsplit(' ').next())
        .collect();
    assert_eq!(exported, declared);
}

#[test]
#[ignore = "nightly: of the portable library, which zig links"]
fn the_fmus_library_runs_on_old_machines() {
    let Some(library) = Library::new() else {
        return;
    };
    let symbols = library.ask("objdump", &["--dynamic-syms"]);
    let versions: BTreeSet<Vec<u32>> = symbols
        .split("GLIBC_")
        .skip(1)
        .map(|rest| {
            rest.split(|c: char| !(c.is_ascii_digit() || c == '.'))
                .next()
                .unwrap()
        })
        .map(|version| {
            version
                .split('.')
                .map(|part| part.parse().unwrap())
                .collect()
        })
        .collect();
    let newest = versions.last().expect("the library needs some glibc");
    assert!(newest.as_slice() <= GLIBC.as_slice(), "{newest:?}");

    // Nothing else has to be there.
    let header = library.ask("objdump", &["--private-headers"]);
    let needed: BTreeSet<&str> = header
        .lines()
        .filter_map(|line| line.trim().strip_prefix("NEEDED"))
        .map(|name| name.trim().split(".so").next().unwrap())
        .collect();
    let glibc = BTreeSet::from([
        "ld-linux-x86-64",
        "libc",
        "libdl",
        "libm",
        "libpthread",
        "librt",
    ]);
    assert!(needed.is_subset(&glibc), "{needed:?}");
}
