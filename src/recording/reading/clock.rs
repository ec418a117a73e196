//! Times that are not in seconds.

use super::agreement::{compare, cumulated};
use super::note;
use crate::display::number;
use crate::recording::csv::{Samples, malformed};
use crate::recording::{Channel, CsvError, Note, NoteKind};

/// A unit of time, its size \[s\].
const UNITS: [(&str, f64); 3] = [
    ("milliseconds", 1e-3),
    ("microseconds", 1e-6),
    ("nanoseconds", 1e-9),
];
/// Shorter median intervals than this are seconds without a doubt \[s\].
const SHORTEST: f64 = 1.0;
/// Longer ones cannot be seconds between samples of wheel speeds.
const LONGEST: f64 = 5.0;
/// Rates at which vehicles are recorded \[Hz\]; no two units both give one of them.
const RATES: std::ops::RangeInclusive<f64> = 1.5..=1400.0;
/// So many wheel speeds at intervals of seconds are odd.
const MANY: usize = 1000;
/// No drive has a longer hole than this \[s\], and samples beyond one are strays where they are fewer than this share.
const LONGEST_HOLE: f64 = 1e6;
const MOST_STRAYS: f64 = 0.05;
/// How far heading and gyro may differ in what they tell of the unit.
const FACTOR: f64 = 2.0;
const STRONG: f64 = 0.8;

/// Converts times to seconds where they are in another unit: the wheel speeds would otherwise
/// be sampled too slowly for anything, and heading turns by another angle than the integrated
/// yaw rate says.
///
/// # Errors
/// Intervals that are too long, but of no unit.
pub fn to_seconds(samples: &mut Samples) -> Result<Option<Note>, CsvError> {
    let mut intervals: Vec<f64> = Vec::new();
    for run in &samples.runs {
        let wheels = &run.channels[Channel::OmegaLeft.index()];
        intervals.extend(wheels.windows(2).map(|pair| pair[1].time - pair[0].time));
    }
    intervals.sort_by(f64::total_cmp);
    let median = intervals.get(intervals.len() / 2).copied().unwrap_or(0.0);
    if median < SHORTEST {
        return Ok(None);
    }
    let turning = turning_unit(samples, median);
    let by_rate = || {
        let fits = |unit: &(&str, f64)| RATES.contains(&(1.0 / (median * unit.1)));
        UNITS.into_iter().find(fits).filter(|_| median > LONGEST)
    };
    let evidence = format!("the median interval is {}", number(median));
    let (unit, evidence) = match (turning, by_rate()) {
        (Some(Turning::Seconds), _) => return Ok(None),
        (Some(Turning::Unit(name, size)), _) => {
            let heading = "heading turns accordingly less than yaw_rate says";
            ((name, size), format!("{evidence}, and {heading}"))
        }
        (None, Some(unit)) => (
            unit,
            format!("{evidence}, which as seconds is no recording"),
        ),
        (None, None) if median > LONGEST => {
            let expected =
                format!("a median interval of at most {LONGEST} s, or one in ms, us or ns");
            let line = first_line(samples);
            return Err(malformed(samples.time_cell(line), evidence, expected));
        }
        (None, None) if intervals.len() < MANY => return Ok(None),
        (None, None) => {
            let text = format!(
                "{evidence} s, which is slow for wheel speeds; left as it is: milliseconds?"
            );
            let place = (intervals.len(), first_line(samples));
            return Ok(note(NoteKind::Suspicion, None, place, text));
        }
    };
    let count = intervals.len();
    let line = first_line(samples);
    for run in &mut samples.runs {
        for sample in run.channels.iter_mut().flatten() {
            sample.time *= unit.1;
        }
    }
    let text = format!("taken as {} and converted: {evidence}", unit.0);
    Ok(note(NoteKind::TimeUnit, None, (count, line), text))
}

