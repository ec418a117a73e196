//! Recordings as CSV: one header line, then numbers in SI units; an empty cell of a measured
//! column is a missing sample. Columns stand in any order, and others may stand among them.

mod error;

pub use error::{Cell, CsvError};

use super::{Recording, fill_gaps};
use csv::{ByteRecord, ReaderBuilder, Trim};
use error::malformed;
use std::io::Read;

/// A column that is read.
struct Column {
    name: &'static str,
    unit: &'static str,
}

const TIME: usize = 0;
const OMEGA_LEFT: usize = 1;
const OMEGA_RIGHT: usize = 2;
/// What every recording has, at the indices above.
const COLUMNS: [Column; 3] = [
    Column {
        name: "time",
        unit: "s",
    },
    Column {
        name: "omega_left",
        unit: "rad/s",
    },
    Column {
        name: "omega_right",
        unit: "rad/s",
    },
];
/// Marks separate drives, each with its own clock.
const RUN: &str = "run";
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads a recording. `file` names it in errors.
///
/// # Errors
/// The first thing that makes the text no recording, with its line and column.
pub fn read_csv(file: &str, mut input: impl Read) -> Result<Recording, CsvError> {
    let read_error = |source| CsvError::Read {
        file: file.into(),
        source,
    };
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes).map_err(read_error)?;
    let text = Text {
        file,
        bytes: bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&bytes),
    };
    // The reader counts the cells itself, to say which are too few or too many.
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text.bytes);
    let mut record = ByteRecord::new();
    let mut next = |record: &mut ByteRecord| {
        reader
            .read_byte_record(record)
            .map_err(|error| read_error(error.into()))
    };
    if !next(&mut record)? {
        let expected = "a header with time, omega_left, omega_right";
        return Err(malformed(text.cell(1, 0, None), "an empty file", expected));
    }
    let header = Header::new(text, &record)?;
    let mut rows = Rows::default();
    while next(&mut record)? {
        if !is_blank(&record) {
            rows.push(&header, &record)?;
        }
    }
    rows.finish(&header)
}

/// The whole file, to find lines in.
#[derive(Clone, Copy)]
struct Text<'a> {
    file: &'a str,
    bytes: &'a [u8],
}

impl Text<'_> {
    fn cell(&self, line: usize, place: usize, name: Option<&str>) -> Cell {
        Cell {
            file: self.file.into(),
            line,
            column: place + 1,
            name: name.map(Into::into),
        }
    }

    /// The line that a record begins on. The `csv` crate's own count stops before the empty
    /// lines that it skips, and before the second half of a CR LF.
    fn line(&self, record: &ByteRecord) -> usize {
        let start = record
            .position()
            .map_or(0, |position| position.byte() as usize);
        let skipped = self.bytes[start..]
            .iter()
            .take_while(|byte| matches!(byte, b'\r' | b'\n'));
        1 + line_ends(&self.bytes[..start + skipped.count()])
    }
}

/// Number of line ends: LF, CR LF or CR.
fn line_ends(bytes: &[u8]) -> usize {
    let lone = |place: &usize| bytes[*place] == b'\r' && bytes.get(place + 1) != Some(&b'\n');
    let ends = |place: &usize| bytes[*place] == b'\n' || lone(place);
    (0..bytes.len()).filter(ends).count()
}

/// A line of spaces, such as some editors leave at the end.
fn is_blank(record: &ByteRecord) -> bool {
    record.len() == 1 && record[0].is_empty()
}

/// A cell's bytes for a message.
fn quoted(bytes: &[u8]) -> String {
    format!("`{}`", String::from_utf8_lossy(bytes))
}

/// Where each column stands.
struct Header<'a> {
    text: Text<'a>,
    names: Vec<String>,
    positions: [usize; COLUMNS.len()],
}

