//! Scores as JSON, format `ugv-score/1`.

use super::comparison::{ModelScore, Pooled, Scores};
use serde_json::{Map, Value, json};
use ugv_terrain::identification::{ErrorSummary, Latency};
use ugv_terrain::recording::IntervalEstimate;

pub fn render(
    horizon: f64,
    spacing: f64,
    outcomes: &[ModelScore],
    pooled: Option<&Vec<Pooled>>,
) -> String {
    let pooled = pooled.map(|models| models.iter().map(pooled_model).collect::<Vec<_>>());
    let value = json!({
        "format": "ugv-score/1",
        "horizon_s": horizon,
        "spacing_s": spacing,
        "recordings": outcomes.iter().map(recording).collect::<Vec<_>>(),
        "pooled": pooled,
    });
    format!("{value:#}\n")
}

fn recording(outcome: &ModelScore) -> Value {
    let comparison = outcome.comparison;
    let models = comparison
        .entries
        .iter()
        .zip(&outcome.results)
        .map(|(entry, result)| {
            let parameters: Map<String, Value> = entry
                .parameters
                .iter()
                .map(|p| (format!("{}_{}", p.name, p.unit), estimate(&p.estimate)))
                .collect();
            let mut model = json!({
                "model": entry.name,
                "description": entry.description,
                "failed": result.failed,
                "first_failure": result.reason,
                "parameters": parameters,
            });
            insert(&mut model, result.scores.as_ref());
            model
        });
    json!({
        "recording": comparison.name,
        "windows": comparison.set.windows.len(),
        "left_out": {
            "standing": comparison.set.rejected.standing,
            "gaps": comparison.set.rejected.gaps,
        },
        "fitted": comparison.halves.fitted.len(),
        "judged": comparison.halves.judged.len(),
        "counted": outcome.counted,
        "latency_s": {
            "pose": latency(&comparison.latencies.pose),
            "wheels": latency(&comparison.latencies.wheels),
        },
        "heading": comparison.how.heading.name(),
        "heading_noise_rad": comparison.heading_noise,
        "models": models.collect::<Vec<_>>(),
    })
}

fn pooled_model(pooled: &Pooled) -> Value {
    let mut model =
        json!({ "model": pooled.name, "counted": pooled.windows, "failed": pooled.failed });
    insert(&mut model, Some(&pooled.scores));
    model
}

/// Adds the scores; null where there is none.
fn insert(model: &mut Value, scores: Option<&Scores>) {
    model["position_m"] = scores.map_or(Value::Null, |scores| summary(&scores.position));
    model["heading_rad"] = scores.map_or(Value::Null, |scores| summary(&scores.heading));
}

fn summary(summary: &ErrorSummary) -> Value {
    json!({
        "median": estimate(&summary.median),
        "p95": estimate(&summary.p95),
        "rmse": estimate(&summary.rmse),
    })
}

fn estimate(estimate: &IntervalEstimate) -> Value {
    json!({ "value": estimate.value, "low": estimate.low, "high": estimate.high })
}

fn latency(latency: &Latency) -> Value {
    match latency {
        Latency::Estimated(value) => estimate(value),
        Latency::Unknown | Latency::Reference => Value::Null,
    }
}
