//! Rows of cells under a header, with the place of each cell for messages.

use super::error::{Cell, CsvError, malformed, plain};
use crate::display::shortened;
use csv::{ByteRecord, ReaderBuilder};
use std::io::Read;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The column that separates runs, each with its own clock.
pub(super) const RUN: ColumnSpec = ColumnSpec {
    name: "run",
    unit: "-",
    is_required: false,
};

/// A column that is read.
#[derive(Debug, Clone, Copy)]
pub struct ColumnSpec {
    pub name: &'static str,
    pub unit: &'static str,
    pub is_required: bool,
}

impl ColumnSpec {
    pub const fn required(name: &'static str, unit: &'static str) -> Self {
        Self {
            name,
            unit,
            is_required: true,
        }
    }
}

/// A file with longer lines is no table \[bytes\].
const LONGEST_LINE: usize = 1 << 20;

/// Reads a whole input, but stops at a line that is too long for a table, so that another kind of file costs little.
/// `file` names it in errors.
///
/// # Errors
/// An input that cannot be read, and a megabyte without a line end.
pub fn read_bytes(file: &str, mut input: impl Read) -> Result<Vec<u8>, CsvError> {
    let mut bytes = Vec::new();
    let mut line = 1;
    loop {
        let start = bytes.len();
        let read = input
            .by_ref()
            .take(LONGEST_LINE as u64)
            .read_to_end(&mut bytes);
        let read = read.map_err(|source| CsvError::Read {
            file: file.into(),
            source,
        })?;
        if read < LONGEST_LINE {
            return Ok(bytes);
        }
        match line_ends(&bytes[start..]) {
            0 => {
                return Err(CsvError::LongLine {
                    file: file.into(),
                    line,
                });
            }
            ends => line += ends,
        }
    }
}

/// Reads a text row by row and returns the table's header. `file` names it in errors.
///
/// # Errors
/// A header that lacks a column or has one twice, a row of another length, and the errors of `visit`.
pub fn read_table<'a>(
    file: &'a str,
    bytes: &'a [u8],
    columns: &'static [ColumnSpec],
    mut visit: impl FnMut(&TableRow) -> Result<(), CsvError>,
) -> Result<TableHeader<'a>, CsvError> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    // `flexible`: rows of another length are reported with their place below.
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(bytes);
    let mut record = ByteRecord::new();
    let mut next = |record: &mut ByteRecord| {
        reader
            .read_byte_record(record)
            .map_err(|error| CsvError::Read {
                file: file.into(),
                source: error.into(),
            })
    };
    let mut place = Place { byte: 0, line: 1 };
    let header_cell = |line, column| Cell {
        file: file.into(),
        line,
        column,
        name: None,
    };
    if !next(&mut record)? {
        let expected = format!("a header with {}", required(columns).join(", "));
        return Err(malformed(header_cell(1, 1), "an empty file", expected));
    }
    place.advance(bytes, &record);
    if let Some(index) = swallowing(&record) {
        return Err(open_quote(header_cell(place.line, index + 1)));
    }
    let header = TableHeader::new(file, bytes, columns, &record, place.line)?;
    while next(&mut record)? {
        place.advance(bytes, &record);
        if !is_blank(&record) {
            let row = TableRow {
                header: &header,
                record: &record,
                line: place.line,
            };
            match swallowing(&record) {
                Some(index) => return Err(open_quote(header.cell_at(place.line, index))),
                None => row.check_length()?,
            }
            visit(&row)?;
        }
    }
    Ok(header)
}

/// The line of a byte.
struct Place {
    byte: usize,
    line: usize,
}

impl Place {
    /// Advances to the first line of a record. The `csv` crate's count stops before the empty lines that it skips, and
    /// within a CR LF.
    fn advance(&mut self, bytes: &[u8], record: &ByteRecord) {
        let start = record
            .position()
            .map_or(0, |position| position.byte() as usize);
        let skipped = bytes[start..]
            .iter()
            .take_while(|byte| matches!(byte, b'\r' | b'\n'));
        let to = start + skipped.count();
        self.line += line_ends(&bytes[self.byte..to]);
        self.byte = to;
    }
}

/// Number of line ends: LF, CR LF or CR.
fn line_ends(bytes: &[u8]) -> usize {
    let lone = |place: &usize| bytes[*place] == b'\r' && bytes.get(place + 1) != Some(&b'\n');
    let ends = |place: &usize| bytes[*place] == b'\n' || lone(place);
    (0..bytes.len()).filter(ends).count()
}

/// The cell with an opening quote that is not closed on its line and swallows the following rows.
fn swallowing(record: &ByteRecord) -> Option<usize> {
    let is_open = |cell: &[u8]| cell.iter().any(|byte| matches!(byte, b'\n' | b'\r'));
    record.iter().position(is_open)
}

fn open_quote(cell: Cell) -> CsvError {
    let expected = "cells of one line (a quote that is text is written twice, within quotes)";
    malformed(cell, "a quote that is not closed on its line", expected)
}

/// A line of spaces, which some editors append.
fn is_blank(record: &ByteRecord) -> bool {
    record.len() == 1 && record[0].trim_ascii().is_empty()
}

/// Names of the required columns.
fn required(columns: &[ColumnSpec]) -> Vec<&'static str> {
    let names = columns.iter().filter(|column| column.is_required);
    names.map(|column| column.name).collect()
}

