//! Charts as SVG, coloured by the page's style sheet so that they follow light and dark.

mod bars;
mod frame;
mod series;

pub use bars::{BarChart, LabelledBar, Tint};
pub use series::{Line, Role, Stroke, Underlay};

use super::number::digits;
use crate::display::markup;
use frame::{Frame, SIZE, figure_opening};
use std::fmt::Write;
use std::ops::RangeInclusive;

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
    pub underlays: Vec<(&'static str, Underlay)>,
    /// Whether both axes have one scale.
    pub is_map: bool,
    /// Its height; its width is 360.
    pub height: f64,
    /// The number of the run that it shows, for the page's script: a time in one chart is marked in all of the run.
    pub run: Option<usize>,
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
            underlays: Vec::new(),
            is_map: false,
            height: SIZE.1,
            run: None,
        }
    }

    /// The chart as an HTML figure with a legend; empty where no line has a point.
    #[must_use]
    pub fn figure(&self) -> String {
        let Some((drawing, legend)) = self.draw() else {
            return String::new();
        };
        let opening = figure_opening(&self.title, &self.in_words(), self.height);
        let opening = match (self.run, self.frame()) {
            (Some(run), Some(frame)) => {
                let map = if self.is_map { " data-map" } else { "" };
                let data = format!(
                    "<svg data-run=\"{run}\"{map} data-frame=\"{}\"",
                    frame.data()
                );
                opening.replacen("<svg", &data, 1)
            }
            _ => opening,
        };
        opening + &drawing + "</svg>" + &legend.html() + "</figure>\n"
    }

    /// Axes, underlays and lines, and what stands in the legend.
    fn draw(&self) -> Option<(String, Legend)> {
        let frame = self.frame()?;
        let mut svg = String::new();
        let mut legend = Legend::default();
        for (name, underlay) in &self.underlays {
            frame.underlay(&mut svg, underlay);
            legend.add(name, (2, underlay.class().into()));
        }
        frame.axes(&mut svg, &self.x_label, &self.y_label);
        let mut coloured: Vec<&str> = Vec::new();
        for line in self.lines.iter().filter(|line| !line.pieces.is_empty()) {
            let known = coloured.iter().position(|name| *name == line.name);
            let place = known.unwrap_or(coloured.len());
            if matches!(line.stroke, Stroke::Line | Stroke::Dots) && known.is_none() {
                coloured.push(&line.name);
            }
            frame.line(&mut svg, line, place);
            legend.add(&line.name, line.stroke.swatch(place));
        }
        Some((svg, legend))
    }

    fn frame(&self) -> Option<Frame> {
        let (x, y) = self.ranges()?;
        Some(Frame::new((SIZE.0, self.height), x, y, self.is_map))
    }

    /// What it shows, for readers who do not see it: the axes, and the range of each line.
    fn in_words(&self) -> String {
        let mut ranges: Vec<(&str, f64, f64)> = Vec::new();
        for line in &self.lines {
            let values = line.pieces.iter().flatten().map(|point| point.1);
            for value in values.filter(|value| value.is_finite()) {
                match ranges.iter_mut().find(|known| known.0 == line.name) {
                    Some(known) => (known.1, known.2) = (known.1.min(value), known.2.max(value)),
                    None => ranges.push((&line.name, value, value)),
                }
            }
        }
        let ranges = ranges.iter().map(|(name, low, high)| {
            let colon = if name.is_empty() { "" } else { ": " };
            format!("{name}{colon}{} to {}", digits(*low, 3), digits(*high, 3))
        });
        let ranges: Vec<String> = ranges.collect();
        format!(
            "{} over {}; {}",
            self.y_label,
            self.x_label,
            ranges.join("; ")
        )
    }

    fn ranges(&self) -> Option<(RangeInclusive<f64>, RangeInclusive<f64>)> {
        let lines = self.lines.iter();
        let mut points: Vec<(f64, f64)> = lines
            .flat_map(|line| line.pieces.iter().flatten().copied())
            .filter(|point| point.0.is_finite() && point.1.is_finite())
            .collect();
        let first = points.first()?.0;
        for (_, underlay) in &self.underlays {
            match underlay {
                Underlay::Span(..) => {}
                Underlay::Band(pieces) => {
                    let ends = pieces.iter().flatten();
                    points.extend(ends.flat_map(|p| [(p.0, p.1), (p.0, p.2)]));
                }
                Underlay::Circle((x, y), radius) => {
                    points.extend([(x - radius, y - radius), (x + radius, y + radius)]);
                }
                Underlay::Zero => points.push((first, 0.0)),
            }
        }
        Some((
            range(points.iter().map(|point| point.0))?,
            range(points.iter().map(|point| point.1))?,
        ))
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

/// Charts in two columns as an SVG file that stands alone, with the colours of the page's style sheet.
#[must_use]
pub fn sheet(title: &str, charts: &[Chart]) -> String {
    const MARGIN: f64 = 14.0;
    const TITLE: f64 = 30.0;
    const CAPTION: f64 = 18.0;
    let drawn = charts.iter().map(Chart::draw);
    let drawn: Vec<(String, Legend)> = drawn.map(Option::unwrap_or_default).collect();
    let legends: Vec<Vec<String>> = drawn.iter().map(|(_, legend)| legend.rows()).collect();
    let legend_rows = legends.iter().map(Vec::len).max().unwrap_or(0);
    let header = CAPTION + LEGEND_ROW * legend_rows as f64;
    let height = charts.iter().map(|chart| chart.height).fold(0.0, f64::max);
    let cell = (SIZE.0 + 2.0 * MARGIN, header + height + MARGIN);
    let rows = charts.len().div_ceil(2) as f64;
    let (width, total) = (2.0 * cell.0, TITLE + rows * cell.1);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {width} {total}\">\n\
         <style>{SHEET_STYLE}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\
         <text class=\"title\" x=\"{MARGIN}\" y=\"22\">{2}</text>\n",
        1.5 * width,
        1.5 * total,
        markup(title)
    );
    for (place, (chart, (drawing, _))) in charts.iter().zip(&drawn).enumerate() {
        let x = cell.0 * (place % 2) as f64 + MARGIN;
        let y = TITLE + cell.1 * (place / 2) as f64;
        let _ = writeln!(
            svg,
            "<g transform=\"translate({x} {y})\"><text class=\"name\" y=\"14\">{}</text>",
            markup(&chart.title)
        );
        for (row, entries) in legends[place].iter().enumerate() {
            let down = CAPTION + LEGEND_ROW * row as f64;
            let _ = writeln!(svg, "<g transform=\"translate(0 {down})\">{entries}</g>");
        }
        let _ = writeln!(
            svg,
            "<g transform=\"translate(0 {header})\">\n{drawing}</g></g>"
        );
    }
    svg + "</svg>\n"
}

