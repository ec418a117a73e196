//! A gyro with an offset.

use super::declaration::effect;

effect! {
    /// The gyro reports a constant more than the yaw rate.
    YawRateBias: "yaw_rate_bias", Measurement,
    lifts "perfect measurement: no gyro bias",
    equation "reported = Omega + bias",
    source "definition",
    {
        bias ["rad/s"] -0.2..0.2, off 0.0, normal(0.0, 0.01), "Offset";
    }
}
