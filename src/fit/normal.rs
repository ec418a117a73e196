//! Normal equations of one segment, and of all by Schur's complement.
//!
//! A segment's unknowns are its start x (six of them, its own) and the parameters q (shared).
//! Of the normal equations
//! [A B; B^T C] [dx; dq] = [g; h], the starts are eliminated segment by segment:
//! (sum C - B^T A^-1 B) dq = sum h - B^T A^-1 g, then dx = A^-1 (g - B dq);
//! the cost is linear in the number of segments (as in bundle adjustment: B. Triggs et al.,
//! "Bundle adjustment — a modern synthesis", 2000, section 6.1).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SMatrix, SVector};
use rayon::prelude::*;

/// Components of a start.
pub const START: usize = 6;
type StartMatrix = SMatrix<f64, START, START>;
type StartVector = SVector<f64, START>;

/// Normal equations of a segment: sums over its whitened residuals and their derivatives.
#[derive(Debug, Clone)]
pub struct Normal {
    /// A, by start and start.
    pub by_start: StartMatrix,
    /// B, by start and parameters.
    pub cross: DMatrix<f64>,
    /// C, by parameters and parameters.
    pub by_parameters: DMatrix<f64>,
    /// g, by the start.
    pub start_gradient: StartVector,
    /// h, by the parameters.
    pub gradient: DVector<f64>,
    /// Sum of the squares.
    pub cost: f64,
}

impl Normal {
    /// No residual yet.
    #[must_use]
    pub fn zeros(parameters: usize) -> Self {
        Self {
            by_start: StartMatrix::zeros(),
            cross: DMatrix::zeros(START, parameters),
            by_parameters: DMatrix::zeros(parameters, parameters),
            start_gradient: StartVector::zeros(),
            gradient: DVector::zeros(parameters),
            cost: 0.0,
        }
    }

    /// Adds whitened rows: each the residual, its derivatives by the start, and those by the
    /// segment's own choice of parameters, whose places among all are given, each once.
    pub fn add(&mut self, table: &[f64], places: &[usize]) {
        let columns = 1 + START + places.len();
        // All products of two columns, the lower triangle row by row.
        let pairs = || (0..columns).flat_map(|a| (0..=a).map(move |b| (a, b)));
        let mut sums: Vec<f64> = pairs().map(|(a, b)| *self.sum(places, a, b)).collect();
        for row in table.chunks_exact(columns) {
            let mut rest = sums.as_mut_slice();
            for (a, value) in row.iter().enumerate() {
                let (own, after) = rest.split_at_mut(a + 1);
                for (sum, other) in own.iter_mut().zip(row) {
                    *sum += value * other;
                }
                rest = after;
            }
        }
        for ((a, b), sum) in pairs().zip(sums) {
            *self.sum(places, a, b) = sum;
        }
        self.by_start.fill_upper_triangle_with_lower_triangle();
        self.by_parameters.fill_upper_triangle_with_lower_triangle();
    }

    /// The sum of the products of two columns of a table, the second of which is not behind the first.
    fn sum(&mut self, places: &[usize], a: usize, b: usize) -> &mut f64 {
        let parameter = |column: usize| places[column - 1 - START];
        match (a, b) {
            (0, _) => &mut self.cost,
            (..=START, 0) => &mut self.start_gradient[a - 1],
            (..=START, _) => &mut self.by_start[(a - 1, b - 1)],
            (_, 0) => &mut self.gradient[parameter(a)],
            (_, ..=START) => &mut self.cross[(b - 1, parameter(a))],
            _ => {
                let (a, b) = (parameter(a), parameter(b));
                &mut self.by_parameters[(a.max(b), a.min(b))]
            }
        }
    }

    /// The sum of the squares after a step of the start and of the parameters.
    #[must_use]
    pub fn cost_after(&self, start: &[f64; START], parameters: &DVector<f64>) -> f64 {
        let start = StartVector::from_row_slice(start);
        let by_start = self.by_start * start + &self.cross * parameters;
        let by_parameters = &self.by_parameters * parameters + self.cross.tr_mul(&start);
        self.cost
            + start.dot(&(by_start - 2.0 * self.start_gradient))
            + parameters.dot(&(by_parameters - 2.0 * &self.gradient))
    }

    /// Adds what is known of the start: its distance from the prior's mean.
    pub fn add_start_prior(&mut self, missing: &[f64; START], deviation: &[f64; START]) {
        for k in 0..START {
            let precision = deviation[k].powi(-2);
            self.by_start[(k, k)] += precision;
            self.start_gradient[k] += precision * missing[k];
            self.cost += precision * missing[k] * missing[k];
        }
    }
}

/// A segment with its start eliminated.
#[derive(Debug, Clone)]
pub struct Eliminated {
    factor: Cholesky<f64, nalgebra::Const<START>>,
    /// C - B^T A^-1 B.
    pub matrix: DMatrix<f64>,
    /// h - B^T A^-1 g: the segment's pull on the parameters, its start following them.
    pub gradient: DVector<f64>,
    /// How much the cost falls when the start alone moves.
    pub start_gain: f64,
}

impl Eliminated {
    /// Eliminates the start, its diagonal raised by the share `damping`. `None` where the
    /// numbers are not finite.
    #[must_use]
    pub fn new(normal: &Normal, damping: f64) -> Option<Self> {
        let mut by_start = normal.by_start;
        for k in 0..START {
            by_start[(k, k)] *= 1.0 + damping;
        }
        let factor = by_start.cholesky()?;
        let solved = factor.solve(&normal.cross);
        let start = factor.solve(&normal.start_gradient);
        Some(Self {
            matrix: &normal.by_parameters - normal.cross.tr_mul(&solved),
            gradient: &normal.gradient - normal.cross.tr_mul(&start),
            start_gain: normal.start_gradient.dot(&start),
            factor,
        })
    }

