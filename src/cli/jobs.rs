//! The threads that an argument asks for.

use super::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// So many threads, or one per processor.
pub fn pool(jobs: Option<usize>) -> Result<ThreadPool, Failure> {
    let pool = ThreadPoolBuilder::new().num_threads(jobs.unwrap_or(0));
    pool.build().map_err(|error| Failure::Argument {
        reason: format!("--jobs: {error}"),
        hint: None,
    })
}
