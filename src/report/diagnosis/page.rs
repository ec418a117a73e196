//! As a page with plots.

use super::input::{Input, Source};
use super::{claim, law, plots, tables, words};
use crate::diagnosis::{Caution, Channel, Diagnosis, Finding, Manoeuvre, Subject, Verdict};
use crate::display::markup;
use crate::effects::{Acts, Axis, CATALOGUE, Declaration};
use crate::report::html;
use crate::report::number::digits;

/// Marks the time under the pointer in all charts of a run, and hides models. Without it the page has the same content.
const SCRIPT: &str = include_str!("page.js");

/// A finished diagnosis as a self-contained HTML page.
#[must_use]
pub fn page(diagnosis: &Diagnosis, input: &Input) -> String {
    let soil = if diagnosis.soil.is_empty() {
        String::new()
    } else {
        tables::soil(diagnosis)
            + "<p class=\"soft\">A posterior about as wide as the prior means that the recordings do not \
               determine the value.</p>\n"
    };
    let sections = [
        ("paths", "Measured and predicted path", paths(diagnosis)),
        ("next", "What now", next(diagnosis, input)),
        ("findings", "Equations and places", details(diagnosis)),
        ("misses", "Where and when the models miss", runs(diagnosis)),
        ("candidates", "Candidates", candidates(diagnosis)),
        ("soil", "The soil", soil),
        ("account", "How it was done", account(diagnosis)),
    ];
    let mut body = asked(diagnosis, input) + &verdict(diagnosis);
    for (id, title, content) in sections.iter().filter(|section| !section.2.is_empty()) {
        body += &format!("<section id=\"{id}\"><h2>{title}</h2>\n{content}</section>\n");
    }
    let title = format!("Diagnosis of {}", words::list(&diagnosis.recordings, "and"));
    // No line break before a percent sign.
    html::document(&title, &body.replace(" %", "&nbsp;%"), SCRIPT)
}

fn paragraph(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    format!("<p>{}</p>\n", markup(text))
}

/// Labels with one or more lines of text each; those without text are omitted.
fn facts(facts: Vec<(&str, Vec<String>)>) -> String {
    let mut html = String::from("<dl>\n");
    for (label, lines) in facts {
        let lines: Vec<String> = lines
            .iter()
            .filter(|line| !line.is_empty())
            .map(|line| markup(line))
            .collect();
        if !lines.is_empty() {
            html += &format!("<dt>{label}</dt><dd>{}</dd>\n", lines.join("<br>"));
        }
    }
    html + "</dl>\n"
}

/// What was asked, and what limits the answer.
fn asked(diagnosis: &Diagnosis, input: &Input) -> String {
    let used = diagnosis
        .account
        .used
        .iter()
        .map(Some)
        .chain(std::iter::repeat(None));
    let recordings = input.recordings.iter().zip(used);
    let recordings = recordings.map(|((file, length), used)| {
        let used = used.map_or(String::new(), |used| format!(", {used:.1} s used"));
        format!("{file}: {length:.1} s{used}")
    });
    let nominal = &diagnosis.nominal;
    let vehicle = format!(
        "{} kg on {} wheels of {} m radius, {}",
        digits(nominal.vehicle.mass, 3),
        nominal.vehicle.wheel_count(),
        digits(nominal.vehicle.wheel_radius, 3),
        source(&input.vehicle, "assumed, because none was named")
    );
    let terrain = source(
        &input.terrain,
        "clayed_soil, assumed, because none was named",
    );
    let given = if diagnosis.soil.is_empty() {
        terrain
    } else {
        format!("{terrain}; a first guess, the soil is refitted")
    };
    let limit = match input.limit {
        Some(limit) => format!("{} s", digits(limit.as_secs_f64(), 3)),
        None => "none".into(),
    };
    let mut html = String::from("<section id=\"input\" aria-label=\"Input\">\n");
    if !input.command.is_empty() {
        html += &format!("<pre><code>{}</code></pre>\n", markup(&input.command));
    }
    html += &facts(vec![
        ("Recordings", recordings.collect()),
        ("Vehicle", vec![vehicle]),
        ("Terrain", vec![given]),
        (
            "Seed, time limit",
            vec![format!("{}, {limit}", diagnosis.account.seed)],
        ),
    ]);
    for caution in claim::cautions(diagnosis) {
        html += &format!("<p class=\"banner\">{}</p>\n", markup(&caution));
    }
    html + "</section>\n"
}

fn source(source: &Source, assumed: &str) -> String {
    match source {
        Source::Named(file) => format!("from {file}"),
        Source::Recorded => "from the file beside the recording".into(),
        Source::Assumed => assumed.into(),
    }
}

