//! Regions in which an effect acts.

/// A time interval of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunInterval {
    /// Recording.
    pub recording: usize,
    /// Run.
    pub run: usize,
    /// Start \[s\], by the run's clock.
    pub start: f64,
    /// End \[s\].
    pub end: f64,
}

/// A region.
#[derive(Debug, Clone, PartialEq)]
pub enum Region {
    /// A time interval of a run.
    Time(RunInterval),
    /// A whole run, of several.
    Run(RunInterval),
    /// A disc on the map.
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
