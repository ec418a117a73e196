//! The parameters of soil, vehicle and effects as the fit sees them: with scale and prior.
//!
//! The soil's priors are those of [`USUAL_SOIL`]. They are wide on purpose: they keep the fit away from nonsense where
//! the data say nothing, and give way where the data say something. Effects bring their own.

use super::parameter::{ActsBy, FreeParameter, Prior, Scale};
use crate::effects;
use crate::spelling::nearest;
use crate::vehicle::{self, Specification, USUAL_SOIL};
use std::fmt;

/// Prior and range of a parameter of soil or vehicle; the vehicle's are centred where the
/// vehicle's own values are.
struct Entry {
    name: &'static str,
    scale: Scale,
    acts_by: ActsBy,
    /// Median of the prior; `None` for the value that the fit was given.
    median: Option<f64>,
    deviation: f64,
    range: (f64, f64),
}

const fn soil(
    name: &'static str,
    usual: effects::Prior,
    range: (f64, f64),
    acts_by: ActsBy,
) -> Entry {
    let (scale, median, deviation) = match usual {
        effects::Prior::Normal { mean, deviation } => (Scale::Linear, mean, deviation),
        effects::Prior::LogNormal { median, deviation } => (Scale::Log, median, deviation),
    };
    Entry {
        name,
        scale,
        acts_by,
        median: Some(median),
        deviation,
        range,
    }
}

const fn body(name: &'static str, deviation: f64, range: (f64, f64)) -> Entry {
    Entry {
        name,
        scale: Scale::Log,
        acts_by: ActsBy::Coordinate,
        median: None,
        deviation,
        range,
    }
}

const ENTRIES: [Entry; 12] = [
    soil("cohesion", USUAL_SOIL[0], (1.0, 1e6), ActsBy::Value),
    soil(
        "friction_angle",
        USUAL_SOIL[1],
        (0.005, 1.0),
        ActsBy::Tangent,
    ),
    soil(
        "cohesive_modulus",
        USUAL_SOIL[2],
        (1.0, 1e8),
        ActsBy::Coordinate,
    ),
    soil(
        "frictional_modulus",
        USUAL_SOIL[3],
        (1e4, 1e9),
        ActsBy::Coordinate,
    ),
    soil(
        "sinkage_exponent",
        USUAL_SOIL[4],
        (0.05, 2.0),
        ActsBy::Value,
    ),
    soil(
        "shear_modulus",
        USUAL_SOIL[5],
        (5e-4, 0.3),
        ActsBy::Coordinate,
    ),
    body("mass", 0.15, (1.0, 1e6)),
    body("yaw_inertia", 0.4, (0.1, 1e7)),
    body("wheel_radius", 0.05, (0.02, 3.0)),
    body("half_track", 0.05, (0.05, 5.0)),
    Entry {
        scale: Scale::Linear,
        ..body("com_offset", 0.1, (-2.0, 2.0))
    },
    body("com_height", 0.3, (0.01, 5.0)),
];

/// What is fitted by default. The cohesive modulus is not among them:
/// wheels of one width feel only k = k_c / b + k_phi (1).
pub const DEFAULT_FREE: [&str; 5] = [
    "cohesion",
    "friction_angle",
    "frictional_modulus",
    "sinkage_exponent",
    "shear_modulus",
];

/// A name that no parameter has, or none that can be fitted.
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

/// All parameters that can be fitted. Sensors' are not among them: they are each recording's
/// own, see [`super::sensor`].
pub fn all() -> impl Iterator<Item = vehicle::ModelParameter> {
    vehicle::ModelParameter::all().filter(|parameter| parameter.is_physics())
}

/// The parameter of a name, with or without `terrain.` or `vehicle.` before it.
///
/// # Errors
/// A name that no parameter has, with the nearest one.
pub fn find(name: &str) -> Result<vehicle::ModelParameter, UnknownParameter> {
    let own = ["terrain.", "vehicle."];
    let short = own
        .iter()
        .find_map(|prefix| name.strip_prefix(prefix))
        .unwrap_or(name);
    all()
        .find(|parameter| parameter.name() == short)
        .ok_or_else(|| {
            let names: Vec<String> = all().map(vehicle::ModelParameter::name).collect();
            let nearest = nearest(short, names.iter().map(String::as_str));
            UnknownParameter {
                name: name.into(),
                nearest: nearest.unwrap_or_default().into(),
            }
        })
}

/// Scale, prior and range of a parameter.
#[must_use]
pub fn describe(parameter: vehicle::ModelParameter, nominal: &Specification) -> FreeParameter {
    let name = parameter.name();
    if let vehicle::ModelParameter::Effect(effect) = parameter {
        return describe_effect(name, effect.declaration().1);
    }
    let entry = ENTRIES.iter().find(|entry| entry.name == name);
    let entry = entry.expect("a test looks up every parameter");
    FreeParameter {
        name,
        unit: parameter.unit(),
        scale: entry.scale,
        acts_by: entry.acts_by,
        prior: Prior {
            // A vehicle may have less than the scale reaches: a centre of mass on the ground.
            median: entry
                .median
                .unwrap_or_else(|| parameter.get(nominal))
                .clamp(entry.range.0, entry.range.1),
            deviation: entry.deviation,
        },
        low: entry.range.0,
        high: entry.range.1,
    }
}

/// An effect that works by a factor has a logarithmic scale, which does not reach "off": the
/// scale ends far below anything that matters.
pub(super) fn describe_effect(
    name: String,
    declared: &effects::ParameterDeclaration,
) -> FreeParameter {
    const FAR: f64 = 5.0;
    let (scale, median, deviation, low) = match declared.prior {
        effects::Prior::Normal { mean, deviation } => {
            (Scale::Linear, mean, deviation, declared.low)
        }
        effects::Prior::LogNormal { median, deviation } => {
            let least = median * (-FAR * deviation).exp();
            (Scale::Log, median, deviation, declared.low.max(least))
        }
    };
    FreeParameter {
        name,
        unit: declared.unit,
        scale,
        acts_by: ActsBy::Coordinate,
        prior: Prior { median, deviation },
        low,
        high: declared.high,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::Terrain;
    use crate::vehicle::Vehicle;

    fn nominal(terrain: &str) -> Specification {
        Specification::plain(Vehicle::tran2007(), Terrain::preset(terrain).unwrap())
    }

    #[test]
    fn every_parameter_is_described_and_found() {
        let nominal = nominal("dry_sand");
        for parameter in all() {
            let described = describe(parameter, &nominal);
            assert_eq!(find(&described.name), Ok(parameter));
            let (low, high) = described.bounds();
            assert!(low.is_finite() && low < high, "{described:?}");
            assert!(described.prior.deviation > 0.0);
        }
        assert_eq!(find("terrain.cohesion"), find("cohesion"));
        assert_eq!(find("cohesoin").unwrap_err().nearest, "cohesion");
        assert!(find("latency.pose").is_err());
    }

    #[test]
    fn every_preset_is_within_the_priors() {
        for name in Terrain::PRESETS {
            let nominal = nominal(name);
            for parameter in all().take(12) {
                let described = describe(parameter, &nominal);
                let at = described.coordinate(parameter.get(&nominal));
                let off = (at - described.prior_coordinate()) / described.prior.deviation;
                // Dry clay's exponent of 0.13 is the farthest.
                assert!(off.abs() < 2.6, "{name} {} {off}", described.name);
            }
        }
    }
}
