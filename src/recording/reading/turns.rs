//! Wrapped headings.

use super::agreement::cumulated;
use super::note;
use crate::recording::csv::{Sample, Samples};
use crate::recording::{Channel, Note, NoteKind};
use std::f64::consts::TAU;

/// A value this far outside of a full turn is not wrapped: rounding of a written number.
const ROUNDING: f64 = 2e-3;

/// Over longer intervals than this the gyro tells how many turns there were \[s\].
const LONG: f64 = 0.5;

/// Whether headings \[rad\] stay within a full turn; those that do not are continuous already.
pub fn is_wrapped(headings: impl Iterator<Item = f64>) -> bool {
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = headings.fold(nothing, |(low, high), value| {
        (f64::min(low, value), f64::max(high, value))
    });
    high - low <= TAU + ROUNDING
}

/// Takes full turns out of headings that are kept within one turn, so that they go on beyond it.
pub fn unwrap(samples: &mut Samples) -> Option<Note> {
    let (mut count, mut line) = (0, 0);
    for run in &mut samples.runs {
        // One that goes on beyond a turn says nothing of another.
        let headings = run.channels[Channel::Heading.index()].iter();
        if !is_wrapped(headings.map(|sample| sample.value)) {
            continue;
        }
        let gyro = cumulated(run, Channel::YawRate);
        let mut turns = 0.0;
        let mut last: Option<Sample> = None;
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
                    count += 1;
                    line = if line == 0 { sample.line } else { line };
                }
                turns = now;
            }
            sample.value += turns * TAU;
            last = Some(*sample);
        }
    }
    let jumps = if count == 1 { "jump" } else { "jumps" };
    let text = format!("{count} {jumps} of a full turn taken out");
    note(
        NoteKind::Unwrapped,
        Some(Channel::Heading),
        (count, line),
        text,
    )
}
