//! Sets of gates, and how well a candidate that acts in one of them alone explains what is left.

use super::locate::{Extent, Stretch};
use super::screen::{Projected, Projection, Score};
use super::system::System;
use crate::diagnosis::hypothesis::Given;
use crate::diagnosis::hypothesis::maps::Maps;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Shorter intervals are not told from outliers, longer ones from the whole drive \[s\].
const SHORTEST: f64 = 1.9;
const LONGEST: f64 = 40.0;
/// Radii of discs \[m\].
const RADII: [f64; 4] = [1.5, 3.0, 5.0, 8.0];
/// The best disc is moved and resized by this share of its radius at first, and down to that one, while it gains
/// more than so much.
const FIRST_MOVE: f64 = 0.3;
const LAST_MOVE: f64 = 0.05;
const WORTH_A_MOVE: f64 = 0.5;
/// Directions of lines, and places of each.
const DIRECTIONS: usize = 12;
const POSITIONS: usize = 24;

/// One gate.
#[derive(Debug, Clone, Copy)]
pub struct Gate {
    /// Place among the system's segments, and within the segment.
    segment: usize,
    gate: usize,
    start: f64,
    end: f64,
    place: Option<[f64; 2]>,
}

/// Gates of a run that follow one another without a gap.
pub struct Chain {
    recording: usize,
    run: usize,
    gates: Vec<Gate>,
}

/// A candidate's equations gate by gate.
pub struct Gated {
    /// Columns within a gate, each with a factor.
    pub columns: Vec<(usize, f64)>,
    /// Its unknowns.
    pub unknowns: Vec<usize>,
}

/// Gates in their order, run by run.
#[must_use]
pub fn chains(given: &Given, system: &System) -> Vec<Chain> {
    let mut chains: Vec<Chain> = Vec::new();
    for (place, segment) in system.segments.iter().enumerate() {
        let data = &given.segments[segment.index];
        let follows = chains.last().is_some_and(|chain| {
            let end = chain.gates.last().map(|gate| gate.end);
            (chain.recording, chain.run) == (data.recording, data.run)
                && end.is_some_and(|end| (end - segment.edges[0]).abs() < 1e-9)
        });
        if !follows {
            chains.push(Chain {
                recording: data.recording,
                run: data.run,
                gates: Vec::new(),
            });
        }
        let run = &given.recordings[data.recording].runs[data.run];
        let at = |channel, time| run.series(channel).and_then(|series| series.at(time));
        let Some(chain) = chains.last_mut() else {
            continue;
        };
        for (gate, edges) in segment.edges.windows(2).enumerate() {
            let middle = 0.5 * (edges[0] + edges[1]);
            let x = at(crate::recording::Channel::X, middle);
            let y = at(crate::recording::Channel::Y, middle);
            chain.gates.push(Gate {
                segment: place,
                gate,
                start: edges[0],
                end: edges[1],
                place: x
                    .zip(y)
                    .filter(|_| given.maps == Maps::One)
                    .map(|(x, y)| [x, y]),
            });
        }
    }
    chains
}

/// Discs along the paths, none twice.
#[must_use]
pub fn discs(chains: &[Chain]) -> Vec<[f64; 3]> {
    let mut discs: Vec<[f64; 3]> = Vec::new();
    for radius in RADII {
        let first = discs.len();
        for gate in chains.iter().flat_map(|chain| &chain.gates) {
            let Some([x, y]) = gate.place else { continue };
            let near = |disc: &[f64; 3]| (disc[0] - x).hypot(disc[1] - y) < 0.5 * radius;
            if !discs[first..].iter().any(near) {
                discs.push([x, y, radius]);
            }
        }
    }
    discs
}

