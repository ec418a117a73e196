//! Scores as a text for the terminal.

use super::comparison::{ComparisonResult, ModelScores, PooledResult};
use crate::display::visible_line;
use crate::identification::Latency;
use crate::recording::IntervalEstimate;
use crate::report::aligned;
use std::fmt::Write;

pub fn render(
    horizon: f64,
    results: &[ComparisonResult],
    pooled: Option<&[PooledResult]>,
) -> String {
    let mut text = String::new();
    for result in results {
        recording(&mut text, horizon, result);
        text.push('\n');
    }
    if let Some(pooled) = pooled.filter(|pooled| !pooled.is_empty()) {
        let _ = writeln!(
            text,
            "All {} recordings: {} windows",
            results.len(),
            pooled[0].windows
        );
        let models = pooled.iter();
        text += &scores(models.map(|model| (model.name, &model.scores, model.failed)));
        for (model, recording) in failed(results) {
            let recording = visible_line(recording);
            let _ = writeln!(text, "{model}: no prediction of {recording}");
        }
        text.push('\n');
    }
    // The last table ends with one line end.
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// Models without a prediction of a recording, with its name.
fn failed<'a>(results: &'a [ComparisonResult]) -> impl Iterator<Item = (&'a str, &'a str)> {
    results.iter().flat_map(|all| {
        let results = all.comparison.models.iter().zip(&all.results);
        let failed = results.filter(|(_, result)| result.scores.is_none());
        failed.map(|(model, _)| (model.name, all.comparison.name.as_str()))
    })
}

fn recording(text: &mut String, horizon: f64, all: &ComparisonResult) {
    let comparison = all.comparison;
    let (set, halves) = (&comparison.set, &comparison.halves);
    let _ = writeln!(
        text,
        "{}: {} windows of {horizon} s (not used: {} standing, {} with gaps); \
         {} fitted, {} judged, {} counted",
        visible_line(&comparison.name),
        set.windows.len(),
        set.rejected.standing,
        set.rejected.gaps,
        halves.fitted.len(),
        halves.judged.len(),
        all.counted
    );
    let _ = write!(
        text,
        "latency removed: pose {}, wheels {}; heading compared with the {}",
        latency(&comparison.latencies.pose),
        latency(&comparison.latencies.wheels),
        comparison.cut.heading.name()
    );
    let _ = match comparison.heading_noise {
        Some(noise) => writeln!(text, " (in 1 s pose and gyro differ by {noise:.3} rad RMS)"),
        None => writeln!(text, " (no yaw rate)"),
    };
    let results = || comparison.models.iter().zip(&all.results);
    *text += &scores(results().filter_map(|(model, result)| {
        let scores = result.scores.as_ref()?;
        Some((model.name, scores, result.failed))
    }));
    for (model, result) in results() {
        let description = visible_line(&model.description);
        let _ = write!(text, "{}: {description}", model.name);
        if result.scores.is_none() {
            *text += "; no prediction";
        }
        for p in &model.parameters {
            let bounds = interval(&p.estimate, 4);
            let _ = write!(
                text,
                "; {} = {:.4} {bounds} {}",
                p.name, p.estimate.value, p.unit
            );
        }
        if let Some(reason) = &result.reason {
            let _ = write!(
                text,
                "; failed in {} windows, first: {reason}",
                result.failed
            );
        }
        text.push('\n');
    }
}

/// The scores of models, and their intervals below.
fn scores<'a>(models: impl Iterator<Item = (&'a str, &'a ModelScores, usize)>) -> String {
    let header = [
        "model",
        "median [m]",
        "95 % [m]",
        "RMSE [m]",
        "median [rad]",
        "95 % [rad]",
        "RMSE [rad]",
        "failed",
    ];
    let mut rows: Vec<[String; 8]> = Vec::new();
    for (name, scores, failed) in models {
        let estimates = [&scores.position, &scores.heading].map(|s| [s.median, s.p95, s.rmse]);
        let estimates = estimates.as_flattened();
        rows.push(std::array::from_fn(|column| match column {
            0 => name.into(),
            7 => failed.to_string(),
            _ => format!("{:.3}", estimates[column - 1].value),
        }));
        rows.push(std::array::from_fn(|column| match column {
            0 | 7 => String::new(),
            _ => interval(&estimates[column - 1], 3),
        }));
    }
    aligned(header, &rows)
}

fn latency(latency: &Latency) -> String {
    match latency {
        Latency::Estimated(estimate) => {
            format!("{:.2} s {}", estimate.value, interval(estimate, 2))
        }
        Latency::Unknown => "unknown (too few turns)".into(),
        Latency::Reference => "none (the reference for the pose)".into(),
    }
}

fn interval(estimate: &IntervalEstimate, digits: usize) -> String {
    let IntervalEstimate { low, high, .. } = estimate;
    if estimate.width().is_finite() {
        format!("({low:.digits$}..{high:.digits$})")
    } else {
        "(too few)".into()
    }
}
