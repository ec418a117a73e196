//! The parameters of soil and vehicle that can be fitted, with their priors.
//!
//! The priors span the mineral soils, from snow and soft sand to asphalt, of which J. Y. Wong,
//! "Theory of Ground Vehicles" (2001), tables 2.3 and 2.4, and Table I of the paper are the
//! firm middle. They are wide on purpose: they keep the fit away from nonsense where the data
//! say nothing, and give way where the data say something.

use super::parameter::{Parameter, Prior, Scale};
use crate::spelling::nearest;
use crate::terrain::Terrain;
use crate::vehicle::Vehicle;
use std::fmt;

/// A parameter of the model with its access.
#[derive(Debug, Clone, Copy)]
struct Entry {
    name: &'static str,
    unit: &'static str,
    scale: Scale,
    /// Median of the prior; `None` for the value that the fit was given.
    median: Option<f64>,
    deviation: f64,
    range: (f64, f64),
    access: Access,
}

#[derive(Debug, Clone, Copy)]
enum Access {
    Terrain(fn(&mut Terrain) -> &mut f64),
    Vehicle(fn(&mut Vehicle) -> &mut f64),
}

const fn soil(
    name: &'static str,
    unit: &'static str,
    (median, deviation): (f64, f64),
    range: (f64, f64),
    access: fn(&mut Terrain) -> &mut f64,
) -> Entry {
    Entry {
        name,
        unit,
        scale: Scale::Log,
        median: Some(median),
        deviation,
        range,
        access: Access::Terrain(access),
    }
}

const fn body(
    name: &'static str,
    unit: &'static str,
    deviation: f64,
    range: (f64, f64),
    access: fn(&mut Vehicle) -> &mut f64,
) -> Entry {
    Entry {
        name,
        unit,
        scale: Scale::Log,
        median: None,
        deviation,
        range,
        access: Access::Vehicle(access),
    }
}

const ENTRIES: [Entry; 12] = [
    soil("terrain.cohesion", "Pa", (3e3, 1.5), (1.0, 1e6), |t| {
        &mut t.cohesion
    }),
    Entry {
        scale: Scale::Linear,
        ..soil(
            "terrain.friction_angle",
            "rad",
            (0.45, 0.2),
            (0.005, 1.0),
            |t| &mut t.friction_angle,
        )
    },
    soil(
        "terrain.cohesive_modulus",
        "N/m^(n+1)",
        (1e4, 1.5),
        (1.0, 1e8),
        |t| &mut t.cohesive_modulus,
    ),
    soil(
        "terrain.frictional_modulus",
        "N/m^(n+2)",
        (1.2e6, 1.2),
        (1e4, 1e9),
        |t| &mut t.frictional_modulus,
    ),
    soil(
        "terrain.sinkage_exponent",
        "1",
        (0.6, 0.6),
        (0.05, 2.0),
        |t| &mut t.sinkage_exponent,
    ),
    soil("terrain.shear_modulus", "m", (0.012, 0.8), (5e-4, 0.3), |t| {
        &mut t.shear_modulus
    }),
    body("vehicle.mass", "kg", 0.15, (1.0, 1e6), |v| &mut v.mass),
    body("vehicle.yaw_inertia", "kg m^2", 0.4, (0.1, 1e7), |v| {
        &mut v.yaw_inertia
    }),
    body("vehicle.wheel_radius", "m", 0.05, (0.02, 3.0), |v| {
        &mut v.wheel_radius
    }),
    body("vehicle.half_track", "m", 0.05, (0.05, 5.0), |v| {
        &mut v.half_track
    }),
    Entry {
        scale: Scale::Linear,
        ..body("vehicle.com_offset", "m", 0.1, (-2.0, 2.0), |v| {
            &mut v.com_offset
        })
    },
    body("vehicle.com_height", "m", 0.3, (0.01, 5.0), |v| {
        &mut v.com_height
    }),
];

/// What is fitted unless the user says otherwise. The cohesive modulus is not among them:
/// wheels of one width feel only k = k_c / b + k_phi (1).
pub const DEFAULT_FREE: [&str; 5] = [
    "terrain.cohesion",
    "terrain.friction_angle",
    "terrain.frictional_modulus",
    "terrain.sinkage_exponent",
    "terrain.shear_modulus",
];

