//! One diagram of a picture: axes with units, lines, and a legend above them.

use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Line<'a> = LineSeries<SVGBackend<'a>, (f64, f64)>;
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);

/// Drawing units per pixel of the picture: the library rounds to whole units, which would
/// show as steps in the lines.
pub const SCALE: u32 = 8;
const UNIT: i32 = SCALE as i32;

/// Around a panel, above its axes for title and legend, beside and below them for labels.
const MARGIN: u32 = 12 * SCALE;
/// Half of the last tick's label reaches beyond the axis.
const MARGIN_RIGHT: u32 = 22 * SCALE;
const HEADER: u32 = 52 * SCALE;
const LABELS_BESIDE: u32 = 66 * SCALE;
const LABELS_BELOW: u32 = 46 * SCALE;
/// Ticks, letters, the legend's lines and gaps.
const TICK: i32 = 4 * UNIT;
const TITLE_SIZE: i32 = 18 * UNIT;
const LEGEND_SIZE: i32 = 15 * UNIT;
const LABEL_SIZE: i32 = 15 * UNIT;
const SWATCH: i32 = 18 * UNIT;
const LEGEND_GAP: i32 = 7 * UNIT;
const LINE_WIDTH: u32 = 2 * SCALE;
/// The first line lies below the others, and shows beside one that covers it.
const FIRST_LINE_WIDTH: u32 = 3 * SCALE;
const DOT: i32 = 5 * UNIT;
/// Width of a letter as a share of the font's size.
const LETTER: f64 = 0.44;
/// Free space beyond the largest values, as a share of their range, and the narrowest range.
const PADDING: f64 = 0.06;
const LEAST_WIDTH: f64 = 1e-3;

/// A line with its name.
pub struct Series {
    name: &'static str,
    color: RGBColor,
    points: Vec<(f64, f64)>,
}

impl Series {
    pub fn new(name: &'static str, color: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            name,
            color,
            points,
        }
    }

    /// The line's visible parts.
    fn parts<'b>(
        &self,
        style: ShapeStyle,
        limits: &Range<f64>,
    ) -> impl Iterator<Item = Line<'b>> + use<'b> {
        clipped(&self.points, limits)
            .into_iter()
            .map(move |part| LineSeries::new(part, style))
    }
}

/// A diagram.
pub struct Panel {
    pub title: &'static str,
    pub x_label: String,
    pub y_label: &'static str,
    pub series: Vec<Series>,
    /// Values beyond these are cut off.
    pub limits: (f64, f64),
    /// A map has equal scales on both axes and a dot where its last line begins.
    pub is_map: bool,
}

impl Panel {
    /// Draws the diagram over a whole area.
    pub fn draw(&self, area: &Area) -> Drawn {
        let area = area.margin(MARGIN, MARGIN, MARGIN, MARGIN_RIGHT);
        let (header, body) = area.split_vertically(HEADER);
        self.draw_header(&header)?;
        let (width, height) = body.dim_in_pixel();
        let (x, y) = self.ranges(width - LABELS_BESIDE, height - LABELS_BELOW);
        let mut chart = ChartBuilder::on(&body)
            .set_label_area_size(LabelAreaPosition::Left, LABELS_BESIDE)
            .set_label_area_size(LabelAreaPosition::Bottom, LABELS_BELOW)
            .build_cartesian_2d(x, y.clone())?;
        chart
            .configure_mesh()
            .x_desc(self.x_label.as_str())
            .y_desc(self.y_label)
            .x_labels(8)
            .y_labels(8)
            .max_light_lines(0)
            .bold_line_style(GRID.stroke_width(SCALE))
            .axis_style(INK.stroke_width(SCALE))
            .set_all_tick_mark_size(TICK)
            .label_style((FONT, LABEL_SIZE, &INK))
            .axis_desc_style((FONT, LABEL_SIZE, &INK))
            .x_label_formatter(&short)
            .y_label_formatter(&short)
            .draw()?;
        for (series, style) in self.styled() {
            for part in series.parts(style, &y) {
                chart.draw_series(part)?;
            }
        }
        if let (true, Some(last)) = (self.is_map, self.series.last()) {
            let start = last.points.iter().take(1);
            chart.draw_series(start.map(|point| Circle::new(*point, DOT, last.color.filled())))?;
        }
        Ok(())
    }

    fn styled(&self) -> impl Iterator<Item = (&Series, ShapeStyle)> {
        let widths = std::iter::once(FIRST_LINE_WIDTH).chain(std::iter::repeat(LINE_WIDTH));
        self.series
            .iter()
            .zip(widths)
            .map(|(series, width)| (series, series.color.stroke_width(width)))
    }

