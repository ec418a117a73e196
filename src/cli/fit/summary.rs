//! The summary for people.

use crate::display::visible_line;
use crate::fit::Fit;
use crate::fit::starts::Starts;
use crate::recording::Recording;
use crate::report::aligned;
use crate::report::number::{digits, shown};
use std::fmt::Write;

/// A larger overdispersion means that the model lacks something.
const LACKING: f64 = 3.0;

pub fn text(fitted: &Fit, recordings: &[Recording], elapsed: f64) -> String {
    let mut text = String::new();
    let count = recordings.len();
    let plural = if count == 1 { "" } else { "s" };
    let _ = writeln!(
        text,
        "fitted {count} recording{plural}: {:.0} s of driving in {} segments, in {elapsed:.1} s",
        fitted.seconds, fitted.segments
    );
    text += &parameters(fitted, recordings);
    text += &noise(fitted, recordings);
    if let Some(found) = &fitted.starts {
        starts(&mut text, found, fitted, recordings);
    }
    for warning in warnings(fitted) {
        let _ = writeln!(text, "  - {}", visible_line(&warning));
    }
    text
}

fn parameters(fitted: &Fit, recordings: &[Recording]) -> String {
    let header = [
        "parameter",
        "fitted",
        "90 % interval",
        "prior 90 % interval",
        "unit",
    ];
    let rows = fitted.estimates.iter().map(|estimate| {
        let (factor, unit) = shown(estimate.parameter.unit);
        let shown = |value: f64| digits(value * factor, 3);
        let (low, high) = estimate.parameter.prior_interval();
        let name = short_name(&estimate.parameter.name, fitted, recordings);
        [
            visible_line(name).into_owned(),
            shown(estimate.value),
            format!("{} .. {}", shown(estimate.low), shown(estimate.high)),
            format!("{} .. {}", shown(low), shown(high)),
            unit.into(),
        ]
    });
    aligned(header, &rows.collect::<Vec<_>>())
}

fn noise(fitted: &Fit, recordings: &[Recording]) -> String {
    let header = [
        "noise",
        "white",
        "coloured",
        "correlated over",
        "residual rms",
        "outliers",
        "unit",
    ];
    let rows = fitted.noise.iter().map(|estimate| {
        let (name, unit) = estimate.group.describe();
        let (factor, unit) = shown(unit);
        let shown = |value: f64| digits(value * factor, 3);
        let name = match recordings.len() {
            1 => name.into(),
            _ => format!(
                "{} {name}",
                visible_line(&recordings[estimate.recording].name)
            ),
        };
        [
            name,
            shown(estimate.noise.white),
            shown(estimate.noise.coloured),
            format!("{:.2} s", estimate.noise.correlation_time),
            shown(estimate.rms),
            format!("{:.1} %", 100.0 * estimate.outliers),
            unit.into(),
        ]
    });
    aligned(header, &rows.collect::<Vec<_>>())
}

fn starts(text: &mut String, found: &Starts, fitted: &Fit, recordings: &[Recording]) {
    let (agreed, tried) = (found.agreed, found.tried);
    let others = if found.others.is_empty() {
        ""
    } else {
        "; others:"
    };
    let _ = writeln!(
        text,
        "{agreed} of {tried} random starts lead to this solution{others}"
    );
    for other in &found.others {
        let values = fitted
            .estimates
            .iter()
            .zip(&other.values)
            .map(|(estimate, value)| {
                let (factor, unit) = shown(estimate.parameter.unit);
                let name = short_name(&estimate.parameter.name, fitted, recordings);
                format!(
                    "{} {} {unit}",
                    visible_line(name),
                    digits(value * factor, 3)
                )
            });
        let verdict = if other.ruled_out() {
            "ruled out by the data"
        } else {
            "EQUALLY GOOD"
        };
        let _ = writeln!(
            text,
            "  - {} starts: chi-square higher by {:.1}, {verdict}: {}",
            other.count,
            other.above,
            values.collect::<Vec<_>>().join(", ")
        );
    }
    let failed = tried - agreed - found.others.iter().map(|other| other.count).sum::<usize>();
    if failed > 0 {
        let _ = writeln!(
            text,
            "  - {failed} starts failed ({} of them on soils on which the vehicle cannot drive)",
            found.failed
        );
    }
}

fn warnings(fitted: &Fit) -> Vec<String> {
    let mut warnings: Vec<String> = fitted.limits.iter().map(ToString::to_string).collect();
    let has = |word: &str| {
        let mut model = fitted.estimates[..fitted.model_parameters].iter();
        model.any(|estimate| estimate.parameter.name.contains(word))
    };
    if has("modulus") || has("sinkage") {
        warnings.push(
            "planar motion depends on sinkage only through its drag: pressure-sinkage parameters are \
             as good as a plate test only with a narrow interval"
                .into(),
        );
    }
    if fitted.uncertainty.overdispersion > LACKING {
        warnings.push(format!(
            "the segments scatter {:.1} times as much as their noise explains: the model lacks something, \
             and the intervals are wider for it",
            fitted.uncertainty.overdispersion
        ));
    }
    if fitted.unusable > 0.0 {
        warnings.push(format!(
            "{:.0} s without wheel speeds or samples were not used",
            fitted.unusable
        ));
    }
    if fitted.undrivable > 0.0 {
        warnings.push(format!(
            "{:.0} s were not used: the model cannot drive there from the measured state",
            fitted.undrivable
        ));
    }
    if !fitted.converged {
        warnings.push("the fit did not converge".into());
    }
    warnings
}

/// The name of a parameter; a sensor parameter of a single recording is named without the recording.
fn short_name<'a>(name: &'a str, fitted: &Fit, recordings: &[Recording]) -> &'a str {
    let is_sensor = fitted.estimates[fitted.model_parameters..]
        .iter()
        .any(|estimate| estimate.parameter.name == name);
    match name.rsplit_once('.') {
        Some((_, short)) if is_sensor && recordings.len() == 1 => short,
        _ => name,
    }
}
