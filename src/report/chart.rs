//! Line charts as SVG, coloured by the page's style sheet so that they follow light and dark.

use std::fmt::Write;
use std::ops::RangeInclusive;

/// Size of a chart, and the margins around its plot (left, top, right, bottom); small enough that
/// a phone shows it without shrinking the text.
const SIZE: (f64, f64) = (360.0, 230.0);
const MARGINS: (f64, f64, f64, f64) = (46.0, 8.0, 8.0, 34.0);
/// More points per line are not visible.
const MOST_POINTS: usize = 1200;
/// Ticks per axis, about.
const TICKS: f64 = 5.0;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Connected.
    Line,
    /// As dots.
    Dots,
}

/// Points with a name; those after a gap begin a new part.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend; lines after the first of one name share its entry and colour.
    pub name: String,
    /// Parts of connected points.
    pub parts: Vec<Vec<(f64, f64)>>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// A chart with its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub x_label: String,
    /// Name and unit of the vertical axis.
    pub y_label: String,
    /// Its lines.
    pub lines: Vec<Line>,
    /// Whether both axes have one scale.
    pub is_map: bool,
}

impl Chart {
    /// The chart as an HTML figure with a legend; nothing where no line has a point.
    #[must_use]
    pub fn figure(&self) -> String {
        let Some((x, y)) = self.ranges() else {
            return String::new();
        };
        let mut svg = format!(
            "<figure><figcaption>{}</figcaption><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
            escape(&self.title),
            SIZE.0,
            SIZE.1,
            escape(&self.title)
        );
        let frame = Frame::new(x, y);
        frame.axes(&mut svg, &self.x_label, &self.y_label);
        let mut names: Vec<&str> = Vec::new();
        for line in self.lines.iter().filter(|line| !line.parts.is_empty()) {
            let place = names
                .iter()
                .position(|name| *name == line.name)
                .unwrap_or_else(|| {
                    names.push(&line.name);
                    names.len() - 1
                });
            frame.line(&mut svg, line, place);
        }
        svg += "</svg>";
        if names.len() > 1 || names.first().is_some_and(|name| !name.is_empty()) {
            svg += "<p class=\"legend\">";
            for (place, name) in names.iter().enumerate() {
                let _ = write!(svg, "<span class=\"k{place}\">{}</span> ", escape(name));
            }
            svg += "</p>";
        }
        svg + "</figure>\n"
    }

    fn ranges(&self) -> Option<(RangeInclusive<f64>, RangeInclusive<f64>)> {
        let points = || {
            self.lines
                .iter()
                .flat_map(|line| line.parts.iter().flatten())
        };
        let (mut x, mut y) = (
            range(points().map(|point| point.0))?,
            range(points().map(|point| point.1))?,
        );
        if self.is_map {
            let plot = (
                SIZE.0 - MARGINS.0 - MARGINS.2,
                SIZE.1 - MARGINS.1 - MARGINS.3,
            );
            let length = |range: &RangeInclusive<f64>| range.end() - range.start();
            let scale = (length(&x) / plot.0).max(length(&y) / plot.1);
            let widen = |range: RangeInclusive<f64>, pixels: f64| {
                let middle = (range.start() + range.end()) / 2.0;
                middle - scale * pixels / 2.0..=middle + scale * pixels / 2.0
            };
            (x, y) = (widen(x, plot.0), widen(y, plot.1));
        }
        Some((x, y))
    }
}

/// The range of finite values, with some room; never empty.
fn range(values: impl Iterator<Item = f64>) -> Option<RangeInclusive<f64>> {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    let room = if high > low {
        0.03 * (high - low)
    } else {
        0.5 + 1e-3 * low.abs()
    };
    (low <= high).then_some(low - room..=high + room)
}

/// Where values are on the picture.
struct Frame {
    x: RangeInclusive<f64>,
    y: RangeInclusive<f64>,
}

impl Frame {
    fn new(x: RangeInclusive<f64>, y: RangeInclusive<f64>) -> Self {
        Self { x, y }
    }

    fn right(&self, value: f64) -> f64 {
        let share = (value - self.x.start()) / (self.x.end() - self.x.start());
        MARGINS.0 + share * (SIZE.0 - MARGINS.0 - MARGINS.2)
    }

    fn down(&self, value: f64) -> f64 {
        let share = (value - self.y.start()) / (self.y.end() - self.y.start());
        SIZE.1 - MARGINS.3 - share * (SIZE.1 - MARGINS.1 - MARGINS.3)
    }

