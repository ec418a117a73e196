//! The plots of a diagnosis: measured and predicted path, the mismatch on the path, errors over time.

use super::words;
use crate::diagnosis::{
    Compared, Diagnosis, Interval, PredictedPath, ResidualTrace, RunTrace, WrenchTrace,
};
use crate::display::markup;
use crate::report::chart::{Chart, Line, Role, Stroke, Underlay};
use crate::report::number::shown;

/// Maximum number of runs that are plotted.
const MAX_RUNS: usize = 4;
/// Maximum number of predictions in one picture: more hide each other.
const MAX_PREDICTIONS: usize = 12;
/// Approximate number of points of a map's path.
const MAP_POINTS: usize = 900;
/// Height of a map: that of two charts with the space between them.
const MAP_HEIGHT: f64 = 470.0;
/// A stretch that covers a larger share of a run is not marked.
const WHOLE: f64 = 0.95;
/// An axis of residuals ends at `CUT` times the quantile `NEARLY_ALL` of their sizes if one exceeds that by as much again.
const NEARLY_ALL: f64 = 0.98;
const CUT: f64 = 2.0;
/// A gap of this many intervals between points interrupts a path.
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
    runs.truncate(MAX_RUNS);
    runs.sort_by_key(|run| run.0);
    runs.into_iter().map(|run| run.1).collect()
}

/// All figures of a run.
pub fn figures(run: &RunTrace, diagnosis: &Diagnosis) -> String {
    let axis = TimeAxis::new(run, diagnosis);
    let roles: Vec<Role> = words::roles(diagnosis).collect();
    let residuals = run.residuals.iter();
    let residuals = residuals.map(|residual| residuals_chart(residual, &axis, &roles));
    let wrench = run.wrench.iter().flat_map(|wrench| wrenches(wrench, &axis));
    let number = number(run, diagnosis);
    let linked = |chart: Chart| Chart {
        run: number,
        ..chart
    };
    let charts = residuals.chain(wrench);
    let charts: String = charts.map(|chart| linked(chart).figure()).collect();
    tall(&linked(map(run, diagnosis, &axis))) + &charts
}

/// A figure as tall as two.
fn tall(chart: &Chart) -> String {
    chart
        .figure()
        .replacen("<figure>", "<figure class=\"tall\">", 1)
}

/// The number of a run, by which the page's script knows its charts.
fn number(run: &RunTrace, diagnosis: &Diagnosis) -> Option<usize> {
    diagnosis
        .runs
        .iter()
        .position(|other| std::ptr::eq(other, run))
}

/// Measured and predicted path of the run with the leading finding's first place, or of the one with the largest
/// errors, and a note about what is shown; `None` without predictions.
pub fn paths(diagnosis: &Diagnosis) -> Option<(String, String)> {
    let candidates = chosen(diagnosis).into_iter();
    let candidates = candidates.filter(|run| !run.predicted.is_empty());
    let leading = diagnosis
        .leading
        .and_then(|place| diagnosis.findings.get(place));
    let place = leading.and_then(|finding| finding.places.first());
    let key = |run: &&RunTrace| {
        let is_place =
            |place: &Interval| (&place.recording, place.run) == (&run.recording, run.run);
        let error: f64 = run.predicted.iter().map(squared_error).sum();
        (place.is_some_and(is_place), error)
    };
    let by_key = |a: &&RunTrace, b: &&RunTrace| {
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    };
    let run = candidates.max_by(by_key)?;
    let shown = worst(&run.predicted);
    let axis = TimeAxis::new(run, diagnosis);
    let clock = |path: &PredictedPath| -> Vec<f64> {
        path.time.iter().map(|time| time - axis.origin).collect()
    };
    let line = |role: Role, name: &str, of: &dyn Fn(&PredictedPath) -> &[[f64; 2]]| Line {
        name: name.into(),
        pieces: shown
            .iter()
            .map(|path| of(path).iter().map(|[x, y]| (*x, *y)).collect())
            .collect(),
        times: shown.iter().map(clock).collect(),
        stroke: Stroke::Of(role),
    };
    let mut lines = vec![line(Role::Measured, "measured", &|path| &path.measured)];
    for (role, model) in words::roles(diagnosis).zip(Compared::ALL) {
        lines.push(line(role, words::role(role), &move |path| {
            &path.predicted[model as usize]
        }));
    }
    let starts = shown.iter().filter_map(|path| path.measured.first());
    lines.push(Line {
        name: "start of a prediction".into(),
        pieces: vec![starts.map(|[x, y]| (*x, *y)).collect()],
        stroke: Stroke::Points,
        ..Line::default()
    });
    let chart = Chart {
        lines,
        is_map: true,
        height: MAP_HEIGHT,
        run: number(run, diagnosis),
        ..Chart::new("Measured and predicted path", "x, east [m]", "y, north [m]")
    };
    let whose = match diagnosis.runs.len() {
        0 | 1 => String::new(),
        _ => format!(" of {}", words::run(&run.recording, &run.label)),
    };
    let note = match (shown.len(), run.predicted.len()) {
        (count, all) if count == all => format!("All {all} predictions{whose}"),
        (count, all) => {
            format!("The {count} neighbouring predictions{whose} with the largest errors, of {all}")
        }
    };
    Some((tall(&chart), note))
}

