//! The metadata in the JSON file beside a recording.

use crate::json::{self, JsonError};
use crate::terrain::Terrain;
use crate::vehicle::Vehicle;
use serde_json::{Map, Value};

/// Vehicle, terrain, sensors and provenance of a recording; each may be unknown.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct About {
    /// The vehicle that drove.
    pub vehicle: Option<Vehicle>,
    /// The nominal terrain: an assumption, not a measurement.
    pub terrain: Option<Terrain>,
    /// Name of the nominal terrain, where it is a preset.
    pub terrain_name: Option<String>,
    /// The JSON entry of each sensor: noise, delay, mounting.
    pub sensors: Map<String, Value>,
    /// Where the recording comes from.
    pub source: String,
    /// Licence under which it may be used.
    pub licence: String,
    /// Anything else worth knowing.
    pub note: String,
    /// Warnings of the importer that made the recording, each a sentence.
    pub import_warnings: Vec<String>,
}

/// What the importer's notes begin with that are warnings.
pub(crate) const IMPORT_WARNING: &str = "warning: ";

impl About {
    /// Reads the keys `vehicle`, `terrain` (a preset's name, or an object), `sensors`, `source`, `licence` and `note`, and
    /// the warnings among the `notes` of `provenance`.
    /// Other keys are ignored: they may hold the solution, which an analysis must not see.
    ///
    /// # Errors
    /// Text that is not JSON, values of another type, and an invalid vehicle or terrain.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        let json = json::parse(text)?;
        let Value::Object(map) = &json else {
            let expected = "an object with keys such as `vehicle`".into();
            return Err(JsonError::wrong_type("the file", &json, expected));
        };
        let known = |key| map.get(key).filter(|value| !value.is_null());
        let text = |key| match known(key) {
            None => Ok(String::new()),
            Some(Value::String(text)) => Ok(text.clone()),
            Some(other) => Err(JsonError::wrong_type(key, other, "a text".into())),
        };
        let terrain = known("terrain");
        Ok(Self {
            vehicle: known("vehicle").map(Vehicle::from_json_value).transpose()?,
            terrain: terrain.map(Terrain::from_json_value).transpose()?,
            terrain_name: terrain.and_then(Value::as_str).map(Into::into),
            sensors: match known("sensors") {
                None => Map::new(),
                Some(Value::Object(sensors)) => sensors.clone(),
                Some(other) => {
                    let expected = "an object with one key per sensor".into();
                    return Err(JsonError::wrong_type("sensors", other, expected));
                }
            },
            source: text("source")?,
            licence: text("licence")?,
            note: text("note")?,
            import_warnings: import_warnings(map.get("provenance")),
        })
    }
}

/// The warnings among the notes of `ugv import`. Another tool may keep anything there.
fn import_warnings(provenance: Option<&Value>) -> Vec<String> {
    let notes = provenance.and_then(|provenance| provenance.get("notes")?.as_array());
    let texts = notes.into_iter().flatten().filter_map(Value::as_str);
    let warnings = texts.filter_map(|text| text.strip_prefix(IMPORT_WARNING));
    warnings.map(Into::into).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        About::from_json(text).unwrap_err().to_string()
    }

    #[test]
    fn known_keys_are_read_and_others_ignored() {
        let vehicle = Vehicle::tran2007();
        let text = format!(
            r#"{{"vehicle": {}, "terrain": "dry_clay", "sensors": {{"pose": "lidar"}}, "source": "s",
               "licence": "MIT", "note": "n", "terrain_as_recorded": "grass", "secret": [1]}}"#,
            vehicle.to_json()
        );
        let about = About::from_json(&text).unwrap();
        assert_eq!(about.vehicle, Some(vehicle));
        assert_eq!(about.terrain, Terrain::preset("dry_clay"));
        assert_eq!(about.terrain_name.as_deref(), Some("dry_clay"));
        assert_eq!(about.sensors["pose"], "lidar");
        let texts = [&about.source, &about.licence, &about.note];
        assert_eq!(texts, ["s", "MIT", "n"]);
        assert_eq!(About::from_json("{}"), Ok(About::default()));
    }

    #[test]
    fn warnings_of_the_importer_are_kept() {
        let of = |provenance: &str| {
            let text = format!(r#"{{"provenance": {provenance}}}"#);
            About::from_json(&text).unwrap().import_warnings
        };
        let notes = r#"{"notes": ["imu from /imu", "warning: /odom is wheel odometry", 3]}"#;
        assert_eq!(of(notes), ["/odom is wheel odometry"]);
        for other in ["null", "[]", r#"{"notes": "none"}"#] {
            assert!(of(other).is_empty());
        }
    }

    #[test]
    fn terrain_may_be_an_object() {
        let soil = Terrain::preset("sandy_loam").unwrap();
        let about = About::from_json(&format!(r#"{{"terrain": {}}}"#, soil.to_json())).unwrap();
        assert_eq!((about.terrain, about.terrain_name), (Some(soil), None));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, expected) in [
            (
                "[]",
                "the file: found an array of 0 values, expected an object",
            ),
            (
                r#"{"note": 3}"#,
                "note: found the number 3, expected a text",
            ),
            (r#"{"sensors": "gps"}"#, "sensors: found the text \"gps\""),
            (r#"{"terrain": "dry_sadn"}"#, "(the nearest is dry_sand)"),
            (
                r#"{"vehicle": {"mass": 1}}"#,
                "the vehicle has no key `yaw_inertia`",
            ),
            ("{", "not JSON"),
        ] {
            assert!(error(text).contains(expected), "{}", error(text));
        }
    }
}