/// A cell's bytes for a message.
pub fn quoted(bytes: &[u8]) -> String {
    format!("`{}`", shortened(&String::from_utf8_lossy(bytes)))
}

/// The places of the columns.
#[derive(Debug)]
pub struct TableHeader<'a> {
    file: &'a str,
    bytes: &'a [u8],
    columns: &'static [ColumnSpec],
    names: Vec<String>,
    positions: Vec<Option<usize>>,
}

impl<'a> TableHeader<'a> {
    fn new(
        file: &'a str,
        bytes: &'a [u8],
        columns: &'static [ColumnSpec],
        record: &ByteRecord,
        line: usize,
    ) -> Result<Self, CsvError> {
        let name = |name: &[u8]| String::from_utf8_lossy(name.trim_ascii()).into_owned();
        let mut header = Self {
            file,
            bytes,
            columns,
            names: record.iter().map(name).collect(),
            positions: Vec::with_capacity(columns.len()),
        };
        for ColumnSpec {
            name, is_required, ..
        } in columns
        {
            let mut places = (0..record.len()).filter(|place| header.names[*place] == *name);
            let position = places.next();
            if position.is_none() && *is_required {
                return Err(CsvError::MissingColumn {
                    cell: header.cell_at(line, header.names.len()),
                    missing: name,
                    required: required(columns).into(),
                    found: header.names,
                });
            }
            if let Some(again) = places.next() {
                let found = format!("a second column `{name}`");
                return Err(malformed(header.cell_at(line, again), found, "one of each"));
            }
            header.positions.push(position);
        }
        Ok(header)
    }

    /// Whether the table has a column of this name, known or not.
    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }

    /// The name of another column that is probably meant for a missing one.
    pub fn meant(&self, index: usize) -> Option<&str> {
        let meant = |name: &&String| {
            let other = |column: &ColumnSpec| column.name == **name;
            plain(name) == self.columns[index].name && !self.columns.iter().any(other)
        };
        match self.positions[index] {
            Some(_) => None,
            None => self.names.iter().find(meant).map(String::as_str),
        }
    }

    /// The cell of a column in some line.
    pub fn cell(&self, line: usize, index: usize) -> Cell {
        self.cell_at(line, self.positions[index].unwrap_or(self.names.len()))
    }

    fn cell_at(&self, line: usize, place: usize) -> Cell {
        Cell {
            file: self.file.into(),
            line,
            column: place + 1,
            name: self.names.get(place).cloned(),
        }
    }

    /// The last line that is not empty.
    pub fn last_line(&self) -> usize {
        1 + line_ends(self.bytes.trim_ascii_end())
    }

    /// The error of a table without rows.
    pub fn no_rows(&self, index: usize) -> CsvError {
        let cell = self.cell(self.last_line() + 1, index);
        let expected = "at least one row of numbers";
        malformed(cell, "the end of the file", expected)
    }

    /// The error of a required column without numbers.
    pub fn no_numbers(&self, index: usize) -> CsvError {
        let expected = format!("at least one number [{}]", self.columns[index].unit);
        let cell = self.cell(self.last_line(), index);
        malformed(cell, "nothing but empty cells", expected)
    }
}

/// A row of cells.
pub struct TableRow<'a> {
    header: &'a TableHeader<'a>,
    record: &'a ByteRecord,
    /// Line of the file, from 1.
    pub line: usize,
}

impl TableRow<'_> {
    fn check_length(&self) -> Result<(), CsvError> {
        let (cells, wanted) = (self.record.len(), self.header.names.len());
        if cells == wanted {
            return Ok(());
        }
        let found = match cells {
            1 => "1 cell".into(),
            _ => format!("{cells} cells"),
        };
        let expected = format!("{wanted} as in the header");
        let cell = self.header.cell_at(self.line, cells.min(wanted));
        Err(malformed(cell, found, expected))
    }

    /// The table's header.
    pub fn header(&self) -> &TableHeader<'_> {
        self.header
    }

    /// The place of a column's cell.
    pub fn cell(&self, index: usize) -> Cell {
        self.header.cell(self.line, index)
    }

    /// The cell of a column; empty without that column.
    pub fn bytes(&self, index: usize) -> &[u8] {
        self.header.positions[index].map_or(&[], |place| self.record[place].trim_ascii())
    }

    /// The number in a column; `None` for an empty cell, or without that column.
    ///
    /// # Errors
    /// Anything except a finite number.
    pub fn number(&self, index: usize) -> Result<Option<f64>, CsvError> {
        let bytes = self.bytes(index);
        if bytes.is_empty() {
            return Ok(None);
        }
        let number = std::str::from_utf8(bytes)
            .ok()
            .and_then(|text| text.parse::<f64>().ok());
        match number {
            Some(value) if value.is_finite() => Ok(Some(value)),
            other => {
                let kind = if other.is_some() {
                    "a finite number"
                } else {
                    "a number"
                };
                let expected = format!("{kind} [{}]", self.header.columns[index].unit);
                Err(malformed(self.cell(index), quoted(bytes), expected))
            }
        }
    }

    /// The number in a column that must not be empty.
    ///
    /// # Errors
    /// An empty cell, and the errors of [`TableRow::number`].
    pub fn required_number(&self, index: usize) -> Result<f64, CsvError> {
        self.number(index)?.ok_or_else(|| {
            let expected = format!("a number [{}]", self.header.columns[index].unit);
            malformed(self.cell(index), "an empty cell", expected)
        })
    }
}
