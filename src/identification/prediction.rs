//! Models that predict the end of a window, and the errors of their predictions.

use super::kinematics::Kinematics;
use super::signals::wrapped;
use super::windows::PredictionWindow;
use crate::recording::{IntervalEstimate, quantile};
use crate::simulation::{Simulation, SimulationError};
use crate::vehicle::VehicleModel;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A model that predicts from a window's start and its wheel speeds.
#[derive(Debug, Clone)]
pub enum MotionModel {
    /// Velocities follow from the wheel speeds alone.
    Kinematics(Kinematics),
    /// The wheel–terrain model.
    Soil(Arc<VehicleModel>),
}

impl MotionModel {
    /// x \[m\], y \[m\] and heading \[rad\] at the end of a window.
    ///
    /// # Errors
    /// A state without a solution; its time counts from the window's start.
    pub fn predict(&self, window: &PredictionWindow) -> Result<[f64; 3], SimulationError> {
        match self {
            Self::Kinematics(kinematics) => Ok(kinematics.predict(window)),
            Self::Soil(model) => simulate(model, window),
        }
    }
}

fn simulate(
    model: &Arc<VehicleModel>,
    window: &PredictionWindow,
) -> Result<[f64; 3], SimulationError> {
    let mut simulation = Simulation::new(Arc::clone(model));
    simulation.set_state(window.state)?;
    let wheels = &window.wheels;
    for row in 0..wheels.len() - 1 {
        simulation.set_wheel_speeds(wheels.wheel_speeds(row).into())?;
        simulation.set_wheel_accelerations(wheels.wheel_accelerations(row).into())?;
        if row == 0 {
            // The window starts within a drive.
            simulation.settle_after(&window.approach)?;
        }
        simulation.step(wheels.time[row + 1] - wheels.time[row])?;
    }
    let state = simulation.state();
    Ok([state.x, state.y, state.heading])
}

/// Error of a predicted pose at the end of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseError {
    /// Distance from the recorded position \[m\].
    pub position: f64,
    /// Angle to the recorded heading \[rad\], 0 to pi.
    pub heading: f64,
}

impl PoseError {
    /// Of predicted x, y and heading.
    #[must_use]
    pub fn new(window: &PredictionWindow, predicted: [f64; 3]) -> Self {
        let [x, y, heading] = window.end;
        Self {
            position: (predicted[0] - x).hypot(predicted[1] - y),
            heading: wrapped(predicted[2] - heading).abs(),
        }
    }
}

/// Statistics of many errors, with intervals from a bootstrap over blocks of windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSummary {
    /// Median.
    pub median: IntervalEstimate,
    /// 95 % quantile.
    pub p95: IntervalEstimate,
    /// Root mean square.
    pub rmse: IntervalEstimate,
}

/// The windows for which every model has a prediction, so that all are judged by the same windows. Models that failed
/// everywhere do not count.
#[must_use]
pub fn common(predictions: &[Vec<Option<PoseError>>]) -> Vec<usize> {
    let usable: Vec<_> = predictions
        .iter()
        .filter(|p| p.iter().any(Option::is_some))
        .collect();
    let windows = predictions.first().map_or(0, Vec::len);
    (0..windows)
        .filter(|window| usable.iter().all(|p| p[*window].is_some()))
        .collect()
}

/// Statistics of errors; `blocks` has the block of each error. `None` without errors.
pub fn summarise<B: Ord>(
    errors: &[f64],
    blocks: impl IntoIterator<Item = B>,
) -> Option<ErrorSummary> {
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
        IntervalEstimate::bootstrap(groups.len(), |blocks| {
            let mut values = drawn(blocks);
            values.sort_unstable_by(f64::total_cmp);
            quantile(&values, share)
        })
    };
    let rmse = IntervalEstimate::bootstrap(groups.len(), |blocks| {
        let values = drawn(blocks);
        (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
    });
    Some(ErrorSummary {
        median: share(0.5),
        p95: share(0.95),
        rmse,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ERROR: PoseError = PoseError {
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
    fn summaries_have_intervals() {
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
