//! Likelihood and evidence of a hypothesis.
//!
//! Multiple shooting: segments with free starts, the soil free under its prior, noise per channel white and AR(1) by
//! restricted maximum likelihood, heavy tails by Student's t (see [`crate::fit`]). The evidence integrates over soil,
//! starts and effects of the linearised problem (Laplace; D. MacKay, "Bayesian interpolation", Neural Computation 4
//! (1992)): -2 ln E = cost + ln det H - ln det P, with the prior's precision P and H = J^T J + P.

use super::{Problem, Solution};
use crate::fit::noise_estimate;
use crate::fit::noise_model::reweigh;
use crate::fit::normal::{Eliminated, Reduced};
use crate::fit::optimiser::{Stop, minimise_from, normals};
use crate::fit::predictor::{PredictionError, Predictor};
use crate::fit::problem::{NoiseModel, Point, ShootingProblem, Tables};
use crate::fit::restart::{moved, restarted};
use crate::fit::uncertainty::uncertainty;
use nalgebra::DMatrix;

/// A hypothesis fitted to the recordings.
#[derive(Debug, Clone)]
pub struct FittedHypothesis {
    /// The free coefficients, besides the soil.
    pub coefficients: Vec<usize>,
    /// The solution.
    pub solution: Solution,
    /// Half the squared whitened residuals, without the priors of soil and coefficients.
    pub misfit: f64,
    /// Negative log evidence.
    pub negative_log_evidence: f64,
    /// Reduction that the next step predicts.
    pub predicted_reduction: f64,
    /// Covariance of the unknowns' coordinates, in the problem's order.
    pub covariance: DMatrix<f64>,
    /// Residuals of each segment and their derivatives.
    pub tables: Vec<Tables>,
    /// Log Bayes factor of the neighbourhood of its effects' formulas (`screening/shape.rs`); zero until it is computed.
    pub shape_gain: f64,
}

impl FittedHypothesis {
    /// Negative log evidence by the catalogue's formulas or neighbours of them.
    #[must_use]
    pub fn with_neighbours(&self) -> f64 {
        self.negative_log_evidence - self.shape_gain
    }
}

/// Factor on the standard deviations of the fit, which neglect other modes and model errors. Calibrated on 100
/// parameters of the proof's third judged set (see the docs); later sets judged it.
const WIDER: f64 = 1.4;
/// Steps that show whether a fit is worth finishing.
pub const PARTIAL_FIT: Stop = Stop::after(5, 1.0);
/// The same from a distant initial guess.
pub const LONG_PARTIAL_FIT: Stop = Stop::after(12, 2.0);
/// The end of a fit under fixed noise: half a unit of log evidence decides nothing.
pub const HELD: Stop = Stop::after(20, 1.0);
/// Maximum number of alternations of motion and noise, and the changes at which they end.
const TURNS: usize = 8;
const STILL: f64 = 1.0;
const STILL_NOISE: f64 = 0.1;
const STILL_EVIDENCE: f64 = 0.02;
/// Duration of a block \[s\]. Misfits of formulas last for a manoeuvre, but local effects act in few blocks. In 38 pairs of
/// rivals the scatter from blocks of 3 s was 1.15 of that from blocks of 1 s in the median, from 8 s 1.25.
const BLOCK: f64 = 2.0;
const FIRST: Stop = Stop::after(40, 1.0);
const NEXT: Stop = Stop::after(8, 0.5);

/// Fits the soil and these coefficients under fixed noise.
///
/// # Errors
/// An initial solution that the model cannot follow.
pub fn fit_hypothesis(
    problem: &Problem,
    coefficients: &[usize],
    initial: &Solution,
    noise: &NoiseModel,
) -> Result<FittedHypothesis, PredictionError> {
    fit_until(problem, coefficients, initial, noise, HELD)
}

/// As [`fit_hypothesis`], until another end.
///
/// # Errors
/// As [`fit_hypothesis`].
pub fn fit_until(
    problem: &Problem,
    coefficients: &[usize],
    initial: &Solution,
    noise: &NoiseModel,
    stop: Stop,
) -> Result<FittedHypothesis, PredictionError> {
    let start = Start::new(problem, coefficients, initial);
    problem.at(coefficients, initial, |shooting, point| {
        let tables = shooting.evaluate(&point, true)?;
        Ok(start.minimise(shooting, point, tables, noise, stop))
    })
}

