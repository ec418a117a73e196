//! A bar on the terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// Steps of a diagnosis in which two things are found; with less it ends early.
const STEPS: u64 = 15;

/// How far a diagnosis has come; shown only on a terminal.
pub struct Bar {
    bar: Option<ProgressBar>,
}

impl Bar {
    pub fn new(quiet: bool) -> Self {
        let style =
            ProgressStyle::with_template("{bar:30} {msg}, {elapsed} so far, {eta} left at most");
        // It goes to standard error, and hides where that is no terminal.
        let bar = || {
            let bar = ProgressBar::new(STEPS).with_style(style.expect("the template is valid"));
            bar.enable_steady_tick(std::time::Duration::from_millis(200));
            bar
        };
        Self {
            bar: (!quiet).then(bar),
        }
    }

    pub fn show(&self, step: &'static str) {
        if let Some(bar) = &self.bar {
            bar.set_position((bar.position() + 1).min(STEPS));
            bar.set_message(step);
        }
    }

    pub fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
