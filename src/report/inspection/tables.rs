//! The tables that text and page share.

use super::words::{noise, remark, title};
use crate::inspection::{Inspection, Quality};
use crate::recording::Recording;
use crate::report::number::{digits, fixed};

/// A row for each channel: name, unit, samples, rate \[Hz\], usual intervals \[s\], longest gap, share of gaps \[%\],
/// noise at rest and in motion.
pub fn channels(
    recording: &Recording,
    inspection: &Inspection,
    with_intervals: bool,
) -> Vec<[String; 9]> {
    let rows = inspection.channels.iter().map(|report| {
        let timing = report.timing;
        let (short, long) = timing.usual;
        let longest = digits(timing.longest, 2);
        let longest = match recording.runs.len() {
            1 => format!("{longest} s at {}", clock(timing.longest_at.0)),
            _ => format!("{longest} s"),
        };
        [
            report.channel.name().into(),
            report.channel.unit().into(),
            timing.samples.to_string(),
            digits(timing.rate(), 3),
            format!("{short:.3} .. {long:.3}"),
            longest,
            format!("{:.1}", 100.0 * timing.in_gaps),
            noise(report.noise_at_rest, with_intervals),
            noise(report.noise_in_motion, with_intervals),
        ]
    });
    rows.collect()
}

/// A time \[s\]; to a hundredth for a clock that counts from 1970.
fn clock(time: f64) -> String {
    if time.abs() < 1e4 {
        digits(time, 4)
    } else {
        format!("{time:.2}")
    }
}

/// A row for each pair of signals: the pair, delay and its interval \[s\], correlation, scale, blocks, remark.
pub fn delays(inspection: &Inspection, decimals: usize) -> Vec<[String; 7]> {
    let rows = inspection.delays.iter().map(|delay| {
        let (found, scale) = (delay.seconds, delay.scale);
        let cell = |text: String| match delay.quality {
            Quality::Unknown => "-".into(),
            _ => text,
        };
        let seconds = |value| fixed(value, decimals);
        [
            title(delay),
            cell(seconds(found.value)),
            cell(format!("{} .. {}", seconds(found.low), seconds(found.high))),
            format!("{:.decimals$}", delay.correlation),
            cell(format!(
                "{:.3} ({:.3} .. {:.3})",
                scale.value, scale.low, scale.high
            )),
            delay.blocks.to_string(),
            remark(delay).into(),
        ]
    });
    rows.collect()
}
