//! Columns that the user names.

use crate::recording::channel::Channel;
use std::fmt;
use std::str::FromStr;

/// A quantity, the columns that hold it, and their unit: `omega_left=wl:rpm`.
///
/// Several columns, joined by `+`, are averaged: the wheels of a side. `#3` is the third column of a file without header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnRequest {
    /// Name of the quantity: `time`, `run`, or that of a channel.
    pub(super) target: String,
    /// Columns and unit, as the user wrote them.
    pub(super) columns: String,
}

impl FromStr for ColumnRequest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = || Channel::ALL.map(Channel::name);
        let (target, columns) = text
            .split_once('=')
            .filter(|(_, columns)| !columns.trim().is_empty())
            .ok_or("expected NAME=COLUMN or NAME=COLUMN:UNIT, such as omega_left=wl:rpm")?;
        let target = target.trim();
        if !["time", "run"].contains(&target) && !known().contains(&target) {
            let names = known().join(", ");
            return Err(format!("`{target}` is none of time, run, {names}"));
        }
        Ok(Self {
            target: target.into(),
            columns: columns.trim().into(),
        })
    }
}

impl fmt::Display for ColumnRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "--column {}={}", self.target, self.columns)
    }
}

/// What is known about a table besides its text.
#[derive(Debug, Clone, Copy, Default)]
pub struct TableOptions<'a> {
    /// Columns that the user names.
    pub columns: &'a [ColumnRequest],
    /// Converts the speed of rims \[m\].
    pub wheel_radius: Option<f64>,
}

impl TableOptions<'_> {
    /// Whether the columns are named by their numbers, as in a file without a header.
    pub fn by_number(&self) -> bool {
        !self.columns.is_empty() && self.columns.iter().all(|one| one.columns.starts_with('#'))
    }
}
