//! What a model is made of, and each of its numbers by name.

use super::Vehicle;
use crate::effects::{
    Drag, Drawbar, Effects, Grade, Kind, ParameterName, ResidualLateral, ResidualLongitudinal,
    ResidualYaw, TerrainChange,
};
use crate::parameter::ParameterError;
use crate::terrain::Terrain;

/// A vehicle, the ground under it, and the effects besides the paper's physics.
#[derive(Debug, Clone, PartialEq)]
pub struct Specification {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// The soil.
    pub terrain: Terrain,
    /// What the paper leaves out.
    pub effects: Effects,
}

/// One number of a [`Specification`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Of the vehicle, in the order of [`Parameter::VEHICLE`].
    Vehicle(usize),
    /// Of the soil, in the order of [`Terrain`]'s fields.
    Terrain(usize),
    /// Of an effect.
    Effect(ParameterName),
}

impl Parameter {
    /// Names and units of the vehicle's numbers (its rows and the wheel width have none here: a
    /// sensitivity by them is not offered).
    pub const VEHICLE: [(&'static str, &'static str); 6] = [
        ("mass", "kg"),
        ("yaw_inertia", "kg m^2"),
        ("wheel_radius", "m"),
        ("half_track", "m"),
        ("com_offset", "m"),
        ("com_height", "m"),
    ];
    /// Names and units of the soil's numbers.
    pub const TERRAIN: [(&'static str, &'static str); Terrain::COUNT] = [
        ("cohesion", "Pa"),
        ("friction_angle", "rad"),
        ("cohesive_modulus", "N/m^(n+1)"),
        ("frictional_modulus", "N/m^(n+2)"),
        ("sinkage_exponent", "1"),
        ("shear_modulus", "m"),
    ];

    /// All parameters: the soil's, the vehicle's, the effects'.
    pub fn all() -> impl Iterator<Item = Self> {
        let terrain = (0..Self::TERRAIN.len()).map(Self::Terrain);
        let vehicle = (0..Self::VEHICLE.len()).map(Self::Vehicle);
        terrain
            .chain(vehicle)
            .chain(ParameterName::all().map(Self::Effect))
    }

