//! Sensors that report the past.

use super::declaration::effect;

effect! {
    /// Each sensor reports the state that much earlier.
    ///
    /// Priors: a pose from lidar or a filter trails by tenths of a second, encoders by less.
    Latency: "latency", Sensors,
    phrase "sensors that trail each other",
    lifts "perfect measurement: no delay",
    equation "reported(t) = state(t - latency)",
    source "definition",
    check "Compare the clocks of the sensors, and how long each filters or buffers before it stamps its values.",
    {
        pose ["s"] -1.5..1.5, off 0.0, normal(0.0, 0.4), "Delay of position and heading";
        yaw_rate ["s"] 0.0..1.0, off 0.0, normal(0.0, 0.05), "Delay of the yaw rate (not estimated: the gyro is the clock)";
        wheels ["s"] -1.0..1.0, off 0.0, normal(0.0, 0.2), "Delay of the wheel speeds";
    }
}
