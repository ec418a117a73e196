//! Wheel speeds from joint states.

use super::attitude::unwrap;
use super::collect::{JointSample, TimedValues, WheelSample};
use crate::recording::range;
use std::f64::consts::{PI, TAU};

/// Source of wheel speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// Velocities of the joints.
    Velocity,
    /// Positions of the joints, which may be wrapped angles.
    Position { wrapped: bool },
}

/// Angular speeds of the left and the right wheels.
#[derive(Debug, PartialEq)]
pub(super) struct JointSpeeds {
    pub left: TimedValues,
    pub right: TimedValues,
    pub source: Source,
    /// Whether positions were used because a velocity stays at zero.
    pub dead_velocity: bool,
    /// Unused joints: their velocity stays exactly at zero while others of their side turn.
    pub still: Vec<usize>,
}

/// Minimum angle of a wheel that turns \[rad\].
const TURNED: f64 = 0.1;
/// Maximum interval between positions for a difference, as a multiple of the median one.
const LONGEST_GAP: i64 = 10;
/// Rounding tolerance for the range of wrapped angles \[rad\].
const WRAP_TOLERANCE: f64 = 1e-3;

/// JointState of a joint, from its velocities and positions.
#[derive(Clone, Copy, PartialEq)]
enum JointState {
    /// It turns, or its velocity is unknown.
    Turns,
    /// It stands, or is not measured.
    Still,
    /// Its velocity stays exactly at zero while its position changes.
    Dead,
}

/// Mean speeds of each side. They are the joints' velocities. If these are missing, or one stays at zero while its wheel
/// turns, they are differences of positions. The first `left` joints are on the left. `None` if a side has neither.
pub(super) fn wheel_speeds(samples: &[(i64, WheelSample)], left: usize) -> Option<JointSpeeds> {
    let joints = samples.first()?.1.len();
    let states: Vec<JointState> = (0..joints).map(|joint| state(samples, joint)).collect();
    let (sides, still) = used(&states, left, |state| state != JointState::Still);
    let dead_velocity = states.contains(&JointState::Dead);
    let velocities = |sides: &[Vec<usize>; 2]| -> Option<[TimedValues; 2]> {
        let means = sides.each_ref().map(|side| mean_velocity(samples, side));
        means.iter().all(|side| !side.is_empty()).then_some(means)
    };
    if !dead_velocity && let Some([left, right]) = velocities(&sides) {
        return Some(JointSpeeds {
            left,
            right,
            source: Source::Velocity,
            dead_velocity,
            still,
        });
    }
    let wrapped = (0..joints).any(|joint| is_wrapped(samples, joint));
    let [by_left, by_right] = sides.map(|side| differences(samples, &side, wrapped));
    if !by_left.is_empty() && !by_right.is_empty() {
        return Some(JointSpeeds {
            left: by_left,
            right: by_right,
            source: Source::Position { wrapped },
            dead_velocity,
            still,
        });
    }
    // Without the positions of all, dead joints are ignored, unless they are the only ones of a side.
    let (sides, still) = used(&states, left, |state| state == JointState::Turns);
    let is_dead = |side: &Vec<usize>| side.iter().any(|joint| states[*joint] == JointState::Dead);
    if !dead_velocity || sides.iter().any(is_dead) {
        return None;
    }
    let [left, right] = velocities(&sides)?;
    Some(JointSpeeds {
        left,
        right,
        source: Source::Velocity,
        dead_velocity: false,
        still,
    })
}

/// The samples with each joint's missing values between its own samples, if the joints of a side mostly come in separate
/// messages: those of the front and of the rear axle, for example. `None` if they come together.
pub(super) fn together(
    samples: &[(i64, WheelSample)],
    left: usize,
) -> Option<Vec<(i64, WheelSample)>> {
    let joints = samples.first()?.1.len();
    let known = |joint: &JointSample| joint.velocity.is_finite() || joint.position.is_finite();
    let is_apart = |side: std::ops::Range<usize>| {
        let count = |joint: usize| samples.iter().filter(|(_, all)| known(&all[joint])).count();
        let rarest = side.clone().map(count).min().unwrap_or(0);
        let whole = samples
            .iter()
            .filter(|(_, all)| all[side.clone()].iter().all(known))
            .count();
        rarest > 0 && 2 * whole < rarest
    };
    if !is_apart(0..left) && !is_apart(left..joints) {
        return None;
    }
    // Messages without any wheel, such as those of an arm, are at other times.
    let wheels = samples.iter().filter(|(_, all)| all.iter().any(known));
    let mut filled: Vec<(i64, WheelSample)> = wheels.cloned().collect();
    for joint in 0..joints {
        let wrapped = is_wrapped(samples, joint);
        fill(&mut filled, wrapped, |all| &mut all[joint].position);
        fill(&mut filled, false, |all| &mut all[joint].velocity);
        fill(&mut filled, false, |all| &mut all[joint].load);
    }
    Some(filled)
}

