//! Regions as sets of time bins, and the score of a candidate that acts in one of them alone.

use super::identifiable::Accepted;
use super::region::{Region, RunInterval};
use super::screen::{Projected, Projection, Score};
use super::system::System;
use super::time_bins::{Chain, TimeBin};
use crate::fit::deadline::Deadline;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Shorter intervals resemble outliers, longer ones the whole drive \[s\].
const SHORTEST: f64 = 1.9;
const LONGEST: f64 = 40.0;
/// Radii of discs \[m\].
const RADII: [f64; 4] = [1.5, 3.0, 5.0, 8.0];
/// The best disc is moved and resized by these shares of its radius, from the first to the last, while the evidence
/// gains more than this.
const FIRST_MOVE: f64 = 0.3;
const LAST_MOVE: f64 = 0.05;
const WORTH_A_MOVE: f64 = 0.5;
/// The ends of the best interval are moved by these times \[s\], by the same rule.
const FIRST_SHIFT: f64 = 0.25;
const LAST_SHIFT: f64 = 0.06;
/// Directions of lines, and places of each.
const DIRECTIONS: usize = 12;
const POSITIONS: usize = 24;

/// A candidate's equations bin by bin.
pub struct BinnedFit {
    /// Columns within a time bin, each with a factor.
    pub columns: Vec<(usize, f64)>,
    /// Its unknowns.
    pub unknowns: Vec<usize>,
}

/// Discs along the paths, none twice.
#[must_use]
pub fn discs(chains: &[Chain]) -> Vec<[f64; 3]> {
    let mut discs: Vec<[f64; 3]> = Vec::new();
    for radius in RADII {
        let first = discs.len();
        for time_bin in chains.iter().flat_map(|chain| &chain.time_bins) {
            let Some([x, y]) = time_bin.place() else {
                continue;
            };
            let near = |disc: &[f64; 3]| (disc[0] - x).hypot(disc[1] - y) < 0.5 * radius;
            if !discs[first..].iter().any(near) {
                discs.push([x, y, radius]);
            }
        }
    }
    discs
}

/// A candidate, and the equations that every region is scored with.
pub struct Scan<'a> {
    /// The linearised problem.
    pub system: &'a System,
    /// Soil and what is on, projected out.
    pub projection: &'a Projection<'a>,
    /// For each recording the columns of the nuisance.
    pub nuisance: &'a [Vec<Option<usize>>],
    /// The nuisance's inverse matrix.
    pub inverse: &'a DMatrix<f64>,
    /// The nuisance's step to zero gradient.
    pub settled: &'a DVector<f64>,
    /// The candidate.
    pub binned: BinnedFit,
    /// Accepted effects that keep their sizes beside it.
    pub accepted: &'a Accepted,
    /// Whether its cause belongs to the vehicle: it stays at every place, and comes or goes once in a run.
    pub of_vehicle: bool,
    /// End of the scan; a scan that is cut short finds nothing.
    pub deadline: Deadline<'a>,
}

/// The best region so far, and the number of those tried.
#[derive(Default)]
struct BestRegion {
    found: Option<(Region, Score)>,
    count: u32,
}

impl BestRegion {
    fn offer(&mut self, extent: Region, score: Score) {
        self.count += 1;
        let best = self.found.as_ref();
        if best.is_none_or(|(_, best)| score.evidence > best.evidence) {
            self.found = Some((extent, score));
        }
    }

    /// With the evidence less the cost of the choice.
    fn with_price(self) -> Option<(Region, Score, f64)> {
        let (extent, score) = self.found?;
        let evidence = score.evidence - f64::from(self.count).ln();
        Some((extent, score, evidence))
    }
}

/// Sums over a set of time bins.
#[derive(Debug, Clone)]
struct BinSums {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    cross: DMatrix<f64>,
}

