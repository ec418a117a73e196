//! How strong an effect is: around its prior, and in proportion to the vehicle.

use super::random::Random;
use super::world::{Ingredient, Region};
use ugv_terrain::effects::{CATALOGUE, Declaration, ParameterDeclaration, Prior};
use ugv_terrain::vehicle::Vehicle;

/// Sizes, with how far they lie from where the effect is off: in standard deviations of a
/// parameter that may have both signs, and from the median of one that has not.
const SIZES: [(&str, f64, f64); 3] = [
    ("small", 0.5, -1.0),
    ("medium", 1.0, 0.2),
    ("large", 2.0, 1.3),
];

/// The vehicle that the priors of masses and forces suit \[kg\].
const USUAL_MASS: f64 = 470.0;
/// The same for lengths: distance between the outer rows \[m\].
const USUAL_LENGTH: f64 = 1.2;

/// Number of sizes.
pub const SIZE_COUNT: usize = SIZES.len();

/// An effect of the catalogue of some size; of several switches one or all are on.
pub fn ingredient(name: &str, size: usize, vehicle: &Vehicle, random: &mut Random) -> Ingredient {
    let effect = CATALOGUE.iter().find(|effect| effect.name == name);
    let effect = effect.unwrap_or_else(|| panic!("{name} is not in the catalogue"));
    let switches: Vec<&str> = switches(effect);
    // Ground seldom falls exactly to one side.
    let all = if name == "grade" { 0.8 } else { 0.35 };
    let on = if switches.len() == 1 || random.chance(all) {
        switches
    } else {
        vec![random.pick(&switches)]
    };
    with_switches(effect.name, &on, size, vehicle, random)
}

/// The parameters that turn an effect on.
fn switches(effect: &Declaration) -> Vec<&'static str> {
    let all = effect.parameters.iter().filter(|p| p.switches);
    // The sensors of the yaw rate and of the pose share a latency as often as not.
    all.filter(|p| (effect.name, p.name) != ("latency", "yaw_rate"))
        .map(|p| p.name)
        .collect()
}

/// An effect of the catalogue of some size, with these of its switches.
pub fn with_switches(
    name: &str,
    on: &[&str],
    size: usize,
    vehicle: &Vehicle,
    random: &mut Random,
) -> Ingredient {
    let effect = CATALOGUE.iter().find(|effect| effect.name == name);
    let effect = effect.unwrap_or_else(|| panic!("{name} is not in the catalogue"));
    let mut parameters = Vec::new();
    // One azimuth: sizes are those of the whole, not of each axis.
    let azimuth = random.between(-3.1, 3.1);
    for parameter in effect.parameters {
        let key = (effect.name, parameter.name);
        let value = if parameter.switches && !on.contains(&parameter.name) {
            continue;
        } else if parameter.switches {
            let value = strength(key, parameter, size, vehicle, random);
            match key.1 {
                _ if on.len() == 1 => value,
                "slope_east" => value.abs() * azimuth.cos(),
                "slope_north" => value.abs() * azimuth.sin(),
                _ => value,
            }
        } else {
            match shape(key, parameter, vehicle, random) {
                Some(value) => value,
                None => continue,
            }
        };
        let full = format!("{}.{}", effect.name, parameter.name);
        parameters.push((full, round(value.clamp(parameter.low, parameter.high))));
    }
    Ingredient {
        name: effect.name,
        size: SIZES[size].0,
        parameters,
        law: None,
        region: Region::Always,
    }
}

/// Four digits are plenty for what nobody knows.
fn round(value: f64) -> f64 {
    format!("{value:.3e}").parse().expect("a number")
}

fn scale(key: (&str, &str), vehicle: &Vehicle) -> f64 {
    let rows = &vehicle.row_positions;
    match key {
        ("drawbar", "force") | ("payload", "mass") | ("rate_dependent_soil" | "drag", _) => {
            vehicle.mass / USUAL_MASS
        }
        ("com_shift", _) | ("payload", "ahead" | "left") => {
            (rows[0] - rows[rows.len() - 1]) / USUAL_LENGTH
        }
        ("payload", "height") | ("drawbar", "hitch_height") => vehicle.com_height / 0.45,
        _ => 1.0,
    }
}

fn strength(
    key: (&str, &str),
    parameter: &ParameterDeclaration,
    size: usize,
    vehicle: &Vehicle,
    random: &mut Random,
) -> f64 {
    let jitter = random.scaled(0.85, 1.18);
    let (_, two_sided, one_sided) = SIZES[size];
    let table = |values: [f64; SIZE_COUNT]| values[size] * jitter;
    match key {
        ("multipass", "memory") => [0.4, 0.7, 1.0][size],
        ("elastic_rebound", _) => table([0.08, 0.2, 0.45]),
        ("stress_peak", "a0") => 0.5 - table([0.04, 0.1, 0.18]),
        ("stress_peak", "a1") => table([0.06, 0.15, 0.3]),
        // Soft tyres are what is far from rigid.
        ("tyre_compliance", _) => table([60e3, 38e3, 20e3]),
        ("latency", "pose") => table([0.12, 0.25, 0.5]),
        ("latency", "wheels") => table([0.07, 0.15, 0.3]),
        ("wheel_radius", _) => 1.0 + random.sign() * table([0.015, 0.03, 0.06]),
        ("slip_sinkage", "exponent_growth") => table([0.1, 0.25, 0.6]),
        _ => match parameter.prior {
            Prior::Normal { deviation, .. } => {
                random.sign() * two_sided * deviation * jitter * scale(key, vehicle)
            }
            // A factor, off at 1: either way.
            Prior::LogNormal { deviation, .. } if parameter.default != 0.0 => {
                (random.sign() * two_sided * deviation * jitter).exp()
            }
            Prior::LogNormal { median, deviation } => {
                median * (one_sided * deviation).exp() * jitter * scale(key, vehicle)
            }
        },
    }
}

/// A parameter that shapes an effect; none where its default is to stand.
fn shape(
    key: (&str, &str),
    parameter: &ParameterDeclaration,
    vehicle: &Vehicle,
    random: &mut Random,
) -> Option<f64> {
    let rear = vehicle.row_positions[vehicle.row_positions.len() - 1];
    let place = scale(key, vehicle);
    Some(match key {
        ("drawbar", "hitch_behind") => -rear * random.between(1.1, 1.5),
        ("terrain_change", _) => return None,
        _ => match parameter.prior {
            Prior::Normal { mean, deviation } => {
                place * (mean + 0.7 * deviation * random.normal().clamp(-1.5, 1.5))
            }
            Prior::LogNormal { median, deviation } => {
                place * median * (0.5 * deviation * random.normal().clamp(-1.5, 1.5)).exp()
            }
        },
    })
}
