//! Robust least squares of a law's parameters.

use super::data::Trial;
use super::law::{Law, Parameter, Prediction, Rig};
use nalgebra::{DMatrix, DVector};

/// Residuals beyond so many units of the repeats' scatter count linearly (Huber).
const HUBER: f64 = 5.0;
/// Residuals of a trial: traction, side force, sinkage, load not carried.
const OUTPUTS: usize = 4;
/// Step of the differences, as a share of a parameter's range.
const STEP: f64 = 1e-5;
const MOST_STEPS: usize = 60;
/// A step that lowers the cost by less than this share of it is the last.
const GAIN: f64 = 1e-6;

/// A fitted law.
#[derive(Debug, Clone)]
pub struct Fit {
    pub law: Law,
    pub values: Vec<f64>,
    /// 95 % interval of each parameter, from the residuals of whole conditions; `None` at a bound.
    pub intervals: Vec<Option<[f64; 2]>>,
    /// Huber's cost of the trials, with the priors'.
    pub cost: f64,
}

impl Fit {
    /// The value of a parameter that the law has.
    pub fn value(&self, name: &str) -> Option<f64> {
        let place = self
            .law
            .parameters
            .iter()
            .position(|parameter| parameter.name == name);
        place.map(|place| self.values[place])
    }
}

impl Parameter {
    /// What the fit moves, and back.
    fn inner(&self, value: f64) -> f64 {
        if self.logarithmic { value.ln() } else { value }
    }

    fn outer(&self, inner: f64) -> f64 {
        if self.logarithmic { inner.exp() } else { inner }
    }

    fn bounds(&self) -> [f64; 2] {
        [self.inner(self.low), self.inner(self.high)]
    }
}

struct ShootingProblem<'p> {
    rig: &'p Rig,
    law: &'p Law,
    trials: &'p [Trial],
    scatter: [f64; 3],
}

