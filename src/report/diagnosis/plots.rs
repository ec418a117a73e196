//! The plots of a diagnosis: where on the path, when, and what is left over.

use super::words;
use crate::diagnosis::{Diagnosis, Interval, ResidualTrace, RunTrace, WrenchTrace};
use crate::report::chart::{Chart, Line, Mark, Stroke};
use crate::report::number::shown;

/// More runs are not plotted.
const MOST_RUNS: usize = 4;
/// Points of a map's path, about.
const MAP_POINTS: usize = 900;
/// Height of a map, that of two charts with what lies between them.
const MAP_HEIGHT: f64 = 470.0;
/// A stretch that covers more of a run marks nothing.
const WHOLE: f64 = 0.95;
/// Residuals are cut off at so many times what nearly all stay under, if one goes so much further again.
const NEARLY_ALL: f64 = 0.98;
const CUT: f64 = 2.0;
/// A gap of so many intervals between points interrupts a path.
const GAP: f64 = 8.0;
/// Times from here on have too many digits for an axis \[s\].
const LONG_CLOCK: f64 = 1e5;

/// The runs to be plotted, in their order: those with a place of a finding first, then the worst.
pub fn chosen(diagnosis: &Diagnosis) -> Vec<&RunTrace> {
    let mut runs: Vec<(usize, &RunTrace)> = diagnosis.runs.iter().enumerate().collect();
    let key = |run: &RunTrace| {
        let finite = run.mismatch.iter().filter(|value| value.is_finite());
        let (count, sum) = finite.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v * v));
        (
            places(run, diagnosis).next().is_some(),
            sum / f64::max(count, 1.0),
        )
    };
    runs.sort_by(|a, b| {
        let (a, b) = (key(a.1), key(b.1));
        b.0.cmp(&a.0).then(b.1.total_cmp(&a.1))
    });
    runs.truncate(MOST_RUNS);
    runs.sort_by_key(|run| run.0);
    runs.into_iter().map(|run| run.1).collect()
}

/// All figures of a run.
pub fn figures(run: &RunTrace, diagnosis: &Diagnosis) -> String {
    let map = map(run, diagnosis).figure();
    let mut html = map.replacen("<figure>", "<figure class=\"tall\">", 1);
    let from = origin(run);
    let label = match from {
        0.0 => "time [s]".to_string(),
        from => format!("time after {from} s [s]"),
    };
    let spans = spans(run, diagnosis).into_iter();
    let spans: Vec<_> = spans
        .map(|(name, start, end)| (name, start - from, end - from))
        .collect();
    let over_time = |chart: Chart| {
        let x_label = label.clone();
        Chart { x_label, ..chart }.figure()
    };
    for residual in &run.residuals {
        let time = since(from, &residual.time);
        let residual = ResidualTrace {
            time,
            ..residual.clone()
        };
        html += &over_time(residuals(&residual, &spans, words::has_model(diagnosis)));
    }
    if let Some(wrench) = &run.wrench {
        let time = since(from, &wrench.time);
        let wrench = WrenchTrace {
            time,
            ..wrench.clone()
        };
        html += &wrenches(&wrench, &spans)
            .into_iter()
            .map(over_time)
            .collect::<String>();
    }
    html
}

/// From where times are shown \[s\]: a clock of more digits than an axis has room for counts from the run's start, to the
/// second.
fn origin(run: &RunTrace) -> f64 {
    let traces = run.residuals.iter().map(|residual| &residual.time);
    let first = traces.chain([&run.time]).filter_map(|time| time.first());
    let start = first
        .copied()
        .filter(|time| time.is_finite())
        .fold(f64::INFINITY, f64::min);
    if start.is_finite() && start.abs() >= LONG_CLOCK {
        start.floor()
    } else {
        0.0
    }
}

fn since(from: f64, time: &[f64]) -> Vec<f64> {
    time.iter().map(|time| time - from).collect()
}

fn places<'a>(
    run: &'a RunTrace,
    diagnosis: &'a Diagnosis,
) -> impl Iterator<Item = (&'a Interval, bool)> {
    diagnosis.findings.iter().flat_map(move |finding| {
        let here = finding
            .places
            .iter()
            .filter(|place| place.recording == run.recording && place.run == run.run);
        here.map(|place| (place, finding.local))
    })
}

/// Stretches to be marked, with what they are called.
fn spans(run: &RunTrace, diagnosis: &Diagnosis) -> Vec<(&'static str, f64, f64)> {
    let times = run
        .residuals
        .iter()
        .flat_map(|residual| &residual.time)
        .chain(&run.time);
    let (start, end) = times
        .filter(|time| time.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), time| {
            (low.min(*time), high.max(*time))
        });
    places(run, diagnosis)
        .filter(|(place, _)| place.end - place.start < WHOLE * (end - start))
        .map(|(place, local)| {
            let name = if local {
                "where it acts"
            } else {
                "where it shows most"
            };
            (name, place.start, place.end)
        })
        .collect()
}

