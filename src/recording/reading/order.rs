//! Times that repeat or run backwards, channel by channel.

use crate::display::number;
use crate::recording::channel::Channel;
use crate::recording::csv::{CsvError, Occurrences, RawSample, RawSamples, malformed};
use crate::recording::note::NoteKind;
use crate::recording::statistics::upper_median;

/// A late sample may stand at most this many places too late in the file.
const MAX_PLACES: usize = 5;
/// A late sample fits into an interval of at least this multiple of the median one.
const OPEN_PLACE: f64 = 1.5;
/// With a larger share of repeated times with different values the clock is too coarse.
const MAX_REPEATED: f64 = 0.02;

/// Sorts late samples in, and drops those that repeat a time.
///
/// # Errors
/// Clocks that jump back, and clocks that stand still repeatedly.
pub fn settle(samples: &mut RawSamples) -> Result<(), CsvError> {
    let places = samples.clone();
    for channel in Channel::ALL {
        let (mut late, mut repeated) = (Occurrences::default(), Repeats::default());
        let mut total = 0;
        for run in &mut samples.runs {
            let found = &mut run.channels[channel.index()];
            total += found.len();
            reorder(found, &mut late).map_err(|[latest, sample]| {
                let expected = format!(
                    "a time later than {} s (sort the rows by time; other runs need other values in a column `run`)",
                    number(latest.time)
                );
                malformed(places.time_cell(sample.line), number(sample.time), expected)
            })?;
            drop_repeats(found, &mut repeated);
        }
        if let Some(sample) = repeated.other
            && repeated.conflicts as f64 > 1.0 + MAX_REPEATED * total as f64
        {
            let found = format!(
                "{} s for the second time with another value, as in {} places",
                number(sample.time),
                repeated.conflicts
            );
            let expected = "a clock with a different time for each sample";
            return Err(malformed(places.time_cell(sample.line), found, expected));
        }
        let text = format!("{} late samples put where their times belong", late.count);
        samples.note(NoteKind::Reordered, Some(channel), late, text);
        let Repeats {
            places: repeats,
            conflicts,
            ..
        } = repeated;
        let text = format!(
            "{} samples repeat a time, {conflicts} of them with another value; the first of each was kept",
            repeats.count
        );
        samples.note(NoteKind::Repeated, Some(channel), repeats, text);
    }
    Ok(())
}

/// Samples that repeat a time.
#[derive(Default)]
struct Repeats {
    places: Occurrences,
    /// Number of those with another value.
    conflicts: usize,
    /// The first of those.
    other: Option<RawSample>,
}

/// Sorts late samples in. Fails with the latest sample and the one that does not fit behind it.
fn reorder(samples: &mut Vec<RawSample>, late: &mut Occurrences) -> Result<(), [RawSample; 2]> {
    let is_late = |pair: &[RawSample]| pair[1].time < pair[0].time;
    if !samples.windows(2).any(is_late) {
        return Ok(());
    }
    let mut ahead: Vec<f64> = samples
        .windows(2)
        .map(|pair| pair[1].time - pair[0].time)
        .collect();
    ahead.retain(|interval| *interval > 0.0);
    let median = upper_median(ahead).unwrap_or(f64::INFINITY);
    let mut sorted: Vec<RawSample> = Vec::with_capacity(samples.len());
    for &sample in samples.iter() {
        let place = sorted.partition_point(|other| other.time <= sample.time);
        if place < sorted.len() {
            let latest = sorted[sorted.len() - 1];
            let open = place > 0
                && sorted.len() - place <= MAX_PLACES
                && sorted[place].time - sorted[place - 1].time >= OPEN_PLACE * median;
            if !open {
                return Err([latest, sample]);
            }
            late.push(sample.line);
        }
        sorted.insert(place, sample);
    }
    *samples = sorted;
    Ok(())
}

/// Drops samples with the time of the one before.
fn drop_repeats(samples: &mut Vec<RawSample>, repeated: &mut Repeats) {
    samples.dedup_by(|again, kept| {
        let is_same = again.time == kept.time;
        if is_same {
            repeated.places.push(again.line);
            if again.value != kept.value {
                repeated.conflicts += 1;
                repeated.other.get_or_insert(*again);
            }
        }
        is_same
    });
}
