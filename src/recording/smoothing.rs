//! Curves behind noisy samples.
//!
//! Whittaker's smoother (E. T. Whittaker, "On a new method of graduation", Proc. Edinb. Math. Soc. 41 (1923)) with the
//! second differences of a curve that is straight between its knots: least squares of what the samples say and of the
//! bends, in a band of five diagonals.

/// An interval of so many usual ones is a gap.
const LONG: f64 = 2.0;

/// One equation of three neighbouring unknowns, the first of them, with its weight.
struct Row {
    first: usize,
    factors: [f64; 3],
    right: f64,
    weight: f64,
}

/// Values between which straight lines come close to the samples without bending much: sum (sample - line)^2 +
/// `smoothing` h^3 times the integral of (bend)^2, h the usual interval (so the sum of squared second differences where all
/// are alike). A sample is the line's value at its time, or, where they are `means`, its mean from the middle of the interval
/// before to the middle of the next (but at the ends and beside intervals that are more than twice as long as usual, where
/// nobody knows how long was counted). Without smoothing they are met.
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
        Row {
            first,
            factors,
            right: samples[row],
            weight: 1.0,
        }
    };
    let inner = (1..count - 1).flat_map(|row| {
        let (before, after) = (interval(row - 1), interval(row));
        let both = before + after;
        let told = if means && before.max(after) <= LONG * usual {
            // Of trapezia over half an interval on either side.
            [before / (4.0 * both), 0.75, after / (4.0 * both)]
        } else {
            [0.0, 1.0, 0.0]
        };
        let bend = [1.0 / before, -1.0 / before - 1.0 / after, 1.0 / after];
        let row_of = |factors, right, weight| Row {
            first: row - 1,
            factors,
            right,
            weight,
        };
        [
            row_of(told, samples[row], 1.0),
            row_of(bend, 0.0, 2.0 * bends / both),
        ]
    });
    let ends = [end(0), end(count - 1)];
    least_squares(count, ends.into_iter().chain(inner))
}

/// The unknowns that meet the equations best: the normal equations by L D L^T.
fn least_squares(count: usize, rows: impl Iterator<Item = Row>) -> Vec<f64> {
    // Of each unknown with itself, the one before, and the one before that.
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
            let mut left = DMatrix::zeros(14, 8);
            let mut right = DVector::zeros(14);
            for row in 0..8 {
                right[row] = SAMPLES[row];
                left[(row, row)] = 1.0;
                if row == 0 || row == 7 {
                    continue;
                }
                let (before, after) = (TIMES[row] - TIMES[row - 1], TIMES[row + 1] - TIMES[row]);
                // 0.1 s is just not too long, but for the last bits.
                if means && before.max(after) <= 0.1 {
                    left[(row, row)] = 0.75;
                    left[(row, row - 1)] = 0.25 * before / (before + after);
                    left[(row, row + 1)] = 0.25 * after / (before + after);
                }
                // The usual interval is 0.05 s.
                let root = (smoothing * 0.05_f64.powi(3) * 2.0 / (before + after)).sqrt();
                left[(7 + row, row - 1)] = root / before;
                left[(7 + row, row)] = -root / before - root / after;
                left[(7 + row, row + 1)] = root / after;
            }
            let normal = left.transpose() * &left;
            let dense = normal.lu().solve(&(left.transpose() * right)).unwrap();
            let banded = knots(&TIMES, &SAMPLES, means, smoothing);
            let apart = |(a, b): (&f64, &f64)| (a - b).abs();
            let most = dense.iter().zip(&banded).map(apart).fold(0.0, f64::max);
            assert!(most < 1e-10, "{means} {smoothing}: {most}");
        }
    }

    #[test]
    fn what_is_straight_stays_and_what_jitters_is_smoothed() {
        let line: Vec<f64> = TIMES.iter().map(|t| 1.0 + 2.0 * t).collect();
        let kept = knots(&TIMES, &line, false, 10.0);
        assert!(kept.iter().zip(&line).all(|(a, b)| (a - b).abs() < 1e-9));
        assert_eq!(knots(&TIMES, &SAMPLES, false, 0.0), SAMPLES);
        assert_eq!(knots(&[0.0, 1.0], &[1.0, 5.0], true, 1.0), [1.0, 5.0]);
        let time: Vec<f64> = (0..40).map(|k| 0.05 * f64::from(k)).collect();
        let jitter: Vec<f64> = (0..40).map(|k| f64::from(k % 2)).collect();
        let smooth = knots(&time, &jitter, false, 1.0);
        // Of the quickest wave 1 / (1 + 16 smoothing) stays.
        let swing = smooth[20] - smooth[19];
        assert!((swing.abs() - 1.0 / 17.0).abs() < 1e-3, "{swing}");
    }
}
