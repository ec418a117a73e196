use super::*;
use crate::recording::{Run, Series};

/// Noise of a given standard deviation: a sum of twelve uniform numbers.
fn normal(random: &mut fastrand::Rng, deviation: f64) -> f64 {
    deviation * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0)
}

const TURN: f64 = 0.16;
const RADIUS: f64 = 0.29;

/// Right less left wheel speed, and their mean, after ten seconds of rest.
fn wheels(time: f64) -> (f64, f64) {
    if time < 10.0 {
        return (0.0, 0.0);
    }
    let t = time - 10.0;
    let turn =
        4.0 * (0.9 * t).sin() * (0.17 * t).cos() + 2.0 * (2.3 * t + 1.0).sin() - 2.0 * 1f64.sin();
    (
        turn,
        4.0 + 3.0 * (0.43 * t).sin() * (0.11 * t).cos() - 4.0 * (-t).exp(),
    )
}

/// A run in which wheels and pose are late by these delays behind the gyro, with noise on all.
fn run(seconds: f64, late: [f64; 2], noise: [f64; 3], seed: u64) -> Run {
    let mut random = fastrand::Rng::with_seed(seed);
    let fine = 0.002;
    let mut pose = vec![[0.0; 3]];
    for index in 0..(seconds / fine) as usize {
        let (turn, mean) = wheels(index as f64 * fine);
        let [x, y, heading] = pose[index];
        let (step, angle) = (RADIUS * mean * fine, heading + 0.5 * TURN * turn * fine);
        pose.push([
            x + step * angle.cos(),
            y + step * angle.sin(),
            heading + TURN * turn * fine,
        ]);
    }
    let at = |time: f64| pose[((time / fine).round().max(0.0) as usize).min(pose.len() - 1)];
    let times =
        |interval: f64| (0..(seconds / interval) as usize).map(move |k| k as f64 * interval);
    let side = |sign: f64| -> Series {
        times(0.05)
            .map(|t| {
                let (turn, mean) = wheels(t - late[0]);
                (t, mean + sign * turn / 2.0)
            })
            .collect()
    };
    // One draw for x, y and heading at each time.
    let poses: Vec<_> = times(0.1)
        .map(|t| {
            (
                t,
                at(t - late[1]),
                [
                    normal(&mut random, noise[1]),
                    normal(&mut random, noise[1]),
                    normal(&mut random, noise[2]),
                ],
            )
        })
        .collect();
    let channel = |axis: usize| -> Series {
        poses
            .iter()
            .map(|(t, pose, noise)| (*t, pose[axis] + noise[axis]))
            .collect()
    };
    Run::new("")
        .with(Channel::OmegaLeft, side(-1.0))
        .with(Channel::OmegaRight, side(1.0))
        .with(
            Channel::YawRate,
            times(0.05)
                .map(|t| (t, TURN * wheels(t).0 + normal(&mut random, noise[0])))
                .collect(),
        )
        .with(Channel::X, channel(0))
        .with(Channel::Y, channel(1))
        .with(Channel::Heading, channel(2))
}

fn recording(runs: Vec<Run>) -> Recording {
    Recording {
        runs,
        ..Recording::default()
    }
}

fn delay(inspection: &Inspection, of: MotionSignal, behind: MotionSignal) -> &Delay {
    let found = inspection
        .delays
        .iter()
        .find(|delay| delay.pair == Pair { of, behind });
    found.expect("the pair was measured")
}

