//! Predicted against measured.

use super::data::Trial;
use super::law::Rig;
use super::tables::Line;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

const SIZE: (u32, u32) = (1240, 900);
/// Drawing units per pixel: the library rounds to whole units.
const SCALE: u32 = 8;
const UNIT: i32 = SCALE as i32;
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);
const LEGEND_HEIGHT: u32 = 54;
const TITLE_HEIGHT: u32 = 30;

/// Slip angles \[deg\] and their colours, from dark to light, told apart also in grey.
const ANGLES: [(f64, RGBColor); 4] = [
    (0.0, RGBColor(52, 20, 110)),
    (15.0, RGBColor(160, 40, 110)),
    (30.0, RGBColor(225, 95, 60)),
    (45.0, RGBColor(240, 180, 30)),
];
/// Output, what turns it into the unit shown, and the axis.
const PANELS: [(&str, f64, Range<f64>); 3] = [
    ("traction [N]", 1.0, -55.0..15.0),
    ("side force [N]", 1.0, -42.0..6.0),
    ("sinkage [mm]", 1e3, 5.0..60.0),
];

/// Draws two laws, each in a row of three panels, as SVG.
pub fn draw(rig: &Rig, rows: [&Line; 2], trials: &[Trial]) -> Result<String, String> {
    let mut svg = String::new();
    let (width, height) = (SIZE.0 * SCALE, SIZE.1 * SCALE);
    let area = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
    draw_on(&area, rig, rows, trials).map_err(|error| error.to_string())?;
    drop(area);
    let fine = format!("width=\"{width}\" height=\"{height}\" viewBox");
    let coarse = format!("width=\"{}\" height=\"{}\" viewBox", SIZE.0, SIZE.1);
    Ok(svg.replacen(&fine, &coarse, 1))
}

fn draw_on(area: &Area, rig: &Rig, rows: [&Line; 2], trials: &[Trial]) -> Drawn {
    area.fill(&WHITE)?;
    let (header, body) = area.split_vertically(LEGEND_HEIGHT * SCALE);
    legend(&header)?;
    for (row, area) in rows.into_iter().zip(body.split_evenly((2, 1))) {
        let (title, body) = area.split_vertically(TITLE_HEIGHT * SCALE);
        let name = row.name.replace('`', "");
        text(&title, &name, (30, 6), 17)?;
        for (output, area) in body.split_evenly((1, 3)).iter().enumerate() {
            panel(area, rig, row, trials, output)?;
        }
    }
    area.present()?;
    Ok(())
}

fn panel(area: &Area, rig: &Rig, row: &Line, trials: &[Trial], output: usize) -> Drawn {
    let (label, scale, range) = &PANELS[output];
    let mut chart = ChartBuilder::on(area)
        .margin(10 * SCALE)
        .margin_right(22 * SCALE)
        .set_label_area_size(LabelAreaPosition::Left, 58 * SCALE)
        .set_label_area_size(LabelAreaPosition::Bottom, 44 * SCALE)
        .build_cartesian_2d(range.clone(), range.clone())?;
    chart
        .configure_mesh()
        .x_desc(format!("measured {label}"))
        .y_desc(format!("predicted {label}"))
        .x_labels(8)
        .y_labels(8)
        .max_light_lines(0)
        .bold_line_style(GRID.stroke_width(SCALE))
        .axis_style(INK.stroke_width(SCALE))
        .set_all_tick_mark_size(4 * UNIT)
        .label_style((FONT, 14 * UNIT, &INK))
        .axis_desc_style((FONT, 15 * UNIT, &INK))
        .x_label_formatter(&|value| format!("{value:.0}").replace('-', "\u{2212}"))
        .y_label_formatter(&|value| format!("{value:.0}").replace('-', "\u{2212}"))
        .draw()?;
    let diagonal = [(range.start, range.start), (range.end, range.end)];
    chart.draw_series(LineSeries::new(diagonal, INK.stroke_width(SCALE)))?;
    for trial in trials {
        let found = rig.predict(&row.fit.law, &row.fit.values, trial).values[output] * scale;
        let point = (trial.measured()[output] * scale, found);
        let colour = ANGLES
            .iter()
            .find(|(angle, _)| *angle == trial.beta_deg)
            .map_or(INK, |angle| angle.1);
        if trial.grouser {
            chart.draw_series([TriangleMarker::new(point, 5 * UNIT, colour.filled())])?;
        } else {
            chart.draw_series([Circle::new(point, 4 * UNIT, colour.stroke_width(2 * SCALE))])?;
        }
    }
    Ok(())
}

fn legend(area: &Area) -> Drawn {
    let mut x = 30;
    for (angle, colour) in ANGLES {
        area.draw(&Rectangle::new(at(x, 20, 16, 14), colour.filled()))?;
        let name = format!("slip angle {angle:.0} deg");
        text(area, &name, (x + 24, 19), 15)?;
        x += 160;
    }
    area.draw(&Circle::new(
        (x * UNIT, 27 * UNIT),
        4 * UNIT,
        INK.stroke_width(2 * SCALE),
    ))?;
    text(area, "smooth", (x + 12, 19), 15)?;
    x += 95;
    area.draw(&TriangleMarker::new(
        (x * UNIT, 27 * UNIT),
        5 * UNIT,
        INK.filled(),
    ))?;
    text(area, "grousers of 5 mm", (x + 12, 19), 15)?;
    x += 165;
    area.draw(&PathElement::new(
        vec![(x * UNIT, 27 * UNIT), ((x + 24) * UNIT, 27 * UNIT)],
        INK.stroke_width(SCALE),
    ))?;
    text(area, "predicted = measured", (x + 32, 19), 15)?;
    Ok(())
}

fn at(x: i32, y: i32, width: i32, height: i32) -> [(i32, i32); 2] {
    [
        (x * UNIT, y * UNIT),
        ((x + width) * UNIT, (y + height) * UNIT),
    ]
}

fn text(area: &Area, text: &str, (x, y): (i32, i32), size: i32) -> Drawn {
    let style = (FONT, size * UNIT).into_font().color(&INK);
    area.draw(&Text::new(text.to_owned(), (x * UNIT, y * UNIT), style))?;
    Ok(())
}
