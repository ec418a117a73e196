//! What can be wrong with a recording's CSV, and where.

use crate::display::{listed, shortened};
use crate::spelling::nearest;
use std::fmt;
use std::io;

/// Where in a file something is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column among the separated ones, from 1.
    pub column: usize,
    /// The column's name, where it has one.
    pub name: Option<String>,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: line {}, column {}",
            self.file, self.line, self.column
        )?;
        match &self.name {
            Some(name) => write!(f, " ({})", shortened(name)),
            None => Ok(()),
        }
    }
}

/// Why a text is no recording.
#[derive(Debug)]
pub enum CsvError {
    /// The file cannot be read.
    Read {
        /// Name of the file.
        file: String,
        /// Why.
        source: io::Error,
    },
    /// A line too long for any table.
    LongLine {
        /// Name of the file.
        file: String,
        /// The line, from 1.
        line: usize,
    },
    /// The header lacks a column.
    MissingColumn {
        /// Behind the header's last cell.
        cell: Cell,
        /// The column that is missing.
        missing: &'static str,
        /// All columns that must be there.
        required: Box<[&'static str]>,
        /// The header's cells.
        found: Vec<String>,
    },
    /// Something else stands in a place than should.
    Malformed {
        /// The place.
        cell: Cell,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
}

impl fmt::Display for CsvError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { file, .. } => write!(f, "cannot read {file}"),
            Self::LongLine { file, line } => write!(
                f,
                "{file}: line {line}: found more than 1 MB without a line end, expected a table (is it another kind of file?)"
            ),
            Self::MissingColumn {
                cell,
                missing,
                required,
                found,
            } => {
                write!(
                    f,
                    "{cell}: found no column `{missing}` among `{}`",
                    listed(found, "`, `")
                )?;
                write!(f, ", expected a header with {}", required.join(", "))?;
                match remedy(missing, required, found) {
                    Some(remedy) => write!(f, " ({remedy})"),
                    None => Ok(()),
                }
            }
            Self::Malformed {
                cell,
                found,
                expected,
            } => write!(f, "{cell}: found {found}, expected {expected}"),
        }
    }
}

/// What to do about a header that lacks a column.
fn remedy(missing: &str, required: &[&str], found: &[String]) -> Option<String> {
    let has = |signs: &[char]| found.iter().any(|name| name.contains(signs));
    if has(&['\0']) {
        return Some("save the file as UTF-8".into());
    }
    if has(&[';', '\t']) {
        return Some("separate the cells by commas".into());
    }
    if found.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Some("put the header above the first row of numbers".into());
    }
    let others = || {
        let names = found.iter().map(String::as_str);
        names.filter(|name| !required.contains(name))
    };
    if let Some(meant) = others().find(|name| plain(name) == missing) {
        let meant = shortened(meant);
        return Some(format!("name the column `{missing}` instead of `{meant}`"));
    }
    let near = nearest(missing, others())?;
    Some(format!("the nearest is `{}`", shortened(near)))
}

/// A column's name in small letters, without a unit in brackets.
pub fn plain(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default();
    name.trim().to_lowercase().replace([' ', '-'], "_")
}

impl std::error::Error for CsvError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Read { source, .. } => Some(source),
            _ => None,
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
