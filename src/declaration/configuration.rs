//! What an FMU is made for: a vehicle, the terrains to choose from, and the one to begin with.

use super::Quantity;
use crate::json::JsonError;
use crate::terrain::Terrain;
use crate::vehicle::Vehicle;
use serde_json::{Value, json};
use std::fmt;
use uuid::Uuid;

/// Names of the terrains in the order of their numbers, from 1.
pub const TERRAIN_NAMES: [&str; 5] = [
    "dry_sand",
    "sandy_loam",
    "clayed_soil",
    "dry_clay",
    "custom",
];

const CLAYED_SOIL: usize = 2;
/// Position of the custom soil in [`TERRAIN_NAMES`].
const CUSTOM: usize = 4;
/// The one parameter that is not kept in the unit that it is set in.
const FRICTION_ANGLE: Quantity = Quantity::Soil(1);

/// The vehicle and terrains that an FMU starts with; they travel in its `resources/`.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The terrains by number, the custom one last.
    pub terrains: [Terrain; 5],
    /// Which of them is chosen, from 0.
    pub selected: usize,
}

/// Why a folder describes no configuration.
#[derive(Debug)]
pub enum ConfigurationError {
    /// A file that is there but cannot be read.
    Io(&'static str, std::io::Error),
    /// A file that says something else than it should.
    Json(&'static str, JsonError),
    /// A file without the name of a terrain.
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
                TERRAIN_NAMES.join(", ")
            ),
        }
    }
}

impl std::error::Error for ConfigurationError {}

const VEHICLE_FILE: &str = "vehicle.json";
const TERRAINS_FILE: &str = "terrains.json";
const SELECTION_FILE: &str = "terrain.json";

impl Default for Configuration {
    /// The paper's vehicle and terrains, on clayed soil.
    fn default() -> Self {
        let presets = Terrain::PRESETS
            .map(|name| Terrain::preset(name).expect("the presets are in the crate, and tested"));
        Self::new(Vehicle::tran2007(), presets)
    }
}

impl Configuration {
    fn new(vehicle: Vehicle, presets: [Terrain; 4]) -> Self {
        let [sand, loam, clayed, clay] = presets;
        Self {
            vehicle,
            terrains: [sand, loam, clayed, clay, clayed],
            selected: CLAYED_SOIL,
        }
    }

    /// Chooses one of the terrains by name; whether there is one.
    pub fn select(&mut self, name: &str) -> bool {
        match TERRAIN_NAMES.iter().position(|known| *known == name) {
            Some(index) => self.selected = index,
            None => return false,
        }
        true
    }

    /// Chooses a soil of one's own.
    pub fn select_custom(&mut self, terrain: Terrain) {
        self.terrains[CUSTOM] = terrain;
        self.selected = CUSTOM;
    }

    /// The terrain that is chosen.
    #[must_use]
    pub fn terrain(&self) -> &Terrain {
        &self.terrains[self.selected]
    }

    /// The value of a parameter of the vehicle or the custom soil (the friction angle in
    /// degrees); `None` for any other quantity.
    #[must_use]
    pub fn parameter(&self, quantity: Quantity) -> Option<f64> {
        if quantity == FRICTION_ANGLE {
            return Some(self.terrains[CUSTOM].friction_angle_degrees());
        }
        self.clone().slot(quantity).map(|slot| *slot)
    }

    /// Sets such a parameter; whether there is one.
    pub fn set_parameter(&mut self, quantity: Quantity, value: f64) -> bool {
        let value = if quantity == FRICTION_ANGLE {
            value.to_radians()
        } else {
            value
        };
        self.slot(quantity).map(|slot| *slot = value).is_some()
    }

    /// Visits every number that can be set.
    #[cfg(feature = "fmu")]
    pub(crate) fn visit(&mut self, visit: &mut impl FnMut(&mut f64)) {
        let mut selected = self.selected as f64;
        visit(&mut selected);
        self.selected = (selected as usize).min(CUSTOM);
        let rows = self.vehicle.row_positions.len();
        let vehicle = (0..7).map(Quantity::Vehicle);
        let all = (0..6)
            .map(Quantity::Soil)
            .chain(vehicle)
            .chain((0..rows).map(Quantity::Row));
        for quantity in all {
            if let Some(slot) = self.slot(quantity) {
                visit(slot);
            }
        }
    }

    /// Where a parameter is kept, in SI units and radians.
    fn slot(&mut self, quantity: Quantity) -> Option<&mut f64> {
        let Self {
            vehicle, terrains, ..
        } = self;
        let soil = &mut terrains[CUSTOM];
        Some(match quantity {
            Quantity::Soil(0) => &mut soil.cohesion,
            Quantity::Soil(1) => &mut soil.friction_angle,
            Quantity::Soil(2) => &mut soil.cohesive_modulus,
            Quantity::Soil(3) => &mut soil.frictional_modulus,
            Quantity::Soil(4) => &mut soil.sinkage_exponent,
            Quantity::Soil(5) => &mut soil.shear_modulus,
            Quantity::Vehicle(0) => &mut vehicle.mass,
            Quantity::Vehicle(1) => &mut vehicle.yaw_inertia,
            Quantity::Vehicle(2) => &mut vehicle.wheel_radius,
            Quantity::Vehicle(3) => &mut vehicle.wheel_width,
            Quantity::Vehicle(4) => &mut vehicle.half_track,
            Quantity::Vehicle(5) => &mut vehicle.com_offset,
            Quantity::Vehicle(6) => &mut vehicle.com_height,
            Quantity::Row(index) => vehicle.row_positions.get_mut(index)?,
            _ => return None,
        })
    }

    /// Reads the files of a `resources` folder through `read`, which answers `None` for a
    /// file that is not there; then the built-in one serves.
    ///
    /// # Errors
    /// A file that cannot be read or says something else than it should.
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
    pub fn to_resources(&self) -> [(&'static str, String); 3] {
        let parsed = |text: String| -> Value {
            serde_json::from_str(&text).expect("what the crate writes is JSON")
        };
        let mut presets = serde_json::Map::new();
        for (name, terrain) in TERRAIN_NAMES.iter().zip(&self.terrains[..CUSTOM]) {
            presets.insert((*name).to_owned(), parsed(terrain.to_json()));
        }
        let selection = json!({
            "selected": TERRAIN_NAMES[self.selected],
            "custom": parsed(self.terrains[CUSTOM].to_json()),
        });
        let pretty = |value: &Value| format!("{value:#}\n");
        [
            (VEHICLE_FILE, self.vehicle.to_json()),
            (TERRAINS_FILE, pretty(&Value::Object(presets))),
            (SELECTION_FILE, pretty(&selection)),
        ]
    }
}

/// The FMU's identity, derived from the declaration of its variables and from all the values
/// that they start with: a model description and a library belong together if they agree.
#[must_use]
pub fn guid(configuration: &Configuration) -> String {
    let mut content = format!("{} {}\n", super::SOURCE, env!("CARGO_PKG_VERSION"));
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
    fn parameters_are_read_back_as_they_were_set() {
        let mut configuration = Configuration::default();
        for quantity in [
            Quantity::Soil(1),
            Quantity::Soil(4),
            Quantity::Vehicle(6),
            Quantity::Row(3),
        ] {
            assert!(configuration.set_parameter(quantity, 29.3));
            assert_eq!(configuration.parameter(quantity), Some(29.3));
        }
        assert!(!configuration.set_parameter(Quantity::Row(4), 1.0));
        assert_eq!(configuration.parameter(Quantity::Input(0)), None);
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
