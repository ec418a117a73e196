//! Rows of cells under a header, with the place of each cell for messages.

use super::calendar::Calendar;
use super::error::{Cell, CsvError, FoundColumns, malformed};
use super::layout::{Layout, are_units, is_comment, layout};
use super::naming::{Match, likely, matched, resembles};
use super::request::{ColumnRequest, TableOptions};
use super::unit::{Quantity, UnitSize};
use crate::display::{shell_quoted, shortened};
use csv::{ByteRecord, ReaderBuilder};
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::cell::RefCell;
use std::io::Read;

/// First bytes of other files, their kind, and a remedy.
const OTHERS: [(&[u8], &str, &str); 6] = [
    (
        b"PK\x03\x04",
        "a zip archive or a spreadsheet",
        "save the sheet as CSV",
    ),
    (b"SQLite format 3\0", "a ROS 2 bag in SQLite", IMPORT),
    (b"\x89MCAP", "an MCAP file", IMPORT),
    (b"#ROSBAG", "a ROS 1 bag", IMPORT),
    (b"\x1f\x8b", "a file packed by gzip", "unpack it: gunzip"),
    (
        b"\x28\xb5\x2f\xfd",
        "a file packed by zstd",
        "unpack it: zstd -d",
    ),
];
const IMPORT: &str = "ugv import FILE --output NAME.csv makes a recording of it";

/// The column that separates runs, each with its own clock.
pub(super) const RUN: ColumnSpec = ColumnSpec {
    name: "run",
    unit: "-",
    quantity: Quantity::Label,
    is_required: false,
};

/// A column that is read.
#[derive(Debug, Clone, Copy)]
pub struct ColumnSpec {
    pub name: &'static str,
    pub unit: &'static str,
    pub quantity: Quantity,
    pub is_required: bool,
}

impl ColumnSpec {
    pub const fn required(name: &'static str, unit: &'static str, quantity: Quantity) -> Self {
        Self {
            name,
            unit,
            quantity,
            is_required: true,
        }
    }
}

/// A file with longer lines is no table \[bytes\].
const LONGEST_LINE: usize = 1 << 20;

