//! Results as text, JSON and pages; only renders.

pub mod chart;
pub mod diagnosis;
mod html;
pub mod inspection;
pub mod number;