/// Upper ends of the steps of the scale, in deviations of the noise.
fn steps(mismatch: &[f64]) -> [f64; 5] {
    let most = mismatch.iter().copied().filter(|v| v.is_finite());
    if most.fold(0.0, f64::max) < 20.0 {
        [1.0, 2.0, 3.0, 5.0, 8.0]
    } else {
        [1.0, 3.0, 10.0, 30.0, 100.0]
    }
}

fn step_name(step: usize, ends: &[f64; 5]) -> String {
    match step {
        0 => format!("under {} sigma", ends[0]),
        5 => format!("over {}", ends[4]),
        _ => format!("{} .. {}", ends[step - 1], ends[step]),
    }
}

/// The path, coloured by how much the re-tuned model misses there.
fn map(run: &RunTrace, diagnosis: &Diagnosis) -> Chart {
    let stride = run.path.len().div_ceil(MAP_POINTS).max(1);
    let usual = (run.time.last().unwrap_or(&0.0) - run.time.first().unwrap_or(&0.0))
        / run.time.len().max(2) as f64;
    // Time, place, and the worst until the next point.
    let points: Vec<(f64, (f64, f64), f64)> = (0..run.path.len())
        .step_by(stride)
        .map(|index| {
            let until = (index + stride).min(run.mismatch.len());
            let worst = run.mismatch.get(index..until).unwrap_or(&[]);
            let worst = worst.iter().copied().fold(f64::NAN, f64::max);
            let [east, north] = run.path[index];
            let time = run.time.get(index).copied().unwrap_or(f64::NAN);
            (time, (east, north), worst)
        })
        .collect();
    let ends = steps(&run.mismatch);
    let mut parts: [Vec<Vec<(f64, f64)>>; 6] = Default::default();
    let mut last = None;
    for pair in points.windows(2) {
        let [(time, from, worst), (next, to, _)] = [pair[0], pair[1]];
        if next - time > GAP * usual * stride as f64 {
            last = None;
            continue;
        }
        let step = ends.iter().filter(|end| worst >= **end).count();
        if last != Some(step) {
            parts[step].push(vec![from]);
        }
        if let Some(part) = parts[step].last_mut() {
            part.push(to);
        }
        last = Some(step);
    }
    let mut chart = Chart::new(
        "Mismatch of the re-tuned model on the path",
        "x, east [m]",
        "y, north [m]",
    );
    (chart.is_map, chart.height) = (true, MAP_HEIGHT);
    for (name, start, end) in spans(run, diagnosis) {
        let within = points
            .iter()
            .filter(|point| (start..=end).contains(&point.0))
            .map(|point| point.1);
        chart.lines.push(Line {
            name: name.into(),
            parts: vec![within.collect()],
            stroke: Stroke::Halo,
        });
    }
    for (place, _) in places(run, diagnosis) {
        if let Some([east, north, radius]) = place.patch {
            let circle = Mark::Circle((east, north), radius);
            chart.marks.push(("patch", circle));
        }
    }
    let highest = parts.iter().rposition(|parts| !parts.is_empty());
    for (step, mut parts) in parts.into_iter().enumerate() {
        if Some(step) <= highest {
            // Steps between that are not reached have their place on the scale.
            parts.push(Vec::new());
            chart.lines.push(Line {
                name: step_name(step, &ends),
                parts,
                stroke: Stroke::Step(step),
            });
        }
    }
    let finite = |point: &&(f64, (f64, f64), f64)| point.1.0.is_finite() && point.1.1.is_finite();
    if let Some(start) = points.iter().find(finite) {
        chart.lines.push(Line {
            name: "start".into(),
            parts: vec![vec![start.1]],
            stroke: Stroke::Points,
        });
    }
    chart
}

