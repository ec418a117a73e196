//! Shear that differs between the wheel's two directions.

use super::declaration::effect;

effect! {
    /// Across the wheel the soil needs another displacement to be sheared, and resists differently.
    ///
    /// Grousers and treads shear soil against soil along the wheel, while its flanks slide.
    ShearAnisotropy: "shear_anisotropy", Wheels,
    phrase "soil that shears differently along and across the wheel",
    lifts "one K, and one strength, in all directions",
    equation "tau = tau_max (1 - exp(-sqrt((j_X^2 + j_Z^2)/K_X^2 + j_Y^2/K_Y^2))); tau_Y times the strength ratio; K_X = K",
    source "elliptic form of Janosi & Hanamoto, as in Wong, Theory of Ground Vehicles, ch. 2, and Schwanghart, J. Terramechanics 5 (1968), for K_Y /= K_X",
    check "Look at the treads: grousers and lugs shear the soil along the wheel, while its flanks slide.",
    formulas differ,
    {
        modulus_ratio ["1"] 0.3..3.0, off 1.0, lognormal(1.0, 0.4), "K_Y / K_X";
        strength_ratio ["1"] 0.5..2.0, off 1.0, lognormal(1.0, 0.2), "Strength across the wheel over the strength along it";
    }
}
