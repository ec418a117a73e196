//! A bar on the terminal while many like things are done.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Jobs shorter than this need no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// How many are done; may be counted from any thread.
pub struct Progress {
    started: Instant,
    quiet: bool,
    bar: ProgressBar,
}

impl Progress {
    pub fn new(count: u64, quiet: bool) -> Self {
        let style = ProgressStyle::with_template("{bar:40} {percent} %, {eta} left");
        let bar = ProgressBar::with_draw_target(Some(count), ProgressDrawTarget::hidden())
            .with_style(style.expect("the template is valid"));
        Self {
            started: Instant::now(),
            quiet,
            bar,
        }
    }

    pub fn count(&self) {
        self.bar.inc(1);
        if !self.quiet && self.bar.is_hidden() && self.started.elapsed() > PATIENCE {
            // It stays hidden where standard error is no terminal.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }

    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}