fn marks(spans: &[(&'static str, f64, f64)]) -> Vec<(&'static str, Mark)> {
    let spans = spans
        .iter()
        .map(|(name, start, end)| (*name, Mark::Span(*start, *end)));
    spans.chain([("", Mark::Zero)]).collect()
}

fn residuals(trace: &ResidualTrace, spans: &[(&'static str, f64, f64)], found: bool) -> Chart {
    let (factor, unit) = shown(trace.unit);
    let channel = trace.channel.replace('_', " ");
    let shown = if found {
        [&trace.before, &trace.after]
    } else {
        [&trace.before; 2]
    };
    // What was found for some seconds is no outlier: there nearly all is shown as well.
    let inside = |time: f64| {
        spans
            .iter()
            .any(|(_, start, end)| (*start..=*end).contains(&time))
    };
    let there = |values: &[f64]| -> Vec<f64> {
        let pairs = trace.time.iter().zip(values);
        let pairs = pairs.filter(|(time, _)| inside(**time));
        pairs.map(|(_, value)| *value).collect()
    };
    let there = shown.map(|values| there(values));
    let limit = limit(&shown).max(usual(&there.each_ref()).unwrap_or(0.0));
    let beyond = |index: &usize| shown.iter().any(|values| values[*index].abs() > limit);
    let cut = match (0..trace.time.len()).filter(beyond).count() {
        0 => String::new(),
        1 => " (one sample beyond the axis)".into(),
        count => format!(" ({count} samples beyond the axis)"),
    };
    let line = |name: &str, values: &[f64]| Line {
        name: name.into(),
        parts: parted(&trace.time, |index| {
            (
                trace.time[index],
                values[index].clamp(-limit, limit) * factor,
            )
        }),
        stroke: Stroke::Line,
    };
    let mut lines = vec![line("re-tuned", &trace.before)];
    if found {
        lines.push(line("with what was found", &trace.after));
    }
    Chart {
        lines,
        marks: marks(spans),
        ..Chart::new(
            format!("{channel}: measured less predicted{cut}"),
            "time [s]",
            format!("{channel} [{unit}]"),
        )
    }
}

/// Where residuals are cut off: far beyond nearly all of them, infinite where none goes much further. One
/// outlier would hide all the others.
fn limit(shown: &[&Vec<f64>]) -> f64 {
    let sizes = shown.iter().flat_map(|values| values.iter());
    let largest = sizes.fold(0.0, |most: f64, value| most.max(value.abs()));
    match usual(shown) {
        Some(limit) if limit > 0.0 && largest > CUT * limit => limit,
        _ => f64::INFINITY,
    }
}

/// What nearly all stay under, with room; `None` of nothing.
fn usual(shown: &[&Vec<f64>]) -> Option<f64> {
    let sizes = shown
        .iter()
        .flat_map(|values| values.iter().map(|value| value.abs()));
    let mut sizes: Vec<f64> = sizes.filter(|size| size.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    let last = sizes.len().checked_sub(1)?;
    Some(CUT * sizes[(NEARLY_ALL * last as f64) as usize])
}

/// Points of a curve or a band, parted where nothing was recorded for a while.
fn parted<P>(time: &[f64], point: impl Fn(usize) -> P) -> Vec<Vec<P>> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
    let mut parts: Vec<Vec<P>> = Vec::new();
    let mut last = f64::NEG_INFINITY;
    for (index, time) in time.iter().enumerate() {
        if time - last > GAP * usual || parts.is_empty() {
            parts.push(Vec::new());
        }
        if let Some(part) = parts.last_mut() {
            part.push(point(index));
        }
        last = *time;
    }
    parts
}

fn wrenches(trace: &WrenchTrace, spans: &[(&'static str, f64, f64)]) -> Vec<Chart> {
    let axes = [
        ("Force left over along the vehicle", "dF_X [N]"),
        ("Force left over across the vehicle", "dF_Y [N]"),
        ("Turning moment left over", "dM_Z [N m]"),
    ];
    let chart = |(axis, (title, y_label)): (usize, (&str, &str))| {
        let value = |index: usize| trace.value[index][axis];
        let band = parted(&trace.time, |index| {
            let (value, reach) = (value(index), 2.0 * trace.deviation[index][axis]);
            (trace.time[index], value - reach, value + reach)
        });
        let mut marks = marks(spans);
        marks.push(("2 deviations to both sides", Mark::Band(band)));
        Chart {
            lines: vec![Line {
                name: String::new(),
                parts: parted(&trace.time, |index| (trace.time[index], value(index))),
                stroke: Stroke::Line,
            }],
            marks,
            ..Chart::new(title, "time [s]", y_label)
        }
    };
    axes.into_iter().enumerate().map(chart).collect()
}

/// How many runs are not plotted.
pub fn note(diagnosis: &Diagnosis) -> String {
    match diagnosis.runs.len().saturating_sub(MOST_RUNS) {
        0 => String::new(),
        1 => "<p>Plotted are the runs with a place that was found, and the worst; one more is not.</p>\n".into(),
        more => format!(
            "<p>Plotted are the runs with a place that was found, and the worst; {more} more are not.</p>\n"
        ),
    }
}

/// A run's heading, where there are several.
pub fn heading(run: &RunTrace, diagnosis: &Diagnosis) -> String {
    if diagnosis.runs.len() < 2 {
        return String::new();
    }
    let name = words::run(&run.recording, &run.label);
    format!("<h3>{}</h3>\n", crate::report::chart::escape(&name))
}

#[cfg(test)]
mod tests;