/// Reads a whole input as UTF-8, but stops at a line that is too long for a table, so that another kind of file costs
/// little. UTF-16 is converted. `file` names it in errors.
///
/// # Errors
/// An input that cannot be read, another kind of file, and a megabyte without a line end.
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
        let kind = OTHERS.iter().find(|(magic, ..)| bytes.starts_with(magic));
        if let Some((_, found, remedy)) = kind {
            let cell = Cell {
                file: file.into(),
                line: 1,
                column: 1,
                name: None,
            };
            return Err(malformed(cell, *found, format!("CSV ({remedy})")));
        }
        if read < LONGEST_LINE {
            return Ok(to_utf8(bytes));
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

/// UTF-16, with a byte order mark or without, as UTF-8; other bytes stay.
fn to_utf8(bytes: Vec<u8>) -> Vec<u8> {
    let marked = Encoding::for_bom(&bytes).map(|(encoding, _)| encoding);
    // Letters and digits have a zero byte in UTF-16; no text in UTF-8 has one.
    let unmarked = || match bytes.get(..4) {
        Some([a, 0, b, 0]) if *a != 0 && *b != 0 => Some(UTF_16LE),
        Some([0, a, 0, b]) if *a != 0 && *b != 0 => Some(UTF_16BE),
        _ => None,
    };
    match marked.or_else(unmarked) {
        // Removes the mark of UTF-8 as well.
        Some(encoding) => {
            if encoding == encoding_rs::UTF_8 {
                return bytes[3..].to_vec();
            }
            encoding
                .decode_with_bom_removal(&bytes)
                .0
                .into_owned()
                .into_bytes()
        }
        None => bytes,
    }
}

/// Reads a text row by row and returns the table's header. `file` names it in errors.
///
/// # Errors
/// A header that lacks a column or has one twice, a row of another length, and the errors of `visit`.
pub fn read_table<'a>(
    file: &'a str,
    bytes: &[u8],
    columns: &'static [ColumnSpec],
    options: &TableOptions,
    mut visit: impl FnMut(&TableRow) -> Result<(), CsvError>,
) -> Result<TableHeader<'a>, CsvError> {
    let Layout {
        text,
        line,
        separator,
        is_headless,
    } = layout(bytes);
    let bytes = &*text;
    // `flexible`: rows of another length are reported with their place below.
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
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
    let mut place = Place { byte: 0, line };
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
    if is_headless && !options.by_number() {
        let names = required(columns);
        let numbers: Vec<String> = names
            .iter()
            .enumerate()
            .map(|(index, name)| format!("--column {name}=#{}", index + 1))
            .collect();
        let expected = format!(
            "a header above it, such as {}, or the numbers of the columns: {}",
            names.join(","),
            numbers.join(" ")
        );
        return Err(malformed(
            header_cell(place.line, 1),
            "a row without a header",
            expected,
        ));
    }
    let mut header_line = record.clone();
    let (mut at, mut has_next) = (place.line, is_headless);
    if is_headless {
        let numbers = (1..=record.len()).map(|number| format!("#{number}"));
        header_line = numbers.collect::<Vec<_>>().into();
        at = place.line;
    } else {
        has_next = next_row(&mut next, &mut record, &mut place, bytes)?;
    }
    let mut units = ByteRecord::new();
    if has_next && are_units(record.iter()) {
        units.clone_from(&record);
        has_next = next_row(&mut next, &mut record, &mut place, bytes)?;
    }
    let last_line = line - 1 + 1 + line_ends(bytes.trim_ascii_end());
    let mut header = TableHeader {
        file,
        line: at,
        last_line,
        separator,
        columns,
        names: header_line.iter().map(decoded).collect(),
        sources: Vec::with_capacity(columns.len()),
        calendar: RefCell::default(),
        findings: Vec::new(),
    };
    header.settle(&units, options)?;
    while has_next {
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
        has_next = next_row(&mut next, &mut record, &mut place, bytes)?;
    }
    let calendar = header.calendar.get_mut().notes();
    let time = columns
        .iter()
        .position(|column| column.quantity == Quantity::Time);
    header
        .findings
        .extend(calendar.into_iter().map(|text| Finding {
            index: time.unwrap_or(0),
            line: place.line.min(at + 1),
            text,
            is_doubt: false,
        }));
    Ok(header)
}

