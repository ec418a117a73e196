//! A file's runs, each with its own clock and pose frame.

use super::about::About;
use super::channel::Channel;
use super::drive::Drive;
use super::note::Note;
use super::series::Series;

/// One drive without interruption.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Run {
    /// Value of the column `run`; empty without that column. Runs share a label if the clock restarts under it.
    pub label: String,
    channels: [Option<Series>; Channel::ALL.len()],
}

impl Run {
    /// A run without any sample.
    #[must_use]
    pub fn new(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..Self::default()
        }
    }

    /// The run with a channel replaced by these samples.
    #[must_use]
    pub fn with(mut self, channel: Channel, series: Series) -> Self {
        self.channels[channel.index()] = (!series.is_empty()).then_some(series);
        self
    }

    /// Samples of a channel; `None` without any.
    #[must_use]
    pub fn series(&self, channel: Channel) -> Option<&Series> {
        self.channels[channel.index()].as_ref()
    }

    /// The channels that have samples.
    pub fn channels(&self) -> impl Iterator<Item = (Channel, &Series)> {
        Channel::ALL
            .into_iter()
            .filter_map(|channel| Some((channel, self.series(channel)?)))
    }

    /// Time of the first sample of any channel \[s\]; 0 without samples.
    #[must_use]
    pub fn start(&self) -> f64 {
        let starts = self.channels().filter_map(|(_, series)| series.start());
        starts.min_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// Time of the last sample of any channel \[s\]; 0 without samples.
    #[must_use]
    pub fn end(&self) -> f64 {
        let ends = self.channels().filter_map(|(_, series)| series.end());
        ends.max_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// From the first sample to the last \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.end() - self.start()
    }

    /// Both wheel speeds at every time of a sample of either; gaps are filled linearly and ends held. `None` if a side has
    /// no sample.
    #[must_use]
    pub fn drive(&self) -> Option<Drive> {
        let (left, right) = (
            self.series(Channel::OmegaLeft)?,
            self.series(Channel::OmegaRight)?,
        );
        let mut time: Vec<f64> = left.time.iter().chain(&right.time).copied().collect();
        time.sort_by(f64::total_cmp);
        time.dedup();
        let rows = |series: &Series| -> Vec<Option<f64>> {
            let mut samples = series.samples().peekable();
            let pick = |row: &f64| samples.next_if(|(at, _)| at == row).map(|(_, value)| value);
            time.iter().map(pick).collect()
        };
        let (left, right) = (rows(left), rows(right));
        Drive::interpolated(time, &left, &right).ok()
    }

    /// Intervals longer than this \[s\] without a sample of one side, in order and without overlap. Times at which only the
    /// other side has started, or has not ended, count as well.
    #[must_use]
    pub fn wheel_gaps(&self, longest: f64) -> Vec<[f64; 2]> {
        let sides = [Channel::OmegaLeft, Channel::OmegaRight].map(|side| self.series(side));
        let between = sides.into_iter().flatten();
        let mut gaps: Vec<[f64; 2]> = between.flat_map(|series| series.gaps(longest)).collect();
        if let [Some(left), Some(right)] = sides {
            let ends = [Series::start, Series::end].map(|end| Some((end(left)?, end(right)?)));
            let apart = ends.into_iter().flatten();
            let apart = apart.map(|(left, right)| [left.min(right), left.max(right)]);
            gaps.extend(apart.filter(|[from, to]| to - from > longest));
        }
        gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut merged: Vec<[f64; 2]> = Vec::new();
        for gap in gaps {
            match merged.last_mut() {
                Some(last) if gap[0] <= last[1] => last[1] = last[1].max(gap[1]),
                _ => merged.push(gap),
            }
        }
        merged
    }
}

/// The content of a recording's file, and of the JSON file beside it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Name of the file, without folder and ending.
    pub name: String,
    /// The runs in the order of their first rows; at least one.
    pub runs: Vec<Run>,
    /// Metadata: vehicle, terrain, sensors.
    pub about: About,
    /// Changes that the reader made.
    pub notes: Vec<Note>,
}

impl Recording {
    /// Whether some run has samples of a channel.
    #[must_use]
    pub fn has(&self, channel: Channel) -> bool {
        self.runs.iter().any(|run| run.series(channel).is_some())
    }

    /// The label of a run where it is the only one of that label, else its number from 1.
    #[must_use]
    pub fn label_of(&self, run: usize) -> String {
        let label = &self.runs[run].label;
        let alike = self.runs.iter().filter(|other| other.label == *label);
        match alike.count() {
            1 if !label.is_empty() => label.clone(),
            _ => (run + 1).to_string(),
        }
    }

    /// The notes that need a check by the user, each with the recording's name.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let warnings = self.notes.iter().filter(|note| note.kind.is_warning());
        warnings.map(|note| format!("{}: {note}", self.name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(samples: &[(f64, f64)]) -> Series {
        samples.iter().copied().collect()
    }

    #[test]
    fn runs_of_one_label_have_numbers() {
        let recording = Recording {
            runs: ["a", "b", "a", ""].map(Run::new).into(),
            ..Recording::default()
        };
        let labels: Vec<String> = (0..4).map(|run| recording.label_of(run)).collect();
        assert_eq!(labels, ["1", "b", "3", "4"]);
    }

    #[test]
    fn run_reaches_from_the_first_sample_to_the_last() {
        let run = Run::new("a")
            .with(Channel::OmegaLeft, series(&[(1.0, 0.0), (2.0, 0.0)]))
            .with(Channel::X, series(&[(0.5, 0.0), (1.5, 0.0)]))
            .with(Channel::Y, Series::default());
        assert_eq!((run.start(), run.end(), run.duration()), (0.5, 2.0, 1.5));
        assert_eq!(run.channels().count(), 2);
        assert_eq!(run.series(Channel::Y), None);
        assert_eq!(run.drive(), None);
    }

    #[test]
    fn a_side_that_starts_late_or_ends_early_has_gaps_there() {
        let seconds = |from: u32, to: u32| -> Series {
            let times = (10 * from..=10 * to).map(|k| 0.1 * f64::from(k));
            times.map(|time| (time, 1.0)).collect()
        };
        let of = |left: Series, right: Series| {
            let run = Run::new("").with(Channel::OmegaLeft, left);
            run.with(Channel::OmegaRight, right).wheel_gaps(1.5)
        };
        assert_eq!(
            of(seconds(0, 100), seconds(5, 30)),
            [[0.0, 5.0], [30.0, 100.0]]
        );
        assert!(of(seconds(0, 100), seconds(1, 99)).is_empty());
    }

    #[test]
    fn drive_has_the_times_of_both_sides() {
        let run = Run::new("")
            .with(Channel::OmegaLeft, series(&[(0.0, 1.0), (1.0, 3.0)]))
            .with(
                Channel::OmegaRight,
                series(&[(0.5, 5.0), (1.0, 6.0), (2.0, 8.0)]),
            );
        let expected = Drive {
            time: vec![0.0, 0.5, 1.0, 2.0],
            omega_left: vec![1.0, 2.0, 3.0, 3.0],
            omega_right: vec![5.0, 5.0, 6.0, 8.0],
            filled_rows: 3,
        };
        assert_eq!(run.drive(), Some(expected));
    }
}
