//! Charts as SVG, coloured by the page's style sheet so that they follow light and dark.

mod bars;
mod frame;
mod mark;
mod thin;

pub use bars::{Bar, Bars, Tint};
pub use mark::Mark;

use super::number::digits;
use crate::display::visible;
use frame::{Frame, SIZE};
use std::fmt::Write;
use std::ops::RangeInclusive;
use thin::{connected, thinned};

/// More points per line are not visible.
const MOST_POINTS: usize = 700;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Connected.
    Line,
    /// As dots.
    Dots,
    /// Connected, in the colour of this step of the sequential scale, 0 to 5.
    Step(usize),
    /// Connected, broad and pale, to mark a part of a line that is drawn over it.
    Halo,
    /// As large dots in the text's colour.
    Points,
}

/// Points with a name; those after a gap begin a new part.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend; lines after the first of one name share its entry and colour.
    pub name: String,
    /// Parts of connected points; one that is not finite interrupts.
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
    /// What lies beneath, with its name in the legend.
    pub marks: Vec<(&'static str, Mark)>,
    /// Whether both axes have one scale.
    pub is_map: bool,
    /// How high it is; its width is 360.
    pub height: f64,
}

impl Chart {
    /// A chart without lines, of the usual size.
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            lines: Vec::new(),
            marks: Vec::new(),
            is_map: false,
            height: SIZE.1,
        }
    }

    /// The chart as an HTML figure with a legend; nothing where no line has a point.
    #[must_use]
    pub fn figure(&self) -> String {
        let Some((drawing, legend)) = self.draw() else {
            return String::new();
        };
        let opening = opening(&self.title, &self.in_words(), self.height);
        opening + &drawing + "</svg>" + &legend.html() + "</figure>\n"
    }

    /// Axes, marks and lines, and what stands in the legend.
    fn draw(&self) -> Option<(String, Legend)> {
        let (x, y) = self.ranges()?;
        let frame = Frame::new((SIZE.0, self.height), x, y, self.is_map);
        let mut svg = String::new();
        let mut legend = Legend::default();
        for (name, mark) in &self.marks {
            frame.mark(&mut svg, mark);
            legend.add(2, name, mark.class().into());
        }
        frame.axes(&mut svg, &self.x_label, &self.y_label);
        let mut coloured: Vec<&str> = Vec::new();
        for line in self.lines.iter().filter(|line| !line.parts.is_empty()) {
            let place = coloured
                .iter()
                .position(|name| *name == line.name)
                .unwrap_or(coloured.len());
            if matches!(line.stroke, Stroke::Line | Stroke::Dots) && place == coloured.len() {
                coloured.push(&line.name);
            }
            frame.line(&mut svg, line, place);
            let (rank, swatch) = match line.stroke {
                Stroke::Line | Stroke::Dots => (0, format!("s{place}")),
                Stroke::Step(step) => (0, format!("m{step}")),
                Stroke::Halo => (1, "halo".into()),
                Stroke::Points => (1, "points".into()),
            };
            legend.add(rank, &line.name, swatch);
        }
        Some((svg, legend))
    }

    /// What it shows, for those who do not see it: the axes, and from where to where each line goes.
    fn in_words(&self) -> String {
        let mut ends: Vec<(&str, f64, f64)> = Vec::new();
        for line in &self.lines {
            let values = line.parts.iter().flatten().map(|point| point.1);
            for value in values.filter(|value| value.is_finite()) {
                match ends.iter_mut().find(|known| known.0 == line.name) {
                    Some(known) => (known.1, known.2) = (known.1.min(value), known.2.max(value)),
                    None => ends.push((&line.name, value, value)),
                }
            }
        }
        let ends = ends.iter().map(|(name, low, high)| {
            let colon = if name.is_empty() { "" } else { ": " };
            format!("{name}{colon}{} to {}", digits(*low, 3), digits(*high, 3))
        });
        let ends: Vec<String> = ends.collect();
        format!(
            "{} over {}; {}",
            self.y_label,
            self.x_label,
            ends.join("; ")
        )
    }

    fn ranges(&self) -> Option<(RangeInclusive<f64>, RangeInclusive<f64>)> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        for line in &self.lines {
            points.extend(line.parts.iter().flatten());
        }
        points.retain(|point| point.0.is_finite() && point.1.is_finite());
        if points.is_empty() {
            return None;
        }
        let first = points[0].0;
        for (_, mark) in &self.marks {
            match mark {
                Mark::Span(..) => {}
                Mark::Band(parts) => {
                    let ends = parts.iter().flatten();
                    points.extend(ends.flat_map(|p| [(p.0, p.1), (p.0, p.2)]));
                }
                Mark::Circle((x, y), radius) => {
                    points.extend([(x - radius, y - radius), (x + radius, y + radius)]);
                }
                Mark::Zero => points.push((first, 0.0)),
            }
        }
        Some((
            range(points.iter().map(|point| point.0))?,
            range(points.iter().map(|point| point.1))?,
        ))
    }
}

