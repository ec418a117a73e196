//! A wheel's soil, generic over the scalar, as effects change it.

use crate::scalar::{Elementary, Scalar};
use crate::terrain::Terrain;

/// Soil parameters under one wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Soil<S> {
    /// Cohesion c \[Pa\].
    pub cohesion: S,
    /// tan phi.
    pub friction: S,
    /// Sinkage modulus k = k_c / b + k_phi \[N/m^(n+2)\] (1).
    pub modulus: S,
    /// Sinkage exponent n \[-\].
    pub exponent: S,
    /// Shear deformation modulus K \[m\].
    pub shear_modulus: S,
}

impl<S: Scalar> Soil<S> {
    /// From a terrain's parameters in the order of [`Terrain`]'s fields, for a wheel of width
    /// `width` \[m\].
    pub(crate) fn from_terrain(parameters: &[S; Terrain::COUNT], width: S) -> Self {
        let [
            cohesion,
            friction_angle,
            cohesive,
            frictional,
            exponent,
            shear_modulus,
        ] = *parameters;
        Self {
            cohesion,
            friction: friction_angle.tan(),
            modulus: cohesive / width + frictional,
            exponent,
            shear_modulus,
        }
    }
}
