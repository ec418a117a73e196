//! Wording that text and page share.

use crate::diagnosis::{
    Candidate, Channel, Diagnosis, Errors, Finding, HeldOut, Interval, Manoeuvre, Quantity, Subject,
};
use crate::effects::{CATALOGUE, ParameterDeclaration};
use crate::report::number::{percent, shown, with_interval, with_unit};

/// The name of a subject as in `diagnosis.json`, in words for the model without additions.
pub fn name(subject: Subject) -> &'static str {
    match subject {
        Subject::Nothing => "nothing missing",
        _ => subject.name(),
    }
}

/// The purpose of a manoeuvre.
pub fn purpose(next: &Manoeuvre) -> String {
    match next.separates {
        [Subject::Unknown, Subject::Nothing] => {
            "reveal half of the effects that these recordings hide".into()
        }
        separates => {
            let [one, other] = separates.map(name);
            format!("separate {one} from {other}")
        }
    }
}

/// How to drive next, and what that is expected to show. Less than two deviations decide little.
pub fn drive_next(next: &Manoeuvre) -> String {
    let weak = if next.separation < 2.0 {
        ", too little to decide"
    } else {
        ""
    };
    format!(
        "{}: {} Expected to {} by {:.1} standard deviations{weak}.",
        next.name.replace('_', " "),
        next.description,
        purpose(next),
        next.separation
    )
}

/// Names in a sentence: "a, b and c".
pub fn list(names: &[String], last: &str) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [some @ .., end] => format!("{} {last} {end}", some.join(", ")),
    }
}

/// A value with its interval and unit: "1.78 deg (1.55 .. 2.01)".
pub fn value(quantity: &Quantity) -> String {
    let (factor, unit) = shown(quantity.unit);
    let [value, low, high] = [quantity.value, quantity.low, quantity.high].map(|v| v * factor);
    let [value, low, high] = with_interval(value, low, high);
    let space = if unit.is_empty() { "" } else { " " };
    format!("{value}{space}{unit} ({low} .. {high})")
}

/// A finding's name, with its probability if there are several findings.
pub fn title(finding: &Finding, diagnosis: &Diagnosis) -> String {
    let name = name(finding.subject);
    if diagnosis.findings.len() > 1 {
        format!("{name}, {}", percent(finding.probability))
    } else {
        name.into()
    }
}

/// All values of a finding.
pub fn values(finding: &Finding, diagnosis: &Diagnosis) -> String {
    let each = finding.parameters.iter();
    let each = each.map(|found| format!("{} {}", parameter(found, diagnosis), value(found)));
    each.collect::<Vec<_>>().join(", ")
}

/// A parameter's name, with its recording if there are several.
pub fn parameter(quantity: &Quantity, diagnosis: &Diagnosis) -> String {
    match &quantity.recording {
        Some(recording) if diagnosis.recordings.len() > 1 => {
            format!("{recording}.{}", quantity.name)
        }
        _ => quantity.name.clone(),
    }
}

/// The catalogue's declaration of a parameter.
pub fn declared(subject: Subject, name: &str) -> Option<&'static ParameterDeclaration> {
    let Subject::Effect(index) = subject else {
        return None;
    };
    CATALOGUE[index].parameters.iter().find(|p| p.name == name)
}

/// A recording and its run, which has a label if there are several.
pub fn run(recording: &str, label: &str) -> String {
    if label.is_empty() {
        recording.into()
    } else {
        format!("{recording} run {label}")
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
pub fn place(place: &Interval) -> String {
    let mut text = format!(
        "{}, {:.1} .. {:.1} s",
        run(&place.recording, &place.label),
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

/// Whether the mended model differs from the refitted one: it cannot have a latent wrench.
pub fn has_model(diagnosis: &Diagnosis) -> bool {
    let findings = &diagnosis.findings;
    findings.iter().any(|found| !found.parameters.is_empty())
}

/// The models of a comparison with their names; the mended one only if it differs.
pub fn models(held_out: &HeldOut, diagnosis: &Diagnosis) -> Vec<(&'static str, Errors)> {
    let mut models = vec![
        ("as given", held_out.nominal),
        ("refitted", held_out.refitted),
    ];
    if has_model(diagnosis) {
        models.push(("mended", held_out.augmented));
    }
    models
}

/// Name, unit and value of an error measure.
pub type Measure = (&'static str, &'static str, fn(&Errors) -> f64);

/// The error measures by which models are compared.
pub const MEASURES: [Measure; 3] = [
    ("position", "m", |errors| errors.position),
    ("heading", "rad", |errors| errors.heading),
    ("yaw rate", "rad/s", |errors| errors.yaw_rate),
];

/// The errors of all models: "position 0.41 m as given, 0.30 m refitted, 0.05 m mended".
pub fn improvement(held_out: &HeldOut, diagnosis: &Diagnosis) -> String {
    let models = models(held_out, diagnosis);
    let lines = MEASURES.iter().filter_map(|(name, unit, of)| {
        if !of(&held_out.refitted).is_finite() {
            return None;
        }
        let values = models
            .iter()
            .map(|(model, errors)| format!("{} {model}", with_unit(of(errors), unit)));
        Some(format!("{name} {}", values.collect::<Vec<_>>().join(", ")))
    });
    // Beside a pose the yaw rate adds little.
    lines.take(2).collect::<Vec<_>>().join("; ")
}

/// A candidate's smallest detectable size, as a distance from the value at which the effect is off.
pub fn smallest(candidate: &Candidate) -> String {
    let size = with_unit(candidate.smallest_detectable, candidate.unit);
    let off = declared(candidate.subject, candidate.parameter).map_or(0.0, |p| p.default);
    if off == 0.0 {
        size
    } else {
        format!("{size} from {}", with_unit(off, candidate.unit))
    }
}

/// Effects that these recordings would have shown, with the smallest size; and those that they cannot show. A candidate
/// that was not screened is in neither list.
pub fn detectable(diagnosis: &Diagnosis) -> (Vec<String>, Vec<String>) {
    let (mut shown, mut hidden) = (Vec::new(), Vec::new());
    let candidates = diagnosis.candidates.iter();
    for candidate in candidates.filter(|c| matches!(c.subject, Subject::Effect(_))) {
        let name = name(candidate.subject);
        match candidate.smallest_detectable {
            smallest if smallest.is_nan() => {}
            smallest if smallest.is_finite() => {
                let size = self::smallest(candidate);
                shown.push(format!("{name} ({} {size})", candidate.parameter));
            }
            _ => hidden.push(name.to_owned()),
        }
    }
    (shown, hidden)
}

/// What may be confused with a finding, with the cosine if it is known.
pub fn alike(finding: &Finding, diagnosis: &Diagnosis) -> Vec<String> {
    let candidate = diagnosis
        .candidates
        .iter()
        .find(|candidate| candidate.subject == finding.subject);
    let cosines = candidate.map_or(&[][..], |candidate| &candidate.alike);
    let others = finding.ambiguous_with.iter().map(|other| {
        match cosines.iter().find(|(subject, _)| subject == other) {
            Some((_, cosine)) => format!("{} (cosine {cosine:.2})", name(*other)),
            None => name(*other).to_owned(),
        }
    });
    others.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_read_as_in_a_sentence() {
        let names = ["a", "b", "c"].map(String::from);
        assert_eq!(list(&names, "or"), "a, b or c");
        assert_eq!(list(&names[..2], "and"), "a and b");
        assert_eq!(list(&names[..1], "and"), "a");
        assert_eq!(list(&[], "and"), "");
    }
}
