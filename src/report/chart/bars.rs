//! Horizontal bars.

use super::frame::{SIZE, figure_opening, ticks};
use super::series::Role;
use crate::display::markup;
use std::fmt::Write;

const ROW: f64 = 19.0;
/// Longer labels stand above their bars.
const MAX_BESIDE: usize = 24;
/// Height of a label above its bar.
const ABOVE: f64 = 14.0;
const TOP: f64 = 4.0;
/// Left of bars whose labels stand above them.
const MARGIN: f64 = 14.0;
const BOTTOM: f64 = 34.0;
/// Minimum room for the values' texts, right of the longest bar.
const TEXT: f64 = 62.0;
/// Maximum number of intervals between ticks: labels leave less room than in other charts.
const TICKS: f64 = 3.0;
/// Width of a letter of a label or a value's text.
const LETTER: f64 = 5.9;

/// Colour of a bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tint {
    /// What matters, or physics.
    First,
    /// Sensors.
    Second,
    /// What it is compared with.
    Plain,
    /// The colour of a model.
    Of(Role),
}

/// One bar.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledBar {
    /// Its name.
    pub label: String,
    /// Its length; not finite draws none.
    pub value: f64,
    /// The value for readers.
    pub text: String,
    /// Its colour.
    pub tint: Tint,
}

/// A chart of bars.
#[derive(Debug, Clone, PartialEq)]
pub struct BarChart {
    /// What it shows.
    pub title: String,
    /// Name and unit of the axis.
    pub x_label: String,
    /// The bars from top to bottom.
    pub bars: Vec<LabelledBar>,
    /// End of the axis; without one the longest bar ends it.
    pub full: Option<f64>,
}

impl BarChart {
    /// The chart as an HTML figure; empty without bars.
    #[must_use]
    pub fn figure(&self) -> String {
        if self.bars.is_empty() {
            return String::new();
        }
        let width = |of: fn(&LabelledBar) -> &str| {
            let letters = self.bars.iter().map(|bar| of(bar).chars().count());
            10.0 + LETTER * letters.max().unwrap_or(0) as f64
        };
        let is_long = |bar: &LabelledBar| bar.label.chars().count() > MAX_BESIDE;
        let above = if self.bars.iter().any(is_long) {
            ABOVE
        } else {
            0.0
        };
        let left = if above > 0.0 {
            MARGIN
        } else {
            width(|bar| &bar.label)
        };
        let right = SIZE.0 - width(|bar| &bar.text).max(TEXT);
        let height = ROW + above;
        let bottom = TOP + height * self.bars.len() as f64;
        let values = self.bars.iter().map(|bar| bar.value);
        let longest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
        let full = self.full.unwrap_or(longest);
        let full = if full > 0.0 { full } else { 1.0 };
        let at = |value: f64| left + (value / full).clamp(0.0, 1.0) * (right - left);
        let words = self.bars.iter();
        let words: Vec<String> = words
            .map(|bar| format!("{}: {}", bar.label, bar.text))
            .collect();
        let mut html = figure_opening(&self.title, &words.join("; "), bottom + BOTTOM);
        for (value, text) in ticks(&(0.0..=full), TICKS) {
            let _ = write!(
                html,
                "<path class=\"grid\" d=\"M{0:.1} {TOP}V{bottom}\"/><text x=\"{0:.1}\" y=\"{1:.1}\" \
                 text-anchor=\"middle\">{text}</text>",
                at(value),
                bottom + 13.0
            );
        }
        for (row, bar) in self.bars.iter().enumerate() {
            let top = TOP + height * row as f64;
            let (x, anchor) = if above > 0.0 {
                (left, "start")
            } else {
                (left - 5.0, "end")
            };
            let end = if bar.value.is_finite() {
                at(bar.value)
            } else {
                left
            };
            let class = match bar.tint {
                Tint::First => "b0",
                Tint::Second => "b1",
                Tint::Plain => "b2",
                Tint::Of(role) => role.name(),
            };
            let _ = writeln!(
                html,
                "<text class=\"name\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>\
                 <rect class=\"bar {class}\" x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"1.5\"/>\
                 <text class=\"name\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                top + 13.0,
                markup(&bar.label),
                top + above + 3.5,
                (end - left).max(0.8),
                ROW - 6.0,
                end + 4.0,
                top + above + 13.0,
                markup(&bar.text)
            );
        }
        let _ = write!(
            html,
            "<path class=\"zero\" d=\"M{left:.1} {TOP}V{bottom}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text></svg></figure>",
            f64::midpoint(left, right),
            bottom + BOTTOM - 5.0,
            markup(&self.x_label)
        );
        html + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_follow_the_values() {
        let bar = |value| LabelledBar {
            label: "a & b".into(),
            value,
            text: format!("{value}"),
            tint: Tint::First,
        };
        let mut chart = BarChart {
            title: "t".into(),
            x_label: "x".into(),
            bars: Vec::new(),
            full: None,
        };
        assert_eq!(chart.figure(), "");
        chart.bars = vec![bar(2.0), bar(1.0), bar(f64::NAN)];
        let figure = chart.figure();
        let widths: Vec<f64> = figure
            .split(" width=\"")
            .skip(1)
            .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
            .collect();
        assert!((widths[0] / widths[1] - 2.0).abs() < 0.01, "{widths:?}");
        assert!(widths[2] < 1.0);
        assert!(
            figure.contains("aria-label=\"t: a &amp; b: 2; a &amp; b: 1"),
            "{figure}"
        );
    }
}
