//! As a page with plots.

use super::{plots, tables, words};
use crate::display::markup;
use crate::inspection::{Inspection, RunReport};
use crate::recording::Recording;
use crate::report::html;
use crate::report::number::digits;

/// The inspection of a recording as a self-contained HTML page.
#[must_use]
pub fn page(recording: &Recording, inspection: &Inspection) -> String {
    let mut body = format!(
        "<p><strong>{}</strong></p>\n",
        markup(&words::fitness(inspection))
    );
    for doubt in &inspection.doubts {
        body += &format!(
            "<p class=\"warning\">{}</p>\n",
            markup(&words::doubt(doubt))
        );
    }
    body += &motion(recording, inspection);
    for note in &recording.notes {
        let class = words::kind(note);
        body += &format!("<p class=\"{class}\">{}</p>\n", markup(&note.to_string()));
    }
    body += "<h2>Delays between sensors</h2>\n";
    body += &delays(inspection);
    body += "<p>By cross-correlation of mean rates over 0.5 s; 90 % intervals from a block bootstrap. \
             Scale: the delayed signal over the other one, each in its unit (metres per radian of the \
             wheels, for example). On slippery ground a delay behind the wheels includes the vehicle's \
             response.</p>\n";
    body += "<h2>Plots</h2>\n<div class=\"plots\">\n";
    for chart in plots::charts(recording, inspection) {
        body += &chart.figure();
    }
    body += "</div>\n<h2>Channels</h2>\n";
    body += &channels(recording, inspection);
    body += "<p>Noise: standard deviation of white noise, from the median distance of a sample to the \
             line between its neighbours. At rest: while no wheel turns. In motion: an upper bound. \
             Held: over half of the samples lie on that line.</p>\n";
    if inspection.runs.len() > 1 {
        body += "<h2>Runs</h2>\n";
        body += &runs(&inspection.runs);
    }
    for (name, text) in [
        ("Source", &recording.about.source),
        ("Licence", &recording.about.licence),
        ("Note", &recording.about.note),
    ] {
        if !text.is_empty() {
            body += &format!("<p>{name}: {}</p>\n", markup(text));
        }
    }
    html::document(&recording.name, &body, "")
}

fn motion(recording: &Recording, inspection: &Inspection) -> String {
    let motion = inspection.motion;
    let optional = |value: Option<f64>, unit: &str| {
        value.map_or(String::new(), |value| format!(", {value:.1} {unit}"))
    };
    format!(
        "<p>{}, {:.1} s{}{}, at rest {:.1} s</p>\n",
        words::runs(recording),
        motion.duration,
        optional(motion.distance, "m driven"),
        optional(motion.turned.map(f64::to_degrees), "deg turned"),
        motion.at_rest
    )
}

fn delays(inspection: &Inspection) -> String {
    let header = [
        "",
        "delay [s]",
        "90 % interval",
        "correlation",
        "scale",
        "blocks",
        "",
    ];
    let rows = tables::delays(inspection, 3).into_iter().map(Vec::from);
    html::table(&header, rows)
}

fn channels(recording: &Recording, inspection: &Inspection) -> String {
    let header = [
        "channel",
        "unit",
        "samples",
        "rate [Hz]",
        "interval 5 .. 95 % [s]",
        "longest gap",
        "in gaps [%]",
        "noise at rest",
        "noise in motion",
    ];
    let rows = tables::channels(recording, inspection, true);
    html::table(&header, rows.into_iter().map(Vec::from))
}

fn runs(runs: &[RunReport]) -> String {
    let header = [
        "run",
        "start [s]",
        "duration [s]",
        "distance [m]",
        "turned [deg]",
        "at rest [s]",
        "longest gap [s]",
    ];
    let rows = runs.iter().map(|run| {
        let motion = run.motion;
        let optional = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.2}"));
        let longest = run
            .timing
            .iter()
            .max_by(|a, b| a.1.longest.total_cmp(&b.1.longest));
        vec![
            run.label.clone(),
            format!("{:.2}", run.start),
            format!("{:.2}", motion.duration),
            optional(motion.distance),
            optional(motion.turned.map(f64::to_degrees)),
            format!("{:.2}", motion.at_rest),
            longest.map_or("-".into(), |(channel, timing)| {
                format!("{} in {channel}", digits(timing.longest, 2))
            }),
        ]
    });
    html::table(&header, rows)
}
