//! `--initial`: where the vehicle starts, and how fast.

use super::Failure;
use std::str::FromStr;
use ugv_terrain::parameter::{Bounds, ParameterError};
use ugv_terrain::simulation::{State, WheelSpeeds};
use ugv_terrain::spelling::nearest;
use ugv_terrain::vehicle::Vehicle;

/// Velocities of rolling without slip at the first wheel speeds.
const NO_SLIP: &str = "no-slip";

/// A state that can be set.
struct Key {
    name: &'static str,
    bounds: Bounds,
    /// Whether `no-slip` sets it.
    velocity: bool,
    field: fn(&mut State) -> &mut f64,
}

/// Larger sizes are none of a ground vehicle's: `ugv inspect` takes none in a recording either.
const fn within(name: &'static str, unit: &'static str, size: f64) -> Bounds {
    Bounds::closed(name, unit, -size, size)
}

const KEYS: [Key; State::COUNT] = [
    Key {
        name: "x",
        bounds: within("x", "m", 1e8),
        velocity: false,
        field: |state| &mut state.x,
    },
    Key {
        name: "y",
        bounds: within("y", "m", 1e8),
        velocity: false,
        field: |state| &mut state.y,
    },
    Key {
        name: "heading",
        bounds: within("heading", "rad", 1e5),
        velocity: false,
        field: |state| &mut state.heading,
    },
    Key {
        name: "v_x",
        bounds: within("v_x", "m/s", 100.0),
        velocity: true,
        field: |state| &mut state.v_x,
    },
    Key {
        name: "v_y",
        bounds: within("v_y", "m/s", 100.0),
        velocity: true,
        field: |state| &mut state.v_y,
    },
    Key {
        name: "yaw_rate",
        bounds: within("yaw_rate", "rad/s", 35.0),
        velocity: true,
        field: |state| &mut state.yaw_rate,
    },
];

/// One of the arguments of `--initial`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Initial {
    /// `no-slip`.
    NoSlip,
    /// `key=value`: the index of the key, and the value.
    Value(usize, f64),
}

impl FromStr for Initial {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == NO_SLIP {
            return Ok(Self::NoSlip);
        }
        let names = KEYS.iter().map(|key| key.name);
        let Some((name, value)) = text.split_once('=') else {
            return Err(format!("found `{text}`, expected KEY=VALUE or {NO_SLIP}"));
        };
        let (name, value) = (name.trim(), value.trim());
        let Some(index) = names.clone().position(|key| key == name) else {
            let meant = nearest(name, names.clone()).unwrap_or_default();
            let known = names.collect::<Vec<_>>().join(", ");
            return Err(format!(
                "unknown key `{name}`, the nearest is `{meant}` (of {known})"
            ));
        };
        match value.parse() {
            Ok(number) if f64::is_finite(number) => {
                check(index, number).map_err(|error| error.to_string())?;
                Ok(Self::Value(index, number))
            }
            _ => Err(format!(
                "found `{value}` for {name}, expected a finite number"
            )),
        }
    }
}

/// Refuses the value of an initial state, by its place in [`State`], that no ground vehicle has.
///
/// # Errors
/// Names the state, the value, the unit and the range.
pub fn check(index: usize, value: f64) -> Result<(), ParameterError> {
    KEYS[index].bounds.check(value)
}

/// The state at the beginning: at rest at the origin but for what the arguments say.
pub fn initial_state(
    arguments: &[Initial],
    vehicle: &Vehicle,
    wheel_speeds: WheelSpeeds,
) -> Result<State, Failure> {
    let mut state = State::default();
    let no_slip = arguments.contains(&Initial::NoSlip);
    if no_slip {
        state = state.rolling_without_slip(wheel_speeds, vehicle.wheel_radius, vehicle.half_track);
    }
    let mut seen = [false; State::COUNT];
    for argument in arguments {
        let Initial::Value(index, value) = *argument else {
            continue;
        };
        let Key {
            name,
            velocity,
            field,
            ..
        } = &KEYS[index];
        if seen[index] {
            return Err(conflict(format!("--initial sets {name} twice")));
        }
        if no_slip && *velocity {
            return Err(conflict(format!(
                "--initial sets {name} beside {NO_SLIP}, which sets it too"
            )));
        }
        seen[index] = true;
        *field(&mut state) = value;
    }
    Ok(state)
}

fn conflict(reason: String) -> Failure {
    Failure::Argument { reason, hint: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(words: &[&str]) -> Result<State, String> {
        let arguments: Vec<Initial> = words
            .iter()
            .map(|word| word.parse())
            .collect::<Result<_, _>>()?;
        let speeds = WheelSpeeds {
            left: 4.0,
            right: 8.0,
        };
        initial_state(&arguments, &Vehicle::tran2007(), speeds)
            .map_err(|failure| failure.to_string())
    }

    #[test]
    fn rest_unless_told_otherwise() {
        assert_eq!(state(&[]), Ok(State::default()));
        let expected = State {
            y: 2.0,
            v_x: -1.1,
            ..State::default()
        };
        assert_eq!(state(&["v_x=-1.1", "y = 2"]), Ok(expected));
    }

    #[test]
    fn no_slip_goes_with_a_pose() {
        let expected = State {
            heading: 0.5,
            // r (4 + 8) / 2 and r (8 - 4) / (2 B).
            v_x: 1.5,
            yaw_rate: 1.0 / 1.22,
            ..State::default()
        };
        assert_eq!(state(&["no-slip", "heading=0.5"]), Ok(expected));
        assert!(
            state(&["v_y=0", "no-slip"])
                .unwrap_err()
                .contains("v_y beside no-slip")
        );
    }

    #[test]
    fn faults_are_explained() {
        for (words, expected) in [
            (
                &["vx=1"][..],
                "unknown key `vx`, the nearest is `v_x` (of x, y, heading, v_x, v_y, yaw_rate)",
            ),
            (&["x=a"], "found `a` for x, expected a finite number"),
            (&["x=nan"], "found `nan` for x, expected a finite number"),
            (&["slip"], "found `slip`, expected KEY=VALUE or no-slip"),
            (&["x=1", "x=2"], "--initial sets x twice"),
            (
                &["v_x=1e150"],
                "v_x = 1e150 m/s is outside its range [-100, 100] m/s",
            ),
            (
                &["yaw_rate=-36"],
                "yaw_rate = -36 rad/s is outside its range [-35, 35] rad/s",
            ),
        ] {
            assert_eq!(state(words).unwrap_err(), expected);
        }
    }
}
