//! How much of the recordings a time limit allows.
//!
//! What a diagnosis costs is counted in passes: predictions of all segments with derivatives by the soil. A few segments
//! are predicted first, which tells what a pass costs on this machine. Where even a diagnosis that finds nothing has no
//! time on all segments, as many are taken as an answer has time for, spread evenly.

use super::Problem;
use crate::diagnosis::{DiagnosisError, Progress};
use crate::fit::problem::Point;

/// Segments that are predicted to learn what a pass costs.
const PROBED: usize = 4;
/// Passes that the first look takes, after the first fit of the soil (a drive of 40 s: 13).
pub const FIRST_LOOK: u32 = 20;
/// Passes that the answer takes after the search: models judged on data that they were not fitted to (the same drive, of
/// which nothing was missing: 12; with what was found twice as many).
const ANSWER: u32 = 30;
/// Passes without which hardly any diagnosis ends (the same drive: 364).
const LEAST: u32 = 200;
/// Passes with which most diagnoses end.
const WHOLE: u32 = 400;
/// Fewer segments than this are no recording to diagnose.
const FEWEST: usize = 4;

/// Learns what a pass costs, and takes as many segments as the time limit allows: seconds used, and of how many. `None`
/// where it allows all.
///
/// # Errors
/// Somebody wants it to end, no time even for that.
pub fn thin(
    problem: &mut Problem,
    progress: &Progress,
) -> Result<Option<[f64; 2]>, DiagnosisError> {
    let (Some(limit), count) = (progress.limit(), problem.segments.len()) else {
        return Ok(None);
    };
    if count == 0 {
        return Ok(None);
    }
    let all = problem.seconds();
    let probed = spread(PROBED.min(count), count);
    let predictor = problem.predictor(&[]);
    let shooting = problem.shooting(&predictor, &[]);
    let few = shooting.with_segments(
        probed
            .iter()
            .map(|k| problem.segments[*k].clone())
            .collect(),
    );
    let point = Point {
        starts: few.measured_starts(),
        ..problem.point(&shooting, &[], &problem.initial())
    };
    let before = progress.elapsed();
    let _ = few.evaluate_each(&point, true);
    let took = progress.elapsed().saturating_sub(before);
    progress.in_time(problem.deadline)?;
    let each = took.as_secs_f64() / probed.len() as f64;
    let left = limit.saturating_sub(progress.elapsed()).as_secs_f64();
    let allowed = |passes: u32| (left / (each * f64::from(passes))) as usize;
    let kept = if allowed(LEAST) >= count {
        count
    } else {
        // Part of the recordings with an answer says more than all of them without.
        allowed(WHOLE).max(FEWEST.min(count))
    };
    progress.measured(took.mul_f64(kept as f64 / probed.len() as f64));
    progress.reserve(progress.passes(ANSWER));
    if kept == count {
        return Ok(None);
    }
    let segments = spread(kept, count).into_iter();
    problem.segments = segments.map(|k| problem.segments[k].clone()).collect();
    Ok(Some([problem.seconds(), all]))
}

/// So many of a number of places, spread evenly.
fn spread(some: usize, count: usize) -> Vec<usize> {
    (0..some)
        .map(|k| (2 * k + 1) * count / (2 * some))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_segments_stand_for_all() {
        assert_eq!(spread(4, 4), [0, 1, 2, 3]);
        assert_eq!(spread(2, 8), [2, 6]);
        assert_eq!(spread(3, 10), [1, 5, 8]);
    }
}
