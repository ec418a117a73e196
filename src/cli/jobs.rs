//! The threads that an argument asks for.

use super::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;

/// So many threads, or one per processor.
pub fn pool(jobs: Option<NonZeroUsize>) -> Result<ThreadPool, Failure> {
    let pool = ThreadPoolBuilder::new().num_threads(jobs.map_or(0, NonZeroUsize::get));
    pool.build().map_err(|error| Failure::Argument {
        reason: format!("--jobs: {error}"),
        hint: None,
    })
}
