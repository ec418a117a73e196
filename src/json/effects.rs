//! Effects as JSON: an object with a key for each effect that is on.

use super::JsonError;
use super::object;
use super::window::{self, WINDOW};
use crate::effects::{
    Boundary, CATALOGUE, Declaration, Effects, Grid, ParameterName, Points, SlopeProfile,
};
use crate::spelling::nearest;
use serde_json::{Map, Value, json};

/// What marks a file of effects.
pub const EFFECTS_FORMAT: &str = "ugv-effects/1";

/// Keys beside the parameters.
const PROFILE: &str = "profile";
const OVER: &str = "over";
const FORMAT: &str = "format";

const BOUNDARIES: [(&str, Boundary); 3] = [
    ("time", Boundary::Time),
    ("distance", Boundary::Distance),
    ("place", Boundary::Place),
];

impl Effects {
    /// Reads effects from JSON: an object whose keys are names of effects, each holding an object
    /// with parameters (what is missing has its default); `grade` may hold a `profile`, and
    /// `terrain_change` tells by `over` what its boundary is measured over; beside the effects a
    /// `window` may tell when or where some of them act.
    ///
    /// # Errors
    /// Text that is not JSON, unknown effects or parameters, and values out of range.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        Self::from_json_value(&object::parse(text)?)
    }

    /// As [`Effects::from_json`], from JSON that is parsed already; of a model, its effects.
    ///
    /// # Errors
    /// As [`Effects::from_json`].
    pub fn from_json_value(value: &Value) -> Result<Self, JsonError> {
        let value = object::unwrap(value, "effects")?;
        let map = as_object(
            value,
            "effects",
            "an object with a key for each effect that is on",
        )?;
        let mut effects = Self::NONE;
        for (key, value) in map {
            if key == FORMAT {
                check_format(value, EFFECTS_FORMAT)?;
                continue;
            }
            if key == WINDOW {
                continue;
            }
            let known = || CATALOGUE.iter().map(|effect| effect.name).chain([WINDOW]);
            let Some(effect) = CATALOGUE.iter().find(|effect| effect.name == key) else {
                return Err(unknown("set of effects", key, known()));
            };
            effects.read_effect(effect, value)?;
        }
        if let Some(value) = map.get(WINDOW) {
            effects.window = Some(window::read(value, &effects)?);
        }
        Ok(effects)
    }

    fn read_effect(
        &mut self,
        effect: &'static Declaration,
        value: &Value,
    ) -> Result<(), JsonError> {
        let map = as_object(value, effect.name, "an object with the effect's parameters")?;
        let extra: &[&'static str] = match effect.name {
            "grade" => &[PROFILE],
            "terrain_change" => &[OVER],
            _ => &[],
        };
        for (key, value) in map {
            let place = format!("{}.{key}", effect.name);
            match ParameterName::find(&place) {
                Some(parameter) => {
                    let expected = || format!("a number [{}]", parameter.declaration().1.unit);
                    let number = value
                        .as_f64()
                        .ok_or_else(|| JsonError::wrong_type(&place, value, expected()))?;
                    self.set(parameter, number)?;
                }
                None if key == PROFILE && extra.contains(&PROFILE) => {
                    self.slope_profile = Some(read_profile(&place, value)?);
                }
                None if key == OVER && extra.contains(&OVER) => {
                    self.boundary = read_over(&place, value)?;
                }
                None => {
                    let known = effect.parameters.iter().map(|p| p.name);
                    return Err(unknown(
                        effect.name,
                        key,
                        known.chain(extra.iter().copied()),
                    ));
                }
            }
        }
        Ok(())
    }

    /// A file of effects, as [`Effects::from_json`] reads it.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut value = self.to_json_value();
        value[FORMAT] = EFFECTS_FORMAT.into();
        format!("{value:#}\n")
    }

    /// The effects that are on, or whose shape is another than where nothing is said, as JSON that
    /// [`Effects::from_json_value`] reads back to the last bit.
    #[must_use]
    pub fn to_json_value(&self) -> Value {
        let mut map = Map::new();
        for (index, effect) in CATALOGUE.iter().enumerate() {
            let places = 0..effect.parameters.len();
            let own: Vec<_> = places
                .filter_map(|place| ParameterName::at(index, place))
                .collect();
            let shaped = own
                .iter()
                .any(|p| self.get(*p) != p.declaration().1.default);
            let bounded = effect.name == "terrain_change" && self.boundary != Boundary::default();
            if !(self.is_on(index) || shaped || bounded) {
                continue;
            }
            let mut parameters = Map::new();
            for parameter in own {
                let name = parameter.declaration().1.name;
                parameters.insert(name.into(), self.get(parameter).into());
            }
            if effect.name == "grade"
                && let Some(profile) = &self.slope_profile
            {
                parameters.insert(PROFILE.into(), write_profile(profile));
            }
            if effect.name == "terrain_change" {
                let named = BOUNDARIES.iter().find(|(_, b)| *b == self.boundary);
                let name = named.map_or("place", |(name, _)| name);
                parameters.insert(OVER.into(), name.into());
            }
            map.insert(effect.name.into(), parameters.into());
        }
        map.extend(window::write(self).map(|window| (WINDOW.into(), window)));
        map.into()
    }
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

