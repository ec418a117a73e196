//! Wrapped headings.

use crate::recording::csv::Samples;
use crate::recording::{Channel, Note, NoteKind};
use std::f64::consts::{PI, TAU};

/// A value this far outside of a full turn is not wrapped: rounding of a written number.
const ROUNDING: f64 = 1e-3;

/// Takes full turns out of headings that are kept within one turn, so that they go on beyond it.
pub fn unwrap(samples: &mut Samples) -> Option<Note> {
    let within = |low: f64| {
        let inside = low - ROUNDING..=low + TAU + ROUNDING;
        samples
            .of(Channel::Heading)
            .all(|sample| inside.contains(&sample.value))
    };
    if !(within(-PI) || within(0.0)) {
        return None;
    }
    let mut jumps = (0, 0);
    for run in &mut samples.runs {
        let mut turns = 0.0;
        let mut last: Option<f64> = None;
        for sample in &mut run.channels[Channel::Heading.index()] {
            if let Some(last) = last {
                let step = ((last - sample.value) / TAU).round();
                if step != turns {
                    jumps.0 += 1;
                    jumps.1 = if jumps.1 == 0 { sample.line } else { jumps.1 };
                }
                turns = step;
            }
            sample.value += turns * TAU;
            last = Some(sample.value);
        }
    }
    let (count, line) = jumps;
    (count > 0).then(|| Note {
        kind: NoteKind::Unwrapped,
        channel: Some(Channel::Heading),
        count,
        line,
        text: format!("{count} jumps of a full turn taken out"),
    })
}
