//! Subjects and findings in plain sentences.

use crate::diagnosis::outcome::{Channel, Finding, Interval, Quantity, Subject, Term};
use crate::effects::CATALOGUE;

/// A subject in plain words, with its name.
#[must_use]
pub fn phrase(subject: Subject) -> String {
    match subject {
        Subject::Unknown => "something that the catalogue does not contain".into(),
        Subject::Nothing => "nothing missing".into(),
        Subject::Data => "data that are not what they claim".into(),
        Subject::Effect(effect) => {
            let declared = CATALOGUE[effect];
            format!("{} ({})", declared.phrase, declared.name)
        }
    }
}

/// A finding in one sentence.
#[must_use]
pub fn statement(finding: &Finding) -> String {
    let what = if finding.law.is_empty() {
        numbers(finding)
    } else {
        residual_model(&finding.law)
    };
    let first = finding.places.first();
    let place = first.filter(|_| finding.local);
    let place = place.map_or(String::new(), |place| {
        let (start, end) = (place.start, place.end);
        format!(", from {start:.1} to {end:.1} s of {}", whose(place))
    });
    let regime = first.map_or("", |place| &place.regime);
    let regime = if regime.is_empty() {
        String::new()
    } else {
        format!("; most visible regime: {regime}")
    };
    let mended = if finding.mended_by.is_empty() {
        String::new()
    } else {
        let terms = residual_model(&finding.mended_by);
        format!("; its formula differs from the catalogue's, which this mends: {terms}")
    };
    format!("{what}{place}{regime}{mended}")
}

/// The subject of a finding with its numbers. Where another formula takes the place of the catalogue's, there are none.
#[must_use]
pub fn numbers(finding: &Finding) -> String {
    let is_replaced = !finding.mended_by.is_empty()
        && finding
            .parameters
            .iter()
            .all(|one| one.low <= one.off && one.off <= one.high);
    if is_replaced {
        return phrase(finding.subject);
    }
    let numbers: Vec<String> = finding.parameters.iter().map(number).collect();
    format!("{}: {}", phrase(finding.subject), numbers.join(", "))
}

/// The recording of a place, with the label of its run.
#[must_use]
pub fn whose(place: &Interval) -> String {
    let run = match &place.label[..] {
        "" => String::new(),
        label => format!(", run {label}"),
    };
    format!("{}{run}", place.recording)
}

/// The terms of an empirical residual model by the component of the wrench that they add to.
fn residual_model(terms: &[Term]) -> String {
    let each = [Channel::Longitudinal, Channel::Lateral, Channel::Yaw].map(|channel| {
        let own = terms.iter().filter(|term| term.channel == channel);
        let own: Vec<String> = own.map(term).collect();
        let (what, unit) = match channel {
            Channel::Yaw => ("a turning moment", "m g B"),
            Channel::Lateral => ("a force across the vehicle", "m g"),
            _ => ("a force along the vehicle", "m g"),
        };
        (!own.is_empty()).then(|| format!("{what} [{unit}] {}", own.join(" and ")))
    });
    each.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// A term by its parameter's description, with its coefficient.
fn term(term: &Term) -> String {
    let (effect, name) = term.parameter.split_once('.').unwrap_or_default();
    let effect = CATALOGUE.iter().find(|known| known.name == effect);
    let declared = effect.and_then(|known| known.parameters.iter().find(|p| p.name == name));
    let words = declared.map_or(name, |declared| declared.description);
    let words = words.trim_end_matches(" (negative)");
    let mut letters = words.chars();
    let first = letters.next().map(|letter| letter.to_ascii_lowercase());
    let words: String = first.into_iter().chain(letters).collect();
    format!("{words} ({})", significant(term.coefficient.value))
}

fn number(quantity: &Quantity) -> String {
    let Quantity {
        name,
        value,
        low,
        high,
        unit,
        recording,
        ..
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