/// Advances to the next row that is neither empty nor a comment; false at the end.
fn next_row(
    next: &mut impl FnMut(&mut ByteRecord) -> Result<bool, CsvError>,
    record: &mut ByteRecord,
    place: &mut Place,
    bytes: &[u8],
) -> Result<bool, CsvError> {
    while next(record)? {
        place.advance(bytes, record);
        if !is_blank(record) && !record.get(0).is_some_and(is_comment) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// A name in a header; one that is not UTF-8 has the letters of Windows.
fn decoded(name: &[u8]) -> String {
    let name = name.trim_ascii();
    match std::str::from_utf8(name) {
        Ok(name) => name.trim().into(),
        Err(_) => WINDOWS_1252
            .decode_without_bom_handling(name)
            .0
            .into_owned(),
    }
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

/// A line of spaces, which some editors append, or of separators alone, as spreadsheets write empty rows.
fn is_blank(record: &ByteRecord) -> bool {
    record.iter().all(|cell| cell.trim_ascii().is_empty())
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

/// The columns of the file that hold a quantity, and their unit.
#[derive(Debug, Clone, Default)]
struct Source {
    /// Their places; several are averaged. Empty without a column.
    places: Vec<usize>,
    /// Size of their unit in that of the quantity, and its name, if it is another one.
    unit: Option<(f64, String)>,
}

/// What a table has as which quantity, and what is doubtful about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Index of the quantity among the columns that are read.
    pub index: usize,
    /// Line of the file, from 1.
    pub line: usize,
    pub text: String,
    /// Whether nothing was taken.
    pub is_doubt: bool,
}

/// The places of the columns.
#[derive(Debug)]
pub struct TableHeader<'a> {
    file: &'a str,
    /// Line of the header, and the last line that is not empty.
    line: usize,
    last_line: usize,
    separator: u8,
    columns: &'static [ColumnSpec],
    names: Vec<String>,
    sources: Vec<Source>,
    calendar: RefCell<Calendar>,
    findings: Vec<Finding>,
}

impl TableHeader<'_> {
    /// Finds the column of each quantity: the requested one, that of its name, or that of a name in common use.
    fn settle(&mut self, units: &ByteRecord, options: &TableOptions) -> Result<(), CsvError> {
        let mut taken: Vec<usize> = Vec::new();
        let wish = |column: &ColumnSpec| {
            let mut wishes = options.columns.iter();
            wishes.rfind(|wish| wish.target == column.name)
        };
        for column in self.columns {
            let source = match wish(column) {
                Some(wish) => self.requested(column, wish)?,
                None => Source {
                    places: self.own(column).next().into_iter().collect(),
                    unit: None,
                },
            };
            taken.extend(&source.places);
            self.sources.push(source);
        }
        for (index, column) in self.columns.iter().enumerate() {
            if self.sources[index].places.is_empty() {
                self.take_alias(index, column, &mut taken);
            }
            self.read_unit(index, column, units, options)?;
            if self.sources[index].places.is_empty() && column.is_required {
                return Err(self.missing(column));
            }
            if wish(column).is_none()
                && let Some(again) = self.own(column).nth(1)
            {
                let cell = self.cell_at(self.line, again);
                let found = format!("a second column `{}`", column.name);
                return Err(malformed(cell, found, "one of each"));
            }
        }
        self.doubt(&taken);
        Ok(())
    }

    /// The columns of a quantity's own name.
    fn own(&self, column: &ColumnSpec) -> impl Iterator<Item = usize> {
        let places = 0..self.names.len();
        places.filter(|place| self.names[*place] == column.name)
    }

    fn requested(&self, column: &ColumnSpec, wish: &ColumnRequest) -> Result<Source, CsvError> {
        let find = |name: &str| {
            let name = name.trim();
            let by_number = || {
                let number = name.strip_prefix('#')?.parse::<usize>().ok()?;
                number
                    .checked_sub(1)
                    .filter(|place| *place < self.names.len())
            };
            let by_name = self.names.iter().position(|other| other == name);
            by_name.or_else(by_number)
        };
        let all = |names: &str| match find(names) {
            Some(place) => Ok(vec![place]),
            None => names
                .split('+')
                .map(|name| find(name).ok_or(name.trim().to_owned()))
                .collect(),
        };
        let whole = all(&wish.columns);
        let found = match wish.columns.rsplit_once(':') {
            Some((names, unit)) if whole.is_err() => all(names).map(|places| (places, Some(unit))),
            _ => whole.map(|places| (places, None)),
        };
        let header_cell = || self.cell_at(self.line, self.names.len());
        let (places, unit) = found.map_err(|name| {
            let near = crate::spelling::nearest(&name, self.names.iter().map(String::as_str));
            let near = near.map_or(String::new(), |near| {
                format!(" (the nearest is `{}`)", shortened(near))
            });
            let expected = format!("the column that `{wish}` names{near}");
            malformed(
                header_cell(),
                format!("no column `{}`", shortened(&name)),
                expected,
            )
        })?;
        let unit = unit.map(|unit| {
            let unit = unit.trim();
            match column.quantity.size(unit) {
                Some(_) => Ok((1.0, unit.to_owned())),
                None => {
                    let expected = format!("one of {}", column.quantity.names());
                    let found = format!("the unit `{}` in `{wish}`", shortened(unit));
                    Err(malformed(
                        self.cell_at(self.line, places[0]),
                        found,
                        expected,
                    ))
                }
            }
        });
        Ok(Source {
            places,
            unit: unit.transpose()?,
        })
    }

    /// Takes the best column whose name is in common use.
    fn take_alias(&mut self, index: usize, column: &ColumnSpec, taken: &mut Vec<usize>) {
        let free = (0..self.names.len()).filter(|place| !taken.contains(place));
        let found = free.filter_map(|place| {
            let found = matched(column.name, column.quantity, &self.names[place])?;
            Some((found.rank, place))
        });
        let mut found: Vec<(usize, usize)> = found.collect();
        found.sort_unstable();
        let Some((&(_, place), others)) = found.split_first() else {
            return;
        };
        taken.push(place);
        self.sources[index].places.push(place);
        let shown = |place: usize| format!("`{}`", shortened(&self.names[place]));
        let others: Vec<String> = others.iter().map(|(_, place)| shown(*place)).collect();
        if !others.is_empty() {
            let text = format!(
                "{} could be it as well and is not used: --column {}=NAME chooses",
                others.join(", "),
                column.name
            );
            self.found(index, text, true);
        }
    }

    /// The unit of a column: the requested one, that in its name, or that of the row of units.
    fn read_unit(
        &mut self,
        index: usize,
        column: &ColumnSpec,
        units: &ByteRecord,
        options: &TableOptions,
    ) -> Result<(), CsvError> {
        let source = &self.sources[index];
        let Some(&place) = source.places.first() else {
            return Ok(());
        };
        let name = &self.names[place];
        let is_own = name == column.name;
        let stated = source.unit.as_ref().map(|(_, unit)| unit.clone());
        let in_name = || {
            let Match { unit, .. } = matched(column.name, column.quantity, name)?;
            unit
        };
        let in_row = || {
            let unit = decoded(units.get(place)?);
            let unit = unit.trim_matches(['[', ']', '(', ')']).to_owned();
            let is_none =
                matches!(unit.as_str(), "" | "-" | "1") || column.quantity == Quantity::Label;
            (!is_none).then_some(unit)
        };
        let unit = stated.or_else(in_name).or_else(in_row);
        let mut size = 1.0;
        if let Some(unit) = &unit {
            let radius = options.wheel_radius;
            size = match (column.quantity.size(unit), radius) {
                (Some(UnitSize::Si(size)), _) => size,
                (Some(UnitSize::Rim(size)), Some(radius)) => size / radius,
                (Some(UnitSize::Rim(_)), None) => {
                    let expected = "rad/s, deg/s or rpm, or a vehicle whose wheel radius converts it \
                                    (--vehicle FILE.json, or NAME.json beside the recording)";
                    let found = format!("the speed of rims [{unit}]");
                    return Err(malformed(self.cell_at(self.line, place), found, expected));
                }
                (None, _) => {
                    let expected = format!(
                        "one of {} (or --column {}=NAME:UNIT)",
                        column.quantity.names(),
                        column.name
                    );
                    let found = format!("the unit `{}`", shortened(unit));
                    return Err(malformed(self.cell_at(self.line, place), found, expected));
                }
            };
        }
        let names = &source.places;
        let names: Vec<String> = names
            .iter()
            .map(|place| format!("`{}`", shortened(&self.names[*place])))
            .collect();
        let mean = if names.len() > 1 {
            "the mean of columns"
        } else {
            "column"
        };
        let text = match &unit {
            Some(unit) if size != 1.0 || !is_own => Some(format!(
                "taken from {mean} {} [{}]",
                names.join(", "),
                shortened(unit)
            )),
            None if !is_own && column.quantity == Quantity::Label => {
                Some(format!("taken from {mean} {}", names.join(", ")))
            }
            None if !is_own => Some(format!(
                "taken from {mean} {}, without a unit, as [{}]",
                names.join(", "),
                column.unit
            )),
            _ => None,
        };
        self.sources[index].unit = unit.filter(|_| size != 1.0).map(|unit| (size, unit));
        if let Some(text) = text {
            self.found(index, text, false);
        }
        Ok(())
    }

    /// Names unused columns that look like a quantity without a column.
    fn doubt(&mut self, taken: &[usize]) {
        for (index, column) in self.columns.iter().enumerate() {
            if !self.sources[index].places.is_empty() {
                continue;
            }
            let free = (0..self.names.len()).filter(|place| !taken.contains(place));
            let alike = free.filter(|place| resembles(column.name, &self.names[*place]));
            let alike: Vec<String> = alike
                .map(|place| shortened(&self.names[place]).into())
                .collect();
            if let Some(first) = alike.first() {
                // What is in brackets is no unit that is known.
                let unit = if first.contains(['[', '(']) {
                    ":UNIT"
                } else {
                    ""
                };
                let argument = format!("{}={first}{unit}", column.name);
                let text = format!(
                    "there is none, but `{}` looks like it and is not read; if it is, --column {} takes it",
                    alike.join("`, `"),
                    shell_quoted(&argument)
                );
                self.found(index, text, true);
            }
        }
    }

    fn found(&mut self, index: usize, text: String, is_doubt: bool) {
        self.findings.push(Finding {
            index,
            line: self.line,
            text,
            is_doubt,
        });
    }

    /// The error of a quantity without a column.
    fn missing(&self, column: &ColumnSpec) -> CsvError {
        let known = |name: &&str| {
            let mut specs = self.columns.iter().zip(&self.sources);
            !specs.any(|(_, source)| {
                source
                    .places
                    .iter()
                    .any(|place| self.names[*place] == **name)
            })
        };
        let names: Vec<&str> = self
            .names
            .iter()
            .map(String::as_str)
            .filter(known)
            .collect();
        let likely = likely(column.name, &names);
        CsvError::MissingColumn {
            cell: self.cell_at(self.line, self.names.len()),
            missing: column.name,
            required: required(self.columns).into(),
            found: Box::new(FoundColumns {
                names: self.names.clone(),
                likely: likely.into_iter().map(Into::into).collect(),
            }),
        }
    }

    /// What was taken as what, and what was not.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// Whether the table has a column for a quantity.
    pub fn has(&self, name: &str) -> bool {
        let mut all = self.columns.iter().zip(&self.sources);
        all.any(|(column, source)| column.name == name && !source.places.is_empty())
    }

    /// The cell of a column in some line.
    pub fn cell(&self, line: usize, index: usize) -> Cell {
        let place = self.sources[index].places.first();
        self.cell_at(line, place.copied().unwrap_or(self.names.len()))
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
        self.last_line
    }

    /// The unit of a column's numbers in the file.
    fn unit(&self, index: usize) -> &str {
        let other = self.sources[index].unit.as_ref();
        other.map_or(self.columns[index].unit, |(_, unit)| unit)
    }

    /// The error of a table without rows.
    pub fn no_rows(&self, index: usize) -> CsvError {
        let cell = self.cell(self.last_line() + 1, index);
        let expected = "at least one row of numbers";
        malformed(cell, "the end of the file", expected)
    }

    /// The error of a required column without numbers.
    pub fn no_numbers(&self, index: usize) -> CsvError {
        let expected = format!("at least one number [{}]", self.unit(index));
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
    /// Empty cells behind the header's last one, and missing ones below empty names, count as what a separator at the
    /// end of a line leaves.
    fn check_length(&self) -> Result<(), CsvError> {
        let (cells, wanted) = (self.record.len(), self.header.names.len());
        let mut beyond = self.record.iter().skip(wanted);
        let mut unnamed = self.header.names.iter().skip(cells);
        if beyond.all(|cell| cell.trim_ascii().is_empty()) && unnamed.all(String::is_empty) {
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
        let place = self.header.sources[index].places.first();
        place.map_or(&[], |place| self.at(*place))
    }

    fn at(&self, place: usize) -> &[u8] {
        self.record.get(place).unwrap_or_default().trim_ascii()
    }

    /// The number in a column, in the unit of its quantity; the mean of several columns. `None` for an empty cell, or
    /// without that column.
    ///
    /// # Errors
    /// Anything except a finite number.
    pub fn number(&self, index: usize) -> Result<Option<f64>, CsvError> {
        let source = &self.header.sources[index];
        let mut sum = 0.0;
        for place in &source.places {
            match self.number_at(index, *place)? {
                Some(value) => sum += value,
                None => return Ok(None),
            }
        }
        let count = source.places.len();
        if count == 0 {
            return Ok(None);
        }
        let size = source.unit.as_ref().map_or(1.0, |(size, _)| *size);
        Ok(Some(
            if count == 1 { sum } else { sum / count as f64 } * size,
        ))
    }

    fn number_at(&self, index: usize, place: usize) -> Result<Option<f64>, CsvError> {
        let bytes = self.at(place);
        if bytes.is_empty() {
            return Ok(None);
        }
        let text = std::str::from_utf8(bytes).ok();
        let number = text.and_then(|text| match text.parse::<f64>() {
            Ok(number) => Some(number),
            // Where commas do not separate cells, they are decimal.
            Err(_) if self.header.separator != b',' => text.replacen(',', ".", 1).parse().ok(),
            Err(_) => None,
        });
        match number {
            Some(value) if value.is_finite() => Ok(Some(value)),
            other => {
                let kind = if other.is_some() {
                    "a finite number"
                } else {
                    "a number"
                };
                let date = match self.header.columns[index].quantity {
                    _ if text.is_some_and(groups_thousands) => " without separators of thousands",
                    Quantity::Time if other.is_none() => " or an ISO 8601 date and time",
                    Quantity::Time => "",
                    _ => ", or an empty cell where nothing was measured",
                };
                let expected = format!("{kind} [{}]{date}", self.header.unit(index));
                Err(malformed(
                    self.header.cell_at(self.line, place),
                    quoted(bytes),
                    expected,
                ))
            }
        }
    }

    /// The number in a column that must not be empty. A time may be a date and a time of day; it counts from the first.
    ///
    /// # Errors
    /// An empty cell, and the errors of [`TableRow::number`].
    pub fn required_number(&self, index: usize) -> Result<f64, CsvError> {
        if self.header.columns[index].quantity == Quantity::Time
            && let Ok(text) = std::str::from_utf8(self.bytes(index))
            && let Some(time) = self.header.calendar.borrow_mut().seconds(text)
        {
            return Ok(time);
        }
        let is_calendar = || self.header.calendar.borrow().is_used();
        if self.header.columns[index].quantity == Quantity::Time && is_calendar() {
            let expected = "a date and time as in the first row";
            return Err(malformed(
                self.cell(index),
                quoted(self.bytes(index)),
                expected,
            ));
        }
        self.number(index)?.ok_or_else(|| {
            let expected = format!("a number [{}]", self.header.unit(index));
            malformed(self.cell(index), "an empty cell", expected)
        })
    }
}

/// Whether a number's digits stand in groups, as in `1,234,567.8` or `1'234`.
fn groups_thousands(text: &str) -> bool {
    let whole = text.trim_start_matches(['-', '+']).split('.').next();
    let groups: Vec<&str> = whole.unwrap_or_default().split([',', '\'', ' ']).collect();
    let is_whole = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    groups.len() > 1
        && groups.iter().all(|group| is_whole(group))
        && (1..=3).contains(&groups[0].len())
        && groups[1..].iter().all(|group| group.len() == 3)
}
