//! The texts below the options, wrapped to the terminal as the options are.

use clap::Command;
use textwrap::{Options, WordSeparator, WordSplitter};

/// Longer lines are hard to read.
pub const MAX_WIDTH: usize = 100;
/// Narrower terminals get lines of this width.
const MIN_WIDTH: usize = 40;
/// Further indentation of a command that continues on the next line.
const CONTINUED: &str = "      ";
/// A blank at which no line is broken.
const GLUE: char = '\u{a0}';

/// The width of the terminal's lines, as the options take it; without a terminal [`MAX_WIDTH`].
pub fn width() -> usize {
    let columns = || std::env::var("COLUMNS").ok()?.parse().ok();
    let terminal = terminal_size::terminal_size().map(|(width, _)| width.0.into());
    let width = terminal.or_else(columns).unwrap_or(MAX_WIDTH);
    width.clamp(MIN_WIDTH, MAX_WIDTH)
}

/// Wraps the examples and explanations of a command and its subcommands.
pub fn fitted(command: Command, width: usize) -> Command {
    let text = command.get_after_help().map(ToString::to_string);
    let command = match text {
        Some(text) => command.after_help(wrapped(&text, width)),
        None => command,
    };
    command.mut_subcommands(|subcommand| fitted(subcommand, width))
}

/// A text of paragraphs in lines of a width. A paragraph is a line with those that continue it: these are indented as the
/// words behind its label, or follow a backslash.
fn wrapped(text: &str, width: usize) -> String {
    let mut paragraphs: Vec<String> = Vec::new();
    for line in text.lines() {
        match paragraphs.last_mut() {
            Some(last) if last.ends_with('\\') => {
                last.pop();
                last.push_str(line.trim_start());
            }
            Some(last) if continues(last, line) => {
                last.push(' ');
                last.push_str(line.trim_start());
            }
            _ => paragraphs.push(line.into()),
        }
    }
    let lines = paragraphs.iter().flat_map(|paragraph| {
        if is_command(paragraph) {
            command(paragraph, width)
        } else {
            filled(paragraph, width, &" ".repeat(hanging(paragraph)))
        }
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

fn continues(paragraph: &str, line: &str) -> bool {
    let is_text = !paragraph.is_empty() && !line.is_empty();
    is_text && !is_command(paragraph) && indent(line) == hanging(paragraph)
}

/// The indentation of the lines that continue a paragraph: the words behind its label stand there.
fn hanging(paragraph: &str) -> usize {
    let indent = indent(paragraph);
    let text = &paragraph[indent..];
    match text.find("  ") {
        Some(gap) => paragraph.len() - text[gap..].trim_start().len(),
        // Lines of a list.
        None if indent == 2 => 4,
        None => indent,
    }
}

fn is_command(paragraph: &str) -> bool {
    paragraph.starts_with("  ") && !paragraph.starts_with("   ") && paragraph.contains("ugv ")
}

fn filled(paragraph: &str, width: usize, indent: &str) -> Vec<String> {
    let options = Options::new(width)
        .subsequent_indent(indent)
        .break_words(false)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation);
    let lines = textwrap::wrap(paragraph, options);
    lines.into_iter().map(Into::into).collect()
}

/// A command that a shell takes as it stands. What explains it goes above it if the line is too long. An option stays beside
/// its value.
fn command(line: &str, width: usize) -> Vec<String> {
    if line.chars().count() <= width {
        return vec![line.into()];
    }
    let (words, comment) = line.split_once("  #").unwrap_or((line, ""));
    let mut lines = Vec::new();
    if !comment.is_empty() {
        lines = filled(&format!("  #{comment}"), width, "  # ");
    }
    let mut glued = String::new();
    for word in words.trim_end().split_inclusive(' ') {
        if word.starts_with(['-', '|', '>']) && glued.ends_with(GLUE) {
            glued.pop();
            glued.push(' ');
        }
        glued += &word.replace(' ', &GLUE.to_string());
    }
    let glued = format!("  {}", glued.trim_start_matches(GLUE));
    let broken = filled(&glued, width - 2, CONTINUED);
    let last = broken.len() - 1;
    let broken = broken.into_iter().enumerate();
    lines.extend(broken.map(|(place, line)| {
        let end = if place < last { " \\" } else { "" };
        format!("{}{end}", line.replace(GLUE, " ").trim_end())
    }));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_filled_behind_their_labels() {
        let text = "Input:   a header with time and the speeds of\n         the wheels\nOutput:  a table\n";
        assert_eq!(
            wrapped(text, 30),
            "Input:   a header with time\n         and the speeds of the\n         wheels\nOutput:  a table"
        );
    }

    #[test]
    fn commands_stay_commands() {
        let text = "Examples:\n  ugv fit a.csv --output b.json    # the model\n  ugv score a.csv";
        assert_eq!(wrapped(text, 60), text);
        assert_eq!(
            wrapped(text, 28),
            "Examples:\n  # the model\n  ugv fit a.csv \\\n      --output b.json\n  ugv score a.csv"
        );
        let broken = "  ugv sweep --vary a \\\n      --samples 2";
        assert_eq!(wrapped(broken, 60), "  ugv sweep --vary a --samples 2");
    }
}
