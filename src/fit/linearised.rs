//! A linearised problem: nothing is predicted any more.

use super::deadline::Deadline;
use super::noise::ChannelNoise;
use super::normal::{Normal, START};
use super::segment::Segment;
use super::signal::NoiseGroup;
use nalgebra::DVector;
use rayon::prelude::*;

/// How residuals are weighed.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseModel {
    /// Noise of each recording's channels, by [`NoiseGroup`].
    pub noise: Vec<[ChannelNoise; NoiseGroup::ALL.len()]>,
    /// Weight of each sample, by segment and channel.
    pub weights: Vec<Vec<Vec<f64>>>,
}

/// A segment's residuals, channel by channel: rows of residual, derivatives by the start and
/// derivatives by the coordinates that the segment depends on.
#[derive(Debug, Clone)]
pub struct Tables {
    /// A table per channel.
    pub channels: Vec<Vec<f64>>,
    /// Numbers in a row: 1 without derivatives.
    pub columns: usize,
}

impl Tables {
    /// Other residuals with these derivatives.
    #[must_use]
    pub fn with_residuals(&self, residuals: &Self) -> Self {
        let mut mixed = self.clone();
        for (table, new) in mixed.channels.iter_mut().zip(&residuals.channels) {
            let rows = table.chunks_exact_mut(self.columns);
            for (row, new) in rows.zip(new.chunks_exact(residuals.columns)) {
                row[0] = new[0];
            }
        }
        mixed
    }
}

/// Segments whose residuals and derivatives are known, and the priors at the point.
#[derive(Debug, Clone)]
pub struct Linearised<'a> {
    /// What was measured.
    pub segments: Vec<&'a Segment>,
    /// Start of each segment at the point.
    pub starts: Vec<[f64; START]>,
    /// For each recording the unknowns that the columns of its tables belong to.
    pub places: Vec<Vec<usize>>,
    /// Precision of each unknown's prior.
    pub precision: DVector<f64>,
    /// Pull of each unknown's prior.
    pub pull: DVector<f64>,
    /// When work on it has to end.
    pub deadline: Deadline<'a>,
}

impl Linearised<'_> {
    /// Normal equations of a segment, its start's prior among them.
    #[must_use]
    pub fn normal(&self, index: usize, tables: &Tables, by: &NoiseModel) -> Normal {
        let segment = self.segments[index];
        let places = &self.places[segment.recording];
        let mut normal = Normal::zeros(self.precision.len());
        add_segment(&mut normal, segment, index, places, tables, by);
        self.add_start_prior(index, &mut normal);
        normal
    }

    /// Normal equations of all segments.
    #[must_use]
    pub fn normals(&self, tables: &[Tables], by: &NoiseModel) -> Vec<Normal> {
        let all = tables.par_iter().enumerate();
        all.map(|(index, tables)| self.normal(index, tables, by))
            .collect()
    }

    /// The same with further unknowns, on which all segments depend by columns after their others; the precision of the
    /// prior of each is given, which has its middle here.
    #[must_use]
    pub fn with_further(mut self, precision: &[f64]) -> Self {
        let (count, more) = (self.precision.len(), precision.len());
        for places in &mut self.places {
            places.extend(count..count + more);
        }
        self.precision = self.precision.resize_vertically(count + more, 0.0);
        self.precision
            .rows_mut(count, more)
            .copy_from_slice(precision);
        self.pull = self.pull.resize_vertically(count + more, 0.0);
        self
    }

    /// Adds what is known of a segment's start.
    pub fn add_start_prior(&self, index: usize, normal: &mut Normal) {
        let (segment, start) = (self.segments[index], &self.starts[index]);
        let missing = std::array::from_fn(|k| segment.start_prior[k] - start[k]);
        normal.add_start_prior(&missing, &segment.start_deviation);
    }
}

/// Adds a segment's whitened residuals and derivatives.
pub(super) fn add_segment(
    normal: &mut Normal,
    segment: &Segment,
    index: usize,
    places: &[usize],
    tables: &Tables,
    by: &NoiseModel,
) {
    for (channel, samples) in segment.samples.iter().enumerate() {
        let mut table = tables.channels[channel].clone();
        let noise = by.noise[segment.recording][samples.signal.group() as usize];
        let weights = &by.weights[index][channel];
        noise.whiten(&samples.time, weights, tables.columns, &mut table);
        normal.add(&table, places);
    }
}