/// A vehicle on a terrain.
#[derive(Debug, Clone, PartialEq)]
pub struct Nominal {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The soil.
    pub terrain: Terrain,
}

/// A name that no parameter has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownParameter {
    /// What was asked for.
    pub name: String,
    /// The nearest parameter.
    pub nearest: String,
}

impl fmt::Display for UnknownParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "there is no parameter `{}`", self.name)
    }
}

impl std::error::Error for UnknownParameter {}

/// Names, units and typical ranges of all parameters of the model.
#[must_use]
pub fn all(nominal: &Nominal) -> Vec<Parameter> {
    let entries = 0..ENTRIES.len();
    entries.map(|index| parameter(index, nominal)).collect()
}

/// A parameter's place in the catalogue, by its full name or by what follows the dot.
///
/// # Errors
/// A name that no parameter has, with the nearest one.
pub fn find(name: &str) -> Result<usize, UnknownParameter> {
    let short = |entry: &Entry| entry.name.split_once('.').map(|(_, short)| short);
    let found = ENTRIES
        .iter()
        .position(|entry| entry.name == name || short(entry) == Some(name));
    found.ok_or_else(|| {
        let names = ENTRIES.iter().flat_map(|e| [Some(e.name), short(e)]);
        UnknownParameter {
            name: name.into(),
            nearest: nearest(name, names.flatten()).unwrap_or_default().into(),
        }
    })
}

/// The parameter at a place of the catalogue.
#[must_use]
pub fn parameter(index: usize, nominal: &Nominal) -> Parameter {
    let entry = &ENTRIES[index];
    let median = entry.median.unwrap_or_else(|| get(index, nominal));
    Parameter {
        name: entry.name.into(),
        unit: entry.unit,
        scale: entry.scale,
        prior: Prior {
            median,
            deviation: entry.deviation,
        },
        low: entry.range.0,
        high: entry.range.1,
    }
}

/// The value of the parameter at a place of the catalogue.
#[must_use]
pub fn get(index: usize, nominal: &Nominal) -> f64 {
    match ENTRIES[index].access {
        Access::Terrain(access) => *access(&mut nominal.terrain.clone()),
        Access::Vehicle(access) => *access(&mut nominal.vehicle.clone()),
    }
}

/// Gives the parameter at a place of the catalogue another value.
pub fn set(index: usize, nominal: &mut Nominal, value: f64) {
    match ENTRIES[index].access {
        Access::Terrain(access) => *access(&mut nominal.terrain) = value,
        Access::Vehicle(access) => *access(&mut nominal.vehicle) = value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_long_or_short() {
        for (index, entry) in ENTRIES.iter().enumerate() {
            assert_eq!(find(entry.name), Ok(index));
            assert_eq!(find(entry.name.split_once('.').unwrap().1), Ok(index));
        }
        let unknown = find("cohesoin").unwrap_err();
        assert_eq!(unknown.nearest, "cohesion");
    }

    #[test]
    fn every_preset_is_within_the_priors() {
        for name in Terrain::PRESETS {
            let nominal = Nominal {
                vehicle: Vehicle::tran2007(),
                terrain: Terrain::preset(name).unwrap(),
            };
            for (index, parameter) in all(&nominal).iter().enumerate() {
                let at = parameter.coordinate(get(index, &nominal));
                let off = (at - parameter.prior_coordinate()) / parameter.prior.deviation;
                // Dry clay's exponent of 0.13 is the farthest.
                assert!(off.abs() < 2.6, "{name} {} {off}", parameter.name);
            }
        }
    }

    #[test]
    fn values_come_back_as_they_were_set() {
        let mut nominal = Nominal {
            vehicle: Vehicle::tran2007(),
            terrain: Terrain::preset("dry_sand").unwrap(),
        };
        for index in 0..ENTRIES.len() {
            set(index, &mut nominal, 0.125 * (index + 1) as f64);
        }
        for index in 0..ENTRIES.len() {
            assert_eq!(get(index, &nominal), 0.125 * (index + 1) as f64);
        }
    }
}
