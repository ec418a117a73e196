//! `ugv`: drives the wheel–terrain model from the command line.

use std::io::{self, Write};
use std::process::ExitCode;
use ugv_terrain::cli;

fn main() -> ExitCode {
    match cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // A closed standard error is no reason to panic.
            let _ = io::stderr().write_all(failure.report().as_bytes());
            ExitCode::from(failure.status())
        }
    }
}
