//! A window of effects as JSON.

use super::error::JsonError;
use super::object::{as_object, check_keys};
use crate::effects::{CATALOGUE, EffectKind, Effects, Extent, Window};
use crate::spelling::nearest;
use serde_json::{Map, Value, json};

/// The key of a window among the effects.
pub(super) const WINDOW: &str = "window";
const EFFECTS: &str = "effects";
const TIME: &str = "time";
const PLACE: &str = "place";
const DISC: [&str; 3] = ["x", "y", "radius"];

/// Reads the window of effects that are read already.
pub(super) fn read(value: &Value, effects: &Effects) -> Result<Window, JsonError> {
    let shape = "{\"effects\": [\"drawbar\", ...], \"time\": [start, end]} [s], or in the place of \
                 \"time\" \"place\": {\"x\": east, \"y\": north, \"radius\": radius} [m]";
    let wrong = || JsonError::wrong_type(WINDOW, value, shape.into());
    let map = as_object(value, WINDOW, shape)?;
    check_keys(WINDOW, map.keys(), [EFFECTS, TIME, PLACE])?;
    let extent = match (map.get(TIME), map.get(PLACE)) {
        (Some(time), None) => read_time(time)?,
        (None, Some(place)) => read_place(place)?,
        (Some(_), Some(_)) => {
            return Err(JsonError::WrongType {
                place: WINDOW.into(),
                found: format!("both `{TIME}` and `{PLACE}`"),
                expected: "one of them".into(),
            });
        }
        (None, None) => return Err(wrong()),
    };
    let names = map.get(EFFECTS).and_then(Value::as_array);
    let numbered = names.ok_or_else(wrong)?.iter().enumerate();
    let places = numbered.map(|(index, name)| read_effect(index, name));
    let window = Window {
        effects: places.collect::<Result<_, _>>()?,
        extent,
    };
    window.check(effects).map_err(|source| JsonError::Window {
        place: WINDOW,
        source,
    })?;
    Ok(window)
}

fn read_effect(index: usize, value: &Value) -> Result<usize, JsonError> {
    let place = || format!("{WINDOW}.{EFFECTS}[{index}]");
    let Some(name) = value.as_str() else {
        let expected = "the name of an effect".into();
        return Err(JsonError::wrong_type(place(), value, expected));
    };
    let found = CATALOGUE.iter().position(|effect| effect.name == name);
    found.ok_or_else(|| {
        let physics = CATALOGUE.iter().filter(|e| e.kind == EffectKind::Physics);
        JsonError::UnknownEffect {
            place: place(),
            name: name.into(),
            nearest: nearest(name, physics.map(|e| e.name)).unwrap_or_default(),
        }
    })
}

fn read_time(value: &Value) -> Result<Extent, JsonError> {
    let pair = value.as_array().map(Vec::as_slice);
    let pair = pair.and_then(|pair| match pair {
        [start, end] => Some((start.as_f64()?, end.as_f64()?)),
        _ => None,
    });
    let (start, end) = pair.ok_or_else(|| {
        let expected = "[start, end], two numbers [s]".into();
        JsonError::wrong_type(format!("{WINDOW}.{TIME}"), value, expected)
    })?;
    Ok(Extent::Time { start, end })
}

fn read_place(value: &Value) -> Result<Extent, JsonError> {
    let place = format!("{WINDOW}.{PLACE}");
    let shape = "{\"x\": east, \"y\": north, \"radius\": radius}, three numbers [m]";
    let map = as_object(value, &place, shape)?;
    check_keys("window's place", map.keys(), DISC)?;
    let number = |key: &str| map.get(key).and_then(Value::as_f64);
    let [Some(x), Some(y), Some(radius)] = DISC.map(number) else {
        return Err(JsonError::wrong_type(place, value, shape.into()));
    };
    Ok(Extent::Place { x, y, radius })
}

