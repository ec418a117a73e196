//! The errors in JSON of vehicles, terrains, effects and models.

use crate::display::{listed, shortened};
use crate::effects::{ProfileError, WindowError};
use crate::parameter::ParameterError;
use serde_json::Value;
use std::fmt;

/// Why JSON is refused.
#[derive(Debug, Clone, PartialEq)]
pub enum JsonError {
    /// The text is not JSON.
    Syntax {
        /// Line of the text, from 1.
        line: usize,
        /// Column of the line, from 1.
        column: usize,
        /// The parser's message.
        message: String,
    },
    /// A value of the wrong type.
    WrongType {
        /// A key, an element such as `row_positions[1]`, or the kind of object.
        place: String,
        /// The value there.
        found: String,
        /// The expected value.
        expected: String,
    },
    /// A required key that is missing.
    MissingKey {
        /// The kind of object.
        what: &'static str,
        /// The key.
        key: &'static str,
        /// Its expected value.
        expected: String,
    },
    /// An unknown key.
    UnknownKey {
        /// The kind of object.
        what: &'static str,
        /// The key.
        key: String,
        /// The known key with the nearest spelling.
        nearest: &'static str,
    },
    /// An object of several terrains instead of one.
    SeveralTerrains {
        /// Their names.
        names: Vec<String>,
    },
    /// One terrain among several is wrong.
    InTerrain {
        /// Its name.
        name: String,
        /// What is wrong with it.
        source: Box<JsonError>,
    },
    /// Numbers that give no profile of slopes.
    Profile {
        /// Where.
        place: String,
        /// What is wrong with it.
        source: ProfileError,
    },
    /// A name of no effect.
    UnknownEffect {
        /// Where.
        place: String,
        /// The name.
        name: String,
        /// The effect with the nearest spelling.
        nearest: &'static str,
    },
    /// An invalid window.
    Window {
        /// Where.
        place: &'static str,
        /// What is wrong with it.
        source: WindowError,
    },
    /// A value outside its range.
    OutOfRange(ParameterError),
}

impl JsonError {
    pub(crate) fn wrong_type(place: impl Into<String>, found: &Value, expected: String) -> Self {
        Self::WrongType {
            place: place.into(),
            found: describe(found),
            expected,
        }
    }
}

/// A value in words, short enough for a message.
fn describe(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(truth) => format!("the truth value {truth}"),
        Value::Number(number) => format!("the number {number}"),
        Value::String(text) => format!("the text \"{}\"", shortened(text)),
        Value::Array(items) => format!("an array of {} values", items.len()),
        Value::Object(_) => "an object".into(),
    }
}

impl From<serde_json::Error> for JsonError {
    fn from(error: serde_json::Error) -> Self {
        let (line, column) = (error.line(), error.column());
        let message = error.to_string();
        let place = format!(" at line {line} column {column}");
        Self::Syntax {
            line,
            column,
            message: message.strip_suffix(&place).unwrap_or(&message).into(),
        }
    }
}

impl From<ParameterError> for JsonError {
    fn from(error: ParameterError) -> Self {
        Self::OutOfRange(error)
    }
}

impl fmt::Display for JsonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax {
                line,
                column,
                message,
            } => write!(f, "line {line}, column {column}: not JSON: {message}"),
            Self::WrongType {
                place,
                found,
                expected,
            } => write!(f, "{place}: found {found}, expected {expected}"),
            Self::MissingKey {
                what,
                key,
                expected,
            } => write!(f, "the {what} has no key `{key}`, expected {expected}"),
            Self::UnknownKey { what, key, nearest } => write!(
                f,
                "the {what} has an unknown key `{}`; the nearest known one is `{nearest}`",
                shortened(key)
            ),
            Self::SeveralTerrains { names } => {
                write!(
                    f,
                    "found several terrains ({}), expected one",
                    listed(names, ", ")
                )
            }
            Self::InTerrain { name, source } => write!(f, "{}: {source}", shortened(name)),
            Self::Profile { place, source } => write!(f, "{place}: {source}"),
            Self::UnknownEffect {
                place,
                name,
                nearest,
            } => write!(
                f,
                "{place}: no effect is called `{}`; the nearest is `{nearest}`",
                shortened(name)
            ),
            Self::Window { place, source } => write!(f, "{place}: {source}"),
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for JsonError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::InTerrain { source, .. } => Some(source),
            Self::Profile { source, .. } => Some(source),
            Self::Window { source, .. } => Some(source),
            _ => None,
        }
    }
}
