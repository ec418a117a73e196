//! The part of a recording by which nothing is judged.

use super::{Cut, IdentificationError, Latencies, Signals, cut, split};
use crate::recording::{Recording, Run};

/// What a model may be fitted to when the windows that are [`split`] off for judging are to stay
/// unseen: of a single run its first part, of several runs every second one.
///
/// # Errors
/// A recording without windows, or one too short to be parted.
pub fn fitted_part(recording: &Recording, how: &Cut) -> Result<Recording, IdentificationError> {
    let mut signals = Signals::of(recording)?;
    let latencies = Latencies::estimate(&signals);
    for run in &mut signals {
        run.remove(&latencies);
    }
    let windows = cut(&recording.name, &signals, how)?.windows;
    let halves = split(&signals, &windows);
    let fitted: Vec<_> = halves.fitted.iter().map(|index| &windows[*index]).collect();
    if fitted.is_empty() {
        return Err(IdentificationError::TooShortToPart {
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
