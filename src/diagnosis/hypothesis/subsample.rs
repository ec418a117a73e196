//! A part of a long recording.
//!
//! What acts throughout shows in some minutes of driving as well as in many: some stretches, spread evenly, stand
//! for all where it is to be seen which way to go; what acts for some seconds changes the cost of those alone.

use super::{Problem, Solution};
use crate::fit::problem::NoiseModel;

/// Stretches of more than this together are many, and of those this is enough \[s\]; but not fewer of them than so many.
const MANY: f64 = 240.0;
const ENOUGH: f64 = 160.0;
const FEWEST: usize = 20;

/// Some stretches of many.
#[derive(Debug, Clone)]
pub struct Subsample {
    places: Vec<usize>,
    count: usize,
}

impl Subsample {
    /// `None` where there are not many.
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

    /// The stretches of a run that reach into a span of time \[s\]. `None` where there is none or are no others.
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

    /// These stretches of all. `None` where there is none.
    #[must_use]
    pub fn some(places: Vec<usize>, count: usize) -> Option<Self> {
        (!places.is_empty()).then_some(Self { places, count })
    }

    /// The places of its stretches among all.
    #[must_use]
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// All over some.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.count as f64 / self.places.len() as f64
    }

    /// These stretches alone.
    #[must_use]
    pub fn problem<'a>(&self, whole: &Problem<'a>) -> Problem<'a> {
        let segments = self.places.iter().map(|k| whole.segments[*k].clone());
        Problem {
            segments: segments.collect(),
            ..whole.clone()
        }
    }

    /// Noise, and the weights of these stretches.
    #[must_use]
    pub fn noise_model(&self, whole: &NoiseModel) -> NoiseModel {
        whole.of(&self.places)
    }

    /// A solution where these stretches begin.
    #[must_use]
    pub fn solution(&self, whole: &Solution) -> Solution {
        Solution {
            starts: self.places.iter().map(|k| whole.starts[*k]).collect(),
            ..whole.clone()
        }
    }

    /// What these stretches told of the soil and of some knobs, on all of them; everything else stays as it was.
    #[must_use]
    pub fn widened(&self, told: &Solution, coefficients: &[usize], whole: &Solution) -> Solution {
        let mut widened = whole.clone();
        widened.soil.clone_from(&told.soil);
        widened.take(coefficients, told);
        for (place, start) in self.places.iter().zip(&told.starts) {
            widened.starts[*place] = *start;
        }
        widened
    }
}
