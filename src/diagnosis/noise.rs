//! The noise under the richest model: what any candidate can explain is no noise.
//!
//! All candidates are integrated out together with soil and starts (restricted likelihood, see
//! [`crate::fit::noise_estimate`]); otherwise the noise, slow noise above all, would take up what is
//! missing. Most candidates point in few directions: those combinations are kept, in units of their
//! priors, that these recordings tell anything about.

use super::hypothesis::{Given, Solution};
use super::sensitivity::SegmentTable;
use super::system::System;
use crate::fit::linearised::Linearised;
use crate::fit::noise_estimate;
use crate::fit::normal::START;
use crate::fit::problem::{Tables, Weighing};
use nalgebra::{DMatrix, DVector};

/// A combination is kept from this information on, in units of its prior's precision.
const TOLD: f64 = 0.3;

/// Estimates the noise anew.
pub fn update(
    given: &Given,
    system: &System,
    tables: &[Option<SegmentTable>],
    at: &Solution,
    by: &mut Weighing,
) {
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
    let problem = Linearised {
        segments: known.iter().map(|k| &given.segments[*k]).collect(),
        starts: known.iter().map(|k| at.starts[*k]).collect(),
        places: vec![(0..kept.len()).collect(); given.recordings.len()],
        precision: DVector::repeat(kept.len(), 1.0),
        pull: basis.tr_mul(&system.pull),
    };
    let combined: Vec<Tables> = known
        .iter()
        .filter_map(|k| {
            let recording = given.segments[*k].recording;
            let whole = &tables[*k].as_ref()?.whole;
            Some(combine(whole, &system.places[recording], &basis))
        })
        .collect();
    let mut weighing = Weighing {
        noise: by.noise.clone(),
        weights: known.iter().map(|k| by.weights[*k].clone()).collect(),
    };
    noise_estimate::update(&problem, &combined, &mut weighing);
    by.noise = weighing.noise;
}

/// Residual and start as they are, then the combinations.
fn combine(tables: &Tables, places: &[Option<usize>], basis: &DMatrix<f64>) -> Tables {
    let channel = |channel: &Vec<f64>| {
        let mut combined = Vec::new();
        for row in channel.chunks_exact(tables.columns) {
            let (own, rest) = row.split_at(1 + START);
            combined.extend(own);
            let mut sums = DVector::zeros(basis.ncols());
            for (value, place) in rest.iter().zip(places) {
                if let Some(place) = place {
                    sums.axpy(*value, &basis.row(*place).transpose(), 1.0);
                }
            }
            combined.extend(sums.iter());
        }
        combined
    };
    Tables {
        channels: tables.channels.iter().map(channel).collect(),
        columns: 1 + START + basis.ncols(),
    }
}
