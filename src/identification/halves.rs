//! Which windows a model is fitted on, and which it is judged by.

use super::{Signals, Window};

/// Indices of windows; none is in both.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Halves {
    /// For fitting.
    pub fitted: Vec<usize>,
    /// For judging.
    pub judged: Vec<usize>,
}

/// Parts the windows of a recording.
///
/// In a single run the second half is judged, and windows of the first that reach into it are
/// not used. Of several runs every second one is judged, in the order of their labels, which
/// tell better than the file in which order they were driven.
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
    let half = windows.len() / 2;
    let Some(first) = windows.get(half) else {
        return Halves::default();
    };
    let apart = |index: &usize| {
        let window = &windows[*index];
        window.start + window.horizon() <= first.start
    };
    Halves {
        fitted: (0..half).filter(apart).collect(),
        judged: (half..windows.len()).collect(),
    }
}
