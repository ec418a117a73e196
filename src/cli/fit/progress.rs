//! A bar on the terminal.

use indicatif::{ProgressBar, ProgressStyle};
use ugv_terrain::fit::Stage;

/// Turns that a fit takes, roughly: the bar counts them as it counts random starts.
const TURNS: u64 = 10;

/// How far a fit has come; shown only on a terminal.
pub struct Progress {
    bar: Option<ProgressBar>,
}

impl Progress {
    pub fn new(starts: usize, quiet: bool) -> Self {
        let style = ProgressStyle::with_template("{bar:40} {msg}, {elapsed} so far");
        // It goes to standard error, and hides where that is no terminal.
        let bar = || {
            ProgressBar::new(TURNS + starts as u64)
                .with_style(style.expect("the template is valid"))
        };
        Self {
            bar: (!quiet).then(bar),
        }
    }

    pub fn show(&self, stage: Stage) {
        let Some(bar) = &self.bar else { return };
        match stage {
            Stage::Turn(turn) => {
                bar.set_position(bar.position().max(TURNS.min(turn as u64)));
                bar.set_message(format!("fitting motion and noise, turn {turn}"));
            }
            Stage::Start(start) => {
                bar.set_position(TURNS + start as u64);
                bar.set_message(format!("random start {}", start + 1));
            }
        }
    }

    pub fn finish(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}
