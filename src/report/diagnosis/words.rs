//! What text and page say alike.

use crate::diagnosis::{
    Channel, Diagnosis, Errors, Finding, HeldOut, Interval, Manoeuvre, Quantity, Subject, Verdict,
};
use crate::effects::{CATALOGUE, ParameterDeclaration};
use crate::report::number::{percent, shown, with_interval, with_unit};

/// Names that say less than they should.
const PHRASES: [(&str, &str); 21] = [
    ("grade", "sloping ground"),
    ("terrain_change", "a change of soil on the way"),
    ("left_right_soil", "different soil left and right"),
    ("bulldozing", "soil pushed ahead and aside by the wheels"),
    ("slip_sinkage", "wheels that dig in as they slip"),
    ("multipass", "rear wheels in the front wheels' rut"),
    ("elastic_rebound", "soil that springs back behind the wheel"),
    ("stress_peak", "pressure that peaks elsewhere"),
    ("tyre_compliance", "tyres that flatten"),
    (
        "shear_anisotropy",
        "soil that shears differently along and across the wheel",
    ),
    ("transient_shear", "shear that builds up over a distance"),
    (
        "rate_dependent_soil",
        "soil that resists in proportion to the speed",
    ),
    ("drag", "drag that grows with the square of the speed"),
    ("drawbar", "a towed load"),
    ("payload", "an added load"),
    ("com_shift", "a shifted centre of mass"),
    ("wheel_radius", "wheels of another radius"),
    ("latency", "sensors that trail each other"),
    ("lever_arm", "an antenna off the reference point"),
    ("yaw_rate_bias", "a gyro that is off at rest"),
    ("heading_offset", "a heading that is turned"),
];

/// The name of a subject as in `diagnosis.json`, in words where it is none of the catalogue's.
pub fn name(subject: Subject) -> &'static str {
    match subject {
        Subject::Nothing => "nothing missing",
        _ => subject.name(),
    }
}

/// A subject in plain words, with its name.
pub fn phrase(subject: Subject) -> String {
    let name = match subject {
        Subject::Unknown => "something that the catalogue does not have",
        _ => name(subject),
    };
    let found = PHRASES.iter().find(|(known, _)| *known == name);
    found.map_or_else(|| name.into(), |(_, words)| format!("{words} ({name})"))
}

/// What a manoeuvre is for.
pub fn purpose(next: &Manoeuvre) -> String {
    match next.separates {
        [Subject::Unknown, Subject::Nothing] => {
            "show half of the effects that these recordings hide".into()
        }
        separates => {
            let [one, other] = separates.map(name);
            format!("part {one} from {other}")
        }
    }
}

/// Names in a row: "a, b and c".
pub fn list(names: &[String], last: &str) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [some @ .., end] => format!("{} {last} {end}", some.join(", ")),
    }
}

/// The verdict in plain words.
pub fn headline(diagnosis: &Diagnosis) -> String {
    let phrases = |findings: &[Finding]| {
        let phrases: Vec<String> = findings.iter().map(|f| phrase(f.subject)).collect();
        list(&phrases, "and")
    };
    let findings = &diagnosis.findings[..];
    match (diagnosis.verdict, findings) {
        (Verdict::NothingMissing, _) => {
            "Nothing is missing: the re-tuned model explains the recordings".into()
        }
        (Verdict::InsufficientData, _) => "These recordings are too little to tell".into(),
        (Verdict::UnknownPhysics, _) => {
            let named: Vec<Finding> = findings
                .iter()
                .filter(|finding| finding.subject != Subject::Unknown)
                .cloned()
                .collect();
            match phrases(&named) {
                also if also.is_empty() => {
                    "Something is missing that the catalogue does not have".into()
                }
                also => format!(
                    "The model lacks {also}, and something that the catalogue does not have"
                ),
            }
        }
        (Verdict::Ambiguous, [first, ..]) => {
            let mut names = vec![name(first.subject).to_owned()];
            names.extend(first.ambiguous_with.iter().map(|s| name(*s).to_owned()));
            format!(
                "The model lacks {}: these recordings do not tell which",
                list(&names, "or")
            )
        }
        (Verdict::Sensor, [_, ..]) => {
            format!("The sensors, not the soil: {}", phrases(findings))
        }
        (Verdict::MissingPhysics, [_, ..]) => format!("The model lacks {}", phrases(findings)),
        (Verdict::Ambiguous, []) => {
            "The model lacks something: these recordings do not tell what".into()
        }
        (Verdict::Sensor, []) => "The sensors are at fault, not the soil".into(),
        (Verdict::MissingPhysics, []) => "The model lacks something".into(),
    }
}

