//! Times that are not in seconds.

use super::agreement::{compare, gyro, heading};
use crate::display::number;
use crate::recording::channel::Channel;
use crate::recording::csv::{CsvError, Occurrences, RawSamples, malformed};
use crate::recording::note::NoteKind;
use crate::recording::statistics::{range, upper_median};

/// A unit of time, its size \[s\].
const UNITS: [(&str, f64); 3] = [
    ("milliseconds", 1e-3),
    ("microseconds", 1e-6),
    ("nanoseconds", 1e-9),
];
/// Shorter median intervals than this are certainly seconds \[s\].
const SHORTEST: f64 = 1.0;
/// Longer median intervals cannot be seconds.
const LONGEST: f64 = 5.0;
/// Rates at which vehicles are recorded \[Hz\]; only one unit gives a rate in this range.
const RATES: std::ops::RangeInclusive<f64> = 1.5..=1400.0;
/// This many wheel speeds at intervals of seconds are suspicious.
const MANY: usize = 1000;
/// Longest hole within a drive \[s\]; samples beyond a longer one are strays if they are fewer than this share.
const LONGEST_HOLE: f64 = 1e6;
const MAX_STRAYS: f64 = 0.05;
/// Largest ratio between the turning rates of heading and gyro that shows the unit; minimum correlation.
const FACTOR: f64 = 2.0;
const STRONG: f64 = 0.8;

/// Converts times in another unit to seconds. Evidence for another unit is a sampling rate too low for wheel speeds, and a
/// heading that turns by another angle than the integrated yaw rate.
///
/// # Errors
/// Intervals that are too long for seconds and fit no other unit.
pub fn to_seconds(samples: &mut RawSamples) -> Result<(), CsvError> {
    let mut intervals: Vec<f64> = Vec::new();
    for run in &samples.runs {
        let wheels = &run.channels[Channel::OmegaLeft.index()];
        intervals.extend(wheels.windows(2).map(|pair| pair[1].time - pair[0].time));
    }
    let count = intervals.len();
    let median = upper_median(intervals).unwrap_or(0.0);
    if median < SHORTEST {
        return Ok(());
    }
    let line = samples.all(Channel::OmegaLeft).line;
    let turning = turning_unit(samples, median);
    let by_rate = || {
        let fits = |unit: &(&str, f64)| RATES.contains(&(1.0 / (median * unit.1)));
        UNITS.into_iter().find(fits).filter(|_| median > LONGEST)
    };
    let evidence = format!("the median interval is {}", number(median));
    let (unit, evidence) = match (turning, by_rate()) {
        (Some(Turning::Seconds), _) => return Ok(()),
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
            return Err(malformed(samples.time_cell(line), evidence, expected));
        }
        (None, None) if count < MANY => return Ok(()),
        (None, None) => {
            let text = format!(
                "{evidence} s, which is slow for wheel speeds; left as it is: milliseconds?"
            );
            samples.note(NoteKind::Suspicion, None, Occurrences { count, line }, text);
            return Ok(());
        }
    };
    for run in &mut samples.runs {
        for sample in run.channels.iter_mut().flatten() {
            sample.time *= unit.1;
        }
    }
    let text = format!("taken as {} and converted: {evidence}", unit.0);
    samples.note(NoteKind::TimeUnit, None, Occurrences { count, line }, text);
    Ok(())
}

/// Drops the few first or last samples of a run that are very far from the others: the clock was set after the start of
/// the log.
pub fn drop_strays(samples: &mut RawSamples) {
    let (mut strays, mut off) = (Occurrences::default(), 0.0);
    for run in &mut samples.runs {
        let times = || run.channels.iter().flatten().map(|sample| sample.time);
        let [first, last] = range(times());
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
                    strays.push(sample.line);
                    off = f64::max(start - sample.time, sample.time - end).max(off);
                }
                is_kept
            });
        }
    }
    let text = format!(
        "{} values are up to {off:.3e} s from all others; left out",
        strays.count
    );
    samples.note(NoteKind::Outlier, None, strays, text);
}

/// First and last time of the stretch between holes that has nearly all samples; `None` without holes.
fn longest_stretch(times: &[f64]) -> Option<(f64, f64)> {
    let stretches = times.chunk_by(|before, after| after - before <= LONGEST_HOLE);
    let longest = stretches.max_by_key(|stretch| stretch.len())?;
    let strays = times.len() - longest.len();
    let is_clear = strays > 0 && (strays as f64) < MAX_STRAYS * times.len() as f64;
    is_clear.then(|| (longest[0], longest[longest.len() - 1]))
}

/// The time unit that fits heading and gyro.
enum Turning {
    Seconds,
    Unit(&'static str, f64),
}

/// The unit in which heading and gyro turn equally fast, if there is one.
fn turning_unit(samples: &RawSamples, interval: f64) -> Option<Turning> {
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
    fn strays_are_few_and_beyond_a_long_hole() {
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
