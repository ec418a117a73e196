//! Kinematic models of a skid-steer vehicle, and their fit to windows.
//!
//! A. Mandow, J. L. Martínez, J. Morales, J. L. Blanco, A. García-Cerezo, J. González,
//! "Experimental kinematics for wheeled skid-steer mobile robots", IROS 2007, after J. L.
//! Martínez et al., "Approximating kinematics for tracked mobile robots", IJRR 24(10), 2005:
//! on even ground the centres of rotation of the wheels of either side hardly move.

use super::estimate::FEWEST_BLOCKS;
use super::rolled::Rolled;
use super::signals::wrapped;
use super::{Estimate, Window};
use crate::vehicle::Vehicle;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// Fewer windows are no base for three numbers.
pub(super) const FEWEST_WINDOWS: usize = 4;

/// V_X = r (omega_L + omega_R) / 2, Omega = r (omega_R - omega_L) / B', V_Y = -x_ICR Omega.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// Effective wheel radius r \[m\].
    pub wheel_radius: f64,
    /// Effective track B' \[m\]: distance between the centres of rotation of both sides.
    pub track: f64,
    /// How far ahead of the reference point the centres of rotation lie, x_ICR \[m\].
    pub icr_x: f64,
}

/// Which of its numbers are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KinematicsForm {
    /// Radius and track.
    TwoParameter,
    /// The centres of rotation also move along the vehicle.
    ThreeParameter,
}

/// Kinematics with the intervals of their numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedKinematics {
    /// The fitted model.
    pub kinematics: Kinematics,
    /// Effective radius \[m\].
    pub wheel_radius: Estimate,
    /// Effective track \[m\].
    pub track: Estimate,
    /// Where the centres of rotation lie \[m\]; `None` where it is not fitted.
    pub icr_x: Option<Estimate>,
}

impl Kinematics {
    /// Wheels that roll without slip, as far as a skid-steer vehicle can.
    #[must_use]
    pub fn no_slip(vehicle: &Vehicle) -> Self {
        Self {
            wheel_radius: vehicle.wheel_radius,
            track: 2.0 * vehicle.half_track,
            icr_x: 0.0,
        }
    }

    /// x \[m\], y \[m\] and heading \[rad\] at the end of a window.
    #[must_use]
    pub fn predict(&self, window: &Window) -> [f64; 3] {
        let [ahead, left, turn] = self.displacement(&Rolled::new(&window.wheels));
        let (sin, cos) = window.state.heading.sin_cos();
        [
            window.state.x + cos * ahead - sin * left,
            window.state.y + sin * ahead + cos * left,
            window.state.heading + turn,
        ]
    }

    fn displacement(&self, rolled: &Rolled) -> [f64; 3] {
        let gain = self.wheel_radius / self.track;
        linearise(rolled, Vector3::new(self.wheel_radius, gain, self.icr_x)).0
    }

    /// Fits the numbers to windows by least squares of the errors at their ends, a metre
    /// weighing as much as a radian. `nominal` says where to look. `None` without windows, or
    /// where these do not determine the numbers.
    #[must_use]
    pub fn fit(
        form: KinematicsForm,
        windows: &[&Window],
        nominal: &Self,
    ) -> Option<FittedKinematics> {
        if windows.len() < FEWEST_WINDOWS {
            return None;
        }
        let samples: Vec<Sample> = windows.iter().map(|window| Sample::new(window)).collect();
        let free = match form {
            KinematicsForm::TwoParameter => 2,
            KinematicsForm::ThreeParameter => 3,
        };
        let parameters = solve(&samples, first_guess(&samples, nominal)?, free)?;
        let inverse = normal(&samples, parameters, free).1.try_inverse()?;
        let covariance = covariance(&samples, parameters, free, inverse);
        let [radius, gain, icr_x] = parameters.into();
        let error = |direction: Vector3<f64>| match covariance {
            Some(covariance) => direction.dot(&(covariance * direction)).sqrt(),
            None => f64::INFINITY,
        };
        let track = radius / gain;
        // B' = r / gain.
        let by_track = Vector3::new(1.0 / gain, -track / gain, 0.0);
        let fitted = FittedKinematics {
            kinematics: Self {
                wheel_radius: radius,
                track,
                icr_x,
            },
            wheel_radius: Estimate::normal(radius, error(Vector3::x())),
            track: Estimate::normal(track, error(by_track)),
            icr_x: (free == 3).then(|| Estimate::normal(icr_x, error(Vector3::z()))),
        };
        let widths = [fitted.wheel_radius.width(), fitted.track.width()];
        (!widths.iter().any(|width| width.is_nan())).then_some(fitted)
    }
}

/// A window as the fit sees it.
struct Sample {
    rolled: Rolled,
    displacement: [f64; 3],
    block: (usize, i64),
}

impl Sample {
    fn new(window: &Window) -> Self {
        Self {
            rolled: Rolled::new(&window.wheels),
            displacement: window.displacement(),
            block: window.block(),
        }
    }

    /// Errors at the end, and their derivatives by the parameters (one per column).
    fn residual(&self, parameters: Vector3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
        let (end, by) = linearise(&self.rolled, parameters);
        let [ahead, left, turn] = self.displacement;
        let error = Vector3::new(end[0] - ahead, end[1] - left, wrapped(end[2] - turn));
        (error, by)
    }
}

