//! Smooth curves through noisy samples.
//!
//! Whittaker's smoother: E. T. Whittaker, "On a new method of graduation", Proc. Edinb. Math. Soc. 41 (1923). The curve is
//! straight between its knots. Least squares of its distances from the samples and of its bends gives a band matrix of
//! five diagonals.

/// An interval longer than this multiple of the usual one is a gap.
const LONG: f64 = 2.0;

/// A weighted equation of three neighbouring unknowns, from index `first` on.
struct Equation {
    first: usize,
    factors: [f64; 3],
    right: f64,
    weight: f64,
}

/// Knots of the piecewise linear curve with the minimum of sum (sample - line)^2 + `smoothing` h^3 times the integral of
/// (bend)^2. Here h is the usual interval. For equal intervals the second term is the sum of squared second differences.
///
/// A sample is the line's value at its time. With `means` it is the line's mean from the middle of the interval before to
/// the middle of the interval after. At the ends, and beside intervals more than twice as long as usual, the counting time
/// is unknown, so a sample is a value there. Without smoothing the curve meets every sample.
#[must_use]
pub fn knots(time: &[f64], samples: &[f64], means: bool, smoothing: f64) -> Vec<f64> {
    let count = samples.len();
    if count < 3 {
        return samples.to_vec();
    }
    let interval = |row: usize| time[row + 1] - time[row];
    let mut intervals: Vec<f64> = (0..count - 1).map(interval).collect();
    let (_, &mut usual, _) = intervals.select_nth_unstable_by((count - 1) / 2, f64::total_cmp);
    let bends = smoothing * usual.powi(3);
    let end = |row: usize| {
        let first = row.min(count - 3);
        let mut factors = [0.0; 3];
        factors[row - first] = 1.0;
        Equation {
            first,
            factors,
            right: samples[row],
            weight: 1.0,
        }
    };
    let inner = (1..count - 1).flat_map(|row| {
        let (before, after) = (interval(row - 1), interval(row));
        let both = before + after;
        let sample = if means && before.max(after) <= LONG * usual {
            // Trapezia over half an interval on either side.
            [before / (4.0 * both), 0.75, after / (4.0 * both)]
        } else {
            [0.0, 1.0, 0.0]
        };
        let bend = [1.0 / before, -1.0 / before - 1.0 / after, 1.0 / after];
        let equation = |factors, right, weight| Equation {
            first: row - 1,
            factors,
            right,
            weight,
        };
        [
            equation(sample, samples[row], 1.0),
            equation(bend, 0.0, 2.0 * bends / both),
        ]
    });
    let ends = [end(0), end(count - 1)];
    least_squares(count, ends.into_iter().chain(inner))
}

/// Least squares: solves the normal equations by L D L^T.
fn least_squares(count: usize, rows: impl Iterator<Item = Equation>) -> Vec<f64> {
    // Products of each unknown with itself and with the two before it.
    let mut band = vec![[0.0; 3]; count];
    let mut solution = vec![0.0; count];
    for row in rows {
        for (place, factor) in row.factors.iter().enumerate() {
            let unknown = row.first + place;
            solution[unknown] += row.weight * factor * row.right;
            for (back, other) in row.factors[..=place].iter().rev().enumerate() {
                band[unknown][back] += row.weight * factor * other;
            }
        }
    }
    for at in 0..count {
        let [mut own, mut one, mut two] = band[at];
        if at > 1 {
            let (off, diagonal) = (band[at - 1][1], band[at - 2][0]);
            one -= two * off;
            own -= two * two / diagonal;
            two /= diagonal;
        }
        if at > 0 {
            let diagonal = band[at - 1][0];
            own -= one * one / diagonal;
            one /= diagonal;
        }
        band[at] = [own, one, two];
        for back in 1..=at.min(2) {
            solution[at] -= band[at][back] * solution[at - back];
        }
    }
    for (value, [diagonal, ..]) in solution.iter_mut().zip(&band) {
        *value /= diagonal;
    }
    for at in (0..count).rev() {
        for back in 1..=at.min(2) {
            solution[at - back] -= band[at][back] * solution[at];
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    const TIMES: [f64; 8] = [0.0, 0.05, 0.11, 0.15, 0.2, 0.3, 0.35, 0.4];
    const SAMPLES: [f64; 8] = [0.0, 0.0, 1.0, 3.0, 2.5, 2.0, 2.0, 2.0];

    #[test]
    fn knots_are_the_least_squares_of_a_dense_problem() {
        for (means, smoothing) in [(false, 0.7), (true, 0.0), (true, 0.2)] {
            let mut matrix = DMatrix::zeros(14, 8);
            let mut right = DVector::zeros(14);
            for row in 0..8 {
                right[row] = SAMPLES[row];
                matrix[(row, row)] = 1.0;
                if row == 0 || row == 7 {
                    continue;
                }
                let (before, after) = (TIMES[row] - TIMES[row - 1], TIMES[row + 1] - TIMES[row]);
                // 0.1 s is just not too long, but for the last bits.
                if means && before.max(after) <= 0.1 {
                    matrix[(row, row)] = 0.75;
                    matrix[(row, row - 1)] = 0.25 * before / (before + after);
                    matrix[(row, row + 1)] = 0.25 * after / (before + after);
                }
                // The usual interval is 0.05 s.
                let root = (smoothing * 0.05_f64.powi(3) * 2.0 / (before + after)).sqrt();
                matrix[(7 + row, row - 1)] = root / before;
                matrix[(7 + row, row)] = -root / before - root / after;
                matrix[(7 + row, row + 1)] = root / after;
            }
            let normal = matrix.transpose() * &matrix;
            let dense = normal.lu().solve(&(matrix.transpose() * right)).unwrap();
            let banded = knots(&TIMES, &SAMPLES, means, smoothing);
            let apart = |(a, b): (&f64, &f64)| (a - b).abs();
            let worst = dense.iter().zip(&banded).map(apart).fold(0.0, f64::max);
            assert!(worst < 1e-10, "{means} {smoothing}: {worst}");
        }
    }

    #[test]
    fn a_line_stays_and_jitter_is_smoothed() {
        let line: Vec<f64> = TIMES.iter().map(|t| 1.0 + 2.0 * t).collect();
        let kept = knots(&TIMES, &line, false, 10.0);
        assert!(kept.iter().zip(&line).all(|(a, b)| (a - b).abs() < 1e-9));
        assert_eq!(knots(&TIMES, &SAMPLES, false, 0.0), SAMPLES);
        assert_eq!(knots(&[0.0, 1.0], &[1.0, 5.0], true, 1.0), [1.0, 5.0]);
        let time: Vec<f64> = (0..40).map(|k| 0.05 * f64::from(k)).collect();
        let jitter: Vec<f64> = (0..40).map(|k| f64::from(k % 2)).collect();
        let smooth = knots(&time, &jitter, false, 1.0);
        // The fastest oscillation is damped to 1 / (1 + 16 smoothing).
        let swing = smooth[20] - smooth[19];
        assert!((swing.abs() - 1.0 / 17.0).abs() < 1e-3, "{swing}");
    }
}
