//! Kinematic models of a skid-steer vehicle, and their fit to windows.
//!
//! A. Mandow, J. L. Martínez, J. Morales, J. L. Blanco, A. García-Cerezo, J. González,
//! "Experimental kinematics for wheeled skid-steer mobile robots", IROS 2007, after J. L.
//! Martínez et al., "Approximating kinematics for tracked mobile robots", IJRR 24(10), 2005:
//! on even ground the centres of rotation of the wheels of either side hardly move.

use super::signals::wrapped;
use super::windows::PredictionWindow;
use crate::recording::{Drive, IntervalEstimate, MIN_BLOCKS};
use crate::vehicle::Vehicle;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// Minimum number of windows for a fit of up to three parameters.
pub(super) const MIN_WINDOWS: usize = 4;
/// Longest step of the integrals \[s\].
const STEP: f64 = 0.02;

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

/// Which parameters are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KinematicsForm {
    /// Radius and track.
    TwoParameter,
    /// Radius, track, and x_ICR: the centres of rotation may lie ahead of the reference point or behind it.
    ThreeParameter,
}

/// Kinematics with the intervals of their parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedKinematics {
    /// The fitted model.
    pub kinematics: Kinematics,
    /// Effective radius \[m\].
    pub wheel_radius: IntervalEstimate,
    /// Effective track \[m\].
    pub track: IntervalEstimate,
    /// Position of the centres of rotation \[m\]; `None` if it is not fitted.
    pub icr_x: Option<IntervalEstimate>,
}

impl Kinematics {
    /// Wheels that roll without slip along the vehicle.
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
    pub fn predict(&self, window: &PredictionWindow) -> [f64; 3] {
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

    /// Fits the parameters by least squares of the errors at the ends of windows; a metre counts as much as a radian. The
    /// search starts around `nominal`. `None` with too few windows, or if they do not determine the parameters.
    #[must_use]
    pub fn fit(
        form: KinematicsForm,
        windows: &[&PredictionWindow],
        nominal: &Self,
    ) -> Option<FittedKinematics> {
        if windows.len() < MIN_WINDOWS {
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
            wheel_radius: IntervalEstimate::normal(radius, error(Vector3::x())),
            track: IntervalEstimate::normal(track, error(by_track)),
            icr_x: (free == 3).then(|| IntervalEstimate::normal(icr_x, error(Vector3::z()))),
        };
        let widths = [fitted.wheel_radius.width(), fitted.track.width()];
        (!widths.iter().any(|width| width.is_nan())).then_some(fitted)
    }
}

/// Integrals of wheel speeds over a window, from which kinematic models follow.
#[derive(Debug, Clone)]
struct Rolled {
    /// Per step: the mean wheel angle rolled \[rad\], and the twist in the middle. The twist is the angle of the right wheels
    /// minus that of the left ones \[rad\].
    steps: Vec<(f64, f64)>,
    /// Twist at the end \[rad\].
    twist: f64,
}

/// Integrals of the rolled angle along the heading, and their derivatives by the gain of the twist.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct RolledPath {
    /// Of the cosine and the sine \[rad\].
    value: [f64; 2],
    /// Derivatives.
    by_gain: [f64; 2],
}

impl Rolled {
    fn new(wheels: &Drive) -> Self {
        let mut steps = Vec::new();
        let mut twist = 0.0;
        for row in 0..wheels.len().saturating_sub(1) {
            let seconds = wheels.time[row + 1] - wheels.time[row];
            let (from, rates) = (wheels.wheel_speeds(row), wheels.wheel_accelerations(row));
            let count = (seconds / STEP).ceil().max(1.0);
            let step = seconds / count;
            for k in 0..count as usize {
                let middle = (k as f64 + 0.5) * step;
                let [left, right] = [0, 1].map(|side| from[side] + rates[side] * middle);
                let change = (right - left) * step;
                steps.push((0.5 * (left + right) * step, twist + 0.5 * change));
                twist += change;
            }
        }
        Self { steps, twist }
    }

