//! Segments that a time limit allows.
//!
//! The cost of a diagnosis is counted in passes: predictions of all segments with derivatives by the soil. A few
//! segments are predicted first, to measure the cost of a pass on this machine. If even a diagnosis without findings
//! would exceed the limit on all segments, evenly spaced ones are taken.

use super::Problem;
use crate::diagnosis::{DiagnosisError, Progress};
use crate::fit::problem::Point;

/// Segments predicted for the measurement.
const PROBED: usize = 4;
/// Passes of the first screening after the first fit of the soil (a drive of 40 s: 13).
pub const FIRST_LOOK: u32 = 20;
/// Passes of the answer after the search: the held-out comparison (the same drive without findings: 12; with findings
/// about 24).
const ANSWER: u32 = 30;
/// Passes below which hardly any diagnosis finishes (the same drive: 364).
const MIN_PASSES: u32 = 200;
/// Passes that suffice for nearly all diagnoses.
const ENOUGH_PASSES: u32 = 400;
/// Minimum number of segments.
const FEWEST: usize = 4;

/// Measures a pass, and keeps the segments that the limit allows; returns the seconds used, and in total. `None` if
/// all are kept.
///
/// # Errors
/// A stop by the caller, or a time limit.
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
    let remaining = limit.saturating_sub(progress.elapsed()).as_secs_f64();
    let allowed = |passes: u32| (remaining / (each * f64::from(passes))) as usize;
    let kept = if allowed(MIN_PASSES) >= count {
        count
    } else {
        // A subsample with an answer says more than all of them without.
        allowed(ENOUGH_PASSES).max(FEWEST.min(count))
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

/// Evenly spaced indices.
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
