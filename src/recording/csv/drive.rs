//! A drive from CSV: the input of a simulation, without any corrections.

use super::error::{CsvError, malformed};
use super::request::TableOptions;
use super::table::{ColumnSpec, RUN, TableHeader, TableRow, quoted, read_bytes, read_table};
use super::unit::Quantity;
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
    ColumnSpec::required("time", "s", Quantity::Time),
    ColumnSpec::required("omega_left", "rad/s", Quantity::WheelSpeed),
    ColumnSpec::required("omega_right", "rad/s", Quantity::WheelSpeed),
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
    Ok(read_drive_of(file, input, &TableOptions::default())?.0)
}

/// The same for columns that the user names, with notes: what was taken as what.
///
/// # Errors
/// As [`read_drive`].
pub fn read_drive_of(
    file: &str,
    input: impl Read,
    options: &TableOptions,
) -> Result<(Drive, Vec<String>), CsvError> {
    let bytes = read_bytes(file, input)?;
    let mut rows = Rows::default();
    let header = read_table(file, &bytes, &COLUMNS, options, |row| rows.push(row))?;
    let findings = header.findings().iter();
    let notes =
        findings.map(|finding| format!("{}: {}", COLUMNS[finding.index].name, finding.text));
    Ok((rows.finish(&header)?, notes.collect()))
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

    /// Reads with columns that the user names.
    fn read_named(text: &str, columns: &[&str]) -> Result<(Drive, Vec<String>), CsvError> {
        let columns: Vec<_> = columns.iter().map(|one| one.parse().unwrap()).collect();
        let options = TableOptions {
            columns: &columns,
            wheel_radius: Some(0.5),
        };
        read_drive_of("drive.csv", text.as_bytes(), &options)
    }

    #[test]
    fn reads_what_programs_write() {
        let plain = read("time,omega_left,omega_right\n0,1.5,2\n0.5,3,4\n").unwrap();
        for text in [
            "sep=;\ntime;omega_left;omega_right\n0;1,5;2\n0,5;3;4\n",
            "\"sep=\t\"\r\ntime\tomega_left\tomega_right\r\n0\t1.5\t2\r\n0.5\t3\t4\r\n",
            "# robot 7\ntime,omega_left,omega_right\n0,1.5,2\n# a stop, with \"quotes\"\n0.5,3,4\n",
            "time,omega_left,omega_right,\n0,1.5,2,\n0.5,3,4,\n",
            "time,omega_left,omega_right\n0,1.5,2,\n0.5,3,4,,\n",
            "time,omega_left,omega_right,\n0,1.5,2\n0.5,3,4\n",
            "# time omega_left omega_right\n0.0e+00 1.5e+00 2\n5.0e-01 3 4\n",
            "time,omega_left,omega_right\ns,rad/s,rad/s\n0,1.5,2\n0.5,3,4\n",
            "time,omega_left,omega_right\n[ms],[mrad/s],rad/s\n0,1500,2\n500,3000,4\n",
        ] {
            assert_eq!(read(text).unwrap(), plain, "{text:?}");
        }
        let utf16 = |start: &[u8], bytes: fn(u16) -> [u8; 2]| {
            let text = "time,omega_left,omega_right\r\n0,1.5,2\r\n0.5,3,4\r\n";
            let mut all = start.to_vec();
            all.extend(text.encode_utf16().flat_map(bytes));
            all
        };
        for bytes in [
            utf16(b"\xff\xfe", u16::to_le_bytes),
            utf16(b"\xfe\xff", u16::to_be_bytes),
            utf16(b"", u16::to_le_bytes),
            utf16(b"", u16::to_be_bytes),
        ] {
            assert_eq!(read_drive("drive.csv", &bytes[..]).unwrap(), plain);
        }
    }

    #[test]
    fn columns_are_named_with_their_units() {
        let (drive, notes) = read_named(
            "clock,fl,rl,right:rpm\n0,10,30,60\n1000,20,,120\n",
            &[
                "time=clock:ms",
                "omega_left=fl+rl:deg/s",
                "omega_right=right:rpm:rpm",
            ],
        )
        .unwrap();
        assert_eq!(drive.time, [0.0, 1.0]);
        assert!((drive.omega_left[0] - 20f64.to_radians()).abs() < 1e-15);
        assert!((drive.omega_right[1] - 4.0 * std::f64::consts::PI).abs() < 1e-12);
        assert!(
            notes[1].contains("the mean of columns `fl`, `rl` [deg/s]"),
            "{notes:?}"
        );
        let numbers = ["time=#1", "omega_left=#3:m/s", "omega_right=#2"];
        let (drive, _) = read_named("0,1,2\n1,3,4\n", &numbers).unwrap();
        assert_eq!(
            (drive.omega_left, drive.omega_right),
            (vec![4.0, 8.0], vec![1.0, 3.0])
        );
        for (column, expected) in [
            (
                "omega_left=fi",
                "found no column `fi`, expected the column that `--column omega_left=fi` names (the nearest is `fl`)",
            ),
            (
                "omega_left=fl:m",
                "found the unit `m` in `--column omega_left=fl:m`, expected one of rad/s",
            ),
        ] {
            let error = read_named("time,fl,omega_right\n0,1,1\n", &[column]);
            let error = error.unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        for text in ["omega=x", "heading", "x="] {
            assert!(
                text.parse::<super::super::ColumnRequest>().is_err(),
                "{text}"
            );
        }
    }

    #[test]
    fn other_files_are_named() {
        for (bytes, found) in [
            (&b"PK\x03\x04rest"[..], "a spreadsheet"),
            (b"SQLite format 3\0", "ugv import"),
            (b"\x89MCAP0\r\n", "ugv import"),
        ] {
            let error = read_drive("log.csv", bytes).unwrap_err().to_string();
            assert!(error.contains(found), "{error}");
        }
    }

    #[test]
    fn one_row_is_a_drive() {
        let drive = read("time,omega_left,omega_right\n2,1,1\n").unwrap();
        assert_eq!((drive.len(), drive.duration()), (1, 0.0));
    }

    #[test]
    fn rows_of_separators_alone_are_empty_lines() {
        let drive = read("time,omega_left,omega_right\n0,1,2\n,,\n\n1,3,4\n , ,\n").unwrap();
        assert_eq!(drive.omega_left, [1.0, 3.0]);
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
                "drive.csv: line 3, column 2 (omega_left): found `abc`, expected a number [rad/s], or an empty cell where nothing was measured",
            ),
            (
                of("\"1,000.5\",1,2\n"),
                "drive.csv: line 2, column 1 (time): found `1,000.5`, expected a number [s] without separators of thousands",
            ),
            (
                of("0,1,NaN\n"),
                "drive.csv: line 2, column 3 (omega_right): found `NaN`, expected a finite number [rad/s], or an empty cell where nothing was measured",
            ),
            (
                of("inf,1,2\n"),
                "drive.csv: line 2, column 1 (time): found `inf`, expected a finite number [s]",
            ),
            (
                of("0,1,1e999\n"),
                "drive.csv: line 2, column 3 (omega_right): found `1e999`, expected a finite number [rad/s], or an empty cell where nothing was measured",
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
                 expected a header with time, omega_left, omega_right (`omega_lft` may be it: --column omega_left=omega_lft:UNIT)",
            ),
            (
                error("time,v_left,v_right,x,y\n0,1,2,0,0\n"),
                "drive.csv: line 1, column 6: found no column `omega_left` among `time`, `v_left`, `v_right`, `x`, `y`, \
                 expected a header with time, omega_left, omega_right (`v_left` may be it: \
                 --column omega_left=v_left:UNIT)",
            ),
            (
                error("when,omega_left,omega_right,x\n0,1,2,3\n"),
                "drive.csv: line 1, column 5: found no column `time` among `when`, `omega_left`, `omega_right`, `x`, \
                 expected a header with time, omega_left, omega_right (--column time=NAME names it)",
            ),
            (
                error("0,1,2\n1,1,2\n"),
                "drive.csv: line 1, column 1: found a row without a header, expected a header above it, such as \
                 time,omega_left,omega_right, or the numbers of the columns: --column time=#1 --column omega_left=#2 \
                 --column omega_right=#3",
            ),
            (
                error("time,omega_left [m],omega_right\n0,1,2\n"),
                "drive.csv: line 1, column 2 (omega_left [m]): found the unit `m`, expected one of rad/s, \
                 deg/s, mrad/s, rpm, rev/s, m/s, cm/s, mm/s, km/h, mph, ft/s (or --column omega_left=NAME:UNIT)",
            ),
            (
                error("time,omega_left [m/s],omega_right\n0,1,2\n"),
                "drive.csv: line 1, column 2 (omega_left [m/s]): found the speed of rims [m/s], expected rad/s, deg/s or \
                 rpm, or a vehicle whose wheel radius converts it (--vehicle FILE.json, or NAME.json beside the recording)",
            ),
            (
                error("time,omega_left,omega_right\n2024-10-27T00:00:00Z,1,2\n1,1,2\n"),
                "drive.csv: line 3, column 1 (time): found `1`, expected a date and time as in the first row",
            ),
            (
                error("time,omega_left,omega_right\nnoon,1,2\n"),
                "drive.csv: line 2, column 1 (time): found `noon`, expected a number [s] or an ISO 8601 date and time",
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
