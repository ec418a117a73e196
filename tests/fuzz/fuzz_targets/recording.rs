//! Recordings and drives as CSV: what is read has finite values at increasing times, and can be
//! looked at.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::fs;
use ugv_terrain::inspection::inspect;
use ugv_terrain::recording::{read_drive, read_recording};
use ugv_terrain_fuzz::scratch;

/// Between the CSV and the JSON beside it; neither has it.
const BETWEEN: u8 = 0;

/// Maximum number of runs for an inspection, which is slow.
const RUNS: usize = 3;

fuzz_target!(|data: &[u8]| {
    let mut files = data.splitn(2, |byte| *byte == BETWEEN);
    let (csv, json) = (files.next().unwrap_or_default(), files.next());
    let (path, beside) = (scratch("csv"), scratch("json"));
    fs::write(&path, csv).unwrap();
    match json {
        Some(json) => fs::write(&beside, json).unwrap(),
        None => drop(fs::remove_file(&beside)),
    }
    if let Ok(drive) = read_drive("drive.csv", csv) {
        assert!(drive.time.is_sorted_by(|a, b| a < b));
    }
    let Ok(recording) = read_recording(&path) else {
        return;
    };
    for (channel, series) in recording.runs.iter().flat_map(|run| run.channels()) {
        assert!(series.time.is_sorted_by(|a, b| a < b), "{channel:?}");
        assert!(
            series.value.iter().all(|value| value.is_finite()),
            "{channel:?}"
        );
    }
    if recording.runs.len() <= RUNS {
        let _ = inspect(&recording, None);
    }
});
