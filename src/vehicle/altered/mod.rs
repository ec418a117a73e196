//! A vehicle whose motion effects alter: the same balance with other masses, loads, laws and
//! forces, generic over the scalar.
//!
//! The balance is found in the specific force s = sum F / m that the ground exerts; the loads follow
//! from it as in (28), and gravity on a slope, drag and drawbar add to the acceleration.

mod chassis;
mod direction;
mod directions;
mod loads;
mod memory;
mod rut;
mod situation;
mod solve;
mod surroundings;
mod tracks;

pub(crate) use chassis::Chassis;
pub(crate) use direction::Direction;
pub(crate) use directions::{Differentiated, Directions};
pub(crate) use memory::{MemoryLayout, Remembered};
pub(crate) use rut::TrackSlope;
pub(crate) use situation::Situation;
pub(crate) use solve::{Altered, Prepared};
pub(crate) use surroundings::Environment;
pub use surroundings::Surroundings;
pub(crate) use tracks::{
    ApproachPath, TRACK_SAMPLES, sample_size, spacing, wheel_places, wheel_travel,
};
pub use tracks::{Tracks, seen_from};
