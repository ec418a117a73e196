//! What the verdict claims, and with which probability.

use super::words::{list, named};
use crate::diagnosis::{
    Candidate, Caution, ClaimLevel, Diagnosis, Finding, Insufficient, Subject, Verdict, phrase,
};
use crate::inspection::Doubt;
use crate::report::number::percent;

/// What limits the verdict, except for what the headline states.
pub fn cautions(diagnosis: &Diagnosis) -> impl Iterator<Item = String> {
    let in_headline = diagnosis.insufficient == Some(Insufficient::TimeUp);
    let cautions = diagnosis.cautions.iter();
    let others = cautions.filter(move |caution| !in_headline || **caution != Caution::TimeUp);
    others.map(Caution::text)
}

/// The claims about the first finding with their probabilities, the safest first. The headline has the mechanism, and
/// the size stands below.
pub fn ladder(diagnosis: &Diagnosis) -> impl Iterator<Item = String> {
    let claims = diagnosis.claims.iter();
    claims.map(|claim| {
        let what = match claim.level {
            ClaimLevel::Where => &claim.statement,
            ClaimLevel::Mechanism => "this mechanism",
            ClaimLevel::Formula => "this size, by the catalogue's formula",
        };
        format!("{}: {what}", percent(claim.probability))
    })
}

/// The statement, where it has more than the headline, the probability, the size and the place.
pub fn reason(diagnosis: &Diagnosis) -> &str {
    let is_known = diagnosis.leading.is_some()
        || diagnosis.verdict == Verdict::NothingMissing
        || diagnosis.insufficient == Some(Insufficient::Undecided);
    if is_known { "" } else { &diagnosis.statement }
}

/// The doubt that the verdict is about.
fn doubt(diagnosis: &Diagnosis) -> Option<&Doubt> {
    if diagnosis.verdict != Verdict::Sensor || diagnosis.leading.is_some() {
        return None;
    }
    diagnosis.cautions.iter().find_map(|caution| match caution {
        Caution::DoubtfulData { doubt, .. } if !doubt.is_left_out() => Some(doubt),
        _ => None,
    })
}

/// The verdict in plain words: one for the terminal, the page and `diagnosis.json`. It does not hide that data were left
/// out or doubted.
#[must_use]
pub fn headline(diagnosis: &Diagnosis) -> String {
    match doubt(diagnosis) {
        Some(doubt) => format!("The data, before any physics: {}", doubt.evidence),
        None => verdict(diagnosis) + &reservations(diagnosis),
    }
}

/// What the headline adds to the verdict: samples that are left out, and the likeliest doubt about the others.
fn reservations(diagnosis: &Diagnosis) -> String {
    let doubts = diagnosis
        .cautions
        .iter()
        .filter_map(|caution| match caution {
            Caution::DoubtfulData { doubt, .. } if doubt.is_left_out() => Some(doubt),
            _ => None,
        });
    let mut channels: Vec<String> = Vec::new();
    for channel in doubts.flat_map(|doubt| &doubt.channels) {
        let name = channel.to_string();
        if !channels.contains(&name) {
            channels.push(name);
        }
    }
    let mut text = String::new();
    if !channels.is_empty() {
        let channels = list(&channels, "and");
        text += &format!("; faulty samples of {channels} are left out");
    }
    if let Some(doubt) = diagnosis.minor_doubts.first() {
        let percent = percent(doubt.probability);
        text += &format!(
            "; {percent} that the data are wrong ({})",
            doubt.kind.name()
        );
    }
    text
}

/// The verdict alone.
fn verdict(diagnosis: &Diagnosis) -> String {
    let findings = &diagnosis.findings[..];
    let leading = diagnosis.leading.and_then(|k| findings.get(k));
    match (diagnosis.verdict, leading) {
        (Verdict::NothingMissing, _) => {
            "Nothing is missing: the refitted model explains the recordings".into()
        }
        (Verdict::InsufficientData, _) => match diagnosis.insufficient {
            Some(Insufficient::TimeUp) => "The time limit was reached before a verdict".into(),
            Some(Insufficient::Undecided) => {
                "These recordings do not decide whether something is missing".into()
            }
            _ => "These recordings are not sufficient for a verdict".into(),
        },
        (Verdict::Ambiguous, Some(set)) => {
            let all = || std::iter::once(&set.subject).chain(&set.ambiguous_with);
            let names: Vec<String> = all().map(|subject| named(*subject)).collect();
            let what = if all().any(|subject| subject.is_sensor()) {
                "The model lacks, or the sensors add, one of"
            } else {
                "The model lacks"
            };
            format!(
                "{what} {}: these recordings cannot separate them",
                list(&names, "or")
            )
        }
        (Verdict::Sensor, Some(_)) => {
            format!(
                "The sensors, not the soil: {}",
                phrases(findings, Subject::is_sensor)
            )
        }
        (_, None) => "Something is missing: these recordings do not show what".into(),
        _ => lacking(findings),
    }
}

