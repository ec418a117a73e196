//! Times that repeat or run backwards, channel by channel.

use super::note;
use crate::display::number;
use crate::recording::csv::{Sample, Samples, malformed};
use crate::recording::{Channel, CsvError, Note, NoteKind};

/// A sample may stand this many places too late in the file.
const MOST_PLACES: usize = 5;
/// A late sample fits where it leaves out an interval of so many median ones.
const OPEN_PLACE: f64 = 1.5;
/// Larger shares of repeated times with different values are a clock that is too coarse.
const MOST_REPEATED: f64 = 0.02;

/// Puts late samples where they belong, and leaves out those that repeat a time.
///
/// # Errors
/// Clocks that jump back, and clocks that stand still again and again.
pub fn settle(samples: &mut Samples) -> Result<Vec<Note>, CsvError> {
    let mut notes = Vec::new();
    let places = samples.clone();
    for channel in Channel::ALL {
        let (mut late, mut repeated) = (Tally::default(), Tally::default());
        let mut total = 0;
        for run in &mut samples.runs {
            let found = &mut run.channels[channel.index()];
            total += found.len();
            reorder(found, &mut late).map_err(|[latest, sample]| {
                let expected = format!(
                    "a time later than {} s (other runs need other values in a column `run`)",
                    number(latest.time)
                );
                malformed(places.time_cell(sample.line), number(sample.time), expected)
            })?;
            thin(found, &mut repeated);
        }
        if let Some(sample) = repeated.other
            && repeated.conflicts as f64 > 1.0 + MOST_REPEATED * total as f64
        {
            let found = format!(
                "{} s for the second time with another value, as in {} places",
                number(sample.time),
                repeated.conflicts
            );
            let expected = "a clock that tells samples apart";
            return Err(malformed(places.time_cell(sample.line), found, expected));
        }
        let count = late.count;
        let text = format!("{count} late samples put where their times belong");
        notes.extend(note(NoteKind::Reordered, Some(channel), late.place(), text));
        let text = format!(
            "{} samples repeat a time, {} of them with another value; the first of each was kept",
            repeated.count, repeated.conflicts
        );
        notes.extend(note(
            NoteKind::Repeated,
            Some(channel),
            repeated.place(),
            text,
        ));
    }
    Ok(notes)
}

#[derive(Default)]
struct Tally {
    count: usize,
    line: usize,
    conflicts: usize,
    /// The first one with another value.
    other: Option<Sample>,
}

impl Tally {
    fn push(&mut self, line: usize) {
        self.count += 1;
        self.line = if self.count == 1 {
            line
        } else {
            self.line.min(line)
        };
    }

    fn place(&self) -> (usize, usize) {
        (self.count, self.line)
    }
}

/// Sorts late samples in. Fails with the latest sample and the one that does not fit behind it.
fn reorder(samples: &mut Vec<Sample>, late: &mut Tally) -> Result<(), [Sample; 2]> {
    let is_late = |pair: &[Sample]| pair[1].time < pair[0].time;
    if !samples.windows(2).any(is_late) {
        return Ok(());
    }
    let mut ahead: Vec<f64> = samples
        .windows(2)
        .map(|pair| pair[1].time - pair[0].time)
        .collect();
    ahead.retain(|interval| *interval > 0.0);
    ahead.sort_by(f64::total_cmp);
    let median = ahead.get(ahead.len() / 2).copied().unwrap_or(f64::INFINITY);
    let mut sorted: Vec<Sample> = Vec::with_capacity(samples.len());
    for &sample in samples.iter() {
        let place = sorted.partition_point(|other| other.time <= sample.time);
        if place < sorted.len() {
            let latest = sorted[sorted.len() - 1];
            let open = place > 0
                && sorted.len() - place <= MOST_PLACES
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

/// Leaves out samples with the time of the one before.
fn thin(samples: &mut Vec<Sample>, repeated: &mut Tally) {
    samples.dedup_by(|again, kept| {
        let is_same = again.time == kept.time;
        if is_same {
            repeated.push(again.line);
            if again.value != kept.value {
                repeated.conflicts += 1;
                repeated.other.get_or_insert(*again);
            }
        }
        is_same
    });
}
