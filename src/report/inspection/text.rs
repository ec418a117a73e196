//! As text, for a reader in a hurry.

use super::{tables, words};
use crate::display::visible_line;
use crate::inspection::Inspection;
use crate::recording::Recording;
use crate::report::aligned;
use std::fmt::Write;
use textwrap::{Options, WordSplitter, fill};

/// Maximum length of a line of sentences, and the indent of its continuation.
const WIDTH: usize = 100;
const INDENT: &str = "    ";

/// The inspection of a recording in a few aligned lines.
#[must_use]
pub fn text(recording: &Recording, inspection: &Inspection) -> String {
    let mut text = verdict(inspection);
    text += &headline(recording, inspection);
    for note in &recording.notes {
        let kind = words::kind(note);
        let _ = writeln!(text, "{kind}: {}", visible_line(&note.to_string()));
    }
    let header = [
        "channel",
        "samples",
        "Hz",
        "interval 5..95 % [s]",
        "longest gap",
        "gaps %",
        "noise: rest",
        "motion",
        "",
    ];
    let channels = tables::channels(recording, inspection, false).into_iter();
    let channels = channels.map(
        |[name, unit, samples, rate, usual, gap, gaps, rest, motion]| {
            [name, samples, rate, usual, gap, gaps, rest, motion, unit]
        },
    );
    text += "\n";
    text += &aligned(header, &channels.collect::<Vec<_>>());
    let header = ["delay", "s", "90 % interval", "correlation", ""];
    let delays = tables::delays(inspection, 2).into_iter();
    let delays = delays.map(|[pair, delay, interval, correlation, _, _, remark]| {
        [pair, delay, interval, correlation, remark]
    });
    let delays: Vec<_> = delays.collect();
    if !delays.is_empty() {
        text += "\n";
        text += &aligned(header, &delays);
    }
    text
}

/// Whether it can be diagnosed, and each doubt.
fn verdict(inspection: &Inspection) -> String {
    let options = Options::new(WIDTH)
        .subsequent_indent(INDENT)
        .break_words(false)
        .word_splitter(WordSplitter::NoHyphenation);
    let line = |text: String| fill(&visible_line(&text), &options) + "\n";
    let doubts = inspection.doubts.iter().map(words::doubt).map(line);
    let fitness = line(words::fitness(inspection));
    fitness + &doubts.collect::<String>()
}

fn headline(recording: &Recording, inspection: &Inspection) -> String {
    let motion = inspection.motion;
    let mut text = format!(
        "{}: {}, {:.1} s",
        visible_line(&recording.name),
        words::runs(recording),
        motion.duration
    );
    if let Some(distance) = motion.distance {
        let _ = write!(text, ", {distance:.1} m");
    }
    if let Some(turned) = motion.turned {
        let _ = write!(text, ", turned {:.0} deg", turned.to_degrees());
    }
    let share = 100.0 * motion.at_rest / motion.duration.max(f64::MIN_POSITIVE);
    let _ = writeln!(text, ", at rest {:.1} s ({share:.0} %)", motion.at_rest);
    text
}
