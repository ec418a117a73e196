//! `ugv inspect`: what a recording is worth, before anything is fitted to it.

use super::output::{Output, finish_all, print};
use super::{Failure, tell};
use std::path::{Path, PathBuf};
use ugv_terrain::inspection::inspect;
use ugv_terrain::recording::read_recording;
use ugv_terrain::report::inspection::{json, page, text};

const EXAMPLES: &str = "\
Examples:
  ugv inspect drive.csv
  ugv inspect drive.csv --page drive.html --json drive.inspection.json --quiet

Input:   CSV with time,omega_left,omega_right [s, rad/s] and any of x,y [m], heading [rad], v_x,v_y
         [m/s], yaw_rate [rad/s], a_x,a_y [m/s^2]; an empty cell is a missing sample, and so is nan;
         a column `run` marks separate runs. Other columns are not read. drive.json beside
         drive.csv may give vehicle, terrain and sensors.
Repairs: wrong units, swapped columns, late rows and wrapped headings are corrected and noted if the
         correction is unambiguous; otherwise the file is refused.
Delays:  positive if the first signal is late against the second. Those against the wheels include
         the response time of the vehicle: up to 0.3 s in turns.";

/// Inspect a recording: rates, gaps, noise, and delays between its sensors.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The recording
    #[arg(value_name = "REC.csv")]
    recording: PathBuf,

    /// Write everything as JSON; - writes to standard output
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,

    /// Write a page with plots
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,

    /// No text, only the requested files
    #[arg(long, short)]
    quiet: bool,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let mut files = Vec::new();
    for path in [&args.json, &args.page].into_iter().flatten() {
        files.push(Output::of(Some(path), [&args.recording])?);
    }
    if let [json, page] = &files[..]
        && json.collides_with(page)
    {
        return Err(Failure::Argument {
            reason: "--json and --page lead to the same place".into(),
            hint: None,
        });
    }
    let recording = read_recording(&args.recording)?;
    let inspection = inspect(&recording);
    let texts = [
        args.json.as_ref().map(|_| json(&recording, &inspection)),
        args.page.as_ref().map(|_| page(&recording, &inspection)),
    ];
    let filled = files.into_iter().zip(texts.iter().flatten());
    let filled: Result<Vec<_>, _> = filled.map(|(file, text)| file.with(text)).collect();
    finish_all(filled?)?;
    if args.quiet {
        return Ok(());
    }
    let text = text(&recording, &inspection);
    let taken = [&args.json, &args.page];
    if taken
        .into_iter()
        .flatten()
        .any(|path| path == Path::new("-"))
    {
        // Standard output is taken.
        text.lines().for_each(tell);
        return Ok(());
    }
    print(&text)
}