/// Sum of the squared errors of the refitted model, or of the mended one where that cannot follow.
fn squared_error(path: &PredictedPath) -> f64 {
    let [_, refitted, mended] = &path.predicted;
    let predicted = if refitted.is_empty() {
        mended
    } else {
        refitted
    };
    let pairs = predicted.iter().zip(&path.measured);
    pairs
        .map(|(p, m)| (p[0] - m[0]).powi(2) + (p[1] - m[1]).powi(2))
        .sum()
}

/// The neighbouring predictions with the largest errors.
fn worst(all: &[PredictedPath]) -> &[PredictedPath] {
    let windows = all.windows(MAX_PREDICTIONS);
    let error = |window: &&[PredictedPath]| window.iter().map(squared_error).sum::<f64>();
    windows
        .max_by(|a, b| error(a).total_cmp(&error(b)))
        .unwrap_or(all)
}

/// The time axis of a run's charts.
struct TimeAxis {
    /// Where its times count from \[s\].
    origin: f64,
    /// Stretches to be marked, in the recording's time, with their names.
    spans: Vec<(&'static str, f64, f64)>,
}

impl TimeAxis {
    fn new(run: &RunTrace, diagnosis: &Diagnosis) -> Self {
        Self {
            origin: origin(run),
            spans: spans(run, diagnosis),
        }
    }

    fn label(&self) -> String {
        match self.origin {
            0.0 => "time [s]".into(),
            origin => format!("time after {origin} s [s]"),
        }
    }

    fn has_marked(&self, time: f64) -> bool {
        let mut spans = self.spans.iter();
        spans.any(|(_, start, end)| (*start..=*end).contains(&time))
    }

    /// The marked stretches and the line of zero.
    fn underlays(&self) -> Vec<(&'static str, Underlay)> {
        let spans = self.spans.iter().map(|(name, start, end)| {
            (
                *name,
                Underlay::Span(start - self.origin, end - self.origin),
            )
        });
        spans.chain([("", Underlay::Zero)]).collect()
    }
}

/// Where the times of a run's charts count from \[s\]: a long clock counts from the run's start, to the second.
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

/// Stretches to be marked, with their names.
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
            let name = if local { "only here" } else { "mainly here" };
            (name, place.start, place.end)
        })
        .collect()
}

/// Upper ends of the steps of the scale, in standard deviations of the noise.
fn steps(mismatch: &[f64]) -> [f64; 5] {
    let finite = mismatch.iter().copied().filter(|v| v.is_finite());
    if finite.fold(0.0, f64::max) < 20.0 {
        [1.0, 2.0, 3.0, 5.0, 8.0]
    } else {
        [1.0, 3.0, 10.0, 30.0, 100.0]
    }
}

