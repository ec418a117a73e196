//! Files, pipes and messages.

use super::*;
use predicates::prelude::*;
use predicates::str::contains;
use std::process::Stdio;

#[test]
fn standard_streams_serve_as_files() {
    let bench = Bench::new();
    let plain = bench.stdout("simulate --input drive.csv");
    let noisy = DRIVE.replace(',', " , ").replace('\n', "\r\n");
    for input in [DRIVE.to_owned(), format!("\u{feff}{noisy}")] {
        let mut command = bench.ugv("simulate --input - --output -");
        command
            .write_stdin(input)
            .assert()
            .success()
            .stdout(plain.clone());
    }
    bench
        .ugv("simulate --input drive.csv --output motion.csv")
        .assert()
        .success()
        .stdout("");
    assert_eq!(bench.read("motion.csv"), plain);
    assert_eq!(bench.files(), ["drive.csv", "motion.csv"]);
}

#[test]
fn summary_can_be_silenced() {
    let bench = Bench::new();
    let summary = contains("simulated 0.65 s")
        .and(contains("drove"))
        .and(contains("real time"));
    bench
        .ugv("simulate --input drive.csv")
        .assert()
        .success()
        .stderr(summary);
    bench
        .ugv("simulate --input drive.csv --quiet")
        .assert()
        .success()
        .stderr("");
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let bench = Bench::new();
    for target in ["no/such/folder.csv", "."] {
        let message = bench.fails(&format!("simulate --input drive.csv --output {target}"), 1);
        assert!(
            message.starts_with(&format!("ugv: error: cannot write {target}: ")),
            "{message}"
        );
    }
    assert_eq!(bench.files(), ["drive.csv"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_place_that_takes_no_file_is_reported_in_the_system_s_words() {
    let bench = Bench::new();
    // Where nobody can make a file, whatever the rights; the temporary name is nobody's business.
    let message = bench.fails("simulate --input drive.csv --output /proc/motion.csv", 1);
    let expected =
        "ugv: error: cannot write /proc/motion.csv: No such file or directory (os error 2)\n";
    assert!(message.starts_with(expected), "{message}");
    assert!(!message.contains(".ugv-"), "{message}");
}

#[test]
fn closed_pipe_is_no_error() {
    let bench = Bench::new();
    for arguments in [
        "simulate --input drive.csv --output-step 1e-5",
        "terrains",
        "--help",
    ] {
        let mut child = std::process::Command::new(UGV)
            .current_dir(bench.0.path())
            .args(arguments.split_whitespace())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments}: {message}");
        assert!(!message.contains("panic"), "{message}");
    }
}

#[test]
fn completions_name_the_subcommands() {
    let bench = Bench::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert_contains(&bench.stdout(&format!("completions {shell}")), "simulate");
    }
    assert_eq!(
        bench.stdout("--version"),
        format!(
            "ugv {} ({})\n",
            env!("CARGO_PKG_VERSION"),
            env!("UGV_TARGET")
        )
    );
}

#[test]
#[cfg(unix)]
fn replaced_files_keep_their_permissions_and_links() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let bench = Bench::new();
    bench.write("real.csv", "old");
    fs::set_permissions(bench.path("real.csv"), fs::Permissions::from_mode(0o640)).unwrap();
    symlink("real.csv", bench.path("link.csv")).unwrap();
    bench
        .ugv("simulate --input drive.csv --output link.csv --force")
        .assert()
        .success();
    assert!(
        fs::symlink_metadata(bench.path("link.csv"))
            .unwrap()
            .is_symlink()
    );
    assert_eq!(
        fs::metadata(bench.path("real.csv"))
            .unwrap()
            .permissions()
            .mode()
            & 0o777,
        0o640
    );
    assert!(bench.read("real.csv").starts_with("time,"));
}
