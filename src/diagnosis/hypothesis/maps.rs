//! Which recordings and runs have a map in common.

use crate::recording::{Channel, Recording, Run};

/// Two sensors' readings are never as close as this by chance \[m\].
const SAME_PLACE: f64 = 1e-6;

/// Where a place is the same place: what begins at one point counts from its own beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Maps {
    /// Everywhere.
    One,
    /// Within each recording.
    OfRecordings,
    /// Within each run.
    OfRuns,
}

impl Maps {
    /// From the first poses of the recordings' runs.
    #[must_use]
    pub fn of(recordings: &[Recording]) -> Self {
        let runs = |recording: &Recording| -> Vec<[f64; 2]> {
            recording.runs.iter().filter_map(begin_of).collect()
        };
        let begins: Vec<Vec<[f64; 2]>> = recordings.iter().map(runs).collect();
        Self::from_begins(&begins)
    }

    /// From where the runs of each recording begin.
    fn from_begins<R: AsRef<[[f64; 2]]>>(recordings: &[R]) -> Self {
        let all: Vec<[f64; 2]> = recordings
            .iter()
            .flat_map(|runs| runs.as_ref())
            .copied()
            .collect();
        if recordings.iter().any(|runs| meet(runs.as_ref())) {
            Self::OfRuns
        } else if meet(&all) {
            Self::OfRecordings
        } else {
            Self::One
        }
    }
}

fn begin_of(run: &Run) -> Option<[f64; 2]> {
    let first = |channel| run.series(channel)?.value.first().copied();
    Some([first(Channel::X)?, first(Channel::Y)?])
}

/// Whether some are the same to the micrometre.
fn meet(begins: &[[f64; 2]]) -> bool {
    let same = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < SAME_PLACE;
    let again = |k: usize| begins[..k].iter().any(|before| same(before, &begins[k]));
    (0..begins.len()).any(again)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_begins_at_one_point_counts_from_its_own_beginning() {
        let one = [[0.0, 0.0], [3.0, 4.0]];
        let maps = |recordings: &[&[[f64; 2]]]| Maps::from_begins(recordings);
        assert_eq!(maps(&[&one, &[[5.0, 0.0]]]), Maps::One);
        assert_eq!(maps(&[&one, &[[0.0, 0.0]]]), Maps::OfRecordings);
        assert_eq!(
            maps(&[&[[1.0, 2.0], [1.0, 2.0]], &[[5.0, 0.0]]]),
            Maps::OfRuns
        );
        assert_eq!(maps(&[&one]), Maps::One);
        assert_eq!(maps(&[]), Maps::One);
    }
}
