//! A sensor mounted askew.

use super::declaration::effect;

effect! {
    /// The heading is reported with a constant offset.
    HeadingOffset: "heading_offset", Measurement,
    lifts "perfect measurement: the sensor's axis is the vehicle's",
    equation "reported = psi + offset",
    source "definition",
    {
        offset ["rad"] -0.5..0.5, off 0.0, normal(0.0, 0.03), "Offset, counter-clockwise";
    }
}
