//! Scores as JSON, format `ugv-score/1`.

use super::comparison::{ComparisonResult, ModelScores, PooledResult};
use crate::identification::{ErrorSummary, Latency};
use crate::recording::IntervalEstimate;
use crate::report::inspection::doubt_json;
use serde_json::{Map, Value, json};

pub fn render(
    horizon: f64,
    spacing: f64,
    results: &[ComparisonResult],
    pooled: Option<&[PooledResult]>,
) -> String {
    let pooled = pooled.map(|models| models.iter().map(pooled_model).collect::<Vec<_>>());
    let value = json!({
        "format": "ugv-score/1",
        "horizon_s": horizon,
        "spacing_s": spacing,
        "recordings": results.iter().map(recording).collect::<Vec<_>>(),
        "pooled": pooled,
    });
    format!("{value:#}\n")
}

fn recording(all: &ComparisonResult) -> Value {
    let comparison = all.comparison;
    let models = comparison
        .models
        .iter()
        .zip(&all.results)
        .map(|(model, result)| {
            let parameters: Map<String, Value> = model
                .parameters
                .iter()
                .map(|p| (format!("{}_{}", p.name, p.unit), estimate(&p.estimate)))
                .collect();
            let mut value = json!({
                "model": model.name,
                "description": model.description,
                "failed": result.failed,
                "first_failure": result.reason,
                "parameters": parameters,
            });
            insert(&mut value, result.scores.as_ref());
            value
        });
    json!({
        "recording": comparison.name,
        "doubts": comparison.doubts.iter().map(doubt_json).collect::<Vec<_>>(),
        "windows": comparison.set.windows.len(),
        "left_out": {
            "standing": comparison.set.rejected.standing,
            "gaps": comparison.set.rejected.gaps,
        },
        "fitted": comparison.halves.fitted.len(),
        "judged": comparison.halves.judged.len(),
        "counted": all.counted,
        "latency_s": {
            "pose": latency(&comparison.latencies.pose),
            "wheels": latency(&comparison.latencies.wheels),
        },
        "heading": comparison.cut.heading.name(),
        "heading_noise_rad": comparison.heading_noise,
        "models": models.collect::<Vec<_>>(),
    })
}

fn pooled_model(pooled: &PooledResult) -> Value {
    let mut model =
        json!({ "model": pooled.name, "counted": pooled.windows, "failed": pooled.failed });
    insert(&mut model, Some(&pooled.scores));
    model
}

/// Adds the scores; null without any.
fn insert(model: &mut Value, scores: Option<&ModelScores>) {
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