    /// The step of the start that belongs to a step of the parameters.
    #[must_use]
    pub fn start_step(&self, normal: &Normal, step: &DVector<f64>) -> [f64; START] {
        let cross = &normal.cross * step;
        let rest = normal.start_gradient - StartVector::from_iterator(cross.iter().copied());
        self.factor.solve(&rest).into()
    }

    /// Logarithm of the determinant of A.
    #[must_use]
    pub fn log_determinant(&self) -> f64 {
        2.0 * self.factor.l_dirty().diagonal().map(f64::ln).sum()
    }
}

/// Normal equations of the parameters: the starts eliminated, the priors added.
#[derive(Debug, Clone)]
pub struct Reduced {
    /// By parameters and parameters.
    pub matrix: DMatrix<f64>,
    /// By the parameters.
    pub gradient: DVector<f64>,
    /// The segments.
    pub each: Vec<Eliminated>,
}

impl Reduced {
    /// The equations of these segments and of a prior with this precision and pull, see [`Eliminated::new`]. `None` where
    /// numbers are not finite.
    #[must_use]
    pub fn new(
        normals: &[Normal],
        precision: &DVector<f64>,
        pull: &DVector<f64>,
        damping: f64,
    ) -> Option<Self> {
        let each = normals.par_iter();
        let each = each.map(|normal| Eliminated::new(normal, damping));
        let each: Vec<Eliminated> = each.collect::<Option<_>>()?;
        let mut matrix = DMatrix::from_diagonal(precision);
        let mut gradient = pull.clone();
        for one in &each {
            matrix += &one.matrix;
            gradient += &one.gradient;
        }
        Some(Self {
            matrix,
            gradient,
            each,
        })
    }
}

/// A positive definite matrix's Cholesky factor.
pub type Factor = Cholesky<f64, Dyn>;

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without pattern.
    fn number(index: usize) -> f64 {
        ((index as f64 * 0.754_877_666).fract() - 0.5) * 2.0
    }

    /// Three segments that see different ones of four parameters.
    fn segments() -> Vec<(Vec<f64>, Vec<usize>)> {
        let places = [vec![0, 1, 2], vec![0, 1, 3], vec![0, 1, 2]];
        let table =
            |k: usize, width: usize| (0..20 * width).map(|i| number(1000 * k + i)).collect();
        places
            .into_iter()
            .enumerate()
            .map(|(k, places)| (table(k, 1 + START + places.len()), places))
            .collect()
    }

    #[test]
    fn elimination_agrees_with_the_dense_solution() {
        let parameters = 4;
        let data = segments();
        let size = START * data.len() + parameters;
        let mut matrix = DMatrix::<f64>::zeros(size, size);
        let mut rhs = DVector::<f64>::zeros(size);
        let mut normals = Vec::new();
        for (k, (table, places)) in data.iter().enumerate() {
            let mut normal = Normal::zeros(parameters);
            normal.add(table, places);
            normal.add_start_prior(&[0.1; 6], &[2.0; 6]);
            for row in table.chunks_exact(1 + START + places.len()) {
                let mut dense = DVector::<f64>::zeros(size);
                for i in 0..START {
                    dense[START * k + i] = row[1 + i];
                }
                for (place, value) in places.iter().zip(&row[1 + START..]) {
                    dense[START * data.len() + place] = *value;
                }
                matrix += &dense * dense.transpose();
                rhs += dense * row[0];
            }
            for i in START * k..START * (k + 1) {
                matrix[(i, i)] += 0.25;
                rhs[i] += 0.025;
            }
            normals.push(normal);
        }
        let expected = matrix.clone().cholesky().unwrap().solve(&rhs);
        let eliminated: Vec<_> = normals
            .iter()
            .map(|normal| Eliminated::new(normal, 0.0).unwrap())
            .collect();
        let reduced: DMatrix<f64> = eliminated.iter().map(|e| &e.matrix).sum();
        let gradient: DVector<f64> = eliminated.iter().map(|e| &e.gradient).sum();
        let factor = reduced.cholesky().unwrap();
        let step = factor.solve(&gradient);
        // Rounding of systems with condition numbers of some hundred.
        let tolerance = 1e-11;
        let tail = expected.rows(START * data.len(), parameters);
        assert!((&step - tail).amax() < tolerance);
        for (k, (normal, eliminated)) in normals.iter().zip(&eliminated).enumerate() {
            for (i, value) in eliminated.start_step(normal, &step).into_iter().enumerate() {
                assert!((value - expected[START * k + i]).abs() < tolerance);
            }
        }
        let log_determinant = eliminated
            .iter()
            .map(Eliminated::log_determinant)
            .sum::<f64>()
            + factor.determinant().ln();
        assert!((log_determinant - matrix.determinant().ln()).abs() < 1e-9);
        let gain: f64 = eliminated.iter().map(|e| e.start_gain).sum::<f64>() + gradient.dot(&step);
        assert!((gain - rhs.dot(&expected)).abs() < tolerance);
        // The same as the difference of the segments' costs.
        let pairs = normals.iter().zip(&eliminated);
        let falls = pairs.map(|(normal, one)| {
            normal.cost - normal.cost_after(&one.start_step(normal, &step), &step)
        });
        assert!((falls.sum::<f64>() - gain).abs() < tolerance);
    }
}
