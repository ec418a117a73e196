//! As a page with plots.

use super::{claim, law, plots, tables, words};
use crate::diagnosis::{Diagnosis, Finding, Subject, Verdict, phrase};
use crate::display::markup;
use crate::effects::CATALOGUE;
use crate::report::html;
use crate::report::number::percent;

/// A finished diagnosis as a self-contained HTML page.
#[must_use]
pub fn page(diagnosis: &Diagnosis) -> String {
    let mut body = verdict(diagnosis);
    for finding in &diagnosis.findings {
        body += &details(finding, diagnosis);
    }
    body += &next(diagnosis);
    body += &held_out(diagnosis);
    body += &runs(diagnosis);
    body += &candidates(diagnosis);
    if !diagnosis.soil.is_empty() {
        body += "<h2>The soil</h2>\n";
        body += &tables::soil(diagnosis);
        body += "<p class=\"soft\">A posterior about as wide as the prior means that the recordings do not \
                 determine the value.</p>\n";
    }
    body += &account(diagnosis);
    let title = format!("Diagnosis of {}", words::list(&diagnosis.recordings, "and"));
    // No line break before a percent sign.
    html::document(&title, &body.replace(" %", "&nbsp;%"))
}

fn paragraph(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    format!("<p>{}</p>\n", markup(text))
}

/// The verdict in plain words, and the facts that a reader asks for next.
fn verdict(diagnosis: &Diagnosis) -> String {
    let class = match diagnosis.verdict {
        Verdict::NothingMissing => "fine",
        Verdict::MissingPhysics | Verdict::Ambiguous | Verdict::UnknownPhysics => "found",
        Verdict::Sensor => "sensor",
        Verdict::InsufficientData => "open",
    };
    let mut html = format!("<section class=\"verdict {class}\">");
    html += &paragraph(&claim::headline(diagnosis));
    html += &paragraph(&diagnosis.statement);
    for caution in claim::cautions(diagnosis) {
        html += &format!("<p class=\"caution\">{}</p>\n", markup(&caution));
    }
    let fact = |label: &str, text: String| (label.to_owned(), text);
    let mut facts = vec![fact("Probability", claim::probability(diagnosis))];
    facts.extend(claim::ladder(diagnosis).map(|claim| fact("Claim", claim)));
    for finding in &diagnosis.findings {
        let label = if diagnosis.findings.len() > 1 {
            words::title(finding, diagnosis)
        } else {
            "Size".into()
        };
        facts.push((label, size(finding, diagnosis)));
        let alike = words::alike(finding, diagnosis).join(", ");
        facts.push(fact("Look-alikes", alike));
    }
    if diagnosis.verdict == Verdict::NothingMissing {
        let (shown, hidden) = words::detectable(diagnosis);
        facts.push(fact("Smallest detectable", shown.join(", ")));
        facts.push(fact("Undetectable", hidden.join(", ")));
    }
    if let Some(held_out) = &diagnosis.held_out {
        let errors = words::improvement(held_out, diagnosis);
        facts.push(fact("On held-out data", errors));
    }
    if let Some(next) = &diagnosis.next {
        facts.push(fact("Drive next", words::drive_next(next)));
    }
    html += "<dl>\n";
    for (label, text) in facts.into_iter().filter(|(_, text)| !text.is_empty()) {
        html += &format!("<dt>{}</dt><dd>{}</dd>\n", markup(&label), markup(&text));
    }
    html + "</dl></section>\n"
}