/// How sure: the findings' probabilities and the runner-up's.
pub fn sureness(diagnosis: &Diagnosis) -> String {
    if diagnosis.account.segments == 0 {
        // Nothing was asked.
        return String::new();
    }
    if let Some(together) = together(diagnosis) {
        return together;
    }
    let several = diagnosis.findings.len() > 1;
    let told = diagnosis.findings.iter().map(|finding| {
        if several {
            format!("{} {}", name(finding.subject), percent(finding.probability))
        } else {
            percent(finding.probability)
        }
    });
    let mut told: Vec<String> = told.collect();
    let asked = |subject: Subject| diagnosis.candidates.iter().find(|c| c.subject == subject);
    if told.is_empty() && diagnosis.verdict == Verdict::NothingMissing {
        told.extend(asked(Subject::Nothing).map(|nothing| percent(nothing.probability)));
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

/// A value with its interval and unit: "1.78 deg (1.55 .. 2.01)".
pub fn value(quantity: &Quantity) -> String {
    let (factor, unit) = shown(quantity.unit);
    let [value, low, high] = [quantity.value, quantity.low, quantity.high].map(|v| v * factor);
    let [value, low, high] = with_interval(value, low, high);
    let space = if unit.is_empty() { "" } else { " " };
    format!("{value}{space}{unit} ({low} .. {high})")
}

/// Whose parameter it is, and its name.
pub fn parameter(quantity: &Quantity, diagnosis: &Diagnosis) -> String {
    match &quantity.recording {
        Some(recording) if diagnosis.recordings.len() > 1 => {
            format!("{recording}.{}", quantity.name)
        }
        _ => quantity.name.clone(),
    }
}

/// What the catalogue says of a parameter.
pub fn declared(subject: Subject, name: &str) -> Option<&'static ParameterDeclaration> {
    let Subject::Effect(index) = subject else {
        return None;
    };
    CATALOGUE[index].parameters.iter().find(|p| p.name == name)
}

/// A recording and its run, which is told where there are several.
pub fn run(recording: &str, run: usize, diagnosis: &Diagnosis) -> String {
    let several = diagnosis
        .runs
        .iter()
        .any(|trace| trace.recording == recording && trace.run != run);
    if several || run > 0 {
        format!("{recording} run {run}")
    } else {
        recording.into()
    }
}

/// A channel in words.
pub fn channel(channel: Channel) -> &'static str {
    match channel {
        Channel::Longitudinal => "force along the vehicle",
        Channel::Lateral => "force across the vehicle",
        Channel::Yaw => "turning moment",
        Channel::Measurement => "measurement",
    }
}

/// A place: recording, seconds, patch, channel and regime.
pub fn place(place: &Interval, diagnosis: &Diagnosis) -> String {
    let mut text = format!(
        "{}, {:.1} .. {:.1} s",
        run(&place.recording, place.run, diagnosis),
        place.start,
        place.end
    );
    if let Some([east, north, radius]) = place.patch {
        text += &format!(", within {radius:.1} m of {east:.1} m east, {north:.1} m north");
    }
    text += &format!(", {}", channel(place.channel));
    if !place.regime.is_empty() {
        text += &format!(", {}", place.regime);
    }
    text
}

/// The models of a comparison with their names; the last only where something was found.
pub fn models(held_out: &HeldOut, diagnosis: &Diagnosis) -> Vec<(&'static str, Errors)> {
    let mut models = vec![
        ("as given", held_out.nominal),
        ("re-tuned", held_out.retuned),
    ];
    if !diagnosis.findings.is_empty() {
        models.push(("with what was found", held_out.augmented));
    }
    models
}

/// What a measure of errors is of a model.
pub type Measure = (&'static str, &'static str, fn(&Errors) -> f64);

/// What models are compared by: name, unit, and which of the errors it is.
pub const MEASURES: [Measure; 3] = [
    ("position", "m", |errors| errors.position),
    ("heading", "rad", |errors| errors.heading),
    ("yaw rate", "rad/s", |errors| errors.yaw_rate),
];

/// How much better: "position 0.41 m as given, 0.30 m re-tuned, 0.05 m with what was found".
pub fn improvement(held_out: &HeldOut, diagnosis: &Diagnosis) -> String {
    let models = models(held_out, diagnosis);
    let told = MEASURES.iter().filter_map(|(name, unit, of)| {
        if !of(&held_out.retuned).is_finite() {
            return None;
        }
        let values = models
            .iter()
            .map(|(model, errors)| format!("{} {model}", with_unit(of(errors), unit)));
        Some(format!("{name} {}", values.collect::<Vec<_>>().join(", ")))
    });
    // Where a pose was recorded, the gyro adds nothing that a reader in haste needs.
    told.take(2).collect::<Vec<_>>().join("; ")
}

/// Which effects would have shown, from which size on; and those that would not.
pub fn detectable(diagnosis: &Diagnosis) -> (Vec<String>, Vec<String>) {
    let (mut shown, mut hidden) = (Vec::new(), Vec::new());
    for candidate in &diagnosis.candidates {
        if !matches!(candidate.subject, Subject::Effect(_)) {
            continue;
        }
        let name = name(candidate.subject);
        if candidate.smallest_detectable.is_finite() {
            let size = with_unit(candidate.smallest_detectable, candidate.unit);
            shown.push(format!("{name} ({} {size})", candidate.parameter));
        } else {
            hidden.push(name.to_owned());
        }
    }
    (shown, hidden)
}

/// What may be confused with a finding, with the cosine where it is known.
pub fn alike(finding: &Finding, diagnosis: &Diagnosis) -> Vec<String> {
    let candidate = diagnosis
        .candidates
        .iter()
        .find(|candidate| candidate.subject == finding.subject);
    let cosines = candidate.map_or(&[][..], |candidate| &candidate.alike);
    let told = finding.ambiguous_with.iter().map(|other| {
        match cosines.iter().find(|(subject, _)| subject == other) {
            Some((_, cosine)) => format!("{} (cosine {cosine:.2})", name(*other)),
            None => name(*other).to_owned(),
        }
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_phrase_is_of_an_effect() {
        for (name, phrase) in PHRASES {
            assert!(CATALOGUE.iter().any(|effect| effect.name == name), "{name}");
            assert!(!phrase.is_empty());
        }
    }

    #[test]
    fn lists_read_as_sentences() {
        let names = ["a", "b", "c"].map(String::from);
        assert_eq!(list(&names, "or"), "a, b or c");
        assert_eq!(list(&names[..2], "and"), "a and b");
        assert_eq!(list(&names[..1], "and"), "a");
        assert_eq!(list(&[], "and"), "");
    }
}
