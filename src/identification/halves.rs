//! Which windows a model is fitted on, and which it is judged by.

use super::kinematics::FEWEST_WINDOWS;
use super::{Signals, Window};

/// A run whose wheels turn for less \[s\] is no drive of its own.
const DRIVES: f64 = 3.0;

/// Indices of windows; none is in both, and those for fitting do not overlap those for judging.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Halves {
    /// For fitting.
    pub fitted: Vec<usize>,
    /// For judging.
    pub judged: Vec<usize>,
    /// Whether these are of one run, so that how windows are cut tells where fitting ends and judging begins.
    pub within_a_run: bool,
}

/// Parts the windows of a recording.
///
/// In a single run the later windows are judged and the earlier ones are for fitting, as many
/// of each as can be without overlap; where the run is too short
/// for both, all are judged. Of
/// several runs every second one is judged, in the order of their labels, which tell better
/// than the file in which order they were driven. Runs that hardly drive do not count and are for fitting: which run is
/// judged does not depend on how windows are cut.
#[must_use]
pub fn split(runs: &[Signals], windows: &[Window]) -> Halves {
    let mut order: Vec<usize> = (0..runs.len())
        .filter(|run| runs[*run].moving_seconds() >= DRIVES)
        .collect();
    if order.is_empty() {
        order = (0..runs.len()).collect();
    }
    if let [only] = order[..] {
        return split_one(windows, only);
    }
    let number = |run: &usize| runs[*run].label.trim().parse().unwrap_or(f64::INFINITY);
    order.sort_by(|a, b| number(a).total_cmp(&number(b)));
    let judged = |index: &usize| {
        let place = order.iter().position(|run| *run == windows[*index].run);
        place.is_some_and(|place| place % 2 == 1)
    };
    let (judged, fitted) = (0..windows.len()).partition(judged);
    Halves {
        fitted,
        judged,
        within_a_run: false,
    }
}

/// Parts the windows of one run; those of others are for fitting.
fn split_one(windows: &[Window], run: usize) -> Halves {
    let first = windows.partition_point(|window| window.run < run);
    let end = windows.partition_point(|window| window.run <= run);
    let own = split_run(&windows[first..end]);
    let shifted = |indices: Vec<usize>| indices.into_iter().map(move |index| first + index);
    Halves {
        fitted: (0..first)
            .chain(shifted(own.fitted))
            .chain(end..windows.len())
            .collect(),
        judged: shifted(own.judged).collect(),
        within_a_run: true,
    }
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
        within_a_run: true,
    }
}