/// Continues a fit, perhaps under another noise.
#[must_use]
pub fn continue_fit(
    problem: &Problem,
    fitted: &FittedHypothesis,
    noise: &NoiseModel,
    stop: Stop,
) -> FittedHypothesis {
    let (coefficients, initial) = (&fitted.coefficients, &fitted.solution);
    let start = Start::new(problem, coefficients, initial);
    problem.at(coefficients, initial, |shooting, point| {
        start.minimise(shooting, point, fitted.tables.clone(), noise, stop)
    })
}

/// Finishes a fit from new starts (see [`crate::fit::restart`]), perhaps under another noise.
#[must_use]
pub fn fit_restarted(
    problem: &Problem,
    fitted: &FittedHypothesis,
    noise: &NoiseModel,
) -> FittedHypothesis {
    let (coefficients, initial) = (&fitted.coefficients, &fitted.solution);
    let start = Start::new(problem, coefficients, initial);
    let restarted = problem.at(coefficients, initial, |shooting, point| {
        let starts = restarted(shooting, &point, noise)?;
        let (moved, tables) = moved(shooting, &point, &fitted.tables, starts)?;
        let fit = start.minimise(shooting, moved, tables, noise, HELD);
        let (before, _) = evidence(shooting, &fitted.tables, &point, noise);
        (fit.negative_log_evidence < before).then_some(fit)
    });
    restarted.unwrap_or_else(|| continue_fit(problem, fitted, noise, HELD))
}

/// A hypothesis before its fit.
struct Start<'s, 'p> {
    problem: &'s Problem<'p>,
    coefficients: &'s [usize],
    initial: &'s Solution,
}

impl<'s, 'p> Start<'s, 'p> {
    fn new(problem: &'s Problem<'p>, coefficients: &'s [usize], initial: &'s Solution) -> Self {
        Self {
            problem,
            coefficients,
            initial,
        }
    }

    /// Minimises the cost from a point with these tables.
    fn minimise<P: Predictor>(
        &self,
        shooting: &ShootingProblem<P>,
        mut point: Point,
        tables: Vec<Tables>,
        noise: &NoiseModel,
        stop: Stop,
    ) -> FittedHypothesis {
        let outcome = minimise_from(shooting, &mut point, tables, noise, stop);
        let (negative_log_evidence, covariance) =
            evidence(shooting, &outcome.tables, &point, noise);
        let solution = self
            .problem
            .solution(shooting, self.coefficients, &point, self.initial);
        FittedHypothesis {
            coefficients: self.coefficients.to_vec(),
            solution,
            misfit: 0.5 * (outcome.cost - shooting.prior_cost(&point.coordinates)),
            negative_log_evidence,
            predicted_reduction: 0.5 * outcome.predicted_reduction,
            covariance,
            tables: outcome.tables,
            shape_gain: 0.0,
        }
    }
}

/// Half the cost of a hypothesis at a solution; infinite if the model cannot follow it.
#[must_use]
pub fn cost(problem: &Problem, coefficients: &[usize], at: &Solution, noise: &NoiseModel) -> f64 {
    problem.at(coefficients, at, |shooting, point| {
        let residuals = shooting.evaluate_unless_one_fails(&point, false);
        residuals.map_or(f64::INFINITY, |r| 0.5 * shooting.cost(&r, &point, noise))
    })
}

/// Fits the soil and these coefficients in turns with noise and weights.
///
/// # Errors
/// As [`fit_hypothesis`].
pub fn fit_with_noise(
    problem: &Problem,
    coefficients: &[usize],
    initial: &Solution,
    noise: &mut NoiseModel,
) -> Result<FittedHypothesis, PredictionError> {
    let predictor = problem.predictor(coefficients);
    let shooting = problem.shooting(&predictor, coefficients);
    let mut point = problem.point(&shooting, coefficients, initial);
    let mut tables = shooting.evaluate(&point, true)?;
    let mut stop = FIRST;
    let mut before = None;
    for _ in 0..TURNS {
        let outcome = minimise_from(&shooting, &mut point, tables, noise, stop);
        let linearised = shooting.linearised(&point);
        let change = noise_estimate::update(&linearised, &outcome.tables, noise, before);
        before = Some(change);
        reweigh(&shooting, &outcome.tables, noise);
        tables = outcome.tables;
        let still = outcome.converged && outcome.gain < STILL && change < STILL_NOISE;
        if still || problem.deadline.is_over() {
            break;
        }
        stop = NEXT;
    }
    let start = Start::new(problem, coefficients, initial);
    Ok(start.minimise(&shooting, point, tables, noise, HELD))
}

