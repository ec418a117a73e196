//! Fewer points that look the same.

/// Runs of finite points.
pub fn connected(points: &[(f64, f64)]) -> impl Iterator<Item = &[(f64, f64)]> {
    let finite = |point: &(f64, f64)| point.0.is_finite() && point.1.is_finite();
    points
        .split(move |point| !finite(point))
        .filter(|part| !part.is_empty())
}

/// Of every three strides of points the first, the lowest and the highest, so that peaks stay.
pub fn thinned(points: &[(f64, f64)], stride: usize) -> Vec<(f64, f64)> {
    if stride < 2 {
        return points.to_vec();
    }
    let mut kept = Vec::new();
    for chunk in points.chunks(3 * stride) {
        let by_value =
            |a: &&(usize, &(f64, f64)), b: &&(usize, &(f64, f64))| a.1.1.total_cmp(&b.1.1);
        let chunk: Vec<_> = chunk.iter().enumerate().collect();
        let mut some: Vec<_> = [
            chunk.first(),
            chunk.iter().min_by(by_value),
            chunk.iter().max_by(by_value),
        ]
        .into_iter()
        .flatten()
        .collect();
        some.sort_by_key(|point| point.0);
        some.dedup_by_key(|point| point.0);
        kept.extend(some.into_iter().map(|point| *point.1));
    }
    kept.extend(points.last());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_peaks() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|k| (f64::from(k), 0.0)).collect();
        points[4321].1 = 7.0;
        points[1234].1 = -3.0;
        let kept = thinned(&points, 10);
        assert!(kept.len() < 1200);
        for point in [points[0], points[4321], points[1234], points[9999]] {
            assert!(kept.contains(&point));
        }
        assert!(kept.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    #[test]
    fn gaps_part() {
        let points = [
            (f64::NAN, 0.0),
            (1.0, 1.0),
            (2.0, f64::INFINITY),
            (3.0, 1.0),
            (4.0, 1.0),
        ];
        let lengths: Vec<usize> = connected(&points).map(<[_]>::len).collect();
        assert_eq!(lengths, [1, 2]);
    }
}
