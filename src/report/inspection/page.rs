//! As a page with plots.

use super::{noise, plots, remark, seconds, title};
use crate::inspection::{Inspection, Quality, RunReport};
use crate::recording::Recording;
use crate::report::chart::escape;
use crate::report::number::digits;
use crate::report::page;

/// The inspection of a recording as a self-contained HTML page.
#[must_use]
pub fn page(recording: &Recording, inspection: &Inspection) -> String {
    let mut body = motion(recording, inspection);
    for note in &recording.notes {
        let class = if note.kind.is_warning() {
            "warning"
        } else {
            "note"
        };
        body += &format!("<p class=\"{class}\">{}</p>\n", escape(&note.to_string()));
    }
    body += "<h2>Delays between sensors</h2>\n";
    body += &delays(inspection);
    body += "<p>By cross-correlation of mean rates over 0.5 s; 90 % intervals from drawing blocks of \
             the recording anew. Scale: of what is behind, in its unit, over the other, in its own (metres for a \
             radian of the wheels, say). On slippery ground a delay behind the wheels holds the vehicle's \
             own response, too.</p>\n";
    body += "<h2>Plots</h2>\n<div class=\"plots\">\n";
    for chart in plots::charts(recording, inspection) {
        body += &chart.figure();
    }
    body += "</div>\n<h2>Channels</h2>\n";
    body += &channels(inspection);
    body += "<p>Noise: standard deviation of white noise, by the median distance of a sample from the \
             line between its neighbours; at rest while no wheel turns, in motion an upper bound; \
             held: over half of the samples lie on that line.</p>\n";
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
            body += &format!("<p>{name}: {}</p>\n", escape(text));
        }
    }
    page::page(&recording.name, &body)
}

fn motion(recording: &Recording, inspection: &Inspection) -> String {
    let motion = inspection.motion;
    let optional = |value: Option<f64>, unit: &str| {
        value.map_or(String::new(), |value| format!(", {value:.1} {unit}"))
    };
    format!(
        "<p>{} run{}, {:.1} s{}{}, at rest {:.1} s</p>\n",
        recording.runs.len(),
        if recording.runs.len() == 1 { "" } else { "s" },
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
    let rows = inspection.delays.iter().map(|delay| {
        let (found, scale) = (delay.seconds, delay.scale);
        let known = delay.quality != Quality::Unknown;
        let cell = |text: String| if known { text } else { "-".into() };
        vec![
            title(delay),
            cell(seconds(found.value, 3)),
            cell(format!(
                "{} .. {}",
                seconds(found.low, 3),
                seconds(found.high, 3)
            )),
            format!("{:.3}", delay.correlation),
            cell(format!(
                "{:.3} ({:.3} .. {:.3})",
                scale.value, scale.low, scale.high
            )),
            delay.blocks.to_string(),
            remark(delay).into(),
        ]
    });
    page::table(&header, rows)
}

fn channels(inspection: &Inspection) -> String {
    let header = [
        "channel",
        "unit",
        "samples",
        "rate [Hz]",
        "interval 5 .. 95 % [s]",
        "longest gap [s]",
        "in gaps [%]",
        "noise at rest",
        "noise in motion",
    ];
    let rows = inspection.channels.iter().map(|report| {
        let timing = report.timing;
        vec![
            report.channel.name().into(),
            report.channel.unit().into(),
            timing.samples.to_string(),
            digits(timing.rate(), 3),
            format!("{:.3} .. {:.3}", timing.usual.0, timing.usual.1),
            digits(timing.longest, 3),
            format!("{:.2}", 100.0 * timing.in_gaps),
            noise(report.noise_at_rest, true),
            noise(report.noise_in_motion, true),
        ]
    });
    page::table(&header, rows)
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
    page::table(&header, rows)
}