/// Fills missing values linear between known ones that are not too far apart.
fn fill(
    samples: &mut [(i64, WheelSample)],
    wrapped: bool,
    value: impl Fn(&mut WheelSample) -> &mut f64,
) {
    let known = samples.iter_mut().enumerate();
    let known = known.map(|(index, (time, all))| (index, *time, *value(all)));
    let known: Vec<(usize, i64, f64)> = known.filter(|(.., value)| value.is_finite()).collect();
    let mut steps: Vec<i64> = known.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
    steps.sort_unstable();
    let Some(usual) = steps.get(steps.len() / 2).copied() else {
        return;
    };
    for pair in known.windows(2) {
        let ((first, from, before), (last, to, after)) = (pair[0], pair[1]);
        if (to - from) / LONGEST_GAP >= usual {
            continue;
        }
        let after = if wrapped {
            unwrap(before, after)
        } else {
            after
        };
        for (time, all) in &mut samples[first + 1..last] {
            let share = (*time - from) as f64 / (to - from) as f64;
            let between = before + share * (after - before);
            // A wrapped angle stays within its turn.
            *value(all) = if wrapped {
                unwrap(0.0, between)
            } else {
                between
            };
        }
    }
}

/// The joints of each side that count, and the others; if no joint of a side would count, all do.
fn used(
    states: &[JointState],
    left: usize,
    counts: impl Fn(JointState) -> bool,
) -> ([Vec<usize>; 2], Vec<usize>) {
    let mut others = Vec::new();
    let sides = [0..left, left..states.len()].map(|side| -> Vec<usize> {
        let (on, off): (Vec<usize>, Vec<usize>) =
            side.clone().partition(|joint| counts(states[*joint]));
        if on.is_empty() {
            return side.collect();
        }
        others.extend(off);
        on
    });
    (sides, others)
}

/// Mean velocity of joints at the times at which all are known.
fn mean_velocity(samples: &[(i64, WheelSample)], side: &[usize]) -> TimedValues {
    let means = samples.iter().filter_map(|(time, sample)| {
        let sum: f64 = side.iter().map(|joint| sample[*joint].velocity).sum();
        let mean = sum / side.len() as f64;
        mean.is_finite().then_some((*time, mean))
    });
    means.collect()
}

fn state(samples: &[(i64, WheelSample)], joint: usize) -> JointState {
    let velocities = samples.iter().map(|(_, sample)| sample[joint].velocity);
    let mut known = velocities
        .filter(|velocity| velocity.is_finite())
        .peekable();
    if known.peek().is_none() || known.any(|velocity| velocity != 0.0) {
        JointState::Turns
    } else if span(samples, joint) > TURNED {
        JointState::Dead
    } else {
        JointState::Still
    }
}

fn positions(samples: &[(i64, WheelSample)], joint: usize) -> impl Iterator<Item = f64> {
    let positions = samples
        .iter()
        .map(move |(_, sample)| sample[joint].position);
    positions.filter(|position| position.is_finite())
}

/// Difference between the largest and the smallest position \[rad\].
fn span(samples: &[(i64, WheelSample)], joint: usize) -> f64 {
    let [min, max] = range(positions(samples, joint));
    if max > min { max - min } else { 0.0 }
}

/// Whether positions stay within a turn and jump by more than half of it.
fn is_wrapped(samples: &[(i64, WheelSample)], joint: usize) -> bool {
    let steps = positions(samples, joint).zip(positions(samples, joint).skip(1));
    span(samples, joint) < TAU + WRAP_TOLERANCE
        && steps.into_iter().any(|(a, b)| (b - a).abs() > PI)
}

