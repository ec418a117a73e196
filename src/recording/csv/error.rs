//! Errors of CSV files, with their place.

use crate::display::{listed, shortened};
use crate::spelling::nearest;
use std::fmt;
use std::io;
use thiserror::Error;

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column among the separated ones, from 1.
    pub column: usize,
    /// Name of the column, if it has one.
    pub name: Option<String>,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file, line, column, ..
        } = self;
        write!(f, "{file}: line {line}, column {column}")?;
        match &self.name {
            Some(name) => write!(f, " ({})", shortened(name)),
            None => Ok(()),
        }
    }
}

/// Why a text is no table of the expected kind.
#[derive(Debug, Error)]
pub enum CsvError {
    /// The file cannot be read.
    #[error("cannot read {file}")]
    Read {
        /// Name of the file.
        file: String,
        /// The system's error.
        source: io::Error,
    },
    /// A line too long for any table.
    #[error(
        "{file}: line {line}: found more than 1 MB without a line end, expected a table (is it another kind of file?)"
    )]
    LongLine {
        /// Name of the file.
        file: String,
        /// The line, from 1.
        line: usize,
    },
    /// The header lacks a column.
    #[error(
        "{cell}: found no column `{missing}` among `{}`, expected a header with {}{}",
        listed(found, "`, `"), required.join(", "), remedy(missing, required, found)
    )]
    MissingColumn {
        /// After the header's last cell.
        cell: Cell,
        /// The missing column.
        missing: &'static str,
        /// All required columns.
        required: Box<[&'static str]>,
        /// The header's cells.
        found: Vec<String>,
    },
    /// An unexpected cell.
    #[error("{cell}: found {found}, expected {expected}")]
    Malformed {
        /// The place.
        cell: Cell,
        /// What the file has there.
        found: String,
        /// What it should have.
        expected: String,
    },
}

/// How to repair a header that lacks a column, in brackets; empty if unknown.
fn remedy(missing: &str, required: &[&str], found: &[String]) -> String {
    let has = |signs: &[char]| found.iter().any(|name| name.contains(signs));
    if has(&['\0']) {
        return " (save the file as UTF-8)".into();
    }
    if has(&[';', '\t']) {
        return " (separate the cells by commas)".into();
    }
    if found.iter().all(|name| name.parse::<f64>().is_ok()) {
        return " (put the header above the first row of numbers)".into();
    }
    let others = || {
        let names = found.iter().map(String::as_str);
        names.filter(|name| !required.contains(name))
    };
    if let Some(meant) = others().find(|name| plain(name) == missing) {
        let meant = shortened(meant);
        return format!(" (name the column `{missing}` instead of `{meant}`)");
    }
    nearest(missing, others()).map_or_else(String::new, |near| {
        format!(" (the nearest is `{}`)", shortened(near))
    })
}

/// A column's name in small letters, without a unit in brackets.
pub fn plain(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default();
    name.trim().to_lowercase().replace([' ', '-'], "_")
}

pub fn malformed(cell: Cell, found: impl Into<String>, expected: impl Into<String>) -> CsvError {
    CsvError::Malformed {
        cell,
        found: found.into(),
        expected: expected.into(),
    }
}
