//! What the verdict claims, and how sure it is.

use super::words::{list, name};
use crate::diagnosis::{Caution, Diagnosis, Finding, Insufficient, Subject, Verdict, phrase};
use crate::report::number::percent;

/// What limits the verdict, but for what the headline says.
pub fn cautions(diagnosis: &Diagnosis) -> impl Iterator<Item = String> {
    let said = diagnosis.insufficient == Some(Insufficient::TimeUp);
    let cautions = diagnosis.cautions.iter();
    let unsaid = cautions.filter(move |caution| !said || **caution != Caution::TimeUp);
    unsaid.map(Caution::text)
}

/// The verdict in plain words.
pub fn headline(diagnosis: &Diagnosis) -> String {
    let findings = &diagnosis.findings[..];
    let leading = diagnosis.leading.and_then(|k| findings.get(k));
    match (diagnosis.verdict, leading) {
        (Verdict::NothingMissing, _) => {
            "Nothing is missing: the re-tuned model explains the recordings".into()
        }
        (Verdict::InsufficientData, _) => match diagnosis.insufficient {
            Some(Insufficient::TimeUp) => "Time was up before there was a verdict".into(),
            Some(Insufficient::Undecided) => {
                "These recordings do not decide whether something is missing".into()
            }
            _ => "These recordings are too little to tell".into(),
        },
        (Verdict::Ambiguous, Some(set)) => {
            let all = || std::iter::once(&set.subject).chain(&set.ambiguous_with);
            let names: Vec<String> = all().map(|s| name(*s).to_owned()).collect();
            let what = if all().any(|subject| subject.is_sensor()) {
                "The model lacks, or the sensors add, one of"
            } else {
                "The model lacks"
            };
            format!(
                "{what} {}: these recordings do not tell which",
                list(&names, "or")
            )
        }
        (Verdict::Sensor, Some(_)) => {
            format!(
                "The sensors, not the soil: {}",
                phrases(findings, Subject::is_sensor)
            )
        }
        (_, None) => "Something is missing: these recordings do not tell what".into(),
        _ => lacking(findings),
    }
}

/// What was found of a sort, each thing once; what is less likely than not with a word of doubt.
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

/// How sure: the finding's probability and the runner-up's. Of several findings each is told with its own.
pub fn sureness(diagnosis: &Diagnosis) -> String {
    let asked = matches!(diagnosis.insufficient, None | Some(Insufficient::Undecided));
    if diagnosis.account.segments == 0 || !asked {
        return String::new();
    }
    if let Some(together) = together(diagnosis) {
        return together;
    }
    if diagnosis.findings.len() > 1 {
        return String::new();
    }
    let told = diagnosis.findings.iter().map(|f| percent(f.probability));
    let mut told: Vec<String> = told.collect();
    let asked = |subject: Subject| diagnosis.candidates.iter().find(|c| c.subject == subject);
    let nothing = asked(Subject::Nothing).map(|nothing| percent(nothing.probability));
    match diagnosis.verdict {
        Verdict::NothingMissing => told.extend(nothing),
        Verdict::InsufficientData if told.is_empty() => {
            told.extend(nothing.map(|nothing| format!("nothing missing {nothing}")));
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
        told.push(format!(
            "next {} {}",
            name(next.subject),
            percent(next.probability)
        ));
    }
    told.join(", ")
}

/// How sure it is that it is one of a set, and which.
fn together(diagnosis: &Diagnosis) -> Option<String> {
    let [finding] = &diagnosis.findings[..] else {
        return None;
    };
    if finding.ambiguous_with.is_empty() {
        return None;
    }
    let others = finding.ambiguous_with.iter().filter_map(|other| {
        let asked = diagnosis.candidates.iter().find(|c| c.subject == *other)?;
        Some((*other, asked.probability))
    });
    let all: Vec<(Subject, f64)> = [(finding.subject, finding.probability)]
        .into_iter()
        .chain(others)
        .collect();
    let sum: f64 = all.iter().map(|(_, probability)| probability).sum();
    let each = all
        .iter()
        .map(|(subject, probability)| format!("{} {}", name(*subject), percent(*probability)));
    Some(format!(
        "{} that it is one of these: {}",
        percent(sum),
        each.collect::<Vec<_>>().join(", ")
    ))
}
