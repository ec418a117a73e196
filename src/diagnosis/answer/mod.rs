//! The answer: posterior and verdict, findings in numbers and words, and the held-out comparison.

pub mod account;
pub mod augmented;
pub mod candidates;
pub mod claims;
pub mod errors;
pub mod findings;
pub mod posterior;
pub mod traces;
pub mod verdict;
pub mod words;
