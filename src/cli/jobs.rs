//! The threads that an argument asks for.

use super::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;

/// No machine has use for more threads, and each takes memory.
const MOST: usize = 1024;

/// So many threads, or one per processor.
pub fn pool(jobs: Option<NonZeroUsize>) -> Result<ThreadPool, Failure> {
    let jobs = jobs.map_or(0, NonZeroUsize::get);
    if jobs > MOST {
        return Err(Failure::Argument {
            reason: format!("--jobs {jobs}: the limit is {MOST} threads"),
            hint: Some("leave --jobs out for one thread per processor".into()),
        });
    }
    let pool = ThreadPoolBuilder::new().num_threads(jobs);
    pool.build().map_err(|error| Failure::Argument {
        reason: format!("--jobs: {error}"),
        hint: None,
    })
}
