//! Errors of CSV files, with their place.

use crate::display::{listed, shell_quoted, shortened};
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
        listed(&found.names, "`, `"), required.join(", "), remedy(missing, &found.names, &found.likely)
    )]
    MissingColumn {
        /// After the header's last cell.
        cell: Cell,
        /// The missing column.
        missing: &'static str,
        /// All required columns.
        required: Box<[&'static str]>,
        /// What the header has instead.
        found: Box<FoundColumns>,
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

/// The columns of a header that lacks one.
#[derive(Debug)]
pub struct FoundColumns {
    /// The header's cells.
    pub names: Vec<String>,
    /// Those that are probably meant.
    pub likely: Vec<String>,
}

/// How to repair a header that lacks a column, in brackets.
fn remedy(missing: &str, found: &[String], likely: &[String]) -> String {
    if found.iter().any(|name| name.contains('\0')) {
        return " (save the file as UTF-8)".into();
    }
    let unit = if missing.starts_with("omega") {
        ":UNIT"
    } else {
        ""
    };
    match likely {
        [] => format!(" (--column {missing}=NAME{unit} names it)"),
        [one] => {
            let one = shortened(one);
            let argument = format!("{missing}={one}{unit}");
            let argument = shell_quoted(&argument);
            format!(" (`{one}` may be it: --column {argument})")
        }
        several => {
            let mean = format!("{missing}={}{unit}", listed(several, "+"));
            let mean = shell_quoted(&mean);
            format!(
                " (`{}` may be it: --column {missing}=NAME{unit}, or their mean: --column {mean})",
                listed(several, "`, `")
            )
        }
    }
}

pub fn malformed(cell: Cell, found: impl Into<String>, expected: impl Into<String>) -> CsvError {
    CsvError::Malformed {
        cell,
        found: found.into(),
        expected: expected.into(),
    }
}
