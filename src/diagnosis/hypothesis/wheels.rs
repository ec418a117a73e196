//! How wheel speeds are taken between samples.

/// What the wheels did between two samples of their speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheels {
    /// Whether samples are means over the time between them.
    pub counted: bool,
    /// How much they are smoothed, see [`crate::recording::Drive::reconstructed`].
    pub smoothing: f64,
    /// By how much log evidence the recordings are likelier so than with straight lines from sample to sample.
    pub likelier: f64,
}
