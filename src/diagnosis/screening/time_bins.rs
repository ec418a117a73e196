//! Time bins, in which each effect's signal is resolved, and the vehicle's places in them.

use super::system::System;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::maps::Maps;
use crate::fit::segment::SAME_TIME;
use crate::recording::Channel;

/// Places within a time bin.
const POINTS: usize = 5;

/// A time bin.
#[derive(Debug, Clone, Copy)]
pub struct TimeBin {
    /// Index among the system's segments.
    pub segment: usize,
    /// Index within the segment.
    pub time_bin: usize,
    /// Start \[s\], by the run's clock.
    pub start: f64,
    /// End \[s\].
    pub end: f64,
    places: [Option<[f64; 2]>; POINTS],
}

impl TimeBin {
    /// Length \[s\].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.end - self.start
    }

    /// The place in the middle, if it is known and all recordings share a map.
    #[must_use]
    pub fn place(&self) -> Option<[f64; 2]> {
        self.places[POINTS / 2]
    }

    /// The share of it that lies within some seconds.
    #[must_use]
    pub fn between(&self, start: f64, end: f64) -> f64 {
        let inside = self.end.min(end) - self.start.max(start);
        (inside / self.seconds()).clamp(0.0, 1.0)
    }

    /// The share of it that lies somewhere on the map.
    #[must_use]
    pub fn within(&self, inside: impl Fn([f64; 2]) -> bool) -> f64 {
        let places = self.places.iter();
        let count = places.filter(|place| place.is_some_and(&inside)).count();
        count as f64 / POINTS as f64
    }
}

/// Time bins of a run that follow one another without a gap.
pub struct Chain {
    /// Recording.
    pub recording: usize,
    /// Run.
    pub run: usize,
    /// The time bins in their order.
    pub time_bins: Vec<TimeBin>,
}

/// Time bins in their order, run by run.
#[must_use]
pub fn chains(problem: &Problem, system: &System) -> Vec<Chain> {
    let mut chains: Vec<Chain> = Vec::new();
    for (place_of_segment, segment) in system.segments.iter().enumerate() {
        let data = &problem.segments[segment.index];
        let follows = chains.last().is_some_and(|chain| {
            let end = chain.time_bins.last().map(|time_bin| time_bin.end);
            (chain.recording, chain.run) == (data.recording, data.run)
                && end.is_some_and(|end| (end - segment.edges[0]).abs() < SAME_TIME)
        });
        if !follows {
            chains.push(Chain {
                recording: data.recording,
                run: data.run,
                time_bins: Vec::new(),
            });
        }
        let run = &problem.recordings[data.recording].runs[data.run];
        let at = |channel, time| run.series(channel).and_then(|series| series.at(time));
        let Some(chain) = chains.last_mut() else {
            continue;
        };
        for (time_bin, edges) in segment.edges.windows(2).enumerate() {
            let place = |point: usize| {
                let share = (point as f64 + 0.5) / POINTS as f64;
                let time = edges[0] + share * (edges[1] - edges[0]);
                let pair = at(Channel::X, time).zip(at(Channel::Y, time));
                pair.filter(|_| problem.maps == Maps::One)
                    .map(|(x, y)| [x, y])
            };
            chain.time_bins.push(TimeBin {
                segment: place_of_segment,
                time_bin,
                start: edges[0],
                end: edges[1],
                places: std::array::from_fn(place),
            });
        }
    }
    chains
}