/// The verdict in plain words, and the facts that a reader asks for next.
fn verdict(diagnosis: &Diagnosis) -> String {
    let class = match diagnosis.verdict {
        Verdict::NothingMissing => "fine",
        Verdict::MissingPhysics | Verdict::Ambiguous | Verdict::UnknownPhysics => "found",
        Verdict::Sensor => "sensor",
        Verdict::InsufficientData => "open",
    };
    let mut html = format!("<section id=\"verdict\" class=\"{class}\">");
    html += &format!(
        "<h2 class=\"headline\">{}</h2>\n",
        markup(&claim::headline(diagnosis))
    );
    html += &paragraph(claim::reason(diagnosis));
    let mut all = vec![
        ("Probability", vec![claim::probability(diagnosis)]),
        ("Claims", claim::ladder(diagnosis).collect()),
    ];
    for finding in &diagnosis.findings {
        if words::needs_title(finding, diagnosis) {
            all.push(("Finding", vec![words::title(finding, diagnosis)]));
        }
        all.push(("Size", size(finding, diagnosis)));
        all.push(("Where", places(finding)));
        all.push(("Look-alikes", words::alike(finding, diagnosis)));
    }
    if diagnosis.verdict == Verdict::NothingMissing {
        let (shown, hidden) = words::detectable(diagnosis);
        let first = |all: &[String]| words::first(all, words::MAX_SIZES, " under Candidates");
        all.push(("Smallest detectable", first(&shown)));
        all.push(("Undetectable", first(&hidden)));
    }
    html += &facts(all);
    html + "</section>\n"
}

/// The size of what was found.
fn size(finding: &Finding, diagnosis: &Diagnosis) -> Vec<String> {
    let equations = law::equations(&finding.law);
    if equations.is_empty() {
        words::values(finding, diagnosis)
    } else {
        equations.iter().map(|text| law::typeset(text)).collect()
    }
}

/// The places of a finding, the strongest first.
fn places(finding: &Finding) -> Vec<String> {
    let label = if finding.local { "only" } else { "mainly" };
    let each = finding.places.iter();
    each.map(|place| format!("{label} {}", words::place(place)))
        .collect()
}

/// Assumption, equation and terms of each finding.
fn details(diagnosis: &Diagnosis) -> String {
    diagnosis
        .findings
        .iter()
        .map(|finding| detail(finding, diagnosis))
        .collect()
}

fn detail(finding: &Finding, diagnosis: &Diagnosis) -> String {
    let mut html = String::new();
    if let Subject::Effect(index) = finding.subject {
        let effect = CATALOGUE[index];
        html += &facts(vec![
            ("The model assumes", vec![effect.lifts.into()]),
            ("Instead", vec![effect.equation.into()]),
            ("Source", vec![effect.source.into()]),
        ]);
    }
    let header = [
        "acts on",
        "group ",
        "coefficient (90 % interval)",
        "selected in",
        "in the model file ",
    ];
    if !finding.law.is_empty() {
        html += &format!(
            "<p class=\"soft\">{}.</p>\n",
            markup(&law::symbols(&finding.law, diagnosis))
        );
        html += &html::table(&header, finding.law.iter().map(law::cells));
        html += "<p class=\"soft\">Selected in: share of the resampled data in which the term was \
                 selected. The terms describe how the force acts, not its cause.</p>\n";
    }
    if !finding.mended_by.is_empty() {
        html += "<p>The formula differs from the catalogue's. These terms mend it:</p>\n";
        html += &html::table(&header, finding.mended_by.iter().map(law::cells));
    }
    if html.is_empty() || diagnosis.findings.len() < 2 {
        return html;
    }
    format!(
        "<h3>{}</h3>\n{html}",
        markup(&words::named(finding.subject))
    )
}

/// What to check on the vehicle, how to use the model, and what to drive.
fn next(diagnosis: &Diagnosis, input: &Input) -> String {
    let mut html = String::new();
    let checks = checks(diagnosis);
    if !checks.is_empty() {
        html += "<h3>Check on the vehicle</h3>\n<ul>\n";
        for (what, check) in &checks {
            html += &format!("<li>{}: {}</li>\n", markup(what), markup(check));
        }
        html += "</ul>\n";
    }
    // Without a fit, the model is the given one.
    if !diagnosis.soil.is_empty() && !input.commands().is_empty() {
        // The model has no sensor faults.
        let mends =
            |finding: &Finding| !finding.subject.is_sensor() && !finding.parameters.is_empty();
        let is_mended = diagnosis.findings.iter().any(mends);
        let model = if is_mended { "mended" } else { "refitted" };
        html += &format!("<h3>Use the {model} model</h3>\n");
        for (purpose, command) in input.commands() {
            html += &format!(
                "<p>{purpose}:</p>\n<pre><code>{}</code></pre>\n",
                markup(&command)
            );
        }
    }
    if let Some(next) = &diagnosis.next {
        html += &drive(next);
    }
    html
}

