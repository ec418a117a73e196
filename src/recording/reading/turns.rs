//! Wrapped headings.

use super::agreement::{gyro, is_wrapped};
use crate::recording::channel::Channel;
use crate::recording::csv::{Occurrences, RawSample, RawSamples};
use crate::recording::note::NoteKind;
use std::f64::consts::TAU;

/// Over longer intervals than this the gyro shows the number of turns \[s\].
const LONG: f64 = 0.5;

/// Unwraps headings that are kept within one turn.
pub fn unwrap(samples: &mut RawSamples) {
    let mut jumps = Occurrences::default();
    for run in &mut samples.runs {
        // A heading beyond a turn in one run says nothing about the others.
        let headings = run.channels[Channel::Heading.index()].iter();
        if !is_wrapped(headings.map(|sample| sample.value)) {
            continue;
        }
        let gyro = gyro(run);
        let mut turns = 0.0;
        let mut last: Option<RawSample> = None;
        for sample in &mut run.channels[Channel::Heading.index()] {
            if let Some(last) = last {
                let interval = sample.time - last.time;
                let middle = last.time + interval / 2.0;
                let turned = gyro
                    .as_ref()
                    .filter(|_| interval > LONG)
                    .and_then(|gyro| gyro.mean_rate(middle, interval))
                    .map_or(0.0, |rate| rate * interval);
                let now = ((last.value + turned - sample.value) / TAU).round();
                if now != turns {
                    jumps.push(sample.line);
                }
                turns = now;
            }
            sample.value += turns * TAU;
            last = Some(*sample);
        }
    }
    let word = if jumps.count == 1 { "jump" } else { "jumps" };
    let text = format!("{} {word} of a full turn taken out", jumps.count);
    samples.note(NoteKind::Unwrapped, Some(Channel::Heading), jumps, text);
}
