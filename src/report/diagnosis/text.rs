//! As text, for a reader in a hurry.

use super::words::MAX_SIZES;
use super::{claim, law, words};
use crate::diagnosis::{Diagnosis, Finding, Verdict};
use crate::report::number::digits;
use textwrap::{Options, WordSplitter};

/// Maximum length of a line.
const WIDTH: usize = 100;
/// Width of the column of labels.
const INDENT: usize = 13;
/// Maximum number of places, findings or notes; the page has all.
const MAX_ENTRIES: usize = 3;

/// A finished diagnosis in a few lines.
#[must_use]
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut lines = Lines(String::new());
    lines.add_wrapped(&format!("{}.", claim::headline(diagnosis)), "", "");
    let reason = claim::reason(diagnosis);
    if !reason.is_empty() {
        lines.add_wrapped(reason, "", "");
    }
    for caution in claim::cautions(diagnosis) {
        lines.add("caution", &caution);
    }
    lines.add("probability", &claim::probability(diagnosis));
    for claim in claim::ladder(diagnosis) {
        lines.add("claim", &claim);
    }
    for finding in diagnosis.findings.iter().take(MAX_ENTRIES) {
        lines.add_finding(finding, diagnosis);
    }
    if diagnosis.findings.is_empty() && diagnosis.verdict == Verdict::NothingMissing {
        let (shown, hidden) = words::detectable(diagnosis);
        lines.add(
            "detectable",
            &words::first(&shown, MAX_SIZES, "").join(", "),
        );
        lines.add(
            "undetectable",
            &words::first(&hidden, MAX_SIZES, "").join(", "),
        );
    }
    if let Some(held_out) = &diagnosis.held_out {
        let errors = words::improvement(held_out, diagnosis);
        if !errors.is_empty() {
            lines.add(
                "held out",
                &format!("{errors} ({:.0} s ahead)", held_out.horizon),
            );
        }
    }
    if let Some(next) = &diagnosis.next {
        lines.add("drive next", &words::drive_next(next));
    }
    for note in diagnosis.account.notes.iter().take(MAX_ENTRIES) {
        lines.add("note", note);
    }
    lines.add("took", &took(diagnosis));
    lines.0
}

/// What mends the formula of a finding.
fn mended(finding: &Finding) -> String {
    match &words::mending(finding)[..] {
        "" => String::new(),
        terms => format!("differs from the catalogue's; mended by {terms}"),
    }
}

fn took(diagnosis: &Diagnosis) -> String {
    let account = &diagnosis.account;
    let total: f64 = account.steps.iter().map(|step| step.1).sum();
    let mut text = format!(
        "{} s over {:.0} s of driving",
        digits(total, 2),
        account.seconds
    );
    if account.left_out >= 0.5 {
        text += &format!(", {:.0} s not used", account.left_out);
    }
    text
}

/// Lines with labels.
struct Lines(String);

impl Lines {
    fn add(&mut self, label: &str, text: &str) {
        if !text.is_empty() {
            self.add_wrapped(text, &format!("{label:<INDENT$}"), &" ".repeat(INDENT));
        }
    }

    fn add_wrapped(&mut self, text: &str, first: &str, indent: &str) {
        let options = Options::new(WIDTH)
            .initial_indent(first)
            .subsequent_indent(indent)
            .break_words(false)
            .word_splitter(WordSplitter::NoHyphenation);
        self.0 += &textwrap::fill(text, options);
        self.0.push('\n');
    }

    fn add_finding(&mut self, finding: &Finding, diagnosis: &Diagnosis) {
        let title = words::title(finding, diagnosis);
        if words::needs_title(finding, diagnosis) {
            self.add("what", &title);
        }
        if finding.law.is_empty() {
            self.add("size", &words::values(finding, diagnosis).join(", "));
        }
        self.add("formula", &mended(finding));
        for equation in law::equations(&finding.law) {
            self.add("law", &equation);
        }
        let places: Vec<String> = finding.places.iter().map(words::place).collect();
        let label = if finding.local {
            "only at"
        } else {
            "mainly at"
        };
        self.add(label, &words::first(&places, MAX_ENTRIES, "").join("; "));
        self.add("look-alikes", &words::alike(finding, diagnosis).join(", "));
    }
}
