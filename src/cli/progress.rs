//! The progress of a command: one line on a terminal, for work that takes longer than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Shorter work shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// A line with the progress, which any thread may advance.
pub struct ProgressLine {
    started: Instant,
    quiet: bool,
    bar: ProgressBar,
}

impl ProgressLine {
    /// Counts things of one kind.
    pub fn counting(count: u64, quiet: bool) -> Self {
        Self::new(count, quiet, "{bar:40} {percent} %, {eta} remaining")
    }

    /// Counts bytes.
    pub fn bytes(quiet: bool) -> Self {
        let template = "{bar:40} {binary_bytes} of {binary_total_bytes}, {eta} remaining";
        Self::new(0, quiet, template)
    }

    /// Names the current step, for an unknown number of steps.
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

    /// Counts one more.
    pub fn count(&self) {
        self.bar.inc(1);
        self.show();
    }

    /// Sets the count and the total.
    pub fn reach(&self, done: u64, total: u64) {
        self.bar.set_length(total);
        self.bar.set_position(done);
        self.show();
    }

    /// Starts the next step.
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
            // It stays hidden unless standard error is a terminal.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }
}
