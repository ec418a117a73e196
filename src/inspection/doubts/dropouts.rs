//! Missing values that were written as 0.

use super::doubt::{Doubt, DoubtKind, Span};
use crate::recording::{Channel, Recording, Series, median};

/// A value falls to 0 from, and comes back to, at least so many times its usual change from sample to sample.
const USUAL: f64 = 8.0;
/// Neighbours of zeros differ by no more than this share of the smaller one: nothing happened in between.
const ALIKE: f64 = 0.3;
/// Zeros in a row at most, and from the value before them to the one after \[s\], so that no vehicle stops and starts in
/// between.
const FEW: usize = 3;
const QUICK: f64 = 0.5;

/// Single zeros among values far from 0 on both sides of them. A wheel, and a vehicle, cannot stop and start so fast.
pub fn doubts(recording: &Recording) -> Vec<Doubt> {
    let rates = [
        Channel::OmegaLeft,
        Channel::OmegaRight,
        Channel::VX,
        Channel::YawRate,
    ];
    let runs = recording.runs.iter().enumerate();
    let each = runs.flat_map(|(run, one)| {
        rates.into_iter().filter_map(move |channel| {
            let spans = dropouts(one.series(channel)?, run);
            let (first, count) = (*spans.first()?, spans.len());
            let times = if count == 1 {
                format!("at {:.2} s", first.start)
            } else {
                format!("{count} times, first at {:.2} s,", first.start)
            };
            Some(Doubt {
                kind: DoubtKind::Dropout,
                channels: vec![channel],
                span: Some(first),
                probability: 0.95,
                left_out: spans,
                evidence: format!(
                    "{channel} is exactly 0 {times} and the same as before right after, as if missing values were \
                     written as 0"
                ),
                remedy: format!(
                    "These samples of {channel} are left out; leave cells empty where nothing was measured"
                ),
            })
        })
    });
    each.collect()
}

fn dropouts(series: &Series, run: usize) -> Vec<Span> {
    let (time, value) = (&series.time, &series.value);
    let changes = value.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut changes: Vec<f64> = changes.filter(|change| *change > 0.0).collect();
    let usual = median(&mut changes);
    let mut found = Vec::new();
    let mut last = None;
    for (k, now) in value.iter().enumerate().filter(|(_, value)| **value != 0.0) {
        let before = last.replace(k);
        let Some(before) = before.filter(|before| (2..=FEW + 1).contains(&(k - before))) else {
            continue;
        };
        let smaller = value[before].abs().min(now.abs());
        let is_alike = (now - value[before]).abs() <= ALIKE * smaller;
        let is_quick = time[k] - time[before] <= QUICK;
        if smaller > USUAL * usual && is_alike && is_quick {
            found.push(Span {
                run,
                start: time[before + 1],
                end: time[k - 1],
            });
        }
    }
    found
}
