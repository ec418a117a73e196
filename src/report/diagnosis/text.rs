//! As text, to be read in ten seconds.

use super::{claim, law, words};
use crate::diagnosis::{Diagnosis, Finding, Verdict};
use crate::report::number::digits;

/// Longest line.
const WIDTH: usize = 100;
/// Where texts begin behind their labels.
const INDENT: usize = 13;
/// More places, findings or notes than these are for the page.
const MOST: usize = 3;
/// More sizes of detectable effects than these are for the page.
const MOST_SIZES: usize = 8;

/// A finished diagnosis in some lines.
#[must_use]
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut lines = Lines(wrapped(&format!("{}.", claim::headline(diagnosis)), 0));
    if !diagnosis.statement.is_empty() {
        lines.0 += &wrapped(&diagnosis.statement, 0);
    }
    for caution in claim::cautions(diagnosis) {
        lines.add("caution", &caution);
    }
    lines.add("sure", &claim::sureness(diagnosis));
    for finding in diagnosis.findings.iter().take(MOST) {
        tell(&mut lines, finding, diagnosis);
    }
    if diagnosis.findings.is_empty() && diagnosis.verdict == Verdict::NothingMissing {
        let (shown, hidden) = words::detectable(diagnosis);
        lines.add("would show", &some(&shown, MOST_SIZES, ", "));
        lines.add("never shows", &some(&hidden, MOST_SIZES, ", "));
    }
    if let Some(held_out) = &diagnosis.held_out {
        let told = words::improvement(held_out, diagnosis);
        if !told.is_empty() {
            lines.add(
                "unseen data",
                &format!("{told} ({:.0} s ahead)", held_out.horizon),
            );
        }
    }
    if let Some(next) = &diagnosis.next {
        let told = format!(
            "{}: {} Expected to {}.",
            next.name,
            words::sentence(&next.description),
            words::expected(next)
        );
        lines.add("drive next", &told);
    }
    for note in diagnosis.account.notes.iter().take(MOST) {
        lines.add("note", note);
    }
    lines.add("took", &took(diagnosis));
    lines.0
}

fn tell(lines: &mut Lines, finding: &Finding, diagnosis: &Diagnosis) {
    let title = words::title(finding, diagnosis);
    let values = words::values(finding, diagnosis);
    let what = match (finding.law.is_empty(), &values[..]) {
        (true, "") => title,
        (true, values) => format!("{title}: {values}"),
        // The equations stand below.
        (false, _) if diagnosis.findings.len() > 1 => title,
        (false, _) => String::new(),
    };
    lines.add("what", &what);
    for equation in law::equations(&finding.law) {
        lines.add("law", &equation);
    }
    let places = finding.places.iter().map(words::place);
    let places = some(&places.collect::<Vec<_>>(), MOST, "; ");
    let label = if finding.local { "only at" } else { "most at" };
    lines.add(label, &places);
    lines.add("or else", &words::alike(finding, diagnosis).join(", "));
}

/// The first of many, and how many more.
fn some(all: &[String], most: usize, between: &str) -> String {
    let mut text = all[..all.len().min(most)].join(between);
    if all.len() > most {
        text += &format!("{between}{} more", all.len() - most);
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
        text += &format!(", {:.0} s left out", account.left_out);
    }
    text
}

/// Lines with labels.
struct Lines(String);

impl Lines {
    fn add(&mut self, label: &str, text: &str) {
        if !text.is_empty() {
            let first = format!("{label:<INDENT$}");
            self.0 += &first;
            self.0 += &wrapped(text, INDENT);
        }
    }
}

/// Lines of words, all but the first indented.
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
        // The first line stands behind its label.
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
    fn the_rest_is_counted() {
        let all = ["a", "b", "c"].map(String::from);
        assert_eq!(some(&all, 2, ", "), "a, b, 1 more");
        assert_eq!(some(&all, 3, ", "), "a, b, c");
    }
}
