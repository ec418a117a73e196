//! Which windows a model is fitted on, and which it is judged by.

use super::error::IdentificationError;
use super::kinematics::MIN_WINDOWS;
use super::latency::Latencies;
use super::signals::Signals;
use super::windows::{PredictionWindow, WindowOptions, cut};
use crate::recording::{Recording, Run};

/// Minimum duration of turning wheels in a run that counts as a drive \[s\].
const MIN_DRIVE: f64 = 3.0;

/// Indices of windows for fitting and judging; the windows of both sets do not overlap.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DataSplit {
    /// For fitting.
    pub fitted: Vec<usize>,
    /// For judging.
    pub judged: Vec<usize>,
    /// Whether both sets are of one run, so that the window options determine the boundary between them.
    pub within_a_run: bool,
}

/// Splits the windows of a recording.
///
/// In a single run the later windows are judged and the earlier ones are for fitting, with equal numbers and without
/// overlap. If the run is too short for both, all are judged. Of several runs every second one is judged, in the order of
/// their labels, which show the order of driving better than the file. Runs that hardly drive are for fitting and do not
/// count, so the choice of runs does not depend on the window options.
#[must_use]
pub fn split(runs: &[Signals], windows: &[PredictionWindow]) -> DataSplit {
    let mut order: Vec<usize> = (0..runs.len())
        .filter(|run| runs[*run].moving_seconds() >= MIN_DRIVE)
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
    DataSplit {
        fitted,
        judged,
        within_a_run: false,
    }
}

/// Splits the windows of one run; the windows of other runs are for fitting.
fn split_one(windows: &[PredictionWindow], run: usize) -> DataSplit {
    let first = windows.partition_point(|window| window.run < run);
    let end = windows.partition_point(|window| window.run <= run);
    let own = split_run(&windows[first..end]);
    let shifted = |indices: Vec<usize>| indices.into_iter().map(move |index| first + index);
    DataSplit {
        fitted: (0..first)
            .chain(shifted(own.fitted))
            .chain(end..windows.len())
            .collect(),
        judged: shifted(own.judged).collect(),
        within_a_run: true,
    }
}

fn split_run(windows: &[PredictionWindow]) -> DataSplit {
    let before = |first: usize| {
        let start = windows[first].start;
        windows.partition_point(|window| window.start + window.horizon() <= start)
    };
    let balanced = |first: &usize| before(*first) >= windows.len() - first;
    let first = (0..windows.len()).find(balanced);
    let enough = |first: &usize| before(*first) >= MIN_WINDOWS;
    let first = first.filter(enough).unwrap_or(0);
    let fitted = if first > 0 { before(first) } else { 0 };
    DataSplit {
        fitted: (0..fitted).collect(),
        judged: (first..windows.len()).collect(),
        within_a_run: true,
    }
}

/// The part of a recording for fitting, without the windows that [`split`] reserves for judging: the start of a single run,
/// or every second one of several runs.
///
/// # Errors
/// A recording without windows, or too short for a split.
pub fn fitted_part(
    recording: &Recording,
    options: &WindowOptions,
) -> Result<Recording, IdentificationError> {
    let mut signals = Signals::of(recording)?;
    let latencies = Latencies::estimate(&signals);
    for run in &mut signals {
        run.remove(&latencies);
    }
    let windows = cut(&recording.name, &signals, options)?.windows;
    let halves = split(&signals, &windows);
    let fitted: Vec<_> = halves.fitted.iter().map(|index| &windows[*index]).collect();
    if fitted.is_empty() {
        return Err(IdentificationError::TooShortToSplit {
            recording: recording.name.clone(),
        });
    }
    let judged_runs = halves.judged.iter().map(|index| windows[*index].run);
    let judged_runs: Vec<usize> = judged_runs.collect();
    let with_pose = recording
        .runs
        .iter()
        .filter(|run| Signals::is_complete(run));
    let mut runs = Vec::new();
    for (index, run) in with_pose.enumerate() {
        let own = fitted.iter().filter(|window| window.run == index);
        let ends = own.map(|window| window.start + window.horizon());
        let Some(end) = ends.max_by(f64::total_cmp) else {
            continue;
        };
        if judged_runs.contains(&index) {
            runs.push(until(run, end));
        } else {
            runs.push(run.clone());
        }
    }
    Ok(Recording {
        runs,
        ..recording.clone()
    })
}

/// A run's samples up to a time.
fn until(run: &Run, end: f64) -> Run {
    run.channels()
        .fold(Run::new(run.label.clone()), |cut, (channel, series)| {
            let kept = series.samples().filter(|(time, _)| *time <= end);
            cut.with(channel, kept.collect())
        })
}