    fn axes(&self, svg: &mut String, x_label: &str, y_label: &str) {
        let (left, top) = (MARGINS.0, MARGINS.1);
        let (right, bottom) = (SIZE.0 - MARGINS.2, SIZE.1 - MARGINS.3);
        for tick in ticks(&self.x) {
            let at = self.right(tick.0);
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {top}V{bottom}\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{}</text>",
                bottom + 13.0,
                tick.1
            );
        }
        for tick in ticks(&self.y) {
            let at = self.down(tick.0);
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{left} {at:.1}H{right}\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{}</text>",
                left - 4.0,
                at + 3.5,
                tick.1
            );
        }
        let (middle, across) = ((left + right) / 2.0, (top + bottom) / 2.0);
        let _ = writeln!(
            svg,
            "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
             <text transform=\"translate(10 {across}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            SIZE.1 - 5.0,
            escape(x_label),
            escape(y_label)
        );
    }

    fn line(&self, svg: &mut String, line: &Line, place: usize) {
        let total: usize = line.parts.iter().map(Vec::len).sum();
        let mut path = String::new();
        for part in &line.parts {
            let stride = total.div_ceil(MOST_POINTS).max(1);
            for (index, &(x, y)) in thinned(part, stride).iter().enumerate() {
                let (right, down) = (self.right(x), self.down(y));
                let _ = match (line.stroke, index) {
                    (Stroke::Line, 1..) => write!(path, "L{right:.1} {down:.1}"),
                    (Stroke::Line, 0) => write!(path, "M{right:.1} {down:.1}"),
                    (Stroke::Dots, _) => write!(path, "M{right:.1} {down:.1}h0"),
                };
            }
        }
        let kind = match line.stroke {
            Stroke::Line => "line",
            Stroke::Dots => "dots",
        };
        let _ = writeln!(svg, "<path class=\"{kind} s{place}\" d=\"{path}\"/>");
    }
}

/// Of every two strides of points the first, the lowest and the highest, so that peaks stay.
fn thinned(points: &[(f64, f64)], stride: usize) -> Vec<(f64, f64)> {
    if stride < 2 {
        return points.to_vec();
    }
    let mut kept = Vec::new();
    for chunk in points.chunks(3 * stride) {
        let by_value =
            |a: &&(usize, &(f64, f64)), b: &&(usize, &(f64, f64))| a.1.1.total_cmp(&b.1.1);
        let chunk: Vec<_> = chunk.iter().enumerate().collect();
        let mut some: Vec<_> = [
            chunk.first(),
            chunk.iter().min_by(by_value),
            chunk.iter().max_by(by_value),
        ]
        .into_iter()
        .flatten()
        .collect();
        some.sort_by_key(|point| point.0);
        some.dedup_by_key(|point| point.0);
        kept.extend(some.into_iter().map(|point| *point.1));
    }
    kept.extend(points.last());
    kept
}

/// Round values within a range, with their texts.
fn ticks(range: &RangeInclusive<f64>) -> Vec<(f64, String)> {
    let length = range.end() - range.start();
    let power = 10f64.powf((length / TICKS).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|step| length / step <= TICKS)
        .unwrap_or(length);
    let decimals = (-(step * 1.001).log10().floor()).max(0.0) as usize;
    let first = (range.start() / step).ceil() as i64;
    let last = (range.end() / step).floor() as i64;
    let text = |value: f64| format!("{:.decimals$}", value + 0.0);
    (first..=last)
        .map(|k| (k as f64 * step, text(k as f64 * step)))
        .collect()
}

/// A text within HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let texts = |range| {
            ticks(&range)
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
    fn thinning_keeps_the_peaks() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|k| (f64::from(k), 0.0)).collect();
        points[4321].1 = 7.0;
        points[1234].1 = -3.0;
        let kept = thinned(&points, 10);
        assert!(kept.len() < 1200);
        for point in [points[0], points[4321], points[1234], points[9999]] {
            assert!(kept.contains(&point));
        }
        assert!(kept.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    #[test]
    fn chart_without_points_is_nothing() {
        let mut chart = Chart {
            title: "a < b".into(),
            x_label: "x".into(),
            y_label: "y".into(),
            lines: Vec::new(),
            is_map: false,
        };
        assert_eq!(chart.figure(), "");
        chart.lines.push(Line {
            name: "one".into(),
            parts: vec![vec![(1.0, 2.0)]],
            stroke: Stroke::Dots,
        });
        let figure = chart.figure();
        assert!(
            figure.contains("a &lt; b") && !figure.contains("NaN"),
            "{figure}"
        );
    }
}
