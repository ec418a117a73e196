//! A picture of a drive: path, speeds, slips, resistance and moments.

mod panel;
mod trace;

pub use trace::{Sample, Trace};

use panel::{Panel, SCALE, Series};
use plotters::prelude::*;
use ugv_terrain::display::visible_line;

/// Size of the picture and of the strip with its title, in pixels.
const SIZE: (u32, u32) = (1240, 940);
const TITLE_HEIGHT: u32 = 40;
const TITLE_SIZE: i32 = 24;
const TITLE_PLACE: (i32, i32) = (78, 14);
const NO_LIMITS: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Slips beyond these are cut off: at standstill they grow without bound.
const SLIP_LIMITS: (f64, f64) = (-1.0, 1.0);

const LEFT: RGBColor = RGBColor(31, 105, 180);
const RIGHT: RGBColor = RGBColor(208, 84, 16);
const BODY: RGBColor = RGBColor(30, 30, 30);
const SIDEWAYS: RGBColor = RGBColor(40, 140, 80);
const REFERENCE: RGBColor = RGBColor(140, 140, 140);
const RESISTING: RGBColor = RGBColor(130, 60, 150);

/// Draws a drive as SVG.
///
/// # Errors
/// What the drawing library says.
pub fn draw(trace: &Trace, terrain: &str) -> Result<String, String> {
    let mut svg = String::new();
    let (width, height) = (SIZE.0 * SCALE, SIZE.1 * SCALE);
    let area = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
    draw_on(&area, trace, terrain).map_err(|error| error.to_string())?;
    drop(area);
    // The drawing stays as fine as it is, and shows at its size in pixels.
    let fine = format!("width=\"{width}\" height=\"{height}\" viewBox");
    let coarse = format!("width=\"{}\" height=\"{}\" viewBox", SIZE.0, SIZE.1);
    Ok(svg.replacen(&fine, &coarse, 1))
}

fn draw_on(area: &panel::Area, trace: &Trace, terrain: &str) -> panel::Drawn {
    area.fill(&WHITE)?;
    let (header, body) = area.split_vertically(TITLE_HEIGHT * SCALE);
    let unit = SCALE as i32;
    let title = format!(
        "{} s on {}",
        panel::short(&trace.duration()),
        visible_line(terrain)
    );
    panel::text(
        &header,
        &title,
        (TITLE_PLACE.0 * unit, TITLE_PLACE.1 * unit),
        TITLE_SIZE * unit,
    )?;
    let panels = [path(trace), speeds(trace), slips(trace), resistances(trace)];
    for (area, panel) in body.split_evenly((2, 2)).iter().zip(&panels) {
        panel.draw(area)?;
    }
    area.present()?;
    Ok(())
}

fn path(trace: &Trace) -> Panel {
    let no_slip = trace.points(|sample| (sample.no_slip.x, sample.no_slip.y));
    let driven = trace.points(|sample| (sample.state.x, sample.state.y));
    Panel {
        title: "Path",
        x_label: "x, east [m]".into(),
        y_label: "y, north [m]",
        series: vec![
            Series::new("rolling without slip", REFERENCE, no_slip),
            Series::new("driven (dot: start)", BODY, driven),
        ],
        limits: NO_LIMITS,
        is_map: true,
    }
}

fn over_time(trace: &Trace, title: &'static str, y_label: &'static str, lines: Lines) -> Panel {
    let line = |&(name, color, value): &Line| Series::new(name, color, trace.over_time(value));
    Panel {
        title,
        x_label: trace.time_label(),
        y_label,
        series: lines.iter().map(line).collect(),
        limits: NO_LIMITS,
        is_map: false,
    }
}

type Line = (&'static str, RGBColor, fn(&Sample) -> f64);
type Lines<'a> = &'a [Line];

fn speeds(trace: &Trace) -> Panel {
    let lines: Lines = &[
        ("r \u{3c9} left", LEFT, |sample| sample.rim_speed_left),
        ("r \u{3c9} right", RIGHT, |sample| sample.rim_speed_right),
        ("V_X", BODY, |sample| sample.state.v_x),
        ("V_Y", SIDEWAYS, |sample| sample.state.v_y),
    ];
    over_time(trace, "Wheel rims and vehicle", "speed [m/s]", lines)
}

fn slips(trace: &Trace) -> Panel {
    let lines: Lines = &[
        ("left wheels", LEFT, |sample| sample.slip_left),
        ("right wheels", RIGHT, |sample| sample.slip_right),
    ];
    Panel {
        limits: SLIP_LIMITS,
        ..over_time(
            trace,
            "Longitudinal slip at the wheels' lowest points",
            "slip [-]",
            lines,
        )
    }
}

fn resistances(trace: &Trace) -> Panel {
    let lines: Lines = &[
        ("rolling resistance [N]", BODY, |sample| {
            sample.rolling_resistance
        }),
        ("turning moment [N m]", LEFT, |sample| sample.turning_moment),
        ("turning resistance [N m]", RESISTING, |sample| {
            sample.turning_resistance
        }),
    ];
    over_time(
        trace,
        "Resistance and moments",
        "force [N], moment [N m]",
        lines,
    )
}