impl<'a> Header<'a> {
    fn new(text: Text<'a>, record: &ByteRecord) -> Result<Self, CsvError> {
        let names = record
            .iter()
            .map(|name| String::from_utf8_lossy(name).into_owned());
        let mut header = Self {
            text,
            names: names.collect(),
            positions: [0; COLUMNS.len()],
        };
        for (index, Column { name, .. }) in COLUMNS.iter().enumerate() {
            let mut places = (0..record.len()).filter(|place| header.names[*place] == *name);
            let Some(place) = places.next() else {
                return Err(CsvError::MissingColumn {
                    cell: header.cell(record, header.names.len()),
                    expected: name,
                    found: header.names,
                });
            };
            if let Some(again) = places.next() {
                let found = format!("a second column `{name}`");
                return Err(malformed(header.cell(record, again), found, "one of each"));
            }
            header.positions[index] = place;
        }
        Ok(header)
    }

    fn cell(&self, record: &ByteRecord, place: usize) -> Cell {
        self.cell_at(self.text.line(record), place)
    }

    fn cell_at(&self, line: usize, place: usize) -> Cell {
        self.text
            .cell(line, place, self.names.get(place).map(String::as_str))
    }

    /// The number in a column, or nothing where the cell is empty.
    fn number(&self, record: &ByteRecord, index: usize) -> Result<Option<f64>, CsvError> {
        let place = self.positions[index];
        let bytes = &record[place];
        if bytes.is_empty() {
            return Ok(None);
        }
        match std::str::from_utf8(bytes)
            .ok()
            .and_then(|text| text.parse::<f64>().ok())
        {
            Some(value) if value.is_finite() => Ok(Some(value)),
            other => {
                let kind = if other.is_some() {
                    "a finite number"
                } else {
                    "a number"
                };
                let expected = format!("{kind} [{}]", COLUMNS[index].unit);
                Err(malformed(self.cell(record, place), quoted(bytes), expected))
            }
        }
    }
}

/// What has been read so far.
#[derive(Default)]
struct Rows {
    time: Vec<f64>,
    omega_left: Vec<Option<f64>>,
    omega_right: Vec<Option<f64>>,
}

impl Rows {
    fn push(&mut self, header: &Header, record: &ByteRecord) -> Result<(), CsvError> {
        let (cells, wanted) = (record.len(), header.names.len());
        if cells != wanted {
            let found = match cells {
                1 => "1 cell".into(),
                _ => format!("{cells} cells"),
            };
            let expected = format!("{wanted} as in the header");
            return Err(malformed(
                header.cell(record, cells.min(wanted)),
                found,
                expected,
            ));
        }
        let at = || header.cell(record, header.positions[TIME]);
        let time = header.number(record, TIME)?;
        let time = time.ok_or_else(|| malformed(at(), "an empty cell", "a number [s]"))?;
        if let Some(&before) = self.time.last()
            && time <= before
        {
            let hint = if header.names.iter().any(|name| name == RUN) {
                " (a file with a column `run` holds several drives: cut out one)"
            } else {
                ""
            };
            let expected = format!("a time later than {before} s{hint}");
            return Err(malformed(at(), format!("{time}"), expected));
        }
        self.time.push(time);
        self.omega_left.push(header.number(record, OMEGA_LEFT)?);
        self.omega_right.push(header.number(record, OMEGA_RIGHT)?);
        Ok(())
    }

    fn finish(self, header: &Header) -> Result<Recording, CsvError> {
        let end = 1 + line_ends(header.text.bytes.trim_ascii_end());
        if self.time.is_empty() {
            let cell = header.cell_at(end + 1, header.positions[TIME]);
            return Err(malformed(
                cell,
                "the end of the file",
                "at least one row of numbers",
            ));
        }
        let column = |samples: &[Option<f64>], index: usize| {
            fill_gaps(&self.time, samples).ok_or_else(|| {
                let cell = header.cell_at(end, header.positions[index]);
                let expected = format!("at least one number [{}]", COLUMNS[index].unit);
                malformed(cell, "nothing but empty cells", expected)
            })
        };
        let pairs = self.omega_left.iter().zip(&self.omega_right);
        Ok(Recording {
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