pub(super) fn unknown(
    what: &'static str,
    key: &str,
    known: impl Iterator<Item = &'static str>,
) -> JsonError {
    JsonError::UnknownKey {
        what,
        key: key.into(),
        nearest: nearest(key, known).unwrap_or_default(),
    }
}

fn read_over(place: &str, value: &Value) -> Result<Boundary, JsonError> {
    let known = BOUNDARIES.iter().find(|(name, _)| value == *name);
    known.map(|(_, boundary)| *boundary).ok_or_else(|| {
        JsonError::wrong_type(place, value, "\"time\", \"distance\" or \"place\"".into())
    })
}

fn read_profile(place: &str, value: &Value) -> Result<SlopeProfile, JsonError> {
    let shape = "{\"over\": \"time\" or \"distance\", \"points\": [[at, slope_east, slope_north], ...]} \
                 or {\"over\": \"place\", \"x\": [...], \"y\": [...], \"slopes\": \
                 [[[slope_east, slope_north] for each y] for each x]}";
    let wrong = || JsonError::wrong_type(place, value, shape.into());
    let numbers = |value: &Value| -> Option<Vec<f64>> {
        value.as_array()?.iter().map(Value::as_f64).collect()
    };
    let profile = match read_over(&format!("{place}.{OVER}"), &value[OVER])? {
        Boundary::Place => {
            let x = numbers(&value["x"]).ok_or_else(wrong)?;
            let y = numbers(&value["y"]).ok_or_else(wrong)?;
            let mut slopes = Vec::new();
            for (index, row) in (value["slopes"].as_array().ok_or_else(wrong)?)
                .iter()
                .enumerate()
            {
                let pairs = row.as_array().ok_or_else(wrong)?;
                // Rows of other lengths could still have as many slopes in all as the grid has corners.
                if pairs.len() != y.len() {
                    let place = format!("{place}.slopes[{index}]");
                    let expected = format!(
                        "{} pairs [slope_east, slope_north], one for each y",
                        y.len()
                    );
                    return Err(JsonError::wrong_type(place, row, expected));
                }
                for pair in pairs {
                    let pair = numbers(pair).ok_or_else(wrong)?;
                    slopes.push(<[f64; 2]>::try_from(pair).map_err(|_| wrong())?);
                }
            }
            Grid::new(x, y, slopes).map(SlopeProfile::Place)
        }
        over => {
            let (mut at, mut slopes) = (Vec::new(), Vec::new());
            for point in value["points"].as_array().ok_or_else(wrong)? {
                let point = numbers(point).ok_or_else(wrong)?;
                let [place, east, north] = <[f64; 3]>::try_from(point).map_err(|_| wrong())?;
                at.push(place);
                slopes.push([east, north]);
            }
            let kind = match over {
                Boundary::Time => SlopeProfile::Time,
                _ => SlopeProfile::Distance,
            };
            Points::new(at, slopes).map(kind)
        }
    };
    profile.map_err(|source| JsonError::Profile {
        place: place.into(),
        source,
    })
}

