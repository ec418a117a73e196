//! JSON objects with a fixed set of keys.

use super::error::JsonError;
use super::unique::Unique;
use crate::spelling::nearest;
use serde_json::{Map, Value};

/// The key of the mark.
pub(super) const FORMAT: &str = "format";
/// The mark of a file of a model.
pub const MODEL_FORMAT: &str = "ugv-model/1";
/// The mark of a file of effects.
pub const EFFECTS_FORMAT: &str = "ugv-effects/1";

/// Recordings list under this key which values of a vehicle were not measured.
const IGNORED: &str = "assumed";

/// A key and its expected value.
pub(super) struct Key {
    pub name: &'static str,
    /// "a number [kg]".
    pub expected: &'static str,
}

pub(super) const fn key(name: &'static str, expected: &'static str) -> Key {
    Key { name, expected }
}

/// An object whose keys are all known.
pub(super) struct Object<'a> {
    what: &'static str,
    keys: &'static [Key],
    map: &'a Map<String, Value>,
}

/// Parses a text, with or without a byte order mark.
pub(crate) fn parse(text: &str) -> Result<Value, JsonError> {
    let Unique(value) = serde_json::from_str(text.strip_prefix('\u{feff}').unwrap_or(text))?;
    Ok(value)
}

/// JSON that this crate has written.
pub(crate) fn parsed(text: &str) -> Value {
    serde_json::from_str(text).expect("what the crate writes is JSON")
}

/// The description or name of a vehicle or a terrain: the value itself, or the value of that key, as in
/// models and the files beside recordings.
///
/// # Errors
/// A model of another version, in which the key may mean another thing.
pub(super) fn unwrap<'a>(value: &'a Value, key: &str) -> Result<&'a Value, JsonError> {
    let is_whole = |inner: &&Value| inner.is_object() || inner.is_string();
    let Some(inner) = value.get(key).filter(is_whole) else {
        return Ok(value);
    };
    let family = |name: &str| name.split('/').next() == MODEL_FORMAT.split('/').next();
    match value.get(FORMAT) {
        Some(format) if format.as_str().is_some_and(family) => check_format(format, MODEL_FORMAT)?,
        _ => {}
    }
    Ok(inner)
}

pub(super) fn as_object<'a>(
    value: &'a Value,
    place: &str,
    expected: &str,
) -> Result<&'a Map<String, Value>, JsonError> {
    value
        .as_object()
        .ok_or_else(|| JsonError::wrong_type(place, value, expected.into()))
}

pub(super) fn check_format(value: &Value, expected: &'static str) -> Result<(), JsonError> {
    if value == expected {
        return Ok(());
    }
    Err(JsonError::wrong_type(
        FORMAT,
        value,
        format!("\"{expected}\""),
    ))
}

/// Refuses unknown keys and suggests the nearest known one.
pub(super) fn check_keys<'a>(
    what: &'static str,
    mut keys: impl Iterator<Item = &'a String>,
    known: impl IntoIterator<Item = &'static str>,
) -> Result<(), JsonError> {
    let known: Vec<&str> = known.into_iter().collect();
    match keys.find(|key| !known.contains(&key.as_str())) {
        None => Ok(()),
        Some(key) => Err(JsonError::UnknownKey {
            what,
            key: key.clone(),
            nearest: nearest(key, known).unwrap_or_default(),
        }),
    }
}

impl<'a> Object<'a> {
    pub fn new(
        what: &'static str,
        keys: &'static [Key],
        value: &'a Value,
    ) -> Result<Self, JsonError> {
        let Value::Object(map) = value else {
            let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
            let expected = format!("an object with the keys {}", names.join(", "));
            return Err(JsonError::wrong_type(what, value, expected));
        };
        let written = map.keys().filter(|key| *key != IGNORED);
        check_keys(what, written, keys.iter().map(|key| key.name))?;
        Ok(Self { what, keys, map })
    }

    fn get(&self, name: &'static str) -> Result<(&'a Value, &'static str), JsonError> {
        let expected = self
            .keys
            .iter()
            .find(|key| key.name == name)
            .map_or("", |key| key.expected);
        match self.map.get(name) {
            Some(value) => Ok((value, expected)),
            None => Err(JsonError::MissingKey {
                what: self.what,
                key: name,
                expected: expected.into(),
            }),
        }
    }

    pub fn number(&self, name: &'static str) -> Result<f64, JsonError> {
        let (value, expected) = self.get(name)?;
        value
            .as_f64()
            .ok_or_else(|| JsonError::wrong_type(name, value, expected.into()))
    }

    pub fn numbers(&self, name: &'static str) -> Result<Vec<f64>, JsonError> {
        let (value, expected) = self.get(name)?;
        let Value::Array(items) = value else {
            return Err(JsonError::wrong_type(name, value, expected.into()));
        };
        let number = |(index, item): (usize, &Value)| {
            item.as_f64().ok_or_else(|| {
                JsonError::wrong_type(format!("{name}[{index}]"), item, "a number".into())
            })
        };
        items.iter().enumerate().map(number).collect()
    }
}

/// Writes an object, one key to a line, in the given order.
pub(super) fn write(entries: &[(&str, Value)]) -> String {
    let lines: Vec<String> = entries
        .iter()
        .map(|(key, value)| format!("  \"{key}\": {value}"))
        .collect();
    format!("{{\n{}\n}}\n", lines.join(",\n"))
}
