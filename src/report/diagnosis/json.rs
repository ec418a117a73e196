//! As JSON (format `ugv-diagnosis/1`), in SI units and radians; numbers that are not finite are null.
//!
//! Nothing here depends on the machine: one seed gives the same bytes.

use super::claim::headline;
use super::words;
use crate::diagnosis::{
    Candidate, Caution, Claim, Diagnosis, Errors, Finding, HeldOut, Insufficient, Interval,
    Manoeuvre, Quantity, Subject, Term,
};
use crate::fit::{Estimate, NoiseEstimate};
use crate::report::inspection::doubt_json;
use serde_json::{Map, Value, json as object};

/// A finished diagnosis.
#[must_use]
pub fn json(diagnosis: &Diagnosis) -> String {
    let account = &diagnosis.account;
    let noise = |estimate: &NoiseEstimate| noise(estimate, diagnosis);
    let all = object!({
        "format": "ugv-diagnosis/1",
        "verdict": diagnosis.verdict.name(),
        "insufficient": diagnosis.insufficient.map(Insufficient::name),
        "headline": headline(diagnosis),
        "statement": diagnosis.statement,
        "cautions": diagnosis.cautions.iter().map(caution).collect::<Vec<_>>(),
        "recordings": diagnosis.recordings,
        "findings": diagnosis.findings.iter().map(|f| finding(f, diagnosis)).collect::<Vec<_>>(),
        "claims": diagnosis.claims.iter().map(claim).collect::<Vec<_>>(),
        "candidates": diagnosis.candidates.iter().map(candidate).collect::<Vec<_>>(),
        "fit": {
            "held_out": diagnosis.held_out.as_ref().map(held_out),
            "soil": diagnosis.soil.iter().map(soil).collect::<Vec<_>>(),
        },
        "next_manoeuvre": diagnosis.next.as_ref().map(manoeuvre),
        "account": {
            "seed": account.seed,
            "segments": account.segments,
            "seconds": account.seconds,
            "seconds_left_out": account.left_out,
            "noise": account.noise.iter().map(noise).collect::<Vec<_>>(),
            "overdispersion": account.overdispersion,
            "threshold": account.threshold,
            "refused": log_odds(&account.refused),
            // Without their seconds, which depend on the machine.
            "steps": account.steps.iter().map(|step| step.0).collect::<Vec<_>>(),
            "notes": account.notes,
        },
    });
    // This value always has a text.
    serde_json::to_string_pretty(&all).unwrap_or_default() + "\n"
}

fn claim(claim: &Claim) -> Value {
    object!({
        "level": claim.level.name(),
        "name": claim.name,
        "statement": claim.statement,
        "probability": claim.probability,
    })
}

fn caution(caution: &Caution) -> Value {
    let mut value = object!({ "kind": caution.name(), "text": caution.text() });
    if let Caution::DoubtfulData { recording, doubt } = caution {
        value["recording"] = recording.as_str().into();
        value["doubt"] = doubt_json(doubt);
    }
    value
}

fn kind(subject: Subject) -> Option<&'static str> {
    match subject {
        Subject::Nothing => None,
        _ if subject.is_sensor() => Some("sensor"),
        _ => Some("physics"),
    }
}

fn finding(finding: &Finding, diagnosis: &Diagnosis) -> Value {
    // Two channels may have terms of one name, so terms have the full name of their parameter.
    let terms = finding.law.iter();
    let terms = terms.map(|term| (term.parameter.clone(), quantity(&term.coefficient)));
    let named = finding.parameters.iter().filter(|_| finding.law.is_empty());
    let named = named.map(|found| (words::parameter(found, diagnosis), quantity(found)));
    let parameters: Map<String, Value> = terms.chain(named).collect();
    object!({
        "effect": finding.subject.name(),
        "kind": kind(finding.subject),
        "probability": finding.probability,
        "ambiguous_with": finding.ambiguous_with.iter().map(|s| s.name()).collect::<Vec<_>>(),
        "evidence": finding.evidence,
        "rivals": log_odds(&finding.rivals),
        "parameters": parameters,
        "where": finding.places.iter().map(place).collect::<Vec<_>>(),
        "local": finding.local,
        "law": finding.law.iter().map(term).collect::<Vec<_>>(),
        "mended_by": finding.mended_by.iter().map(term).collect::<Vec<_>>(),
        "statement": finding.statement,
    })
}

