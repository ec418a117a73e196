//! The plots of an inspection.

use super::words::title;
use crate::inspection::{Inspection, MotionSignal, heading_rate, wheel_mean};
use crate::recording::{Channel, Recording, Run, Series};
use crate::report::chart::{Chart, Line, Stroke};

/// Window for rates from a pose \[s\].
const WINDOW: f64 = 0.5;

/// All charts that the recording has data for.
pub fn charts(recording: &Recording, inspection: &Inspection) -> Vec<Chart> {
    let runs = &recording.runs;
    let time = match (runs.len(), runs.first().map_or(0.0, Run::start)) {
        (1, 0.0) => "time [s]".into(),
        (1, start) => format!("time after {start} s [s]"),
        _ => "time, runs end to end [s]".into(),
    };
    let over_time = |title: &str, y_label: &str, lines: Vec<Line>| Chart {
        lines,
        ..Chart::new(title, time.clone(), y_label)
    };
    let channel = |channel: Channel| line(runs, channel.name(), |run| run.series(channel).cloned());
    let radius = recording
        .about
        .vehicle
        .as_ref()
        .map(|vehicle| vehicle.wheel_radius);
    let rims = move |run: &Run| scaled(&wheel_mean(run)?, radius?);
    let mut charts = vec![
        path(runs),
        over_time(
            "Wheel speeds",
            "rad/s",
            vec![channel(Channel::OmegaLeft), channel(Channel::OmegaRight)],
        ),
        over_time(
            "Yaw rate",
            "rad/s",
            vec![
                channel(Channel::YawRate),
                line(runs, "rate of heading", |run| heading_rate(run, WINDOW)),
            ],
        ),
        over_time(
            "Speed",
            "m/s",
            vec![
                line(runs, "along the heading", speed),
                line(runs, "wheels' rims", rims),
                channel(Channel::VX),
            ],
        ),
        over_time("Heading", "rad", vec![channel(Channel::Heading)]),
        correlations(inspection),
        over_time("Intervals between samples", "s", intervals(runs)),
    ];
    for (title, pair) in [
        ("Sideways velocity", [Channel::VY, Channel::VY]),
        ("Accelerations", [Channel::AX, Channel::AY]),
    ] {
        let mut lines = pair.map(channel).to_vec();
        lines.dedup();
        charts.push(over_time(title, pair[0].unit(), lines));
    }
    charts
}

/// A line over the time since the first run's start, runs end to end.
fn line(runs: &[Run], name: &str, of: impl Fn(&Run) -> Option<Series>) -> Line {
    let mut offset = 0.0;
    let mut pieces = Vec::new();
    for run in runs {
        let start = run.start();
        if let Some(series) = of(run) {
            let points = series
                .samples()
                .map(|(time, value)| (offset + time - start, value));
            pieces.push(points.collect());
        }
        offset += run.duration();
    }
    Line {
        name: name.into(),
        pieces,
        ..Line::default()
    }
}

fn scaled(series: &Series, factor: f64) -> Option<Series> {
    Some(
        series
            .samples()
            .map(|(time, value)| (time, factor * value))
            .collect(),
    )
}

fn speed(run: &Run) -> Option<Series> {
    let way = MotionSignal::Distance.of(run)?;
    let times = &run.series(Channel::X)?.time;
    let speeds = times
        .iter()
        .filter_map(|time| Some((*time, way.mean_rate(*time, WINDOW)?)));
    Some(speeds.collect())
}

fn path(runs: &[Run]) -> Chart {
    let piece = |run: &Run| {
        let (x, y) = (run.series(Channel::X)?, run.series(Channel::Y)?);
        let points = x
            .samples()
            .filter_map(|(time, east)| Some((east, y.at(time)?)));
        Some(points.collect::<Vec<_>>())
    };
    let pieces: Vec<Vec<(f64, f64)>> = runs.iter().filter_map(piece).collect();
    let starts = pieces
        .iter()
        .filter_map(|piece| Some(vec![*piece.first()?]))
        .collect();
    Chart {
        lines: vec![
            Line {
                name: "path".into(),
                pieces,
                ..Line::default()
            },
            Line {
                name: "start".into(),
                pieces: starts,
                stroke: Stroke::Points,
                ..Line::default()
            },
        ],
        is_map: true,
        ..Chart::new("Path", "x, east [m]", "y, north [m]")
    }
}

fn correlations(inspection: &Inspection) -> Chart {
    let lines = inspection.delays.iter().map(|delay| Line {
        name: title(delay),
        pieces: vec![delay.curve.clone()],
        ..Line::default()
    });
    Chart {
        lines: lines.collect(),
        ..Chart::new("Correlation over delay", "delay [s]", "correlation")
    }
}

/// Intervals as dots, for each kind of sensor: one channel stands for all that its sensor measures at once.
fn intervals(runs: &[Run]) -> Vec<Line> {
    let intervals = |run: &Run, channel: Channel| -> Option<Series> {
        let series = run.series(channel)?;
        let starts = series.time.iter().copied();
        Some(starts.zip(series.intervals()).collect())
    };
    [
        Channel::OmegaLeft,
        Channel::X,
        Channel::VX,
        Channel::YawRate,
        Channel::AX,
    ]
    .map(|channel| Line {
        stroke: Stroke::Dots,
        ..line(runs, channel.name(), |run| intervals(run, channel))
    })
    .into_iter()
    .filter(|line| !line.pieces.is_empty())
    .collect()
}