/// The findings of a kind, each once; "perhaps" marks what is less likely than not.
fn phrases(findings: &[Finding], of: fn(Subject) -> bool) -> String {
    let mut phrases: Vec<String> = Vec::new();
    for finding in findings.iter().filter(|finding| of(finding.subject)) {
        let phrase = phrase(finding.subject);
        let phrase = if finding.probability < 0.5 {
            format!("perhaps {phrase}")
        } else {
            phrase
        };
        if !phrases.contains(&phrase) {
            phrases.push(phrase);
        }
    }
    list(&phrases, "and")
}

/// What the model lacks, and what the sensors add.
fn lacking(findings: &[Finding]) -> String {
    let phrases = |of: fn(Subject) -> bool| phrases(findings, of);
    let named = phrases(|subject| subject != Subject::Unknown && !subject.is_sensor());
    let sensors = phrases(Subject::is_sensor);
    let unknown = phrases(|subject| subject == Subject::Unknown);
    let physics = match (&named[..], &unknown[..]) {
        ("", unknown) => format!("The model lacks {unknown}"),
        (named, "") => format!("The model lacks {named}"),
        (named, unknown) => format!("The model lacks {named}, and {unknown}"),
    };
    if sensors.is_empty() {
        physics
    } else {
        format!("{physics}; the recording has {sensors}")
    }
}

/// The probability of the finding and of the runner-up. Empty for several findings: each states its probability.
pub fn probability(diagnosis: &Diagnosis) -> String {
    let judged = matches!(diagnosis.insufficient, None | Some(Insufficient::Undecided));
    if let Some(doubt) = doubt(diagnosis) {
        let others = diagnosis.candidates.iter();
        let others = others.filter(|other| other.subject != Subject::Data);
        let next = others.max_by(|a, b| a.probability.total_cmp(&b.probability));
        let next = next.map_or(String::new(), |next| {
            format!(
                ", next {} {}",
                named(next.subject),
                percent(next.probability)
            )
        });
        return format!(
            "{} that the data are wrong{next}",
            percent(doubt.probability)
        );
    }
    if diagnosis.account.segments == 0 || !judged {
        return String::new();
    }
    if let Some(joint) = joint_probability(diagnosis) {
        return joint;
    }
    if diagnosis.findings.len() > 1 {
        return String::new();
    }
    let found = diagnosis.findings.iter().map(|f| percent(f.probability));
    let mut probabilities: Vec<String> = found.collect();
    let nothing = candidate(diagnosis, Subject::Nothing).map(|c| percent(c.probability));
    match diagnosis.verdict {
        Verdict::NothingMissing => probabilities.extend(nothing),
        Verdict::InsufficientData if probabilities.is_empty() => {
            probabilities.extend(nothing.map(|nothing| format!("nothing missing {nothing}")));
        }
        _ => {}
    }
    let found = |subject: Subject| {
        let is_found = diagnosis.findings.iter().any(|f| f.subject == subject);
        is_found || (diagnosis.findings.is_empty() && subject == Subject::Nothing)
    };
    let others = diagnosis.candidates.iter().filter(|c| !found(c.subject));
    let next = others
        .filter(|candidate| candidate.probability >= 0.005)
        .max_by(|a, b| a.probability.total_cmp(&b.probability));
    if let Some(next) = next {
        probabilities.push(format!(
            "next {} {}",
            named(next.subject),
            percent(next.probability)
        ));
    }
    probabilities.join(", ")
}

fn candidate(diagnosis: &Diagnosis, subject: Subject) -> Option<&Candidate> {
    diagnosis.candidates.iter().find(|c| c.subject == subject)
}

/// The probability of an ambiguous set, and of each of its subjects.
fn joint_probability(diagnosis: &Diagnosis) -> Option<String> {
    let [finding] = &diagnosis.findings[..] else {
        return None;
    };
    if finding.ambiguous_with.is_empty() {
        return None;
    }
    let others = finding.ambiguous_with.iter().filter_map(|other| {
        let probability = candidate(diagnosis, *other)?.probability;
        Some((*other, probability))
    });
    let all: Vec<(Subject, f64)> = std::iter::once((finding.subject, finding.probability))
        .chain(others)
        .collect();
    let sum: f64 = all.iter().map(|(_, probability)| probability).sum();
    let each = all
        .iter()
        .map(|(subject, probability)| format!("{} {}", named(*subject), percent(*probability)));
    Some(format!(
        "{} for one of these: {}",
        percent(sum),
        each.collect::<Vec<_>>().join(", ")
    ))
}
