//! Quality of satellite fixes.

use super::collect::{FixSample, Stream};
use crate::recording::upper_median;

/// Standard deviation of a receiver with corrections (RTK) \[m\].
const PRECISE: f64 = 0.1;
/// Status of a fix with ground-based corrections.
const GROUND_BASED: i8 = 2;

impl FixSample {
    /// Whether it has a position.
    pub fn is_valid(&self) -> bool {
        let [latitude, longitude, _] = self.place;
        // Comparisons with NaN are false.
        let is_somewhere = latitude != 0.0 || longitude != 0.0;
        self.status >= 0 && is_somewhere && latitude.abs() <= 90.0 && longitude.abs() <= 180.0
    }
}

/// A topic with valid fixes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fixes<'a> {
    pub topic: &'a str,
    /// Whether the stated deviation is mostly less than a decimetre.
    pub precise: bool,
}

impl<'a> Fixes<'a> {
    /// `None` without valid fixes; the invalid ones are noted.
    pub fn of(stream: &'a Stream<FixSample>, notes: &mut Vec<String>) -> Option<Self> {
        let topic = stream.topic.name.as_str();
        let all = stream.samples.iter().map(|sample| &sample.value);
        let valid: Vec<&FixSample> = all.filter(|fix| fix.is_valid()).collect();
        let lost = stream.samples.len() - valid.len();
        if lost > 0 {
            notes.push(format!(
                "{topic}: {lost} of {} fixes are invalid (status below 0, no latitude and longitude, or \
                 exactly 0 of both); left out",
                stream.samples.len()
            ));
        }
        let precise = are_precise(&valid);
        (!valid.is_empty()).then_some(Self { topic, precise })
    }
}

/// By the deviations, or by the status if most have no deviation.
fn are_precise(fixes: &[&FixSample]) -> bool {
    let known: Vec<f64> = fixes.iter().filter_map(|fix| fix.deviation).collect();
    if 2 * known.len() > fixes.len() {
        return upper_median(known).is_some_and(|deviation| deviation < PRECISE);
    }
    let corrected = fixes.iter().filter(|fix| fix.status == GROUND_BASED);
    2 * corrected.count() > fixes.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_or_status_show_precision() {
        let fix = |status, deviation| FixSample {
            status,
            place: [48.0, 11.0, 500.0],
            deviation,
        };
        let good = [fix(0, Some(0.02)), fix(0, Some(0.01)), fix(0, Some(9.0))];
        let poor = [fix(2, Some(1.2)), fix(2, Some(1.5)), fix(2, Some(0.01))];
        let corrected = [fix(2, None), fix(2, None), fix(0, Some(0.01))];
        let plain = [fix(0, None), fix(2, None), fix(0, None)];
        for (fixes, precise) in [
            (good, true),
            (poor, false),
            (corrected, true),
            (plain, false),
        ] {
            let all: Vec<&FixSample> = fixes.iter().collect();
            assert_eq!(are_precise(&all), precise, "{fixes:?}");
        }
        assert!(!are_precise(&[]));
    }
}