/// Displacement by radius, gain of the heading by the twist (r / B') and x_ICR, in closed form
/// but for the way; and its derivatives by the three.
fn linearise(rolled: &Rolled, parameters: Vector3<f64>) -> ([f64; 3], Matrix3<f64>) {
    let [radius, gain, icr_x] = parameters.into();
    let way = rolled.way(gain);
    let (sin, cos) = (gain * rolled.twist).sin_cos();
    let end = [
        radius * way.value[0] + icr_x * (1.0 - cos),
        radius * way.value[1] - icr_x * sin,
        gain * rolled.twist,
    ];
    let by_gain = [
        radius * way.by_gain[0] + icr_x * rolled.twist * sin,
        radius * way.by_gain[1] - icr_x * rolled.twist * cos,
        rolled.twist,
    ];
    let by = Matrix3::from_columns(&[
        Vector3::new(way.value[0], way.value[1], 0.0),
        Vector3::from(by_gain),
        Vector3::new(1.0 - cos, -sin, 0.0),
    ]);
    (end, by)
}

/// The best of a row of gains below and above the nominal one: vehicles that skid have tracks
/// up to several times as wide, and far from the solution headings are off by full turns.
fn first_guess(samples: &[Sample], nominal: &Kinematics) -> Option<Vector3<f64>> {
    let gain = nominal.wheel_radius / nominal.track;
    let guesses = (1..=40).map(|k| {
        let gain = 0.05 * f64::from(k) * gain;
        // With the gain given, the radius is linear.
        let (mut products, mut squares) = (0.0, 0.0);
        for sample in samples {
            let way = sample.rolled.way(gain).value;
            products += way[0] * sample.displacement[0] + way[1] * sample.displacement[1];
            squares += way[0] * way[0] + way[1] * way[1];
        }
        let guess = Vector3::new(products / squares, gain, 0.0);
        (cost(samples, guess), guess)
    });
    let usable = guesses.filter(|(cost, _)| cost.is_finite());
    Some(usable.min_by(|a, b| a.0.total_cmp(&b.0))?.1)
}

fn cost(samples: &[Sample], parameters: Vector3<f64>) -> f64 {
    samples
        .iter()
        .map(|sample| sample.residual(parameters).0.norm_squared())
        .sum()
}

/// Gradient and Gauss–Newton matrix of the first `free` parameters; the others stay.
fn normal(
    samples: &[Sample],
    parameters: Vector3<f64>,
    free: usize,
) -> (Vector3<f64>, Matrix3<f64>) {
    let mut gradient = Vector3::zeros();
    let mut matrix = Matrix3::zeros();
    for sample in samples {
        let (error, by) = sample.residual(parameters);
        gradient += by.transpose() * error;
        matrix += by.transpose() * by;
    }
    for fixed in free..3 {
        gradient[fixed] = 0.0;
        matrix.fill_row(fixed, 0.0);
        matrix.fill_column(fixed, 0.0);
        matrix[(fixed, fixed)] = 1.0;
    }
    (gradient, matrix)
}

/// Levenberg–Marquardt; `None` where the windows leave a parameter open.
fn solve(samples: &[Sample], start: Vector3<f64>, free: usize) -> Option<Vector3<f64>> {
    const ROUNDS: usize = 60;
    /// Steps below this share of the parameters change nothing that is reported.
    const CONVERGED: f64 = 1e-9;
    let (mut parameters, mut damping) = (start, 1e-4);
    let mut least = cost(samples, parameters);
    for _ in 0..ROUNDS {
        let (gradient, matrix) = normal(samples, parameters, free);
        let mut damped = matrix;
        for k in 0..3 {
            damped[(k, k)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&-gradient);
        let trial = cost(samples, parameters + step);
        if trial <= least {
            parameters += step;
            least = trial;
            damping /= 10.0;
            if step.norm() < CONVERGED * parameters.norm() {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }
    let sensible = parameters[1] != 0.0 && parameters.iter().all(|v| v.is_finite());
    sensible.then_some(parameters)
}

/// Covariance by the sandwich formula: windows overlap and errors last, so those of a block
/// may depend on each other in any way. `None` where there are too few blocks to tell.
fn covariance(
    samples: &[Sample],
    parameters: Vector3<f64>,
    free: usize,
    inverse: Matrix3<f64>,
) -> Option<Matrix3<f64>> {
    let mut blocks: BTreeMap<(usize, i64), Vec<&Sample>> = BTreeMap::new();
    for sample in samples {
        blocks.entry(sample.block).or_default().push(sample);
    }
    if blocks.len() < FEWEST_BLOCKS {
        return None;
    }
    let mut scatter = Matrix3::zeros();
    for block in blocks.values() {
        let mut gradient = Vector3::zeros();
        for sample in block {
            let (error, by) = sample.residual(parameters);
            gradient += by.transpose() * error;
        }
        for fixed in free..3 {
            gradient[fixed] = 0.0;
        }
        scatter += gradient * gradient.transpose();
    }
    // Few blocks scatter less than their errors do.
    let count = blocks.len() as f64;
    let corrected = count / (count - free as f64);
    Some(inverse * scatter * inverse * corrected)
}
