//! Terrains as JSON.

use super::error::JsonError;
use super::object::{self, Key, Object, key};
use crate::spelling::nearest;
use crate::terrain::Terrain;
use serde_json::Value;

/// The four terrains of the paper (Table I).
const TABLE_I: &str = include_str!("../../modelDescription/resources/terrains.json");

const KEYS: &[Key] = &[
    key("cohesion", "a number [Pa]"),
    key("friction_angle_deg", "a number [deg]"),
    key("cohesive_modulus", "a number [N/m^(n+1)]"),
    key("frictional_modulus", "a number [N/m^(n+2)]"),
    key("sinkage_exponent", "a number"),
    key("shear_modulus", "a number [m]"),
];

impl Terrain {
    /// Names of the paper's terrains (Table I), in its order.
    pub const PRESETS: [&str; 4] = ["dry_sand", "sandy_loam", "clayed_soil", "dry_clay"];

    /// One of the paper's terrains (Table I) by its name.
    #[must_use]
    pub fn preset(name: &str) -> Option<Self> {
        let index = Self::PRESETS.iter().position(|preset| *preset == name)?;
        let terrains = Self::presets_from_json(TABLE_I).expect("a test reads the same text");
        Some(terrains[index])
    }

    /// Reads the terrains named in [`Terrain::PRESETS`], in their order, from a JSON object
    /// that holds each of them under its name.
    ///
    /// # Errors
    /// Text that is not JSON, a terrain that is missing, and what [`Terrain::from_json`] refuses.
    pub fn presets_from_json(text: &str) -> Result<[Self; 4], JsonError> {
        let json = object::parse(text)?;
        let mut terrains = Vec::with_capacity(Self::PRESETS.len());
        for key in Self::PRESETS {
            let value = json.get(key).ok_or_else(|| JsonError::MissingKey {
                what: "set of terrains",
                key,
                expected: "a terrain".into(),
            })?;
            let terrain = Self::from_json_value(value).map_err(|source| JsonError::InTerrain {
                name: key.into(),
                source: source.into(),
            })?;
            terrains.push(terrain);
        }
        Ok(std::array::from_fn(|index| terrains[index]))
    }

    /// Reads a terrain from JSON: an object with the keys `cohesion`, `friction_angle_deg`,
    /// `cohesive_modulus`, `frictional_modulus`, `sinkage_exponent` and `shear_modulus`, or the
    /// name of a preset; or an object with one of these under the key `terrain`.
    ///
    /// # Errors
    /// Text that is not JSON, keys that are missing, unknown or of the wrong type, names of no
    /// preset, and values that [`Terrain::validate`] refuses.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        Self::from_json_value(&object::parse(text)?)
    }

    /// As [`Terrain::from_json`], from JSON that is parsed already.
    ///
    /// # Errors
    /// As [`Terrain::from_json`].
    pub fn from_json_value(value: &Value) -> Result<Self, JsonError> {
        let value = object::unwrap(value, "terrain")?;
        if let Value::String(name) = value {
            return Self::preset(name).ok_or_else(|| {
                let presets = Self::PRESETS;
                let meant = nearest(name, presets).unwrap_or_default();
                let names = presets.join(", ");
                let expected = format!("an object or one of {names} (the nearest is {meant})");
                JsonError::wrong_type("terrain", value, expected)
            });
        }
        refuse_several(value)?;
        let object = Object::new("terrain", KEYS, value)?;
        let friction_angle_deg = object.number("friction_angle_deg")?;
        let terrain = Self {
            cohesion: object.number("cohesion")?,
            friction_angle: friction_angle_deg.to_radians(),
            cohesive_modulus: object.number("cohesive_modulus")?,
            frictional_modulus: object.number("frictional_modulus")?,
            sinkage_exponent: object.number("sinkage_exponent")?,
            shear_modulus: object.number("shear_modulus")?,
        };
        terrain.validate()?;
        Ok(terrain)
    }

    /// Angle of internal friction phi \[deg\], which gives the same radians again.
    #[must_use]
    pub fn friction_angle_degrees(&self) -> f64 {
        degrees(self.friction_angle)
    }

    /// The terrain as JSON that [`Terrain::from_json`] reads back; the friction angle to the
    /// last bit where degrees have that resolution.
    #[must_use]
    pub fn to_json(&self) -> String {
        object::write(&[
            ("cohesion", self.cohesion.into()),
            ("friction_angle_deg", self.friction_angle_degrees().into()),
            ("cohesive_modulus", self.cohesive_modulus.into()),
            ("frictional_modulus", self.frictional_modulus.into()),
            ("sinkage_exponent", self.sinkage_exponent.into()),
            ("shear_modulus", self.shear_modulus.into()),
        ])
    }
}

