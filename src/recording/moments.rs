//! Sums from which correlation and slope of two signals follow.

/// Number, sums and sums of products of pairs (a, b).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    /// Number of pairs.
    pub count: f64,
    a: f64,
    b: f64,
    aa: f64,
    bb: f64,
    ab: f64,
}

impl Moments {
    /// Adds a pair.
    pub fn push(&mut self, a: f64, b: f64) {
        self.count += 1.0;
        self.a += a;
        self.b += b;
        self.aa += a * a;
        self.bb += b * b;
        self.ab += a * b;
    }

    /// Of the pairs (a so many grid steps later, b) where both are known; `indices` are b's.
    #[must_use]
    pub fn shifted(
        a: &[Option<f64>],
        b: &[Option<f64>],
        shift: isize,
        indices: std::ops::Range<usize>,
    ) -> Self {
        let mut moments = Self::default();
        for index in indices {
            let later = index.checked_add_signed(shift).and_then(|at| *a.get(at)?);
            if let (Some(a), Some(b)) = (later, b[index]) {
                moments.push(a, b);
            }
        }
        moments
    }

    /// The pairs of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            a: self.a + other.a,
            b: self.b + other.b,
            aa: self.aa + other.aa,
            bb: self.bb + other.bb,
            ab: self.ab + other.ab,
        }
    }

    /// The same pairs less their own means, so that sums over several sets compare only
    /// what varies within each.
    #[must_use]
    pub fn centred(self) -> Self {
        let count = self.count.max(1.0);
        Self {
            count: self.count,
            a: 0.0,
            b: 0.0,
            aa: (self.aa - self.a * self.a / count).max(0.0),
            bb: (self.bb - self.b * self.b / count).max(0.0),
            ab: self.ab - self.a * self.b / count,
        }
    }

    /// Pearson's correlation; 0 where one of both does not vary.
    #[must_use]
    pub fn correlation(self) -> f64 {
        let Self { aa, bb, ab, .. } = self.centred();
        let scale = (aa * bb).sqrt();
        // What is left of a constant is rounding.
        let varies = aa > 1e-12 * self.aa && bb > 1e-12 * self.bb && scale > 0.0;
        if varies { ab / scale } else { 0.0 }
    }

    /// By how much a grows with b; 0 where b does not vary.
    #[must_use]
    pub fn slope(self) -> f64 {
        let Self { bb, ab, .. } = self.centred();
        if bb > 0.0 { ab / bb } else { 0.0 }
    }

    /// How much a is by b, where a is none without b; 0 where b is none.
    #[must_use]
    pub fn proportion(self) -> f64 {
        if self.bb > 0.0 {
            self.ab / self.bb
        } else {
            0.0
        }
    }

    /// Standard deviations of a and b.
    #[must_use]
    pub fn deviations(self) -> (f64, f64) {
        let Self { count, aa, bb, .. } = self.centred();
        let count = count.max(1.0);
        ((aa / count).sqrt(), (bb / count).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_is_recovered() {
        let b: Vec<Option<f64>> = (0..50).map(|k| Some((0.3 * f64::from(k)).sin())).collect();
        let a: Vec<Option<f64>> = (0..50)
            .map(|k| (k > 2).then(|| 4.0 - 3.0 * (0.3 * f64::from(k - 3)).sin()))
            .collect();
        let moments = Moments::shifted(&a, &b, 3, 0..50);
        assert_eq!(moments.count, 47.0);
        assert!((moments.slope() + 3.0).abs() < 1e-12);
        assert!((moments.correlation() + 1.0).abs() < 1e-12);
        let through_origin = (4.0 * moments.b - 3.0 * moments.bb) / moments.bb;
        assert!((moments.proportion() - through_origin).abs() < 1e-12);
        let (da, db) = moments.deviations();
        assert!((da - 3.0 * db).abs() < 1e-12);
        let twice = moments.centred().and(moments.centred());
        assert!((twice.slope() + 3.0).abs() < 1e-12);
    }

    #[test]
    fn constants_do_not_correlate() {
        let mut moments = Moments::default();
        for k in 0..9 {
            moments.push(0.1, f64::from(k));
        }
        assert_eq!(moments.correlation(), 0.0);
        assert_eq!(Moments::default().correlation(), 0.0);
    }
}