fn step_name(step: usize, ends: &[f64; 5]) -> String {
    match step {
        0 => format!("below {} sigma", ends[0]),
        5 => format!("above {}", ends[4]),
        _ => format!("{} .. {}", ends[step - 1], ends[step]),
    }
}

/// The path, coloured by the mismatch of the refitted model.
fn map(run: &RunTrace, diagnosis: &Diagnosis, axis: &TimeAxis) -> Chart {
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
    let mut steps: [Vec<Vec<(f64, f64)>>; 6] = Default::default();
    let mut times: [Vec<Vec<f64>>; 6] = Default::default();
    let mut last = None;
    for pair in points.windows(2) {
        let [(time, from, worst), (next, to, _)] = [pair[0], pair[1]];
        if next - time > GAP * usual * stride as f64 {
            last = None;
            continue;
        }
        let step = ends.iter().filter(|end| worst >= **end).count();
        if last != Some(step) {
            steps[step].push(vec![from]);
            times[step].push(vec![time - axis.origin]);
        }
        if let (Some(piece), Some(clock)) = (steps[step].last_mut(), times[step].last_mut()) {
            piece.push(to);
            clock.push(next - axis.origin);
        }
        last = Some(step);
    }
    let mut chart = Chart::new(
        "Mismatch of the refitted model on the path",
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
            pieces: vec![within.collect()],
            stroke: Stroke::Halo,
            ..Line::default()
        });
    }
    for (place, _) in places(run, diagnosis) {
        if let Some([east, north, radius]) = place.patch {
            let circle = Underlay::Circle((east, north), radius);
            chart.underlays.push(("patch", circle));
        }
    }
    let highest = steps.iter().rposition(|pieces| !pieces.is_empty());
    for (step, (mut pieces, times)) in steps.into_iter().zip(times).enumerate() {
        if Some(step) <= highest {
            // The legend shows the whole scale up to the highest step, also steps without points.
            pieces.push(Vec::new());
            chart.lines.push(Line {
                name: step_name(step, &ends),
                pieces,
                times,
                stroke: Stroke::Step(step),
            });
        }
    }
    let finite = |point: &&(f64, (f64, f64), f64)| point.1.0.is_finite() && point.1.1.is_finite();
    if let Some(start) = points.iter().find(finite) {
        chart.lines.push(Line {
            name: "start".into(),
            pieces: vec![vec![start.1]],
            stroke: Stroke::Points,
            ..Line::default()
        });
    }
    chart
}

fn residuals_chart(trace: &ResidualTrace, axis: &TimeAxis, roles: &[Role]) -> Chart {
    let (factor, unit) = shown(trace.unit);
    let channel = words::signal(trace.channel);
    let models: Vec<(Role, &Vec<f64>)> = roles.iter().copied().zip(&trace.errors).collect();
    // Within a marked stretch large residuals are a finding, not outliers: the axis shows nearly all of them too.
    let marked = models.iter().map(|(_, values)| -> Vec<f64> {
        let pairs = trace.time.iter().zip(values.iter());
        let marked = pairs.filter(|(time, _)| axis.has_marked(**time));
        marked.map(|(_, value)| *value).collect()
    });
    let marked: Vec<Vec<f64>> = marked.collect();
    let all: Vec<&[f64]> = models.iter().map(|(_, values)| &values[..]).collect();
    let limit = limit(&all).max(usual(&marked).unwrap_or(0.0));
    let is_cut = |index: &usize| all.iter().any(|values| values[*index].abs() > limit);
    let cut = match (0..trace.time.len()).filter(is_cut).count() {
        0 => String::new(),
        1 => " (one sample beyond the axis)".into(),
        count => format!(" ({count} samples beyond the axis)"),
    };
    let is_known = |values: &[f64]| values.iter().any(|value| value.is_finite());
    let models = models.into_iter().filter(|(_, values)| is_known(values));
    let lines = models.map(|(role, values)| Line {
        name: words::role(role).into(),
        pieces: pieces(&trace.time, |index| {
            let value = values[index].clamp(-limit, limit) * factor;
            (trace.time[index] - axis.origin, value)
        }),
        stroke: Stroke::Of(role),
        ..Line::default()
    });
    Chart {
        lines: lines.collect(),
        underlays: axis.underlays(),
        ..Chart::new(
            format!("{channel}: measured minus predicted{cut}"),
            axis.label(),
            format!("{} [{unit}]", trace.channel.replace('_', " ")),
        )
    }
}

