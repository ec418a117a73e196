//! The velocities at the start of a window.

use super::signals::Signals;
use crate::recording::median;
use nalgebra::{SMatrix, SVector};

/// Reaches of the fit to positions on either side \[s\]: the first with enough samples counts. It is short because the
/// acceleration is assumed constant; a position error of 0.03 m at 10 Hz gives 0.03 m/s.
const REACHES: [f64; 3] = [0.5, 1.0, 2.0];
/// Minimum number of samples.
const MIN_SAMPLES: usize = 6;
/// Reach of the fit to the yaw rate on either side \[s\].
const GYRO_REACH: f64 = 0.2;
/// Step of the integrals \[s\].
const STEP: f64 = 0.025;
/// Assumed error of a position \[m\], and prior of the acceleration \[m/s^2\], which samples on one side alone cannot
/// separate from the velocity.
const POSITION_NOISE: f64 = 0.03;
const ACCELERATION: f64 = 1.0;
/// Beyond this multiple of the median residual a sample has less weight (Huber).
const HUBER: f64 = 2.0;
/// Rounds of reweighting.
const ROUNDS: usize = 5;

type Unknowns = SVector<f64, 5>;

/// Velocities ahead and to the left \[m/s\] and yaw rate \[rad/s\] at a time.
///
/// The positions within reach, before and after, are fitted by a vehicle that turns as recorded, with a constant lateral
/// velocity and a constant forward acceleration. Nothing is differentiated. `None` with too few samples.
pub(super) fn velocities(signals: &Signals, time: f64, heading: f64) -> Option<[f64; 3]> {
    let samples = |reach: &f64| signals.position_times(time - reach, time + reach).count();
    let enough = |reach: &&f64| samples(reach) >= MIN_SAMPLES;
    let reach = *REACHES.iter().find(enough)?;
    let yaw_rate = yaw_rate(signals, time, reach)?;
    let turned = |at: f64| {
        let by_gyro = || Some(signals.turned(at)? - signals.turned(time)?);
        let by_pose = || Some(signals.pose(at)?[2] - signals.pose(time)?[2]);
        by_gyro().or_else(by_pose).unwrap_or((at - time) * yaw_rate)
    };
    let mut rows: Vec<(Unknowns, f64)> = Vec::new();
    for at in signals.position_times(time - reach, time + reach) {
        let [x, y, _] = signals.pose(at)?;
        let [c, s, c_t, s_t] = integrals(at - time, |t| heading + turned(time + t));
        rows.push((Unknowns::from([1.0, 0.0, c, -s, c_t]), x));
        rows.push((Unknowns::from([0.0, 1.0, s, c, s_t]), y));
    }
    let [_, _, v_x, v_y, _] = robust(&rows)?.into();
    Some([v_x, v_y, yaw_rate])
}

/// From a line through the yaw rates around, or through the headings without a gyro.
fn yaw_rate(signals: &Signals, time: f64, reach: f64) -> Option<f64> {
    let rates = signals.yaw_rates(time - GYRO_REACH, time + GYRO_REACH);
    if rates.len() >= 3 {
        return Some(line(&rates, time)?.0);
    }
    Some(line(&signals.headings(time - reach, time + reach), time)?.1)
}

/// Value and slope at a time of the line through samples.
fn line(samples: &[(f64, f64)], time: f64) -> Option<(f64, f64)> {
    let count = samples.len() as f64;
    let mean = |pick: fn(&(f64, f64)) -> f64| samples.iter().map(pick).sum::<f64>() / count;
    let (t, v) = (mean(|s| s.0), mean(|s| s.1));
    let squares: f64 = samples.iter().map(|s| (s.0 - t).powi(2)).sum();
    let products: f64 = samples.iter().map(|s| (s.0 - t) * (s.1 - v)).sum();
    let slope = products / squares;
    slope.is_finite().then_some((v + slope * (time - t), slope))
}

/// Integrals from 0 to `end` of cos, sin, t cos and t sin of a heading that depends on t.
fn integrals(end: f64, heading: impl Fn(f64) -> f64) -> [f64; 4] {
    let steps = (end.abs() / STEP).ceil().max(1.0);
    let step = end / steps;
    (0..steps as usize).fold([0.0; 4], |sums, k| {
        let t = (k as f64 + 0.5) * step;
        let (sin, cos) = heading(t).sin_cos();
        [
            sums[0] + cos * step,
            sums[1] + sin * step,
            sums[2] + t * cos * step,
            sums[3] + t * sin * step,
        ]
    })
}

/// Least squares with Huber's weights; x and y of a sample share their weight.
fn robust(rows: &[(Unknowns, f64)]) -> Option<Unknowns> {
    let mut weights = vec![1.0; rows.len() / 2];
    let mut best = None;
    for _ in 0..ROUNDS {
        let mut normal = SMatrix::<f64, 5, 5>::zeros();
        let mut right = Unknowns::zeros();
        normal[(4, 4)] = (POSITION_NOISE / ACCELERATION).powi(2);
        for (index, (row, value)) in rows.iter().enumerate() {
            let weight = weights[index / 2];
            normal += row * row.transpose() * weight;
            right += row * (*value * weight);
        }
        let solution = normal.cholesky()?.solve(&right);
        let distance = |pair: &[(Unknowns, f64)]| {
            let [a, b] = [0, 1].map(|k| pair[k].1 - pair[k].0.dot(&solution));
            a.hypot(b)
        };
        let distances: Vec<f64> = rows.chunks_exact(2).map(distance).collect();
        let limit = HUBER * median(&mut distances.clone());
        for (weight, distance) in weights.iter_mut().zip(&distances) {
            *weight = if *distance > limit {
                limit / distance
            } else {
                1.0
            };
        }
        best = Some(solution);
    }
    best.filter(|solution| solution.iter().all(|v| v.is_finite()))
}
