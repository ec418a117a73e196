//! Doubts of the reader and of the importer.

use super::doubt::{Doubt, DoubtKind};
use crate::recording::{NoteKind, Recording};

/// Probability of a warning that the importer could not decide, and of one that it could.
const OPEN: f64 = 0.3;
const CERTAIN: f64 = 0.9;
/// Probability of what the reader suspects, of a repaired clock, and of another repair.
const SUSPECTED: f64 = 0.4;
const REPAIRED: f64 = 0.2;

/// The warnings of the importer, and what the reader left as it is.
pub fn doubts(recording: &Recording) -> Vec<Doubt> {
    let imported = recording.about.import_warnings.iter().map(|warning| Doubt {
        kind: DoubtKind::Source,
        channels: Vec::new(),
        span: None,
        probability: if warning.contains("is wheel odometry") {
            CERTAIN
        } else {
            OPEN
        },
        left_out: Vec::new(),
        evidence: format!("ugv import warned: {warning}"),
        remedy: "Import again with other sources (--topics, --pose, --heading, --time)".into(),
    });
    let notes = recording.notes.iter().filter_map(|note| {
        let (kind, probability) = match note.kind {
            NoteKind::Suspicion => (DoubtKind::Source, SUSPECTED),
            NoteKind::Reordered | NoteKind::Repeated | NoteKind::TimeUnit => {
                (DoubtKind::Clock, REPAIRED)
            }
            _ => return None,
        };
        Some(Doubt {
            kind,
            channels: note.channel.into_iter().collect(),
            span: None,
            probability,
            left_out: Vec::new(),
            evidence: note.to_string(),
            remedy: "Check the file".into(),
        })
    });
    imported.chain(notes).collect()
}
