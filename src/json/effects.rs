//! Effects as JSON: an object with a key for each effect that is on.

use super::error::JsonError;
use super::object::{self, EFFECTS_FORMAT, FORMAT, as_object, check_format, check_keys};
use super::window::{self, WINDOW};
use crate::effects::{
    Boundary, CATALOGUE, Declaration, Effects, Grid, ParameterName, Points, SlopeProfile,
};
use serde_json::{Map, Value, json};

/// Keys beside the parameters.
const PROFILE: &str = "profile";
const OVER: &str = "over";

const BOUNDARIES: [(&str, Boundary); 3] = [
    ("time", Boundary::Time),
    ("distance", Boundary::Distance),
    ("place", Boundary::Place),
];

impl Effects {
    /// Reads effects from JSON: an object whose keys are names of effects, with objects of parameters
    /// as values. Missing parameters have their defaults. `grade` may have a `profile`;
    /// `terrain_change` may have `over`, the quantity over which its boundary is measured. The
    /// key `window` limits the time or place where some of the effects act.
    ///
    /// # Errors
    /// Text that is not JSON, unknown effects or parameters, and values out of range.
    pub fn from_json(text: &str) -> Result<Self, JsonError> {
        Self::from_json_value(&object::parse(text)?)
    }

    /// As [`Effects::from_json`], from parsed JSON. From a model it reads the effects.
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
        let names = CATALOGUE.iter().map(|effect| effect.name);
        check_keys("set of effects", map.keys(), names.chain([WINDOW, FORMAT]))?;
        if let Some(value) = map.get(FORMAT) {
            check_format(value, EFFECTS_FORMAT)?;
        }
        let mut effects = Self::NONE;
        for (index, effect) in CATALOGUE.iter().enumerate() {
            if let Some(value) = map.get(effect.name) {
                effects.read_effect(index, effect, value)?;
            }
        }
        if let Some(value) = map.get(WINDOW) {
            effects.window = Some(window::read(value, &effects)?);
        }
        Ok(effects)
    }

    fn read_effect(
        &mut self,
        index: usize,
        effect: &'static Declaration,
        value: &Value,
    ) -> Result<(), JsonError> {
        let map = as_object(value, effect.name, "an object with the effect's parameters")?;
        let extra = match effect.name {
            "grade" => Some(PROFILE),
            "terrain_change" => Some(OVER),
            _ => None,
        };
        let names = effect.parameters.iter().map(|parameter| parameter.name);
        check_keys(effect.name, map.keys(), names.chain(extra))?;
        let place = |key: &str| format!("{}.{key}", effect.name);
        for parameter in parameters(index) {
            let declared = parameter.declaration().1;
            if let Some(value) = map.get(declared.name) {
                let number = value.as_f64().ok_or_else(|| {
                    let expected = format!("a number [{}]", declared.unit);
                    JsonError::wrong_type(place(declared.name), value, expected)
                })?;
                self.set(parameter, number)?;
            }
        }
        if let Some(value) = map.get(PROFILE) {
            self.slope_profile = Some(read_profile(&place(PROFILE), value)?);
        }
        if let Some(value) = map.get(OVER) {
            self.boundary = read_over(&place(OVER), value)?;
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

    /// The effects that are on or have parameters other than the defaults, as JSON that
    /// [`Effects::from_json_value`] reads back to the last bit.
    #[must_use]
    pub fn to_json_value(&self) -> Value {
        let mut map = Map::new();
        for (index, effect) in CATALOGUE.iter().enumerate() {
            let shaped = parameters(index).any(|p| self.get(p) != p.declaration().1.default);
            let bounded = effect.name == "terrain_change" && self.boundary != Boundary::default();
            if !(self.is_on(index) || shaped || bounded) {
                continue;
            }
            let named = parameters(index).map(|parameter| {
                let value = self.get(parameter).into();
                (parameter.declaration().1.name.to_owned(), value)
            });
            let mut entries: Map<String, Value> = named.collect();
            if effect.name == "grade"
                && let Some(profile) = &self.slope_profile
            {
                entries.insert(PROFILE.into(), write_profile(profile));
            }
            if effect.name == "terrain_change" {
                let named = BOUNDARIES.iter().find(|(_, b)| *b == self.boundary);
                let name = named.map_or("place", |(name, _)| name);
                entries.insert(OVER.into(), name.into());
            }
            map.insert(effect.name.into(), entries.into());
        }
        map.extend(window::write(self).map(|window| (WINDOW.into(), window)));
        map.into()
    }
}

/// The parameters of an effect.
fn parameters(effect: usize) -> impl Iterator<Item = ParameterName> {
    (0..).map_while(move |place| ParameterName::at(effect, place))
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
                // Rows of different lengths could have the right number of slopes in total.
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
        // Parameters that do not switch an effect on are kept while it is off.
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
                "drag.coefficient = -1 N s^2/m^2 is outside its range [0, 1000] N s^2/m^2",
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
