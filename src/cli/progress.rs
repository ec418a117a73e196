//! The progress of a command: one line on standard error, on a terminal only, and only for what takes longer than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Jobs shorter than this show no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// How far a command has come; may be advanced from any thread.
pub struct Progress {
    started: Instant,
    quiet: bool,
    bar: ProgressBar,
}

impl Progress {
    /// Counts things of one kind.
    pub fn counting(count: u64, quiet: bool) -> Self {
        Self::new(count, quiet, "{bar:40} {percent} %, {eta} remaining")
    }

    /// Counts bytes.
    pub fn bytes(quiet: bool) -> Self {
        let template = "{bar:40} {binary_bytes} of {binary_total_bytes}, {eta} remaining";
        Self::new(0, quiet, template)
    }

    /// Names the step that is being taken, where nobody can say how many are to come.
    pub fn steps(quiet: bool) -> Self {
        Self::new(0, quiet, "{msg}, {elapsed} so far")
    }

    fn new(total: u64, quiet: bool, template: &str) -> Self {
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
        Self {
            started: Instant::now(),
            quiet,
            bar: bar.with_style(style),
        }
    }

    /// One more is done.
    pub fn count(&self) {
        self.bar.inc(1);
        self.show();
    }

    /// So many of so many are done.
    pub fn reach(&self, done: u64, total: u64) {
        self.bar.set_length(total);
        self.bar.set_position(done);
        self.show();
    }

    /// The next step.
    pub fn step(&self, name: impl Into<String>) {
        self.bar.set_message(name.into());
        if !self.quiet {
            self.bar.enable_steady_tick(PATIENCE);
        }
        self.show();
    }

    /// Clears the line.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn show(&self) {
        if !self.quiet && self.bar.is_hidden() && self.started.elapsed() > PATIENCE {
            // It stays hidden where standard error is no terminal.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }
}
