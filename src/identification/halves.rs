//! Which windows a model is fitted on, and which it is judged by.

use super::kinematics::FEWEST_WINDOWS;
use super::{Signals, Window};

/// Indices of windows; none is in both, and those for fitting do not overlap those for judging.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Halves {
    /// For fitting.
    pub fitted: Vec<usize>,
    /// For judging.
    pub judged: Vec<usize>,
}

/// Parts the windows of a recording.
///
/// In a single run the later windows are judged and the earlier ones are for fitting, as many
/// of each as can be without overlap; where the run is too short
/// for both, all are judged. Of
/// several runs every second one is judged, in the order of their labels, which tell better
/// than the file in which order they were driven.
#[must_use]
pub fn split(runs: &[Signals], windows: &[Window]) -> Halves {
    let mut order: Vec<usize> = windows.iter().map(|window| window.run).collect();
    order.dedup();
    if order.len() <= 1 {
        return split_run(windows);
    }
    let number = |run: &usize| runs[*run].label.trim().parse().unwrap_or(f64::INFINITY);
    order.sort_by(|a, b| number(a).total_cmp(&number(b)));
    let judged = |index: &usize| {
        let place = order.iter().position(|run| *run == windows[*index].run);
        place.is_some_and(|place| place % 2 == 1)
    };
    let (judged, fitted) = (0..windows.len()).partition(judged);
    Halves { fitted, judged }
}

fn split_run(windows: &[Window]) -> Halves {
    let before = |first: usize| {
        let start = windows[first].start;
        windows.partition_point(|window| window.start + window.horizon() <= start)
    };
    let balanced = |first: &usize| before(*first) >= windows.len() - first;
    let first = (0..windows.len()).find(balanced);
    let enough = |first: &usize| before(*first) >= FEWEST_WINDOWS;
    let first = first.filter(enough).unwrap_or(0);
    let fitted = if first > 0 { before(first) } else { 0 };
    Halves {
        fitted: (0..fitted).collect(),
        judged: (first..windows.len()).collect(),
    }
}
