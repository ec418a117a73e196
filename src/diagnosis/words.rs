//! A finding in a plain sentence.

use super::outcome::{Finding, Quantity, Subject};

/// One plain sentence.
#[must_use]
pub fn statement(finding: &Finding) -> String {
    let numbers: Vec<String> = finding.parameters.iter().map(number).collect();
    let place = finding
        .places
        .first()
        .filter(|_| finding.local)
        .map_or(String::new(), |place| {
            format!(
                " from {:.1} to {:.1} s of {}",
                place.start, place.end, place.recording
            )
        });
    let what = match finding.subject {
        Subject::Unknown => "a push without a name".into(),
        Subject::Effect(_) if finding.subject.is_sensor() => {
            format!("the sensors: {}", finding.subject.name())
        }
        _ => finding.subject.name().to_owned(),
    };
    let regime = finding
        .places
        .first()
        .map_or("", |place| place.regime.as_str());
    let regime = if regime.is_empty() {
        String::new()
    } else {
        format!("; it shows most at {regime}")
    };
    format!("{what}, {}{place}{regime}", numbers.join(", "))
}

fn number(quantity: &Quantity) -> String {
    let Quantity {
        name,
        value,
        low,
        high,
        unit,
        recording,
    } = quantity;
    let whose = recording
        .as_ref()
        .map_or(String::new(), |name| format!(" ({name})"));
    let (scale, unit) = match *unit {
        "rad" => (1f64.to_degrees(), "deg"),
        "1" => (1.0, ""),
        other => (1.0, other),
    };
    let shown = |v: f64| significant(scale * v);
    let space = if unit.is_empty() { "" } else { " " };
    format!(
        "{name}{whose} {}{space}{unit} (90 %: {} to {})",
        shown(*value),
        shown(*low),
        shown(*high)
    )
}

/// Three significant digits.
fn significant(value: f64) -> String {
    let digits = if value == 0.0 {
        0
    } else {
        (2 - value.abs().log10().floor() as i32).clamp(0, 5)
    };
    format!("{value:.*}", digits as usize)
}
