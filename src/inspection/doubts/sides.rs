//! Sides that differ: one that counts backwards, one in another unit than the other, or behind another gear.

use super::doubt::{Doubt, DoubtKind};
use crate::inspection::signals::MotionSignal;
use crate::recording::{BySides, Channel, Recording, Run, SideMotion};

/// Sides roll alike within this factor: a strength of the soil that differs between them by 2.2, two standard deviations of
/// its prior, makes 1.6 of it on sandy loam.
const ALIKE: f64 = 1.7;
/// Share of the motion that another factor leaves unexplained at most. Soil that differs between the sides makes up to 2.8 of
/// it as well, but not steadily: 0.33 and 0.41 on two simulated drives. Real drives with one side's speeds doubled have 0.15
/// to 0.25.
const UNSTEADY: f64 = 0.3;
/// Turning and distance have to find the same factor, within this one.
const SAME: f64 = 1.2;
const PROBABILITY: f64 = 0.95;

/// What both sides add to a motion.
pub fn by_sides(runs: &[Run], motion: MotionSignal) -> Option<BySides> {
    let signals = [motion, MotionSignal::LeftWheels, MotionSignal::RightWheels];
    let runs = runs.iter().filter_map(|run| {
        let [motion, left, right] = signals.map(|signal| signal.of(run));
        Some([motion?, left?, right?])
    });
    BySides::of(&runs.collect::<Vec<SideMotion>>())
}

/// The same where it is clear, by the first signal of them.
fn clear(recording: &Recording, signals: [MotionSignal; 2]) -> Option<BySides> {
    let mut found = signals
        .into_iter()
        .filter_map(|signal| by_sides(&recording.runs, signal));
    found.find(BySides::is_clear)
}

/// A doubt about a side that counts backwards: both sides then turn the vehicle the same way, and move it in opposite
/// directions.
pub fn mirrored(recording: &Recording) -> Option<Doubt> {
    let turn = clear(recording, [MotionSignal::YawRate, MotionSignal::Heading])?;
    let side = turn.inverted_by_turn()?;
    let ahead = clear(recording, [MotionSignal::Distance, MotionSignal::Velocity]);
    let is_confirmed = ahead.is_none_or(|ahead| ahead.inverted_by_distance() == Some(side));
    is_confirmed.then(|| {
        let names = ["left", "right"];
        let channel = [Channel::OmegaLeft, Channel::OmegaRight][side];
        Doubt {
            kind: DoubtKind::MirroredSide,
            channels: vec![channel],
            span: None,
            probability: PROBABILITY,
            left_out: Vec::new(),
            evidence: format!(
                "the {} side counts backwards: the vehicle turns by {:.3} rad for each radian of it, and by {:.3} rad for \
                 each of the other side",
                names[side],
                turn.by[side],
                turn.by[1 - side]
            ),
            remedy: format!("Turn the sign of {channel} round"),
        }
    })
}

/// A doubt about sides that roll by different factors.
pub fn factor(recording: &Recording) -> Option<Doubt> {
    let steady =
        |signals| clear(recording, signals).filter(|found: &BySides| found.unexplained < UNSTEADY);
    let ahead = steady([MotionSignal::Distance, MotionSignal::Velocity])?;
    let turn = steady([MotionSignal::Heading, MotionSignal::YawRate])?;
    let [ahead, turning] = [(ahead, 1.0), (turn, -1.0)].map(|(found, sign)| {
        let ratio = sign * found.by[1] / found.by[0];
        (ratio > 0.0).then_some(ratio)
    });
    let (ahead, turning) = (ahead?, turning?);
    let differs = ahead.ln().abs() > ALIKE.ln() && turning.ln().abs() > ALIKE.ln();
    let agrees = (ahead / turning).ln().abs() < SAME.ln();
    (differs && agrees).then(|| {
        let (more, less, times) = if ahead > 1.0 {
            ("left", "right", ahead)
        } else {
            ("right", "left", 1.0 / ahead)
        };
        Doubt {
            kind: DoubtKind::RollingRatio,
            channels: vec![Channel::OmegaLeft, Channel::OmegaRight],
            span: None,
            probability: PROBABILITY,
            left_out: Vec::new(),
            evidence: format!(
                "omega_{more} counts {times:.2} times as much as omega_{less} for the same way, by the distance; by the \
                 turns {:.2} times",
                if ahead > 1.0 { turning } else { 1.0 / turning }
            ),
            remedy: format!(
                "Check unit, gear and ticks of both sides: divide omega_{more} by {times:.2}, or multiply omega_{less} by it"
            ),
        }
    })
}