impl Scan<'_> {
    fn nothing(&self) -> BinSums {
        let (count, nuisance) = (self.binned.columns.len(), self.settled.len());
        BinSums {
            matrix: DMatrix::zeros(count, count),
            gradient: DVector::zeros(count),
            cross: DMatrix::zeros(count, nuisance),
        }
    }

    /// Adds a share of a time bin to a set; `before` are the set's bins of the same segment with their shares.
    fn add(
        &self,
        sums: &mut BinSums,
        (time_bin, share): (&TimeBin, f64),
        before: impl Iterator<Item = (usize, f64)> + Clone,
    ) {
        let segment = &self.system.segments[time_bin.segment];
        let layout = &self.system.layout;
        let first = |time_bin: usize| layout.whole() + time_bin * layout.per_bin();
        let nuisance = &self.nuisance[segment.recording];
        for (i, (a, factor)) in self.binned.columns.iter().enumerate() {
            let row = first(time_bin.time_bin) + a;
            let factor = share * factor;
            sums.gradient[i] += factor * segment.gradient[row];
            for (j, column) in nuisance.iter().enumerate() {
                if let Some(column) = column {
                    sums.cross[(i, j)] += factor * segment.matrix[(row, *column)];
                }
            }
            for (j, (b, other_factor)) in self.binned.columns.iter().enumerate() {
                let column = first(time_bin.time_bin) + b;
                let mut sum = share * segment.matrix[(row, column)];
                for (other, theirs) in before.clone() {
                    sum += theirs * segment.matrix[(row, first(other) + b)];
                    sum += theirs * segment.matrix[(first(other) + a, column)];
                }
                sums.matrix[(i, j)] += factor * other_factor * sum;
            }
        }
    }

    /// The one-step fit of a set; without evidence where an accepted effect loses its size.
    fn score(&self, sums: &BinSums) -> Score {
        let projected = Projected {
            unknowns: self.binned.unknowns.clone(),
            matrix: &sums.matrix - &sums.cross * self.inverse * sums.cross.transpose(),
            gradient: &sums.gradient - &sums.cross * self.settled,
            raw: sums.matrix.clone(),
        };
        let score = self.projection.score_with(&projected, 1.0);
        let remainder = self.projection.with_prior(&projected);
        if self
            .accepted
            .keep_sizes(&sums.cross.transpose(), &remainder)
        {
            score
        } else {
            Score {
                evidence: f64::NEG_INFINITY,
                ..score
            }
        }
    }

    /// Sums over the shares of time bins that lie somewhere, and the seconds that they last.
    fn sum(&self, chains: &[Chain], inside: impl Fn(&TimeBin) -> f64) -> (BinSums, f64) {
        let mut sums = self.nothing();
        let mut seconds = 0.0;
        for chain in chains {
            let shares = chain
                .time_bins
                .iter()
                .map(|time_bin| (time_bin, inside(time_bin)));
            let set: Vec<(&TimeBin, f64)> = shares.filter(|(_, share)| *share > 0.0).collect();
            for (index, (time_bin, share)) in set.iter().enumerate() {
                let before = set[..index].iter().rev();
                let before = before.take_while(|(other, _)| other.segment == time_bin.segment);
                let before = before.map(|(other, theirs)| (other.time_bin, *theirs));
                self.add(&mut sums, (time_bin, *share), before);
                seconds += share * time_bin.seconds();
            }
        }
        (sums, seconds)
    }

    /// The one-step fit in one region. `None` for a region without time bins, and for a line on the map.
    #[must_use]
    pub fn within(&self, chains: &[Chain], extent: &Region) -> Option<Score> {
        let of_run = |at: &RunInterval| {
            let same = |chain: &&Chain| (chain.recording, chain.run) == (at.recording, at.run);
            let time_bins = chains.iter().filter(same);
            let sums = time_bins.map(|chain| {
                self.sum(std::slice::from_ref(chain), |time_bin| {
                    time_bin.between(at.start, at.end)
                })
            });
            sums.max_by(|a, b| a.1.total_cmp(&b.1))
        };
        if !self.is_possible(chains, extent) {
            return None;
        }
        let (sums, seconds) = match extent {
            Region::Time(at) => of_run(at)?,
            Region::Place { disc } => self.sum(chains, |time_bin| time_bin.within(inside(*disc))),
            Region::Run(_) | Region::Beyond { .. } => return None,
        };
        (seconds > 0.0).then(|| self.score(&sums))
    }

    /// Whether it may act in a region alone.
    fn is_possible(&self, chains: &[Chain], extent: &Region) -> bool {
        match extent {
            _ if !self.of_vehicle => true,
            Region::Place { .. } => false,
            Region::Time(at) => {
                let of_run =
                    |chain: &&Chain| (chain.recording, chain.run) == (at.recording, at.run);
                let mut time_bins = chains.iter().filter(of_run).flat_map(|c| &c.time_bins);
                let first = time_bins.next();
                let last = time_bins.next_back().or(first);
                first.is_some_and(|first| at.start - first.start < SHORTEST)
                    || last.is_some_and(|last| last.end - at.end < SHORTEST)
            }
            Region::Run(_) | Region::Beyond { .. } => true,
        }
    }

    /// The best interval of all runs, its ends refined.
    #[must_use]
    pub fn intervals(&self, chains: &[Chain]) -> Option<(Region, Score, f64)> {
        let mut best = BestRegion::default();
        for chain in chains {
            for (from, first) in chain.time_bins.iter().enumerate() {
                if self.deadline.is_over() {
                    return None;
                }
                let mut sums = self.nothing();
                for (to, time_bin) in chain.time_bins.iter().enumerate().skip(from) {
                    let length = time_bin.end - first.start;
                    if length > LONGEST {
                        break;
                    }
                    let before = chain.time_bins[from..to].iter().rev();
                    let before = before.take_while(|other| other.segment == time_bin.segment);
                    self.add(
                        &mut sums,
                        (time_bin, 1.0),
                        before.map(|other| (other.time_bin, 1.0)),
                    );
                    if length < SHORTEST {
                        continue;
                    }
                    let extent = Region::Time(RunInterval {
                        recording: chain.recording,
                        run: chain.run,
                        start: first.start,
                        end: time_bin.end,
                    });
                    if self.is_possible(chains, &extent) {
                        best.offer(extent, self.score(&sums));
                    }
                }
            }
        }
        let mut shift = FIRST_SHIFT;
        while shift > LAST_SHIFT {
            let (Region::Time(at), before) = best.found.clone()? else {
                return None;
            };
            for [earlier, later] in [[shift, 0.0], [-shift, 0.0], [0.0, shift], [0.0, -shift]] {
                let (start, end) = (at.start - earlier, at.end + later);
                self.offer_interval(&mut best, chains, RunInterval { start, end, ..at });
            }
            let gained = best.found.as_ref()?.1.evidence - before.evidence;
            let moved = gained >= WORTH_A_MOVE;
            if !moved {
                shift *= 0.5;
            }
        }
        best.with_price()
    }

    /// Offers an interval within one chain; a time bin counts by its share inside.
    fn offer_interval(&self, best: &mut BestRegion, chains: &[Chain], at: RunInterval) {
        let middle = 0.5 * (at.start + at.end);
        let covers = |chain: &&Chain| {
            let ends = chain.time_bins.first().zip(chain.time_bins.last());
            (chain.recording, chain.run) == (at.recording, at.run)
                && ends.is_some_and(|(first, last)| first.start <= middle && middle <= last.end)
        };
        let Some(chain) = chains.iter().find(covers) else {
            return;
        };
        let (sums, seconds) = self.sum(std::slice::from_ref(chain), |time_bin| {
            time_bin.between(at.start, at.end)
        });
        // An interval beyond the end of the chain is cut short.
        let inside = (seconds - (at.end - at.start)).abs() < 1e-6;
        let extent = Region::Time(at);
        if inside && (SHORTEST..=LONGEST).contains(&seconds) && self.is_possible(chains, &extent) {
            best.offer(extent, self.score(&sums));
        }
    }

    /// The best of several runs.
    #[must_use]
    pub fn runs(&self, chains: &[Chain]) -> Option<(Region, Score, f64)> {
        let runs: Vec<&[Chain]> = chains
            .chunk_by(|a, b| (a.recording, a.run) == (b.recording, b.run))
            .collect();
        if runs.len() < 2 {
            return None;
        }
        let mut best = BestRegion::default();
        for run in runs {
            let mut time_bins = run.iter().flat_map(|chain| &chain.time_bins);
            let (Some(first), Some(last)) = (time_bins.next(), time_bins.next_back()) else {
                continue;
            };
            let extent = Region::Run(RunInterval {
                recording: run[0].recording,
                run: run[0].run,
                start: first.start,
                end: last.end,
            });
            best.offer(extent, self.score(&self.sum(run, |_| 1.0).0));
        }
        best.with_price()
    }

    /// The best disc, refined.
    #[must_use]
    pub fn discs(&self, chains: &[Chain], discs: &[[f64; 3]]) -> Option<(Region, Score, f64)> {
        let mut best = BestRegion::default();
        if self.of_vehicle {
            return None;
        }
        for disc in discs {
            if self.deadline.is_over() {
                return None;
            }
            self.offer_disc(&mut best, chains, *disc);
        }
        let mut share = FIRST_MOVE;
        while share > LAST_MOVE {
            let (Region::Place { disc }, before) = best.found.clone()? else {
                return None;
            };
            let [x, y, radius] = disc;
            let step = share * radius;
            for [dx, dy] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                self.offer_disc(&mut best, chains, [x + step * dx, y + step * dy, radius]);
            }
            for factor in [1.0 + share, 1.0 / (1.0 + share)] {
                self.offer_disc(&mut best, chains, [x, y, factor * radius]);
            }
            let gained = best.found.as_ref()?.1.evidence - before.evidence;
            // What is not a number is no gain.
            let moved = gained >= WORTH_A_MOVE;
            if !moved {
                share *= 0.5;
            }
        }
        best.with_price()
    }

    fn offer_disc(&self, best: &mut BestRegion, chains: &[Chain], disc: [f64; 3]) {
        let (sums, seconds) = self.sum(chains, |time_bin| time_bin.within(inside(disc)));
        if seconds >= SHORTEST {
            best.offer(Region::Place { disc }, self.score(&sums));
        }
    }

    /// The best line across the map.
    #[must_use]
    pub fn boundary(&self, chains: &[Chain]) -> Option<(Region, Score, f64)> {
        let mut best = BestRegion::default();
        for direction in (0..DIRECTIONS).map(|k| PI * k as f64 / DIRECTIONS as f64) {
            let (sin, cos) = direction.sin_cos();
            let along = |[x, y]: [f64; 2]| x * cos + y * sin;
            let time_bins = chains.iter().flat_map(|chain| &chain.time_bins);
            let mut places: Vec<f64> = time_bins.filter_map(TimeBin::place).map(along).collect();
            places.sort_by(f64::total_cmp);
            if self.deadline.is_over() {
                return None;
            }
            for k in 1..POSITIONS {
                let Some(&position) = places.get(k * places.len() / POSITIONS) else {
                    continue;
                };
                let beyond = |place: [f64; 2]| along(place) > position;
                let (sums, _) = self.sum(chains, |time_bin| time_bin.within(beyond));
                let extent = Region::Beyond {
                    direction,
                    position,
                };
                best.offer(extent, self.score(&sums));
            }
        }
        best.with_price()
    }
}

/// Whether a place lies in a disc.
fn inside([east, north, radius]: [f64; 3]) -> impl Fn([f64; 2]) -> bool {
    move |[x, y]| (x - east).hypot(y - north) < radius
}
