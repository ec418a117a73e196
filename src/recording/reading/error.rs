//! Why a file is no recording.

use crate::json::JsonError;
use crate::recording::CsvError;
use std::fmt;

/// Why a file, or the one beside it, is no recording.
#[derive(Debug)]
pub enum RecordingError {
    /// The measurements, or a file that cannot be read.
    Csv(CsvError),
    /// What stands beside them.
    About {
        /// Name of the file.
        file: String,
        /// What is wrong with it.
        source: JsonError,
    },
}

impl From<CsvError> for RecordingError {
    fn from(error: CsvError) -> Self {
        Self::Csv(error)
    }
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Csv(error) => error.fmt(f),
            Self::About { file, source } => write!(f, "{file}: {source}"),
        }
    }
}

impl std::error::Error for RecordingError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Csv(error) => error.source(),
            Self::About { source, .. } => source.source(),
        }
    }
}
