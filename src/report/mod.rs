//! Results as text, JSON and pages; only renders.

mod aligned;
pub mod chart;
pub mod diagnosis;
mod html;
pub mod inspection;
pub mod number;

pub use aligned::aligned;
