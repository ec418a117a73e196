//! Columns that are swapped and signs that are turned round: two sensors that agree outvote a
//! third one that says the opposite.

use super::agreement::{Agreement, compare, cumulated, wheels};
use super::note;
use crate::recording::csv::{RawRun, Samples};
use crate::recording::{Channel, Cumulated, Note, NoteKind, Series, way_along};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Step of the comparisons \[s\].
const STEP: f64 = 0.1;
/// Slower turning than this is noise \[rad/s\].
const SLOWEST_TURN: f64 = 0.03;
/// Directions of travel are those of so many seconds, in which the vehicle comes this far \[m\].
const TRAVEL: (f64, f64) = (1.0, 0.3);
/// Fewer directions tell nothing.
const FEWEST: usize = 50;
/// How well directions must agree with one relation, and how badly with the other: lengths of
/// the mean of unit vectors.
const CLEAR: f64 = 0.9;
const UNCLEAR: f64 = 0.5;
/// Largest angle between the relation and what is expected of it \[rad\].
const NEAR: f64 = 0.3;

/// Puts right what is swapped or turned round.
pub fn settle(samples: &mut Samples) -> Vec<Note> {
    let difference = |run: &_| wheels(run, [-1.0, 1.0]);
    let heading = |run: &_| cumulated(run, Channel::Heading);
    let gyro = |run: &_| cumulated(run, Channel::YawRate);
    let turning = |found: &Agreement| found.second_deviation() >= SLOWEST_TURN;
    let pose_wheels = compare(samples, STEP, difference, heading).filter(turning);
    let gyro_wheels = compare(samples, STEP, difference, gyro).filter(turning);
    let pose_gyro = compare(samples, STEP, heading, gyro).filter(turning);
    let position = position(samples);
    let says =
        |found: &Option<Agreement>, what: fn(&Agreement) -> bool| found.as_ref().is_some_and(what);
    let (for_it, against) = (Agreement::agrees, Agreement::contradicts);
    let r = |found: &Option<Agreement>| found.map_or(0.0, |found| found.strongest().0);

    let has_both = pose_gyro.is_some();
    if says(&gyro_wheels, against)
        && (says(&pose_wheels, against) && says(&pose_gyro, for_it) || pose_wheels.is_none())
        || says(&pose_wheels, against)
            && gyro_wheels.is_none()
            && position != Some(Relation::Mirrored)
    {
        let found = if gyro_wheels.is_some() {
            &gyro_wheels
        } else {
            &pose_wheels
        };
        let witness = match (has_both, gyro_wheels.is_some()) {
            (true, _) => "yaw_rate and heading fall",
            (false, true) => "yaw_rate falls",
            (false, false) => "heading falls",
        };
        let text = format!(
            "left and right wheel speeds taken as swapped, and swapped back: {witness} where the right wheels are \
             faster (correlation {:.2}); turns counted clockwise would look the same",
            r(found)
        );
        return swap(
            samples,
            [Channel::OmegaLeft, Channel::OmegaRight],
            NoteKind::SwappedWheels,
            text,
        );
    }
    if says(&pose_gyro, against) && says(&gyro_wheels, against) && says(&pose_wheels, for_it) {
        let text = format!(
            "sign turned round: it contradicts heading (correlation {:.2}) and wheels ({:.2}), which agree",
            r(&pose_gyro),
            r(&gyro_wheels)
        );
        return turn_round(samples, Channel::YawRate, 0.0, text);
    }
    let heading_alone =
        says(&pose_gyro, against) && says(&pose_wheels, against) && says(&gyro_wheels, for_it)
            || says(&pose_wheels, against) && gyro_wheels.is_none();
    match (heading_alone, position) {
        (true, Some(Relation::Mirrored)) => {
            let text = format!(
                "taken as clockwise from north and converted: it contradicts the wheels (correlation {:.2}), and \
                 the direction of travel is a quarter turn less it",
                r(&pose_wheels)
            );
            turn_round(samples, Channel::Heading, FRAC_PI_2, text)
        }
        (true, None) if samples.of(Channel::X).next().is_none() => {
            let text = format!(
                "sign turned round: it contradicts yaw_rate (correlation {:.2}) and wheels ({:.2}), which agree",
                r(&pose_gyro),
                r(&pose_wheels)
            );
            turn_round(samples, Channel::Heading, 0.0, text)
        }
        (false, Some(Relation::Mirrored))
            if says(&pose_gyro, for_it) || says(&pose_wheels, for_it) =>
        {
            let text = "x and y taken as swapped, and swapped back: the direction of travel is a quarter turn less the \
                        heading, which agrees with yaw rate or wheels";
            swap(
                samples,
                [Channel::X, Channel::Y],
                NoteKind::SwappedPosition,
                text.into(),
            )
        }
        (true, _) => suspicion(
            samples,
            format!(
                "it contradicts yaw_rate (correlation {:.2}) or wheels ({:.2}); left as it is",
                r(&pose_gyro),
                r(&pose_wheels)
            ),
        ),
        (false, Some(Relation::Mirrored)) => suspicion(
            samples,
            "travel goes a quarter turn less it; left as it is, nothing tells why".into(),
        ),
        _ => Vec::new(),
    }
}

