//! What `ugv inspect` found, as text, JSON and a page.

mod json;
mod page;
mod plots;
mod tables;
mod text;
mod words;

pub use json::{doubt as doubt_json, json};
pub use page::page;
pub use text::text;
