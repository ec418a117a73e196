//! What a model is made of, and each of its numbers by name.

use super::Vehicle;
use crate::effects::{Acts, EffectKind, Effects, ParameterName};
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
pub enum ModelParameter {
    /// Of the vehicle.
    Vehicle(VehicleParameter),
    /// Of the soil.
    Terrain(TerrainParameter),
    /// Of an effect.
    Effect(ParameterName),
}

/// Numbers of a part of a [`Specification`]: each with its name in files, unit, and field.
macro_rules! numbers {
    (
        $(#[$about:meta])* $parameter:ident of $part:ident, $count:expr;
        $($(#[$told:meta])* $variant:ident $name:literal [$unit:literal] $field:ident,)*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $parameter {
            $($(#[$told])* $variant,)*
        }

        impl $parameter {
            /// All of them.
            pub const ALL: [Self; $count] = [$(Self::$variant),*];

            /// Name in files and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// Unit.
            #[must_use]
            pub const fn unit(self) -> &'static str {
                match self {
                    $(Self::$variant => $unit,)*
                }
            }

            fn get(self, part: &$part) -> f64 {
                match self {
                    $(Self::$variant => part.$field,)*
                }
            }

            fn set(self, part: &mut $part, value: f64) {
                match self {
                    $(Self::$variant => part.$field = value,)*
                }
            }
        }
    };
}

numbers! {
    /// One number of a [`Vehicle`]. Its rows and the wheel width are none: a sensitivity by them is not offered.
    VehicleParameter of Vehicle, 6;
    /// Mass.
    Mass "mass" ["kg"] mass,
    /// Yaw inertia about the centre of mass.
    YawInertia "yaw_inertia" ["kg m^2"] yaw_inertia,
    /// Radius of the wheels.
    WheelRadius "wheel_radius" ["m"] wheel_radius,
    /// Distance of the wheels' middle from the vehicle's axis.
    HalfTrack "half_track" ["m"] half_track,
    /// Centre of mass ahead of the middle.
    ComOffset "com_offset" ["m"] com_offset,
    /// Height of the centre of mass.
    ComHeight "com_height" ["m"] com_height,
}

numbers! {
    /// One number of a [`Terrain`], in the order of its fields.
    TerrainParameter of Terrain, Terrain::COUNT;
    /// Cohesion c.
    Cohesion "cohesion" ["Pa"] cohesion,
    /// Angle of internal friction phi.
    FrictionAngle "friction_angle" ["rad"] friction_angle,
    /// Cohesive modulus k_c.
    CohesiveModulus "cohesive_modulus" ["N/m^(n+1)"] cohesive_modulus,
    /// Frictional modulus k_phi.
    FrictionalModulus "frictional_modulus" ["N/m^(n+2)"] frictional_modulus,
    /// Sinkage exponent n.
    SinkageExponent "sinkage_exponent" ["1"] sinkage_exponent,
    /// Shear deformation modulus K.
    ShearModulus "shear_modulus" ["m"] shear_modulus,
}

impl ModelParameter {
    /// All parameters: the soil's, the vehicle's, the effects'.
    pub fn all() -> impl Iterator<Item = Self> {
        let terrain = TerrainParameter::ALL.into_iter().map(Self::Terrain);
        let vehicle = VehicleParameter::ALL.into_iter().map(Self::Vehicle);
        terrain
            .chain(vehicle)
            .chain(ParameterName::all().map(Self::Effect))
    }

    /// Name in files and on the command line: `cohesion`, `mass`, `grade.slope_east`.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Vehicle(number) => number.name().into(),
            Self::Terrain(number) => number.name().into(),
            Self::Effect(parameter) => parameter.full_name(),
        }
    }

    /// Unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Vehicle(number) => number.unit(),
            Self::Terrain(number) => number.unit(),
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
            Self::Vehicle(number) => number.get(&specification.vehicle),
            Self::Terrain(number) => number.get(&specification.terrain),
            Self::Effect(parameter) => specification.effects.get(parameter),
        }
    }

    /// Sets its value, which for the vehicle and the soil is checked when a model is made.
    ///
    /// # Errors
    /// A value outside the range of an effect's parameter.
    pub fn set(self, specification: &mut Specification, value: f64) -> Result<(), ParameterError> {
        match self {
            Self::Vehicle(number) => number.set(&mut specification.vehicle, value),
            Self::Terrain(number) => number.set(&mut specification.terrain, value),
            Self::Effect(parameter) => return specification.effects.set(parameter, value),
        }
        Ok(())
    }

    /// Whether forces that it scales depend on position or heading.
    pub(crate) fn depends_on_place(self) -> bool {
        let Self::Effect(parameter) = self else {
            return false;
        };
        let (effect, declared) = parameter.declaration();
        matches!(effect.acts, Acts::Slope | Acts::SoilByPlace) || declared.on_map
    }

    /// Whether it belongs to an effect that changes how the vehicle moves (or to vehicle or soil),
    /// not to a sensor.
    #[must_use]
    pub fn is_physics(self) -> bool {
        match self {
            Self::Effect(parameter) => parameter.declaration().0.acts != Acts::Sensors,
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

    /// The same vehicle and terrain with other effects.
    #[must_use]
    pub fn with_effects(&self, effects: Effects) -> Self {
        Self {
            effects,
            ..self.clone()
        }
    }

    /// Names of the effects that are on.
    #[must_use]
    pub fn effect_names(&self) -> Vec<&'static str> {
        let kinds = [EffectKind::Physics, EffectKind::Measurement];
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
        for parameter in ModelParameter::all() {
            assert_eq!(ModelParameter::find(&parameter.name()), Some(parameter));
            assert!(!parameter.unit().is_empty());
            let value = parameter.get(&specification) * 0.99;
            parameter.set(&mut specification, value).unwrap();
            assert_eq!(parameter.get(&specification), value);
        }
        assert_eq!(ModelParameter::find("cohesio"), None);
        assert!(ModelParameter::find("mass").unwrap().is_physics());
        assert!(!ModelParameter::find("latency.pose").unwrap().is_physics());
    }

    #[test]
    fn what_points_somewhere_on_the_map_depends_on_the_place() {
        let placed = |name: &str| ModelParameter::find(name).unwrap().depends_on_place();
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