/// Covariance of a hypothesis' unknowns from the scatter of the segments' scores (see [`uncertainty`]), else from the
/// noise model; widened by [`WIDER`].
#[must_use]
pub fn scattered(problem: &Problem, fit: &FittedHypothesis, noise: &NoiseModel) -> DMatrix<f64> {
    let robust = problem.at(&fit.coefficients, &fit.solution, |shooting, point| {
        uncertainty(shooting, &fit.tables, &point, noise, true)
    });
    let covariance = robust.map_or_else(|| fit.covariance.clone(), |robust| robust.covariance);
    covariance * (WIDER * WIDER)
}

/// Noise and weights of a fitted hypothesis' residuals.
#[must_use]
pub fn own_noise(problem: &Problem, fit: &FittedHypothesis, noise: &NoiseModel) -> NoiseModel {
    let mut own = noise.clone();
    problem.at(&fit.coefficients, &fit.solution, |shooting, point| {
        follow(shooting, &point, &fit.tables, &mut own)
    });
    own
}

/// Derivatives of all samples by further unknowns, in units of the prior deviations of these.
#[derive(Debug, Clone)]
pub struct FurtherColumns {
    /// Number of unknowns.
    pub count: usize,
    /// By segment and channel, row by row; none for a segment that the model cannot follow.
    pub each: Vec<Option<Vec<Vec<f64>>>>,
}

/// Evidence of a hypothesis under the noise and weights that are likeliest for it.
#[derive(Debug, Clone)]
pub struct OwnEvidence {
    /// Negative log evidence; infinite if numbers are not finite.
    pub negative_log: f64,
    /// Log likelihood of the likeliest residuals in each block of [`BLOCK`] seconds, but for a constant.
    pub blocks: Vec<f64>,
}

/// The restricted likelihood, in which further unknowns are integrated out as well, under the noise and weights that are
/// likeliest, beginning with these.
#[must_use]
pub fn evidence_under_own_noise(
    problem: &Problem,
    fit: &FittedHypothesis,
    further: Option<&FurtherColumns>,
    noise: &NoiseModel,
) -> OwnEvidence {
    problem.at(&fit.coefficients, &fit.solution, |shooting, point| {
        let count = further.map_or(0, |further| further.count);
        let linearised = shooting.linearised(&point).with_further(&vec![1.0; count]);
        let each = fit.tables.iter().enumerate();
        let tables = each.map(|(index, table)| {
            let columns = further.and_then(|further| further.each[index].as_ref());
            with_columns(table, count, columns)
        });
        let tables: Vec<Tables> = tables.collect();
        let mut own = noise.clone();
        let mut residuals = Vec::new();
        let mut before = None;
        for _ in 0..TURNS {
            let change = noise_estimate::update_finely(&linearised, &tables, &mut own, before);
            before = Some(change);
            let Some(after) = noise_estimate::residuals_after_step(&linearised, &tables, &own)
            else {
                return OwnEvidence {
                    negative_log: f64::INFINITY,
                    blocks: Vec::new(),
                };
            };
            reweigh(shooting, &after, &mut own);
            residuals = after;
            if change < STILL_EVIDENCE {
                break;
            }
        }
        let prior_cost = shooting.prior_cost(&point.coordinates);
        OwnEvidence {
            negative_log: 0.5 * noise_estimate::restricted(&linearised, &tables, prior_cost, &own),
            blocks: noise_estimate::blockwise(&linearised, &residuals, &own, BLOCK),
        }
    })
}

/// A table with further columns; zeros if there are none for it.
fn with_columns(table: &Tables, count: usize, further: Option<&Vec<Vec<f64>>>) -> Tables {
    let channels = table.channels.iter().enumerate().map(|(channel, rows)| {
        let rows = rows.chunks_exact(table.columns).enumerate();
        let rows = rows.flat_map(|(number, row)| {
            let own = further.map_or_else(
                || vec![0.0; count],
                |further| further[channel][number * count..(number + 1) * count].to_vec(),
            );
            row.iter().copied().chain(own)
        });
        rows.collect()
    });
    Tables {
        channels: channels.collect(),
        columns: table.columns + count,
    }
}

/// Re-estimates noise and weights from the residuals; returns the change of the noise.
pub fn follow<P: Predictor>(
    shooting: &ShootingProblem<P>,
    point: &Point,
    tables: &[Tables],
    noise: &mut NoiseModel,
) -> f64 {
    let change = noise_estimate::update(&shooting.linearised(point), tables, noise, None);
    reweigh(shooting, tables, noise);
    change
}

