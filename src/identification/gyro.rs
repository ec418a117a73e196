//! The scale of a gyro, by the heading that was recorded beside it.

use crate::recording::{
    Channel, Cumulated, DELAY_STEP, Moments, Note, NoteKind, Recording, Run, SENSOR_DELAYS, Series,
    TimeGrid,
};

/// Window of the mean rates \[s\]. Of windows of 1, 3, 6 and 12 s on ten simulated drives with known scales, these came
/// nearest: 0.1 to 0.4 % off.
const WINDOW: f64 = 3.0;
/// Standard deviation of gyros' scales before anything is known: data sheets of micromechanical gyros name 1 to 3 %.
const USUAL: f64 = 0.01;
/// A larger factor is no scale of a gyro, but a doubt about the data.
const LARGEST: f64 = 0.1;
/// Differences within so many standard errors are noise.
const CLEAR: f64 = 2.0;
/// Maximum share of the heading's rate that the gyro leaves unexplained. Unsteady delays of a pose lower the ratio by half
/// the square of it.
const UNEXPLAINED: f64 = 0.05;

/// How far the heading turns for each radian of the gyro.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GyroScale {
    /// The ratio.
    pub ratio: f64,
    /// Its standard error.
    pub error: f64,
}

impl GyroScale {
    /// From all runs; `None` without heading or gyro, with too little turning, or with a pose too poor to tell.
    ///
    /// # Algorithm
    /// 1. Mean rates of heading and gyro in windows of 3 s, every 0.05 s; means of each run are taken off, and with them
    ///    the gyro's bias.
    /// 2. The delay of the heading with the highest correlation, and the slope there.
    /// 3. Its standard error counts only windows that do not overlap.
    #[must_use]
    pub fn of(recording: &Recording) -> Option<Self> {
        let rates = |run: &Run| {
            let heading = Cumulated::of_position(run.series(Channel::Heading)?);
            let gyro = Cumulated::of_rate(run.series(Channel::YawRate)?);
            let grid = TimeGrid::over(&heading, &gyro, DELAY_STEP)?;
            Some([heading, gyro].map(|sum| sum.mean_rates(&grid, WINDOW)))
        };
        let rates: Vec<_> = recording.runs.iter().filter_map(rates).collect();
        let at = |delay: isize| {
            let runs = rates.iter();
            let runs = runs.map(|[heading, gyro]| {
                Moments::shifted(heading, gyro, delay, 0..gyro.len()).centred()
            });
            runs.fold(Moments::default(), Moments::and)
        };
        let best = SENSOR_DELAYS.map(at);
        let best = best.max_by(|a, b| a.correlation().total_cmp(&b.correlation()))?;
        let correlation = best.correlation();
        let unexplained = (1.0 - correlation * correlation).max(0.0).sqrt();
        let windows = best.count * DELAY_STEP / WINDOW;
        let ratio = best.slope();
        let error = ratio * unexplained / correlation / windows.sqrt();
        (correlation > 0.0 && unexplained < UNEXPLAINED && error > 0.0)
            .then_some(Self { ratio, error })
    }

    /// The likeliest ratio, if it is clearly another than 1 and that of a gyro.
    #[must_use]
    pub fn clear(self) -> Option<f64> {
        let off = self.ratio - 1.0;
        let is_clear = off.abs() > CLEAR * self.error && off.abs() < LARGEST;
        let weight = USUAL * USUAL / (USUAL * USUAL + self.error * self.error);
        is_clear.then_some(1.0 + weight * off)
    }
}

/// The recording with the yaw rates of a gyro without an error of scale, and a note; `None` where it is not clear.
#[must_use]
pub fn with_true_gyro(recording: &Recording) -> Option<Recording> {
    let scale = GyroScale::of(recording)?;
    let ratio = scale.clear()?;
    let mut corrected = recording.clone();
    let mut count = 0;
    for run in &mut corrected.runs {
        let Some(series) = run.series(Channel::YawRate) else {
            continue;
        };
        count += series.len();
        let scaled: Series = series
            .samples()
            .map(|(time, rate)| (time, ratio * rate))
            .collect();
        *run = std::mem::take(run).with(Channel::YawRate, scaled);
    }
    corrected.notes.push(Note {
        kind: NoteKind::Scale,
        channel: Some(Channel::YawRate),
        count,
        line: 2,
        text: format!(
            "taken {ratio:.4} times: the heading turns {:.4} times (standard error {:.4}) as far as the gyro says",
            scale.ratio, scale.error
        ),
    });
    Some(corrected)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute with turns both ways, a gyro of this scale, and a heading of this noise \[rad\].
    fn recording(scale: f64, noise: f64) -> Recording {
        let mut random = fastrand::Rng::with_seed(3);
        let mut normal = || (0..12).map(|_| random.f64()).sum::<f64>() - 6.0;
        let angle = |t: f64| (0.4 * t).sin() + 0.5 * (0.9 * t).cos();
        let rate = |t: f64| 0.4 * (0.4 * t).cos() - 0.45 * (0.9 * t).sin();
        let times = || (0..1200).map(|k| 0.05 * f64::from(k));
        let heading = times().step_by(2).map(|t| (t, angle(t) + noise * normal()));
        let heading = heading.collect();
        let gyro = times()
            .map(|t| (t, scale * rate(t) + 0.003 + 0.01 * normal()))
            .collect();
        let run = Run::new("")
            .with(Channel::Heading, heading)
            .with(Channel::YawRate, gyro);
        Recording {
            runs: vec![run],
            ..Recording::default()
        }
    }

    #[test]
    fn a_gyro_that_shows_too_little_is_put_right() {
        let given = recording(0.98, 0.005);
        let corrected = with_true_gyro(&given).unwrap();
        let rates = |one: &Recording| one.runs[0].series(Channel::YawRate).unwrap().value.clone();
        let ratio = rates(&corrected)[100] / rates(&given)[100];
        assert!((ratio * 0.98 - 1.0).abs() < 3e-3, "{ratio}");
        assert!(corrected.notes[0].text.contains("the heading turns"));
    }

    #[test]
    fn a_true_gyro_a_poor_heading_and_another_factor_are_left_alone() {
        for (scale, noise) in [(1.0, 0.005), (0.98, 0.2), (0.7, 0.005)] {
            assert_eq!(
                with_true_gyro(&recording(scale, noise)),
                None,
                "{scale} {noise}"
            );
        }
    }
}
