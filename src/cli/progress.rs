//! The progress of a command on standard error. On a terminal it is one line, for work that takes longer than a second.
//! Elsewhere it is a line for each numbered step, and nothing for other work.

use super::output::notify;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Shorter work shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// A line with the progress, which any thread may advance.
pub struct ProgressLine {
    started: Instant,
    quiet: bool,
    bar: ProgressBar,
    /// The step shown last.
    last: Mutex<String>,
}

impl ProgressLine {
    /// Counts things of one kind.
    pub fn counting(count: u64, quiet: bool) -> Self {
        Self::new(count, quiet, "{bar:40} {percent} %{remaining}")
    }

    /// Counts bytes.
    pub fn bytes(quiet: bool) -> Self {
        let template = "{bar:40} {binary_bytes} of {binary_total_bytes}{remaining}";
        Self::new(0, quiet, template)
    }

    /// Names the current step, for an unknown number of steps.
    pub fn steps(quiet: bool) -> Self {
        Self::new(0, quiet, "{msg}, {elapsed} so far")
    }

    fn new(total: u64, quiet: bool, template: &str) -> Self {
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        let style = style.with_key("remaining", remaining);
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
        Self {
            started: Instant::now(),
            quiet,
            bar: bar.with_style(style),
            last: Mutex::default(),
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

    /// Starts some work of a numbered step.
    pub fn numbered_step(&self, step: &str, work: &str) {
        if stderr().is_terminal() {
            self.step(format!("{step} ({work})"));
        } else if let Ok(mut last) = self.last.lock()
            && *last != step
        {
            step.clone_into(&mut last);
            if !self.quiet {
                notify(step);
            }
        }
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

/// The remaining time, once a twentieth is done: before, there is nothing to estimate it from.
fn remaining(state: &ProgressState, text: &mut dyn Write) {
    if state.fraction() >= 0.05 {
        let _ = write!(text, ", {} remaining", HumanDuration(state.eta()));
    }
}