/// The window as [`read`] takes it, with those of its effects that are on, if any is.
pub(super) fn write(effects: &Effects) -> Option<Value> {
    let window = effects.window.as_ref()?;
    let on = window
        .effects
        .iter()
        .filter(|effect| effects.is_on(**effect));
    let names: Vec<&str> = on.map(|effect| CATALOGUE[*effect].name).collect();
    let (key, extent) = match window.extent {
        Extent::Time { start, end } => (TIME, json!([start, end])),
        Extent::Place { x, y, radius } => (PLACE, json!({ "x": x, "y": y, "radius": radius })),
    };
    (!names.is_empty()).then(|| {
        let mut map = Map::new();
        map.insert(EFFECTS.into(), names.into());
        map.insert(key.into(), extent);
        map.into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_read_back_to_the_last_bit() {
        for extent in [
            r#""time": [12.4, 21.333333333333332]"#,
            r#""place": {"x": -3.5, "y": 2, "radius": 0.1}"#,
        ] {
            let text = format!(
                r#"{{"window": {{"effects": ["drawbar", "grade"], {extent}}},
                    "drawbar": {{"force": 300}}, "drag": {{"coefficient": 4}},
                    "grade": {{"profile": {{"over": "time", "points": [[0, 0.1, 0]]}}}}}}"#
            );
            let effects = Effects::from_json(&text).unwrap();
            assert_eq!(effects.window.as_ref().unwrap().effects.len(), 2);
            assert_eq!(Effects::from_json(&effects.to_json()), Ok(effects));
        }
    }

    #[test]
    fn what_is_off_anyway_is_not_written() {
        let mut effects = Effects::NONE;
        effects.window = Some(Window {
            effects: vec![0],
            extent: Extent::Time {
                start: 0.0,
                end: 1.0,
            },
        });
        assert_eq!(effects.to_json_value(), json!({}));
        let drag = CATALOGUE.iter().position(|effect| effect.name == "drag");
        effects.window.as_mut().unwrap().effects.push(drag.unwrap());
        let effects = effects.with("drag.coefficient", 2.0).unwrap();
        assert_eq!(
            effects.to_json_value()["window"]["effects"],
            json!(["drag"])
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (window, expected) in [
            (
                r#"{"effects": ["drawbr"], "time": [1, 2]}"#,
                "window.effects[0]: no effect is called `drawbr`; the nearest is `drawbar`",
            ),
            (
                r#"{"effects": ["drawbar", 7], "time": [1, 2]}"#,
                "window.effects[1]: found the number 7, expected the name of an effect",
            ),
            (
                r#"{"effects": ["drawbar", "drag"], "time": [1, 2]}"#,
                "window: drag is off: set its parameters beside the window, or leave it out",
            ),
            (
                r#"{"effects": ["latency"], "time": [1, 2]}"#,
                "window: latency changes what sensors report, which has no window: leave it out",
            ),
            (
                r#"{"effects": [], "time": [1, 2]}"#,
                "window: it holds no effects: name at least one",
            ),
            (
                r#"{"effects": ["drawbar"], "time": [2, 2]}"#,
                "window: the start, 2 s, must come before the end, 2 s",
            ),
            (
                r#"{"effects": ["drawbar"], "time": 2}"#,
                "window.time: found the number 2, expected [start, end], two numbers [s]",
            ),
            (
                r#"{"effects": ["drawbar"], "place": {"x": 1, "y": 2, "radius": 0}}"#,
                "window: the radius, 0 m, must be above 0 m",
            ),
            (
                r#"{"effects": ["drawbar"], "place": {"x": 1, "y": 2, "radios": 1}}"#,
                "the window's place has an unknown key `radios`; the nearest known one is `radius`",
            ),
            (
                r#"{"effects": ["drawbar"], "time": [1, 2], "place": {}}"#,
                "window: found both `time` and `place`, expected one of them",
            ),
            (
                r#"{"effects": ["drawbar"], "tim": [1, 2]}"#,
                "the window has an unknown key `tim`; the nearest known one is `time`",
            ),
        ] {
            let text = format!(r#"{{"window": {window}, "drawbar": {{"force": 300}}}}"#);
            assert_eq!(Effects::from_json(&text).unwrap_err().to_string(), expected);
        }
        for window in [r#"{"effects": ["drawbar"]}"#, r#"{"time": [1, 2]}"#, "3"] {
            let text = format!(r#"{{"window": {window}, "drawbar": {{"force": 300}}}}"#);
            let message = Effects::from_json(&text).unwrap_err().to_string();
            assert!(
                message.contains("\"time\": [start, end]} [s], or in"),
                "{message}"
            );
        }
    }
}
