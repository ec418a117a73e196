//! Which column of a header holds a quantity: by its name, by a name in common use, or by request.

use super::unit::{Quantity, is_unit};
use crate::spelling::nearest_within;

/// Names in common use, in the order of preference, written as [`words`] writes them.
const ALIASES: [(&str, &str); 12] = [
    (
        "time",
        "t timestamp time_stamp stamp ros_time rostime sim_time unix_time epoch epoch_time elapsed \
         elapsed_time datetime date_time utc utc_time seconds header_stamp",
    ),
    (
        "omega_left",
        "omega_l left_omega wl w_l w_left left_w wheel_left wheel_l left_wheel l_wheel wheel_speed_left \
         wheel_speed_l left_wheel_speed wheel_left_speed wheel_velocity_left left_wheel_velocity \
         wheel_left_velocity left_wheel_vel wheel_vel_left wheel_left_vel omega_wheel_left \
         left_wheel_omega rpm_left left_rpm rpm_l l_rpm left_angular_velocity angular_velocity_left",
    ),
    (
        "omega_right",
        "omega_r right_omega wr w_r w_right right_w wheel_right wheel_r right_wheel r_wheel \
         wheel_speed_right wheel_speed_r right_wheel_speed wheel_right_speed wheel_velocity_right \
         right_wheel_velocity wheel_right_velocity right_wheel_vel wheel_vel_right wheel_right_vel \
         omega_wheel_right right_wheel_omega rpm_right right_rpm rpm_r r_rpm right_angular_velocity \
         angular_velocity_right",
    ),
    (
        "x",
        "pos_x x_pos position_x x_position px p_x pose_x x_pose easting east pos_east",
    ),
    (
        "y",
        "pos_y y_pos position_y y_position py p_y pose_y y_pose northing north pos_north",
    ),
    (
        "heading",
        "yaw theta psi hdg yaw_angle heading_angle pose_theta pose_yaw",
    ),
    (
        "v_x",
        "vx vel_x x_vel velocity_x x_velocity linear_x linear_velocity_x forward_velocity \
         velocity_forward forward_speed v_forward v_long longitudinal_velocity",
    ),
    (
        "v_y",
        "vy vel_y y_vel velocity_y y_velocity linear_y linear_velocity_y lateral_velocity \
         velocity_lateral lateral_speed v_lat",
    ),
    (
        "yaw_rate",
        "yawrate wz w_z omega_z gyro_z gyroz z_gyro yaw_dot psi_dot theta_dot yaw_speed yaw_velocity \
         heading_rate turn_rate angular_z angular_velocity_z ang_vel_z",
    ),
    (
        "a_x",
        "ax acc_x accel_x x_accel acceleration_x linear_acceleration_x imu_ax",
    ),
    (
        "a_y",
        "ay acc_y accel_y y_accel acceleration_y linear_acceleration_y imu_ay",
    ),
    ("run", "run_id run_number"),
];

/// Ends of the names of message fields, as exporters of robots' logs write them.
const FIELDS: [(&str, &str); 9] = [
    ("x", "pose_position_x"),
    ("y", "pose_position_y"),
    ("v_x", "twist_linear_x"),
    ("v_y", "twist_linear_y"),
    ("yaw_rate", "twist_angular_z"),
    ("yaw_rate", "angular_velocity_z"),
    ("a_x", "linear_acceleration_x"),
    ("a_y", "linear_acceleration_y"),
    ("heading", "pose_orientation_yaw"),
];

/// Words in names of columns that may hold a quantity; a column needs one of each group.
const SIGNS: [(&str, &[&str]); 11] = [
    ("time", &["time stamp timestamp clock date sec secs t"]),
    ("omega_left", &["left l fl rl ml bl lf lr lm lb", WHEELS]),
    ("omega_right", &["right r fr rr mr br rf rm rb", WHEELS]),
    ("x", &["position pos easting lon longitude"]),
    ("y", &["position pos northing lat latitude"]),
    (
        "heading",
        &["heading yaw theta psi azimuth bearing compass course cog orientation"],
    ),
    ("v_x", &["v vx vel velocity speed u"]),
    ("v_y", &["vy"]),
    (
        "yaw_rate",
        &[
            "yaw gyro turn angular omega r w wz",
            "rate gyro dot angular omega r w wz",
        ],
    ),
    ("a_x", &["ax acc accel acceleration", "x ax"]),
    ("a_y", &["ay acc accel acceleration", "y ay"]),
];
const WHEELS: &str =
    "wheel wheels omega w rpm speed velocity vel v vl vr motor encoder enc track drive";
/// Words in names of columns that are no measurements.
const COMMANDS: &str = "cmd command commanded ref reference target desired des setpoint goal sp std var cov covariance";

