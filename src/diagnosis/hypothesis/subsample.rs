//! A subsample of a long recording.
//!
//! An effect that acts throughout shows in some minutes of driving as well as in many: evenly spaced segments suffice
//! for the first steps of its fit. An effect of some seconds changes the cost of those segments alone.

use super::{Problem, Solution};
use crate::fit::problem::NoiseModel;

/// A recording longer than the first \[s\] is subsampled to about the second, with at least this number of segments.
const MANY: f64 = 240.0;
const ENOUGH: f64 = 160.0;
const FEWEST: usize = 20;

/// Some segments of a recording.
#[derive(Debug, Clone)]
pub struct Subsample {
    places: Vec<usize>,
    count: usize,
}

impl Subsample {
    /// `None` for a short recording.
    #[must_use]
    pub fn of(problem: &Problem) -> Option<Self> {
        let count = problem.segments.len();
        let seconds = problem.seconds();
        let enough = ENOUGH / seconds * count as f64;
        let enough = (enough.round() as usize).max(FEWEST);
        (seconds > MANY && count > enough).then(|| Self {
            places: (0..enough).map(|k| k * count / enough).collect(),
            count,
        })
    }

    /// The segments of a run that overlap a time interval \[s\]. `None` if these are none or all.
    #[must_use]
    pub fn within(problem: &Problem, run: (usize, usize), [start, end]: [f64; 2]) -> Option<Self> {
        let count = problem.segments.len();
        let reaches = |place: &usize| {
            let segment = &problem.segments[*place];
            (segment.recording, segment.run) == run && segment.start < end && segment.end > start
        };
        let places: Vec<usize> = (0..count).filter(reaches).collect();
        Self::some(places, count).filter(|subsample| subsample.places.len() < count)
    }

    /// These segments. `None` for none.
    #[must_use]
    pub fn some(places: Vec<usize>, count: usize) -> Option<Self> {
        (!places.is_empty()).then_some(Self { places, count })
    }

    /// Indices of its segments.
    #[must_use]
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// Number of all segments over that of the subsample.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.count as f64 / self.places.len() as f64
    }

    /// The problem on these segments alone.
    #[must_use]
    pub fn problem<'a>(&self, whole: &Problem<'a>) -> Problem<'a> {
        let segments = self.places.iter().map(|k| whole.segments[*k].clone());
        Problem {
            segments: segments.collect(),
            ..whole.clone()
        }
    }

    /// The noise model of these segments.
    #[must_use]
    pub fn noise_model(&self, whole: &NoiseModel) -> NoiseModel {
        whole.of(&self.places)
    }

    /// The solution on these segments.
    #[must_use]
    pub fn solution(&self, whole: &Solution) -> Solution {
        Solution {
            starts: self.places.iter().map(|k| whole.starts[*k]).collect(),
            ..whole.clone()
        }
    }

    /// A solution for all segments with soil, some coefficients and starts from a fit of the subsample.
    #[must_use]
    pub fn widened(&self, fitted: &Solution, coefficients: &[usize], whole: &Solution) -> Solution {
        let mut widened = whole.clone();
        widened.soil.clone_from(&fitted.soil);
        widened.take(coefficients, fitted);
        for (place, start) in self.places.iter().zip(&fitted.starts) {
            widened.starts[*place] = *start;
        }
        widened
    }
}
