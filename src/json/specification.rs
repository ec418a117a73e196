//! Models as JSON: vehicle, terrain and effects together.

use super::JsonError;
use super::effects::{as_object, check_format};
use super::object;
use crate::effects::Effects;
use crate::spelling::nearest;
use crate::terrain::Terrain;
use crate::vehicle::{Specification, Vehicle};
use serde_json::{Value, json};

/// What marks a file of a model.
pub const MODEL_FORMAT: &str = "ugv-model/1";

const KEYS: [&str; 5] = ["format", "vehicle", "terrain", "effects", "note"];

impl Specification {
    /// Reads a model from JSON: an object with the keys `format`, `vehicle`, `terrain` (an object,
    /// or the name of one of the paper's) and `effects` (which may be missing); `note` is for
    /// people.
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
        if let Some(key) = map.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(JsonError::UnknownKey {
                what: "model",
                key: key.clone(),
                nearest: nearest(key, KEYS).unwrap_or_default(),
            });
        }
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
        let parsed = |text: String| -> Value {
            serde_json::from_str(&text).expect("what the crate writes is JSON")
        };
        let value = json!({
            "format": MODEL_FORMAT,
            "vehicle": parsed(self.vehicle.to_json()),
            "terrain": parsed(self.terrain.to_json()),
            "effects": self.effects.to_json_value(),
        });
        format!("{value:#}\n")
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