/// The end of the axis of residuals, so that one outlier does not hide all the others; infinite without outliers.
fn limit(shown: &[&[f64]]) -> f64 {
    let sizes = shown.iter().copied().flatten().map(|value| value.abs());
    let largest = sizes.fold(0.0, f64::max);
    match usual(shown) {
        Some(limit) if limit > 0.0 && largest > CUT * limit => limit,
        _ => f64::INFINITY,
    }
}

/// The size that nearly all residuals stay under, with room; `None` without any.
fn usual(shown: &[impl AsRef<[f64]>]) -> Option<f64> {
    let sizes = shown.iter().flat_map(|values| values.as_ref());
    let sizes = sizes.map(|value| value.abs());
    let mut sizes: Vec<f64> = sizes.filter(|size| size.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    let last = sizes.len().checked_sub(1)?;
    Some(CUT * sizes[(NEARLY_ALL * last as f64) as usize])
}

/// Points of a line or a band, in pieces: gaps in the time separate them.
fn pieces<P>(time: &[f64], point: impl Fn(usize) -> P) -> Vec<Vec<P>> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
    let mut pieces: Vec<Vec<P>> = Vec::new();
    let mut last = f64::NEG_INFINITY;
    for (index, time) in time.iter().enumerate() {
        if time - last > GAP * usual || pieces.is_empty() {
            pieces.push(Vec::new());
        }
        if let Some(piece) = pieces.last_mut() {
            piece.push(point(index));
        }
        last = *time;
    }
    pieces
}

fn wrenches(trace: &WrenchTrace, axis: &TimeAxis) -> [Chart; 3] {
    [
        ("Residual force along the vehicle", "dF_X [N]", 0),
        ("Residual force across the vehicle", "dF_Y [N]", 1),
        ("Residual yaw moment", "dM_Z [N m]", 2),
    ]
    .map(|(title, y_label, component)| {
        let point = |index: usize| {
            let time = trace.time[index] - axis.origin;
            (time, trace.value[index][component])
        };
        let band = pieces(&trace.time, |index| {
            let (time, value) = point(index);
            let reach = 2.0 * trace.deviation[index][component];
            (time, value - reach, value + reach)
        });
        let mut underlays = axis.underlays();
        underlays.push(("\u{b1} 2 standard deviations", Underlay::Band(band)));
        Chart {
            lines: vec![Line {
                name: String::new(),
                pieces: pieces(&trace.time, point),
                stroke: Stroke::Of(Role::Refitted),
                ..Line::default()
            }],
            underlays,
            ..Chart::new(title, axis.label(), y_label)
        }
    })
}

/// How many runs are not plotted.
pub fn note(diagnosis: &Diagnosis) -> String {
    match diagnosis.runs.len() {
        0..=MAX_RUNS => String::new(),
        all => format!(
            "<p>Plotted: {MAX_RUNS} of {all} runs, those with a place of a finding and those with the largest mismatch.</p>\n"
        ),
    }
}