/// A candidate, and what every set of gates is judged by.
pub struct Scan<'a> {
    /// The linearised problem.
    pub system: &'a System,
    /// Soil and what is on, projected out.
    pub projection: &'a Projection<'a>,
    /// For each recording the columns of the nuisance.
    pub nuisance: &'a [Vec<Option<usize>>],
    /// The nuisance's inverse matrix.
    pub inverse: &'a DMatrix<f64>,
    /// The nuisance's step to where its pulls vanish.
    pub settled: &'a DVector<f64>,
    /// The candidate.
    pub gated: Gated,
}

/// The best set so far, and how many were looked at.
#[derive(Default)]
struct Best {
    found: Option<(Extent, Score)>,
    looked_at: u32,
}

impl Best {
    fn offer(&mut self, extent: Extent, score: Score) {
        self.looked_at += 1;
        let best = self.found.as_ref();
        if best.is_none_or(|(_, best)| score.evidence > best.evidence) {
            self.found = Some((extent, score));
        }
    }

    /// With the evidence less what looking in so many places costs.
    fn of_looked_at(self) -> Option<(Extent, Score, f64)> {
        let (extent, score) = self.found?;
        let evidence = score.evidence - f64::from(self.looked_at).ln();
        Some((extent, score, evidence))
    }
}

/// Sums over a set of gates.
#[derive(Debug, Clone)]
struct Sums {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    cross: DMatrix<f64>,
}

