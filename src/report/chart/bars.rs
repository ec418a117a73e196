//! Horizontal bars.

use super::frame::{SIZE, ticks};
use super::{escape, opening};
use std::fmt::Write;

const ROW: f64 = 19.0;
const TOP: f64 = 4.0;
const BOTTOM: f64 = 34.0;
/// Room of the values' texts, right of the longest bar, at least.
const TEXT: f64 = 62.0;
/// Most intervals between ticks: labels leave less room.
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
    /// What stands beside.
    Plain,
}

/// One bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What it is of.
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
pub struct Bars {
    /// What it shows.
    pub title: String,
    /// Name and unit of the axis.
    pub x_label: String,
    /// The bars from top to bottom.
    pub bars: Vec<Bar>,
    /// End of the axis, where it is fixed.
    pub full: Option<f64>,
}

impl Bars {
    /// The chart as an HTML figure; nothing without bars.
    #[must_use]
    pub fn figure(&self) -> String {
        if self.bars.is_empty() {
            return String::new();
        }
        let width = |of: fn(&Bar) -> &str| {
            let letters = self.bars.iter().map(|bar| of(bar).chars().count());
            10.0 + LETTER * letters.max().unwrap_or(0) as f64
        };
        let left = width(|bar| &bar.label);
        let right = SIZE.0 - width(|bar| &bar.text).max(TEXT);
        let bottom = TOP + ROW * self.bars.len() as f64;
        let values = self.bars.iter().map(|bar| bar.value);
        let most = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
        let full = self.full.unwrap_or(most);
        let full = if full > 0.0 { full } else { 1.0 };
        let at = |value: f64| left + (value / full).clamp(0.0, 1.0) * (right - left);
        let rows = self.bars.iter();
        let rows: Vec<String> = rows
            .map(|bar| format!("{}: {}", bar.label, bar.text))
            .collect();
        let mut html = opening(&self.title, &rows.join("; "), bottom + BOTTOM);
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
            let top = TOP + ROW * row as f64;
            let end = if bar.value.is_finite() {
                at(bar.value)
            } else {
                left
            };
            let class = match bar.tint {
                Tint::First => "b0",
                Tint::Second => "b1",
                Tint::Plain => "b2",
            };
            let _ = writeln!(
                html,
                "<text class=\"name\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\
                 <rect class=\"{class}\" x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"1.5\"/>\
                 <text class=\"name\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                left - 5.0,
                top + 13.0,
                escape(&bar.label),
                top + 3.5,
                (end - left).max(0.8),
                ROW - 6.0,
                end + 4.0,
                top + 13.0,
                escape(&bar.text)
            );
        }
        let _ = write!(
            html,
            "<path class=\"zero\" d=\"M{left:.1} {TOP}V{bottom}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text></svg></figure>",
            f64::midpoint(left, right),
            bottom + BOTTOM - 5.0,
            escape(&self.x_label)
        );
        html + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_follow_the_values() {
        let bar = |value| Bar {
            label: "a & b".into(),
            value,
            text: format!("{value}"),
            tint: Tint::First,
        };
        let mut bars = Bars {
            title: "t".into(),
            x_label: "x".into(),
            bars: Vec::new(),
            full: None,
        };
        assert_eq!(bars.figure(), "");
        bars.bars = vec![bar(2.0), bar(1.0), bar(f64::NAN)];
        let figure = bars.figure();
        let widths: Vec<f64> = figure
            .split(" width=\"")
            .skip(1)
            .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
            .collect();
        assert!((widths[0] / widths[1] - 2.0).abs() < 0.01, "{widths:?}");
        assert!(
            figure.contains("aria-label=\"t: a &amp; b: 2; a &amp; b: 1"),
            "{figure}"
        );
        assert!(widths[2] < 1.0 && figure.contains("a &amp; b"));
    }
}
