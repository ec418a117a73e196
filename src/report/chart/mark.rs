//! What lies beneath a chart's lines.

use super::MOST_POINTS;
use super::frame::Frame;
use std::fmt::Write;

/// What lies beneath the lines.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A stretch of the horizontal axis.
    Span(f64, f64),
    /// An area over the horizontal axis: place, lower and upper end. Parts as a line's: points after a gap begin a
    /// new one, one that is not finite interrupts.
    Band(Vec<Vec<(f64, f64, f64)>>),
    /// A circle on a map: centre and radius.
    Circle((f64, f64), f64),
    /// The line of zero.
    Zero,
}

impl Mark {
    /// Its class in the style sheet.
    pub fn class(&self) -> &'static str {
        match self {
            Self::Span(..) => "span",
            Self::Band(_) => "band",
            Self::Circle(..) => "patch",
            Self::Zero => "zero",
        }
    }
}

impl Frame {
    /// Draws what lies beneath the lines.
    pub fn mark(&self, svg: &mut String, mark: &Mark) {
        let class = mark.class();
        let _ = match mark {
            Mark::Span(start, end) => {
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
            Mark::Band(parts) => {
                let total: usize = parts.iter().map(Vec::len).sum();
                let stride = total.div_ceil(MOST_POINTS).max(1);
                let finite = |p: &(f64, f64, f64)| [p.0, p.1, p.2].iter().all(|v| v.is_finite());
                let pieces = parts.iter().flat_map(|part| part.split(|p| !finite(p)));
                let areas = pieces.map(|piece| self.area(piece, stride));
                let areas: String = areas.collect();
                writeln!(svg, "<path class=\"{class}\" d=\"{areas}\"/>")
            }
            Mark::Circle((x, y), radius) => writeln!(
                svg,
                "<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"{:.1}\"/>",
                self.right(*x),
                self.down(*y),
                self.right(x + radius) - self.right(*x)
            ),
            Mark::Zero => writeln!(
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
        let kept = piece.iter().enumerate();
        let kept = kept.filter(|(index, _)| index % stride == 0 || *index == last);
        let kept: Vec<_> = kept.map(|(_, point)| point).collect();
        let upper = kept.iter().map(|p| (p.0, p.2));
        let lower = kept.iter().rev().map(|p| (p.0, p.1));
        let corners = upper
            .chain(lower)
            .map(|(x, y)| format!("{:.1} {:.1}", self.right(x), self.down(y)));
        let corners: Vec<String> = corners.collect();
        format!("M{}Z", corners.join("L"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The outlines of a band.
    fn outlines(parts: Vec<Vec<(f64, f64, f64)>>) -> Vec<String> {
        let frame = Frame::new((360.0, 230.0), 0.0..=10.0, -2.0..=2.0, false);
        let mut svg = String::new();
        frame.mark(&mut svg, &Mark::Band(parts));
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
        assert_eq!(found.len(), 3, "{found:?}");
        let corners: Vec<usize> = found
            .iter()
            .map(|one| one.matches('L').count() + 1)
            .collect();
        assert_eq!(corners, [6, 4, 4]);
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
        assert!(corners.len() <= 2 * (MOST_POINTS + 1));
        // The outline turns back at the last point.
        let frame = Frame::new((360.0, 230.0), 0.0..=10.0, -2.0..=2.0, false);
        let end = format!("{:.1} ", frame.right(10.0));
        assert!(corners[corners.len() / 2].starts_with(&end), "{end}");
    }
}
