//! Steps of a linearised problem within bounds.

use super::parameter::FreeParameter;
use nalgebra::{DMatrix, DVector};

/// Rounds at most, for each number.
const ROUNDS: usize = 4;

/// How far down (at most 0) and up (at least 0) each coordinate may go.
#[must_use]
pub fn room(parameters: &[FreeParameter], coordinates: &DVector<f64>) -> Vec<(f64, f64)> {
    let pairs = parameters.iter().zip(coordinates.iter());
    let room = |(parameter, at): (&FreeParameter, &f64)| {
        let (low, high) = parameter.bounds();
        ((low - at).min(0.0), (high - at).max(0.0))
    };
    pairs.map(room).collect()
}

/// The step s that raises g^T s - s^T H s / 2 most without leaving `room`, how far down and up each number
/// may go (from at most 0 to at least 0).
///
/// A primal active set (J. Nocedal & S. Wright, "Numerical Optimization", ch. 16): what stands on its bound and
/// is pushed outward, or reaches its bound on the way, is held there while the rest moves on to where it is
/// best beside that; then what is pulled back inward is let go again, one at a time. A step that is cut at the bounds
/// instead may lead uphill where numbers are correlated. `None` where H is not positive definite.
#[must_use]
pub fn step_within(
    matrix: &DMatrix<f64>,
    gradient: &DVector<f64>,
    room: &[(f64, f64)],
) -> Option<DVector<f64>> {
    let count = gradient.len();
    let mut taken = DVector::zeros(count);
    let outward = |(pull, (low, high)): (&f64, &(f64, f64))| {
        (*low == 0.0 && *pull < 0.0) || (*high == 0.0 && *pull > 0.0)
    };
    let mut held: Vec<bool> = gradient.iter().zip(room).map(outward).collect();
    // Each round holds or lets go one number: more would be going round in a circle.
    for _ in 0..ROUNDS * (count + 1) {
        let mut system = matrix.clone();
        let mut left = gradient - matrix * &taken;
        for k in (0..count).filter(|k| held[*k]) {
            hold(&mut system, &mut left, k);
        }
        let step = system.cholesky()?.solve(&left);
        let share_to_bound = |k: usize| {
            let (low, high) = room[k];
            let end = taken[k] + step[k];
            let bound = end.clamp(low, high);
            let share = ((bound - taken[k]) / step[k]).max(0.0);
            (bound != end && !held[k]).then_some((k, bound, share))
        };
        let first = (0..count).filter_map(share_to_bound);
        if let Some((k, bound, share)) = first.min_by(|a, b| a.2.total_cmp(&b.2)) {
            taken += step * share;
            taken[k] = bound;
            held[k] = true;
            continue;
        }
        taken += step;
        let pull = gradient - matrix * &taken;
        let inward = |k: &usize| {
            let (low, high) = room[*k];
            let away = if taken[*k] <= low {
                pull[*k]
            } else {
                -pull[*k]
            };
            held[*k] && low < high && away > 0.0
        };
        let strongest = |a: &usize, b: &usize| {
            let gain = |k: usize| pull[k].powi(2) / matrix[(k, k)];
            gain(*a).total_cmp(&gain(*b))
        };
        match (0..count).filter(inward).max_by(strongest) {
            Some(k) => held[k] = false,
            None => break,
        }
    }
    Some(taken)
}

/// Takes an unknown out of a system: its step is zero.
fn hold(matrix: &mut DMatrix<f64>, gradient: &mut DVector<f64>, k: usize) {
    matrix.row_mut(k).fill(0.0);
    matrix.column_mut(k).fill(0.0);
    matrix[(k, k)] = 1.0;
    gradient[k] = 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(matrix: &DMatrix<f64>, gradient: &DVector<f64>, step: &DVector<f64>) -> f64 {
        gradient.dot(step) - 0.5 * step.dot(&(matrix * step))
    }

    #[test]
    fn correlated_numbers_at_a_bound_still_make_a_step_uphill() {
        // The free step is (-3, 3.1), but the first number stands on its lower bound.
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 0.99, 0.99, 1.0]) * 1e4;
        let gradient = &matrix * DVector::from_vec(vec![-3.0, 3.1]);
        let cut = DVector::from_vec(vec![0.0, 3.1]);
        assert!(gain(&matrix, &gradient, &cut) < 0.0);
        let step = step_within(&matrix, &gradient, &[(0.0, 9.0), (-9.0, 9.0)]).unwrap();
        assert!(step[0] == 0.0 && (step[1] - 0.13).abs() < 1e-9, "{step}");
        assert!(gain(&matrix, &gradient, &step) > 0.0);
    }

    #[test]
    fn within_the_bounds_it_is_newtons_step() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 0.5, 0.5, 1.0]);
        let gradient = DVector::from_vec(vec![1.0, -0.3]);
        let free = matrix.clone().cholesky().unwrap().solve(&gradient);
        let step = step_within(&matrix, &gradient, &[(-9.0, 9.0), (-9.0, 9.0)]).unwrap();
        assert_eq!(step, free);
        // Both in the way: both at their bounds.
        let tight = step_within(&matrix, &gradient, &[(-0.1, 0.1), (-0.1, 0.1)]).unwrap();
        assert!((tight - DVector::from_vec(vec![0.1, -0.1])).amax() < 1e-15);
    }

    #[test]
    fn what_is_held_on_the_way_is_let_go_where_it_is_pulled_back() {
        // Best is (-3, 10), from (1, 1) in a square from 0 to 5: first to the corner (0, 5), from there on to (1.95, 5).
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 0.99, 0.99, 1.0]);
        let gradient = &matrix * DVector::from_vec(vec![-4.0, 9.0]);
        let step = step_within(&matrix, &gradient, &[(-1.0, 4.0), (-1.0, 4.0)]).unwrap();
        assert!((step[0] - 0.95).abs() < 1e-9 && step[1] == 4.0, "{step}");
        let corner = DVector::from_vec(vec![-1.0, 4.0]);
        assert!(gain(&matrix, &gradient, &step) > gain(&matrix, &gradient, &corner));
        // From the corner itself: no reason to stay.
        let left = &gradient - &matrix * &corner;
        let step = step_within(&matrix, &left, &[(0.0, 5.0), (-5.0, 0.0)]).unwrap();
        assert!((step[0] - 1.95).abs() < 1e-9 && step[1] == 0.0, "{step}");
    }
}
