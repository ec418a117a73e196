//! A sensor mounted askew.

use super::declaration::effect;

effect! {
    /// The heading is reported with a constant offset.
    HeadingOffset: "heading_offset", Sensors,
    phrase "a heading that is turned",
    lifts "perfect measurement: the sensor's axis is the vehicle's",
    equation "reported = psi + offset",
    source "definition",
    {
        offset ["rad"] -0.8..0.8, off 0.0, normal(0.0, 0.05), "Offset, counter-clockwise";
    }
}
