//! A law for what has no name, as a formula.

use super::words;
use crate::diagnosis::{Channel, Diagnosis, Term};
use crate::report::number::{percent, with_interval};
use crate::vehicle::GRAVITY;

/// The channels that a law may push.
const PUSHED: [Channel; 3] = [Channel::Longitudinal, Channel::Lateral, Channel::Yaw];

/// Symbols of a law with what they stand for.
const SYMBOLS: [(&str, &str); 6] = [
    ("u", "speed ahead over sqrt(g B)"),
    ("w", "speed to the left over sqrt(g B)"),
    ("q", "yaw rate times sqrt(B / g)"),
    (
        "p",
        "rims' speed over the ground (in turns that of their difference) over sqrt(g B)",
    ),
    ("s", "sign, fading towards standstill"),
    ("psi", "heading, counter-clockwise from east"),
];

/// One equation for each channel that is pushed.
pub fn equations(law: &[Term]) -> Vec<String> {
    let of = |channel: Channel| {
        let terms: Vec<&Term> = law.iter().filter(|term| term.channel == channel).collect();
        let mut text = match channel {
            Channel::Longitudinal => "dF_X / (m g) =".to_owned(),
            Channel::Lateral => "dF_Y / (m g) =".to_owned(),
            _ => "dM_Z / (m g B) =".to_owned(),
        };
        for (place, term) in terms.iter().enumerate() {
            let found = &term.coefficient;
            let [value, ..] = with_interval(found.value, found.low, found.high);
            let (turned, group) = unsigned(&term.group);
            let (sign, size) = match (value.strip_prefix('-'), turned) {
                (Some(size), true) => ("+", size),
                (Some(size), false) => ("-", size),
                (None, true) => ("-", &value[..]),
                (None, false) => ("+", &value[..]),
            };
            match (place, sign) {
                (0, "+") => text += &format!(" {size}"),
                (0, _) => text += &format!(" -{size}"),
                _ => text += &format!(" {sign} {size}"),
            }
            if group != "1" {
                text += &format!(" {group}");
            }
        }
        (!terms.is_empty()).then_some(text)
    };
    PUSHED.into_iter().filter_map(of).collect()
}

/// Whether a group has a minus of its own, and the group without it.
fn unsigned(group: &str) -> (bool, &str) {
    group
        .strip_prefix('-')
        .map_or((false, group), |rest| (true, rest))
}

/// An equation as one writes it by hand.
pub fn handwritten(equation: &str) -> String {
    let text = equation
        .replace(" - ", " \u{2212} ")
        .replace("= -", "= \u{2212}");
    text.replace("psi", "\u{3c8}").replace("^2", "\u{b2}")
}

/// What the symbols of a law stand for, with the numbers of the vehicle.
pub fn symbols(law: &[Term], diagnosis: &Diagnosis) -> String {
    let vehicle = &diagnosis.model.vehicle;
    let weight = vehicle.mass * GRAVITY;
    let speed = (GRAVITY * vehicle.half_track).sqrt();
    let mut told = vec![
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
            told.push(format!("{symbol}: {meaning}"));
        }
    }
    told.join("; ")
}

/// A row of the terms' table.
pub fn cells(term: &Term) -> Vec<String> {
    vec![
        words::channel(term.channel).into(),
        handwritten(&term.group),
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
            handwritten("y = -0.042 |u| q - 0.3 w^2 sin psi"),
            "y = \u{2212}0.042 |u| q \u{2212} 0.3 w\u{b2} sin \u{3c8}"
        );
        assert!(equations(&[]).is_empty());
    }
}
