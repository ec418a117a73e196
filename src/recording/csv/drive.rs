//! A drive from CSV: the input of a simulation, without any corrections.

use super::error::{CsvError, malformed};
use super::table::{ColumnSpec, RUN, TableHeader, TableRow, quoted, read_bytes, read_table};
use crate::display::number;
use crate::recording::channel::Channel;
use crate::recording::drive::Drive;
use std::io::Read;

const TIME: usize = 0;
const OMEGA_LEFT: usize = 1;
const OMEGA_RIGHT: usize = 2;
const RUN_INDEX: usize = 3;
/// The columns at the indices above.
const COLUMNS: [ColumnSpec; 4] = [
    ColumnSpec::required("time", "s"),
    ColumnSpec::required("omega_left", "rad/s"),
    ColumnSpec::required("omega_right", "rad/s"),
    RUN,
];

/// Longest interval of a drive \[s\]: no wheel speed is held, or changes steadily, for a day.
const LONGEST: f64 = 86_400.0;
/// Maximum wheel speed \[rad/s\]; differences of such speeds are finite.
const FASTEST: f64 = 1e6;

/// Reads the wheel speeds of one drive. `file` names it in errors.
///
/// # Errors
/// The first malformed cell, with its line and column.
pub fn read_drive(file: &str, input: impl Read) -> Result<Drive, CsvError> {
    let bytes = read_bytes(file, input)?;
    let mut rows = Rows::default();
    let header = read_table(file, &bytes, &COLUMNS, |row| rows.push(row))?;
    rows.finish(&header)
}

/// A wheel speed; `None` for an empty cell.
fn speed(row: &TableRow, index: usize) -> Result<Option<f64>, CsvError> {
    let speed = row.number(index)?;
    match speed.filter(|speed| speed.abs() > FASTEST) {
        Some(found) => {
            let expected = format!("a wheel speed within {FASTEST:e} rad/s");
            Err(malformed(row.cell(index), format!("{found:e}"), expected))
        }
        None => Ok(speed),
    }
}

/// The rows so far.
#[derive(Default)]
struct Rows {
    time: Vec<f64>,
    omega_left: Vec<Option<f64>>,
    omega_right: Vec<Option<f64>>,
    /// Label of the first row's run.
    run: Vec<u8>,
}

