//! Rows of cells under a header, with the place of each for messages.

use super::error::{Cell, CsvError, malformed, plain};
use crate::display::shortened;
use csv::{ByteRecord, ReaderBuilder};
use std::io::Read;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A column that is read.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    pub name: &'static str,
    pub unit: &'static str,
    pub is_required: bool,
}

/// A table has no longer lines \[bytes\]; what has is another kind of file.
const LONGEST_LINE: usize = 1 << 20;

/// Reads all of an input, but stops at a line that no table has: another kind of file costs little. `file` names it in
/// errors.
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

/// Reads a text row by row; the header of the table comes back. `file` names it in errors.
///
/// # Errors
/// A header that lacks a column or has one twice, a row of another length, and whatever
/// `visit` refuses.
pub fn read_table<'a>(
    file: &'a str,
    bytes: &'a [u8],
    columns: &'static [Column],
    mut visit: impl FnMut(&Row) -> Result<(), CsvError>,
) -> Result<Header<'a>, CsvError> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    // The reader counts the cells itself, to say which are too few or too many.
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
    let mut place = Place::default();
    if !next(&mut record)? {
        let cell = Cell {
            file: file.into(),
            line: 1,
            column: 1,
            name: None,
        };
        let expected = format!("a header with {}", required(columns).join(", "));
        return Err(malformed(cell, "an empty file", expected));
    }
    place.advance(bytes, &record);
    if let Some(index) = swallowing(&record) {
        let cell = Cell {
            file: file.into(),
            line: place.line,
            column: index + 1,
            name: None,
        };
        return Err(open_quote(cell));
    }
    let header = Header::new(file, bytes, columns, &record, place.line)?;
    while next(&mut record)? {
        place.advance(bytes, &record);
        if !is_blank(&record) {
            let row = Row {
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

/// How far the lines are counted.
struct Place {
    byte: usize,
    line: usize,
}

impl Default for Place {
    fn default() -> Self {
        Self { byte: 0, line: 1 }
    }
}

impl Place {
    /// Goes on to the line that a record begins on. The `csv` crate's own count stops before
    /// the empty lines that it skips, and before the second half of a CR LF.
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

/// Which cell has a quote that opens it and is not closed on its line, which swallows what follows.
fn swallowing(record: &ByteRecord) -> Option<usize> {
    let is_open = |cell: &[u8]| cell.iter().any(|byte| matches!(byte, b'\n' | b'\r'));
    record.iter().position(is_open)
}

fn open_quote(cell: Cell) -> CsvError {
    let expected = "cells of one line (a quote that is text is written twice, within quotes)";
    malformed(cell, "a quote that is not closed on its line", expected)
}

/// A line of spaces, such as some editors leave at the end.
fn is_blank(record: &ByteRecord) -> bool {
    record.len() == 1 && record[0].trim_ascii().is_empty()
}

/// Names of the columns that must be there.
fn required(columns: &[Column]) -> Vec<&'static str> {
    let names = columns.iter().filter(|column| column.is_required);
    names.map(|column| column.name).collect()
}

/// A cell's bytes for a message.
pub fn quoted(bytes: &[u8]) -> String {
    format!("`{}`", shortened(&String::from_utf8_lossy(bytes)))
}

/// Where each column stands.
#[derive(Debug)]
pub struct Header<'a> {
    file: &'a str,
    bytes: &'a [u8],
    columns: &'static [Column],
    names: Vec<String>,
    positions: Vec<Option<usize>>,
}

impl<'a> Header<'a> {
    fn new(
        file: &'a str,
        bytes: &'a [u8],
        columns: &'static [Column],
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
        for Column {
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

    /// Whether the table has a column of this name, read or not.
    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }

    /// Where a column is not there, the name of another one that is meant for it.
    pub fn meant(&self, index: usize) -> Option<&str> {
        let meant = |name: &&String| {
            let other = |column: &Column| column.name == **name;
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

    /// The last line with anything in it.
    pub fn last_line(&self) -> usize {
        1 + line_ends(self.bytes.trim_ascii_end())
    }

    /// A table without a single row.
    pub fn no_rows(&self, index: usize) -> CsvError {
        let cell = self.cell(self.last_line() + 1, index);
        let expected = "at least one row of numbers";
        malformed(cell, "the end of the file", expected)
    }

    /// A required column without a single number.
    pub fn no_numbers(&self, index: usize) -> CsvError {
        let expected = format!("at least one number [{}]", self.columns[index].unit);
        let cell = self.cell(self.last_line(), index);
        malformed(cell, "nothing but empty cells", expected)
    }
}

/// A row of cells.
pub struct Row<'a> {
    header: &'a Header<'a>,
    record: &'a ByteRecord,
    /// Its line in the file, from 1.
    pub line: usize,
}

impl Row<'_> {
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
    pub fn header(&self) -> &Header<'_> {
        self.header
    }

    /// The place of a column's cell.
    pub fn cell(&self, index: usize) -> Cell {
        self.header.cell(self.line, index)
    }

    /// What stands in a column; nothing where there is no such column.
    pub fn bytes(&self, index: usize) -> &[u8] {
        self.header.positions[index].map_or(&[], |place| self.record[place].trim_ascii())
    }

    /// The number in a column, or nothing where the cell is empty or there is no such column.
    ///
    /// # Errors
    /// Anything but a finite number.
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

    /// The number in a column that must have one.
    ///
    /// # Errors
    /// An empty cell, and what [`Row::number`] refuses.
    pub fn required_number(&self, index: usize) -> Result<f64, CsvError> {
        self.number(index)?.ok_or_else(|| {
            let expected = format!("a number [{}]", self.header.columns[index].unit);
            malformed(self.cell(index), "an empty cell", expected)
        })
    }
}