/// The beginning of a figure, up to its drawing, with what it shows in words.
fn opening(title: &str, words: &str, height: f64) -> String {
    format!(
        "<figure><figcaption>{}</figcaption><svg viewBox=\"0 0 {} {height}\" role=\"img\" \
         aria-label=\"{}\">\n",
        escape(title),
        SIZE.0,
        escape(&format!("{title}: {words}"))
    )
}

/// Charts in two columns as an SVG file that stands alone, with the colours of the page's style sheet.
#[must_use]
pub fn sheet(title: &str, charts: &[Chart]) -> String {
    const HEADER: f64 = 42.0;
    const MARGIN: f64 = 14.0;
    let height = charts
        .iter()
        .fold(0.0, |most: f64, chart| most.max(chart.height));
    let cell = (SIZE.0 + 2.0 * MARGIN, height + HEADER + MARGIN);
    let (width, total) = (
        2.0 * cell.0,
        30.0 + cell.1 * charts.len().div_ceil(2) as f64,
    );
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {width} {total}\">\n\
         <style>{SHEET_STYLE}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\
         <text class=\"title\" x=\"{MARGIN}\" y=\"22\">{2}</text>\n",
        1.5 * width,
        1.5 * total,
        escape(title)
    );
    for (place, chart) in charts.iter().enumerate() {
        let (x, y) = (
            cell.0 * (place % 2) as f64 + MARGIN,
            30.0 + cell.1 * (place / 2) as f64,
        );
        let (drawing, legend) = chart.draw().unwrap_or_default();
        let _ = writeln!(
            svg,
            "<g transform=\"translate({x} {y})\"><text class=\"name\" y=\"14\">{}</text>{}\
             <g transform=\"translate(0 {HEADER})\">\n{drawing}</g></g>",
            escape(&chart.title),
            legend.svg(32.0)
        );
    }
    svg + "</svg>\n"
}

/// The style sheet of a [`sheet`]: the light colours of the page's.
const SHEET_STYLE: &str = "\
    text{font:11px sans-serif;fill:#63636a}.name,.title{fill:#1c1c1e;font-weight:600}.title{font-size:14px}\
    path{fill:none;stroke-linejoin:round;stroke-linecap:round;stroke-width:1.3}.grid{stroke:#e0e0e6;stroke-width:1}\
    .points{stroke:#1c1c1e;stroke-width:9}.s0{stroke:#1f69b4}.s1{stroke:#c74a0a}.s2{stroke:#288c50}.s3{stroke:#823c96}";

/// Names with their swatches, each once: lines, what marks parts of them, what lies beneath.
#[derive(Default)]
struct Legend(Vec<(usize, String, String)>);

impl Legend {
    fn add(&mut self, rank: usize, name: &str, swatch: String) {
        if !name.is_empty() && self.0.iter().all(|entry| entry.1 != name) {
            self.0.push((rank, name.into(), swatch));
        }
    }

    /// In a row of an SVG file, whose letters are about so wide.
    fn svg(&self, y: f64) -> String {
        const LETTER: f64 = 5.6;
        let mut x = 0.0;
        let entries = self.0.iter().map(|(_, name, swatch)| {
            let (line, text) = (x, x + 20.0);
            x = text + LETTER * name.chars().count() as f64 + 12.0;
            let middle = y - 4.0;
            let name = escape(name);
            format!("<path class=\"{swatch}\" d=\"M{line} {middle}h16\"/><text x=\"{text}\" y=\"{y}\">{name}</text>")
        });
        entries.collect()
    }

