//! A gyro with an offset.

use super::declaration::effect;

effect! {
    /// The gyro reports a constant more than the yaw rate.
    YawRateBias: "yaw_rate_bias", Sensors,
    phrase "a gyro that is off at rest",
    lifts "perfect measurement: no gyro bias",
    equation "reported = Omega + bias",
    source "definition",
    check "Read the gyro at rest before and after the drive.",
    {
        bias ["rad/s"] -0.3..0.3, off 0.0, normal(0.0, 0.02), "Offset";
    }
}
