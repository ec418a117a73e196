//! Results as text, JSON and pages; only renders.

pub mod chart;
pub mod inspection;
mod page;
