//! Where values are on the picture, and the axes.

use crate::display::markup;
use std::fmt::Write;
use std::ops::RangeInclusive;

/// Size of a chart; small enough that a phone shows it without shrinking the text.
pub const SIZE: (f64, f64) = (360.0, 230.0);
/// Margins around the plot; the ticks' texts decide the left one.
const TOP: f64 = 8.0;
const RIGHT: f64 = 12.0;
const BOTTOM: f64 = 34.0;
/// Width of the vertical axis' name, and of a digit.
const NAME: f64 = 20.0;
const DIGIT: f64 = 6.2;
/// Maximum number of intervals between ticks.
const TICKS: f64 = 6.0;

/// The start of a figure, up to its drawing, with what it shows in words.
pub fn figure_opening(title: &str, words: &str, height: f64) -> String {
    format!(
        "<figure><figcaption>{}</figcaption><svg viewBox=\"0 0 {} {height}\" role=\"img\" \
         aria-label=\"{}\">\n",
        markup(title),
        SIZE.0,
        markup(&format!("{title}: {words}"))
    )
}

/// Where values are on the picture.
pub struct Frame {
    size: (f64, f64),
    left: f64,
    /// Range of the horizontal axis.
    pub x: RangeInclusive<f64>,
    /// Range of the vertical axis.
    pub y: RangeInclusive<f64>,
}

impl Frame {
    /// A frame of this size in pixels around ranges, widened to one scale on a map.
    pub fn new(
        size: (f64, f64),
        x: RangeInclusive<f64>,
        y: RangeInclusive<f64>,
        is_map: bool,
    ) -> Self {
        // A map's scale, and with it the ticks, depends on the margin: room for six digits.
        let longest = |y| ticks(y, TICKS).iter().map(|tick| tick.1.len()).max();
        let digits = longest(&y).unwrap_or(0).max(if is_map { 5 } else { 3 });
        let left = NAME + DIGIT * digits as f64;
        let mut frame = Self { size, left, x, y };
        if is_map {
            let (width, height) = (frame.edge() - left, frame.bottom() - TOP);
            let length = |range: &RangeInclusive<f64>| range.end() - range.start();
            let scale = (length(&frame.x) / width).max(length(&frame.y) / height);
            let widen = |range: &RangeInclusive<f64>, pixels: f64| {
                let middle = f64::midpoint(*range.start(), *range.end());
                middle - scale * pixels / 2.0..=middle + scale * pixels / 2.0
            };
            (frame.x, frame.y) = (widen(&frame.x, width), widen(&frame.y, height));
        }
        frame
    }

    /// For the page's script: the ends of the plot in pixels, and the values there.
    pub fn data(&self) -> String {
        let (x, y) = (&self.x, &self.y);
        let values =
            [*x.start(), *x.end(), *y.start(), *y.end()].map(|value| format!("{value:.6e}"));
        let ends = [self.left, self.edge(), self.bottom(), TOP].map(|end| format!("{end:.1}"));
        [ends, values].concat().join(" ")
    }

    /// Left end of the plot.
    pub fn left(&self) -> f64 {
        self.left
    }

    /// Right end of the plot.
    pub fn edge(&self) -> f64 {
        self.size.0 - RIGHT
    }

    /// Upper end of the plot.
    pub fn top(&self) -> f64 {
        TOP
    }

    /// Lower end of the plot.
    pub fn bottom(&self) -> f64 {
        self.size.1 - BOTTOM
    }

    /// Place of a value on the horizontal axis.
    pub fn right(&self, value: f64) -> f64 {
        let share = (value - self.x.start()) / (self.x.end() - self.x.start());
        self.left + share * (self.edge() - self.left)
    }

    /// Place of a value on the vertical axis.
    pub fn down(&self, value: f64) -> f64 {
        let share = (value - self.y.start()) / (self.y.end() - self.y.start());
        self.bottom() - share * (self.bottom() - TOP)
    }

    /// Grid, ticks and names.
    pub fn axes(&self, svg: &mut String, x_label: &str, y_label: &str) {
        let (left, right, bottom) = (self.left, self.edge(), self.bottom());
        for tick in ticks(&self.x, TICKS) {
            let at = self.right(tick.0);
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {TOP}V{bottom}\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{}</text>",
                bottom + 13.0,
                tick.1
            );
        }
        for tick in ticks(&self.y, TICKS) {
            let at = self.down(tick.0);
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{left:.1} {at:.1}H{right}\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{}</text>",
                left - 4.0,
                at + 3.5,
                tick.1
            );
        }
        let (middle, across) = (f64::midpoint(left, right), f64::midpoint(TOP, bottom));
        let _ = writeln!(
            svg,
            "<text x=\"{middle:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
             <text transform=\"translate(11 {across}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            self.size.1 - 5.0,
            markup(x_label),
            markup(y_label)
        );
    }
}

/// Round values within a range, with at most `max` intervals between them, and their texts.
pub fn ticks(range: &RangeInclusive<f64>, max: f64) -> Vec<(f64, String)> {
    let length = range.end() - range.start();
    let power = 10f64.powf((length / max).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|step| length / step <= max)
        .unwrap_or(length);
    let decimals = (-(step * 1.001).log10().floor()).max(0.0) as usize;
    let first = (range.start() / step).ceil() as i64;
    let last = (range.end() / step).floor() as i64;
    let text = |value: f64| format!("{:.decimals$}", value + 0.0);
    (first..=last)
        .map(|k| (k as f64 * step, text(k as f64 * step)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let texts = |range| {
            ticks(&range, TICKS)
                .into_iter()
                .map(|tick| tick.1)
                .collect::<Vec<_>>()
        };
        assert_eq!(texts(0.0..=10.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(texts(-0.3..=0.95), ["0.0", "0.5"]);
        assert_eq!(
            texts(-0.001..=0.0031),
            ["-0.001", "0.000", "0.001", "0.002", "0.003"]
        );
    }

    #[test]
    fn a_map_has_one_scale() {
        let frame = Frame::new((360.0, 300.0), 0.0..=100.0, -5.0..=5.0, true);
        let right = frame.right(1.0) - frame.right(0.0);
        let up = frame.down(0.0) - frame.down(1.0);
        assert!((right - up).abs() < 1e-9);
        assert!(frame.right(0.0) >= frame.left() && frame.right(100.0) <= frame.edge() + 1e-9);
    }
}