/// The size of what was found, and where it shows most.
fn size(finding: &Finding, diagnosis: &Diagnosis) -> String {
    let equations = law::equations(&finding.law);
    let mut facts: Vec<String> = equations.iter().map(|text| law::typeset(text)).collect();
    if facts.is_empty() && !finding.parameters.is_empty() {
        facts.push(words::values(finding, diagnosis));
    }
    if let Some(first) = finding.places.first() {
        let label = if finding.local {
            "only at"
        } else {
            "mainly at"
        };
        let more = match finding.places.len() - 1 {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        facts.push(format!("{label} {}{more}", words::place(first)));
    }
    facts.join("; ")
}

fn details(finding: &Finding, diagnosis: &Diagnosis) -> String {
    let found = if finding.probability < 0.5 {
        "Perhaps"
    } else {
        "Found"
    };
    let mut html = format!(
        "<h2>{found}: {}, {}</h2>\n",
        markup(&phrase(finding.subject)),
        percent(finding.probability)
    );
    html += &paragraph(&finding.statement);
    if let Subject::Effect(index) = finding.subject {
        let effect = CATALOGUE[index];
        html += &format!(
            "<p class=\"soft\">Assumption of the model: {}. Found instead: {} ({}).</p>\n",
            markup(effect.lifts),
            markup(effect.equation),
            markup(effect.source)
        );
    }
    if !finding.parameters.is_empty() && finding.law.is_empty() {
        let rows = finding.parameters.iter().map(|found| {
            let what = words::declared(finding.subject, &found.name);
            vec![
                words::parameter(found, diagnosis),
                words::value(found),
                what.map_or(String::new(), |declared| declared.description.into()),
            ]
        });
        html += &html::table(&["parameter", "value (90 % interval)", " "], rows);
    }
    if !finding.law.is_empty() {
        for equation in law::equations(&finding.law) {
            let equation = markup(&law::typeset(&equation));
            html += &format!("<p class=\"law\">{equation}</p>\n");
        }
        html += &format!(
            "<p class=\"soft\">{}.</p>\n",
            markup(&law::symbols(&finding.law, diagnosis))
        );
        let header = [
            "acts on",
            "group ",
            "coefficient (90 % interval)",
            "selected in",
            "in the model file ",
        ];
        html += &html::table(&header, finding.law.iter().map(law::cells));
        html += "<p class=\"soft\">Selected in: share of the resampled data in which the term was \
                 selected. The law describes how the force acts, not its cause.</p>\n";
    }
    if !finding.places.is_empty() {
        let label = if finding.local {
            "Acts only at:"
        } else {
            "Acts mainly at:"
        };
        html += &format!("<p>{label}</p>\n<ul>\n");
        for place in &finding.places {
            html += &format!("<li>{}</li>\n", markup(&words::place(place)));
        }
        html += "</ul>\n";
    }
    html
}

fn next(diagnosis: &Diagnosis) -> String {
    let Some(next) = &diagnosis.next else {
        return String::new();
    };
    let mut html = format!(
        "<h2>Drive next: {}</h2>\n",
        markup(&next.name.replace('_', " "))
    );
    html += &paragraph(&next.description);
    html + "<div class=\"plots\">\n" + &tables::manoeuvres(next) + "</div>\n"
}

fn held_out(diagnosis: &Diagnosis) -> String {
    let Some(held_out) = &diagnosis.held_out else {
        return String::new();
    };
    let mut html = String::from("<h2>Errors on held-out data</h2>\n<div class=\"plots\">\n");
    html += &tables::error_bars(held_out, diagnosis);
    html += "</div>\n";
    html += &tables::errors(held_out, diagnosis);
    let stretches = match held_out.stretches {
        1 => "one stretch".into(),
        count => format!("{count} stretches"),
    };
    html + &format!(
        "<p class=\"soft\">Predicted {:.1} s ahead, on {stretches}.</p>\n",
        held_out.horizon
    )
}

fn runs(diagnosis: &Diagnosis) -> String {
    let chosen = plots::chosen(diagnosis);
    if chosen.is_empty() {
        return String::new();
    }
    let mut html = String::from("<h2>Where and when the model misses</h2>\n");
    html += &plots::note(diagnosis);
    for run in chosen {
        html += &plots::heading(run, diagnosis);
        html += "<div class=\"plots\">\n";
        html += &plots::figures(run, diagnosis);
        html += "</div>\n";
    }
    html + "<p class=\"soft\">Sigma: standard deviation of the noise. Residual force and moment: what \
            the refitted model needs in addition to follow the recording.</p>\n"
}

fn candidates(diagnosis: &Diagnosis) -> String {
    if diagnosis.candidates.is_empty() {
        return String::new();
    }
    let mut html = String::from("<h2>Candidates</h2>\n<div class=\"plots\">\n");
    html += &tables::probabilities(diagnosis);
    html += "</div>\n";
    if diagnosis.findings.len() > 1 {
        html += "<p class=\"soft\">There are several findings. Each probability here is an average over them, \
                 weighted by what each explains. A small effect therefore has a small share, however certain \
                 its name is.</p>\n";
    }
    html += &tables::candidates(diagnosis);
    html + "<p class=\"soft\">Absorbed fraction: share of the candidate's signal that other soil \
           parameters imitate; only the rest is visible. Signal / threshold: above 1 the signal exceeds the \
           largest that chance alone gives among all candidates. Estimate: one linear step from the refitted \
           model. Smallest detectable: smallest size of the parameter, or distance from its value without the \
           effect, that these recordings would have shown. Held-out gain: gain of the log score per \
           sample over the refitted model, with its standard error. Look-alikes: candidates with \
           nearly the same signal, with the cosine.</p>\n"
}

fn account(diagnosis: &Diagnosis) -> String {
    let account = &diagnosis.account;
    let mut html = String::from("<h2>How it was done</h2>\n");
    for note in &account.notes {
        html += &paragraph(note);
    }
    if account.segments == 0 {
        return html;
    }
    html += &format!(
        "<p>{} segments over {:.0} s of driving; {:.0} s were not used (rest, gaps, stretches that the model \
         cannot drive).",
        account.segments, account.seconds, account.left_out,
    );
    if account.overdispersion.is_finite() {
        html += &format!(
            " The segments scatter {:.2} times as much as the noise explains.",
            account.overdispersion
        );
    }
    if account.threshold.is_finite() {
        html += &format!(
            " The threshold of the screening is {:.2}, from simulated recordings with nothing missing.",
            account.threshold
        );
    }
    html += &format!(
        " Seed {}, ugv {}.</p>\n",
        account.seed,
        env!("CARGO_PKG_VERSION")
    );
    html += "<details><summary>Noise of the sensors, and seconds per step</summary>\n";
    html += &tables::noise(diagnosis);
    html += &tables::steps(diagnosis);
    html + "</details>\n"
}
