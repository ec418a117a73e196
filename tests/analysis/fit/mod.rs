//! Fits to recordings whose truth is known.

mod answers;
mod coverage;
mod deadline;
mod derivatives;
mod differences;
mod recovery;
mod refusals;
mod segments;
mod synthetic;
mod valleys;