/// For a set of terrains the message would otherwise be that its first name is an unknown key.
fn refuse_several(value: &Value) -> Result<(), JsonError> {
    match value.as_object() {
        Some(map) if !map.is_empty() && map.values().all(Value::is_object) => {
            Err(JsonError::SeveralTerrains {
                names: map.keys().cloned().collect(),
            })
        }
        _ => Ok(()),
    }
}

/// Degrees that give the same radians again; of the candidates the one with fewer digits,
/// so that 29 does not come back as 28.999999999999996.
fn degrees(radians: f64) -> f64 {
    let exact = radians.to_degrees();
    let short = (exact * 1e9).round() / 1e9;
    [short, exact, exact.next_up(), exact.next_down()]
        .into_iter()
        .find(|candidate| candidate.to_radians() == radians)
        .unwrap_or(exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        Terrain::from_json(text).unwrap_err().to_string()
    }

    fn with(key: &str, value: &str) -> String {
        let mut json: Value = serde_json::from_str(TABLE_I).unwrap();
        json["dry_sand"][key] = serde_json::from_str(value).unwrap();
        json["dry_sand"].to_string()
    }

    #[test]
    fn presets_are_table_one() {
        // c kPa, phi deg, k_c kN/m^(n+1), k_phi kN/m^(n+2), n, K m.
        let table = [
            ("dry_sand", [1.04, 28.0, 0.99, 1528.43, 1.1, 0.01]),
            ("sandy_loam", [1.72, 29.0, 5.27, 1515.04, 0.7, 0.025]),
            ("clayed_soil", [4.14, 13.0, 13.19, 692.15, 0.5, 0.006]),
            ("dry_clay", [68.95, 34.0, 12.70, 1555.95, 0.13, 0.006]),
        ];
        assert_eq!(table.map(|row| row.0), Terrain::PRESETS);
        for (name, [c, phi, k_c, k_phi, n, shear]) in table {
            let terrain = Terrain::preset(name).unwrap();
            // A thousand times a decimal number may be off in the last bit.
            let close = |value: f64, kilo: f64| (value - 1e3 * kilo).abs() <= 1e-15 * value;
            assert!(close(terrain.cohesion, c), "{name}");
            assert!(close(terrain.cohesive_modulus, k_c), "{name}");
            assert!(close(terrain.frictional_modulus, k_phi), "{name}");
            assert_eq!(terrain.friction_angle, phi.to_radians());
            assert_eq!(
                (terrain.sinkage_exponent, terrain.shear_modulus),
                (n, shear)
            );
        }
        assert_eq!(Terrain::preset("moon"), None);
    }

    #[test]
    fn json_round_trips() {
        for name in Terrain::PRESETS {
            let terrain = Terrain::preset(name).unwrap();
            assert_eq!(Terrain::from_json(&terrain.to_json()), Ok(terrain));
        }
        let json = Terrain::preset("sandy_loam").unwrap().to_json();
        assert!(json.contains("\"friction_angle_deg\": 29.0,"), "{json}");
    }

    #[test]
    fn file_may_hold_the_terrain_under_its_key() {
        let file = format!(
            r#"{{"terrain": {}, "source": "plate test"}}"#,
            with("cohesion", "1040")
        );
        assert_eq!(Terrain::from_json(&file).ok(), Terrain::preset("dry_sand"));
        let file = r#"{"terrain": "dry_sand", "source": "a guess"}"#;
        assert_eq!(Terrain::from_json(file).ok(), Terrain::preset("dry_sand"));
    }

    #[test]
    fn wrong_keys_and_values_are_named() {
        for (text, expected) in [
            (
                with("friction_angle", "0.5"),
                "the terrain has an unknown key `friction_angle`; the nearest known one is `friction_angle_deg`",
            ),
            (
                with("friction_angle_deg", "90"),
                "friction_angle_deg = 90 deg is outside its range [0, 60] deg",
            ),
            (
                with("cohesion", "{}"),
                "cohesion: found an object, expected a number [Pa]",
            ),
            (
                "{}".into(),
                "the terrain has no key `friction_angle_deg`, expected a number [deg]",
            ),
            (
                TABLE_I.into(),
                "found several terrains (clayed_soil, dry_clay, dry_sand, sandy_loam), expected one",
            ),
        ] {
            assert_eq!(error(&text), expected);
        }
    }

    #[test]
    fn set_of_terrains_names_the_one_that_is_wrong() {
        let text = TABLE_I.replacen("0.025", "-1", 1);
        let error = Terrain::presets_from_json(&text).unwrap_err().to_string();
        assert_eq!(
            error,
            "sandy_loam: shear_modulus = -1 m is outside its range (0, 1] m"
        );
        let error = Terrain::presets_from_json("{}").unwrap_err().to_string();
        assert_eq!(
            error,
            "the set of terrains has no key `dry_sand`, expected a terrain"
        );
    }
}
