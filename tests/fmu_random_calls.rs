//! 100 000 random calls of all 44 functions, in and out of order, on several instances and states,
//! from C (`fmu_host.c`): no crash, no memory error, no leak, and the same results however the
//! calls of independent instances interleave.

#![cfg(feature = "cli")]

mod support;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::Command;

const CALLS: &str = "100000";
const SEED: &str = "20071121";

/// The host program, the unpacked FMU and its guid.
struct Bench {
    folder: tempfile::TempDir,
    guid: String,
}

impl Bench {
    /// Compiles the host and unpacks the FMU; `None`, and says so, where something is missing.
    fn new() -> Option<Self> {
        let (fmu, headers) = (support::fmu()?, support::standard_headers()?);
        if !support::has("gcc", "gcc libc6-dev") {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let mut archive = zip::ZipArchive::new(std::fs::File::open(&fmu).unwrap()).unwrap();
        archive.extract(folder.path()).unwrap();
        let description = folder.path().join("modelDescription.xml");
        let description = std::fs::read_to_string(description).unwrap();
        let (_, rest) = description.split_once(" guid=\"").unwrap();
        let guid = rest.split_once('"').unwrap().0.to_owned();
        let bench = Self { folder, guid };
        let compiled = Command::new("gcc")
            .args([
                "-std=c11",
                "-D_GNU_SOURCE",
                "-O1",
                "-g",
                "-Wall",
                "-Wextra",
                "-Werror",
            ])
            .arg("-I")
            .arg(headers)
            .arg("-I")
            .arg(support::root().join("modelDescription"))
            .arg("-o")
            .arg(bench.host())
            .arg(support::root().join("tests/fmu_host.c"))
            .args(["-ldl", "-lm", "-lpthread"])
            .status()
            .unwrap();
        assert!(compiled.success());
        Some(bench)
    }

    fn host(&self) -> PathBuf {
        self.folder.path().join("fmu_host")
    }

    /// Runs the host through `command`; how often each function returned each status.
    fn run(&self, mut command: Command, ways: &[&str]) -> HashMap<String, [u64; 4]> {
        let path = |name: &str| self.folder.path().join(name);
        let output = command
            .arg(path("binaries/linux64/ugv.so"))
            .arg(uri(&path("resources")))
            .args([&self.guid, SEED, CALLS])
            .args(ways)
            .output()
            .unwrap();
        let (said, errors) = (
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr),
        );
        assert!(output.status.success(), "{}\n{errors}", output.status);
        said.lines().map(counts).collect()
    }
}

fn uri(path: &Path) -> String {
    format!("file://{}", path.display())
}

fn counts(line: &str) -> (String, [u64; 4]) {
    let mut words = line.split(' ');
    let name = words.next().unwrap().to_owned();
    let counts: Vec<u64> = words.map(|word| word.parse().unwrap()).collect();
    (name, counts.try_into().unwrap())
}

/// Functions that never succeed with this FMU, whose steps are never pending.
const NEVER: [&str; 4] = [
    "fmi2CancelStep",
    "fmi2GetStatus",
    "fmi2GetIntegerStatus",
    "fmi2GetStringStatus",
];

/// Calls that always succeed.
const ALWAYS: [&str; 3] = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2FreeInstance"];

/// The calls mean something only if enough of them get somewhere.
fn assert_variety(counts: &HashMap<String, [u64; 4]>) {
    assert_eq!(counts.len(), 44);
    for (name, [ok, _warning, discard, error]) in counts {
        assert_eq!(*ok == 0, NEVER.contains(&name.as_str()), "{name}");
        assert_eq!(*error == 0, ALWAYS.contains(&name.as_str()), "{name}");
        let status = name.ends_with("Status");
        assert_eq!(*discard > 0, status, "{name}");
    }
    assert!(counts["fmi2DoStep"][0] > 1000, "{counts:?}");
    assert!(counts["fmi2GetDerivatives"][0] > 500, "{counts:?}");
    assert!(counts["fmi2SetFMUstate"][0] > 500, "{counts:?}");
    assert!(counts["fmi2DeSerializeFMUstate"][3] > 500, "{counts:?}");
}

#[test]
fn random_calls_give_the_same_mixed_one_after_the_other_and_in_threads() {
    let Some(bench) = Bench::new() else {
        return;
    };
    let counts = bench.run(Command::new(bench.host()), &["mixed", "serial", "threads"]);
    assert_variety(&counts);
}

#[test]
fn random_calls_make_no_memory_error_and_leak_nothing() {
    let Some(bench) = Bench::new() else {
        return;
    };
    if !support::has("valgrind", "valgrind") {
        return;
    }
    let mut valgrind = Command::new("valgrind");
    let kinds = "definite,indirect,possible";
    valgrind
        .args(["--quiet", "--error-exitcode=99", "--leak-check=full"])
        .args([
            format!("--show-leak-kinds={kinds}"),
            format!("--errors-for-leak-kinds={kinds}"),
        ])
        .arg(format!(
            "--suppressions={}",
            support::root().join("tests/fmu_host.supp").display()
        ))
        .arg(bench.host());
    assert_variety(&bench.run(valgrind, &["mixed"]));
}
