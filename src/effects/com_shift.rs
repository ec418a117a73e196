//! A centre of mass that is not where the data sheet has it.

use super::declaration::effect;

effect! {
    /// The centre of mass lies ahead of, or beside, the one that the vehicle's parameters give.
    ///
    /// The position, heading and velocities stay those of the point where it was thought to be.
    ComShift: "com_shift", Wheels,
    phrase "a shifted centre of mass",
    lifts "known centre of mass",
    equation "X_i, Y_i in the loads and moments less the shift; a at the reference point by rigid-body kinematics",
    source "rigid-body mechanics",
    check "Weigh the vehicle wheel by wheel, and compare the centre of mass with that of the vehicle file.",
    class Weight,
    {
        ahead ["m"] -1.0..1.0, off 0.0, normal(0.0, 0.1), "Shift ahead";
        left ["m"] -1.0..1.0, off 0.0, normal(0.0, 0.05), "Shift to the left";
    }
}
