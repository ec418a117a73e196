//! Worn or soft tyres.

use super::declaration::effect;

effect! {
    /// The wheels of a side are smaller or larger than known. An encoder that counts a wrong number
    /// of ticks per turn looks the same (but for the sinkage), and cannot be distinguished from it.
    WheelRadius: "wheel_radius", Wheels,
    phrase "wheels of another radius",
    lifts "known wheel radius, equal on both sides",
    equation "r times the side's factor: in r omega, and in the contact",
    source "geometry",
    check "Measure how far each side rolls in ten turns, and check the encoders' ticks per turn and the gear ratio.",
    class RollingRadius,
    {
        left ["1"] 0.8..1.1, off 1.0, normal(1.0, 0.03), "Factor of the left wheels";
        right ["1"] 0.8..1.1, off 1.0, normal(1.0, 0.03), "Factor of the right wheels";
    }
}
