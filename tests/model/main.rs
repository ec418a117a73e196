//! The model against the paper, hand-computed limits, golden values and its own properties.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
#[cfg(feature = "batch")]
mod batch;
mod drivable;
mod effects;
mod golden;
mod integration;
mod limits;
mod paper_findings;
mod properties;
