//! What to fit, how, and how far a fit has come.

use super::sensor::SensorParameter;

/// What to fit, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Free parameters of each recording's sensors, where the recording determines them.
    pub sensors: Vec<SensorParameter>,
    /// Length of a segment \[s\].
    pub segment: f64,
    /// Number of random starts.
    pub starts: usize,
    /// Seed of the random starts.
    pub seed: u64,
    /// Whether samples far off count less.
    pub robust: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            sensors: SensorParameter::DEFAULT_FREE.to_vec(),
            segment: 5.0,
            starts: 20,
            seed: 1,
            robust: true,
        }
    }
}

/// How far a fit has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// In this turn of motion, noise and weights.
    Turn(usize),
    /// So many random starts done.
    Start(usize),
}
