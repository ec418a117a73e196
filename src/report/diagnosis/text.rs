//! As text, for a reader in a hurry.

use super::{claim, law, words};
use crate::diagnosis::{Diagnosis, Finding, Verdict};
use crate::report::number::digits;

/// Maximum length of a line.
const WIDTH: usize = 100;
/// Width of the column of labels.
const INDENT: usize = 13;
/// Maximum number of places, findings or notes; the page has all.
const MAX_ENTRIES: usize = 3;
/// Maximum number of detectable effects; the page has all.
const MAX_SIZES: usize = 8;

/// A finished diagnosis in a few lines.
#[must_use]
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut lines = Lines(wrapped(&format!("{}.", claim::headline(diagnosis)), 0));
    if !diagnosis.statement.is_empty() {
        lines.0 += &wrapped(&diagnosis.statement, 0);
    }
    for caution in claim::cautions(diagnosis) {
        lines.add("caution", &caution);
    }
    lines.add("probability", &claim::probability(diagnosis));
    for finding in diagnosis.findings.iter().take(MAX_ENTRIES) {
        lines.add_finding(finding, diagnosis);
    }
    if diagnosis.findings.is_empty() && diagnosis.verdict == Verdict::NothingMissing {
        let (shown, hidden) = words::detectable(diagnosis);
        lines.add("detectable", &some(&shown, MAX_SIZES, ", "));
        lines.add("undetectable", &some(&hidden, MAX_SIZES, ", "));
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

/// The first of many, and how many more.
fn some(all: &[String], max: usize, separator: &str) -> String {
    let mut text = all[..all.len().min(max)].join(separator);
    if all.len() > max {
        text += &format!("{separator}{} more", all.len() - max);
    }
    text
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
            self.0 += &format!("{label:<INDENT$}");
            self.0 += &wrapped(text, INDENT);
        }
    }

    fn add_finding(&mut self, finding: &Finding, diagnosis: &Diagnosis) {
        let title = words::title(finding, diagnosis);
        let values = words::values(finding, diagnosis);
        let what = match (finding.law.is_empty(), &values[..]) {
            (true, "") => title,
            (true, values) => format!("{title}: {values}"),
            // The equations stand below.
            (false, _) if diagnosis.findings.len() > 1 => title,
            (false, _) => String::new(),
        };
        self.add("what", &what);
        for equation in law::equations(&finding.law) {
            self.add("law", &equation);
        }
        let places: Vec<String> = finding.places.iter().map(words::place).collect();
        let label = if finding.local {
            "only at"
        } else {
            "mainly at"
        };
        self.add(label, &some(&places, MAX_ENTRIES, "; "));
        self.add("look-alikes", &words::alike(finding, diagnosis).join(", "));
    }
}

/// Wrapped lines; all but the first are indented.
fn wrapped(text: &str, indent: usize) -> String {
    let mut wrapped = String::new();
    let mut column = indent;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if column > indent && column + 1 + length > WIDTH {
            wrapped += "\n";
            wrapped += &" ".repeat(indent);
            column = indent;
        } else if column > indent {
            wrapped += " ";
            column += 1;
        }
        wrapped += word;
        column += length;
    }
    wrapped + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_wrapped() {
        let text = wrapped(&"word ".repeat(60), INDENT);
        let lengths: Vec<usize> = text.lines().map(str::len).collect();
        // The first line follows its label.
        assert!(lengths[0] + INDENT <= WIDTH && lengths[0] + INDENT > WIDTH - 5);
        assert!(lengths[1..].iter().all(|length| *length <= WIDTH));
        assert_eq!(text.split_whitespace().count(), 60);
        assert!(
            text.lines()
                .skip(1)
                .all(|line| line.starts_with(&" ".repeat(INDENT)))
        );
        assert_eq!(wrapped(&"x".repeat(120), 0).lines().count(), 1);
    }

    #[test]
    fn the_others_are_counted() {
        let all = ["a", "b", "c"].map(String::from);
        assert_eq!(some(&all, 2, ", "), "a, b, 1 more");
        assert_eq!(some(&all, 3, ", "), "a, b, c");
    }
}
