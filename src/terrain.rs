//! Soil parameters of the Bekker–Janosi model, and the four terrains of the paper.

use crate::parameter::{Bounds, ParameterError};

/// The soil under the wheels (Table I of the paper).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terrain {
    /// Cohesion c \[Pa\].
    pub cohesion: f64,
    /// Angle of internal friction phi \[rad\].
    pub friction_angle: f64,
    /// Cohesive modulus of the pressure-sinkage law k_c \[N/m^(n+1)\].
    pub cohesive_modulus: f64,
    /// Frictional modulus of the pressure-sinkage law k_phi \[N/m^(n+2)\].
    pub frictional_modulus: f64,
    /// Sinkage exponent n \[-\].
    pub sinkage_exponent: f64,
    /// Shear deformation modulus K \[m\].
    pub shear_modulus: f64,
}

/// Bounds of each soil parameter; the angle in degrees, as users write it. Angles above 60 deg, which no soil has, would
/// pull a wheel with more than 1.7 times its load: the load transfer of most vehicles has no balance with that.
const COHESION: Bounds = Bounds::closed("cohesion", "Pa", 0.0, 1e8);
const FRICTION_ANGLE: Bounds = Bounds::closed("friction_angle_deg", "deg", 0.0, 60.0);
const COHESIVE_MODULUS: Bounds = Bounds::closed("cohesive_modulus", "N/m^(n+1)", -1e9, 1e12);
const FRICTIONAL_MODULUS: Bounds = Bounds::closed("frictional_modulus", "N/m^(n+2)", 0.0, 1e12);
const SINKAGE_EXPONENT: Bounds = Bounds::open_low("sinkage_exponent", "1", 0.0, 3.0);
const SHEAR_MODULUS: Bounds = Bounds::open_low("shear_modulus", "m", 0.0, 1.0);

impl Terrain {
    /// Refuses values that describe no soil.
    ///
    /// # Errors
    /// The first parameter that is not finite or lies outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        COHESION.check(self.cohesion)?;
        FRICTION_ANGLE.check(self.friction_angle.to_degrees())?;
        COHESIVE_MODULUS.check(self.cohesive_modulus)?;
        FRICTIONAL_MODULUS.check(self.frictional_modulus)?;
        SINKAGE_EXPONENT.check(self.sinkage_exponent)?;
        SHEAR_MODULUS.check(self.shear_modulus)
    }

    /// Number of soil parameters.
    pub const COUNT: usize = 6;

    /// The soil parameters in the order of the fields.
    #[must_use]
    pub fn to_array(self) -> [f64; Self::COUNT] {
        [
            self.cohesion,
            self.friction_angle,
            self.cohesive_modulus,
            self.frictional_modulus,
            self.sinkage_exponent,
            self.shear_modulus,
        ]
    }

    /// Sinkage modulus k = k_c / b + k_phi \[N/m^(n+2)\] under a wheel of width b \[m\] (1).
    #[must_use]
    pub fn sinkage_modulus(&self, wheel_width: f64) -> f64 {
        self.cohesive_modulus / wheel_width + self.frictional_modulus
    }
}