impl ShootingProblem<'_> {
    /// Of each trial traction, side force, sinkage and load not carried; then the priors.
    fn residuals(&self, inner: &DVector<f64>) -> DVector<f64> {
        let parameters = &self.law.parameters;
        let values: Vec<f64> = parameters
            .iter()
            .zip(inner.iter())
            .map(|(p, &x)| p.outer(x))
            .collect();
        let mut all = Vec::with_capacity(OUTPUTS * self.trials.len() + parameters.len());
        for trial in self.trials {
            let Prediction { values, uncarried } = self.rig.predict(self.law, &values, trial);
            for (output, measured) in trial.measured().into_iter().enumerate() {
                all.push((values[output] - measured) / self.scatter[output]);
            }
            all.push(uncarried / self.scatter[0]);
        }
        for (parameter, &x) in parameters.iter().zip(inner.iter()) {
            if let Some((mean, deviation)) = parameter.prior {
                all.push((x - mean) / deviation);
            }
        }
        DVector::from_vec(all)
    }

    fn cost(residuals: &DVector<f64>) -> f64 {
        residuals
            .iter()
            .map(|r| {
                let size = r.abs();
                if size < HUBER {
                    0.5 * r * r
                } else {
                    HUBER * (size - 0.5 * HUBER)
                }
            })
            .sum()
    }

    fn jacobian(&self, inner: &DVector<f64>, at: &DVector<f64>) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(at.len(), inner.len());
        for (column, parameter) in self.law.parameters.iter().enumerate() {
            let [low, high] = parameter.bounds();
            let step = STEP * (high - low);
            let step = if inner[column] + step > high {
                -step
            } else {
                step
            };
            let mut moved = inner.clone();
            moved[column] += step;
            jacobian.set_column(column, &((self.residuals(&moved) - at) / step));
        }
        jacobian
    }

    /// Levenberg and Marquardt's method with Huber's weights, between the bounds.
    fn minimise(&self, mut inner: DVector<f64>) -> (DVector<f64>, f64) {
        let bounds: Vec<[f64; 2]> = self.law.parameters.iter().map(Parameter::bounds).collect();
        let mut residuals = self.residuals(&inner);
        let mut cost = Self::cost(&residuals);
        let mut damping = 1e-2;
        for _ in 0..MOST_STEPS {
            let jacobian = self.jacobian(&inner, &residuals);
            let weights = residuals.map(weight);
            let weighted = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |row, column| {
                weights[row] * jacobian[(row, column)]
            });
            let gradient = weighted.tr_mul(&residuals);
            let mut curvature = weighted.tr_mul(&jacobian);
            // A parameter at a bound that the cost presses on stays there.
            for (at, [low, high]) in bounds.iter().enumerate() {
                let pressed = (inner[at] <= *low && gradient[at] > 0.0)
                    || (inner[at] >= *high && gradient[at] < 0.0);
                if pressed {
                    curvature.row_mut(at).fill(0.0);
                    curvature.column_mut(at).fill(0.0);
                    curvature[(at, at)] = f64::INFINITY;
                }
            }
            let mut gained = 0.0;
            for _ in 0..12 {
                let mut damped = curvature.clone();
                let mut slope = -&gradient;
                for at in 0..inner.len() {
                    if curvature[(at, at)].is_infinite() {
                        damped[(at, at)] = 1.0;
                        slope[at] = 0.0;
                    } else {
                        damped[(at, at)] += damping * curvature[(at, at)].max(1e-9);
                    }
                }
                let Some(step) = damped.lu().solve(&slope) else {
                    break;
                };
                let moved = DVector::from_fn(inner.len(), |at, _| {
                    (inner[at] + step[at]).clamp(bounds[at][0], bounds[at][1])
                });
                let found = self.residuals(&moved);
                let lower = Self::cost(&found);
                if lower < cost {
                    gained = cost - lower;
                    (inner, residuals, cost) = (moved, found, lower);
                    damping = f64::max(damping * 0.2, 1e-9);
                    break;
                }
                damping *= 5.0;
            }
            if gained < GAIN * cost {
                break;
            }
        }
        (inner, cost)
    }

    /// 95 % intervals: the curvature of the cost and the scatter of its slope between conditions.
    fn intervals(&self, inner: &DVector<f64>) -> Vec<Option<[f64; 2]>> {
        let residuals = self.residuals(inner);
        let jacobian = self.jacobian(inner, &residuals);
        let parameters = &self.law.parameters;
        let free: Vec<usize> = (0..inner.len())
            .filter(|&at| {
                let [low, high] = parameters[at].bounds();
                let margin = 1e-3 * (high - low);
                inner[at] > low + margin && inner[at] < high - margin
            })
            .collect();
        let jacobian = jacobian.select_columns(&free);
        let weighted = DMatrix::from_fn(jacobian.nrows(), free.len(), |row, column| {
            weight(residuals[row]) * jacobian[(row, column)]
        });
        let curvature = weighted.tr_mul(&jacobian);
        let mut conditions: Vec<_> = self.trials.iter().map(Trial::condition).collect();
        conditions.sort_unstable();
        conditions.dedup();
        let mut scatter = DMatrix::zeros(free.len(), free.len());
        for condition in &conditions {
            let mut slope = DVector::zeros(free.len());
            for (index, _) in self
                .trials
                .iter()
                .enumerate()
                .filter(|(_, t)| t.condition() == *condition)
            {
                for row in OUTPUTS * index..OUTPUTS * (index + 1) {
                    slope += weighted.row(row).transpose() * residuals[row];
                }
            }
            scatter += &slope * slope.transpose();
        }
        let groups = conditions.len() as f64;
        scatter *= groups / (groups - free.len() as f64).max(1.0);
        let mut intervals = vec![None; inner.len()];
        if let Some(inverse) = curvature.try_inverse() {
            let covariance = &inverse * scatter * &inverse;
            for (place, &at) in free.iter().enumerate() {
                let reach = 1.96 * covariance[(place, place)].sqrt();
                let [low, high] = parameters[at].bounds();
                let end = |x: f64| parameters[at].outer(x.clamp(low, high));
                intervals[at] = Some([end(inner[at] - reach), end(inner[at] + reach)]);
            }
        }
        intervals
    }
}

fn weight(residual: f64) -> f64 {
    (HUBER / residual.abs().max(1e-12)).min(1.0)
}

/// Fits a law to trials, from its own start and from other fits, of whose parameters it takes
/// those that it has: the valleys are flat, and one start may end before the lowest place.
pub fn fit(rig: &Rig, law: &Law, trials: &[Trial], scatter: [f64; 3], from: &[&Fit]) -> Fit {
    let problem = ShootingProblem {
        rig,
        law,
        trials,
        scatter,
    };
    let own = law
        .parameters
        .iter()
        .map(|parameter| parameter.start)
        .collect();
    let warm = from.iter().map(|fit| {
        let known = |p: &Parameter| fit.value(&p.name).unwrap_or(p.start);
        law.parameters.iter().map(known).collect()
    });
    let starts: Vec<Vec<f64>> = std::iter::once(own).chain(warm).collect();
    let (inner, cost) = starts
        .into_iter()
        .map(|start| {
            let inner = law
                .parameters
                .iter()
                .zip(start)
                .map(|(p, value)| p.inner(value));
            problem.minimise(DVector::from_iterator(law.parameters.len(), inner))
        })
        .min_by(|first, second| first.1.total_cmp(&second.1))
        .expect("at least one start");
    Fit {
        values: law
            .parameters
            .iter()
            .zip(inner.iter())
            .map(|(p, &x)| p.outer(x))
            .collect(),
        intervals: problem.intervals(&inner),
        law: law.clone(),
        cost,
    }
}
