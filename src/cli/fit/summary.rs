//! The summary for people.

use std::fmt::Write;
use ugv_terrain::display::visible_line;
use ugv_terrain::fit::starts::Starts;
use ugv_terrain::fit::{Estimate, Fit};
use ugv_terrain::recording::Recording;
use ugv_terrain::report::number::{digits, shown};

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
    parameters(&mut text, fitted, recordings);
    noise(&mut text, fitted, recordings);
    if let Some(found) = &fitted.starts {
        starts(&mut text, found, fitted, recordings);
    }
    for warning in warnings(fitted) {
        let _ = writeln!(text, "  - {}", visible_line(&warning));
    }
    text
}

fn parameters(text: &mut String, fitted: &Fit, recordings: &[Recording]) {
    let name = |estimate: &Estimate| {
        let name = short_name(&estimate.parameter.name, fitted, recordings);
        visible_line(name).into_owned()
    };
    let width = fitted
        .estimates
        .iter()
        .map(|e| name(e).chars().count())
        .max()
        .unwrap_or(0)
        .max(9);
    let _ = writeln!(
        text,
        "{:width$}  {:>9}  {:>22}  {:>22}  unit",
        "parameter", "fitted", "90 % interval", "prior 90 % interval"
    );
    for (index, estimate) in fitted.estimates.iter().enumerate() {
        if index == fitted.model_parameters {
            text.push_str("sensors\n");
        }
        let (factor, unit) = shown(estimate.parameter.unit);
        let range = |low: f64, high: f64| {
            format!(
                "{} .. {}",
                digits(low * factor, 3),
                digits(high * factor, 3)
            )
        };
        let (low, high) = estimate.parameter.prior_interval();
        let _ = writeln!(
            text,
            "{:width$}  {:>9}  {:>22}  {:>22}  {unit}",
            name(estimate),
            digits(estimate.value * factor, 3),
            range(estimate.low, estimate.high),
            range(low, high),
        );
    }
}

fn noise(text: &mut String, fitted: &Fit, recordings: &[Recording]) {
    text.push_str("noise      white  coloured  over       residual rms  outliers  unit\n");
    let mut last = 0;
    for estimate in &fitted.noise {
        if recordings.len() > 1 && (estimate.recording != last || estimate == &fitted.noise[0]) {
            let _ = writeln!(
                text,
                "{}",
                visible_line(&recordings[estimate.recording].name)
            );
            last = estimate.recording;
        }
        let (name, unit) = estimate.group.describe();
        let (factor, unit) = shown(unit);
        let _ = writeln!(
            text,
            "{name:8}  {:>6}  {:>8}  {:>5.2} s  {:>12}  {:>6.1} %  {unit}",
            digits(estimate.noise.white * factor, 3),
            digits(estimate.noise.coloured * factor, 3),
            estimate.noise.correlation_time,
            digits(estimate.rms * factor, 3),
            100.0 * estimate.outliers,
        );
    }
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
