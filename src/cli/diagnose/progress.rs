//! A bar on the terminal.

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::time::Duration;

/// Shares of the time that steps take: most goes into fitting many things beside what is on.
const FITTING: [&str; 2] = ["naming", "what else"];
const FITTING_SHARE: u64 = 8;
/// All shares of a diagnosis in which two things are found; with less it ends early.
const SHARES: u64 = 50;

/// How far a diagnosis has come; shown only on a terminal.
pub struct Bar {
    bar: Option<ProgressBar>,
}

impl Bar {
    pub fn new(quiet: bool) -> Self {
        let style = ProgressStyle::with_template("{bar:30} {msg}, {elapsed} so far{left}");
        let style = style.expect("the template is valid");
        let left = |state: &ProgressState, out: &mut dyn Write| {
            let left = left(state.elapsed(), state.pos());
            // Where the terminal fails there is nothing to tell.
            let _ = left.map(|left| write!(out, ", {:#} left at most", HumanDuration(left)));
        };
        // It goes to standard error, and hides where that is no terminal.
        let bar = || {
            let bar = ProgressBar::new(SHARES).with_style(style.with_key("left", left));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        };
        Self {
            bar: (!quiet).then(bar),
        }
    }

    pub fn show(&self, step: &'static str) {
        if let Some(bar) = &self.bar {
            bar.set_position((bar.position() + share(&bar.message())).min(SHARES));
            bar.set_message(step);
        }
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// The share of a step that has ended; none before the first.
fn share(step: &str) -> u64 {
    match step {
        "" => 0,
        step if FITTING.contains(&step) => FITTING_SHARE,
        _ => 1,
    }
}

/// What is left when these shares have taken so long; nothing where that cannot be told.
fn left(elapsed: Duration, shares: u64) -> Option<Duration> {
    let rest = SHARES.saturating_sub(shares);
    let each = elapsed.as_secs_f64() / shares as f64;
    (shares > 0 && rest > 0).then(|| Duration::from_secs_f64(rest as f64 * each))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_grows_no_faster_than_time_goes_by() {
        let seconds = Duration::from_secs;
        assert_eq!(left(seconds(5), 0), None);
        assert_eq!(left(seconds(5), SHARES), None);
        assert_eq!(left(seconds(20), SHARES / 5), Some(seconds(80)));
        // A step that goes on and on.
        assert_eq!(left(seconds(200), SHARES / 5), Some(seconds(800)));
    }

    #[test]
    fn steps_count_by_what_they_take() {
        let bar = Bar {
            bar: Some(ProgressBar::hidden()),
        };
        let at = || bar.bar.as_ref().map_or(0, ProgressBar::position);
        bar.show("preparing");
        assert_eq!(at(), 0);
        bar.show("naming");
        assert_eq!(at(), 1);
        bar.show("noise");
        assert_eq!(at(), 1 + FITTING_SHARE);
    }
}
