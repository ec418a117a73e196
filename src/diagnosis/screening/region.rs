//! Where something acts: a set of time bins.

/// A part of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunInterval {
    /// Recording.
    pub recording: usize,
    /// Run.
    pub run: usize,
    /// Beginning \[s\], by the run's clock.
    pub start: f64,
    /// End \[s\].
    pub end: f64,
}

/// A set of gates: where something acts.
#[derive(Debug, Clone, PartialEq)]
pub enum Region {
    /// From gate to gate (exclusive) of a run's gates in their order.
    Time(RunInterval),
    /// All of a run, of several.
    Run(RunInterval),
    /// Where the vehicle is within a disc.
    Place {
        /// Centre, east and north, and radius \[m\].
        disc: [f64; 3],
    },
    /// Beyond a line on the map.
    Beyond {
        /// Direction across the line \[rad\], counter-clockwise from east.
        direction: f64,
        /// The line's distance from the origin in that direction \[m\].
        position: f64,
    },
}
