//! What is told: probabilities and the verdict, what was found in numbers and words, and what it predicts.

pub mod account;
pub mod ambiguity;
pub mod augmented;
pub mod candidates;
pub mod errors;
pub mod findings;
pub mod posterior;
pub mod traces;
pub mod verdict;
pub mod words;
