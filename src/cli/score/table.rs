//! Scores as a text for the terminal.

use super::comparison::{ModelScore, Pooled, Scores};
use std::fmt::Write;
use ugv_terrain::display::visible_line;
use ugv_terrain::identification::Latency;
use ugv_terrain::recording::IntervalEstimate;

/// Widths of the column of names and of the others.
const NAME: usize = 18;
const CELL: usize = 17;

pub fn render(horizon: f64, outcomes: &[ModelScore], pooled: Option<&Vec<Pooled>>) -> String {
    let mut text = String::new();
    for outcome in outcomes {
        recording(&mut text, horizon, outcome);
        text.push('\n');
    }
    if let Some(pooled) = pooled.filter(|pooled| !pooled.is_empty()) {
        let _ = writeln!(
            text,
            "All {} recordings: {} windows",
            outcomes.len(),
            pooled[0].windows
        );
        heads(&mut text);
        for model in pooled {
            rows(&mut text, model.name, &model.scores, model.failed);
        }
        for (model, recording) in lost(outcomes) {
            let recording = visible_line(recording);
            let _ = writeln!(text, "  {model:NAME$} no prediction of {recording}");
        }
        text.push('\n');
    }
    // One line end closes the last table.
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// Models that predicted nothing of some recording, with its name.
fn lost<'a>(outcomes: &'a [ModelScore]) -> impl Iterator<Item = (&'a str, &'a str)> {
    outcomes.iter().flat_map(|outcome| {
        let results = outcome.comparison.entries.iter().zip(&outcome.results);
        let lost = results.filter(|(_, result)| result.scores.is_none());
        lost.map(|(entry, _)| (entry.name, outcome.comparison.name.as_str()))
    })
}

fn recording(text: &mut String, horizon: f64, outcome: &ModelScore) {
    let comparison = outcome.comparison;
    let (set, halves) = (&comparison.set, &comparison.halves);
    let _ = writeln!(
        text,
        "{}: {} windows of {horizon} s (left out: {} standing, {} with gaps); \
         {} fitted, {} judged, {} counted",
        visible_line(&comparison.name),
        set.windows.len(),
        set.rejected.standing,
        set.rejected.gaps,
        halves.fitted.len(),
        halves.judged.len(),
        outcome.counted
    );
    let _ = write!(
        text,
        "latency removed: pose {}, wheels {}; heading compared with the {}",
        latency(&comparison.latencies.pose),
        latency(&comparison.latencies.wheels),
        comparison.how.heading.name()
    );
    let _ = match comparison.heading_noise {
        Some(noise) => writeln!(text, " (in 1 s pose and gyro differ by {noise:.3} rad RMS)"),
        None => writeln!(text, " (no yaw rate)"),
    };
    heads(text);
    for (entry, result) in comparison.entries.iter().zip(&outcome.results) {
        match &result.scores {
            Some(scores) => rows(text, entry.name, scores, result.failed),
            None => {
                let _ = writeln!(text, "  {:NAME$} no prediction", entry.name);
            }
        }
    }
    for (entry, result) in comparison.entries.iter().zip(&outcome.results) {
        let _ = write!(
            text,
            "  {}: {}",
            entry.name,
            visible_line(&entry.description)
        );
        for p in &entry.parameters {
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

/// The values, and below them their intervals.
fn rows(text: &mut String, name: &str, scores: &Scores, failed: usize) {
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
        Latency::Unknown => "none (too few turns to tell)".into(),
        Latency::Reference => "none (the pose's is against them)".into(),
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
