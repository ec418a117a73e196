//! The linearised problem: normal equations of every segment, its start eliminated, by the soil and
//! every candidate, whole and bin by bin.

use super::sensitivity::{Layout, SegmentTable};
use crate::diagnosis::hypothesis::{Problem, Solution, UnknownKind};
use crate::fit::noise_model::reweigh;
use crate::fit::normal::START;
use crate::fit::parameter::FreeParameter;
use crate::fit::problem::{NoiseModel, Tables};
use crate::fit::segment::SAME_TIME;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use rayon::prelude::*;
use std::ops::Range;

/// Normal equations of all segments.
#[derive(Debug, Clone)]
pub struct System {
    /// All unknowns: the soil, the coefficients (one per recording where each has its own).
    pub parameters: Vec<FreeParameter>,
    /// For each recording the unknown of each whole column: soil, then coefficients; `None` without information.
    pub places: Vec<Vec<Option<usize>>>,
    /// Precision of the priors.
    pub precision: DVector<f64>,
    /// Pull of the priors at the point.
    pub pull: DVector<f64>,
    /// The segments.
    pub segments: Vec<SegmentSystem>,
    /// Columns.
    pub layout: Layout,
}

/// A segment's normal equations by its own columns: whole ones, then the binned ones bin by bin.
#[derive(Debug, Clone)]
pub struct SegmentSystem {
    /// Index among the problem's segments.
    pub index: usize,
    /// Which recording.
    pub recording: usize,
    /// Matrix, J^T S J with the start eliminated.
    pub matrix: DMatrix<f64>,
    /// Pull, J^T S r with the start eliminated.
    pub gradient: DVector<f64>,
    /// Squared whitened residuals after elimination of the start.
    pub cost: f64,
    /// Where time bins start and end \[s\].
    pub edges: Vec<f64>,
}

/// The normal equations of all segments; of some where the deadline has passed.
#[must_use]
pub fn linearise(
    problem: &Problem,
    layout: &Layout,
    tables: &[Option<SegmentTable>],
    at: &Solution,
    noise: &NoiseModel,
) -> System {
    let coefficients: Vec<usize> = (0..problem.candidates.coefficients.len()).collect();
    let predictor = problem.predictor(&coefficients);
    let shooting = problem.shooting(&predictor, &coefficients);
    let mut places = vec![vec![None; layout.whole()]; problem.recordings.len()];
    problem.visit(&shooting, &coefficients, |place, recording, what| {
        let column = match what {
            UnknownKind::Soil(index) => index,
            UnknownKind::CandidateParameter(coefficient) => layout.soil + coefficient,
        };
        places[recording][column] = Some(place);
    });
    let point = problem.point(&shooting, &coefficients, at);
    let one = |(index, table): (usize, &Option<SegmentTable>)| {
        let table = table.as_ref().filter(|_| !problem.deadline.is_over())?;
        segment(problem, layout, index, table, &at.starts[index], noise)
    };
    let segments: Vec<Option<SegmentSystem>> = tables.par_iter().enumerate().map(one).collect();
    let (precision, pull) = shooting.prior(&point.coordinates);
    System {
        precision,
        pull,
        parameters: shooting.parameters,
        places,
        segments: segments.into_iter().flatten().collect(),
        layout: layout.clone(),
    }
}

/// Weights at the residuals of a fitted hypothesis.
pub fn weigh(problem: &Problem, coefficients: &[usize], tables: &[Tables], noise: &mut NoiseModel) {
    let predictor = problem.predictor(coefficients);
    let shooting = problem.shooting(&predictor, coefficients);
    reweigh(&shooting, tables, noise);
}

fn segment(
    problem: &Problem,
    layout: &Layout,
    index: usize,
    table: &SegmentTable,
    start: &[f64; START],
    noise: &NoiseModel,
) -> Option<SegmentSystem> {
    let segment = &problem.segments[index];
    let binned = layout.per_bin() * (table.edges.len() - 1);
    let width = table.whole.columns + binned;
    let local = width - 1 - START;
    let mut normal = DMatrix::<f64>::zeros(width, width);
    for (channel, data) in segment.samples.iter().enumerate() {
        let whole = table.whole.channels[channel].chunks_exact(table.whole.columns);
        let rows = data.time.len();
        let mut cells = Vec::with_capacity(rows * width);
        for (row, whole) in whole.enumerate() {
            cells.extend(whole);
            cells.extend(&table.binned[channel][row * binned..(row + 1) * binned]);
        }
        let channel_noise = noise.noise[segment.recording][data.signal.group() as usize];
        channel_noise.whiten(
            &data.time,
            &noise.weights[index][channel],
            width,
            &mut cells,
        );
        let rows = DMatrix::from_vec(width, rows, cells);
        normal.gemm(1.0, &rows, &rows.transpose(), 1.0);
    }
    let mut by_start: SMatrix<f64, START, START> =
        normal.fixed_view::<START, START>(1, 1).into_owned();
    let mut pull: SVector<f64, START> = normal.fixed_view::<START, 1>(1, 0).into_owned();
    let mut cost = normal[(0, 0)];
    for k in 0..START {
        let precision = segment.start_deviation[k].powi(-2);
        let missing = segment.start_prior[k] - start[k];
        by_start[(k, k)] += precision;
        pull[k] += precision * missing;
        cost += precision * missing * missing;
    }
    let cross = normal.view((1, 1 + START), (START, local)).into_owned();
    let factor = by_start.cholesky()?;
    let solved = factor.solve(&cross);
    let moved = factor.solve(&pull);
    let own = normal.view((1 + START, 1 + START), (local, local));
    let gradient = normal
        .view((1 + START, 0), (local, 1))
        .column(0)
        .into_owned();
    let system = SegmentSystem {
        index,
        recording: segment.recording,
        matrix: own - cross.tr_mul(&solved),
        gradient: gradient - cross.tr_mul(&moved),
        cost: cost - pull.dot(&moved),
        edges: table.edges.clone(),
    };
    let finite = system.cost.is_finite() && system.matrix.iter().all(|v| v.is_finite());
    finite.then_some(system)
}

