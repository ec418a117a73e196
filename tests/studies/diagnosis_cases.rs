//! Makes recordings whose truth is known, to develop the diagnosis on:
//!
//! ```text
//! cargo run --release --example diagnosis_cases -- --out DIR --cases 100 --seed 1
//! ```
//!
//! `DIR/CASE/` holds what the tool may see, `DIR/CASE.truth.json` what is behind it.

#[path = "../analysis/diagnosis/cases/mod.rs"]
mod cases;

use cases::{Family, generate, write};
use clap::Parser;
use rayon::prelude::*;
use std::path::PathBuf;
use std::process::ExitCode;

/// Make recordings whose truth is known.
#[derive(Parser)]
struct Args {
    /// Folder to write to
    #[arg(long)]
    out: PathBuf,

    /// Number of cases
    #[arg(long)]
    cases: usize,

    /// Seed; the same gives the same files
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Only cases of this family: nothing, single, sensor, local, pair, lookalike, out,
    /// terrain_change, poor [default: all of them by their shares]
    #[arg(long, value_parser = |name: &str| Family::find(name).ok_or("no such family"))]
    family: Option<Family>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let sequence: Vec<(Family, usize)> = match args.family {
        Some(family) => (0..args.cases).map(|number| (family, number)).collect(),
        None => Family::sequence(args.cases),
    };
    let results: Vec<Result<(), String>> = sequence
        .par_iter()
        .enumerate()
        .map(|(index, (family, number))| {
            let case = generate(*family, *number, args.seed)?;
            let name = format!("case_{index:04}");
            write(&case, &args.out, &name).map_err(|error| format!("{name}: {error}"))
        })
        .collect();
    let failures: Vec<&String> = results.iter().filter_map(|r| r.as_ref().err()).collect();
    for failure in &failures {
        eprintln!("diagnosis_cases: {failure}");
    }
    println!("{} cases", results.len() - failures.len());
    if failures.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
