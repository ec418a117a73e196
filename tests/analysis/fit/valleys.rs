//! Random starts where the fit has several minima, whose places are known.

use super::synthetic::plain;
use ugv_terrain::fit::parameter::{ActsBy, FreeParameter, Prior, Scale};
use ugv_terrain::fit::predictor::{PredictionError, Predictor, Request, Trajectory};
use ugv_terrain::fit::{Fit, Options, fit};
use ugv_terrain::recording::{Channel, Recording, Run, Series};

const STARTS: usize = 20;

/// Drives straight on, whatever its wheels do, at a speed that several values of p have.
struct Steady {
    /// 1 m/s and a tenth of this \[m/s\], which comes with its derivative by p.
    shape: fn(f64) -> [f64; 2],
    held: Option<f64>,
}

/// Up to three values of p.
fn cubic(p: f64) -> [f64; 2] {
    [p.powi(3) - 3.0 * p, 3.0 * (p * p - 1.0)]
}

/// As many as there is room for.
fn wave(p: f64) -> [f64; 2] {
    let (sin, cos) = (3.0 * p).sin_cos();
    [sin, 3.0 * cos]
}

impl Predictor for Steady {
    fn parameters(&self) -> usize {
        usize::from(self.held.is_none())
    }

    fn held(&self, parameters: &[f64]) -> Result<Self, PredictionError> {
        let held = Some(parameters[0]);
        Ok(Self { held, ..*self })
    }

    fn predict(&self, request: &Request, out: &mut Trajectory) -> Result<(), PredictionError> {
        out.clear();
        let p = self.held.unwrap_or_else(|| request.parameters[0]);
        let [off, slope] = (self.shape)(p).map(|value| 0.1 * value);
        let speed = 1.0 + off;
        let (sin, cos) = request.start.heading.sin_cos();
        for time in request.times {
            let after = time - request.times[0];
            let way = speed * after;
            let (x, y) = (request.start.x + way * cos, request.start.y + way * sin);
            let heading = request.start.heading;
            out.states.push([x, y, heading, speed, 0.0, 0.0]);
            out.rates
                .push([speed * cos, speed * sin, 0.0, 0.0, 0.0, 0.0]);
            if request.derivatives {
                let mut by_start = [[0.0; 6]; 6];
                by_start[0][0] = 1.0;
                by_start[1][1] = 1.0;
                by_start[2] = [-way * sin, way * cos, 1.0, 0.0, 0.0, 0.0];
                out.by_start.push(by_start);
                out.by_wheel_latency.push([0.0; 6]);
                let by_p = [
                    slope * after * cos,
                    slope * after * sin,
                    0.0,
                    slope,
                    0.0,
                    0.0,
                ];
                out.by_parameter.extend(self.held.is_none().then_some(by_p));
            }
        }
        Ok(())
    }
}

/// Fits p to 20 s of driving at the speed of `truth`, from `nominal` on.
fn fitted(truth: f64, shape: fn(f64) -> [f64; 2], nominal: f64, p: FreeParameter) -> Fit {
    let mut noise = fastrand::Rng::with_seed(5);
    // A sum of uniform numbers: near enough to normal, 1 cm.
    let mut disturbed =
        |value: f64| value + 0.01 * ((0..12).map(|_| noise.f64()).sum::<f64>() - 6.0);
    let times = (0..=200).map(|k| 0.1 * f64::from(k));
    let series = |value: &mut dyn FnMut(f64) -> f64| -> Series {
        times.clone().map(|time| (time, value(time))).collect()
    };
    let run = Run::new("")
        .with(Channel::OmegaLeft, series(&mut |_| 5.0))
        .with(Channel::OmegaRight, series(&mut |_| 5.0))
        .with(Channel::X, series(&mut |time| disturbed(truth * time)))
        .with(Channel::Y, series(&mut |_| disturbed(0.0)))
        .with(Channel::Heading, series(&mut |_| disturbed(0.0)));
    let recording = Recording {
        name: "straight".into(),
        runs: vec![run],
        ..Recording::default()
    };
    let options = Options {
        starts: STARTS,
        ..plain()
    };
    let predictor = Steady { shape, held: None };
    fit(
        &predictor,
        vec![p],
        &[nominal],
        &[recording],
        &options,
        &|_| {},
    )
    .unwrap()
}

fn parameter([low, high]: [f64; 2], median: f64, deviation: f64) -> FreeParameter {
    FreeParameter {
        name: "p".into(),
        unit: "1",
        scale: Scale::Linear,
        acts_by: ActsBy::Coordinate,
        prior: Prior { median, deviation },
        low,
        high,
    }
}

fn fitted_cubic(truth: f64) -> Fit {
    fitted(truth, cubic, -1.3, parameter([-4.0, 4.0], -1.3, 2.0))
}

#[test]
fn a_better_valley_becomes_the_answer() {
    // p^3 - 3 p = 2.5 at 2.0536 alone; from -1.3 steps end on the hump at -1, where it is 2.
    let fit = fitted_cubic(1.25);
    let starts = fit.starts.unwrap();
    assert!(starts.better.is_some(), "{starts:?}");
    assert!(
        (fit.estimates[0].value - 2.0536).abs() < 0.05,
        "{}",
        fit.estimates[0].value
    );
    // Those from the left of 1 end on the hump, as the nominal one.
    let on_hump = &starts.others[0];
    assert!(
        (on_hump.values[0] + 1.0).abs() < 0.1 && on_hump.ruled_out(),
        "{starts:?}"
    );
    assert!(starts.agreed > 0 && on_hump.count > 0, "{starts:?}");
    let counted: usize = starts.others.iter().map(|other| other.count).sum();
    assert_eq!(starts.agreed + counted, STARTS, "{starts:?}");
}

#[test]
fn valleys_as_deep_as_the_answer_s_are_told() {
    // p^3 - 3 p = 1.5 at -1.3802, -0.5580 and 1.9382.
    let fit = fitted_cubic(1.15);
    let answer = fit.estimates[0].value;
    let starts = fit.starts.unwrap();
    let mut told: Vec<f64> = starts.others.iter().map(|other| other.values[0]).collect();
    told.push(answer);
    told.sort_by(f64::total_cmp);
    assert_eq!(told.len(), 3, "{starts:?}");
    for (told, true_value) in told.iter().zip([-1.3802, -0.5580, 1.9382]) {
        assert!((told - true_value).abs() < 0.1, "{told}: {starts:?}");
    }
    assert!(
        starts.others.iter().all(|other| !other.ruled_out()),
        "{starts:?}"
    );
    let counted: usize = starts.others.iter().map(|other| other.count).sum();
    assert_eq!(starts.agreed + counted, STARTS, "{starts:?}");
}

#[test]
fn who_led_to_the_answer_is_counted_behind_better_looking_ones() {
    // sin 3 p = 0.5 at -3.316, -1.920, -1.222, 0.175, 0.873, 2.269 and 2.967, which the prior hardly tells apart; starts
    // beyond the lower bound begin there, beside the nominal answer, which is the farthest from the prior's median.
    let p = parameter([-3.5, 3.2], 0.5, 5.0);
    let fit = fitted(1.05, wave, -3.3, p);
    let starts = fit.starts.unwrap();
    let answer = fit.estimates[0].value;
    assert!((answer + 3.316).abs() < 0.05, "{answer}: {starts:?}");
    assert!(starts.better.is_none(), "{starts:?}");
    assert!(starts.others.len() >= 4, "{starts:?}");
    assert!(starts.agreed >= 2, "{starts:?}");
}