#[test]
fn delays_are_recovered_within_two_hundredths_of_a_second() {
    const TOLERANCE: f64 = 0.02;
    for (wheels, pose) in [(0.0, 0.0), (0.12, 0.37), (0.2, 0.8), (-0.15, 0.05)] {
        let run = run(100.0, [wheels, pose], [0.02, 0.02, 0.005], 3);
        let inspection = inspect(&recording(vec![run]), None);
        for (of, behind, truth) in [
            (MotionSignal::WheelDifference, MotionSignal::YawRate, wheels),
            (MotionSignal::Heading, MotionSignal::YawRate, pose),
            (
                MotionSignal::Heading,
                MotionSignal::WheelDifference,
                pose - wheels,
            ),
            (
                MotionSignal::Distance,
                MotionSignal::WheelMean,
                pose - wheels,
            ),
        ] {
            let delay = delay(&inspection, of, behind);
            let error = delay.seconds.value - truth;
            assert!(
                error.abs() < TOLERANCE,
                "{of:?} behind {behind:?}: {:?}, not {truth}",
                delay.seconds
            );
            assert_eq!(delay.quality, Quality::Clear);
            assert!(
                delay.seconds.low - TOLERANCE <= truth && truth <= delay.seconds.high + TOLERANCE
            );
            assert!(!delay.contradicts);
        }
        let scale = delay(
            &inspection,
            MotionSignal::Heading,
            MotionSignal::WheelDifference,
        )
        .scale;
        assert!((scale.value / TURN - 1.0).abs() < 0.02, "{scale:?}");
    }
}

#[test]
fn ten_days_of_silence_hide_no_delay() {
    let run = run(100.0, [0.12, 0.37], [0.02, 0.02, 0.005], 3);
    let paused = |by: f64| {
        let channels = run.channels().map(|(channel, series)| {
            let samples = series.samples();
            let later = |time: f64| if time < 60.0 { time } else { time + by };
            (
                channel,
                samples.map(|(time, value)| (later(time), value)).collect(),
            )
        });
        let run = channels.fold(Run::new(""), |run, (channel, series)| {
            run.with(channel, series)
        });
        inspect(&recording(vec![run]), None)
    };
    let (minutes, days) = (paused(120.0), paused(864_000.0));
    assert_eq!(days.delays.len(), minutes.delays.len());
    for (one, other) in days.delays.iter().zip(&minutes.delays) {
        assert_eq!(one.quality, Quality::Clear, "{:?}", one.pair);
        let apart = one.seconds.value - other.seconds.value;
        assert!(apart.abs() < 0.005, "{:?}: {apart}", one.pair);
    }
    let [one, other] = [days, minutes].map(|found| found.motion.turned.unwrap());
    assert!((one - other).abs() < 1e-6, "{one}, {other}");
}

#[test]
fn short_runs_are_pooled() {
    let long = run(150.0, [0.1, 0.37], [0.02, 0.02, 0.005], 5);
    let piece = |index: usize| {
        let from = 12.0 + 6.0 * index as f64;
        long.channels()
            .fold(Run::new(index.to_string()), |run, (channel, series)| {
                let inside = series
                    .samples()
                    .filter(|(t, _)| (from..from + 6.0).contains(t));
                run.with(
                    channel,
                    inside.map(|(t, value)| (t - from, value)).collect(),
                )
            })
    };
    let inspection = inspect(&recording((0..20).map(piece).collect()), None);
    let found = delay(&inspection, MotionSignal::Heading, MotionSignal::YawRate);
    assert!(
        (found.seconds.value - 0.37).abs() < 0.03,
        "{:?}",
        found.seconds
    );
    assert_eq!((found.quality, found.blocks), (Quality::Clear, 20));
    assert_eq!(inspection.runs.len(), 20);
}

#[test]
fn interval_covers_the_truth_about_as_often_as_stated() {
    let truth = 0.37;
    let estimated = |seed| {
        let run = run(60.0, [0.1, truth], [0.2, 0.05, 0.05], seed);
        let inspection = inspect(&recording(vec![run]), None);
        delay(&inspection, MotionSignal::Heading, MotionSignal::YawRate).seconds
    };
    let found: Vec<_> = (0..40).map(estimated).collect();
    let covered = found
        .iter()
        .filter(|one| one.low <= truth && truth <= one.high)
        .count();
    // Of 40 with a chance of 0.9; five blocks make the intervals a little short.
    assert!(covered >= 29, "{covered} of 40");
    // Nor are they wide: 3.29 deviations of the estimates are 90 %.
    let squares = found.iter().map(|one| (one.value - truth).powi(2));
    let scatter = (squares.sum::<f64>() / 40.0).sqrt();
    let width = found.iter().map(|one| one.width()).sum::<f64>() / 40.0;
    assert!(width < 2.0 * 3.29 * scatter, "{width} {scatter}");
}

