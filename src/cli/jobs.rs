//! The number of threads.

use super::failure::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::RangeInclusive;

/// No machine has use for more threads, and each takes memory.
pub const RANGE: RangeInclusive<i64> = 1..=1024;

/// This many threads, or one per processor.
pub fn pool(jobs: Option<u16>) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new()
        .num_threads(jobs.unwrap_or(0).into())
        .build()
        .map_err(|error| Failure::argument(format!("--jobs: {error}")))
}
