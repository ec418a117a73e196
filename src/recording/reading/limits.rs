//! Impossible values.

use crate::display::number;
use crate::recording::channel::Channel;
use crate::recording::csv::{CsvError, Occurrences, RawSample, RawSamples, malformed};
use crate::recording::note::NoteKind;
use crate::recording::statistics::upper_median;
use std::f64::consts::TAU;

/// Maximum magnitude for a ground vehicle, in the channel's unit.
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

/// Values at this multiple of the limit are impossible in any common unit.
pub const ANY_UNIT: f64 = 60.0;
/// Maximum share of outliers in a channel.
const MAX_OUTLIERS: f64 = 0.01;

/// A heading that differs from the one before by more than this, in degrees or radians, stands for a missing number, such
/// as -999.
const LEAP: f64 = 400.0;
/// Full turns in radians and degrees, with a tolerance for rounding.
const TURNS: [f64; 2] = [TAU + 2e-3, 360.5];
/// No vehicle turns by this share of a turn, and back, between samples less than QUICK apart \[s\].
const FAR: f64 = 0.25;
const QUICK: f64 = 1.2;
/// Minimum number of headings for a decision about strays.
const MIN_HEADINGS: usize = 20;
/// The median of this many first headings stands for the one before the first.
const FIRST: usize = 11;

/// Drops single values beyond a multiple of the limits.
pub fn drop_outliers(samples: &mut RawSamples, factor: f64) {
    for channel in Channel::ALL {
        let bound = factor * limit(channel);
        let beyond = |sample: &&RawSample| sample.value.abs() > bound;
        let lines = samples.of(channel).filter(beyond);
        let lines = lines.map(|sample| sample.line).collect();
        let why = format!("are beyond {bound} {}", channel.unit());
        drop_lines(samples, channel, lines, &why);
    }
}

/// Drops single headings that are far from all others; the others may be wrapped or in degrees.
pub fn drop_leaps(samples: &mut RawSamples) {
    let mut lines = Vec::new();
    for run in &samples.runs {
        let headings = &run.channels[Channel::Heading.index()];
        let first = headings.iter().take(FIRST).map(|one| one.value);
        let Some(mut last) = upper_median(first.collect()) else {
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
    drop_lines(samples, Channel::Heading, lines, &why);
}

/// Drops single headings outside the full turn, in radians or else in degrees, that holds all others. Such numbers stand
/// for missing ones, for example -1 degree, and would hide that the others are wrapped.
pub fn drop_strays(samples: &mut RawSamples) {
    for turn in TURNS {
        let runs = samples.runs.iter();
        let lines = runs.flat_map(|run| strays(&run.channels[Channel::Heading.index()], turn));
        let lines = lines.collect();
        let why = format!("are outside of the full turn ({turn:.1}) that all others keep to");
        if drop_lines(samples, Channel::Heading, lines, &why) {
            return;
        }
    }
}

/// Lines of the few samples outside a turn that holds all others, if each is far from its neighbours.
fn strays(headings: &[RawSample], turn: f64) -> Vec<usize> {
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
    let outside = |sample: &RawSample| !(low..=low + turn).contains(&sample.value);
    let few = 1.0_f64.max(MAX_OUTLIERS * headings.len() as f64);
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
    let many = headings.len() < MIN_HEADINGS || (headings.len() - count) as f64 > few;
    if many || !all.iter().all(|index| is_far(*index)) {
        return Vec::new();
    }
    all.into_iter().map(|k| headings[k].line).collect()
}

/// Drops the values of these lines, unless they are too many for outliers. Returns whether any was dropped.
fn drop_lines(
    samples: &mut RawSamples,
    channel: Channel,
    mut lines: Vec<usize>,
    why: &str,
) -> bool {
    let (count, total) = (lines.len(), samples.of(channel).count());
    if count as f64 > 1.0_f64.max(MAX_OUTLIERS * total as f64) || count == total {
        return false;
    }
    lines.sort_unstable();
    for run in &mut samples.runs {
        run.channels[channel.index()].retain(|sample| lines.binary_search(&sample.line).is_err());
    }
    let text = format!("{count} of {total} values {why} and taken as missing");
    let line = lines.first().copied().unwrap_or_default();
    samples.note(
        NoteKind::Outlier,
        Some(channel),
        Occurrences { count, line },
        text,
    );
    count > 0
}

/// Checks the limits. Wheel speeds whose unit is doubted may be beyond theirs, as motors before a gear are.
///
/// # Errors
/// The first value of a channel beyond its limit, with the units that it may be in.
pub fn check(samples: &RawSamples) -> Result<(), CsvError> {
    let is_doubted = samples
        .notes
        .iter()
        .any(|note| note.kind == NoteKind::Suspicion && note.channel == Some(Channel::OmegaLeft));
    for channel in Channel::ALL {
        let is_wheel = matches!(channel, Channel::OmegaLeft | Channel::OmegaRight);
        let bound = if is_doubted && is_wheel {
            ANY_UNIT * limit(channel)
        } else {
            limit(channel)
        };
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
