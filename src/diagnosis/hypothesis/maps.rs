//! Which recordings and runs have a map in common.

use crate::recording::{Channel, Recording, Run};

/// Two measured positions closer than this are one reset origin \[m\].
const SAME_PLACE: f64 = 1e-6;

/// Frames of the recordings: runs that start at one point have separate maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Maps {
    /// One for all recordings.
    One,
    /// One for each recording.
    OfRecordings,
    /// One for each run.
    OfRuns,
}

impl Maps {
    /// From the first points of the recordings' runs.
    #[must_use]
    pub fn of(recordings: &[Recording]) -> Self {
        let runs = |recording: &Recording| -> Vec<[f64; 2]> {
            recording.runs.iter().filter_map(first_point).collect()
        };
        let points: Vec<Vec<[f64; 2]>> = recordings.iter().map(runs).collect();
        Self::from_first_points(&points)
    }

    /// From the first points of each recording's runs.
    fn from_first_points<R: AsRef<[[f64; 2]]>>(recordings: &[R]) -> Self {
        let all: Vec<[f64; 2]> = recordings
            .iter()
            .flat_map(|runs| runs.as_ref())
            .copied()
            .collect();
        if recordings.iter().any(|runs| coincide(runs.as_ref())) {
            Self::OfRuns
        } else if coincide(&all) {
            Self::OfRecordings
        } else {
            Self::One
        }
    }
}

fn first_point(run: &Run) -> Option<[f64; 2]> {
    let first = |channel| run.series(channel)?.value.first().copied();
    Some([first(Channel::X)?, first(Channel::Y)?])
}

/// Whether two points coincide to the micrometre.
fn coincide(points: &[[f64; 2]]) -> bool {
    let same = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < SAME_PLACE;
    let again = |k: usize| points[..k].iter().any(|before| same(before, &points[k]));
    (0..points.len()).any(again)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_begins_at_one_point_counts_from_its_own_beginning() {
        let one = [[0.0, 0.0], [3.0, 4.0]];
        let maps = |recordings: &[&[[f64; 2]]]| Maps::from_first_points(recordings);
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