/// The words of a name, in small letters and joined by `_`. Greek letters are spelt out.
pub fn words(name: &str) -> String {
    let mut words = String::with_capacity(name.len());
    let mut was_small = false;
    for letter in name.chars() {
        if letter.is_uppercase() && was_small {
            words.push('_');
        }
        was_small = letter.is_lowercase() || letter.is_ascii_digit();
        match letter {
            'ω' | 'Ω' => words.push_str("omega_"),
            'ψ' | 'Ψ' => words.push_str("psi_"),
            'θ' | 'Θ' => words.push_str("theta_"),
            letter if letter.is_alphanumeric() => words.extend(letter.to_lowercase()),
            _ => words.push('_'),
        }
    }
    let parts: Vec<&str> = words.split('_').filter(|word| !word.is_empty()).collect();
    parts.join("_")
}

/// A name and the unit in brackets behind it: `heading [deg]`.
fn bracketed(name: &str) -> Option<(&str, &str)> {
    let name = name.trim();
    let (base, unit) = name.split_once(['[', '(', '{'])?;
    let unit = unit.trim_end().strip_suffix([']', ')', '}'])?;
    Some((base.trim(), unit.trim()))
}

/// A column's name that stands for a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    /// Smaller is better: 0 for the quantity's own name.
    pub rank: usize,
    /// The unit in the name, as it stands there.
    pub unit: Option<String>,
}

/// How a column's name stands for a quantity, if it does.
pub fn matched(target: &str, quantity: Quantity, name: &str) -> Option<Match> {
    if name == target {
        return Some(Match {
            rank: 0,
            unit: None,
        });
    }
    let (base, unit) = match bracketed(name) {
        Some((base, "")) => (base, None),
        // Something else in brackets, such as a zone or a sensor.
        Some((base, text)) if !is_unit(text) => {
            if quantity != Quantity::Time {
                return None;
            }
            (base, None)
        }
        Some((base, unit)) => (base, Some(unit.to_owned())),
        None => (name, None),
    };
    let base = words(base);
    if let Some(rank) = rank(target, &base) {
        // Names in common use that say their unit: `rpm_left`.
        let says = || base.split('_').any(|word| word == "rpm");
        let unit = unit.or_else(|| says().then(|| "rpm".to_owned()));
        return Some(Match { rank, unit });
    }
    // `heading_deg`, `omega_left_rad_s`.
    let words: Vec<&str> = base.split('_').collect();
    (1..words.len())
        .filter(|_| unit.is_none())
        .find_map(|count| {
            let (start, end) = words.split_at(count);
            let rank = rank(target, &start.join("_"))?;
            let unit = match (quantity, end) {
                (Quantity::Velocity, ["ms"]) => "m/s".to_owned(),
                (Quantity::Acceleration, ["ms2"]) => "m/s^2".to_owned(),
                _ => end.join("/"),
            };
            quantity.size(&unit)?;
            Some(Match {
                rank,
                unit: Some(unit),
            })
        })
}

/// The place of a name in the order of preference for a quantity.
fn rank(target: &str, words: &str) -> Option<usize> {
    if words == target {
        return Some(1);
    }
    let aliases = ALIASES.iter().find(|(name, _)| *name == target)?.1;
    let known = aliases.split_whitespace().position(|alias| alias == words);
    let field = || {
        let ends = FIELDS.iter().filter(|(name, _)| *name == target);
        let mut ends = ends.map(|(_, end)| *end);
        let fits = |end: &str| {
            words
                .strip_suffix(end)
                .is_some_and(|start| start.ends_with('_'))
        };
        ends.any(fits).then_some(aliases.len())
    };
    known.map(|place| place + 2).or_else(field)
}

/// Whether a name looks as if it might stand for a quantity.
pub fn resembles(target: &str, name: &str) -> bool {
    let base = bracketed(name).map_or(name, |(base, _)| base);
    let joined = words(base);
    let has = |list: &str| {
        let mut words = joined.split('_');
        words.any(|word| {
            list.split(' ')
                .any(|sign| sign == word.trim_end_matches(char::is_numeric))
        })
    };
    // Components of vectors and quaternions, and wheels.
    let others = match target {
        "heading" => "x y z w",
        "yaw_rate" => "x y left right l fl rl ml bl r fr rr mr br",
        _ => "",
    };
    let Some((_, groups)) = SIGNS.iter().find(|(name, _)| *name == target) else {
        return false;
    };
    let is_rate = has("rate dot gyro") && target != "yaw_rate";
    groups.iter().all(|group| has(group)) && !has(COMMANDS) && !has(others) && !is_rate
}