/// For every name of every finding its check, the data before the physics.
fn checks(diagnosis: &Diagnosis) -> Vec<(String, String)> {
    let mut checks: Vec<(String, String)> = Vec::new();
    for caution in &diagnosis.cautions {
        if let Caution::DoubtfulData { recording, doubt } = caution {
            checks.push((recording.clone(), doubt.remedy.clone()));
        }
    }
    for finding in &diagnosis.findings {
        for subject in std::iter::once(&finding.subject).chain(&finding.ambiguous_with) {
            let Some(effect) = declaration(*subject, finding) else {
                continue;
            };
            let check = (words::named(*subject), effect.check.to_owned());
            if !checks.contains(&check) {
                checks.push(check);
            }
        }
    }
    checks
}

/// The declaration of a subject; of unknown physics, that of the residual model for where it acts.
fn declaration(subject: Subject, finding: &Finding) -> Option<&'static Declaration> {
    let index = match subject {
        Subject::Effect(index) => return Some(CATALOGUE[index]),
        Subject::Unknown => {
            let term = finding.law.first().map(|term| term.channel);
            let channel = term.or(finding.places.first().map(|place| place.channel))?;
            let axis = match channel {
                Channel::Longitudinal => Axis::Longitudinal,
                Channel::Lateral => Axis::Lateral,
                Channel::Yaw => Axis::Yaw,
                Channel::Measurement => return None,
            };
            CATALOGUE
                .iter()
                .position(|effect| effect.acts == Acts::Residual(axis))?
        }
        Subject::Nothing | Subject::Data => return None,
    };
    Some(CATALOGUE[index])
}

fn drive(next: &Manoeuvre) -> String {
    format!(
        "<h3>Drive next</h3>\n{}<div class=\"plots\">\n{}</div>\n",
        paragraph(&words::drive_next(next)),
        tables::manoeuvres(next)
    )
}

/// Paths and errors on held-out data.
fn paths(diagnosis: &Diagnosis) -> String {
    let Some(held_out) = &diagnosis.held_out else {
        return String::new();
    };
    let (map, shown) = plots::paths(diagnosis).unwrap_or_default();
    let shown = if shown.is_empty() {
        String::new()
    } else {
        format!(" {}.", markup(&shown))
    };
    let stretches = match held_out.stretches {
        1 => "one segment".into(),
        count => format!("{count} segments"),
    };
    format!(
        "<div class=\"plots\">\n{map}<div class=\"stack\">\n{}</div></div>\n{}<p class=\"soft\">Each prediction starts from a state that is fitted to the first \
         second of its segment, and then follows the wheel speeds for up to {:.1} s. Its parameters are fitted to the other \
         segments. Errors: over {stretches}.{shown}</p>\n",
        tables::error_bars(held_out, diagnosis),
        tables::errors(held_out, diagnosis),
        held_out.horizon
    )
}

fn runs(diagnosis: &Diagnosis) -> String {
    let chosen = plots::chosen(diagnosis);
    if chosen.is_empty() {
        return String::new();
    }
    let mut html = plots::note(diagnosis);
    for run in chosen {
        html += &plots::heading(run, diagnosis);
        html += "<div class=\"plots\">\n";
        html += &plots::figures(run, diagnosis);
        html += "</div>\n";
    }
    let errors = match diagnosis.held_out {
        Some(_) => "on held-out data, as in the first picture",
        None => "of the fits, because nothing was held out",
    };
    html + &format!(
        "<p class=\"soft\">Measured minus predicted: errors {errors}. Sigma: standard deviation of the noise. \
         Residual force and moment: what the refitted model needs in addition to follow the recording.</p>\n"
    )
}

fn candidates(diagnosis: &Diagnosis) -> String {
    if diagnosis.candidates.is_empty() {
        return String::new();
    }
    let mut html = format!(
        "<div class=\"plots\">\n{}</div>\n",
        tables::probabilities(diagnosis)
    );
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
    let mut html: String = account.notes.iter().map(|note| paragraph(note)).collect();
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
    html += &format!(" ugv {}.</p>\n", env!("CARGO_PKG_VERSION"));
    html += "<details><summary>Noise of the sensors, and seconds per step</summary>\n";
    html += &tables::noise(diagnosis);
    html += &tables::steps(diagnosis);
    html + "</details>\n"
}
