//! The command-line tool as its users call it.

#![cfg(feature = "cli")]

mod diagnose;
mod effects;
mod fit;
mod foreign;
#[path = "../common/formats.rs"]
mod formats;
#[path = "../common/page.rs"]
mod generated;
mod inspect;
#[path = "../common/libraries.rs"]
mod libraries;
mod package;
mod page;
mod refusals;
mod score;
mod simulate;
mod streams;
mod sweep;
mod tables;

use assert_cmd::Command;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

const UGV: &str = env!("CARGO_BIN_EXE_ugv");
const DRIVE: &str = "time,omega_left,omega_right\n0,2,2\n0.1,4,4\n0.3,6,5.5\n0.65,7,5\n";

/// A folder with files to work on.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(TempDir::new().unwrap());
        bench.write("drive.csv", DRIVE);
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn ugv(&self, arguments: &str) -> Command {
        let mut command = Command::new(UGV);
        command
            .current_dir(self.0.path())
            .args(arguments.split_whitespace());
        command
    }

    /// Runs and returns standard output.
    fn stdout(&self, arguments: &str) -> String {
        let output = self
            .ugv(arguments)
            .assert()
            .success()
            .get_output()
            .stdout
            .clone();
        String::from_utf8(output).unwrap()
    }

    /// Runs, expects failure with this status, and returns the message.
    fn fails(&self, arguments: &str, status: i32) -> String {
        let assert = self.ugv(arguments).assert().code(status).stdout("");
        String::from_utf8(assert.get_output().stderr.clone()).unwrap()
    }
}

#[track_caller]
fn assert_contains(text: &str, expected: &str) {
    assert!(text.contains(expected), "no `{expected}` in: {text}");
}

/// The rows after the header.
fn numbers(csv: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    csv.lines().skip(1).map(row).collect()
}

fn column(csv: &str, name: &str) -> Vec<f64> {
    let index = csv
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|cell| cell == name)
        .unwrap();
    numbers(csv).iter().map(|row| row[index]).collect()
}
