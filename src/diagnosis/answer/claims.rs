//! The ladder of claims about the finding that a verdict is about: where it acts, which mechanism it is, by which
//! formula. Each has its own probability: what is safe to say of the direction may not be of the name.

use super::verdict::Judgement;
use super::words::phrase;
use crate::diagnosis::outcome::{Channel, Claim, ClaimLevel, Finding, Subject};
use crate::diagnosis::screening::shape;
use crate::diagnosis::search::SearchResult;
use crate::effects::{CATALOGUE, Class};

/// The claims of a judgement, from the safest to the boldest; none without a leading finding.
///
/// # Algorithm
/// 1. *Where.* Names of one class, such as all that resist the motion, share their probability. What resists does so in
///    the direction in which the finding shows most: all of its rivals explain the same misfit. *Unknown* physics
///    counts as a resistance there.
/// 2. *Mechanism.* The probability of the finding's name.
/// 3. *Formula.* That times the probability of the catalogue's own formula against the neighbours of it
///    ([`crate::diagnosis::screening::shape`]).
#[must_use]
pub fn claims(searched: &SearchResult, judgement: &Judgement, findings: &[Finding]) -> Vec<Claim> {
    let Some(place) = judgement.leading else {
        return Vec::new();
    };
    let (judged, finding) = (&judgement.findings[place], &findings[place]);
    let class = class(finding.subject);
    let of_class = judged.posterior.iter();
    let of_class = of_class.filter(|(subject, _)| *subject != Subject::Nothing);
    let of_class = of_class.filter(|(subject, _)| self::class(*subject) == class);
    let together: f64 = of_class.map(|(_, probability)| probability).sum();
    let channel = finding.places.first().map(|place| place.channel);
    let (name, words) = words(class, channel.unwrap_or(Channel::Longitudinal));
    let mut claims = vec![Claim {
        level: ClaimLevel::Where,
        name,
        statement: words.into(),
        probability: together.max(finding.probability).min(1.0),
    }];
    let Subject::Effect(_) = finding.subject else {
        return claims;
    };
    claims.push(Claim {
        level: ClaimLevel::Mechanism,
        name: finding.subject.name(),
        statement: phrase(finding.subject),
        probability: finding.probability,
    });
    let exact = match finding.subject {
        Subject::Effect(effect) if !CATALOGUE[effect].varies_with.is_empty() => {
            shape::exactness(searched.augmented.shape_gain)
        }
        _ => 1.0,
    };
    let numbers = finding.statement.split(';').next().unwrap_or_default();
    claims.push(Claim {
        level: ClaimLevel::Formula,
        name: finding.subject.name(),
        statement: format!("{numbers}, by the catalogue's formula"),
        probability: finding.probability * exact,
    });
    claims
}

fn class(subject: Subject) -> Class {
    match subject {
        Subject::Effect(effect) => CATALOGUE[effect].class,
        Subject::Unknown | Subject::Nothing => Class::Resistance,
    }
}

/// Name of a claim about a class, and the claim.
fn words(class: Class, channel: Channel) -> (&'static str, &'static str) {
    match (class, channel) {
        (Class::Resistance, Channel::Longitudinal | Channel::Measurement) => (
            "resistance_along",
            "a force along the vehicle that the model lacks",
        ),
        (Class::Resistance, Channel::Lateral | Channel::Yaw) => (
            "resistance_aside",
            "a force across the vehicle, or a moment against its turning, that the model lacks",
        ),
        (Class::Weight, _) => ("weight", "another weight, or another place of it"),
        (Class::Gravity, _) => ("gravity", "gravity on a slope"),
        (Class::RollingRadius, _) => (
            "rolling_radius",
            "wheels that roll farther or less far in a turn",
        ),
        (Class::Ground, _) => ("ground", "ground that differs from place to place"),
        (Class::Sensor, _) => ("sensor", "what a sensor reports"),
    }
}