    /// The path if the heading changes by `gain` times the twist.
    fn path(&self, gain: f64) -> RolledPath {
        self.steps
            .iter()
            .fold(RolledPath::default(), |mut path, (rolled, twist)| {
                let (sin, cos) = (gain * twist).sin_cos();
                path.value[0] += rolled * cos;
                path.value[1] += rolled * sin;
                path.by_gain[0] -= rolled * twist * sin;
                path.by_gain[1] += rolled * twist * cos;
                path
            })
    }
}

/// A window's data for the fit.
struct Sample {
    rolled: Rolled,
    displacement: [f64; 3],
    block: (usize, i64),
}

impl Sample {
    fn new(window: &PredictionWindow) -> Self {
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

/// Displacement and its derivatives by radius, gain of the heading (r / B') and x_ICR, in closed form except for the path.
fn linearise(rolled: &Rolled, parameters: Vector3<f64>) -> ([f64; 3], Matrix3<f64>) {
    let [radius, gain, icr_x] = parameters.into();
    let path = rolled.path(gain);
    let (sin, cos) = (gain * rolled.twist).sin_cos();
    let end = [
        radius * path.value[0] + icr_x * (1.0 - cos),
        radius * path.value[1] - icr_x * sin,
        gain * rolled.twist,
    ];
    let by_gain = [
        radius * path.by_gain[0] + icr_x * rolled.twist * sin,
        radius * path.by_gain[1] - icr_x * rolled.twist * cos,
        rolled.twist,
    ];
    let by = Matrix3::from_columns(&[
        Vector3::new(path.value[0], path.value[1], 0.0),
        Vector3::from(by_gain),
        Vector3::new(1.0 - cos, -sin, 0.0),
    ]);
    (end, by)
}

/// The best of a series of gains below and above the nominal one. The effective track of a skidding vehicle is up to
/// several times as wide, and far from the solution headings are wrong by full turns.
fn first_guess(samples: &[Sample], nominal: &Kinematics) -> Option<Vector3<f64>> {
    let gain = nominal.wheel_radius / nominal.track;
    let guesses = (1..=40).map(|k| {
        let gain = 0.05 * f64::from(k) * gain;
        // With the gain given, the radius is linear.
        let (mut products, mut squares) = (0.0, 0.0);
        for sample in samples {
            let path = sample.rolled.path(gain).value;
            products += path[0] * sample.displacement[0] + path[1] * sample.displacement[1];
            squares += path[0] * path[0] + path[1] * path[1];
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

/// Gradient and Gauss–Newton matrix of the first `free` parameters; the others are fixed.
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

/// Levenberg–Marquardt; `None` if the windows do not determine a parameter.
fn solve(samples: &[Sample], start: Vector3<f64>, free: usize) -> Option<Vector3<f64>> {
    const ROUNDS: usize = 60;
    /// Relative step below which no reported digit changes.
    const CONVERGED: f64 = 1e-9;
    let (mut parameters, mut damping) = (start, 1e-4);
    let mut lowest = cost(samples, parameters);
    for _ in 0..ROUNDS {
        let (gradient, matrix) = normal(samples, parameters, free);
        let mut damped = matrix;
        for k in 0..3 {
            damped[(k, k)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&-gradient);
        let trial = cost(samples, parameters + step);
        if trial <= lowest {
            parameters += step;
            lowest = trial;
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

/// Covariance by the sandwich formula. Windows overlap and errors persist, so the errors within a block may depend on each
/// other. `None` with too few blocks.
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
    if blocks.len() < MIN_BLOCKS {
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
    // Correction for few blocks, whose scatter is too small.
    let count = blocks.len() as f64;
    let corrected = count / (count - free as f64);
    Some(inverse * scatter * inverse * corrected)
}
