//! Wording that text and page share.

use crate::diagnosis::{
    Candidate, Channel, Diagnosis, Errors, Finding, HeldOut, Interval, Manoeuvre, Quantity,
    Subject, phrase,
};
use crate::effects::{CATALOGUE, ParameterDeclaration};
use crate::report::chart::Role;
use crate::report::number::{percent, shown, with_interval, with_unit};

/// A subject in plain words, with its name in `diagnosis.json`.
pub fn named(subject: Subject) -> String {
    match subject {
        Subject::Nothing => "nothing missing".into(),
        Subject::Unknown => "physics outside the catalogue (unknown)".into(),
        Subject::Data => "data that are not what they claim (doubtful_data)".into(),
        Subject::Effect(_) => phrase(subject),
    }
}

/// A quantity of a subject in plain words, with its name: "force D (force)".
pub fn plain(subject: Subject, name: &str) -> String {
    match declared(subject, name) {
        Some(declared) => format!("{} ({name})", first_words(declared.description)),
        None => name.into(),
    }
}

/// The beginning of a description, for the middle of a sentence.
fn first_words(description: &str) -> String {
    let words = description
        .split([',', ';', ':', '('])
        .next()
        .unwrap_or_default();
    let mut letters = words.trim().chars();
    let first = letters.next().map(|letter| letter.to_ascii_lowercase());
    first.into_iter().chain(letters).collect()
}

/// A channel of a recording in plain words, with its name.
pub fn signal(channel: &str) -> String {
    let words = match channel {
        "x" => "position east",
        "y" => "position north",
        "v_x" => "forward speed",
        "v_y" => "speed to the left",
        "yaw_rate" => "yaw rate",
        _ => return channel.into(),
    };
    format!("{words} ({channel})")
}

/// The purpose of a manoeuvre.
pub fn purpose(next: &Manoeuvre) -> String {
    match next.separates {
        [Subject::Unknown, Subject::Nothing] => {
            "reveal half of the effects that these recordings hide".into()
        }
        separates => {
            let [one, other] = separates.map(named);
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
    let name = named(finding.subject);
    if diagnosis.findings.len() > 1 {
        format!("{name}, {}", percent(finding.probability))
    } else {
        name
    }
}

/// Whether the headline does not name this finding, or not it alone.
pub fn needs_title(finding: &Finding, diagnosis: &Diagnosis) -> bool {
    let is_alone = diagnosis.findings.len() == 1 && diagnosis.leading.is_some();
    !is_alone || !finding.ambiguous_with.is_empty()
}

/// All values of a finding, each with its name in plain words.
pub fn values(finding: &Finding, diagnosis: &Diagnosis) -> Vec<String> {
    let each = finding.parameters.iter();
    let each = each.map(|found| {
        let short = parameter(found, diagnosis);
        let name = match declared(finding.subject, &found.name) {
            Some(declared) => format!("{} ({short})", first_words(declared.description)),
            None => short,
        };
        format!("{name} {}", value(found))
    });
    each.collect()
}

/// The terms that mend the formula of a finding.
pub fn mending(finding: &Finding) -> String {
    let each = finding.mended_by.iter();
    let each = each.map(|term| format!("{} {}", term.parameter, value(&term.coefficient)));
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
pub fn models(held_out: &HeldOut, diagnosis: &Diagnosis) -> Vec<(Role, Errors)> {
    let errors = [held_out.nominal, held_out.refitted, held_out.augmented];
    roles(diagnosis).zip(errors).collect()
}

/// The compared models: the mended one only if it differs.
pub fn roles(diagnosis: &Diagnosis) -> impl Iterator<Item = Role> {
    let count = if has_model(diagnosis) { 3 } else { 2 };
    [Role::Given, Role::Refitted, Role::Mended]
        .into_iter()
        .take(count)
}

/// The name of a model in words.
pub fn role(role: Role) -> &'static str {
    match role {
        Role::Given => "as given",
        other => other.name(),
    }
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
            .map(|(model, errors)| format!("{} {}", with_unit(of(errors), unit), role(*model)));
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

/// Maximum number of detectable effects beside the verdict; the table of candidates has all.
pub const MAX_SIZES: usize = 8;

/// The first of many, and how many more there are, and where.
pub fn first(all: &[String], max: usize, place: &str) -> Vec<String> {
    let more = all.len().saturating_sub(max);
    let more = (more > 0).then(|| format!("{more} more{place}"));
    all.iter().take(max).cloned().chain(more).collect()
}

/// Effects that these recordings would have shown, with the smallest size; and those that they cannot show. A candidate
/// that was not screened is in neither list.
pub fn detectable(diagnosis: &Diagnosis) -> (Vec<String>, Vec<String>) {
    let (mut shown, mut hidden) = (Vec::new(), Vec::new());
    let candidates = diagnosis.candidates.iter();
    for candidate in candidates.filter(|c| matches!(c.subject, Subject::Effect(_))) {
        let name = named(candidate.subject);
        match candidate.smallest_detectable {
            smallest if smallest.is_nan() => {}
            smallest if smallest.is_finite() => {
                let size = self::smallest(candidate);
                let name = name.trim_end_matches(')');
                shown.push(format!("{name}.{}) {size}", candidate.parameter));
            }
            _ => hidden.push(name),
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
            Some((_, cosine)) => format!("{}, cosine {cosine:.2}", named(*other)),
            None => named(*other),
        }
    });
    others.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_others_are_counted() {
        let all = ["a", "b", "c"].map(String::from);
        assert_eq!(first(&all, 2, " below"), ["a", "b", "1 more below"]);
        assert_eq!(first(&all, 3, ""), ["a", "b", "c"]);
    }

    #[test]
    fn lists_read_as_in_a_sentence() {
        let names = ["a", "b", "c"].map(String::from);
        assert_eq!(list(&names, "or"), "a, b or c");
        assert_eq!(list(&names[..2], "and"), "a and b");
        assert_eq!(list(&names[..1], "and"), "a");
        assert_eq!(list(&[], "and"), "");
    }
}
