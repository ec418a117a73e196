//! Soil that resists faster motion more.

use super::declaration::effect;

effect! {
    /// Viscous resistance of wet soil, shared evenly by the wheels.
    ///
    /// Each of N wheels adds -c_x V_X / N and -c_y V_Y / N at its place, so that the lateral part
    /// resists turning too.
    RateDependentSoil: "rate_dependent_soil", Wheels,
    phrase "soil that resists in proportion to the speed",
    lifts "stresses independent of the speed",
    equation "F_Xi += -c_x V_Xi / N, F_Yi += -c_y V_Yi / N",
    source "linearised rate effect of saturated soils; cf. Grahn, J. Terramechanics 28 (1991), on the rate dependence of the pressure-sinkage law",
    check "Check whether the ground was wet, and drive the same straight slowly and fast.",
    formulas differ,
    {
        forward ["N s/m"] 0.0..5000.0, off 0.0, lognormal(80.0, 1.0), "Coefficient c_x of the whole vehicle";
        lateral ["N s/m"] 0.0..10000.0, off 0.0, lognormal(150.0, 1.0), "Coefficient c_y of the whole vehicle";
    }
}
