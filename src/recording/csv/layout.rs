//! What stands before the rows of a table: comments, the separator, the header, a row of units.

use super::naming::words;
use super::unit::is_unit;
use std::borrow::Cow;

/// Separators that programs write, and the words of a table that is aligned by blanks.
const SEPARATORS: [u8; 4] = [b',', b';', b'\t', b'|'];
/// Starts of comment lines.
const COMMENTS: [&str; 3] = ["#", "%", "//"];

/// How a text is a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout<'a> {
    /// The text from the header on; blanks that separate cells are commas.
    pub text: Cow<'a, [u8]>,
    /// Line of its start, from 1.
    pub line: usize,
    pub separator: u8,
    /// Whether the first line is a row of numbers, and no header stands above it.
    pub is_headless: bool,
}

/// The next line with its end, and the rest.
fn line(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    let end = end.map_or(text.len(), |end| {
        end + 1 + usize::from(text[end..].starts_with(b"\r\n"))
    });
    text.split_at(end)
}

/// The separator that a line `sep=;` of a spreadsheet names.
fn named_separator(line: &str) -> Option<u8> {
    let line = line.trim().trim_matches('"');
    let (key, value) = line.split_at_checked(4)?;
    let separator = *value.as_bytes().first().unwrap_or(&b'\t');
    (key.eq_ignore_ascii_case("sep=") && value.trim_matches([',', ';', '"']).len() <= 1)
        .then_some(separator)
}

/// The text of a comment line.
fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    COMMENTS.iter().find_map(|mark| line.strip_prefix(mark))
}

/// Whether a row starts a comment.
pub fn is_comment(first_cell: &[u8]) -> bool {
    let cell = first_cell.trim_ascii_start();
    COMMENTS
        .iter()
        .any(|mark| cell.starts_with(mark.as_bytes()))
}

fn count(line: &str, separator: u8) -> usize {
    let mut quoted = false;
    let outside = line.bytes().filter(|byte| {
        quoted ^= *byte == b'"';
        !quoted && *byte == separator
    });
    outside.count()
}

/// The separator of a line's cells; `None` for blanks.
fn separator(line: &str) -> Option<u8> {
    let most = SEPARATORS
        .iter()
        .rev()
        .copied()
        .max_by_key(|separator| count(line, *separator));
    most.filter(|separator| count(line, *separator) > 0)
        .or_else(|| (line.split_whitespace().count() < 3).then_some(b','))
}

/// The cells of a line, for a look at the header.
fn cells(line: &str, separator: Option<u8>) -> Vec<&str> {
    let line = line.trim();
    match separator {
        Some(separator) => line.split(char::from(separator)).map(str::trim).collect(),
        None => line.split_whitespace().collect(),
    }
}

fn is_number(cell: &str) -> bool {
    let cell = cell.trim_matches('"');
    cell.is_empty() || cell.replace(',', ".").parse::<f64>().is_ok()
}

/// Whether a row has units, such as `s, rad/s, rad/s`.
pub fn are_units<'a>(mut cells: impl Iterator<Item = &'a [u8]> + Clone) -> bool {
    let text = |cell: &'a [u8]| std::str::from_utf8(cell).unwrap_or("?").trim();
    let named = cells
        .clone()
        .map(text)
        .filter(|cell| !matches!(*cell, "" | "-") && !is_number(cell));
    named.count() > 1 && cells.all(|cell| is_unit(text(cell)))
}

