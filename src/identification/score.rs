//! Errors of predictions, and what is told of them.

use super::estimate::quantile;
use super::signals::wrapped;
use super::{Estimate, Window};
use std::collections::BTreeMap;

/// How far a prediction is off at the end of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictionError {
    /// Distance from the recorded position \[m\].
    pub position: f64,
    /// Angle to the recorded heading \[rad\], 0 to pi.
    pub heading: f64,
}

impl PredictionError {
    /// Of predicted x, y and heading.
    #[must_use]
    pub fn new(window: &Window, predicted: [f64; 3]) -> Self {
        let [x, y, heading] = window.end;
        Self {
            position: (predicted[0] - x).hypot(predicted[1] - y),
            heading: wrapped(predicted[2] - heading).abs(),
        }
    }
}

/// Statistics of many errors, with intervals from a bootstrap over blocks of windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Half of the errors are smaller.
    pub median: Estimate,
    /// 95 % of the errors are smaller.
    pub p95: Estimate,
    /// Root of the mean square.
    pub rmse: Estimate,
}

/// The windows for which every model has a prediction: all are to be judged by the same.
/// Models that failed everywhere take nobody's windows away.
#[must_use]
pub fn common(predictions: &[Vec<Option<PredictionError>>]) -> Vec<usize> {
    let usable: Vec<_> = predictions
        .iter()
        .filter(|p| p.iter().any(Option::is_some))
        .collect();
    let windows = predictions.first().map_or(0, Vec::len);
    (0..windows)
        .filter(|window| usable.iter().all(|p| p[*window].is_some()))
        .collect()
}

/// Sums errors up; `blocks` holds for each the number of the stretch that it belongs to.
/// `None` without errors.
pub fn summarise<B: Ord>(errors: &[f64], blocks: impl IntoIterator<Item = B>) -> Option<Summary> {
    let mut grouped: BTreeMap<B, Vec<f64>> = BTreeMap::new();
    for (error, block) in errors.iter().zip(blocks) {
        grouped.entry(block).or_default().push(*error);
    }
    if grouped.is_empty() {
        return None;
    }
    let groups: Vec<Vec<f64>> = grouped.into_values().collect();
    let drawn = |blocks: &[usize]| -> Vec<f64> {
        blocks
            .iter()
            .flat_map(|block| groups[*block].iter().copied())
            .collect()
    };
    let share = |share: f64| {
        Estimate::bootstrap(groups.len(), |blocks| {
            let mut values = drawn(blocks);
            values.sort_unstable_by(f64::total_cmp);
            quantile(&values, share)
        })
    };
    let rmse = Estimate::bootstrap(groups.len(), |blocks| {
        let values = drawn(blocks);
        (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
    });
    Some(Summary {
        median: share(0.5),
        p95: share(0.95),
        rmse,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ERROR: PredictionError = PredictionError {
        position: 1.0,
        heading: 0.1,
    };

    #[test]
    fn only_windows_that_all_models_predict_are_common() {
        let (yes, no) = (Some(ERROR), None);
        let never = vec![no; 3];
        assert_eq!(common(&[vec![yes; 3], vec![yes, no, yes]]), [0, 2]);
        assert_eq!(common(&[vec![yes; 3], never.clone()]), [0, 1, 2]);
        assert_eq!(common(&[never]), [0, 1, 2]);
        assert_eq!(common(&[]), [0; 0]);
    }

    #[test]
    fn errors_are_summed_up_with_intervals() {
        let errors: Vec<f64> = (0..=100).map(f64::from).collect();
        let summary = summarise(&errors, (0..=100).map(|k| k / 5)).unwrap();
        assert_eq!((summary.median.value, summary.p95.value), (50.0, 95.0));
        assert!((summary.rmse.value - 57.88).abs() < 0.01, "{summary:?}");
        for estimate in [summary.median, summary.p95, summary.rmse] {
            assert!(estimate.low < estimate.value && estimate.value <= estimate.high);
        }
        assert_eq!(summarise::<u8>(&[], []), None);
    }
}
