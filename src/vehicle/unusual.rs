//! Which parameter of a model is farthest from what such parameters usually are: the first to doubt where a model is
//! hardly drivable.

use super::{Specification, TerrainParameter, VehicleModel};
use crate::effects::{ParameterName, Prior};
use crate::terrain::Terrain;
use std::fmt;

/// A parameter far outside its usual values.
#[derive(Debug, Clone, PartialEq)]
pub struct Unusual {
    /// Its name in files.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Usual values: three standard deviations to both sides.
    pub usual: [f64; 2],
}

impl fmt::Display for Unusual {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            value,
            unit,
            usual: [low, high],
        } = self;
        let unit = if *unit == "1" { "" } else { unit };
        let text = format!("{name} = {value:.4e} {unit}");
        write!(
            f,
            "{} (usual: {} to {})",
            text.trim_end(),
            short(*low),
            short(*high)
        )
    }
}

/// Three digits.
fn short(value: f64) -> String {
    if value != 0.0 && !(1e-2..1e4).contains(&value.abs()) {
        format!("{value:.1e}")
    } else {
        format!("{value:.3}")
    }
}

/// What is usual of each soil parameter, in the order of [`TerrainParameter::ALL`].
///
/// The priors span the mineral soils, from snow and soft sand to asphalt, of which J. Y. Wong, "Theory of Ground
/// Vehicles" (2001), tables 2.3 and 2.4, and Table I of the paper are the firm middle.
pub const USUAL_SOIL: [Prior; Terrain::COUNT] = [
    Prior::LogNormal {
        median: 3e3,
        deviation: 1.5,
    },
    Prior::Normal {
        mean: 0.45,
        deviation: 0.2,
    },
    Prior::LogNormal {
        median: 1e4,
        deviation: 1.5,
    },
    Prior::LogNormal {
        median: 1.2e6,
        deviation: 1.2,
    },
    Prior::LogNormal {
        median: 0.6,
        deviation: 0.6,
    },
    Prior::LogNormal {
        median: 0.012,
        deviation: 0.8,
    },
];

/// Standard deviations from the mean beyond which a value is unusual.
const USUAL_DEVIATIONS: f64 = 3.0;

/// How many deviations a value lies from the middle, and the usual values.
fn rate(prior: Prior, value: f64) -> (f64, [f64; 2]) {
    match prior {
        Prior::Normal { mean, deviation } => (
            (value - mean).abs() / deviation,
            [-1.0, 1.0].map(|side| mean + side * USUAL_DEVIATIONS * deviation),
        ),
        Prior::LogNormal { median, deviation } => (
            // Nothing at all is usual: of cohesion, of an effect that is off.
            if value > 0.0 {
                (value / median).ln().abs() / deviation
            } else {
                0.0
            },
            [-1.0, 1.0].map(|side| median * (side * USUAL_DEVIATIONS * deviation).exp()),
        ),
    }
}

impl Specification {
    /// The soil's or switched-on effect's parameter that is farthest from its usual values, if one is outside of them.
    #[must_use]
    pub fn most_unusual(&self) -> Option<Unusual> {
        unusual(&self.terrain, &mut self.effect_values())
    }

    fn effect_values(&self) -> impl Iterator<Item = (ParameterName, f64)> {
        let on = ParameterName::all().filter(|name| self.effects.is_on(name.effect()));
        on.map(|name| (name, self.effects.get(name)))
    }
}

impl VehicleModel {
    /// As [`Specification::most_unusual`].
    #[must_use]
    pub fn most_unusual(&self) -> Option<Unusual> {
        self.specification().most_unusual()
    }
}

fn unusual(
    terrain: &Terrain,
    effects: &mut dyn Iterator<Item = (ParameterName, f64)>,
) -> Option<Unusual> {
    let soil = TerrainParameter::ALL.iter().zip(terrain.to_array());
    let soil = soil.zip(USUAL_SOIL).map(|((parameter, value), prior)| {
        let (far, usual) = rate(prior, value);
        let (name, unit) = (parameter.name().to_owned(), parameter.unit());
        (
            far,
            Unusual {
                name,
                value,
                unit,
                usual,
            },
        )
    });
    // Those that only shape an effect, as places do, make no drive stiff.
    let effects = effects.filter(|(name, _)| name.declaration().1.switches);
    let effects = effects.map(|(name, value)| {
        let (_, declared) = name.declaration();
        let (far, usual) = rate(declared.prior, value);
        let (name, unit) = (name.full_name(), declared.unit);
        (
            far,
            Unusual {
                name,
                value,
                unit,
                usual,
            },
        )
    });
    let all = soil.chain(effects);
    let (far, first) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (far > USUAL_DEVIATIONS).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effects;
    use crate::vehicle::Vehicle;

    #[test]
    fn the_parameter_that_is_farthest_from_usual_is_named() {
        let loam = Terrain::preset("sandy_loam").unwrap();
        let mut one = Specification::plain(Vehicle::tran2007(), loam);
        assert_eq!(one.most_unusual(), None);
        one.effects = Effects::default()
            .with("transient_shear.relaxation", 1e-4)
            .unwrap();
        let found = one.most_unusual().unwrap();
        assert_eq!(found.name, "transient_shear.relaxation");
        assert_eq!(
            found.to_string(),
            "transient_shear.relaxation = 1.0000e-4 (usual: 0.301 to 3.320)"
        );
        one.terrain.friction_angle = 6.0;
        assert_eq!(one.most_unusual().unwrap().name, "friction_angle");
        one.terrain.cohesion = 0.0;
        one.terrain.friction_angle = 0.4;
        one.effects = Effects::default();
        assert_eq!(one.most_unusual(), None);
    }
}
