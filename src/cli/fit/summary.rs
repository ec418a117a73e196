//! The summary: what a person reads.

use super::short_name;
use std::fmt::Write;
use ugv_terrain::display::visible_line;
use ugv_terrain::fit::starts::Starts;
use ugv_terrain::fit::{Estimate, Fit};
use ugv_terrain::recording::Recording;

/// An overdispersion beyond this says that the model lacks something.
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
        "parameter", "fitted", "90 % interval", "before the data"
    );
    for (index, estimate) in fitted.estimates.iter().enumerate() {
        if index == fitted.model_parameters {
            text.push_str("sensors\n");
        }
        let (factor, unit) = shown(estimate.parameter.unit);
        let range =
            |low: f64, high: f64| format!("{} .. {}", digits(low * factor), digits(high * factor));
        let (low, high) = estimate.parameter.prior_interval();
        let _ = writeln!(
            text,
            "{:width$}  {:>9}  {:>22}  {:>22}  {unit}",
            name(estimate),
            digits(estimate.value * factor),
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
            digits(estimate.noise.white * factor),
            digits(estimate.noise.coloured * factor),
            estimate.noise.correlation_time,
            digits(estimate.rms * factor),
            100.0 * estimate.outliers,
        );
    }
}

fn starts(text: &mut String, found: &Starts, fitted: &Fit, recordings: &[Recording]) {
    let (agreed, tried) = (found.agreed, found.tried);
    let _ = match (agreed == tried, found.others.is_empty()) {
        (true, _) => writeln!(text, "all {tried} random starts lead to this answer"),
        (false, true) => writeln!(
            text,
            "{agreed} of {tried} random starts lead to this answer"
        ),
        (false, false) => writeln!(
            text,
            "{agreed} of {tried} random starts lead to this answer; others:"
        ),
    };
    for other in &found.others {
        let values = fitted
            .estimates
            .iter()
            .zip(&other.values)
            .map(|(estimate, value)| {
                let (factor, unit) = shown(estimate.parameter.unit);
                let name = short_name(&estimate.parameter.name, fitted, recordings);
                format!("{} {} {unit}", visible_line(name), digits(value * factor))
            });
        let verdict = if other.ruled_out() {
            "the data rule it out"
        } else {
            "THE DATA CANNOT CHOOSE"
        };
        let _ = writeln!(
            text,
            "  - {} starts: chi-square higher by {:.1}, {verdict}: {}",
            other.count,
            other.above,
            values.collect::<Vec<_>>().join(", ")
        );
    }
    let lost = tried - agreed - found.others.iter().map(|other| other.count).sum::<usize>();
    if lost > 0 {
        let _ = writeln!(
            text,
            "  - {lost} starts came to nothing ({} of them at soils on which the vehicle cannot drive)",
            found.failed
        );
    }
}

fn warnings(fitted: &Fit) -> Vec<String> {
    let mut warnings: Vec<String> = fitted.limits.iter().map(ToString::to_string).collect();
    let names = |part: &str| {
        let mut model = fitted.estimates[..fitted.model_parameters].iter();
        model.any(|estimate| estimate.parameter.name.contains(part))
    };
    if names("modulus") || names("sinkage") {
        warnings.push(
            "planar motion tells of sinkage only through its drag: pressure-sinkage parameters are \
             as good as a plate test only if their interval says so"
                .into(),
        );
    }
    if fitted.uncertainty.overdispersion > LACKING {
        warnings.push(format!(
            "segments disagree {:.1} times more than their noise explains: the model lacks something, \
             and the intervals are widened for it",
            fitted.uncertainty.overdispersion
        ));
    }
    if fitted.unusable > 0.0 {
        warnings.push(format!(
            "{:.0} s were left out for want of wheel speeds or samples",
            fitted.unusable
        ));
    }
    if fitted.undrivable > 0.0 {
        warnings.push(format!(
            "{:.0} s were left out because the model cannot drive there from where the sensors see it",
            fitted.undrivable
        ));
    }
    if !fitted.converged {
        warnings.push("the fit had not come to rest after its last turn".into());
    }
    warnings
}

/// Factor and unit of what is shown: angles in degrees.
fn shown(unit: &'static str) -> (f64, &'static str) {
    match unit {
        "rad" => (1f64.to_degrees(), "deg"),
        "rad/s" => (1f64.to_degrees(), "deg/s"),
        _ => (1.0, unit),
    }
}

/// Three significant digits.
fn digits(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let places = if size > 0.0 {
        2 - size.log10().floor() as i32
    } else {
        2
    };
    format!("{value:.*}", places.clamp(0, 5) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_shown() {
        for (value, expected) in [
            (0.0, "0.00"),
            (12_345.0, "12345"),
            (1.234e6, "1.23e6"),
            (-0.012_34, "-0.0123"),
            (1.0, "1.00"),
            (1e-5, "1.00e-5"),
        ] {
            assert_eq!(digits(value), expected);
        }
    }
}
