//! The wheel speeds that a drive is made of.

use crate::cli::Failure;
use std::fs::File;
use std::io;
use std::path::Path;
use ugv_terrain::recording::{CsvError, Drive, read_drive, upper_median};

/// Faster wheels are told of \[rad/s\]: `ugv inspect` takes none of a ground vehicle's for faster.
const FAST: f64 = 200.0;
/// So many rows further apart than this \[s\] are told of: recordings are not so slow.
const SLOW: f64 = 5.0;
const ROWS: usize = 20;
/// A gap is told of where it is longer than this \[s\] and than so many usual intervals.
const GAP: (f64, f64) = (10.0, 50.0);

/// Reads wheel speeds from a file, or from standard input for `-`.
pub fn read_input(path: &Path) -> Result<Drive, Failure> {
    if path == Path::new("-") {
        return read_drive("standard input", io::stdin().lock()).map_err(Failure::Recording);
    }
    read_file(path, read_drive)
}

/// Reads a file, and names it where it cannot.
pub fn read_file<T>(
    path: &Path,
    read: impl FnOnce(&str, File) -> Result<T, CsvError>,
) -> Result<T, Failure> {
    let file = path.display().to_string();
    let opened = File::open(path);
    opened
        .map_err(|source| CsvError::Read {
            file: file.clone(),
            source,
        })
        .and_then(|input| read(&file, input))
        .map_err(Failure::Recording)
}

/// Says that wheel speeds are missing.
pub fn filled(drive: &Drive) -> String {
    format!(
        "note: {} of {} rows lack a wheel speed; it was interpolated",
        drive.filled_rows,
        drive.len()
    )
}

/// Says what is unlikely in wheel speeds, which are taken as they stand.
pub fn doubts(drive: &Drive) -> impl Iterator<Item = String> + use<> {
    let speeds = drive.omega_left.iter().chain(&drive.omega_right);
    let fastest = speeds.fold(0.0, |most: f64, speed| most.max(speed.abs()));
    let fast = (fastest > FAST).then(|| {
        format!(
            "warning: wheels turn at up to {fastest:.0} rad/s: if the file has deg/s or rpm, convert it first \
             (`ugv inspect` tells the units of a recording with a pose)"
        )
    });
    let rows = drive.time.windows(2).map(|pair| pair[1] - pair[0]);
    let usual = upper_median(rows.collect()).filter(|_| drive.len() >= ROWS);
    let slow = usual.filter(|usual| *usual > SLOW).map(|usual| {
        format!(
            "warning: rows are {usual} s apart: if the file has milliseconds or less, convert it first"
        )
    });
    let gap = usual.and_then(|usual| {
        let longest = GAP.0.max(GAP.1 * usual);
        let pairs = drive.time.windows(2);
        let gaps: Vec<_> = pairs.filter(|pair| pair[1] - pair[0] > longest).collect();
        let (first, more) = (gaps.first()?, gaps.len() - 1);
        let others = if more > 0 { format!(" ({more} more such gaps)") } else { String::new() };
        Some(format!(
            "warning: no row from {} to {} s{others}: the wheels are taken to turn on, from one speed to the next; if the \
             recording paused there, give what comes before and after as two files",
            milliseconds(first[0]),
            milliseconds(first[1])
        ))
    });
    fast.into_iter().chain(slow).chain(gap)
}

/// A time rounded to milliseconds \[s\].
fn milliseconds(time: f64) -> f64 {
    (1e3 * time).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn doubts_of(step: f64, speed: f64) -> Vec<String> {
        let time: Vec<f64> = (0..50).map(|row| step * f64::from(row)).collect();
        let drive = Drive {
            omega_left: vec![1.0; time.len()],
            omega_right: vec![-speed; time.len()],
            time,
            filled_rows: 0,
        };
        doubts(&drive).collect()
    }

    #[test]
    fn wheel_speeds_in_degrees_and_times_in_milliseconds_are_doubted() {
        assert!(doubts_of(0.1, 12.0).is_empty());
        let fast = doubts_of(0.1, 12.0_f64.to_degrees());
        assert!(
            fast.len() == 1 && fast[0].contains("up to 688 rad/s"),
            "{fast:?}"
        );
        let gap = |length: f64| {
            let time: Vec<f64> = (0..50)
                .map(|row| 0.1 * f64::from(row) + if row > 30 { length } else { 0.0 })
                .collect();
            let speeds = vec![1.0; time.len()];
            let drive = Drive {
                omega_left: speeds.clone(),
                omega_right: speeds,
                time,
                filled_rows: 0,
            };
            doubts(&drive).collect::<Vec<_>>()
        };
        assert!(gap(9.0).is_empty());
        let told = gap(3600.0);
        assert!(
            told.len() == 1 && told[0].contains("no row from 3 to 3603.1 s:"),
            "{told:?}"
        );
        let slow = doubts_of(100.0, 12.0);
        assert!(
            slow.len() == 1 && slow[0].contains("100 s apart"),
            "{slow:?}"
        );
    }
}