impl SegmentSystem {
    /// Number of time bins.
    #[must_use]
    pub fn time_bins(&self) -> usize {
        self.edges.len() - 1
    }

    /// Whether the other starts at its end.
    #[must_use]
    pub fn joins(&self, next: &Self) -> bool {
        let apart = self.edges.last().zip(next.edges.first());
        apart.is_some_and(|(end, start)| (start - end).abs() < SAME_TIME)
    }
}

impl System {
    /// Unknowns of a coefficient: one, or one for each recording.
    #[must_use]
    pub fn unknowns(&self, coefficient: usize) -> Vec<usize> {
        let column = self.layout.soil + coefficient;
        let each = self.places.iter().filter_map(|places| places[column]);
        let mut found: Vec<usize> = each.collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// A step of these unknowns from the steps of coefficients by recording.
    #[must_use]
    pub fn step(
        &self,
        unknowns: &[usize],
        coefficients: &[usize],
        value: impl Fn(usize, usize) -> f64,
    ) -> DVector<f64> {
        let mut step = DVector::zeros(unknowns.len());
        for (recording, places) in self.places.iter().enumerate() {
            for coefficient in coefficients {
                let unknown = places[self.layout.soil + coefficient];
                if let Some(place) = unknowns.iter().position(|u| Some(*u) == unknown) {
                    step[place] = value(*coefficient, recording);
                }
            }
        }
        step
    }

    /// Appends unknowns that act along combinations of each segment's columns: a matrix for each segment, with a row
    /// for each of its columns. They stand between the whole columns and the binned ones.
    pub fn append(&mut self, combinations: &[DMatrix<f64>], unknowns: Vec<FreeParameter>) {
        let (whole, count) = (self.layout.whole(), unknowns.len());
        for (segment, combination) in self.segments.iter_mut().zip(combinations) {
            let bent = &segment.matrix * combination;
            let own = combination.tr_mul(&bent);
            let pull = combination.tr_mul(&segment.gradient);
            let size = segment.gradient.len();
            let mut matrix = std::mem::take(&mut segment.matrix)
                .insert_rows(whole, count, 0.0)
                .insert_columns(whole, count, 0.0);
            let place = |k: usize| if k < whole { k } else { k + count };
            for k in 0..size {
                for new in 0..count {
                    matrix[(place(k), whole + new)] = bent[(k, new)];
                    matrix[(whole + new, place(k))] = bent[(k, new)];
                }
            }
            matrix
                .view_mut((whole, whole), (count, count))
                .copy_from(&own);
            segment.matrix = matrix;
            let gradient = std::mem::take(&mut segment.gradient);
            segment.gradient = gradient.insert_rows(whole, count, 0.0);
            segment.gradient.rows_mut(whole, count).copy_from(&pull);
        }
        let first = self.parameters.len();
        for places in &mut self.places {
            places.extend((first..first + count).map(Some));
        }
        let precision = unknowns.iter().map(|one| one.prior.deviation.powi(-2));
        let precision = self.precision.iter().copied().chain(precision);
        self.precision = DVector::from_vec(precision.collect());
        // Off, where their priors pull them.
        self.pull = self.pull.clone().insert_rows(first, count, 0.0);
        self.parameters.extend(unknowns);
        self.layout.appended += count;
    }

    /// Unknowns of the soil.
    #[must_use]
    pub fn soil(&self) -> Range<usize> {
        0..self.layout.soil
    }

    /// Sums of some segments' equations over these unknowns.
    #[must_use]
    pub fn sum<'a>(
        &self,
        unknowns: &[usize],
        segments: impl Iterator<Item = &'a SegmentSystem>,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let count = unknowns.len();
        let (mut matrix, mut gradient) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for segment in segments {
            let columns = self.columns(segment.recording, unknowns);
            for (i, a) in columns.iter().enumerate() {
                let Some(a) = a else { continue };
                gradient[i] += segment.gradient[*a];
                for (j, b) in columns.iter().enumerate() {
                    if let Some(b) = b {
                        matrix[(i, j)] += segment.matrix[(*a, *b)];
                    }
                }
            }
        }
        (matrix, gradient)
    }

    /// A recording's columns of some unknowns.
    #[must_use]
    pub fn columns(&self, recording: usize, unknowns: &[usize]) -> Vec<Option<usize>> {
        let places = &self.places[recording];
        let column = |unknown: &usize| places.iter().position(|p| p == &Some(*unknown));
        unknowns.iter().map(column).collect()
    }
}