/// Mean speeds between samples at the times in the middle: of second order, without delay.
fn differences(samples: &[(i64, WheelSample)], side: &[usize], wrapped: bool) -> TimedValues {
    let known = |sample: &&(i64, WheelSample)| {
        let mut joints = side.iter();
        joints.all(|joint| sample.1[*joint].position.is_finite())
    };
    let known: Vec<&(i64, WheelSample)> = samples.iter().filter(known).collect();
    let mut steps: Vec<i64> = known.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    steps.sort_unstable();
    let Some(usual) = steps.get(steps.len() / 2).copied() else {
        return TimedValues::new();
    };
    let turned = |from: &JointSample, to: &JointSample| {
        if wrapped {
            unwrap(from.position, to.position) - from.position
        } else {
            to.position - from.position
        }
    };
    let speeds = known.windows(2).filter_map(|pair| {
        let ((from, before), (to, after)) = (pair[0], pair[1]);
        let step = to - from;
        if step / LONGEST_GAP >= usual {
            return None;
        }
        let each = side
            .iter()
            .map(|joint| turned(&before[*joint], &after[*joint]));
        let sum: f64 = each.sum();
        let speed = sum / side.len() as f64 / (step as f64 * 1e-9);
        Some((from + step / 2, speed))
    });
    speeds.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn sample(time: i64, joints: &[(f64, f64)]) -> (i64, WheelSample) {
        let joint = |(position, velocity): &(f64, f64)| JointSample {
            position: *position,
            velocity: *velocity,
            load: f64::NAN,
        };
        (time * MS, joints.iter().map(joint).collect())
    }

    #[test]
    fn velocities_are_averaged_over_a_side_that_is_whole() {
        let nan = f64::NAN;
        let samples = [
            sample(0, &[(nan, 1.0), (nan, 3.0), (nan, 5.0)]),
            sample(10, &[(nan, 2.0), (nan, nan), (nan, 6.0)]),
        ];
        let speeds = wheel_speeds(&samples, 2).unwrap();
        assert_eq!(speeds.source, Source::Velocity);
        assert_eq!(speeds.left, [(0, 2.0)]);
        assert_eq!(speeds.right, [(0, 5.0), (10 * MS, 6.0)]);
    }

    #[test]
    fn positions_are_differentiated_and_unwrapped() {
        // Left turns at 20 rad/s, right at -20, in angles within (-pi, pi].
        let wrap = |angle: f64| unwrap(0.0, angle);
        let drive = |velocity: f64| -> Vec<_> {
            let row = |time| {
                let angle = 20.0 * time as f64 * 1e-3;
                sample(time, &[(wrap(angle), velocity), (wrap(-angle), velocity)])
            };
            (0..100).map(|index| row(10 * index)).collect()
        };
        for velocity in [f64::NAN, 0.0] {
            let speeds = wheel_speeds(&drive(velocity), 1).unwrap();
            assert_eq!(speeds.source, Source::Position { wrapped: true });
            assert_eq!(speeds.dead_velocity, velocity == 0.0);
            assert_eq!((speeds.left.len(), speeds.left[0].0), (99, 5 * MS));
            for ((_, left), (_, right)) in speeds.left.iter().zip(&speeds.right) {
                assert!((left - 20.0).abs() < 1e-9 && (right + 20.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn an_unmeasured_wheel_does_not_halve_the_speed() {
        let row = |time: i64| {
            let angle = time as f64 * 1e-3;
            sample(
                time,
                &[(0.0, 0.0), (angle, 1.0), (angle, 1.0), (angle, 1.0)],
            )
        };
        let speeds = wheel_speeds(&[0, 1000, 2000].map(row), 2).unwrap();
        assert_eq!((speeds.still, speeds.left[0].1), (vec![0], 1.0));
        // If all joints of a side stand still, the side stands.
        let row = |time: i64| sample(time, &[(0.0, 0.0), (0.0, 0.0), (0.0, 1.0)]);
        let speeds = wheel_speeds(&[0, 1000, 2000].map(row), 2).unwrap();
        assert_eq!((speeds.still.len(), speeds.left[0].1), (0, 0.0));
    }

    #[test]
    fn one_joint_without_velocity_does_not_halve_the_speed() {
        // The second of the left ones has only a position; all turn at 2 rad/s.
        let row = |time: i64, known: f64| {
            let angle = 2.0 * time as f64 * 1e-3;
            let whole = (known * angle, 2.0);
            sample(time, &[whole, (angle, 0.0), whole])
        };
        let times = [0, 10, 20, 30, 100];
        let speeds = wheel_speeds(&times.map(|time| row(time, 1.0)), 2).unwrap();
        assert_eq!(speeds.source, Source::Position { wrapped: false });
        assert!(speeds.dead_velocity && speeds.still.is_empty());
        let near =
            |series: &TimedValues| series.iter().all(|(_, speed)| (speed - 2.0).abs() < 1e-9);
        assert!(near(&speeds.left) && near(&speeds.right), "{speeds:?}");
        // Without positions of the others, their velocities count.
        let speeds = wheel_speeds(&times.map(|time| row(time, f64::NAN)), 2).unwrap();
        assert_eq!(
            (speeds.source, speeds.still),
            (Source::Velocity, vec![1]),
            "{:?}",
            speeds.left
        );
        assert!(near(&speeds.left) && near(&speeds.right));
        // A side without another joint has no speed.
        let row = |time: i64| sample(time, &[(time as f64, 0.0), (f64::NAN, 1.0)]);
        assert_eq!(wheel_speeds(&times.map(row), 1), None);
    }

    #[test]
    fn nothing_is_derived_across_a_gap_or_from_nothing() {
        let times = [0, 10, 20, 30, 1000, 1010];
        let row = |time| sample(time, &[(time as f64, f64::NAN); 2]);
        let speeds = wheel_speeds(&times.map(row), 1).unwrap();
        assert_eq!(speeds.source, Source::Position { wrapped: false });
        let at: Vec<i64> = speeds.left.iter().map(|(time, _)| time / MS).collect();
        assert_eq!(at, [5, 15, 25, 1005]);
        let none = sample(0, &[(f64::NAN, f64::NAN); 2]);
        assert_eq!(wheel_speeds(&[none.clone(), none], 1), None);
        assert_eq!(wheel_speeds(&[], 1), None);
    }

    #[test]
    fn wheels_in_separate_messages_are_joined() {
        // Front at even times, rear 10 ms later; the right side comes with the front.
        let nan = f64::NAN;
        let row = |index: i64| {
            let time = 10 * index;
            let angle = |speed: f64| speed * time as f64 * 1e-3;
            let wrapped = unwrap(0.0, angle(30.0));
            match index % 2 {
                0 => sample(time, &[(wrapped, 30.0), (nan, nan), (nan, 2.0), (nan, nan)]),
                _ => sample(
                    time,
                    &[(nan, nan), (angle(3.0), 3.0), (nan, nan), (nan, 4.0)],
                ),
            }
        };
        let apart: Vec<_> = (0..200).map(row).collect();
        let joined = together(&apart, 2).unwrap();
        let speeds = wheel_speeds(&joined, 2).unwrap();
        assert_eq!((speeds.left.len(), speeds.right.len()), (198, 198));
        assert!(
            speeds
                .left
                .iter()
                .all(|(_, speed)| (speed - 16.5).abs() < 1e-9)
        );
        assert!(
            speeds
                .right
                .iter()
                .all(|(_, speed)| (speed - 3.0).abs() < 1e-9)
        );
        let within = |(_, all): &(i64, WheelSample)| all[0].position.abs() <= PI + 1e-9;
        assert!(
            joined
                .iter()
                .filter(|(_, all)| all[0].position.is_finite())
                .all(within)
        );
        // Nothing across a gap, and nothing where all come together.
        let mut cut = apart.clone();
        cut.retain(|(time, _)| !(500..1500).contains(&(time / MS)));
        let gap = together(&cut, 2).unwrap();
        let times: Vec<i64> = wheel_speeds(&gap, 2)
            .unwrap()
            .left
            .iter()
            .map(|(time, _)| time / MS)
            .collect();
        assert!(
            !times.iter().any(|time| (495..1505).contains(time)),
            "{times:?}"
        );
        let all = [(0.0, 1.0); 4];
        assert_eq!(together(&[sample(0, &all), sample(10, &all)], 2), None);
    }
}
