//! Foreign text and numbers in messages and pages: harmless on a terminal and in a browser, and short.

use std::borrow::Cow;

/// A message shows this many characters of a foreign text.
const MAX_CHARACTERS: usize = 60;
/// A list in a message shows this many entries.
const MAX_ENTRIES: usize = 20;
/// Magnitudes of numbers that are shown without an exponent.
const PLAIN: std::ops::Range<f64> = 1e-6..1e15;

/// Whether a terminal or browser obeys a character instead of showing it: control characters (C0, DEL and C1), line
/// and paragraph separators, and those that reverse the direction of text (Unicode Standard Annex 9).
fn is_obeyed(character: char) -> bool {
    character.is_control()
        || matches!(
            character,
            '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
        )
}

/// A text on one line, with visible escapes for line ends and everything else that a terminal obeys.
#[must_use]
pub fn visible_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_obeyed)
}

/// As [`visible_line`] for a text of several lines: its line ends and tabs stay.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_obeyed(c) && !matches!(c, '\n' | '\t'))
}

/// A text within HTML or SVG, with visible escapes for characters that these forbid or that reverse the direction of text.
#[must_use]
pub fn markup(text: &str) -> String {
    visible(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn escaped(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return text.into();
    }
    let mut visible = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        if is_escaped(character) {
            visible.extend(character.escape_default());
        } else {
            visible.push(character);
        }
    }
    visible.into()
}

/// An argument for a shell, in quotes where it needs them.
#[must_use]
pub fn shell_quoted(argument: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        argument.into()
    } else {
        format!("'{}'", argument.replace('\'', r"'\''"))
    }
}

/// The first characters of a foreign text, and the length of a longer one.
#[must_use]
pub fn shortened(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(MAX_CHARACTERS) {
        None => text.into(),
        Some((end, _)) => format!("{}… ({} bytes)", &text[..end], text.len()).into(),
    }
}

/// The first of many foreign texts, shortened, and the number of the others.
#[must_use]
pub fn listed<T: AsRef<str>>(texts: &[T], between: &str) -> String {
    let shown: Vec<_> = texts
        .iter()
        .take(MAX_ENTRIES)
        .map(|text| shortened(text.as_ref()))
        .collect();
    let shown = shown.join(between);
    match texts.len().saturating_sub(MAX_ENTRIES) {
        0 => shown,
        others => format!("{shown}{between}… ({others} more)"),
    }
}

/// A number with all its digits; with an exponent where it would have many zeros.
#[must_use]
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || PLAIN.contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// A number rounded to this many decimals, without trailing zeros.
#[must_use]
pub fn rounded(value: f64, decimals: i32) -> String {
    let scale = 10f64.powi(decimals);
    let rounded = (value * scale).round() / scale + 0.0;
    // A number too large to have decimals may overflow.
    number(if rounded.is_finite() { rounded } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_becomes_visible_and_all_else_stays() {
        for (text, expected) in [
            ("\u{1b}[31mred", "\\u{1b}[31mred"),
            ("\u{7f}\u{9b}2J", "\\u{7f}\\u{9b}2J"),
            (
                "a\u{202e}b\u{2066}c\u{2028}",
                "a\\u{202e}b\\u{2066}c\\u{2028}",
            ),
            ("grün, 砂, رمل, 👩‍🌾, C:\\soil", "grün, 砂, رمل, 👩‍🌾, C:\\soil"),
        ] {
            assert_eq!(visible_line(text), expected);
            assert_eq!(visible(text), expected);
        }
        let lines = "one\n\ttwo\r";
        assert_eq!(visible_line(lines), "one\\n\\ttwo\\r");
        assert_eq!(visible(lines), "one\n\ttwo\\r");
    }

    #[test]
    fn long_texts_and_lists_are_cut_and_counted() {
        assert_eq!(shortened("soil"), "soil");
        assert_eq!(shortened(&"é".repeat(60)), "é".repeat(60));
        let expected = "é".repeat(60) + "… (122 bytes)";
        assert_eq!(shortened(&"é".repeat(61)), expected);
        assert_eq!(listed(&["a", "b"], ", "), "a, b");
        let many = listed(&["a"; 1000], ", ");
        assert_eq!(many, "a, ".repeat(20) + "… (980 more)");
    }

    #[test]
    fn numbers_are_never_hundreds_of_digits() {
        for (value, expected) in [
            (0.0, "0"),
            (-1.5, "-1.5"),
            (1e6, "1000000"),
            (1e308, "1e308"),
            (-2.5e-9, "-2.5e-9"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(value), expected);
        }
        assert_eq!(rounded(1234.567, 2), "1234.57");
        assert_eq!(rounded(-0.001, 2), "0");
        assert_eq!(rounded(-1e308, 2), "-1e308");
    }
}
