//! The noise under the richest model, so that a missing effect does not count as noise.
//!
//! All candidates are integrated out together with soil and starts (restricted likelihood, see
//! [`crate::fit::noise_estimate`]); otherwise the noise, slow noise above all, would absorb the missing effect. So is
//! an unmodelled force in the interval in which it explains most: a disturbance of some seconds looks like slow
//! noise. Candidates point in few directions; those combinations are kept, in units of their priors, of which the
//! recordings contain information.

use super::locate::{in_time, scanned};
use super::region::Region;
use super::screen::Projection;
use super::sensitivity::SegmentTable;
use super::system::System;
use super::wrench::force_columns;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::fit::linearised::Linearised;
use crate::fit::noise_estimate;
use crate::fit::normal::START;
use crate::fit::problem::{NoiseModel, Tables};
use crate::fit::segment::Segment;
use nalgebra::{DMatrix, DVector};

/// Combinations with less information are dropped, in units of the prior's precision.
const TOLD: f64 = 0.3;

/// An unmodelled force with less evidence, the choice of its interval not counted, is neglected.
const FAINT: f64 = 4.0;

/// The interval in which an unmodelled force explains most.
fn push(problem: &Problem, system: &System, at: &Solution) -> Option<(Region, [usize; 3])> {
    let projection = Projection::over_all(system, &[])?;
    let mut candidates = scanned(problem, system, &at.soil, &[]);
    candidates.retain(|one| one.subject == Subject::Unknown);
    let found = in_time(problem, system, &projection, &candidates);
    let mut found = found
        .into_iter()
        .filter(|found| found.score.evidence > FAINT);
    Some((
        found.next()?.extent,
        force_columns(problem, &system.layout)?,
    ))
}

/// Re-estimates the noise.
pub fn update(
    problem: &Problem,
    system: &System,
    tables: &[Option<SegmentTable>],
    at: &Solution,
    noise: &mut NoiseModel,
) {
    let push = push(problem, system, at);
    let extra = push.as_ref().map_or(0, |(_, columns)| columns.len());
    let count = system.precision.len();
    let all: Vec<usize> = (0..count).collect();
    let (matrix, _) = system.sum(&all, system.segments.iter());
    let unit = system.precision.map(|precision| precision.sqrt().recip());
    let scaled = DMatrix::from_fn(count, count, |i, j| matrix[(i, j)] * unit[i] * unit[j]);
    let eigen = scaled.symmetric_eigen();
    let kept: Vec<usize> = (0..count)
        .filter(|k| eigen.eigenvalues[*k] > TOLD)
        .collect();
    // Columns: combinations; rows: unknowns.
    let basis = DMatrix::from_fn(count, kept.len(), |i, k| {
        unit[i] * eigen.eigenvectors[(i, kept[k])]
    });
    let known: Vec<usize> = (0..tables.len()).filter(|k| tables[*k].is_some()).collect();
    let shooting = Linearised {
        segments: known.iter().map(|k| &problem.segments[*k]).collect(),
        starts: known.iter().map(|k| at.starts[*k]).collect(),
        places: vec![(0..kept.len() + extra).collect(); problem.recordings.len()],
        precision: DVector::repeat(kept.len() + extra, 1.0),
        pull: basis
            .tr_mul(&system.pull)
            .resize_vertically(kept.len() + extra, 0.0),
        deadline: problem.deadline,
    };
    let combined: Vec<Tables> = known
        .iter()
        .filter_map(|k| {
            let recording = problem.segments[*k].recording;
            let table = tables[*k].as_ref()?;
            let own = push.as_ref().map(|(extent, columns)| WindowedForce {
                time_bins: open(extent, &problem.segments[*k], &table.edges),
                columns: *columns,
                per_bin: system.layout.per_bin(),
                table,
            });
            Some(combine(
                &table.whole,
                &system.places[recording],
                &basis,
                own.as_ref(),
            ))
        })
        .collect();
    let mut noise_model = noise.of(&known);
    noise_estimate::update(&shooting, &combined, &mut noise_model, None);
    noise.noise = noise_model.noise;
}

/// An unmodelled force in some time bins of a segment.
struct WindowedForce<'a> {
    time_bins: Vec<usize>,
    columns: [usize; 3],
    per_bin: usize,
    table: &'a SegmentTable,
}

/// Unit of an unmodelled force, as a share of the weight: its prior's deviation.
const SHARE: f64 = 0.05;

impl WindowedForce<'_> {
    /// Derivatives of a sample by the unmodelled force's components.
    fn of(&self, channel: usize, row: usize) -> [f64; 3] {
        let width = self.per_bin * (self.table.edges.len() - 1);
        let binned = &self.table.binned[channel][row * width..(row + 1) * width];
        self.columns.map(|column| {
            let each = self.time_bins.iter();
            SHARE
                * each
                    .map(|time_bin| binned[time_bin * self.per_bin + column])
                    .sum::<f64>()
        })
    }
}

/// The time bins of a segment that lie within an interval.
fn open(extent: &Region, segment: &Segment, edges: &[f64]) -> Vec<usize> {
    let Region::Time(at) = *extent else {
        return Vec::new();
    };
    let within = |time_bin: &usize| {
        let middle = 0.5 * (edges[*time_bin] + edges[time_bin + 1]);
        (segment.recording, segment.run) == (at.recording, at.run)
            && (at.start..at.end).contains(&middle)
    };
    (0..edges.len() - 1).filter(within).collect()
}

/// Columns of residual and start, then the combinations, then the force.
fn combine(
    tables: &Tables,
    places: &[Option<usize>],
    basis: &DMatrix<f64>,
    push: Option<&WindowedForce>,
) -> Tables {
    let channel = |(index, channel): (usize, &Vec<f64>)| {
        let mut combined = Vec::new();
        for (number, row) in channel.chunks_exact(tables.columns).enumerate() {
            let (own, rest) = row.split_at(1 + START);
            combined.extend(own);
            let mut sums = DVector::zeros(basis.ncols());
            for (value, place) in rest.iter().zip(places) {
                if let Some(place) = place {
                    sums.axpy(*value, &basis.row(*place).transpose(), 1.0);
                }
            }
            combined.extend(sums.iter());
            if let Some(push) = push {
                combined.extend(push.of(index, number));
            }
        }
        combined
    };
    let extra = push.map_or(0, |push| push.columns.len());
    Tables {
        channels: tables.channels.iter().enumerate().map(channel).collect(),
        columns: 1 + START + basis.ncols() + extra,
    }
}
