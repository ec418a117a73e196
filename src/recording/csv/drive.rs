//! A drive from CSV: a simulation's input, in which nothing is put right.

use super::RUN;
use super::error::{CsvError, malformed};
use super::table::{Column, Header, Row, quoted, read_bytes, read_table};
use crate::display::number;
use crate::recording::{Drive, fill_gaps};
use std::io::Read;

const TIME: usize = 0;
const OMEGA_LEFT: usize = 1;
const OMEGA_RIGHT: usize = 2;
const RUN_INDEX: usize = 3;
/// What every recording has, and the run, at the indices above.
const COLUMNS: [Column; 4] = [
    required("time", "s"),
    required("omega_left", "rad/s"),
    required("omega_right", "rad/s"),
    Column {
        name: RUN,
        unit: "-",
        is_required: false,
    },
];

/// Longer intervals are none of a drive's \[s\]: nobody holds a wheel speed, or changes it steadily, for a day.
const LONGEST: f64 = 86_400.0;
/// No wheel is faster \[rad/s\]; differences of such speeds are finite.
const FASTEST: f64 = 1e6;

const fn required(name: &'static str, unit: &'static str) -> Column {
    Column {
        name,
        unit,
        is_required: true,
    }
}

/// Reads the wheel speeds of one drive. `file` names it in errors.
///
/// # Errors
/// The first thing that makes the text no drive, with its line and column.
pub fn read_drive(file: &str, input: impl Read) -> Result<Drive, CsvError> {
    let bytes = read_bytes(file, input)?;
    let mut rows = Rows::default();
    let header = read_table(file, &bytes, &COLUMNS, |row| rows.push(row))?;
    rows.finish(&header)
}

/// A wheel speed, or nothing where the cell is empty.
fn speed(row: &Row, index: usize) -> Result<Option<f64>, CsvError> {
    let speed = row.number(index)?;
    match speed.filter(|speed| speed.abs() > FASTEST) {
        Some(found) => {
            let expected = format!("a wheel speed within {FASTEST:e} rad/s");
            Err(malformed(row.cell(index), format!("{found:e}"), expected))
        }
        None => Ok(speed),
    }
}

/// What has been read so far.
#[derive(Default)]
struct Rows {
    time: Vec<f64>,
    omega_left: Vec<Option<f64>>,
    omega_right: Vec<Option<f64>>,
    /// Label of the first row's run.
    run: Vec<u8>,
}

impl Rows {
    fn push(&mut self, row: &Row) -> Result<(), CsvError> {
        let (time, run) = (row.required_number(TIME)?, row.bytes(RUN_INDEX));
        if self.time.is_empty() {
            self.run = run.into();
        } else if self.run != run {
            // Also where its clock goes on: what lies between was not driven at the speeds between.
            let expected = format!(
                "{} as in the first row: one drive (a file with several runs holds several drives: cut out one)",
                quoted(&self.run)
            );
            return Err(malformed(row.cell(RUN_INDEX), quoted(run), expected));
        }
        if let Some(&before) = self.time.last()
            && time <= before
        {
            let expected = format!("a time later than {} s", number(before));
            return Err(malformed(row.cell(TIME), number(time), expected));
        }
        if let Some(&before) = self.time.last()
            && time - before > LONGEST
        {
            let expected = format!(
                "a time within {LONGEST} s of the one before, {} s (does the clock count milliseconds or less?)",
                number(before)
            );
            return Err(malformed(row.cell(TIME), number(time), expected));
        }
        self.time.push(time);
        self.omega_left.push(speed(row, OMEGA_LEFT)?);
        self.omega_right.push(speed(row, OMEGA_RIGHT)?);
        Ok(())
    }

    fn finish(self, header: &Header) -> Result<Drive, CsvError> {
        if self.time.is_empty() {
            return Err(header.no_rows(TIME));
        }
        let column = |samples: &[Option<f64>], index: usize| {
            fill_gaps(&self.time, samples).ok_or_else(|| header.no_numbers(index))
        };
        let pairs = self.omega_left.iter().zip(&self.omega_right);
        Ok(Drive {
            omega_left: column(&self.omega_left, OMEGA_LEFT)?,
            omega_right: column(&self.omega_right, OMEGA_RIGHT)?,
            filled_rows: pairs
                .filter(|(left, right)| left.is_none() || right.is_none())
                .count(),
            time: self.time,
        })
    }
}

#[cfg(test)]
mod tests;