    /// Ranges of both axes for a diagram of so many drawing units.
    fn ranges(&self, width: u32, height: u32) -> (Range<f64>, Range<f64>) {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x = bounds(points().map(|point| point.0));
        let (low, high) = self.limits;
        let y = points().map(|point| point.1.clamp(low, high));
        if !self.is_map {
            let x = if x.is_empty() { widened(&x, 1.0) } else { x };
            return (x, padded(bounds(y.chain([0.0]))));
        }
        let (x, y) = (padded(x), padded(bounds(y)));
        let (width, height) = (f64::from(width), f64::from(height));
        let scale = f64::max((x.end - x.start) / width, (y.end - y.start) / height);
        (widened(&x, scale * width), widened(&y, scale * height))
    }

    fn draw_header(&self, area: &Area) -> Drawn {
        text(
            area,
            self.title,
            (LABELS_BESIDE as i32, 2 * UNIT),
            TITLE_SIZE,
        )?;
        let (mut x, y) = (LABELS_BESIDE as i32, 36 * UNIT);
        for (series, style) in self.styled() {
            area.draw(&PathElement::new([(x, y), (x + SWATCH, y)], style))?;
            x += SWATCH + LEGEND_GAP;
            text(area, series.name, (x, y - LEGEND_SIZE / 2), LEGEND_SIZE)?;
            let width = series.name.chars().count() as f64 * LETTER * f64::from(LEGEND_SIZE);
            x += width as i32 + 2 * LEGEND_GAP;
        }
        Ok(())
    }
}

/// Writes a text with its upper left corner at a place.
pub fn text(area: &Area, text: &str, place: (i32, i32), size: i32) -> Drawn {
    area.draw_text(text, &(FONT, size).into_font().color(&INK), place)?;
    Ok(())
}

/// A value without the noise of binary fractions.
pub fn short(value: &f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

fn bounds(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    low..high
}

/// A range with some space around, and some width in any case.
fn padded(range: Range<f64>) -> Range<f64> {
    let width = range.end - range.start;
    let least = LEAST_WIDTH.max(1e-9 * range.start.abs());
    widened(&range, (width * (1.0 + 2.0 * PADDING)).max(least))
}

/// A range of another width about the same middle.
fn widened(range: &Range<f64>, width: f64) -> Range<f64> {
    let middle = (range.start + range.end) / 2.0;
    middle - width / 2.0..middle + width / 2.0
}

/// The parts of a line within limits, cut where it crosses them.
fn clipped(points: &[(f64, f64)], limits: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let inside = |point: &(f64, f64)| limits.start <= point.1 && point.1 <= limits.end;
    let mut parts = Vec::new();
    let mut part: Vec<(f64, f64)> = points
        .first()
        .filter(|point| inside(point))
        .copied()
        .into_iter()
        .collect();
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let across = |limit: f64| {
            let share = (limit - from.1) / (to.1 - from.1);
            (from.0 + share * (to.0 - from.0), limit)
        };
        let mut crossings: Vec<_> = [limits.start, limits.end]
            .into_iter()
            .filter(|limit| {
                (from.1 < *limit && *limit < to.1) || (to.1 < *limit && *limit < from.1)
            })
            .map(across)
            .collect();
        if to.1 < from.1 {
            crossings.reverse();
        }
        part.extend(crossings);
        if inside(&to) {
            part.push(to);
        } else if !part.is_empty() {
            parts.push(std::mem::take(&mut part));
        }
    }
    parts.push(part);
    parts.retain(|part| part.len() > 1);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_limits() {
        let line = [(0.0, 0.0), (1.0, 2.0), (2.0, 2.0), (3.0, -2.0), (4.0, 0.0)];
        let expected = vec![
            vec![(0.0, 0.0), (0.5, 1.0)],
            vec![(2.25, 1.0), (2.75, -1.0)],
            vec![(3.5, -1.0), (4.0, 0.0)],
        ];
        assert_eq!(clipped(&line, &(-1.0..1.0)), expected);
        assert_eq!(clipped(&line, &(-2.0..2.0)), [line.to_vec()]);
        assert!(clipped(&line, &(5.0..6.0)).is_empty());
    }

    #[test]
    fn values_are_short() {
        assert_eq!(short(&(0.1 + 0.2)), "0.3");
        assert_eq!(short(&-1e-12), "0");
        assert_eq!(short(&1200.0), "1200");
    }
}
