//! Wheels and their sides, by the names of joints.

use std::collections::BTreeSet;

/// The wheels' joints of both sides.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WheelJoints {
    /// Of the left side.
    pub left: Vec<String>,
    /// Of the right side.
    pub right: Vec<String>,
}

/// Words for the sides: left and right alone, and with front, middle (centre), rear (back, hind).
const LEFT: [&str; 14] = [
    "left", "l", "fl", "lf", "ml", "lm", "cl", "lc", "rl", "lr", "bl", "lb", "hl", "lh",
];
const RIGHT: [&str; 13] = [
    "right", "r", "fr", "rf", "mr", "rm", "cr", "rc", "rr", "br", "rb", "hr", "rh",
];
/// Fragments of names of what rolls on the ground, and of drives, which may turn faster, before a gear.
const ROLLS: [&str; 5] = ["wheel", "track", "tire", "tyre", "sprocket"];
const DRIVES: [&str; 2] = ["drive", "motor"];
/// Fragments of names of other joints; they override the others.
const OTHERS: [&str; 12] = [
    "steer", "caster", "castor", "susp", "shock", "rocker", "bogie", "arm", "gripper", "finger",
    "camera", "flipper",
];

/// The side of a wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    Left,
    Right,
}

/// The wheels among joints: by names of rolling joints; without any, by names of drives; else all names with a side.
pub(super) fn guess(joints: &BTreeSet<String>) -> WheelJoints {
    let sided = joints
        .iter()
        .filter(|name| !contains(name, &OTHERS))
        .filter_map(|name| Some((name, side(name)?)));
    let (rolling, rest): (Vec<_>, Vec<_>) = sided.partition(|(name, _)| contains(name, &ROLLS));
    let (driving, rest): (Vec<_>, Vec<_>) = rest
        .into_iter()
        .partition(|(name, _)| contains(name, &DRIVES));
    let groups = [rolling, driving, rest];
    let chosen = groups.into_iter().find(|group| !group.is_empty());
    let chosen = chosen.unwrap_or_default();
    let of = |wanted| {
        let names = chosen.iter().filter(|(_, side)| *side == wanted);
        names.map(|(name, _)| (*name).clone()).collect()
    };
    WheelJoints {
        left: of(Side::Left),
        right: of(Side::Right),
    }
}

fn contains(name: &str, fragments: &[&str]) -> bool {
    let name = name.to_lowercase();
    fragments.iter().any(|fragment| name.contains(fragment))
}

/// The side in a name; `None` for neither or both.
pub(super) fn side(name: &str) -> Option<Side> {
    let lower = name.to_lowercase();
    match (lower.contains("left"), lower.contains("right")) {
        (true, false) => return Some(Side::Left),
        (false, true) => return Some(Side::Right),
        (true, true) => return None,
        (false, false) => {}
    }
    let words = words(name);
    let says = |side: &[&str]| words.iter().any(|word| side.contains(&word.as_str()));
    match (says(&LEFT), says(&RIGHT)) {
        (true, false) => Some(Side::Left),
        (false, true) => Some(Side::Right),
        _ => None,
    }
}

/// The words of a name in lower case, separated by non-letters and before a capital after a small letter: `wheelFL1` has
/// `wheel` and `fl`.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars() {
        if !letter.is_alphabetic() || (was_small && letter.is_uppercase()) {
            words.push(String::new());
        }
        was_small = letter.is_lowercase();
        if let (true, Some(word)) = (letter.is_alphabetic(), words.last_mut()) {
            word.extend(letter.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guessed(names: &str) -> (String, String) {
        let joints = names.split(' ').map(str::to_owned).collect();
        let WheelJoints { left, right } = guess(&joints);
        (left.join(" "), right.join(" "))
    }

    fn pair(left: &str, right: &str) -> (String, String) {
        (left.into(), right.into())
    }

    #[test]
    fn names_of_robots_in_use() {
        for (names, left, right) in [
            // Husky and Jackal, Warthog, Rover with letters, Leo, camel case, no separator.
            (
                "front_left_wheel rear_left_wheel front_right_wheel rear_right_wheel",
                "front_left_wheel rear_left_wheel",
                "front_right_wheel rear_right_wheel",
            ),
            (
                "left_wheels_joint right_wheels_joint",
                "left_wheels_joint",
                "right_wheels_joint",
            ),
            ("fl rl fr rr", "fl rl", "fr rr"),
            (
                "wheel_FL_joint wheel_RL_joint wheel_FR_joint wheel_RR_joint",
                "wheel_FL_joint wheel_RL_joint",
                "wheel_FR_joint wheel_RR_joint",
            ),
            (
                "wheelL1 wheelL2 wheelR1 wheelR2",
                "wheelL1 wheelL2",
                "wheelR1 wheelR2",
            ),
            (
                "frontleftwheel frontrightwheel",
                "frontleftwheel",
                "frontrightwheel",
            ),
            ("base/wheel_l base/wheel_r", "base/wheel_l", "base/wheel_r"),
        ] {
            assert_eq!(guessed(names), pair(left, right), "{names}");
        }
    }

    #[test]
    fn other_joints_are_ignored() {
        let names = "left_wheel right_wheel left_hip right_hip left_wheel_steer left_arm_wheel pan";
        assert_eq!(guessed(names), pair("left_wheel", "right_wheel"));
        assert_eq!(guessed("wheel_1 wheel_2 left_right_wheel"), pair("", ""));
    }

    #[test]
    fn motors_before_a_gear_are_no_wheels_where_there_are_some() {
        let motors = "front_left_motor front_right_motor";
        let wheels = "front_left_wheel front_right_wheel";
        let found = pair("front_left_wheel", "front_right_wheel");
        assert_eq!(guessed(&format!("{motors} {wheels}")), found);
        let found = pair("front_left_motor", "front_right_motor");
        assert_eq!(guessed(&format!("{motors} left_hip right_hip")), found);
    }
}
