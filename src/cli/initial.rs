//! `--initial`: the initial pose and velocities.

use super::failure::Failure;
use crate::parameter::{Bounds, ParameterError};
use crate::simulation::{State, WheelSpeeds};
use crate::spelling::nearest;
use crate::vehicle::Vehicle;
use std::str::FromStr;

/// Sets the velocities of rolling without slip at the first wheel speeds.
const NO_SLIP: &str = "no-slip";

/// The states in the order of [`State::to_array`]: no ground vehicle has larger values. `ugv inspect` has the same limits for
/// recordings.
const STATES: [(&str, Bounds); State::COUNT] = [
    limited("x", "m", 1e8),
    limited("y", "m", 1e8),
    limited("heading", "rad", 1e5),
    limited("v_x", "m/s", 100.0),
    limited("v_y", "m/s", 100.0),
    limited("yaw_rate", "rad/s", 35.0),
];
/// The states from here on are velocities.
const FIRST_VELOCITY: usize = 3;

const fn limited(name: &'static str, unit: &'static str, limit: f64) -> (&'static str, Bounds) {
    (name, Bounds::closed(name, unit, -limit, limit))
}

/// One of the arguments of `--initial`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InitialArgument {
    /// `no-slip`.
    NoSlip,
    /// `key=value`: the place of the key in [`State::to_array`], and the value.
    Value(usize, f64),
}

impl InitialArgument {
    /// Whether it sets the state at this place.
    pub fn sets(self, place: usize) -> bool {
        match self {
            Self::NoSlip => place >= FIRST_VELOCITY,
            Self::Value(set, _) => set == place,
        }
    }
}

impl FromStr for InitialArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == NO_SLIP {
            return Ok(Self::NoSlip);
        }
        let names = STATES.map(|(name, _)| name);
        let Some((name, value)) = text.split_once('=') else {
            return Err(format!("found `{text}`, expected KEY=VALUE or {NO_SLIP}"));
        };
        let (name, value) = (name.trim(), value.trim());
        let Some(place) = names.iter().position(|known| *known == name) else {
            return Err(format!(
                "unknown key `{name}`, the nearest is `{}` (of {})",
                nearest(name, names).unwrap_or_default(),
                names.join(", ")
            ));
        };
        match value.parse() {
            Ok(number) if f64::is_finite(number) => {
                check(place, number).map_err(|error| error.to_string())?;
                Ok(Self::Value(place, number))
            }
            _ => Err(format!(
                "found `{value}` for {name}, expected a finite number"
            )),
        }
    }
}

/// Refuses the value of an initial state, by its place in [`State::to_array`], that no ground vehicle has.
///
/// # Errors
/// Names the state, the value, the unit and the range.
pub fn check(place: usize, value: f64) -> Result<(), ParameterError> {
    STATES[place].1.check(value)
}

/// The initial state: at rest at the origin, except for what the arguments set.
pub fn initial_state(
    arguments: &[InitialArgument],
    vehicle: &Vehicle,
    wheel_speeds: WheelSpeeds,
) -> Result<State, Failure> {
    let mut state = State::default();
    if arguments.contains(&InitialArgument::NoSlip) {
        state = state.rolling_without_slip(wheel_speeds, vehicle.wheel_radius, vehicle.half_track);
    }
    let mut values = state.to_array();
    for (index, argument) in arguments.iter().enumerate() {
        let InitialArgument::Value(place, value) = *argument else {
            continue;
        };
        let name = STATES[place].0;
        if arguments[..index]
            .iter()
            .any(|other| matches!(other, InitialArgument::Value(set, _) if *set == place))
        {
            return Err(Failure::argument(format!("--initial sets {name} twice")));
        }
        if arguments.contains(&InitialArgument::NoSlip) && place >= FIRST_VELOCITY {
            return Err(Failure::argument(format!(
                "--initial sets {name} beside {NO_SLIP}, which sets it too"
            )));
        }
        values[place] = value;
    }
    Ok(State::from_array(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(words: &[&str]) -> Result<State, String> {
        let arguments: Vec<InitialArgument> = words
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
    fn the_default_is_rest_at_the_origin() {
        assert_eq!(state(&[]), Ok(State::default()));
        let expected = State {
            y: 2.0,
            v_x: -1.1,
            ..State::default()
        };
        assert_eq!(state(&["v_x=-1.1", "y = 2"]), Ok(expected));
    }

    #[test]
    fn no_slip_combines_with_a_pose() {
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
