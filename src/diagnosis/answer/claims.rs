//! The ladder of claims about the finding that a verdict is about: where it acts, which mechanism it is, by which
//! formula. Each has its own probability: what is safe to say of the direction may not be of the name.

use super::posterior::DOUBT;
use super::verdict::Judgement;
use super::words::{numbers, phrase};
use crate::diagnosis::outcome::{Claim, ClaimLevel, Finding, Subject};
use crate::diagnosis::screening::shape;
use crate::diagnosis::search::SearchResult;
use crate::effects::{CATALOGUE, Class};

/// The claims of a judgement, from the safest to the boldest; none without a leading finding.
///
/// # Algorithm
/// 1. *Where.* Names of one class, such as all that resist the motion, share their probability. What resists does so
///    along the vehicle or aside, whichever has the larger share of the wrench that the finding exerts: all of its
///    rivals explain the same misfit. *Unknown* physics counts as a resistance there, but for the constant share that it
///    has whatever the evidence.
/// 2. *Mechanism.* The probability of the finding's name.
/// 3. *Formula.* That times the probability of the catalogue's own formula against the neighbours of it
///    ([`crate::diagnosis::screening::shape`]), or against what mends it.
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
    let together: f64 = of_class
        .map(|(subject, probability)| match subject {
            Subject::Unknown => (probability - DOUBT).max(0.0),
            _ => *probability,
        })
        .sum();
    let (name, words) = words(class, exerts_along(searched, judged.effect));
    let mut claims = vec![Claim {
        level: ClaimLevel::Where,
        name,
        statement: words.into(),
        probability: together.max(finding.probability),
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
        Subject::Effect(effect) if CATALOGUE[effect].formulas_differ => {
            shape::exactness(searched.other_formulas())
        }
        _ => 1.0,
    };
    let numbers = numbers(finding);
    claims.push(Claim {
        level: ClaimLevel::Formula,
        name: finding.subject.name(),
        statement: format!("{numbers}, by the catalogue's formula"),
        probability: finding.probability * exact,
    });
    claims
}

/// Whether a finding's wrench, with what mends its formula, acts along the vehicle more than across and about it.
fn exerts_along(searched: &SearchResult, effect: Option<usize>) -> bool {
    let own = effect.map(|place| &searched.accepted[place]).into_iter();
    let mending = searched.accepted.iter().filter(|effect| effect.mends);
    let all = own
        .chain(mending)
        .flat_map(|effect| &effect.proposal.coefficients);
    let all: Vec<usize> = all.copied().collect();
    let [along, across, about] =
        shape::exerted(&searched.placed, &all, &searched.augmented.solution);
    along >= across + about
}

fn class(subject: Subject) -> Class {
    match subject {
        Subject::Effect(effect) => CATALOGUE[effect].class,
        Subject::Data => Class::Sensor,
        Subject::Unknown | Subject::Nothing => Class::Resistance,
    }
}

/// Name of a claim about a class, and the claim.
fn words(class: Class, along: bool) -> (&'static str, &'static str) {
    match (class, along) {
        (Class::Resistance, true) => (
            "resistance_along",
            "a force along the vehicle that the model lacks",
        ),
        (Class::Resistance, false) => (
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