impl Scan<'_> {
    fn nothing(&self) -> Sums {
        let (count, nuisance) = (self.gated.columns.len(), self.settled.len());
        Sums {
            matrix: DMatrix::zeros(count, count),
            gradient: DVector::zeros(count),
            cross: DMatrix::zeros(count, nuisance),
        }
    }

    /// Adds a gate to a set; `before` are the set's gates of the same segment.
    fn add(&self, sums: &mut Sums, gate: &Gate, before: impl Iterator<Item = usize> + Clone) {
        let segment = &self.system.segments[gate.segment];
        let layout = &self.system.layout;
        let first = |gate: usize| layout.whole() + gate * layout.per_gate();
        let nuisance = &self.nuisance[segment.recording];
        for (i, (a, factor)) in self.gated.columns.iter().enumerate() {
            let row = first(gate.gate) + a;
            sums.gradient[i] += factor * segment.gradient[row];
            for (j, column) in nuisance.iter().enumerate() {
                if let Some(column) = column {
                    sums.cross[(i, j)] += factor * segment.matrix[(row, *column)];
                }
            }
            for (j, (b, other_factor)) in self.gated.columns.iter().enumerate() {
                let column = first(gate.gate) + b;
                let mut sum = segment.matrix[(row, column)];
                for other in before.clone() {
                    sum += segment.matrix[(row, first(other) + b)];
                    sum += segment.matrix[(first(other) + a, column)];
                }
                sums.matrix[(i, j)] += factor * other_factor * sum;
            }
        }
    }

    /// The one-step fit of a set.
    fn score(&self, sums: &Sums) -> Score {
        let projected = Projected {
            unknowns: self.gated.unknowns.clone(),
            matrix: &sums.matrix - &sums.cross * self.inverse * sums.cross.transpose(),
            gradient: &sums.gradient - &sums.cross * self.settled,
            raw: sums.matrix.clone(),
        };
        self.projection.score_with(&projected, 1.0)
    }

    /// Sums over the gates that lie somewhere, and the seconds that they last.
    fn sum(&self, chains: &[Chain], inside: impl Fn(&Gate) -> bool) -> (Sums, f64) {
        let mut sums = self.nothing();
        let mut seconds = 0.0;
        for chain in chains {
            let set: Vec<&Gate> = chain.gates.iter().filter(|gate| inside(gate)).collect();
            for (index, gate) in set.iter().enumerate() {
                let before = set[..index].iter().rev();
                let before = before.take_while(|other| other.segment == gate.segment);
                self.add(&mut sums, gate, before.map(|other| other.gate));
                seconds += gate.end - gate.start;
            }
        }
        (sums, seconds)
    }

    /// The best interval of any run.
    #[must_use]
    pub fn intervals(&self, chains: &[Chain]) -> Option<(Extent, Score, f64)> {
        let mut best = Best::default();
        for chain in chains {
            for (from, begin) in chain.gates.iter().enumerate() {
                let mut sums = self.nothing();
                for (to, gate) in chain.gates.iter().enumerate().skip(from) {
                    let length = gate.end - begin.start;
                    if length > LONGEST {
                        break;
                    }
                    let before = chain.gates[from..to].iter().rev();
                    let before = before.take_while(|other| other.segment == gate.segment);
                    self.add(&mut sums, gate, before.map(|other| other.gate));
                    if length < SHORTEST {
                        continue;
                    }
                    let extent = Extent::Time(Stretch {
                        recording: chain.recording,
                        run: chain.run,
                        start: begin.start,
                        end: gate.end,
                    });
                    best.offer(extent, self.score(&sums));
                }
            }
        }
        best.of_looked_at()
    }

    /// The best run, of several, from its beginning to its end.
    #[must_use]
    pub fn runs(&self, chains: &[Chain]) -> Option<(Extent, Score, f64)> {
        let runs: Vec<&[Chain]> = chains
            .chunk_by(|a, b| (a.recording, a.run) == (b.recording, b.run))
            .collect();
        if runs.len() < 2 {
            return None;
        }
        let mut best = Best::default();
        for run in runs {
            let mut gates = run.iter().flat_map(|chain| &chain.gates);
            let (Some(first), Some(last)) = (gates.next(), gates.next_back()) else {
                continue;
            };
            let extent = Extent::Run(Stretch {
                recording: run[0].recording,
                run: run[0].run,
                start: first.start,
                end: last.end,
            });
            best.offer(extent, self.score(&self.sum(run, |_| true).0));
        }
        best.of_looked_at()
    }

    /// The best disc, moved and resized until that gains nothing more.
    #[must_use]
    pub fn discs(&self, chains: &[Chain], discs: &[[f64; 3]]) -> Option<(Extent, Score, f64)> {
        let mut best = Best::default();
        for disc in discs {
            self.offer_disc(&mut best, chains, *disc);
        }
        let mut share = FIRST_MOVE;
        while share > LAST_MOVE {
            let (Extent::Place { disc }, before) = best.found.clone()? else {
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
        best.of_looked_at()
    }

    fn offer_disc(&self, best: &mut Best, chains: &[Chain], disc: [f64; 3]) {
        let (sums, seconds) = self.sum(chains, |gate| {
            let away = gate.place.map(|[x, y]| (x - disc[0]).hypot(y - disc[1]));
            away.is_some_and(|away| away < disc[2])
        });
        if seconds >= SHORTEST {
            best.offer(Extent::Place { disc }, self.score(&sums));
        }
    }

    /// The best line across the map.
    #[must_use]
    pub fn boundary(&self, chains: &[Chain]) -> Option<(Extent, Score, f64)> {
        let mut best = Best::default();
        for direction in (0..DIRECTIONS).map(|k| PI * k as f64 / DIRECTIONS as f64) {
            let (sin, cos) = direction.sin_cos();
            let along = |gate: &Gate| gate.place.map(|[x, y]| x * cos + y * sin);
            let gates = chains.iter().flat_map(|chain| &chain.gates);
            let mut places: Vec<f64> = gates.filter_map(along).collect();
            places.sort_by(f64::total_cmp);
            for k in 1..POSITIONS {
                let Some(&position) = places.get(k * places.len() / POSITIONS) else {
                    continue;
                };
                let beyond = |gate: &Gate| along(gate).is_some_and(|at| at > position);
                let (sums, _) = self.sum(chains, beyond);
                let extent = Extent::Beyond {
                    direction,
                    position,
                };
                best.offer(extent, self.score(&sums));
            }
        }
        best.of_looked_at()
    }
}