/// Height of a row of the legend of a [`sheet`].
const LEGEND_ROW: f64 = 15.0;

/// The style sheet of a [`sheet`]: the light colours of the page's.
const SHEET_STYLE: &str = "\
    text{font:11px sans-serif;fill:#63636a}.name,.title{fill:#1c1c1e;font-weight:600}.title{font-size:14px}\
    path{fill:none;stroke-linejoin:round;stroke-linecap:round;stroke-width:1.3}.grid{stroke:#e0e0e6;stroke-width:1}\
    .zero{stroke:#63636a;stroke-width:.8}.points{stroke:#1c1c1e;stroke-width:9}.s0{stroke:#1f69b4}.s1{stroke:#c74a0a}.s2{stroke:#288c50}.s3{stroke:#823c96}";

/// Names with the classes of their swatches, each once, with a rank: lines, what marks stretches of them, what lies beneath.
#[derive(Default)]
struct Legend(Vec<(usize, String, String)>);

impl Legend {
    fn add(&mut self, name: &str, (rank, swatch): (usize, String)) {
        if !name.is_empty() && self.0.iter().all(|entry| entry.1 != name) {
            self.0.push((rank, name.into(), swatch));
        }
    }

    /// The entries in rows of an SVG file, as wide as a chart.
    fn rows(&self) -> Vec<String> {
        /// Approximate width of a letter.
        const LETTER: f64 = 5.6;
        let mut rows = Vec::new();
        let mut x = f64::INFINITY;
        for (_, name, swatch) in &self.0 {
            let width = 20.0 + LETTER * name.chars().count() as f64;
            if x + width > SIZE.0 {
                rows.push(String::new());
                x = 0.0;
            }
            let line = if swatch == "points" {
                format!("M{} 8h0", x + 8.0)
            } else {
                format!("M{x} 8h16")
            };
            if let Some(row) = rows.last_mut() {
                let (text, name) = (x + 20.0, markup(name));
                *row += &format!(
                    "<path class=\"{swatch}\" d=\"{line}\"/><text x=\"{text}\" y=\"12\">{name}</text>"
                );
            }
            x += width + 12.0;
        }
        rows
    }

