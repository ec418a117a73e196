//! Derivatives of the tracks that the wheels left: past states act on the present motion.

use super::{Simulation, State};
use crate::vehicle::{TRACK_SAMPLES, sample_size};
use nalgebra::DMatrix;
use std::collections::VecDeque;

/// For each sample that is kept the derivatives of its pose and depths (rows) by all that derivatives are taken by.
#[derive(Debug, Clone, Default)]
pub(super) struct SlopeHistory {
    samples: VecDeque<DMatrix<f64>>,
    /// Samples since the last restart that are in the history.
    begun: u64,
}

impl SlopeHistory {
    /// Begins anew.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.begun = 0;
    }

    /// Takes note of the sample that was left in the present state, if there is a new one.
    pub fn follow(
        &mut self,
        simulation: &Simulation,
        by: &DMatrix<f64>,
        depths: impl FnOnce() -> DMatrix<f64>,
    ) {
        let begun = simulation.left.begun();
        if begun == self.begun {
            return;
        }
        self.begun = begun;
        if self.samples.len() >= TRACK_SAMPLES {
            self.samples.pop_front();
        }
        let pose = by.rows(0, 3).into_owned();
        self.samples.push_back(sample(&pose, &depths()));
    }

    /// Takes note of the tracks that the vehicle came with, in poses with these derivatives by its state.
    pub fn came_here(
        &mut self,
        simulation: &Simulation,
        poses: &[[[f64; State::COUNT]; 3]],
        by: &DMatrix<f64>,
        depths: &DMatrix<f64>,
    ) {
        self.clear();
        for slopes in poses {
            let slopes = DMatrix::from_fn(3, State::COUNT, |i, j| slopes[i][j]);
            let pose = slopes * by.rows(0, State::COUNT);
            self.samples.push_back(sample(&pose, depths));
        }
        self.begun = simulation.left.begun();
    }

    /// What the tracks do to the rates of the state and of what is remembered, by so many columns; empty where
    /// there are none.
    pub fn rates(&self, simulation: &Simulation, rows: usize, columns: usize) -> DMatrix<f64> {
        if !simulation.model.has_ruts() {
            return DMatrix::zeros(0, 0);
        }
        let mut rates = DMatrix::zeros(rows, columns);
        for slope in simulation.track_slopes() {
            let place = simulation.model.rut_of(slope.wheel);
            // A sample that has just been left is taken note of with the next step.
            let Some((place, sample)) = place.zip(self.samples.get(slope.sample)) else {
                continue;
            };
            let mut rate = rates.row_mut(State::COUNT + place);
            let [by_pose @ .., by_depth] = slope.by;
            for (row, by) in by_pose.into_iter().enumerate() {
                rate += sample.row(row) * by;
            }
            rate += sample.row(3 + slope.left_by) * by_depth;
        }
        rates
    }
}

fn sample(pose: &DMatrix<f64>, depths: &DMatrix<f64>) -> DMatrix<f64> {
    let mut sample = DMatrix::zeros(sample_size(depths.nrows()), pose.ncols());
    sample.rows_mut(0, 3).copy_from(pose);
    sample.rows_mut(3, depths.nrows()).copy_from(depths);
    sample
}
