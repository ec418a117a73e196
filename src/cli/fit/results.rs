//! The results as JSON, format `ugv-fit/1`: all results, in SI units and radians.

use crate::fit::starts::{OtherMinimum, Starts};
use crate::fit::{Estimate, Fit, NoiseEstimate, Options};
use crate::inspection::Doubt;
use crate::recording::Recording;
use crate::report::inspection::doubt_json;
use crate::vehicle::Specification;
use serde_json::{Value, json};

pub fn to_json(
    fitted: &Fit,
    model: &Specification,
    recordings: &[Recording],
    options: &Options,
    doubted: &[(String, Vec<Doubt>)],
) -> String {
    let doubt = |name: &String, doubt: &Doubt| {
        let mut value = doubt_json(doubt);
        value["recording"] = name.as_str().into();
        value
    };
    let doubts = doubted.iter();
    let doubts = doubts.flat_map(|(name, found)| found.iter().map(move |one| doubt(name, one)));
    let names: Vec<&str> = recordings.iter().map(|r| r.name.as_str()).collect();
    let count = fitted.estimates.len();
    let correlation = |a: usize| -> Vec<f64> {
        (0..count)
            .map(|b| fitted.uncertainty.correlation(a, b))
            .collect()
    };
    let document = json!({
        "format": "ugv-fit/1",
        "recordings": names,
        "settings": {
            "segment_s": options.segment, "starts": options.starts, "seed": options.seed,
            "robust": options.robust,
        },
        "doubts": doubts.collect::<Vec<_>>(),
        "parameters": fitted.estimates.iter().enumerate()
            .map(|(k, estimate)| parameter(estimate, k < fitted.model_parameters))
            .collect::<Vec<_>>(),
        "correlation": (0..count).map(correlation).collect::<Vec<_>>(),
        "noise": fitted.noise.iter().map(|noise| channel(noise, &names)).collect::<Vec<_>>(),
        "overdispersion": fitted.uncertainty.overdispersion,
        "limits": fitted.limits.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "starts": fitted.starts.as_ref().map(|found| starts(found, fitted)),
        "data": {
            "segments": fitted.segments, "seconds": fitted.seconds,
            "at_rest_s": fitted.at_rest, "unusable_s": fitted.unusable,
            "undrivable_s": fitted.undrivable,
        },
        "turns": fitted.turns,
        "converged": fitted.converged,
        "model": serde_json::from_str::<Value>(&model.to_json()).unwrap_or_default(),
    });
    format!("{document:#}\n")
}

fn parameter(estimate: &Estimate, of_model: bool) -> Value {
    let (low, high) = estimate.parameter.prior_interval();
    json!({
        "name": estimate.parameter.name, "unit": estimate.parameter.unit,
        "kind": if of_model { "model" } else { "sensor" },
        "value": estimate.value, "low": estimate.low, "high": estimate.high,
        "start": estimate.nominal,
        "prior": { "median": estimate.parameter.prior.median, "low": low, "high": high },
        "width_over_prior": estimate.posterior_prior_ratio,
    })
}

fn channel(estimate: &NoiseEstimate, names: &[&str]) -> Value {
    let (channel, unit) = estimate.group.describe();
    json!({
        "recording": names[estimate.recording], "channel": channel, "unit": unit,
        "white": estimate.noise.white, "coloured": estimate.noise.coloured,
        "correlation_time_s": estimate.noise.correlation_time,
        "residual_rms": estimate.rms, "samples": estimate.samples,
        "outlier_share": estimate.outliers,
    })
}

fn starts(found: &Starts, fitted: &Fit) -> Value {
    let other = |minimum: &OtherMinimum| {
        let values = fitted.estimates.iter().zip(&minimum.values);
        let values: serde_json::Map<String, Value> = values
            .map(|(estimate, value)| (estimate.parameter.name.clone(), json!(value)))
            .collect();
        json!({
            "count": minimum.count, "chi_square_above": minimum.above,
            "ruled_out": minimum.ruled_out(), "values": values,
        })
    };
    json!({
        "tried": found.tried, "failed": found.failed, "agreed": found.agreed,
        "others": found.others.iter().map(other).collect::<Vec<_>>(),
    })
}
