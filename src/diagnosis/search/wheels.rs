//! Reconstruction of the wheel speeds between samples.
//!
//! An encoder counts: a sample is the mean over its interval, and linear interpolation between such means cuts
//! corners. At 20 Hz a light vehicle that is steered hard errs by 17 standard deviations of a good gyro over a
//! minute, which looks like a force for some seconds. Other sensors measure the speed at a time. Both are tried.
//!
//! Whole counts are noise as well, and drive the model: 4096 a turn at 20 Hz are steps of 0.03 rad/s. A delay of a
//! fraction of an interval mixes neighbouring samples, which smooths, so noise alone would look like a delay. Both
//! are therefore tried with more and more smoothing, as long as the evidence grows.

use crate::diagnosis::Progress;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::hypothesis::Wheels;
use crate::diagnosis::hypothesis::likelihood::{FittedHypothesis, fit_hypothesis, fit_with_noise};
use crate::diagnosis::hypothesis::thin::FIRST_LOOK;
use crate::fit::problem::NoiseModel;
use std::sync::Arc;
use std::time::Duration;

/// Smoothing parameters s: the shortest wave keeps the factor 1/(1 + 16 s), one of four samples 1/(1 + 4 s).
const SMOOTHINGS: [f64; 5] = [0.0, 0.1, 0.4, 1.6, 6.4];
/// Log odds that smoothing must exceed, as recorded speeds are usually exact.
const UNLIKELY: f64 = 3.0;

/// The refitted model with the reconstruction of the largest evidence. At the deadline, the best so far.
#[must_use]
pub fn reconstructed<'a>(
    problem: &Problem<'a>,
    fit: FittedHypothesis,
    noise: &mut NoiseModel,
    progress: &Progress,
) -> (Problem<'a>, FittedHypothesis) {
    let mut took = Duration::ZERO;
    let mut best: Option<(Problem, FittedHypothesis, f64)> = None;
    for counted in [false, true] {
        let mut smallest = f64::INFINITY;
        for smoothing in SMOOTHINGS {
            let price = if smoothing > 0.0 { UNLIKELY } else { 0.0 };
            let as_it_is = !counted && smoothing == 0.0;
            let (other, fitted) = if as_it_is {
                (problem.clone(), Ok(fit.clone()))
            } else {
                if progress.lacks(took + progress.passes(FIRST_LOOK)) {
                    break;
                }
                let before = progress.elapsed();
                let initial = best.as_ref().map_or(&fit, |(_, fit, _)| fit);
                let other = with_wheels(problem, counted, smoothing);
                let fitted = fit_hypothesis(&other, &fit.coefficients, &initial.solution, noise);
                took = progress.elapsed().saturating_sub(before);
                (other, fitted)
            };
            let Ok(fitted) = fitted else { continue };
            if fitted.negative_log_evidence >= smallest {
                break;
            }
            smallest = fitted.negative_log_evidence;
            if best
                .as_ref()
                .is_none_or(|(.., best)| smallest + price < *best)
            {
                best = Some((other, fitted, smallest + price));
            }
        }
    }
    let Some((mut problem, fitted, _)) = best else {
        return (problem.clone(), fit);
    };
    let Some(wheels) = &mut problem.wheels else {
        return (problem, fit);
    };
    wheels.likelier = fit.negative_log_evidence - fitted.negative_log_evidence;
    let mut own = noise.clone();
    let fitted = match fit_with_noise(&problem, &fitted.coefficients, &fitted.solution, &mut own) {
        Ok(settled) => {
            *noise = own;
            settled
        }
        Err(_) => fitted,
    };
    (problem, fitted)
}

/// The same recordings with reconstructed wheel speeds.
fn with_wheels<'a>(problem: &Problem<'a>, counted: bool, smoothing: f64) -> Problem<'a> {
    let mut other = problem.clone();
    let mut last = None;
    for segment in &mut other.segments {
        let run = (segment.recording, segment.run);
        let drive = match last {
            Some((before, drive)) if before == run => drive,
            _ => {
                let recorded = segment.drive.as_ref().clone();
                Arc::new(recorded.reconstructed(counted, smoothing))
            }
        };
        segment.drive = Arc::clone(&drive);
        last = Some((run, drive));
    }
    other.wheels = Some(Wheels {
        counted,
        smoothing,
        likelier: 0.0,
    });
    other
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Options;

    use crate::diagnosis::testing::{driven, fitted, on};
    use crate::recording::{Channel, Recording, Series};

    /// Seconds between two samples of the encoders.
    const INTERVAL: f64 = 0.3;

    /// The same drive with wheel speeds at this interval, sampled or as means.
    fn sampled_coarsely(recording: &Recording, means: bool) -> Recording {
        let mut coarse = recording.clone();
        for run in &mut coarse.runs {
            for channel in [Channel::OmegaLeft, Channel::OmegaRight] {
                let fine = run.series(channel).unwrap().clone();
                let end = fine.end().unwrap();
                let at = |time: f64| fine.at(time.clamp(0.0, end)).unwrap();
                let mean = |time: f64| {
                    let within =
                        (0..50).map(|k| time + INTERVAL * ((f64::from(k) + 0.5) / 50.0 - 0.5));
                    within.map(at).sum::<f64>() / 50.0
                };
                let times = (0..=(end / INTERVAL) as u32).map(|k| INTERVAL * f64::from(k));
                let sample = |time: f64| (time, if means { mean(time) } else { at(time) });
                *run = run
                    .clone()
                    .with(channel, times.map(sample).collect::<Series>());
            }
        }
        coarse
    }

    /// The same drive with uniform errors of the wheel speeds.
    fn jittered(recording: &Recording, amplitude: f64) -> Recording {
        let mut coarse = recording.clone();
        let mut random = fastrand::Rng::with_seed(11);
        for run in &mut coarse.runs {
            for channel in [Channel::OmegaLeft, Channel::OmegaRight] {
                let series = run.series(channel).unwrap().clone();
                let off = |(time, value): (f64, f64), off: f64| {
                    (time, value + amplitude * (2.0 * off - 1.0))
                };
                let samples = series.samples().map(|sample| off(sample, random.f64()));
                let samples: Series = samples.collect();
                *run = run.clone().with(channel, samples);
            }
        }
        coarse
    }

    #[test]
    fn wheel_speeds_are_means_where_they_were_counted() {
        let model = on("sandy_loam");
        let whole = driven(&model, "slalom");
        let likelier = |recording: Recording| {
            let recordings = [recording];
            let (problem, fit, mut noise) = fitted(&model, &recordings, &Options::default());
            let (found, again) =
                reconstructed(&problem, fit.clone(), &mut noise, &Progress::new(&|_| ()));
            assert_eq!(
                found.wheels.is_some(),
                found.segments[0].drive != problem.segments[0].drive
            );
            (found.wheels, again.misfit)
        };
        let (as_it_was, _) = likelier(whole.clone());
        assert!(as_it_was.is_none());
        let (means, misfit) = likelier(sampled_coarsely(&whole, true));
        let means = means.unwrap();
        assert!(means.counted && means.likelier > 20.0);
        let (sampled, more) = likelier(sampled_coarsely(&whole, false));
        assert!(sampled.is_none() && more > misfit);
        let (jittery, _) = likelier(jittered(&whole, 0.1));
        let jittery = jittery.unwrap();
        assert!(!jittery.counted && jittery.smoothing > 0.0 && jittery.likelier > 5.0);
    }
}