fn place(samples: &Samples, channel: Channel) -> (usize, usize) {
    let first = samples.of(channel).next().map_or(0, |sample| sample.line);
    (samples.of(channel).count(), first)
}

fn swap(samples: &mut Samples, pair: [Channel; 2], kind: NoteKind, text: String) -> Vec<Note> {
    let place = place(samples, pair[0]);
    for run in &mut samples.runs {
        run.channels.swap(pair[0].index(), pair[1].index());
    }
    note(kind, Some(pair[0]), place, text).into_iter().collect()
}

/// Takes each value from a constant.
fn turn_round(samples: &mut Samples, channel: Channel, from: f64, text: String) -> Vec<Note> {
    let place = place(samples, channel);
    for run in &mut samples.runs {
        for sample in &mut run.channels[channel.index()] {
            sample.value = from - sample.value;
        }
    }
    note(NoteKind::Sign, Some(channel), place, text)
        .into_iter()
        .collect()
}

fn suspicion(samples: &Samples, text: String) -> Vec<Note> {
    let place = place(samples, Channel::Heading);
    note(NoteKind::Suspicion, Some(Channel::Heading), place, text)
        .into_iter()
        .collect()
}

/// How the direction of travel depends on the heading, forward or in reverse.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Relation {
    /// It is the heading, or goes with it at some angle.
    Same,
    /// It is a quarter turn less the heading.
    Mirrored,
}

/// The relation that the positions show, if they show one.
fn position(samples: &Samples) -> Option<Relation> {
    // Sums of unit vectors at twice the angles, so that reverse counts as forward.
    let (mut same, mut mirrored) = ([0.0; 2], [0.0; 2]);
    let mut count = 0;
    for run in &samples.runs {
        let (Some(x), Some(y)) = (cumulated(run, Channel::X), cumulated(run, Channel::Y)) else {
            continue;
        };
        for sample in &run.channels[Channel::Heading.index()] {
            let speed = |sum: &Cumulated| sum.mean_rate(sample.time, TRAVEL.0);
            let (Some(east), Some(north)) = (speed(&x), speed(&y)) else {
                continue;
            };
            if east.hypot(north) * TRAVEL.0 < TRAVEL.1 {
                continue;
            }
            let travel = north.atan2(east);
            for (sum, angle) in [
                (&mut same, travel - sample.value),
                (&mut mirrored, travel + sample.value),
            ] {
                sum[0] += (2.0 * angle).cos();
                sum[1] += (2.0 * angle).sin();
            }
            count += 1;
        }
    }
    if count < FEWEST {
        return None;
    }
    let length = |sum: [f64; 2]| sum[0].hypot(sum[1]) / count as f64;
    let off = (mirrored[1].atan2(mirrored[0]) - PI).rem_euclid(TAU);
    if length(mirrored) >= CLEAR && length(same) <= UNCLEAR && off.min(TAU - off) <= NEAR {
        Some(Relation::Mirrored)
    } else {
        (length(same) >= CLEAR && length(mirrored) <= UNCLEAR).then_some(Relation::Same)
    }
}

/// Way along the heading \[m\].
pub fn travel(run: &RawRun) -> Option<Cumulated> {
    let of = |channel: Channel| -> Series {
        let samples = run.channels[channel.index()].iter();
        samples.map(|sample| (sample.time, sample.value)).collect()
    };
    let way = way_along(&of(Channel::X), &of(Channel::Y), &of(Channel::Heading));
    (way.len() > 1).then(|| Cumulated::of_position(&way))
}
