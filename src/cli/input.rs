//! Wheel speeds that drive a simulation.

use super::columns::ColumnArgs;
use super::failure::Failure;
use super::output::{is_stream, notify};
use std::fs::File;
use std::io;
use std::path::Path;
use ugv_terrain::recording::{CsvError, Drive, TableOptions, read_drive_of, upper_median};

/// Wheel speeds above this cause a warning \[rad/s\]. `ugv inspect` takes it as the limit of a ground vehicle, too.
const FAST: f64 = 200.0;
/// A median interval above this causes a warning \[s\]: no recording is so slow.
const SLOW: f64 = 5.0;
/// With fewer rows the intervals cause no warning.
const MIN_ROWS: usize = 20;
/// A gap causes a warning from this length on \[s\], and from this multiple of the median interval on.
const GAP: (f64, f64) = (10.0, 50.0);

/// Reads wheel speeds from a file, or from standard input for `-`. The wheel radius \[m\] converts speeds of rims. Notes
/// name the columns of other names.
pub fn read_input(
    path: &Path,
    columns: &ColumnArgs,
    wheel_radius: f64,
    quiet: bool,
) -> Result<Drive, Failure> {
    let options = TableOptions {
        columns: &columns.columns,
        wheel_radius: Some(wheel_radius),
    };
    let (drive, notes) = if is_stream(path) {
        read_drive_of("standard input", io::stdin().lock(), &options)?
    } else {
        read_file(path, |file, input| read_drive_of(file, input, &options))?
    };
    if !quiet {
        notes
            .iter()
            .for_each(|note| notify(&format!("note: {note}")));
    }
    Ok(drive)
}

/// Reads a file; errors have its name.
pub fn read_file<T>(
    path: &Path,
    read: impl FnOnce(&str, File) -> Result<T, CsvError>,
) -> Result<T, Failure> {
    let file = path.display().to_string();
    match File::open(path) {
        Ok(input) => Ok(read(&file, input)?),
        Err(source) => Err(CsvError::Read { file, source }.into()),
    }
}

/// A note on missing wheel speeds, if any are missing.
pub fn filled(drive: &Drive) -> Option<String> {
    (drive.filled_rows > 0).then(|| {
        format!(
            "note: {} of {} rows lack a wheel speed; it is interpolated",
            drive.filled_rows,
            drive.len()
        )
    })
}

/// Warnings of unlikely wheel speeds and times, which are used as they are.
pub fn doubts(drive: &Drive) -> Vec<String> {
    let mut doubts = Vec::new();
    let speeds = drive.omega_left.iter().chain(&drive.omega_right);
    let fastest = speeds.map(|speed| speed.abs()).fold(0.0, f64::max);
    if fastest > FAST {
        doubts.push(format!(
            "warning: the wheels turn at up to {fastest:.0} rad/s: if the file has deg/s or rpm, convert it first \
             (`ugv inspect` finds the units of a recording with a pose)"
        ));
    }
    let intervals = drive.time.windows(2).map(|pair| pair[1] - pair[0]);
    let median = upper_median(intervals.collect()).filter(|_| drive.len() >= MIN_ROWS);
    let Some(median) = median else {
        return doubts;
    };
    if median > SLOW {
        doubts.push(format!(
            "warning: the rows are {median} s apart: if the file has milliseconds or less, convert it first"
        ));
    }
    let longest = GAP.0.max(GAP.1 * median);
    let pairs = drive.time.windows(2);
    let gaps: Vec<_> = pairs.filter(|pair| pair[1] - pair[0] > longest).collect();
    if let Some((first, others)) = gaps.split_first() {
        let others = match others.len() {
            0 => String::new(),
            more => format!(" ({more} more such gaps)"),
        };
        doubts.push(format!(
            "warning: no row from {} to {} s{others}: the wheel speeds are interpolated over the gap; if the recording \
             paused there, give the rows before and after it as two files",
            milliseconds(first[0]),
            milliseconds(first[1])
        ));
    }
    doubts
}

/// A time rounded to milliseconds \[s\].
fn milliseconds(time: f64) -> f64 {
    (1e3 * time).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Doubts about 50 rows at these intervals, with a gap after row 30.
    fn doubts_of(step: f64, speed: f64, gap: f64) -> Vec<String> {
        let time: Vec<f64> = (0..50)
            .map(|row| step * f64::from(row) + if row > 30 { gap } else { 0.0 })
            .collect();
        doubts(&Drive {
            omega_left: vec![1.0; time.len()],
            omega_right: vec![-speed; time.len()],
            time,
            filled_rows: 0,
        })
    }

    #[test]
    fn degrees_and_milliseconds_and_gaps_are_doubted() {
        assert!(doubts_of(0.1, 12.0, 9.0).is_empty());
        for (doubts, expected) in [
            (
                doubts_of(0.1, 12.0_f64.to_degrees(), 0.0),
                "up to 688 rad/s",
            ),
            (doubts_of(0.1, 1.0, 3600.0), "no row from 3 to 3603.1 s:"),
            (doubts_of(100.0, 12.0, 0.0), "100 s apart"),
        ] {
            assert!(
                doubts.len() == 1 && doubts[0].contains(expected),
                "{doubts:?}"
            );
        }
    }
}