impl Rows {
    fn push(&mut self, row: &TableRow) -> Result<(), CsvError> {
        let (time, run) = (row.required_number(TIME)?, row.bytes(RUN_INDEX));
        if self.time.is_empty() {
            self.run = run.into();
        } else if self.run != run {
            // Also if the clock continues: speeds must not be interpolated between runs.
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

    fn finish(self, header: &TableHeader) -> Result<Drive, CsvError> {
        if self.time.is_empty() {
            return Err(header.no_rows(TIME));
        }
        let drive = Drive::interpolated(self.time, &self.omega_left, &self.omega_right);
        drive.map_err(|channel| {
            header.no_numbers(if channel == Channel::OmegaLeft {
                OMEGA_LEFT
            } else {
                OMEGA_RIGHT
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Drive, CsvError> {
        read_drive("drive.csv", text.as_bytes())
    }

    fn error(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    const HEADER: &str = "time,omega_left,omega_right\n";

    #[test]
    fn reads_columns_in_any_order_among_others() {
        let drive =
            read("note,omega_right,time,x,omega_left\nstart,3,0,,1\n,4.5,0.5,nan,-2e-1\n").unwrap();
        assert_eq!(drive.time, [0.0, 0.5]);
        assert_eq!(drive.omega_left, [1.0, -0.2]);
        assert_eq!(drive.omega_right, [3.0, 4.5]);
        assert_eq!(drive.filled_rows, 0);
    }

    #[test]
    fn forgives_what_editors_do() {
        let plain = read("time,omega_left,omega_right\n0,1,2\n1,3,4\n").unwrap();
        for text in [
            "\u{feff}time,omega_left,omega_right\r\n0,1,2\r\n1,3,4\r\n",
            " time ,\tomega_left, omega_right\n 0, 1 ,2 \n1,3,4",
            "\"time\",\"omega_left\",\"omega_right\"\n\n\"0\",1,2\n1,3,4\n\n   \n",
        ] {
            assert_eq!(read(text).unwrap(), plain, "{text:?}");
        }
    }

    #[test]
    fn one_row_is_a_drive() {
        let drive = read("time,omega_left,omega_right\n2,1,1\n").unwrap();
        assert_eq!((drive.len(), drive.duration()), (1, 0.0));
    }

    #[test]
    fn empty_cells_of_wheel_speeds_are_missing_samples() {
        let drive = read("time,omega_left,omega_right\n0,1,2\n1,,4\n2,5,\n").unwrap();
        assert_eq!(drive.omega_left, [1.0, 3.0, 5.0]);
        assert_eq!(drive.omega_right, [2.0, 4.0, 4.0]);
        assert_eq!(drive.filled_rows, 2);
    }

    #[test]
    fn faults_are_located_and_explained() {
        let of = |rows: &str| error(&format!("{HEADER}{rows}"));
        for (found, expected) in [
            (
                error(""),
                "drive.csv: line 1, column 1: found an empty file, expected a header with time, omega_left, omega_right",
            ),
            (
                error(HEADER),
                "drive.csv: line 2, column 1 (time): found the end of the file, expected at least one row of numbers",
            ),
            (
                of("0,1,2\n0.1,abc,2\n"),
                "drive.csv: line 3, column 2 (omega_left): found `abc`, expected a number [rad/s]",
            ),
            (
                of("0,1,NaN\n"),
                "drive.csv: line 2, column 3 (omega_right): found `NaN`, expected a finite number [rad/s]",
            ),
            (
                of("inf,1,2\n"),
                "drive.csv: line 2, column 1 (time): found `inf`, expected a finite number [s]",
            ),
            (
                of("0,1,1e999\n"),
                "drive.csv: line 2, column 3 (omega_right): found `1e999`, expected a finite number [rad/s]",
            ),
            (
                of("0,1,2\n\n1,2\n"),
                "drive.csv: line 4, column 3 (omega_right): found 2 cells, expected 3 as in the header",
            ),
            (
                of("0,5,1,5,2,5\n"),
                "drive.csv: line 2, column 4: found 6 cells, expected 3 as in the header",
            ),
            (
                of("0,1,2\n0.5,1,2\n0.5,1,2\n"),
                "drive.csv: line 4, column 1 (time): found 0.5, expected a time later than 0.5 s",
            ),
            (
                of("0,1,2\n2000000,1,2\n"),
                "drive.csv: line 3, column 1 (time): found 2000000, expected a time within 86400 s of the one before, 0 s \
                 (does the clock count milliseconds or less?)",
            ),
            (
                of("0,1,-1e308\n"),
                "drive.csv: line 2, column 3 (omega_right): found -1e308, expected a wheel speed within 1e6 rad/s",
            ),
            (
                of(",1,2\n"),
                "drive.csv: line 2, column 1 (time): found an empty cell, expected a number [s]",
            ),
            (
                of("0,,2\n1,,2\n"),
                "drive.csv: line 3, column 2 (omega_left): found nothing but empty cells, \
                 expected at least one number [rad/s]",
            ),
            (
                error("time,omega_lft,omega_right\n0,1,2\n"),
                "drive.csv: line 1, column 4: found no column `omega_left` among `time`, `omega_lft`, `omega_right`, \
                 expected a header with time, omega_left, omega_right (the nearest is `omega_lft`)",
            ),
            (
                error("Time [s],omega_left,omega_right\n0,1,2\n"),
                "drive.csv: line 1, column 4: found no column `time` among `Time [s]`, `omega_left`, `omega_right`, \
                 expected a header with time, omega_left, omega_right (name the column `time` instead of `Time [s]`)",
            ),
            (
                error("time;omega_left;omega_right\n0;1;2\n"),
                "drive.csv: line 1, column 2: found no column `time` among `time;omega_left;omega_right`, \
                 expected a header with time, omega_left, omega_right (separate the cells by commas)",
            ),
            (
                error("0,1,2\n1,1,2\n"),
                "drive.csv: line 1, column 4: found no column `time` among `0`, `1`, `2`, \
                 expected a header with time, omega_left, omega_right (put the header above the first row of numbers)",
            ),
            (
                error("time,time,omega_left,omega_right\n0,1,2,3\n"),
                "drive.csv: line 1, column 2 (time): found a second column `time`, expected one of each",
            ),
        ] {
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn several_runs_in_one_file_are_no_drive() {
        // Neither where the clock starts anew nor where it goes on.
        for time in [0.0, 100.0] {
            let message = error(&format!(
                "run,time,omega_left,omega_right\na,5,1,1\nb,{time},1,1\n"
            ));
            assert!(
                message.contains("line 3, column 1 (run): found `b`, expected `a` as in the first row: one drive (a file"),
                "{message}"
            );
        }
        assert_eq!(
            read("run,time,omega_left,omega_right\n3,5,1,1\n3,6,1,1\n")
                .unwrap()
                .len(),
            2
        );
    }

    #[test]
    fn an_open_quote_swallows_no_rows() {
        let rows = "1,1,1,\"\n2,2,2,\"\n3,3,3,\"\n4,4,4,\"\n";
        for (rows, line) in [
            (rows, 2),
            ("0,1,1,\"start\n1,1,1,\n", 2),
            ("0,1,1,a\n1,1,1,\"b\nc\"\n", 3),
        ] {
            let message = error(&format!("time,omega_left,omega_right,note\n{rows}"));
            let expected = format!(
                "drive.csv: line {line}, column 4 (note): found a quote that is not closed on its line, expected cells of one line"
            );
            assert!(message.starts_with(&expected), "{message}");
        }
        // In the header as well.
        for (header, column) in [
            ("time,omega_left,omega_right,\"note", 4),
            ("\"time,omega_left,omega_right", 1),
        ] {
            let message = error(&format!("{header}\n0,1,1,a\n1,1,1,\"b\"\n2,1,1,c\n"));
            let expected = format!(
                "drive.csv: line 1, column {column}: found a quote that is not closed on its line"
            );
            assert!(message.starts_with(&expected), "{message}");
        }
        let quoted = read("time,omega_left,omega_right,note\n0,1,1,\"a, \"\"b\"\"\"\n1,1,1,5\"\n");
        assert_eq!(quoted.unwrap().len(), 2);
    }

    #[test]
    fn bytes_that_are_not_text_are_shown() {
        let error =
            read_drive("drive.csv", &b"time,omega_left,omega_right\n0,\xff,1\n"[..]).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("column 2 (omega_left): found `\u{fffd}`"),
            "{error}"
        );
    }

    #[test]
    fn lines_are_counted_as_editors_do() {
        for (end, mark) in [("\n", ""), ("\r\n", ""), ("\r", ""), ("\r\n", "\u{feff}")] {
            let text = format!("{mark}time,omega_left,omega_right\n0,1,2\n\n1,1,2\n2,x,2\n")
                .replace('\n', end);
            assert!(
                error(&text).starts_with("drive.csv: line 5, column 2 (omega_left)"),
                "{end:?}"
            );
        }
    }
}