    /// Name in files and on the command line: `cohesion`, `mass`, `grade.slope_east`.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Vehicle(index) => Self::VEHICLE[index].0.into(),
            Self::Terrain(index) => Self::TERRAIN[index].0.into(),
            Self::Effect(parameter) => parameter.full_name(),
        }
    }

    /// Unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Vehicle(index) => Self::VEHICLE[index].1,
            Self::Terrain(index) => Self::TERRAIN[index].1,
            Self::Effect(parameter) => parameter.declaration().1.unit,
        }
    }

    /// The parameter of a name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|parameter| parameter.name() == name)
    }

    /// Its value in a specification.
    #[must_use]
    pub fn get(self, specification: &Specification) -> f64 {
        match self {
            Self::Effect(parameter) => specification.effects.get(parameter),
            _ => *self
                .slot(&mut specification.clone())
                .expect("not an effect's"),
        }
    }

    /// Sets its value, which for the vehicle and the soil is checked when a model is made.
    ///
    /// # Errors
    /// A value outside the range of an effect's parameter.
    pub fn set(self, specification: &mut Specification, value: f64) -> Result<(), ParameterError> {
        match self {
            Self::Effect(parameter) => specification.effects.set(parameter, value),
            _ => {
                if let Some(slot) = self.slot(specification) {
                    *slot = value;
                }
                Ok(())
            }
        }
    }

    fn slot(self, specification: &mut Specification) -> Option<&mut f64> {
        let Specification {
            vehicle, terrain, ..
        } = specification;
        Some(match self {
            Self::Vehicle(0) => &mut vehicle.mass,
            Self::Vehicle(1) => &mut vehicle.yaw_inertia,
            Self::Vehicle(2) => &mut vehicle.wheel_radius,
            Self::Vehicle(3) => &mut vehicle.half_track,
            Self::Vehicle(4) => &mut vehicle.com_offset,
            Self::Vehicle(_) => &mut vehicle.com_height,
            Self::Terrain(0) => &mut terrain.cohesion,
            Self::Terrain(1) => &mut terrain.friction_angle,
            Self::Terrain(2) => &mut terrain.cohesive_modulus,
            Self::Terrain(3) => &mut terrain.frictional_modulus,
            Self::Terrain(4) => &mut terrain.sinkage_exponent,
            Self::Terrain(_) => &mut terrain.shear_modulus,
            Self::Effect(_) => return None,
        })
    }

    /// Whether forces that it scales depend on position or heading.
    pub(crate) fn depends_on_place(self) -> bool {
        let Self::Effect(parameter) = self else {
            return false;
        };
        let (effect, declared) = parameter.declaration();
        let of_one = |names: &[&str]| names.contains(&effect.name);
        // Of a law without a name only what points somewhere on the map.
        of_one(&[
            Grade::<f64>::DECLARATION.name,
            TerrainChange::<f64>::DECLARATION.name,
        ]) || of_one(&[
            ResidualLongitudinal::<f64>::DECLARATION.name,
            ResidualLateral::<f64>::DECLARATION.name,
            ResidualYaw::<f64>::DECLARATION.name,
        ]) && ["east", "north"].contains(&declared.name)
    }

    /// Whether it belongs to an effect that acts on the vehicle's body alone: gravity on a slope,
    /// drag, what is towed, laws without a name.
    pub(crate) fn acts_on_body(self) -> bool {
        const BODY: [&str; 6] = [
            Grade::<f64>::DECLARATION.name,
            Drag::<f64>::DECLARATION.name,
            Drawbar::<f64>::DECLARATION.name,
            ResidualLongitudinal::<f64>::DECLARATION.name,
            ResidualLateral::<f64>::DECLARATION.name,
            ResidualYaw::<f64>::DECLARATION.name,
        ];
        self.is_of(&BODY)
    }

    /// Whether it belongs to an effect by which the soil under a wheel depends on its place.
    pub(crate) fn changes_soil_by_place(self) -> bool {
        self.is_of(&[TerrainChange::<f64>::DECLARATION.name])
    }

    fn is_of(self, effects: &[&str]) -> bool {
        match self {
            Self::Effect(parameter) => effects.contains(&parameter.declaration().0.name),
            _ => false,
        }
    }

    /// Whether it belongs to an effect that changes how the vehicle moves (or to vehicle or soil),
    /// not to a sensor.
    #[must_use]
    pub fn is_physics(self) -> bool {
        match self {
            Self::Effect(parameter) => {
                parameter.declaration().0.kind == crate::effects::Kind::Physics
            }
            _ => true,
        }
    }
}

impl Specification {
    /// A vehicle on a terrain, with the paper's physics alone.
    #[must_use]
    pub fn plain(vehicle: Vehicle, terrain: Terrain) -> Self {
        Self {
            vehicle,
            terrain,
            effects: Effects::NONE,
        }
    }

    /// Names of the effects that are on.
    #[must_use]
    pub fn effect_names(&self) -> Vec<&'static str> {
        let kinds = [Kind::Physics, Kind::Measurement];
        let on = kinds.into_iter().flat_map(|kind| self.effects.on(kind));
        on.map(|effect| effect.name).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_is_found_by_its_name_and_read_back() {
        let mut specification =
            Specification::plain(Vehicle::tran2007(), Terrain::preset("dry_sand").unwrap());
        for parameter in Parameter::all() {
            assert_eq!(Parameter::find(&parameter.name()), Some(parameter));
            assert!(!parameter.unit().is_empty());
            let value = parameter.get(&specification) * 0.99;
            parameter.set(&mut specification, value).unwrap();
            assert_eq!(parameter.get(&specification), value);
        }
        assert_eq!(Parameter::find("cohesio"), None);
        assert!(Parameter::find("mass").unwrap().is_physics());
        assert!(!Parameter::find("latency.pose").unwrap().is_physics());
    }

    #[test]
    fn what_points_somewhere_on_the_map_depends_on_the_place() {
        let placed = |name: &str| Parameter::find(name).unwrap().depends_on_place();
        for name in ["grade.slope_east", "terrain_change.position"] {
            assert!(placed(name), "{name}");
        }
        for law in ["residual_longitudinal", "residual_lateral", "residual_yaw"] {
            assert!(placed(&format!("{law}.east")) && placed(&format!("{law}.north")));
            assert!(!placed(&format!("{law}.constant")));
        }
        assert!(!placed("mass") && !placed("drawbar.force"));
    }
}
