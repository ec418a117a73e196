//! A picture of a drive: path, speeds, slips, resistance and moments.

mod trace;

pub use trace::{Sample, Trace};

use ugv_terrain::report::chart::{Chart, Line, Stroke, sheet};

/// Slips beyond these are drawn at the limit: at standstill they grow without bound.
const SLIP_LIMITS: (f64, f64) = (-1.0, 1.0);
/// Height of a diagram.
const HEIGHT: f64 = 250.0;

type Value = fn(&Sample) -> f64;

/// Draws a drive as SVG.
pub fn draw(trace: &Trace, terrain: &str) -> String {
    let title = format!("{:.6} s on {terrain}", trace.duration());
    let title = title.replacen(".000000 s", " s", 1);
    let slip = |sample: f64| sample.clamp(SLIP_LIMITS.0, SLIP_LIMITS.1);
    let mut slips = over_time(
        trace,
        "Longitudinal slip at the wheels' lowest points",
        "slip [-]",
        &[
            ("left wheels", |s| s.slip_left),
            ("right wheels", |s| s.slip_right),
        ],
    );
    for part in slips.lines.iter_mut().flat_map(|line| &mut line.parts) {
        part.iter_mut().for_each(|point| point.1 = slip(point.1));
    }
    let speeds = over_time(
        trace,
        "Wheel rims and vehicle",
        "speed [m/s]",
        &[
            ("r \u{3c9} left", |s| s.rim_speed_left),
            ("r \u{3c9} right", |s| s.rim_speed_right),
            ("V_X", |s| s.state.v_x),
            ("V_Y", |s| s.state.v_y),
        ],
    );
    let resistances = over_time(
        trace,
        "Resistance and moments",
        "force [N], moment [N m]",
        &[
            ("rolling resistance [N]", |s| s.rolling_resistance),
            ("turning moment [N m]", |s| s.turning_moment),
            ("turning resistance [N m]", |s| s.turning_resistance),
        ],
    );
    sheet(&title, &[path(trace), speeds, slips, resistances])
}

fn path(trace: &Trace) -> Chart {
    let driven = trace.points(|s| (s.state.x, s.state.y));
    let rolled = trace.points(|s| (s.no_slip.x, s.no_slip.y));
    let start = driven[..1].to_vec();
    let line = |name: &str, stroke, points| Line {
        name: name.into(),
        parts: vec![points],
        stroke,
    };
    Chart {
        lines: vec![
            line("driven", Stroke::Line, driven),
            line("rolling without slip", Stroke::Line, rolled),
            line("start", Stroke::Points, start),
        ],
        is_map: true,
        height: HEIGHT,
        ..Chart::new("Path", "x, east [m]", "y, north [m]")
    }
}

fn over_time(trace: &Trace, title: &str, y_label: &str, values: &[(&str, Value)]) -> Chart {
    let lines = values.iter().map(|(name, value)| Line {
        name: (*name).into(),
        parts: vec![trace.over_time(*value)],
        stroke: Stroke::Line,
    });
    Chart {
        lines: lines.collect(),
        height: HEIGHT,
        ..Chart::new(title, trace.time_label(), y_label)
    }
}
