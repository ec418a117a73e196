//! What `ugv diagnose` found, as text, JSON and a page.

mod claim;
mod input;
mod json;
mod law;
mod page;
mod plots;
mod tables;
mod text;
mod words;

pub use claim::headline;
pub use input::{Input, Source, command};
pub use json::json;
pub use page::page;
pub use text::text;
