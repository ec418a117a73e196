//! Wording that text, JSON and page share.

use crate::inspection::{Delay, Doubt, Inspection, Noise, Quality};
use crate::recording::{Note, Recording};
use crate::report::number::{digits, percent};

/// Whether the recording can be diagnosed, and why not.
pub fn fitness(inspection: &Inspection) -> String {
    let (fitness, why) = &inspection.fitness;
    format!("Fit for diagnosis: {}, because {why}.", fitness.name())
}

/// A doubt with its probability and remedy.
pub fn doubt(doubt: &Doubt) -> String {
    format!("doubt ({}): {doubt}", percent(doubt.probability))
}

/// Words of the kind of a note.
pub fn kind(note: &Note) -> &'static str {
    if note.kind.is_warning() {
        "warning"
    } else {
        "note"
    }
}

/// "3 runs".
pub fn runs(recording: &Recording) -> String {
    match recording.runs.len() {
        1 => "1 run".into(),
        count => format!("{count} runs"),
    }
}

/// A noise in two digits. "held" where over half of the values lie on the line between their neighbours: they are repeated
/// or coarsely quantised, and have no measurable noise.
pub fn noise(noise: Option<Noise>, with_interval: bool) -> String {
    match noise {
        None => "-".into(),
        Some(noise) if noise.deviation.value == 0.0 => "held".into(),
        Some(Noise { deviation, .. }) => {
            let [value, low, high] =
                [deviation.value, deviation.low, deviation.high].map(|value| digits(value, 2));
            if with_interval {
                format!("{value} ({low} .. {high})")
            } else {
                value
            }
        }
    }
}

/// The two signals of a delay: "heading behind yaw_rate".
pub fn title(delay: &Delay) -> String {
    format!(
        "{} behind {}",
        delay.pair.of.name(),
        delay.pair.behind.name()
    )
}

/// A word for how well a delay is determined.
pub fn quality(quality: Quality) -> &'static str {
    match quality {
        Quality::Clear => "clear",
        Quality::Weak => "weak",
        Quality::Unknown => "unknown",
    }
}

/// How far to trust a delay.
pub fn remark(delay: &Delay) -> &'static str {
    match delay.quality {
        _ if delay.contradicts => "the signals have opposite signs: check their directions",
        Quality::Clear => "clear",
        Quality::Weak => "weak: it may vary over the recording",
        Quality::Unknown => "not determined",
    }
}
