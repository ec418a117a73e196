//! A part of a drive, outside of which effects are off.

use crate::display::number;
use thiserror::Error;

/// Effects that act for a while only, or somewhere only.
///
/// Outside they are off, as if all that switches them had its default. What they make the vehicle and
/// its ground remember goes on being remembered there, and is felt again inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// The effects, by their places in [`crate::effects::CATALOGUE`].
    pub effects: Vec<usize>,
    /// Where or when they act.
    pub extent: Extent,
}

/// Where or when something acts; its edges are hard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// From one time on, and before another \[s\].
    Time {
        /// The first moment.
        start: f64,
        /// The first moment after it.
        end: f64,
    },
    /// While the reference point (whose motion is the state) is in a disc on the map \[m\].
    Place {
        /// East of the origin.
        x: f64,
        /// North of the origin.
        y: f64,
        /// Radius of the disc.
        radius: f64,
    },
}

/// Why a window makes no sense.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum WindowError {
    /// No effects in it.
    #[error("it holds no effects: name at least one")]
    Empty,
    /// A place in the catalogue at which there is no effect.
    #[error("there is no effect number {0}")]
    Unknown(usize),
    /// An effect that is off inside as well.
    #[error("{0} is off: set its parameters beside the window, or leave it out")]
    Off(&'static str),
    /// An effect that changes what sensors report, which has no window.
    #[error("{0} changes what sensors report, which has no window: leave it out")]
    Sensor(&'static str),
    /// A start \[s\] that does not come before the end \[s\].
    #[error("the start, {} s, must come before the end, {} s", number(*.0), number(*.1))]
    Order(f64, f64),
    /// A radius \[m\] that is not positive.
    #[error("the radius, {} m, must be above 0 m", number(*.0))]
    Radius(f64),
    /// A number that is not finite.
    #[error("{0} is not finite")]
    NotFinite(f64),
}

impl Extent {
    pub(super) fn check(&self) -> Result<(), WindowError> {
        let numbers = match *self {
            Self::Time { start, end } => [start, end, 0.0],
            Self::Place { x, y, radius } => [x, y, radius],
        };
        match (*self, numbers.into_iter().find(|n| !n.is_finite())) {
            (_, Some(number)) => Err(WindowError::NotFinite(number)),
            (Self::Time { start, end }, _) if start >= end => Err(WindowError::Order(start, end)),
            (Self::Place { radius, .. }, _) if radius <= 0.0 => Err(WindowError::Radius(radius)),
            _ => Ok(()),
        }
    }

    /// Whether a moment, or a place (east and north), is inside.
    #[must_use]
    pub fn holds(&self, time: f64, place: [f64; 2]) -> bool {
        match *self {
            Self::Time { start, end } => (start..end).contains(&time),
            Self::Place { x, y, radius } => (place[0] - x).hypot(place[1] - y) <= radius,
        }
    }

    /// The length \[m\] of what lies in the way; `None` where that is nothing.
    #[must_use]
    pub const fn min_feature_length(&self) -> Option<f64> {
        match *self {
            Self::Time { .. } => None,
            Self::Place { radius, .. } => Some(radius),
        }
    }

    /// The first moment after `time` \[s\] at which an edge is passed, whatever the vehicle does.
    #[must_use]
    pub fn next_edge(&self, time: f64) -> Option<f64> {
        match *self {
            Self::Time { start, end } => [start, end].into_iter().find(|edge| *edge > time),
            Self::Place { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_while_begins_with_its_start_and_ends_before_its_end() {
        let extent = Extent::Time {
            start: 2.0,
            end: 3.0,
        };
        for (time, inside, edge) in [
            (1.9, false, Some(2.0)),
            (2.0, true, Some(3.0)),
            (2.9, true, Some(3.0)),
            (3.0, false, None),
        ] {
            assert_eq!(extent.holds(time, [0.0; 2]), inside, "{time}");
            assert_eq!(extent.next_edge(time), edge, "{time}");
        }
    }

    #[test]
    fn a_place_is_a_disc() {
        let extent = Extent::Place {
            x: 1.0,
            y: -1.0,
            radius: 5.0,
        };
        assert!(extent.holds(7.0, [4.0, 3.0]) && !extent.holds(7.0, [4.0, 3.1]));
        assert_eq!(extent.next_edge(0.0), None);
    }
}
