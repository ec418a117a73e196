//! Scores as a text for the terminal.

use super::comparison::{ComparisonResult, ModelScores, PooledResult};
use std::fmt::Write;
use ugv_terrain::display::visible_line;
use ugv_terrain::identification::{Estimate, Latency};

/// Widths of the column of names and of the others.
const NAME: usize = 18;
const CELL: usize = 17;

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
        heads(&mut text);
        for model in pooled {
            rows(&mut text, model.name, &model.scores, model.failed);
        }
        for (model, recording) in failed(results) {
            let recording = visible_line(recording);
            let _ = writeln!(text, "  {model:NAME$} no prediction of {recording}");
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
    heads(text);
    for (model, result) in comparison.models.iter().zip(&all.results) {
        match &result.scores {
            Some(scores) => rows(text, model.name, scores, result.failed),
            None => {
                let _ = writeln!(text, "  {:NAME$} no prediction", model.name);
            }
        }
    }
    for (model, result) in comparison.models.iter().zip(&all.results) {
        let _ = write!(
            text,
            "  {}: {}",
            model.name,
            visible_line(&model.description)
        );
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

fn heads(text: &mut String) {
    let columns = [
        "median [m]",
        "95 % [m]",
        "RMSE [m]",
        "median [rad]",
        "95 % [rad]",
        "RMSE [rad]",
    ];
    let _ = write!(text, "  {:NAME$}", "model");
    for column in columns {
        let _ = write!(text, "{column:>CELL$}");
    }
    let _ = writeln!(text, "{:>8}", "failed");
}

/// The values, and their intervals below.
fn rows(text: &mut String, name: &str, scores: &ModelScores, failed: usize) {
    let summaries = [&scores.position, &scores.heading];
    let estimates = || {
        summaries
            .into_iter()
            .flat_map(|s| [s.median, s.p95, s.rmse])
    };
    let _ = write!(text, "  {name:NAME$}");
    for estimate in estimates() {
        let _ = write!(text, "{:>CELL$.3}", estimate.value);
    }
    let _ = write!(text, "{failed:>8}\n  {:NAME$}", "");
    for estimate in estimates() {
        let _ = write!(text, "{:>CELL$}", interval(&estimate, 3));
    }
    text.push('\n');
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

fn interval(estimate: &Estimate, digits: usize) -> String {
    let Estimate { low, high, .. } = estimate;
    if estimate.width().is_finite() {
        format!("({low:.digits$}..{high:.digits$})")
    } else {
        "(too few)".into()
    }
}
