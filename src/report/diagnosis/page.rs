//! As a page with plots.

use super::{claim, law, plots, tables, words};
use crate::diagnosis::{Diagnosis, Finding, Subject, Verdict, phrase};
use crate::effects::CATALOGUE;
use crate::report::chart::escape;
use crate::report::number::percent;
use crate::report::page;

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
    body += &asked(diagnosis);
    if !diagnosis.soil.is_empty() {
        body += "<h2>The soil</h2>\n";
        body += &tables::soil(diagnosis);
        body += "<p class=\"soft\">Where nearly all of the prior's width is left, the recordings say \
                 nothing of the value.</p>\n";
    }
    body += &account(diagnosis);
    let title = format!("Diagnosis of {}", words::list(&diagnosis.recordings, "and"));
    // Numbers stay with their percent signs.
    page::page(&title, &body.replace(" %", "&nbsp;%"))
}

fn paragraph(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    format!("<p>{}</p>\n", escape(text))
}

/// The verdict in plain words, and what a reader wants to know next.
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
        html += &format!("<p class=\"caution\">{}</p>\n", escape(&caution));
    }
    let fact = |label: &str, text: String| (label.to_owned(), text);
    let mut facts = vec![fact("How sure", claim::sureness(diagnosis))];
    for finding in &diagnosis.findings {
        let label = if diagnosis.findings.len() > 1 {
            words::title(finding, diagnosis)
        } else {
            "How much".into()
        };
        facts.push((label, size(finding, diagnosis)));
        let alike = words::alike(finding, diagnosis).join(", ");
        facts.push(fact("May as well be", alike));
    }
    if diagnosis.verdict == Verdict::NothingMissing {
        let (shown, hidden) = words::detectable(diagnosis);
        facts.push(fact("Would show from", shown.join(", ")));
        facts.push(fact("Never shows", hidden.join(", ")));
    }
    if let Some(held_out) = &diagnosis.held_out {
        let told = words::improvement(held_out, diagnosis);
        facts.push(fact("On unseen data", told));
    }
    if let Some(next) = &diagnosis.next {
        let told = format!(
            "{}: {} Expected to {}.",
            next.name.replace('_', " "),
            words::sentence(&next.description),
            words::expected(next)
        );
        facts.push(fact("Drive next", told));
    }
    html += "<dl>\n";
    for (label, text) in facts.into_iter().filter(|(_, text)| !text.is_empty()) {
        html += &format!("<dt>{}</dt><dd>{}</dd>\n", escape(&label), escape(&text));
    }
    html + "</dl></section>\n"
}

/// How much it is, and where it shows most.
fn size(finding: &Finding, diagnosis: &Diagnosis) -> String {
    let mut told: Vec<String> = law::equations(&finding.law);
    for equation in &mut told {
        *equation = law::handwritten(equation);
    }
    if told.is_empty() && !finding.parameters.is_empty() {
        told.push(words::values(finding, diagnosis));
    }
    if let Some(first) = finding.places.first() {
        let where_ = if finding.local { "only at" } else { "most at" };
        let more = match finding.places.len() - 1 {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        told.push(format!("{where_} {}{more}", words::place(first)));
    }
    told.join("; ")
}

fn details(finding: &Finding, diagnosis: &Diagnosis) -> String {
    let found = if finding.probability < 0.5 {
        "Perhaps"
    } else {
        "Found"
    };
    let mut html = format!(
        "<h2>{found}: {}, {}</h2>\n",
        escape(&phrase(finding.subject)),
        percent(finding.probability)
    );
    html += &paragraph(&finding.statement);
    if let Subject::Effect(index) = finding.subject {
        let effect = CATALOGUE[index];
        html += &format!(
            "<p class=\"soft\">The model had assumed: {}. Now: {} ({}).</p>\n",
            escape(effect.lifts),
            escape(effect.equation),
            escape(effect.source)
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
        html += &page::table(&["parameter", "value (90 % interval)", " "], rows);
    }
    if !finding.law.is_empty() {
        for equation in law::equations(&finding.law) {
            let equation = escape(&law::handwritten(&equation));
            html += &format!("<p class=\"law\">{equation}</p>\n");
        }
        html += &format!(
            "<p class=\"soft\">{}.</p>\n",
            escape(&law::symbols(&finding.law, diagnosis))
        );
        let header = [
            "pushes",
            "group ",
            "coefficient (90 % interval)",
            "chosen in",
            "in the model file ",
        ];
        html += &page::table(&header, finding.law.iter().map(law::cells));
        html += "<p class=\"soft\">Chosen in: share of the resampled data in which the term was \
                 selected. A law says how it acts, not what it is.</p>\n";
    }
    if !finding.places.is_empty() {
        let label = if finding.local {
            "Acts only at:"
        } else {
            "Shows most at:"
        };
        html += &format!("<p>{label}</p>\n<ul>\n");
        for place in &finding.places {
            html += &format!("<li>{}</li>\n", escape(&words::place(place)));
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
        escape(&next.name.replace('_', " "))
    );
    html += &paragraph(&next.description);
    html + "<div class=\"plots\">\n" + &tables::manoeuvres(next) + "</div>\n"
}

fn held_out(diagnosis: &Diagnosis) -> String {
    let Some(held_out) = &diagnosis.held_out else {
        return String::new();
    };
    let mut html =
        String::from("<h2>Errors on data that were not fitted</h2>\n<div class=\"plots\">\n");
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
    html + "<p class=\"soft\">Sigma: standard deviation of the noise. Left over: what must push the \
            re-tuned model for it to follow the recording.</p>\n"
}

fn asked(diagnosis: &Diagnosis) -> String {
    if diagnosis.candidates.is_empty() {
        return String::new();
    }
    let mut html = String::from("<h2>What was asked about</h2>\n<div class=\"plots\">\n");
    html += &tables::probabilities(diagnosis);
    html += "</div>\n";
    if diagnosis.findings.len() > 1 {
        html += "<p class=\"soft\">Several things were found: these are the averages of their probabilities, each \
                 weighed by what it explains, so that a small one has little of it however sure its name is.</p>\n";
    }
    html += &tables::candidates(diagnosis);
    html + "<p class=\"soft\">Taken up by re-tuning: share of the candidate's signal that other soil \
           parameters imitate; only the rest can be seen. Signal over chance: over 1 is more than \
           chance alone gives the largest of all candidates. Estimate: one linear step from the re-tuned \
           model. Would show from: smallest size of the parameter, or distance from where it is off, that \
           these recordings would have shown. Held-out gain: of the log score per \
           sample over the re-tuned model, with its standard error. Looks like: candidates with \
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
        "<p>{} segments over {:.0} s of driving; {:.0} s were left out (rest, gaps, what the model \
         cannot drive).",
        account.segments, account.seconds, account.left_out,
    );
    if account.overdispersion.is_finite() {
        html += &format!(
            " The segments' pulls scatter {:.2} times as much as the noise explains.",
            account.overdispersion
        );
    }
    if account.threshold.is_finite() {
        html += &format!(
            " The screen's threshold, from simulated recordings with nothing missing, is {:.2}.",
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
