//! Vehicles as JSON.

use super::error::JsonError;
use super::object::{self, Key, Object, key};
use crate::vehicle::Vehicle;
use serde_json::Value;

/// The vehicle of the paper (Table II).
const TRAN_2007: &str = include_str!("../../modelDescription/resources/vehicle.json");

const KEYS: &[Key] = &[
    key("mass", "a number [kg]"),
    key("yaw_inertia", "a number [kg m^2]"),
    key("wheel_radius", "a number [m]"),
    key("wheel_width", "a number [m]"),
    key(
        "row_positions",
        "an array of numbers [m ahead of the centroid, front row first]",
    ),
    key("half_track", "a number [m]"),
    key("com_offset", "a number [m ahead of the centroid]"),
    key("com_height", "a number [m]"),
];

impl Vehicle {
    /// The eight-wheeled vehicle of the paper (Table II).
    #[must_use]
    pub fn tran2007() -> Self {
        Self::from_json(TRAN_2007).expect("a test reads the same text")
    }

    /// Reads a vehicle from JSON: an object with the fields of [`Vehicle`] as keys, or one
    /// with such an object under the key `vehicle`.
    ///
    /// # Errors
    /// Text that is not JSON, keys that are missing, unknown or of the wrong type, and
    /// values that [`Vehicle::validate`] refuses.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        Self::from_json_value(&object::parse(text)?)
    }

    /// As [`Vehicle::from_json`], from JSON that is parsed already.
    ///
    /// # Errors
    /// As [`Vehicle::from_json`].
    pub fn from_json_value(value: &Value) -> Result<Self, JsonError> {
        let object = Object::new("vehicle", KEYS, object::unwrap(value, "vehicle")?)?;
        let vehicle = Self {
            mass: object.number("mass")?,
            yaw_inertia: object.number("yaw_inertia")?,
            wheel_radius: object.number("wheel_radius")?,
            wheel_width: object.number("wheel_width")?,
            row_positions: object.numbers("row_positions")?,
            half_track: object.number("half_track")?,
            com_offset: object.number("com_offset")?,
            com_height: object.number("com_height")?,
        };
        vehicle.validate()?;
        Ok(vehicle)
    }

    /// The vehicle as JSON that [`Vehicle::from_json`] reads back to the last bit.
    #[must_use]
    pub fn to_json(&self) -> String {
        object::write(&[
            ("mass", self.mass.into()),
            ("yaw_inertia", self.yaw_inertia.into()),
            ("wheel_radius", self.wheel_radius.into()),
            ("wheel_width", self.wheel_width.into()),
            ("row_positions", self.row_positions.clone().into()),
            ("half_track", self.half_track.into()),
            ("com_offset", self.com_offset.into()),
            ("com_height", self.com_height.into()),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        Vehicle::from_json(text).unwrap_err().to_string()
    }

    fn with(key: &str, value: &str) -> String {
        let mut json: Value = serde_json::from_str(TRAN_2007).unwrap();
        json[key] = serde_json::from_str(value).unwrap();
        json.to_string()
    }

    fn without(key: &str) -> String {
        let mut json: Value = serde_json::from_str(TRAN_2007).unwrap();
        json.as_object_mut().unwrap().remove(key);
        json.to_string()
    }

    #[test]
    fn paper_vehicle_is_table_two() {
        let expected = Vehicle {
            mass: 490.0,
            yaw_inertia: 309.43,
            wheel_radius: 0.25,
            wheel_width: 0.246,
            // (3/2 - E[(i-1)/2]) a with a = 0.61 m.
            row_positions: vec![0.915, 0.305, -0.305, -0.915],
            half_track: 0.61,
            com_offset: 0.17,
            com_height: 0.35,
        };
        assert_eq!(Vehicle::tran2007(), expected);
    }

    #[test]
    fn json_round_trips() {
        let vehicle = Vehicle {
            mass: 470.000_000_000_000_1,
            row_positions: vec![1.0 / 3.0, -0.457],
            com_offset: -1e-7,
            ..Vehicle::tran2007()
        };
        assert_eq!(Vehicle::from_json(&vehicle.to_json()), Ok(vehicle));
        assert_eq!(
            Vehicle::tran2007().to_json().lines().count(),
            KEYS.len() + 2
        );
    }

    #[test]
    fn file_beside_a_recording_holds_a_vehicle() {
        let vehicle = with("assumed", r#"["yaw_inertia"]"#);
        let file =
            format!(r#"{{"vehicle": {vehicle}, "terrain_as_recorded": "grass", "note": ""}}"#);
        assert_eq!(Vehicle::from_json(&file), Ok(Vehicle::tran2007()));
    }

    #[test]
    fn text_that_is_not_json_is_located() {
        let text = "{\n  \"mass\": 490.0\n  \"yaw_inertia\": 1.0\n}";
        assert_eq!(
            error(text),
            "line 3, column 3: not JSON: expected `,` or `}`"
        );
    }

    #[test]
    fn missing_key_is_named_with_its_unit() {
        let expected = "the vehicle has no key `half_track`, expected a number [m]";
        assert_eq!(error(&without("half_track")), expected);
        for key in KEYS {
            assert!(error(&without(key.name)).contains(key.name));
        }
    }

    #[test]
    fn wrong_types_are_described() {
        for (key, value, expected) in [
            (
                "mass",
                "\"490\"",
                "mass: found the text \"490\", expected a number [kg]",
            ),
            (
                "half_track",
                "null",
                "half_track: found null, expected a number [m]",
            ),
            (
                "row_positions",
                "[1.0, true]",
                "row_positions[1]: found the truth value true, expected a number",
            ),
            (
                "row_positions",
                "0.6",
                "row_positions: found the number 0.6, expected an array of numbers \
                 [m ahead of the centroid, front row first]",
            ),
        ] {
            assert_eq!(error(&with(key, value)), expected);
        }
        assert!(
            error("[1]").starts_with("vehicle: found an array of 1 values, expected an object")
        );
    }

    #[test]
    fn unknown_key_is_answered_with_the_nearest() {
        let expected =
            "the vehicle has an unknown key `wheel_radus`; the nearest known one is `wheel_radius`";
        assert_eq!(error(&with("wheel_radus", "1")), expected);
    }

    #[test]
    fn values_out_of_range_are_refused() {
        assert_eq!(
            error(&with("mass", "-3")),
            "mass = -3 kg is outside its range (0, 10000000] kg"
        );
        assert!(error(&with("row_positions", "[0.5]")).starts_with("number of row_positions = 1"));
        assert_eq!(
            error(&with("row_positions", "[-0.9, -0.3]")),
            "row_positions = -0.3 m is outside its range [-50, -0.9) m (rows stand in order from the front to the rear)"
        );
        assert!(error(&with("half_track", "0.01")).contains("0.02] m (at most twice half_track)"));
    }
}
