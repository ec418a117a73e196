//! As text, for a reader in a hurry.

use super::words::{self, noise, remark, title};
use crate::display::visible_line;
use crate::inspection::{Inspection, Quality};
use crate::recording::Recording;
use crate::report::number::{digits, fixed};
use std::fmt::Write;

/// The inspection of a recording in a few aligned lines.
#[must_use]
pub fn text(recording: &Recording, inspection: &Inspection) -> String {
    let mut text = headline(recording, inspection);
    for note in &recording.notes {
        let kind = words::kind(note);
        let _ = writeln!(text, "{kind}: {}", visible_line(&note.to_string()));
    }
    let rows = inspection.channels.iter().map(|report| {
        let timing = report.timing;
        let (short, long) = timing.usual;
        let at = match recording.runs.len() {
            1 => format!(
                "{} s at {}",
                digits(timing.longest, 2),
                clock(timing.longest_at.0)
            ),
            _ => format!("{} s", digits(timing.longest, 2)),
        };
        [
            report.channel.name().into(),
            timing.samples.to_string(),
            digits(timing.rate(), 3),
            format!("{short:.3} .. {long:.3}"),
            at,
            format!("{:.1}", 100.0 * timing.in_gaps),
            noise(report.noise_at_rest, false),
            noise(report.noise_in_motion, false),
            report.channel.unit().into(),
        ]
    });
    let header = [
        "channel",
        "samples",
        "Hz",
        "interval 5..95 % [s]",
        "longest gap",
        "gaps %",
        "noise: rest",
        "motion",
        "",
    ];
    text += "\n";
    text += &table(&header.map(String::from), &rows.collect::<Vec<_>>());
    let rows = inspection.delays.iter().map(|delay| {
        let found = delay.seconds;
        let known = delay.quality != Quality::Unknown;
        let cell = |text: String| if known { text } else { "-".into() };
        [
            title(delay),
            cell(fixed(found.value, 2)),
            cell(format!(
                "{} .. {}",
                fixed(found.low, 2),
                fixed(found.high, 2)
            )),
            format!("{:.2}", delay.correlation),
            remark(delay).into(),
        ]
    });
    let header = ["delay", "s", "90 % interval", "correlation", ""];
    let rows: Vec<_> = rows.collect();
    if !rows.is_empty() {
        text += "\n";
        text += &table(&header.map(String::from), &rows);
    }
    text
}

/// A time \[s\]; to a hundredth for a clock that counts from 1970.
fn clock(time: f64) -> String {
    if time.abs() < 1e4 {
        digits(time, 4)
    } else {
        format!("{time:.2}")
    }
}

fn headline(recording: &Recording, inspection: &Inspection) -> String {
    let motion = inspection.motion;
    let mut text = format!(
        "{}: {}, {:.1} s",
        visible_line(&recording.name),
        words::runs(recording),
        motion.duration
    );
    if let Some(distance) = motion.distance {
        let _ = write!(text, ", {distance:.1} m");
    }
    if let Some(turned) = motion.turned {
        let _ = write!(text, ", turned {:.0} deg", turned.to_degrees());
    }
    let share = 100.0 * motion.at_rest / motion.duration.max(f64::MIN_POSITIVE);
    let _ = writeln!(text, ", at rest {:.1} s ({share:.0} %)", motion.at_rest);
    text
}

/// Columns as wide as their longest cells; the first and the last are aligned to the left.
fn table<const N: usize>(header: &[String; N], rows: &[[String; N]]) -> String {
    let all = || std::iter::once(header).chain(rows);
    let widths: [usize; N] = std::array::from_fn(|column| {
        all()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    });
    let mut text = String::new();
    for row in all() {
        let mut line = String::new();
        for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
            if column == 0 || column + 1 == N {
                let _ = write!(line, "{cell:<width$}  ");
            } else {
                let _ = write!(line, "{cell:>width$}  ");
            }
        }
        text += line.trim_end();
        text += "\n";
    }
    text
}
