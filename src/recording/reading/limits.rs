//! Values that cannot be.

use super::note;
use crate::recording::csv::{Samples, malformed};
use crate::recording::{Channel, CsvError, Note, NoteKind};

/// Larger magnitudes are none of a ground vehicle's, in the channel's unit.
pub fn limit(channel: Channel) -> f64 {
    match channel {
        Channel::OmegaLeft | Channel::OmegaRight => 200.0,
        Channel::X | Channel::Y => 1e8,
        Channel::Heading => 1e5,
        Channel::VX | Channel::VY => 100.0,
        Channel::YawRate => 35.0,
        Channel::AX | Channel::AY => 1000.0,
    }
}

/// Values this many times beyond the limit are wrong in every unit that somebody might take.
pub const ANY_UNIT: f64 = 60.0;
/// Larger shares of a channel are no single slips.
const MOST_OUTLIERS: f64 = 0.01;

/// Leaves out single values beyond a multiple of the limits.
pub fn drop_outliers(samples: &mut Samples, factor: f64) -> Vec<Note> {
    let mut notes = Vec::new();
    for channel in Channel::ALL {
        let bound = factor * limit(channel);
        let lines = samples
            .of(channel)
            .filter(|sample| sample.value.abs() > bound);
        let lines: Vec<usize> = lines.map(|sample| sample.line).collect();
        let total = samples.of(channel).count();
        if lines.is_empty()
            || lines.len() as f64 > 1.0_f64.max(MOST_OUTLIERS * total as f64)
            || lines.len() == total
        {
            continue;
        }
        for run in &mut samples.runs {
            run.channels[channel.index()].retain(|sample| sample.value.abs() <= bound);
        }
        let count = lines.len();
        let text = format!(
            "{count} of {total} values are beyond {bound} {} and taken as missing",
            channel.unit()
        );
        let first = lines.iter().min().copied().unwrap_or_default();
        notes.extend(note(NoteKind::Outlier, Some(channel), (count, first), text));
    }
    notes
}

/// Refuses what is beyond the limits.
///
/// # Errors
/// The first such value of a channel, and the units that it may be in.
pub fn check(samples: &Samples) -> Result<(), CsvError> {
    for channel in Channel::ALL {
        let bound = limit(channel);
        if let Some(sample) = samples
            .of(channel)
            .find(|sample| sample.value.abs() > bound)
        {
            let units = match channel {
                Channel::OmegaLeft | Channel::OmegaRight => {
                    " (is it in rpm or degrees per second?)"
                }
                Channel::YawRate => " (is it in degrees per second?)",
                _ => "",
            };
            let expected = format!("a value within {bound} {}{units}", channel.unit());
            let found = format!("{}", sample.value);
            return Err(malformed(
                samples.cell(sample.line, channel),
                found,
                expected,
            ));
        }
    }
    Ok(())
}
