//! Results as text, JSON and pages; only renders.

pub mod chart;
pub mod diagnosis;
pub mod inspection;
mod number;
mod page;