/// Finds the header of a text.
pub fn layout(text: &[u8]) -> Layout<'_> {
    let (mut rest, mut number) = (text, 1);
    let mut named = None;
    let mut last_comment: Option<(&[u8], usize)> = None;
    loop {
        let (first, behind) = line(rest);
        let shown = String::from_utf8_lossy(first);
        let is_skipped = shown.trim().is_empty();
        if first.is_empty() {
            return Layout {
                text: rest.into(),
                line: number,
                separator: named.unwrap_or(b','),
                is_headless: false,
            };
        }
        let separator_line = named_separator(&shown);
        if separator_line.is_some() {
            named = separator_line;
        } else if comment(&shown).is_some() {
            last_comment = Some((rest, number));
        } else if !is_skipped {
            break;
        }
        rest = behind;
        number += 1;
    }
    let first = String::from_utf8_lossy(line(rest).0).into_owned();
    let separator = named.or_else(|| separator(&first));
    let row = cells(&first, separator);
    let is_row = row.iter().any(|cell| !cell.is_empty())
        && row.iter().all(|cell| is_number(cell) || is_moment(cell));
    let (mut is_headless, mut start) = (is_row, (rest, number));
    if is_row && let Some((from, at)) = last_comment {
        // The header of some programs is a comment.
        let shown = String::from_utf8_lossy(line(from).0);
        let text = comment(&shown).unwrap_or_default();
        let header = cells(text, separator);
        let by_commas = cells(text, Some(b','));
        let names =
            |cells: &[&str]| cells.len() == row.len() && !cells.iter().all(|cell| is_number(cell));
        if names(&header) || (separator.is_none() && names(&by_commas)) {
            let skipped = shown.len() - text.len();
            // The mark is ASCII, so that both texts have it at the same place.
            start = (&from[skipped.min(from.len())..], at);
            is_headless = false;
        }
    }
    let (text, line) = start;
    Layout {
        text: match separator {
            Some(_) => text.into(),
            None => commas_for_blanks(text).into(),
        },
        line,
        separator: separator.unwrap_or(b','),
        is_headless,
    }
}

/// Whether a cell may be a date or a time of day.
fn is_moment(cell: &str) -> bool {
    let cell = cell.trim_matches('"');
    cell.starts_with(|c: char| c.is_ascii_digit())
        && cell.matches(':').count() >= 1
        && words(cell).len() > 4
}

/// Blanks between cells as commas; line ends stay.
fn commas_for_blanks(text: &[u8]) -> Vec<u8> {
    let mut commas = Vec::with_capacity(text.len());
    let mut pending = false;
    for &byte in text {
        match byte {
            b' ' | b'\t' => {
                pending = commas
                    .last()
                    .is_some_and(|last| !matches!(last, b'\n' | b'\r'))
            }
            b'\n' | b'\r' => {
                pending = false;
                commas.push(byte);
            }
            _ => {
                if pending && commas.last() != Some(&b',') && byte != b',' {
                    commas.push(b',');
                }
                pending = false;
                commas.push(byte);
            }
        }
    }
    commas
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> (String, usize, char, bool) {
        let found = layout(text.as_bytes());
        let text = String::from_utf8(found.text.into_owned()).unwrap();
        (
            text,
            found.line,
            char::from(found.separator),
            found.is_headless,
        )
    }

    #[test]
    fn what_stands_before_the_header_is_skipped() {
        for (text, rest, line, separator) in [
            ("a,b,c\n1,2,3\n", "a,b,c\n1,2,3\n", 1, ','),
            ("sep=;\na;b\n1,5;2\n", "a;b\n1,5;2\n", 2, ';'),
            ("\"sep=\t\"\r\na\tb\r\n", "a\tb\r\n", 2, '\t'),
            ("# robot 3\n\n// wet\na,b\n1,2\n", "a,b\n1,2\n", 4, ','),
            ("# a b c\n1 2 3\n", "a,b,c\n1,2,3\n", 1, ','),
            ("%time,field.x\n1,2\n", "time,field.x\n1,2\n", 1, ','),
            ("  a   b c \n 1 2\t 3 \n", "a,b,c\n1,2,3\n", 1, ','),
        ] {
            assert_eq!(of(text), (rest.into(), line, separator, false), "{text:?}");
        }
    }

    #[test]
    fn numbers_are_no_header() {
        assert!(of("1,2,3\n4,5,6\n").3);
        assert!(of("# the robot of Monday\n2024-10-27 00:59:30,2,3\n").3);
        assert!(of("# one\n1;2,5;3\n").3);
        assert!(!of("").3 && !of("a\n").3);
    }

    #[test]
    fn a_row_of_units_is_recognised() {
        let units = |text: &str| are_units(text.as_bytes().split(|byte| *byte == b','));
        assert!(units("s,rad/s,rad/s,[m],-"));
        assert!(!units("1,2,3") && !units("a,b") && !units(",,"));
    }
}