fn log_odds(odds: &[(Subject, f64)]) -> Vec<Value> {
    let one =
        |(subject, odds): &(Subject, f64)| object!({ "effect": subject.name(), "log_odds": odds });
    odds.iter().map(one).collect()
}

fn quantity(quantity: &Quantity) -> Value {
    object!({
        "value": quantity.value,
        "low": quantity.low,
        "high": quantity.high,
        "unit": quantity.unit,
    })
}

fn place(place: &Interval) -> Value {
    let mut value = object!({
        "recording": place.recording,
        "run": place.run,
        "label": place.label,
        "start": place.start,
        "end": place.end,
        "channel": place.channel.name(),
        "regime": place.regime,
    });
    if let Some([east, north, radius]) = place.patch {
        value["patch"] = object!({ "east": east, "north": north, "radius": radius });
    }
    value
}

fn term(term: &Term) -> Value {
    object!({
        "channel": term.channel.name(),
        "parameter": term.parameter,
        "group": term.group,
        "coefficient": quantity(&term.coefficient),
        "stability": term.stability,
    })
}

fn candidate(candidate: &Candidate) -> Value {
    let alike = candidate
        .alike
        .iter()
        .map(|(subject, cosine)| object!({ "effect": subject.name(), "cosine": cosine }));
    let is_effect = matches!(candidate.subject, Subject::Effect(_));
    object!({
        "effect": candidate.subject.name(),
        "kind": kind(candidate.subject),
        "probability": candidate.probability,
        "absorbed_by_retuning": candidate.absorbed,
        "significance": candidate.significance,
        "smallest_detectable": candidate.smallest_detectable,
        "parameter": is_effect.then_some(candidate.parameter),
        "unit": is_effect.then_some(candidate.unit),
        "estimate": is_effect.then(|| object!({
            "value": candidate.estimate,
            "low": candidate.interval[0],
            "high": candidate.interval[1],
        })),
        "held_out_gain": candidate.held_out_gain.map(|(gain, error)| {
            object!({ "value": gain, "standard_error": error })
        }),
        "alike": alike.collect::<Vec<_>>(),
    })
}

fn held_out(held_out: &HeldOut) -> Value {
    object!({
        "nominal": errors(&held_out.nominal),
        "retuned": errors(&held_out.refitted),
        "augmented": errors(&held_out.augmented),
        "gain": {
            "value": held_out.gain.0,
            "standard_error": held_out.gain.1,
        },
        "horizon": held_out.horizon,
        "stretches": held_out.stretches,
    })
}

fn errors(errors: &Errors) -> Value {
    object!({
        "position_rmse_m": errors.position,
        "heading_rmse_rad": errors.heading,
        "yaw_rate_rmse_rad_s": errors.yaw_rate,
        "log_score": errors.log_score,
    })
}

fn soil((refitted, augmented): &(Estimate, Estimate)) -> Value {
    let fitted = |estimate: &Estimate| {
        object!({
            "value": estimate.value,
            "low": estimate.low,
            "high": estimate.high,
            "width_over_prior": estimate.posterior_prior_ratio,
        })
    };
    object!({
        "parameter": refitted.parameter.name,
        "unit": refitted.parameter.unit,
        "nominal": refitted.nominal,
        "retuned": fitted(refitted),
        "augmented": fitted(augmented),
    })
}

fn manoeuvre(manoeuvre: &Manoeuvre) -> Value {
    let compared = manoeuvre
        .compared
        .iter()
        .map(|(name, separation)| object!({ "name": name, "separation": separation }));
    object!({
        "name": manoeuvre.name,
        "description": manoeuvre.description,
        "separates": manoeuvre.separates.map(Subject::name),
        "separation": manoeuvre.separation,
        "compared": compared.collect::<Vec<_>>(),
    })
}

fn noise(estimate: &NoiseEstimate, diagnosis: &Diagnosis) -> Value {
    let (channel, unit) = estimate.group.describe();
    object!({
        "recording": diagnosis.recordings.get(estimate.recording),
        "channel": channel,
        "unit": unit,
        "white": estimate.noise.white,
        "coloured": estimate.noise.coloured,
        "correlation_time": estimate.noise.correlation_time,
        "samples": estimate.samples,
        "rms": estimate.rms,
        "outliers": estimate.outliers,
    })
}
