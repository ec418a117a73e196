//! Models as JSON: vehicle, terrain and effects together.

use super::error::JsonError;
use super::object::{self, MODEL_FORMAT, as_object, check_format, check_keys, parsed};
use crate::effects::Effects;
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};
use serde_json::{Value, json};

const KEYS: [&str; 6] = [
    "format",
    "vehicle",
    "terrain",
    "effects",
    "fitted_to",
    "note",
];

/// A recording that a model was fitted to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FittedTo {
    /// Its name.
    pub recording: String,
    /// All of it, or only the half that `ugv score` does not use.
    pub whole: bool,
}

/// Values of the key `part`.
const ALL: &str = "all";
const HALF: &str = "half";

impl FittedTo {
    /// The recordings in the file of a model; empty where it names none.
    #[must_use]
    pub fn from_json(text: &str) -> Vec<Self> {
        let value = object::parse(text).unwrap_or_default();
        let entries = value["fitted_to"].as_array().into_iter().flatten();
        let read = |entry: &Value| {
            Some(Self {
                recording: entry["recording"].as_str()?.into(),
                whole: entry["part"] != HALF,
            })
        };
        entries.filter_map(read).collect()
    }
}

impl Specification {
    /// Reads a model from JSON: an object with the keys `format`, `vehicle`, `terrain` (an object,
    /// or the name of one of the paper's) and `effects` (which may be missing); `note` is for
    /// people, `fitted_to` read by [`FittedTo::from_json`].
    ///
    /// # Errors
    /// Text that is not JSON, keys that are missing or unknown, and what vehicle, terrain and
    /// effects refuse.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        Self::from_json_value(&object::parse(text)?)
    }

    /// As [`Specification::from_json`], from JSON that is parsed already.
    ///
    /// # Errors
    /// As [`Specification::from_json`].
    pub fn from_json_value(value: &Value) -> Result<Self, JsonError> {
        let expected = "an object with the keys format, vehicle, terrain and effects";
        let map = as_object(value, "model", expected)?;
        check_keys("model", map.keys(), KEYS)?;
        let get = |key: &'static str, expected: &str| {
            map.get(key).ok_or_else(|| JsonError::MissingKey {
                what: "model",
                key,
                expected: expected.into(),
            })
        };
        check_format(get("format", &format!("\"{MODEL_FORMAT}\""))?, MODEL_FORMAT)?;
        let terrain = get("terrain", "a terrain or the name of one")?;
        let effects = map.get("effects").map(Effects::from_json_value);
        Ok(Self {
            vehicle: Vehicle::from_json_value(get("vehicle", "a vehicle")?)?,
            terrain: Terrain::from_json_value(terrain)?,
            effects: effects.transpose()?.unwrap_or_default(),
        })
    }

    /// The model as JSON that [`Specification::from_json`] reads back to the last bit (the
    /// friction angle, in degrees there, to rounding).
    #[must_use]
    pub fn to_json(&self) -> String {
        format!("{:#}\n", self.to_json_value())
    }

    /// As [`Specification::to_json`], with what the model was fitted to.
    #[must_use]
    pub fn to_json_fitted(&self, to: &[FittedTo]) -> String {
        let each = to.iter().map(
            |to| json!({ "recording": to.recording, "part": if to.whole { ALL } else { HALF } }),
        );
        let mut value = self.to_json_value();
        value["fitted_to"] = each.collect();
        format!("{value:#}\n")
    }

    fn to_json_value(&self) -> Value {
        json!({
            "format": MODEL_FORMAT,
            "vehicle": parsed(&self.vehicle.to_json()),
            "terrain": parsed(&self.terrain.to_json()),
            "effects": self.effects.to_json_value(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_read_back() {
        let model = Specification {
            vehicle: Vehicle::tran2007(),
            terrain: Terrain::preset("dry_sand").unwrap(),
            effects: Effects::NONE.with("grade.slope_north", -0.07).unwrap(),
        };
        assert_eq!(Specification::from_json(&model.to_json()), Ok(model));
    }

    #[test]
    fn recordings_of_the_fit_are_read_back() {
        let model = Specification::plain(Vehicle::tran2007(), Terrain::preset("dry_clay").unwrap());
        let to = [("monday", true), ("tuesday", false)].map(|(recording, whole)| FittedTo {
            recording: recording.into(),
            whole,
        });
        let text = model.to_json_fitted(&to);
        assert_eq!(FittedTo::from_json(&text), to);
        assert_eq!(Specification::from_json(&text), Ok(model.clone()));
        assert_eq!(FittedTo::from_json(&model.to_json()), []);
    }

    #[test]
    fn what_is_missing_or_unknown_is_named() {
        let error = |text: &str| Specification::from_json(text).unwrap_err().to_string();
        assert_eq!(
            error("{}"),
            "the model has no key `format`, expected \"ugv-model/1\""
        );
        assert!(error(r#"{"efects": {}}"#).contains("nearest known one is `effects`"));
        let text = Specification::plain(Vehicle::tran2007(), Terrain::preset("dry_clay").unwrap());
        let mut json: Value = serde_json::from_str(&text.to_json()).unwrap();
        json["terrain"] = "dry_sand".into();
        let named = Specification::from_json_value(&json).unwrap();
        assert_eq!(named.terrain, Terrain::preset("dry_sand").unwrap());
        json["terrain"] = "mud".into();
        let message = Specification::from_json_value(&json)
            .unwrap_err()
            .to_string();
        assert!(message.contains("one of dry_sand"), "{message}");
    }
}
