//! Poses that were computed from the wheel speeds.

use super::doubt::{Doubt, DoubtKind, PROBABLE, logistic};
use super::pairs::{Pairs, Ratio};
use crate::inspection::signals::MotionSignal;
use crate::recording::{Channel, Recording, Run};

/// A copy deviates by less than this share of its variation. Slip and sensors scatter more: see the tests on simulated
/// drives without noise.
const EXACT: f64 = 0.007;
/// Width of the transition, as a factor of the share.
const WIDTH: f64 = 0.2;
/// Signals that vary less, as a share of their size, follow from anything steady.
const MIN_VARIETY: f64 = 0.1;
/// Sideways motion of a copy, as a share of the distance. A vehicle that skids moves sideways in turns, by its turning
/// rate times the offset of its centre of rotation.
const MAX_SIDEWAYS: f64 = 0.01;

/// Whether distance, heading or forward velocity are copies of the wheels.
pub fn doubts(recording: &Recording) -> Vec<Doubt> {
    let runs = &recording.runs;
    let exact = |signal, behind| {
        let pairs = Pairs::of(runs, signal, behind)?;
        let ratio = pairs.ratio()?;
        let is_varied = ratio.variety >= MIN_VARIETY && ratio.correlation > 0.0;
        let p = logistic(-(ratio.unexplained / EXACT).ln() / WIDTH);
        is_varied.then_some((p, ratio, pairs))
    };
    let turn = exact(MotionSignal::Heading, MotionSignal::WheelDifference);
    let turn = turn.filter(|(.., pairs)| turns_both_ways(pairs));
    let distance = exact(MotionSignal::Distance, MotionSignal::WheelMean);
    let distance = distance.map(|(p, ratio, _)| {
        let sideways = sideways(runs).unwrap_or(0.0);
        let straight = logistic(-(sideways.max(1e-9) / MAX_SIDEWAYS).ln() / WIDTH);
        (p * straight, ratio)
    });
    let velocity = exact(MotionSignal::Velocity, MotionSignal::WheelMean);
    let turn = turn.map(|(p, ratio, _)| {
        let what = "heading follows from the difference of the wheel speeds";
        doubt(p, &ratio, vec![Channel::Heading], what)
    });
    let distance = distance.map(|(p, ratio)| {
        let what = "x and y follow from the mean of the wheel speeds";
        doubt(p, &ratio, vec![Channel::X, Channel::Y], what)
    });
    let velocity = velocity.map(|(p, ratio, _)| {
        let what = "v_x follows from the mean of the wheel speeds";
        doubt(p, &ratio, vec![Channel::VX], what)
    });
    let pose = match (turn, distance) {
        (Some(turn), Some(distance)) if turn.probability.min(distance.probability) >= PROBABLE => {
            let evidence = "the pose is the vehicle's own wheel odometry: heading follows from the difference of the wheel \
                            speeds, and x and y from their mean, more exactly than slip allows"
                .into();
            vec![Doubt {
                channels: vec![Channel::X, Channel::Y, Channel::Heading],
                probability: turn.probability.max(distance.probability),
                evidence,
                ..turn
            }]
        }
        (turn, distance) => turn.into_iter().chain(distance).collect(),
    };
    pose.into_iter().chain(velocity).collect()
}

/// Whether the wheels turn the vehicle to the left and to the right. In a steady bend to one side slip is proportional to the
/// turning, which looks like a copy.
fn turns_both_ways(pairs: &Pairs) -> bool {
    let largest = pairs
        .values
        .iter()
        .map(|pair| pair.1.abs())
        .fold(0.0, f64::max);
    let share = |sign: f64| {
        let side = pairs
            .values
            .iter()
            .filter(|pair| sign * pair.1 > MIN_VARIETY * largest);
        side.count() as f64 / pairs.values.len() as f64
    };
    share(1.0).min(share(-1.0)) >= MIN_VARIETY
}

fn doubt(probability: f64, ratio: &Ratio, channels: Vec<Channel>, what: &str) -> Doubt {
    let share = 100.0 * ratio.unexplained;
    Doubt {
        kind: DoubtKind::OwnOdometry,
        channels,
        span: None,
        probability,
        left_out: Vec::new(),
        evidence: format!("{what} within {share:.1} % of the variation, which slip does not allow"),
        remedy: "Slip cannot be seen in wheel odometry: take the pose from a source that does not use the wheels \
                 (lidar, satellites, cameras)"
            .into(),
    }
}

/// Root mean square of the sideways speed over that of the speed along the heading.
fn sideways(runs: &[Run]) -> Option<f64> {
    let (mut across, mut along) = (0.0, 0.0);
    for run in runs {
        let series = |channel| run.series(channel);
        let (x, y, heading) = (
            series(Channel::X)?,
            series(Channel::Y)?,
            series(Channel::Heading)?,
        );
        let poses = x
            .samples()
            .filter_map(|(t, x)| Some([x, y.at(t)?, heading.at(t)?]));
        let poses: Vec<[f64; 3]> = poses.collect();
        for pair in poses.windows(2) {
            let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
            let (sin, cos) = (0.5 * (pair[0][2] + pair[1][2])).sin_cos();
            across += (dy * cos - dx * sin).powi(2);
            along += (dx * cos + dy * sin).powi(2);
        }
    }
    (along > 0.0).then(|| (across / along).sqrt())
}
