//! The tables of a diagnosis, and its charts of bars.

use super::words;
use crate::diagnosis::{Candidate, Diagnosis, HeldOut, Manoeuvre, Subject};
use crate::fit::Estimate;
use crate::report::chart::{BarChart, LabelledBar, Tint};
use crate::report::html::table;
use crate::report::number::{digits, percent, shown, with_interval, with_unit};

/// Maximum number of effects in the chart; the table has all candidates.
const MAX_BARS: usize = 8;
/// Minimum probability of an effect in the chart.
const LIKELY: f64 = 0.005;

/// The candidates, the likeliest first.
fn ranked(diagnosis: &Diagnosis) -> Vec<&Candidate> {
    let mut ranked: Vec<&Candidate> = diagnosis.candidates.iter().collect();
    // NaN comes last; the sort is stable.
    let key = |value: f64| {
        if value.is_nan() {
            f64::NEG_INFINITY
        } else {
            value
        }
    };
    ranked.sort_by(|a, b| {
        key(b.probability)
            .total_cmp(&key(a.probability))
            .then(key(b.significance.abs()).total_cmp(&key(a.significance.abs())))
    });
    ranked
}

/// The probabilities as bars.
pub fn probabilities(diagnosis: &Diagnosis) -> String {
    let ranked = ranked(diagnosis);
    let tint = |subject: Subject| match subject {
        Subject::Effect(_) | Subject::Data if subject.is_sensor() => Tint::Second,
        Subject::Effect(_) | Subject::Data => Tint::First,
        Subject::Unknown | Subject::Nothing => Tint::Plain,
    };
    // Nothing and unknown are always shown.
    let shown = ranked.iter().enumerate().filter(|(place, candidate)| {
        let likely = *place < MAX_BARS && candidate.probability >= LIKELY;
        likely || !matches!(candidate.subject, Subject::Effect(_))
    });
    let mut bars: Vec<LabelledBar> = shown
        .map(|(_, candidate)| LabelledBar {
            label: words::named(candidate.subject),
            value: candidate.probability,
            text: percent(candidate.probability),
            tint: tint(candidate.subject),
        })
        .collect();
    let others = ranked.len() - bars.len();
    if others > 0 {
        let rest = 1.0 - bars.iter().map(|bar| bar.value).sum::<f64>();
        bars.push(LabelledBar {
            label: format!("{others} others"),
            value: rest.max(0.0),
            text: percent(rest.max(0.0)),
            tint: Tint::Plain,
        });
    }
    let chart = BarChart {
        title: "What is missing?".into(),
        x_label: "probability".into(),
        bars,
        full: Some(1.0),
    };
    let legend = "<p class=\"legend\"><span><i class=\"b0\"></i>physics</span> \
                  <span><i class=\"b1\"></i>sensors</span></p></figure>";
    chart.figure().replacen("</figure>", legend, 1)
}

/// All candidates.
pub fn candidates(diagnosis: &Diagnosis) -> String {
    let header = [
        "candidate ",
        "probability",
        "absorbed fraction",
        "signal / threshold",
        "parameter ",
        "estimate",
        "smallest detectable",
        "held-out gain",
        "look-alikes ",
    ];
    let finite = |value: f64, text: String| if value.is_finite() { text } else { "-".into() };
    let rows = ranked(diagnosis).into_iter().map(|candidate| {
        let is_effect = matches!(candidate.subject, Subject::Effect(_));
        let unit = candidate.unit;
        let unseen = is_effect && !candidate.smallest_detectable.is_nan();
        let never = if unseen { "never" } else { "-" };
        let alike = candidate
            .alike
            .iter()
            .map(|(other, cosine)| format!("{} {cosine:.2}", other.name()));
        vec![
            words::named(candidate.subject),
            percent(candidate.probability),
            percent(candidate.absorbed),
            finite(
                candidate.significance,
                format!("{:.2}", candidate.significance),
            ),
            words::plain(candidate.subject, candidate.parameter),
            with_unit(candidate.estimate, unit),
            if candidate.smallest_detectable.is_finite() {
                words::smallest(candidate)
            } else {
                never.into()
            },
            candidate.held_out_gain.map_or("-".into(), |(gain, error)| {
                let [mean, ..] = with_interval(gain, gain - error, gain + error);
                finite(gain + error, format!("{mean} \u{b1} {}", digits(error, 2)))
            }),
            alike.collect::<Vec<_>>().join(", "),
        ]
    });
    table(&header, rows)
}

/// Held-out errors as bars.
pub fn error_bars(held_out: &HeldOut, diagnosis: &Diagnosis) -> String {
    let models = words::models(held_out, diagnosis);
    let charts = words::MEASURES.iter().map(|(name, unit, of)| {
        let (factor, shown) = shown(unit);
        let bars = models.iter().map(|(model, errors)| LabelledBar {
            label: words::role(*model).into(),
            value: of(errors) * factor,
            text: with_unit(of(errors), unit),
            tint: Tint::Of(*model),
        });
        let bars: Vec<LabelledBar> = bars.collect();
        if bars.iter().all(|bar| !bar.value.is_finite()) {
            return String::new();
        }
        let chart = BarChart {
            title: format!("Error of {name}"),
            x_label: format!("root mean square [{shown}]"),
            bars,
            full: None,
        };
        chart.figure()
    });
    charts.collect()
}

