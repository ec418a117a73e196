//! Another mass on board.

use super::declaration::effect;

effect! {
    /// A payload: mass, centre of mass and yaw inertia change by the parallel-axis rule.
    ///
    /// The position, heading and velocities stay those of the vehicle's own centre of mass.
    Payload: "payload", Wheels,
    phrase "an added load",
    lifts "known mass, inertia and centre of mass",
    equation "m += m_p; centre of mass at sum m x / sum m; I_Z about it by the parallel-axis rule",
    source "rigid-body mechanics",
    check "Weigh the vehicle as it was driven, and note what it carried and where.",
    class Weight,
    {
        mass ["kg"] 0.0..1e5, off 0.0, lognormal(50.0, 0.9), "Mass m_p";
        ahead ["m"] -20.0..20.0, shape 0.0, normal(0.0, 0.4), "Its place ahead of the centroid", estimated;
        left ["m"] -10.0..10.0, shape 0.0, normal(0.0, 0.3), "Its place to the left of the centroid", estimated;
        height ["m"] 0.0..10.0, shape 0.5, normal(0.5, 0.2), "Its height above the ground";
    }
}
