//! The files of an FMU's `resources` folder, and the identity that follows from them.

use super::configuration::{CUSTOM, Configuration, TERRAINS};
use super::effects;
use crate::effects::Effects;
use crate::json::{JsonError, parsed};
use crate::terrain::Terrain;
use crate::vehicle::Vehicle;
use serde_json::{Value, json};
use std::fmt;
use uuid::Uuid;

/// The identity of the library: the declaration as it is written, and the version. Every library of this version
/// contains it, and no other.
pub const MARK: &str = concat!(
    include_str!("table.rs"),
    " ",
    env!("CARGO_PKG_VERSION"),
    "\n"
);

/// Why the files of a folder give no configuration.
#[derive(Debug)]
pub enum ConfigurationError {
    /// A file that cannot be read.
    Io(&'static str, std::io::Error),
    /// A file with invalid content.
    Json(&'static str, JsonError),
    /// A file that selects no terrain.
    Selection(&'static str),
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(file, error) => write!(f, "resources/{file} cannot be read: {error}"),
            Self::Json(file, error) => write!(f, "resources/{file}: {error}"),
            Self::Selection(file) => write!(
                f,
                "resources/{file}: \"selected\" must be one of {}",
                TERRAINS.map(|(name, _)| name).join(", ")
            ),
        }
    }
}

impl std::error::Error for ConfigurationError {}

const VEHICLE_FILE: &str = "vehicle.json";
const TERRAINS_FILE: &str = "terrains.json";
const SELECTION_FILE: &str = "terrain.json";
const EFFECTS_FILE: &str = "effects.json";

impl Configuration {
    /// Reads the files of a `resources` folder through `read`, which returns `None` for a
    /// missing file. The built-in vehicle, terrains and effects replace missing files.
    ///
    /// # Errors
    /// A file that cannot be read or has invalid content.
    pub fn from_resources(
        read: impl Fn(&str) -> std::io::Result<Option<String>>,
    ) -> Result<Self, ConfigurationError> {
        let read = |file: &'static str| read(file).map_err(|e| ConfigurationError::Io(file, e));
        let mut configuration = Self::default();
        if let Some(text) = read(VEHICLE_FILE)? {
            configuration.vehicle = Vehicle::from_json(&text)
                .map_err(|error| ConfigurationError::Json(VEHICLE_FILE, error))?;
        }
        if let Some(text) = read(TERRAINS_FILE)? {
            let presets = Terrain::presets_from_json(&text)
                .map_err(|error| ConfigurationError::Json(TERRAINS_FILE, error))?;
            configuration = Self::new(configuration.vehicle, presets);
        }
        if let Some(text) = read(SELECTION_FILE)? {
            configuration.read_selection(&text)?;
        }
        if let Some(text) = read(EFFECTS_FILE)? {
            configuration.effects = Effects::from_json(&text)
                .map_err(|error| ConfigurationError::Json(EFFECTS_FILE, error))?;
        }
        Ok(configuration)
    }

    fn read_selection(&mut self, text: &str) -> Result<(), ConfigurationError> {
        let wrong = ConfigurationError::Selection(SELECTION_FILE);
        let Ok(value) = serde_json::from_str::<Value>(text) else {
            return Err(wrong);
        };
        let custom = value
            .get("custom")
            .map(Terrain::from_json_value)
            .transpose();
        let custom = custom.map_err(|e| ConfigurationError::Json(SELECTION_FILE, e))?;
        if let Some(custom) = custom {
            self.terrains[CUSTOM] = custom;
        }
        match value["selected"].as_str() {
            Some(name) if self.select(name) => Ok(()),
            _ => Err(wrong),
        }
    }

    /// The files that [`Configuration::from_resources`] reads back.
    #[must_use]
    pub fn to_resources(&self) -> [(&'static str, String); 4] {
        let mut presets = serde_json::Map::new();
        for ((name, _), terrain) in TERRAINS.iter().zip(&self.terrains[..CUSTOM]) {
            presets.insert((*name).to_owned(), parsed(&terrain.to_json()));
        }
        let selection = json!({
            "selected": TERRAINS[self.selected].0,
            "custom": parsed(&self.terrains[CUSTOM].to_json()),
        });
        let pretty = |value: &Value| format!("{value:#}\n");
        [
            (VEHICLE_FILE, self.vehicle.to_json()),
            (TERRAINS_FILE, pretty(&Value::Object(presets))),
            (SELECTION_FILE, pretty(&selection)),
            (EFFECTS_FILE, self.effects.to_json()),
        ]
    }
}

/// The FMU's identity, derived from the declaration of its variables and all their start values.
/// A model description and a library fit together if they have the same identity.
#[must_use]
pub fn guid(configuration: &Configuration) -> String {
    let mut content = MARK.to_owned();
    for variable in effects::variables(configuration) {
        content += &format!("{variable:?}\n");
    }
    for (name, text) in configuration.to_resources() {
        content += &format!("{name}\n{text}\n");
    }
    Uuid::new_v5(&Uuid::NAMESPACE_OID, content.as_bytes()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn custom() -> Configuration {
        let mut configuration = Configuration::default();
        configuration.vehicle.row_positions = vec![0.5, -0.5];
        configuration.select_custom(Terrain {
            cohesion: 321.0,
            ..configuration.terrains[0]
        });
        let effects = r#"{"grade": {"profile": {"over": "time", "points": [[0, 0.1, 0]]}},
            "window": {"effects": ["grade"], "place": {"x": 1, "y": 0, "radius": 2.5}}}"#;
        configuration.effects = Effects::from_json(effects).unwrap();
        configuration
    }

    #[test]
    fn resources_are_read_back() {
        for configuration in [Configuration::default(), custom()] {
            let files = configuration.to_resources();
            let read = |name: &str| {
                Ok(files
                    .iter()
                    .find(|(file, _)| *file == name)
                    .map(|(_, text)| text.clone()))
            };
            assert_eq!(Configuration::from_resources(read).unwrap(), configuration);
        }
    }

    #[test]
    fn without_files_the_defaults_serve() {
        let read = Configuration::from_resources(|_| Ok(None)).unwrap();
        assert_eq!(read, Configuration::default());
    }

    #[test]
    fn a_wrong_selection_is_refused() {
        let read =
            |name: &str| Ok((name == SELECTION_FILE).then(|| "{\"selected\": \"mud\"}".into()));
        let error = Configuration::from_resources(read).unwrap_err().to_string();
        assert!(
            error.contains("terrain.json") && error.contains("dry_sand"),
            "{error}"
        );
    }

    #[test]
    fn the_guid_follows_the_content() {
        let (default, custom) = (guid(&Configuration::default()), guid(&custom()));
        assert_ne!(default, custom);
        assert_eq!(default.len(), 36);
        assert!(!default.contains(['{', '}']));
    }
}