#[test]
fn noise_is_recovered_at_rest_and_is_a_bound_in_motion() {
    let sizes = [0.02, 0.03, 0.004];
    let run = run(100.0, [0.0, 0.2], sizes, 7);
    let inspection = inspect(&recording(vec![run]), None);
    for (channel, size) in [
        (Channel::YawRate, sizes[0]),
        (Channel::X, sizes[1]),
        (Channel::Heading, sizes[2]),
    ] {
        let report = inspection
            .channels
            .iter()
            .find(|report| report.channel == channel)
            .unwrap();
        let (rest, motion) = (
            report.noise_at_rest.unwrap(),
            report.noise_in_motion.unwrap(),
        );
        // Some 100 differences.
        assert!(
            (rest.deviation.value / size - 1.0).abs() < 0.35,
            "{channel}: {rest:?}"
        );
        assert!(
            rest.deviation.low <= size && size <= rest.deviation.high,
            "{channel}: {rest:?}"
        );
        assert!(motion.deviation.value > 0.9 * size, "{channel}: {motion:?}");
    }
}

#[test]
fn motion_and_timing_are_summed_up() {
    let mut run = run(60.0, [0.0, 0.0], [0.0; 3], 1);
    let gap = run
        .series(Channel::X)
        .unwrap()
        .samples()
        .filter(|(t, _)| !(20.05..22.95).contains(t))
        .collect();
    run = run.with(Channel::X, gap);
    let inspection = inspect(&recording(vec![run]), None);
    assert!((inspection.motion.duration - 59.95).abs() < 1e-9);
    assert!(
        (inspection.motion.at_rest - 10.0).abs() < 0.1,
        "{:?}",
        inspection.motion
    );
    let distance: f64 = (0..60_000)
        .map(|k| RADIUS * wheels(0.001 * f64::from(k)).1.abs() * 0.001)
        .sum();
    assert!(
        (inspection.motion.distance.unwrap() - distance).abs() < 0.02 * distance,
        "{distance}"
    );
    let timing = |channel| {
        inspection
            .channels
            .iter()
            .find(|report| report.channel == channel)
            .unwrap()
            .timing
    };
    assert!((timing(Channel::YawRate).rate() - 20.0).abs() < 1e-9);
    let x = timing(Channel::X);
    assert!(
        (x.longest - 3.0).abs() < 1e-9 && (x.longest_at.0 - 20.0).abs() < 1e-9,
        "{x:?}"
    );
    assert!((x.in_gaps - 3.0 / 59.9).abs() < 1e-6);
}

#[test]
fn opposite_signs_are_reported() {
    let good = run(100.0, [0.1, 0.3], [0.02, 0.02, 0.005], 9);
    let gyro: Series = good
        .series(Channel::YawRate)
        .unwrap()
        .samples()
        .map(|(t, value)| (t, -value))
        .collect();
    let inspection = inspect(&recording(vec![good.with(Channel::YawRate, gyro)]), None);
    assert!(delay(&inspection, MotionSignal::Heading, MotionSignal::YawRate).contradicts);
    assert!(
        !delay(
            &inspection,
            MotionSignal::Heading,
            MotionSignal::WheelDifference
        )
        .contradicts
    );
}

#[test]
fn no_motion_gives_no_delay() {
    let still: Series = (0..400).map(|k| (0.05 * f64::from(k), 0.0)).collect();
    let run = Run::new("")
        .with(Channel::OmegaLeft, still.clone())
        .with(Channel::OmegaRight, still.clone())
        .with(Channel::YawRate, still);
    let inspection = inspect(&recording(vec![run]), None);
    assert!(
        inspection
            .delays
            .iter()
            .all(|delay| delay.quality == Quality::Unknown)
    );
    let one: Series = [(0.0, 1.0)].into_iter().collect();
    let run = Run::new("")
        .with(Channel::OmegaLeft, one.clone())
        .with(Channel::OmegaRight, one);
    let inspection = inspect(&recording(vec![run]), None);
    assert!(inspection.channels.is_empty() && inspection.delays.is_empty());
    assert_eq!(inspection.motion.distance, None);
}