/// Held-out errors as a table, with the remaining share of the refitted model's.
pub fn errors(held_out: &HeldOut, diagnosis: &Diagnosis) -> String {
    let models = words::models(held_out, diagnosis);
    let mut header = vec!["on held-out data"];
    header.extend(models.iter().map(|model| words::role(model.0)));
    let is_mended = models.len() > 2;
    if is_mended {
        header.push("mended / refitted");
    }
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (name, unit, of) in words::MEASURES {
        if !of(&held_out.refitted).is_finite() {
            continue;
        }
        let mut row = vec![format!("error of {name}, rms")];
        row.extend(models.iter().map(|(_, errors)| with_unit(of(errors), unit)));
        if is_mended {
            let ratio = of(&held_out.augmented) / of(&held_out.refitted);
            row.push(if ratio.is_finite() {
                format!("{:.0} %", 100.0 * ratio)
            } else {
                "-".into()
            });
        }
        rows.push(row);
    }
    let mut row = vec!["log score per sample, higher is better".to_owned()];
    row.extend(models.iter().map(|(_, errors)| {
        let score = errors.log_score;
        if score.is_finite() {
            format!("{score:.2}")
        } else {
            "-".into()
        }
    }));
    if is_mended {
        row.push(String::new());
    }
    rows.push(row);
    table(&header, rows.into_iter())
}

/// The soil as given, refitted and in the mended model.
pub fn soil(diagnosis: &Diagnosis) -> String {
    let is_mended = words::has_model(diagnosis);
    let mut header = vec!["soil", "unit ", "as given", "refitted", "90 % interval"];
    if is_mended {
        header.extend(["mended", "90 % interval"]);
    }
    header.push("posterior / prior width");
    let rows = diagnosis.soil.iter().map(|(refitted, augmented)| {
        let parameter = &refitted.parameter;
        let (factor, unit) = shown(parameter.unit);
        let cells = |estimate: &Estimate| {
            let [value, low, high] =
                [estimate.value, estimate.low, estimate.high].map(|v| v * factor);
            let [value, low, high] = with_interval(value, low, high);
            [value, format!("{low} .. {high}")]
        };
        let mut row = vec![
            parameter.name.replace('_', " "),
            unit.to_owned(),
            digits(refitted.nominal * factor, 3),
        ];
        row.extend(cells(refitted));
        let last = if is_mended {
            row.extend(cells(augmented));
            augmented
        } else {
            refitted
        };
        row.push(percent(last.posterior_prior_ratio));
        row
    });
    table(&header, rows)
}

/// How well the compared manoeuvres would separate.
pub fn manoeuvres(next: &Manoeuvre) -> String {
    let bars = next.compared.iter().map(|(name, separation)| LabelledBar {
        label: name.replace('_', " "),
        value: *separation,
        text: digits(*separation, 2),
        tint: if *name == next.name {
            Tint::First
        } else {
            Tint::Plain
        },
    });
    BarChart {
        title: format!("How well manoeuvres {}", words::purpose(next)),
        x_label: "expected separation [standard deviations]".into(),
        bars: bars.collect(),
        full: None,
    }
    .figure()
}

/// Noise of every channel.
pub fn noise(diagnosis: &Diagnosis) -> String {
    let header = [
        "channel",
        "recording ",
        "white",
        "coloured",
        "correlation time",
        "residuals, rms",
        "outliers",
        "samples",
    ];
    let rows = diagnosis.account.noise.iter().map(|estimate| {
        let (channel, unit) = estimate.group.describe();
        let recording = diagnosis.recordings.get(estimate.recording);
        vec![
            channel.into(),
            recording.cloned().unwrap_or_default(),
            with_unit(estimate.noise.white, unit),
            with_unit(estimate.noise.coloured, unit),
            with_unit(estimate.noise.correlation_time, "s"),
            with_unit(estimate.rms, unit),
            format!("{:.1} %", 100.0 * estimate.outliers),
            estimate.samples.to_string(),
        ]
    });
    table(&header, rows)
}

/// Seconds of every step.
pub fn steps(diagnosis: &Diagnosis) -> String {
    let steps = &diagnosis.account.steps;
    let total: f64 = steps.iter().map(|step| step.1).sum();
    let rows = steps
        .iter()
        .map(|(name, seconds)| (*name, *seconds))
        .chain([("total", total)])
        .map(|(name, seconds)| vec![name.to_owned(), with_unit(seconds, "s")]);
    table(&["step", "time"], rows)
}