/// A run's heading, if there are several runs.
pub fn heading(run: &RunTrace, diagnosis: &Diagnosis) -> String {
    if diagnosis.runs.len() < 2 {
        return String::new();
    }
    let name = words::run(&run.recording, &run.label);
    format!("<h3>{}</h3>\n", markup(&name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(spans: &[(&'static str, f64, f64)]) -> TimeAxis {
        TimeAxis {
            origin: 0.0,
            spans: spans.into(),
        }
    }

    #[test]
    fn a_gap_separates_the_band_as_its_line() {
        let trace = WrenchTrace {
            time: [0.0, 1.0, 2.0, 30.0, 31.0].into(),
            value: vec![[1.0; 3]; 5],
            deviation: vec![[0.5; 3]; 5],
        };
        for chart in wrenches(&trace, &axis(&[])) {
            let Some((_, Underlay::Band(band))) = chart.underlays.last() else {
                panic!("no band")
            };
            let line: Vec<usize> = chart.lines[0].pieces.iter().map(Vec::len).collect();
            let band: Vec<usize> = band.iter().map(Vec::len).collect();
            assert_eq!((line, band), (vec![3, 2], vec![3, 2]));
        }
    }

    #[test]
    fn an_outlier_does_not_hide_the_others() {
        let noise: Vec<f64> = (0..200).map(|k| f64::from(k % 7) - 3.0).collect();
        let mut spiked = noise.clone();
        spiked[50] = -400.0;
        spiked[60] = f64::NAN;
        assert_eq!(limit(&[&noise, &noise]), f64::INFINITY);
        assert_eq!(limit(&[&noise, &spiked]), 6.0);
        assert_eq!(limit(&[&[0.0; 9]]), f64::INFINITY);
        assert_eq!(limit(&[&[]]), f64::INFINITY);
        let trace = |before: &Vec<f64>| ResidualTrace {
            channel: "yaw_rate",
            unit: "m",
            time: (0..200).map(f64::from).collect(),
            errors: [noise.clone(), before.clone(), noise.clone()],
        };
        let roles = [Role::Given, Role::Refitted, Role::Mended];
        let residuals =
            |trace: &ResidualTrace, axis: &TimeAxis| residuals_chart(trace, axis, &roles);
        let chart = residuals(&trace(&spiked), &axis(&[]));
        assert!(
            chart
                .title
                .ends_with("predicted (one sample beyond the axis)")
        );
        let lowest = chart.lines[1].pieces.iter().flatten().map(|point| point.1);
        assert_eq!(lowest.fold(f64::INFINITY, f64::min), -6.0);
        // Within a marked stretch a signal is shown, a single outlier is not.
        let acts = axis(&[("only here", 45.0, 55.0)]);
        let title = |before: &Vec<f64>| residuals(&trace(before), &acts).title;
        assert!(title(&spiked).ends_with("predicted (one sample beyond the axis)"));
        spiked[47..54].fill(-400.0);
        assert!(title(&spiked).ends_with("predicted"));
        assert!(
            residuals(&trace(&noise), &axis(&[]))
                .title
                .ends_with("predicted")
        );
    }

    #[test]
    fn a_long_clock_counts_from_the_start_of_the_run() {
        let residual = |start: f64| ResidualTrace {
            channel: "yaw_rate",
            unit: "rad/s",
            time: (0..3).map(|k| start + f64::from(k)).collect(),
            errors: [1.0, 1.0, 0.0].map(|error| vec![error; 3]),
        };
        let run = |start: f64| RunTrace {
            recording: "drive".into(),
            run: 0,
            label: String::new(),
            time: vec![start, start + 2.0],
            path: Vec::new(),
            mismatch: Vec::new(),
            predicted: Vec::new(),
            residuals: vec![residual(start)],
            wrench: None,
        };
        assert_eq!(origin(&run(12.5)), 0.0);
        let late = run(1_700_000_000.25);
        let axis = TimeAxis {
            origin: origin(&late),
            spans: Vec::new(),
        };
        assert_eq!(axis.label(), "time after 1700000000 s [s]");
        let chart = residuals_chart(&late.residuals[0], &axis, &[Role::Given]);
        let times = chart.lines[0].pieces.iter().flatten().map(|point| point.0);
        assert_eq!(times.collect::<Vec<_>>(), [0.25, 1.25, 2.25]);
    }
}