/// The columns that may be meant for a missing quantity: those that look like it, or else those of its side, or else a
/// misspelt one.
pub fn likely<'a>(target: &str, names: &[&'a str]) -> Vec<&'a str> {
    let alike = |fits: &dyn Fn(&str) -> bool| -> Vec<&'a str> {
        let names = names.iter().copied();
        names.filter(|name| fits(name)).collect()
    };
    let found = alike(&|name| resembles(target, name));
    if !found.is_empty() {
        return found;
    }
    let found = alike(&|name| is_of_side(target, name));
    if !found.is_empty() {
        return found;
    }
    let misspelt = nearest_within(target, names.iter().copied());
    misspelt.into_iter().collect()
}

/// Whether a name has the side of a wheel speed and is no command: `right` for `omega_right`.
fn is_of_side(target: &str, name: &str) -> bool {
    let Some(side) = target.strip_prefix("omega_") else {
        return false;
    };
    let words = words(name);
    let mut words = words.split('_');
    words.clone().any(|word| word == side)
        && !words.any(|word| COMMANDS.split(' ').any(|command| command == word))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(target: &str, quantity: Quantity, name: &str) -> Option<String> {
        matched(target, quantity, name).map(|found| found.unit.unwrap_or_default())
    }

    #[test]
    fn names_in_common_use_and_their_units_are_known() {
        for (target, quantity, name, expected) in [
            ("heading", Quantity::Angle, "yaw", ""),
            ("heading", Quantity::Angle, "Heading", ""),
            ("heading", Quantity::Angle, "theta (deg)", "deg"),
            ("heading", Quantity::Angle, "yaw_deg", "deg"),
            ("heading", Quantity::Angle, "ψ [°]", "°"),
            ("omega_left", Quantity::WheelSpeed, "omegaLeft", ""),
            ("omega_left", Quantity::WheelSpeed, "ω_l", ""),
            ("omega_left", Quantity::WheelSpeed, "wl_rpm", "rpm"),
            ("omega_left", Quantity::WheelSpeed, "rpm_left", "rpm"),
            ("omega_right", Quantity::WheelSpeed, "right RPM", "rpm"),
            (
                "omega_right",
                Quantity::WheelSpeed,
                "rpm_r [rad/s]",
                "rad/s",
            ),
            (
                "omega_left",
                Quantity::WheelSpeed,
                "omega_left_rad_s",
                "rad/s",
            ),
            (
                "omega_right",
                Quantity::WheelSpeed,
                "Wheel Speed Right [m/s]",
                "m/s",
            ),
            ("time", Quantity::Time, "__time", ""),
            ("time", Quantity::Time, "timestamp_ns", "ns"),
            ("v_x", Quantity::Velocity, "vx_ms", "m/s"),
            ("x", Quantity::Length, "/odom/pose/pose/position/x", ""),
            (
                "yaw_rate",
                Quantity::AngularVelocity,
                "field.twist.twist.angular.z",
                "",
            ),
        ] {
            assert_eq!(
                unit(target, quantity, name).as_deref(),
                Some(expected),
                "{name}"
            );
        }
    }

    #[test]
    fn other_names_stand_for_nothing() {
        for name in [
            "heading_deviation",
            "yaw_rate",
            "yaw_ref",
            "x",
            "heading_error",
        ] {
            assert_eq!(unit("heading", Quantity::Angle, name), None, "{name}");
        }
        assert_eq!(unit("omega_left", Quantity::WheelSpeed, "wl_cmd"), None);
        assert_eq!(unit("omega_left", Quantity::WheelSpeed, "v_left"), None);
        assert_eq!(unit("x", Quantity::Length, "max"), None);
        // In brackets stands a unit, or the name of something else.
        assert_eq!(unit("heading", Quantity::Angle, "heading (gps)"), None);
        assert_eq!(
            unit("time", Quantity::Time, "time (UTC)").as_deref(),
            Some("")
        );
    }

    #[test]
    fn likely_columns_share_words_or_nearly_the_spelling() {
        let names = ["x", "y", "v_left", "v_right", "wl_cmd", "note"];
        assert_eq!(likely("omega_left", &names), ["v_left"]);
        assert_eq!(likely("omega_right", &names), ["v_right"]);
        assert_eq!(likely("omega_left", &["x", "omega_lefft"]), ["omega_lefft"]);
        assert!(likely("time", &["x", "y", "a"]).is_empty());
        assert_eq!(
            likely("heading", &["azimuth", "yaw_rate", "orientation_x"]),
            ["azimuth"]
        );
        assert!(likely("yaw_rate", &["omega_fl", "angular_velocity_x"]).is_empty());
        // A side alone, but not beside a better one.
        assert_eq!(likely("omega_right", &["x", "right"]), ["right"]);
        assert_eq!(likely("omega_right", &["right", "v_right"]), ["v_right"]);
        assert!(likely("omega_right", &["left", "right_cmd", "bright"]).is_empty());
    }
}
