//! A sensor mounted askew.

use super::declaration::effect;

effect! {
    /// The heading is reported with a constant offset.
    HeadingOffset: "heading_offset", Sensors,
    phrase "a heading that is turned",
    lifts "perfect measurement: the sensor's axis is the vehicle's",
    equation "reported = psi + offset",
    source "definition",
    check "Check the mount of the heading sensor against the vehicle's axis, and its zero against east.",
    {
        offset ["rad"] -0.8..0.8, off 0.0, normal(0.0, 0.05), "Offset, counter-clockwise";
    }
}
