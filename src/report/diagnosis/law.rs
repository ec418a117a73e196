//! The empirical residual model as a formula.

use super::words;
use crate::diagnosis::{Channel, Diagnosis, Term};
use crate::report::number::{percent, with_interval};
use crate::vehicle::GRAVITY;

/// The channels that a residual model acts on, with the left side of its equation.
const CHANNELS: [(Channel, &str); 3] = [
    (Channel::Longitudinal, "dF_X / (m g) ="),
    (Channel::Lateral, "dF_Y / (m g) ="),
    (Channel::Yaw, "dM_Z / (m g B) ="),
];

/// Symbols of the equations with their meaning.
const SYMBOLS: [(&str, &str); 6] = [
    ("u", "forward speed over sqrt(g B)"),
    ("w", "speed to the left over sqrt(g B)"),
    ("q", "yaw rate times sqrt(B / g)"),
    (
        "p",
        "speed of the rims over the ground (for the yaw moment their difference) over sqrt(g B)",
    ),
    ("s", "sign, fading towards standstill"),
    ("psi", "heading, counter-clockwise from east"),
];

/// One equation for each channel that the terms act on.
pub fn equations(law: &[Term]) -> Vec<String> {
    let equation = |(channel, left_side): (Channel, &str)| {
        let mut terms = law.iter().filter(|term| term.channel == channel).peekable();
        terms.peek()?;
        let mut text = left_side.to_owned();
        for (place, term) in terms.enumerate() {
            let found = &term.coefficient;
            let [value, ..] = with_interval(found.value, found.low, found.high);
            let size = value.strip_prefix('-');
            let group = term.group.strip_prefix('-');
            let is_negative = size.is_some() != group.is_some();
            text += match (place, is_negative) {
                (0, false) => " ",
                (0, true) => " -",
                (_, false) => " + ",
                (_, true) => " - ",
            };
            text += size.unwrap_or(&value);
            let group = group.unwrap_or(&term.group);
            if group != "1" {
                text += &format!(" {group}");
            }
        }
        Some(text)
    };
    CHANNELS.into_iter().filter_map(equation).collect()
}

/// An equation with typographic signs.
pub fn typeset(equation: &str) -> String {
    let text = equation
        .replace(" - ", " \u{2212} ")
        .replace("= -", "= \u{2212}");
    text.replace("psi", "\u{3c8}").replace("^2", "\u{b2}")
}

/// The meaning of the symbols in some terms, with the numbers of the vehicle.
pub fn symbols(law: &[Term], diagnosis: &Diagnosis) -> String {
    let vehicle = &diagnosis.model.vehicle;
    let weight = vehicle.mass * GRAVITY;
    let speed = (GRAVITY * vehicle.half_track).sqrt();
    let mut meanings = vec![
        format!("m g = {weight:.0} N, the weight"),
        format!(
            "B = {:.2} m, half the track; sqrt(g B) = {speed:.2} m/s",
            vehicle.half_track
        ),
    ];
    let groups: Vec<&str> = law.iter().map(|term| &term.group[..]).collect();
    let groups = groups.join(" ");
    let words: Vec<&str> = groups.split(|c: char| !c.is_alphanumeric()).collect();
    for (symbol, meaning) in SYMBOLS {
        if words.contains(&symbol) {
            meanings.push(format!("{symbol}: {meaning}"));
        }
    }
    meanings.join("; ")
}

/// A row of the table of terms.
pub fn cells(term: &Term) -> Vec<String> {
    vec![
        words::channel(term.channel).into(),
        typeset(&term.group),
        words::value(&term.coefficient),
        percent(term.stability),
        term.parameter.clone(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Quantity;

    fn term(channel: Channel, group: &str, value: f64) -> Term {
        Term {
            channel,
            parameter: "residual_yaw.speed_turning".into(),
            group: group.into(),
            coefficient: Quantity {
                name: "speed_turning".into(),
                recording: None,
                value,
                low: value - 0.01,
                high: value + 0.01,
                off: 0.0,
                unit: "1",
            },
            stability: 0.9,
        }
    }

    #[test]
    fn laws_are_formulas() {
        let law = [
            term(Channel::Yaw, "|u| q", -0.042),
            term(Channel::Lateral, "1", 0.1),
            term(Channel::Lateral, "-sin psi", -0.2),
            term(Channel::Yaw, "sin psi", 0.2),
            term(Channel::Yaw, "w^2", -0.3),
        ];
        assert_eq!(
            equations(&law),
            [
                "dF_Y / (m g) = 0.100 + 0.200 sin psi",
                "dM_Z / (m g B) = -0.042 |u| q + 0.200 sin psi - 0.300 w^2"
            ]
        );
        assert_eq!(
            typeset("y = -0.042 |u| q - 0.3 w^2 sin psi"),
            "y = \u{2212}0.042 |u| q \u{2212} 0.3 w\u{b2} sin \u{3c8}"
        );
        assert!(equations(&[]).is_empty());
    }
}
