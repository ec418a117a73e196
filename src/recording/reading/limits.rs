//! Values that cannot be.

use super::note;
use crate::display::number;
use crate::recording::csv::{Sample, Samples, malformed};
use crate::recording::{Channel, CsvError, Note, NoteKind};
use std::f64::consts::TAU;

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

/// Headings that leave the ones before by more than this, in degrees or radians, are none: a number that stands for a
/// missing one, such as -999.
const LEAP: f64 = 400.0;
/// Full turns, of radians and of degrees, with the rounding of numbers that are written.
const TURNS: [f64; 2] = [TAU + 2e-3, 360.5];
/// No vehicle turns by this share of a turn and back within so many seconds from one sample to the next.
const FAR: f64 = 0.25;
const QUICK: f64 = 1.2;
/// Fewer headings do not tell which of them is a stray.
const FEWEST: usize = 20;
/// Of so many first ones the median is taken for what comes before.
const FIRST: usize = 11;

/// Leaves out single values beyond a multiple of the limits.
pub fn drop_outliers(samples: &mut Samples, factor: f64) -> Vec<Note> {
    let leave = |channel: Channel| {
        let bound = factor * limit(channel);
        let beyond = |sample: &&Sample| sample.value.abs() > bound;
        let lines = samples.of(channel).filter(beyond);
        let lines: Vec<usize> = lines.map(|sample| sample.line).collect();
        let why = format!("are beyond {bound} {}", channel.unit());
        take_out(samples, channel, lines, &why)
    };
    Channel::ALL.into_iter().filter_map(leave).collect()
}

/// Leaves out single headings that are far from all others, so that these may be wrapped or in degrees.
pub fn drop_leaps(samples: &mut Samples) -> Option<Note> {
    let mut lines = Vec::new();
    for run in &samples.runs {
        let headings = &run.channels[Channel::Heading.index()];
        let mut first: Vec<f64> = headings.iter().take(FIRST).map(|one| one.value).collect();
        first.sort_by(f64::total_cmp);
        let Some(mut last) = first.get(first.len() / 2).copied() else {
            continue;
        };
        for sample in headings {
            if (sample.value - last).abs() > LEAP {
                lines.push(sample.line);
            } else {
                last = sample.value;
            }
        }
    }
    let why = format!("are more than {LEAP} from the ones before");
    take_out(samples, Channel::Heading, lines, &why)
}

/// Leaves out single headings outside of the full turn, of radians or else of degrees, that all others keep to: numbers
/// that stand for missing ones, such as -1 degree. They would hide that the others are wrapped.
pub fn drop_strays(samples: &mut Samples) -> Option<Note> {
    TURNS.into_iter().find_map(|turn| {
        let runs = samples.runs.iter();
        let lines = runs.flat_map(|run| strays(&run.channels[Channel::Heading.index()], turn));
        let why = format!("are outside of the full turn ({turn:.1}) that all others keep to");
        let lines = lines.collect();
        take_out(samples, Channel::Heading, lines, &why)
    })
}

/// Lines of the few samples outside of a turn that holds all others, if each is far from those beside it.
fn strays(headings: &[Sample], turn: f64) -> Vec<usize> {
    let mut sorted: Vec<f64> = headings.iter().map(|sample| sample.value).collect();
    sorted.sort_by(f64::total_cmp);
    let held = |low: &f64| sorted.partition_point(|value| value - low <= turn);
    let counts = sorted
        .iter()
        .enumerate()
        .map(|(k, low)| (held(low) - k, *low));
    let Some((count, low)) = counts.max_by_key(|(count, _)| *count) else {
        return Vec::new();
    };
    let outside = |sample: &Sample| !(low..=low + turn).contains(&sample.value);
    let few = 1.0_f64.max(MOST_OUTLIERS * headings.len() as f64);
    let is_far = |index: usize| {
        let beside = [index.checked_sub(1), Some(index + 1)];
        let beside = beside.into_iter().flatten();
        let mut beside = beside.filter_map(|k| headings.get(k));
        beside.all(|other| {
            let apart = (other.value - headings[index].value).abs();
            apart > FAR * turn && (other.time - headings[index].time).abs() < QUICK
        })
    };
    let all = (0..headings.len()).filter(|k| outside(&headings[*k]));
    let all: Vec<usize> = all.collect();
    let many = headings.len() < FEWEST || (headings.len() - count) as f64 > few;
    if many || !all.iter().all(|index| is_far(*index)) {
        return Vec::new();
    }
    all.into_iter().map(|k| headings[k].line).collect()
}

/// Leaves out the values of these lines, unless they are too many for slips.
fn take_out(
    samples: &mut Samples,
    channel: Channel,
    mut lines: Vec<usize>,
    why: &str,
) -> Option<Note> {
    let (count, total) = (lines.len(), samples.of(channel).count());
    if count as f64 > 1.0_f64.max(MOST_OUTLIERS * total as f64) || count == total {
        return None;
    }
    lines.sort_unstable();
    for run in &mut samples.runs {
        run.channels[channel.index()].retain(|sample| lines.binary_search(&sample.line).is_err());
    }
    let text = format!("{count} of {total} values {why} and taken as missing");
    let first = lines.first().copied().unwrap_or_default();
    note(NoteKind::Outlier, Some(channel), (count, first), text)
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
            let found = number(sample.value);
            return Err(malformed(
                samples.cell(sample.line, channel),
                found,
                expected,
            ));
        }
    }
    Ok(())
}