/// Negative log evidence, and the covariance of the unknowns. Infinite if numbers are not finite.
fn evidence<P: Predictor>(
    shooting: &ShootingProblem<P>,
    tables: &[Tables],
    point: &Point,
    noise: &NoiseModel,
) -> (f64, DMatrix<f64>) {
    let count = shooting.parameters.len();
    let mut cost = shooting.prior_cost(&point.coordinates);
    let (precision, pull) = shooting.prior(&point.coordinates);
    let prior: f64 = precision.iter().map(|p| p.ln()).sum();
    let normals = normals(shooting, tables, point, noise);
    cost += normals.iter().map(|normal| normal.cost).sum::<f64>();
    let reduced = Reduced::new(&normals, &precision, &pull, 0.0);
    let starts = |reduced: &Reduced| reduced.each.iter().map(Eliminated::log_determinant).sum();
    let starts: f64 = reduced.as_ref().map_or(0.0, starts);
    let Some(factor) = reduced.and_then(|reduced| reduced.matrix.cholesky()) else {
        return (f64::INFINITY, DMatrix::identity(count, count));
    };
    let whole = 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
    (0.5 * (cost + whole - prior + starts), factor.inverse())
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::diagnosis::Options;
    use crate::diagnosis::testing::{driven, fitted, on};
    use crate::fit::restart::outlying_restarted;

    /// Noise of all channels \[m, rad, m/s, rad/s\].
    const WHITE: f64 = 2e-3;

    /// Pivots on the given clayed soil, and the refitted soil.
    fn with_pivots(check: impl FnOnce(&Problem, &NoiseModel, &FittedHypothesis)) {
        let truth = on("clayed_soil");
        let recordings = [driven(&truth, "pivots")];
        let (problem, fit, mut noise) = fitted(&truth, &recordings, &Options::default());
        // The recording has none, and the estimate depends on where the fit ended.
        for noise in noise.noise.iter_mut().flatten() {
            noise.white = WHITE;
            noise.coloured = 0.0;
        }
        let fit = fit_hypothesis(&problem, &[], &fit.solution, &noise).unwrap();
        check(&problem, &noise, &fit);
    }

    /// A solution in which one segment starts backwards and sideways, beside its place; it recovers within tenths of
    /// a second.
    fn with_wrong_start(from: &Solution, segment: usize, left: f64) -> Solution {
        let off = [0.4, -0.2 * left, 0.0, -2.0, left, 0.0];
        let mut with_wrong_start = from.clone();
        for (value, off) in with_wrong_start.starts[segment].iter_mut().zip(off) {
            *value += off;
        }
        with_wrong_start
    }

    #[test]
    fn a_start_in_the_wrong_basin_is_found_again() {
        with_pivots(|problem, noise, fit| {
            // Already optimal.
            let same = fit_restarted(problem, fit, noise);
            assert!((same.negative_log_evidence - fit.negative_log_evidence).abs() < 1.0);
            for (segment, left) in [(3, 3.0), (4, 1.0)] {
                let wrong = with_wrong_start(&fit.solution, segment, left);
                let predictor = problem.predictor(&[]);
                let shooting = problem.shooting(&predictor, &[]);
                let point = problem.point(&shooting, &[], &wrong);
                let costs = |costly| (0..6).map(move |k| if k == costly { 9.0 } else { 1.0 });
                for found in [
                    restarted(&shooting, &point, noise),
                    outlying_restarted(&shooting, &point, noise, costs(segment)),
                ] {
                    let speed = [&found.unwrap(), &fit.solution.starts].map(|all| all[segment][3]);
                    assert!((speed[0] - speed[1]).abs() < 0.1, "{speed:?}");
                }
                // Only outlying segments are restarted.
                assert!(outlying_restarted(&shooting, &point, noise, costs(segment + 1)).is_none());
                // The fit itself finds the start, which is fitted to the parameters at each step.
                let found = fit_hypothesis(problem, &[], &wrong, noise).unwrap();
                let off = found.negative_log_evidence - fit.negative_log_evidence;
                assert!(off.abs() < 10.0, "{off}");
                // So does a restart where a fit has ended.
                let ended = Stop::after(0, 0.0).without_renewals();
                let stuck = fit_until(problem, &[], &wrong, noise, ended).unwrap();
                assert!(stuck.negative_log_evidence > fit.negative_log_evidence + 100.0);
                let again = fit_restarted(problem, &stuck, noise);
                let off = again.negative_log_evidence - fit.negative_log_evidence;
                assert!(off.abs() < 10.0, "{off}");
                // Also under less noise, where everything costs more.
                let mut less = noise.clone();
                for noise in less.noise.iter_mut().flatten() {
                    noise.white *= 0.8;
                    noise.coloured *= 0.8;
                }
                let [again, right] = [&stuck, fit].map(|one| fit_restarted(problem, one, &less));
                let off = again.negative_log_evidence - right.negative_log_evidence;
                assert!(off.abs() < 10.0, "{off}");
            }
        });
    }

    #[test]
    fn what_further_unknowns_explain_is_no_noise() {
        with_pivots(|problem, noise, fit| {
            let mut random = fastrand::Rng::with_seed(1);
            let mut normal = || (0..12).map(|_| random.f64()).sum::<f64>() - 6.0;
            let mut noisy = fit.clone();
            let mut signal = noisy.clone();
            let mut columns = Vec::new();
            for (plain, bent) in noisy.tables.iter_mut().zip(&mut signal.tables) {
                let width = plain.columns;
                let mut each = Vec::new();
                for (plain, bent) in plain.channels.iter_mut().zip(&mut bent.channels) {
                    let rows = plain.len() / width;
                    let column: Vec<f64> =
                        (0..rows).map(|k| WHITE * (0.9 * k as f64).sin()).collect();
                    for (row, column) in column.iter().enumerate() {
                        plain[row * width] += WHITE * normal();
                        bent[row * width] = plain[row * width] + 5.0 * column;
                    }
                    each.push(column);
                }
                columns.push(Some(each));
            }
            let columns = FurtherColumns {
                count: 1,
                each: columns,
            };
            // The search is one of logarithms.
            let mut noise = noise.clone();
            for noise in noise.noise.iter_mut().flatten() {
                noise.coloured = 0.2 * WHITE;
            }
            let noise = &noise;
            let negative = |fit: &FittedHypothesis, further: bool, noise: &NoiseModel| {
                let columns = further.then_some(&columns);
                evidence_under_own_noise(problem, fit, columns, noise).negative_log
            };
            let plain = negative(&noisy, false, noise);
            // Where the noise begins does not matter.
            let mut louder = noise.clone();
            for noise in louder.noise.iter_mut().flatten() {
                noise.white *= 3.0;
            }
            let again = negative(&noisy, false, &louder);
            assert!((plain - again).abs() < 3.0, "{plain} {again}");
            // An unknown of five standard deviations: its prior costs 12.5, its determinant some units.
            let explained = negative(&signal, true, noise) - plain;
            assert!((10.0..30.0).contains(&explained), "{explained}");
            let mistaken = negative(&signal, false, noise) - plain;
            assert!(mistaken > 10.0 * explained, "{mistaken}");
            // One without a signal costs its determinant.
            let idle = negative(&noisy, true, noise) - plain;
            assert!((0.0..10.0).contains(&idle), "{idle}");
        });
    }

    #[test]
    fn a_fit_that_cannot_come_to_be_of_use_is_given_up() {
        with_pivots(|problem, noise, fit| {
            let fitted = |initial: &Solution, stop: Stop| {
                let one = fit_until(problem, &[], initial, noise, stop).unwrap();
                one.negative_log_evidence - fit.negative_log_evidence
            };
            let of_use = 2.0 * fit.misfit + 20.0;
            // Distant, but converging.
            let mut far = fit.solution.clone();
            for (value, parameter) in far.soil.iter_mut().zip(problem.soil_parameters()) {
                *value += 0.7 * parameter.prior.deviation;
            }
            let gone_on = fitted(&far, LONG_PARTIAL_FIT);
            assert!(gone_on < 10.0, "{gone_on}");
            assert_eq!(fitted(&far, LONG_PARTIAL_FIT.unless_above(of_use)), gone_on);
            // One wrong start does not stop the fit as hopeless, nor prevent that.
            let (near, far) = (
                with_wrong_start(&fit.solution, 3, 3.0),
                with_wrong_start(&fit.solution, 4, 1.0),
            );
            let found = fitted(&near, LONG_PARTIAL_FIT.unless_above(of_use));
            assert_eq!(found, fitted(&near, LONG_PARTIAL_FIT));
            let given_up = fitted(&far, LONG_PARTIAL_FIT.unless_above(-1e6));
            assert!(
                given_up > fitted(&far, LONG_PARTIAL_FIT) + 1.0,
                "{given_up}"
            );
        });
    }
}
