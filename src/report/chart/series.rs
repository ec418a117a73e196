//! Lines of a chart, and what lies beneath them.

use super::frame::Frame;
use std::fmt::Write;
use std::ops::Range;

/// More points per line are not visible.
const MAX_POINTS: usize = 700;

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stroke {
    /// Connected.
    #[default]
    Line,
    /// Connected, in the one colour of a model or of the measurement.
    Of(Role),
    /// As dots.
    Dots,
    /// Connected, in the colour of this step of the sequential scale, 0 to 5.
    Step(usize),
    /// Connected, broad and pale: it marks a stretch of a line that is drawn over it.
    Halo,
    /// As large dots in the text's colour.
    Points,
}

/// What a line of a comparison is: each has one colour in the whole page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The recording.
    Measured,
    /// The model as given.
    Given,
    /// With the refitted soil.
    Refitted,
    /// With the findings.
    Mended,
}

impl Role {
    /// Its class in the style sheet, and its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Given => "given",
            Self::Refitted => "refitted",
            Self::Mended => "mended",
        }
    }
}

impl Stroke {
    /// Classes in the style sheet of the line whose name is at this place among the coloured ones.
    fn classes(self, place: usize) -> String {
        match self {
            Self::Line => format!("line s{place}"),
            Self::Of(role) => format!("line {}", role.name()),
            Self::Dots => format!("dots s{place}"),
            Self::Step(step) => format!("step m{step}"),
            Self::Halo => "halo".into(),
            Self::Points => "points".into(),
        }
    }

    /// Class of its swatch in the legend, and the rank there: lines come before what marks them.
    pub(super) fn swatch(self, place: usize) -> (usize, String) {
        match self {
            Self::Line | Self::Dots => (0, format!("s{place}")),
            Self::Of(role) => (0, role.name().into()),
            Self::Step(step) => (0, format!("m{step}")),
            Self::Halo | Self::Points => (1, self.classes(place)),
        }
    }
}

/// Points with a name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Name in the legend; lines of one name share its entry and colour.
    pub name: String,
    /// Pieces of connected points; a point that is not finite interrupts.
    pub pieces: Vec<Vec<(f64, f64)>>,
    /// On a map, the time of each point \[s\], in pieces as the points; empty for none.
    pub times: Vec<Vec<f64>>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// What lies beneath the lines.
#[derive(Debug, Clone, PartialEq)]
pub enum Underlay {
    /// A stretch of the horizontal axis.
    Span(f64, f64),
    /// An area over the horizontal axis, in pieces as a line: place, lower and upper end.
    Band(Vec<Vec<(f64, f64, f64)>>),
    /// A circle on a map: centre and radius.
    Circle((f64, f64), f64),
    /// The line of zero.
    Zero,
}

impl Underlay {
    /// Its class in the style sheet.
    pub(super) fn class(&self) -> &'static str {
        match self {
            Self::Span(..) => "span",
            Self::Band(_) => "band",
            Self::Circle(..) => "patch",
            Self::Zero => "zero",
        }
    }
}

impl Frame {
    /// Draws a line whose name is at this place among the coloured ones.
    pub(super) fn line(&self, svg: &mut String, line: &Line, place: usize) {
        let total: usize = line.pieces.iter().map(Vec::len).sum();
        let stride = total.div_ceil(MAX_POINTS).max(1);
        let dots = matches!(line.stroke, Stroke::Dots | Stroke::Points);
        let has_times = line.times.iter().flatten().all(|time| time.is_finite());
        let (mut path, mut times) = (String::new(), String::new());
        for (number, piece) in line.pieces.iter().enumerate() {
            let clock = line.times.get(number).filter(|_| has_times);
            for run in finite_runs(piece) {
                for (index, at) in thinned(&piece[run.clone()], stride).into_iter().enumerate() {
                    let (x, y) = piece[run.start + at];
                    let (right, down) = (self.right(x), self.down(y));
                    let _ = match index {
                        _ if dots || run.len() == 1 => write!(path, "M{right:.1} {down:.1}h0"),
                        0 => write!(path, "M{right:.1} {down:.1}"),
                        _ => write!(path, "L{right:.1} {down:.1}"),
                    };
                    if let Some(time) = clock.and_then(|clock| clock.get(run.start + at)) {
                        let _ = write!(times, "{time:.2} ");
                    }
                }
            }
        }
        if !path.is_empty() {
            let class = line.stroke.classes(place);
            let times = match times.trim_end() {
                "" => String::new(),
                times => format!(" data-t=\"{times}\""),
            };
            let _ = writeln!(svg, "<path class=\"{class}\"{times} d=\"{path}\"/>");
        }
    }