    fn html(mut self) -> String {
        if self.0.is_empty() {
            return String::new();
        }
        self.0.sort_by_key(|entry| entry.0);
        let entries = self.0.iter().map(|(_, name, swatch)| {
            format!("<span><i class=\"{swatch}\"></i>{}</span> ", markup(name))
        });
        format!("<p class=\"legend\">{}</p>", entries.collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_legend_of_a_sheet_is_no_wider_than_a_chart() {
        let mut chart = Chart::new("t", "x", "y");
        let names = [
            "rolling resistance [N]",
            "turning moment [N m]",
            "turning resistance [N m]",
            "start",
        ];
        let lines = names.map(|name| Line {
            name: name.into(),
            pieces: vec![vec![(0.0, 1.0)]],
            ..Line::default()
        });
        chart.lines = lines.into();
        let rows = chart.draw().unwrap().1.rows();
        let counts = rows.iter().map(|row| row.matches("<text").count());
        assert_eq!(counts.collect::<Vec<_>>(), [2, 2]);
    }

    #[test]
    fn a_chart_without_points_is_empty() {
        let mut chart = Chart::new("a < b", "x", "y");
        assert_eq!(chart.figure(), "");
        chart.lines.push(Line {
            name: "one".into(),
            pieces: vec![vec![(f64::NAN, 2.0)]],
            stroke: Stroke::Dots,
            ..Line::default()
        });
        assert_eq!(chart.figure(), "");
        chart.lines[0].pieces[0].push((1.0, 2.0));
        let figure = chart.figure();
        assert!(
            figure.contains("a &lt; b") && !figure.contains("NaN"),
            "{figure}"
        );
    }

    #[test]
    fn underlays_stay_within_the_plot() {
        let mut chart = Chart::new("t", "x", "y");
        chart.lines.push(Line {
            name: "one".into(),
            pieces: vec![vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.5), (3.0, 2.0)]],
            ..Line::default()
        });
        chart.underlays = vec![
            ("found", Underlay::Span(-5.0, 1.0)),
            ("found", Underlay::Span(2.0, f64::INFINITY)),
            (
                "band",
                Underlay::Band(vec![vec![
                    (0.0, -4.0, 1.0),
                    (1.0, f64::NAN, 0.0),
                    (3.0, 1.0, 9.0),
                ]]),
            ),
            ("", Underlay::Zero),
        ];
        let figure = chart.figure();
        assert!(
            !figure.contains("NaN") && !figure.contains("inf"),
            "{figure}"
        );
        assert_eq!(figure.matches("class=\"span\" x=").count(), 2);
        assert_eq!(figure.matches("</i>found</span>").count(), 1);
        // Before the gap a lone point, shown as a dot; after it a line.
        let path = figure.split("class=\"line s0\" d=\"").nth(1).unwrap();
        let path = path.split('"').next().unwrap();
        let count = |letter| path.matches(letter).count();
        assert_eq!((count('M'), count('L'), count('h')), (2, 1, 1));
        // A screen reader speaks the range.
        assert!(
            figure.contains("aria-label=\"t: y over x; one: 1.00 to 2.00\""),
            "{figure}"
        );
        // Bands widen the axis.
        assert!(figure.contains(">5</text>"), "{figure}");
    }
}