/// Leaves out the first or last samples of a run that lie years from the others: a clock that was set after the log began.
pub fn drop_strays(samples: &mut Samples) -> Option<Note> {
    let (mut count, mut line, mut off) = (0, usize::MAX, 0.0);
    for run in &mut samples.runs {
        let times = || run.channels.iter().flatten().map(|sample| sample.time);
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        let (first, last) =
            times().fold(nothing, |(low, high), time| (time.min(low), time.max(high)));
        if last - first <= LONGEST_HOLE {
            continue;
        }
        let mut times: Vec<f64> = times().collect();
        times.sort_by(f64::total_cmp);
        let Some((start, end)) = longest_stretch(&times) else {
            continue;
        };
        for channel in &mut run.channels {
            channel.retain(|sample| {
                let is_kept = (start..=end).contains(&sample.time);
                if !is_kept {
                    (count, line) = (count + 1, line.min(sample.line));
                    off = f64::max(start - sample.time, sample.time - end).max(off);
                }
                is_kept
            });
        }
    }
    let text = format!("{count} values are up to {off:.3e} s from all others; left out");
    note(NoteKind::Outlier, None, (count, line), text)
}

/// First and last time of the stretch between holes that has nearly all samples, where there are such holes.
fn longest_stretch(times: &[f64]) -> Option<(f64, f64)> {
    let stretches = times.chunk_by(|before, after| after - before <= LONGEST_HOLE);
    let longest = stretches.max_by_key(|stretch| stretch.len())?;
    let strays = times.len() - longest.len();
    let is_clear = strays > 0 && (strays as f64) < MOST_STRAYS * times.len() as f64;
    is_clear.then(|| (longest[0], longest[longest.len() - 1]))
}

fn first_line(samples: &Samples) -> usize {
    let first = samples.of(Channel::OmegaLeft).next();
    first.map_or(2, |sample| sample.line)
}

enum Turning {
    Seconds,
    Unit(&'static str, f64),
}

/// The unit by which the heading turns as fast as the gyro says, if one does.
fn turning_unit(samples: &Samples, interval: f64) -> Option<Turning> {
    let heading = |run: &_| cumulated(run, Channel::Heading);
    let gyro = |run: &_| cumulated(run, Channel::YawRate);
    let (correlation, slope) = compare(samples, interval, heading, gyro)?.strongest();
    let near = |size: f64| (slope / size).max(size / slope) < FACTOR;
    if correlation < STRONG {
        return None;
    }
    if near(1.0) {
        return Some(Turning::Seconds);
    }
    let unit = UNITS.into_iter().find(|(_, size)| near(*size))?;
    Some(Turning::Unit(unit.0, unit.1))
}

#[cfg(test)]
mod tests {
    use super::super::test_drive::{drive, kinds, read, text};
    use super::*;

    #[test]
    fn strays_are_few_and_beyond_a_hole_that_no_drive_has() {
        let drive = |start: f64, count: usize| (0..count).map(move |k| start + 0.1 * k as f64);
        let with = |start: f64, count: usize| drive(start, count).chain(drive(1e9, 100)).collect();
        let found = |times: Vec<f64>| longest_stretch(&times);
        assert_eq!(found(with(0.0, 5)), Some((1e9, 1e9 + 9.9)));
        // Two drives, a drive with a hole, and one drive.
        assert_eq!(found(with(0.0, 6)), None);
        assert_eq!(found(with(1e9 - 9e5, 2)), None);
        assert_eq!(found(with(0.0, 0)), None);
        assert_eq!(found(Vec::new()), None);
    }

    #[test]
    fn stamps_from_before_the_clock_was_set_are_left_out() {
        let good = drive(60.0, 5);
        let epoch = 1.7e9;
        let mut rows = good.clone();
        for (time, values) in &mut rows {
            *time += epoch;
            values.swap(0, 1);
        }
        let swapped = NoteKind::SwappedWheels;
        assert_eq!(kinds(&read(&text(&rows)).unwrap().notes), [swapped]);
        let mut stray = rows.clone();
        stray.insert(0, (0.0, rows[0].1));
        stray.push((2.0 * epoch, rows[0].1));
        let recording = read(&text(&stray)).unwrap();
        let found = kinds(&recording.notes);
        assert_eq!(found, [NoteKind::Outlier, swapped], "{:?}", recording.notes);
        assert_eq!(recording.notes[0].line, 2);
        assert!((recording.runs[0].duration() - 60.0).abs() < 0.1);
    }
}
