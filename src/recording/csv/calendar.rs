//! Times as dates and times of day (ISO 8601), in seconds after the first.

use jiff::Timestamp;
use jiff::civil::{DateTime, Time};
use jiff::fmt::strtime;
use jiff::tz::TimeZone;

/// An hour and a day \[s\].
const HOUR: f64 = 3600.0;
const DAY: f64 = 86_400.0;
/// The clock is set back by an hour; samples may be as far apart as this \[s\].
const CHANGE: f64 = 120.0;

/// A moment as a cell states it \[ns\].
#[derive(Debug, Clone, Copy, PartialEq)]
enum Moment {
    /// With its offset from UTC, since 1970.
    Universal(i128),
    /// Without, since 1970 by the clock on the wall.
    Local(i128),
    /// A time of day, since midnight.
    OfDay(i128),
}

impl Moment {
    /// From a cell: RFC 3339 or ISO 8601, with `T` or a blank, `-` or `/`; day.month.year; a time of day.
    fn parse(text: &str) -> Option<Self> {
        // Shorter texts are numbers.
        if text.len() < 5 || !text.contains(':') {
            return None;
        }
        let plain = text.replace('/', "-").replace(" UTC", "Z");
        // A blank before an offset.
        let plain = plain.replace(" +", "+").replace(" Z", "Z");
        if let Ok(moment) = plain.parse::<Timestamp>() {
            return Some(Self::Universal(moment.as_nanosecond()));
        }
        let local = |moment: DateTime| {
            let moment = TimeZone::UTC.to_timestamp(moment).ok()?;
            Some(Self::Local(moment.as_nanosecond()))
        };
        // A text with an offset that did not parse above would lose it here.
        let has_offset = plain.contains(['Z', '+', '[']);
        if !has_offset && let Ok(moment) = plain.parse::<DateTime>() {
            return local(moment);
        }
        if !has_offset
            && let Ok(broken) = strtime::parse("%d.%m.%Y %H:%M:%S%.f", &plain)
            && let Ok(moment) = broken.to_datetime()
        {
            return local(moment);
        }
        let time = plain
            .parse::<Time>()
            .ok()
            .filter(|_| !plain.contains('-') && !has_offset)?;
        let seconds = i128::from(time.hour()) * 3600
            + i128::from(time.minute()) * 60
            + i128::from(time.second());
        Some(Self::OfDay(
            seconds * 1_000_000_000 + i128::from(time.subsec_nanosecond()),
        ))
    }
}

/// The moments of a table so far.
#[derive(Debug, Clone, Default)]
pub struct Calendar {
    /// The first moment and its text.
    first: Option<(Moment, String)>,
    /// The last time \[s\].
    last: f64,
    /// Added to all moments \[s\].
    shift: f64,
    notes: Vec<String>,
}

impl Calendar {
    /// Seconds after the first moment; `None` if the text is no moment, or one of another kind.
    pub fn seconds(&mut self, text: &str) -> Option<f64> {
        let moment = Moment::parse(text)?;
        let (first, _) = self.first.get_or_insert_with(|| (moment, text.to_owned()));
        let (nanoseconds, is_local, is_of_day) = match (moment, *first) {
            (Moment::Universal(now), Moment::Universal(first)) => (now - first, false, false),
            (Moment::Local(now), Moment::Local(first)) => (now - first, true, false),
            (Moment::OfDay(now), Moment::OfDay(first)) => (now - first, false, true),
            _ => return None,
        };
        let mut time = nanoseconds as f64 * 1e-9 + self.shift;
        let back = self.last - time;
        if is_of_day && back > DAY / 2.0 {
            self.shift += DAY;
            time += DAY;
            self.notes
                .push("times of day pass midnight at".to_owned() + " " + text);
        } else if is_local && back > HOUR - CHANGE && back <= HOUR {
            self.shift += HOUR;
            time += HOUR;
            self.notes.push(format!(
                "the clock goes back by an hour at {text}, as at the end of summer time; later times count on"
            ));
        }
        self.last = time;
        Some(time)
    }

    /// Whether any cell was a moment.
    pub fn is_used(&self) -> bool {
        self.first.is_some()
    }

    /// What was taken as what.
    pub fn notes(&self) -> Vec<String> {
        let Some((_, text)) = &self.first else {
            return Vec::new();
        };
        let first = format!("taken as dates and times of day; zero is {text}");
        std::iter::once(first)
            .chain(self.notes.iter().cloned())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(texts: &[&str]) -> Vec<Option<f64>> {
        let mut calendar = Calendar::default();
        let all = texts.iter().map(|text| calendar.seconds(text));
        all.collect()
    }

    fn assert_times(texts: &[&str], expected: &[f64]) {
        let found = times(texts);
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            let near = found.is_some_and(|found| (found - expected).abs() < 1e-9);
            assert!(near, "{texts:?}: {found:?} {expected}");
        }
    }

    #[test]
    fn moments_count_from_the_first() {
        let steps = [0.0, 0.05, 60.0];
        for texts in [
            [
                "2024-10-27T00:59:30.000+00:00",
                "2024-10-27T00:59:30.050+00:00",
                "2024-10-27T01:00:30Z",
            ],
            [
                "2024-10-27 00:59:30Z",
                "2024-10-27 00:59:30.05Z",
                "2024-10-27 01:00:30 UTC",
            ],
            [
                "2024/02/28 23:59:30",
                "2024/02/28 23:59:30.05",
                "2024/02/29 00:00:30",
            ],
            [
                "31.12.2023 23:59:30",
                "31.12.2023 23:59:30.05",
                "01.01.2024 00:00:30",
            ],
            ["23:59:30", "23:59:30.05", "00:00:30"],
        ] {
            assert_times(&texts, &steps);
        }
    }

    #[test]
    fn the_end_of_summer_time_is_no_step_back() {
        // With an offset the moment is known; without, the clock steps back by an hour less the step.
        assert_times(
            &["2024-10-27T02:59:59.9+02:00", "2024-10-27T02:00:00.0+01:00"],
            &[0.0, 0.1],
        );
        assert_times(
            &[
                "2024-10-27T02:59:59.9",
                "2024-10-27T02:00:00.0",
                "2024-10-27T02:00:00.1",
            ],
            &[0.0, 0.1, 0.2],
        );
        // Other steps back stay.
        assert_times(
            &["2024-10-27T02:59:59", "2024-10-27T02:49:59"],
            &[0.0, -600.0],
        );
    }

    #[test]
    fn other_texts_are_no_moments() {
        for text in [
            "12.5",
            "abc",
            "2024-13-01T00:00:00Z",
            "10-27-2024 01:02:03",
            "59:30.1x",
            "",
        ] {
            assert_eq!(times(&[text]), [None], "{text}");
        }
        // Moments of another kind than the first.
        assert_eq!(
            times(&["2024-10-27T00:00:00Z", "2024-10-27T00:00:01"])[1],
            None
        );
    }
}
