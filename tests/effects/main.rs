//! Left-out physics switched on: limits, signs, symmetries, derivatives.

#[path = "../common/mod.rs"]
mod common;

mod derivatives;
mod limits;