    fn html(mut self) -> String {
        self.0.sort_by_key(|entry| entry.0);
        let entries = self.0.iter().map(|(_, name, swatch)| {
            format!("<span><i class=\"{swatch}\"></i>{}</span> ", escape(name))
        });
        let entries: String = entries.collect();
        if entries.is_empty() {
            return entries;
        }
        format!("<p class=\"legend\">{entries}</p>")
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

impl Frame {
    fn line(&self, svg: &mut String, line: &Line, place: usize) {
        let total: usize = line.parts.iter().map(Vec::len).sum();
        let stride = total.div_ceil(MOST_POINTS).max(1);
        let dots = matches!(line.stroke, Stroke::Dots | Stroke::Points);
        let mut path = String::new();
        for part in line.parts.iter().flat_map(|part| connected(part)) {
            for (index, &(x, y)) in thinned(part, stride).iter().enumerate() {
                let (right, down) = (self.right(x), self.down(y));
                let _ = match index {
                    _ if dots || part.len() == 1 => write!(path, "M{right:.1} {down:.1}h0"),
                    0 => write!(path, "M{right:.1} {down:.1}"),
                    _ => write!(path, "L{right:.1} {down:.1}"),
                };
            }
        }
        if path.is_empty() {
            return;
        }
        let class = match line.stroke {
            Stroke::Line => format!("line s{place}"),
            Stroke::Dots => format!("dots s{place}"),
            Stroke::Step(step) => format!("step m{step}"),
            Stroke::Halo => "halo".into(),
            Stroke::Points => "points".into(),
        };
        let _ = writeln!(svg, "<path class=\"{class}\" d=\"{path}\"/>");
    }
}

/// A text within HTML or SVG, with visible escapes for characters that these forbid or that turn text round.
#[must_use]
pub fn escape(text: &str) -> String {
    visible(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chart_without_points_is_nothing() {
        let mut chart = Chart::new("a < b", "x", "y");
        assert_eq!(chart.figure(), "");
        chart.lines.push(Line {
            name: "one".into(),
            parts: vec![vec![(f64::NAN, 2.0)]],
            stroke: Stroke::Dots,
        });
        assert_eq!(chart.figure(), "");
        chart.lines[0].parts[0].push((1.0, 2.0));
        let figure = chart.figure();
        assert!(
            figure.contains("a &lt; b") && !figure.contains("NaN"),
            "{figure}"
        );
    }

    #[test]
    fn marks_stay_within_the_plot() {
        let mut chart = Chart::new("t", "x", "y");
        chart.lines.push(Line {
            name: "one".into(),
            parts: vec![vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.5), (3.0, 2.0)]],
            stroke: Stroke::Line,
        });
        chart.marks = vec![
            ("found", Mark::Span(-5.0, 1.0)),
            ("found", Mark::Span(2.0, f64::INFINITY)),
            (
                "band",
                Mark::Band(vec![vec![
                    (0.0, -4.0, 1.0),
                    (1.0, f64::NAN, 0.0),
                    (3.0, 1.0, 9.0),
                ]]),
            ),
            ("", Mark::Zero),
        ];
        let figure = chart.figure();
        assert!(
            !figure.contains("NaN") && !figure.contains("inf"),
            "{figure}"
        );
        assert_eq!(figure.matches("class=\"span\" x=").count(), 2);
        assert_eq!(figure.matches("</i>found</span>").count(), 1);
        // The gap leaves a lone point before it, shown as a dot, and a line after it.
        let path = figure.split("class=\"line s0\" d=\"").nth(1).unwrap();
        let path = path.split('"').next().unwrap();
        let count = |letter| path.matches(letter).count();
        assert_eq!((count('M'), count('L'), count('h')), (2, 1, 1));
        // Who does not see it reads from where to where it goes.
        assert!(
            figure.contains("aria-label=\"t: y over x; one: 1.00 to 2.00\""),
            "{figure}"
        );
        // Bands widen the axis.
        assert!(figure.contains(">5</text>"), "{figure}");
    }
}