    /// Draws what lies beneath the lines.
    pub(super) fn underlay(&self, svg: &mut String, underlay: &Underlay) {
        let class = underlay.class();
        let _ = match underlay {
            Underlay::Span(start, end) => {
                let within = |value: f64| self.right(value.clamp(*self.x.start(), *self.x.end()));
                let (left, right) = (within(*start), within(*end));
                writeln!(
                    svg,
                    "<rect class=\"{class}\" x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                    self.top(),
                    (right - left).max(1.0),
                    self.bottom() - self.top()
                )
            }
            Underlay::Band(pieces) => {
                let total: usize = pieces.iter().map(Vec::len).sum();
                let stride = total.div_ceil(MAX_POINTS).max(1);
                let finite = |p: &(f64, f64, f64)| [p.0, p.1, p.2].iter().all(|v| v.is_finite());
                let pieces = pieces
                    .iter()
                    .flat_map(|piece| piece.split(|point| !finite(point)));
                let areas: String = pieces.map(|piece| self.area(piece, stride)).collect();
                writeln!(svg, "<path class=\"{class}\" d=\"{areas}\"/>")
            }
            Underlay::Circle((x, y), radius) => writeln!(
                svg,
                "<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"{:.1}\"/>",
                self.right(*x),
                self.down(*y),
                self.right(x + radius) - self.right(*x)
            ),
            Underlay::Zero => writeln!(
                svg,
                "<path class=\"{class}\" d=\"M{:.1} {:.1}H{:.1}\"/>",
                self.left(),
                self.down(0.0),
                self.edge()
            ),
        };
    }

    /// The outline of a piece of a band: along the upper ends, and back along the lower ones.
    fn area(&self, piece: &[(f64, f64, f64)], stride: usize) -> String {
        let Some(last) = piece.len().checked_sub(1) else {
            return String::new();
        };
        let kept = (0..=last).filter(|index| index % stride == 0 || *index == last);
        let kept: Vec<_> = kept.map(|index| piece[index]).collect();
        let upper = kept.iter().map(|point| (point.0, point.2));
        let lower = kept.iter().rev().map(|point| (point.0, point.1));
        let corners = upper
            .chain(lower)
            .map(|(x, y)| format!("{:.1} {:.1}", self.right(x), self.down(y)));
        format!("M{}Z", corners.collect::<Vec<_>>().join("L"))
    }
}

/// Runs of finite points.
fn finite_runs(points: &[(f64, f64)]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (index, (x, y)) in points.iter().enumerate() {
        match runs.last_mut() {
            _ if !(x.is_finite() && y.is_finite()) => {}
            Some(run) if run.end == index => run.end += 1,
            _ => runs.push(index..index + 1),
        }
    }
    runs
}

/// Of every three strides of points the first, the lowest and the highest, so that peaks stay: their indices.
fn thinned(points: &[(f64, f64)], stride: usize) -> Vec<usize> {
    if stride < 2 {
        return (0..points.len()).collect();
    }
    let mut kept = Vec::new();
    for (number, chunk) in points.chunks(3 * stride).enumerate() {
        let by_height = |a: &usize, b: &usize| chunk[*a].1.total_cmp(&chunk[*b].1);
        let lowest = (0..chunk.len()).min_by(by_height);
        let highest = (0..chunk.len()).max_by(by_height);
        let mut shown = [Some(0), lowest, highest];
        shown.sort_unstable();
        let mut shown: Vec<usize> = shown.into_iter().flatten().collect();
        shown.dedup();
        kept.extend(shown.into_iter().map(|index| 3 * stride * number + index));
    }
    let last = points.len().checked_sub(1);
    kept.extend(last.filter(|last| kept.last() != Some(last)));
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        Frame::new((360.0, 230.0), 0.0..=10.0, -2.0..=2.0, false)
    }

    /// The outlines of a band.
    fn outlines(pieces: Vec<Vec<(f64, f64, f64)>>) -> Vec<String> {
        let mut svg = String::new();
        frame().underlay(&mut svg, &Underlay::Band(pieces));
        assert!(!svg.contains("NaN"), "{svg}");
        let path = svg.split(" d=\"").nth(1).unwrap();
        let path = path.split('"').next().unwrap();
        path.split_inclusive('Z').map(Into::into).collect()
    }

    #[test]
    fn a_band_spans_no_gap() {
        let point = |x: f64| (x, -1.0, 1.0);
        let broken = (8.0, f64::NAN, 1.0);
        let first = vec![point(0.0), point(1.0), point(2.0)];
        let last = vec![point(6.0), point(7.0), broken, point(9.0), point(10.0)];
        let found = outlines(vec![first, Vec::new(), last]);
        let corners = found.iter().map(|one| one.matches('L').count() + 1);
        assert_eq!(corners.collect::<Vec<_>>(), [6, 4, 4]);
        assert!(
            found
                .iter()
                .all(|one| one.starts_with('M') && one.ends_with('Z'))
        );
    }

    #[test]
    fn a_long_band_is_thinned_and_keeps_its_end() {
        let long = (0..=10_000).map(|k| (1e-3 * f64::from(k), -1.0, 1.0));
        let outline = outlines(vec![long.collect()]).remove(0);
        let corners: Vec<&str> = outline.trim_matches(['M', 'Z']).split('L').collect();
        assert!(corners.len() <= 2 * (MAX_POINTS + 1));
        // The outline turns back at the last point.
        let end = format!("{:.1} ", frame().right(10.0));
        assert!(corners[corners.len() / 2].starts_with(&end), "{end}");
    }

    #[test]
    fn thinning_keeps_the_peaks() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|k| (f64::from(k), 0.0)).collect();
        points[4321].1 = 7.0;
        points[1234].1 = -3.0;
        let kept = thinned(&points, 10);
        assert!(kept.len() < 1200);
        for point in [0, 4321, 1234, 9999] {
            assert!(kept.contains(&point));
        }
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
