//! A bar on the terminal for drives that take long.

use super::drive::Stop;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};
use ugv_terrain::recording::Drive;

/// Jobs shorter than this need no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Parts that the bar counts.
const PARTS: f64 = 1000.0;

/// How far a drive has come; shown only on a terminal, and only if it takes long.
pub struct Progress {
    started: Instant,
    start: f64,
    duration: f64,
    quiet: bool,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub fn new(recording: &Drive, quiet: bool) -> Self {
        Self {
            started: Instant::now(),
            start: recording.time[0],
            duration: recording.duration(),
            quiet,
            bar: None,
        }
    }

    pub fn visit(&mut self, stop: &Stop) {
        if self.quiet || (self.bar.is_none() && self.started.elapsed() < PATIENCE) {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{bar:40} {percent} %, {eta} left");
            // It goes to standard error, and hides where that is no terminal.
            ProgressBar::new(PARTS as u64).with_style(style.expect("the template is valid"))
        });
        bar.set_position((PARTS * (stop.time - self.start) / self.duration) as u64);
    }

    pub fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