fn write_profile(profile: &SlopeProfile) -> Value {
    let points = |over: &str, points: &Points| {
        let points: Vec<_> = points
            .iter()
            .map(|(at, [e, n])| json!([at, e, n]))
            .collect();
        json!({ "over": over, "points": points })
    };
    match profile {
        SlopeProfile::Time(along) => points("time", along),
        SlopeProfile::Distance(along) => points("distance", along),
        SlopeProfile::Place(grid) => {
            let (x, y, slopes) = grid.parts();
            let rows: Vec<_> = slopes.chunks(y.len()).collect();
            json!({ "over": "place", "x": x, "y": y, "slopes": rows })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        Effects::from_json(text).unwrap_err().to_string()
    }

    #[test]
    fn effects_are_read_back_to_the_last_bit() {
        for profile in [
            r#"{"over": "time", "points": [[0.0, 0.1, 0.0], [2.5, -0.1, 0.05]]}"#,
            r#"{"over": "distance", "points": [[0, 0.1, 0]]}"#,
            r#"{"over": "place", "x": [0, 1], "y": [0, 2, 3], "slopes":
                [[[0, 0], [0.1, 0], [0, 0.2]], [[0, 0], [0, 0], [0.3, -0.3]]]}"#,
        ] {
            let text = format!(
                r#"{{"format": "ugv-effects/1", "grade": {{"slope_east": 0.1, "profile": {profile}}},
                    "terrain_change": {{"cohesion_factor": 0.3, "over": "distance", "position": 7}},
                    "drag": {{"coefficient": 0.3333333333333333}}}}"#
            );
            let effects = Effects::from_json(&text).unwrap();
            assert_eq!(
                Effects::from_json_value(&effects.to_json_value()),
                Ok(effects)
            );
        }
        assert_eq!(Effects::from_json("{}"), Ok(Effects::NONE));
        assert_eq!(Effects::NONE.to_json_value(), json!({}));
        assert_eq!(
            Effects::from_json(&Effects::NONE.to_json()),
            Ok(Effects::NONE)
        );
        // What only shapes an effect is kept while it is off.
        let mut shaped = Effects::NONE.with("drawbar.hitch_height", 0.9).unwrap();
        shaped.boundary = Boundary::Time;
        assert_eq!(Effects::from_json(&shaped.to_json()), Ok(shaped));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, expected) in [
            (
                r#"{"grad": {}}"#,
                "the set of effects has an unknown key `grad`; the nearest known one is `grade`",
            ),
            (
                r#"{"drag": {"coeficient": 1}}"#,
                "the drag has an unknown key `coeficient`; the nearest known one is `coefficient`",
            ),
            (
                r#"{"drag": {"coefficient": "1"}}"#,
                "drag.coefficient: found the text \"1\", expected a number [N s^2/m^2]",
            ),
            (
                r#"{"drag": {"coefficient": -1}}"#,
                "drag.coefficient = -1 N s^2/m^2 is outside its range [0, 200] N s^2/m^2",
            ),
            (
                r#"{"drag": 3}"#,
                "drag: found the number 3, expected an object with the effect's parameters",
            ),
            (
                r#"{"format": "ugv-effects/2"}"#,
                "format: found the text \"ugv-effects/2\", expected \"ugv-effects/1\"",
            ),
            (
                r#"{"terrain_change": {"over": "mood"}}"#,
                "terrain_change.over: found the text \"mood\", expected \"time\", \"distance\" or \"place\"",
            ),
            (
                r#"{"grade": {"profile": {"over": "time", "points": [[1, 0.1, 0], [1, 0, 0]]}}}"#,
                "grade.profile: the profile's points must increase, but not so at 1",
            ),
            (
                r#"{"grade": {"profile": {"over": "place", "x": [0, 1], "y": [0, 1], "slopes":
                    [[[0, 0]], [[0, 0], [0, 0], [0, 0]]]}}}"#,
                "grade.profile.slopes[0]: found an array of 1 values, expected 2 pairs [slope_east, slope_north], one for each y",
            ),
            (
                r#"{"grade": {"profile": {"over": "place", "x": [0, 1], "y": [0], "slopes":
                    [[[0, 0]]]}}}"#,
                "grade.profile: found 1 slopes for the 2 corners of the grid",
            ),
        ] {
            assert_eq!(error(text), expected);
        }
        assert!(error(r#"{"grade": {"profile": {"over": "time"}}}"#).contains("[[at, slope_east"));
    }
}
