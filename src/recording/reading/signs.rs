//! Swapped columns and inverted signs: two sensors that agree outvote a third one.

use super::agreement::{
    Agreement, compare, cumulated, gyro, heading, wheel_difference, wheel_mean,
};
use crate::recording::by_sides::{BySides, SideMotion};
use crate::recording::channel::Channel;
use crate::recording::csv::{RawRun, RawSamples};
use crate::recording::cumulated::{Cumulated, TimeGrid};
use crate::recording::note::NoteKind;
use crate::recording::pose_history::distance_along_heading;
use crate::recording::series::Series;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Step of the comparisons \[s\].
const STEP: f64 = 0.1;
/// Slower turning than this is noise \[rad/s\].
const SLOWEST_TURN: f64 = 0.03;
/// A direction of travel is taken over one of these durations \[s\], the shortest that gives enough directions, if the
/// vehicle moves at least this far \[m\].
const SPANS: [f64; 3] = [1.0, 3.0, 10.0];
const TRAVEL: f64 = 0.3;
/// Minimum number of directions.
const MIN_DIRECTIONS: usize = 50;
/// Lengths of the mean of unit vectors: the minimum for the relation that holds, the maximum for the other.
pub const CLEAR: f64 = 0.9;
const UNCLEAR: f64 = 0.5;
/// Largest angle between the measured and the expected relation \[rad\].
pub const NEAR: f64 = 0.3;

/// The result of comparing two signals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Vote {
    Together,
    Against,
    /// Neither clearly.
    Unclear,
    /// A signal is missing or too short.
    Absent,
}

/// The vote of two signals with their correlation.
#[derive(Debug, Clone, Copy)]
struct Comparison {
    vote: Vote,
    r: f64,
}

impl Comparison {
    fn of(found: Option<Agreement>) -> Self {
        let vote = match found {
            None => Vote::Absent,
            Some(found) if found.second_deviation() < SLOWEST_TURN => Vote::Absent,
            Some(found) if found.agrees() => Vote::Together,
            Some(found) if found.contradicts() => Vote::Against,
            Some(_) => Vote::Unclear,
        };
        Self {
            vote,
            r: found.map_or(0.0, |found| found.strongest().0),
        }
    }
}

/// Corrects swapped columns and inverted signs.
pub fn settle(samples: &mut RawSamples) {
    use Vote::{Absent, Against, Together};
    correct_side(samples);
    let pose_wheels = Comparison::of(compare(samples, STEP, wheel_difference, heading));
    let gyro_wheels = Comparison::of(compare(samples, STEP, wheel_difference, gyro));
    let pose_gyro = Comparison::of(compare(samples, STEP, heading, gyro));
    let relation = relation(samples);
    let is_mirrored = relation == Some(Relation::Mirrored);
    if let (Against, Against | Absent, Together | Absent, Some(Relation::Clockwise(from)))
    | (Against, Together, Against, Some(Relation::Clockwise(from))) =
        (pose_wheels.vote, gyro_wheels.vote, pose_gyro.vote, relation)
    {
        return convert_clockwise(samples, from, pose_wheels.r, gyro_wheels.vote == Against);
    }
    match (pose_wheels.vote, gyro_wheels.vote, pose_gyro.vote) {
        (Against, Against, Together) if is_mirrored => {
            let text = format!(
                "the wheels went the other way (correlation {:.2}), and the direction of travel is a \
                 quarter turn less the heading",
                gyro_wheels.r
            );
            let heading = format!("taken as clockwise from north and converted: {text}");
            let gyro = format!("taken as clockwise, its sign turned round: {text}");
            invert(samples, Channel::Heading, FRAC_PI_2, heading);
            invert(samples, Channel::YawRate, 0.0, gyro);
            note_lateral_axis(samples);
        }
        (Against, Against, Together) => {
            correct_wheels(samples, "yaw_rate and heading", gyro_wheels.r)
        }
        (Absent, Against, _) => settle_gyro(samples, gyro_wheels.r),
        (Against, Absent, _) if !is_mirrored => correct_wheels(samples, "heading", pose_wheels.r),
        (Together, Against, Against) => {
            let text = format!(
                "sign turned round: it contradicts heading (correlation {:.2}) and wheels \
                 ({:.2}), which agree",
                pose_gyro.r, gyro_wheels.r
            );
            invert(samples, Channel::YawRate, 0.0, text);
        }
        (Against, Together, Against) | (Against, Absent, _) => {
            let text = format!(
                "it contradicts the wheels (correlation {:.2}) and yaw_rate, if there is one",
                pose_wheels.r
            );
            settle_heading(samples, is_mirrored, &text);
        }
        (Together, ..) | (_, _, Together) if is_mirrored => {
            let text = "x and y taken as swapped, and swapped back: the direction of travel is a \
                        quarter turn less the heading, which agrees with yaw rate or wheels";
            let pair = [Channel::X, Channel::Y];
            swap(samples, pair, NoteKind::SwappedPosition, text.into());
        }
        _ if is_mirrored => {
            let text = "the direction of travel is a quarter turn less it; left as it is";
            suspect_heading(samples, text.into());
        }
        _ => {}
    }
}

/// Inverts the side that counts backwards: both sides turn the vehicle the same way then, and move it in opposite
/// directions. Distance and turns must show the same side.
fn correct_side(samples: &mut RawSamples) {
    let by_sides = |motion: fn(&RawRun) -> Option<Cumulated>| {
        let sides = [Channel::OmegaLeft, Channel::OmegaRight];
        let runs = samples.runs.iter().filter_map(|run| {
            let [left, right] = sides.map(|side| cumulated(run, side));
            Some([motion(run)?, left?, right?])
        });
        BySides::of(&runs.collect::<Vec<SideMotion>>())
    };
    let Some(ahead) = by_sides(travel) else {
        return;
    };
    let turns = [heading, gyro].into_iter().filter_map(by_sides);
    let turns: Vec<BySides> = turns.filter(BySides::is_clear).collect();
    let side = ahead.inverted_by_distance();
    let all_agree = turns.iter().all(|turn| turn.inverted_by_turn() == side);
    let (Some(side), Some(turn), true) = (side, turns.first(), all_agree) else {
        return;
    };
    let other = 1 - side;
    let text = format!(
        "its sign turned round: this side counted backwards. For each radian of it the vehicle moves by {:.3} m and turns \
         by {:.3} rad; for each of the other side by {:.3} m and {:.3} rad",
        ahead.by[side], turn.by[side], ahead.by[other], turn.by[other]
    );
    let channel = [Channel::OmegaLeft, Channel::OmegaRight][side];
    invert(samples, channel, 0.0, text);
}

/// Converts a heading that counts clockwise from this direction, as wheels and course over ground show, and inverts the
/// gyro if it counts clockwise as well.
fn convert_clockwise(samples: &mut RawSamples, from: f64, r: f64, gyro: bool) {
    let text = format!(
        "the wheels went the other way (correlation {r:.2}), and so did the course over the ground"
    );
    // The course is the same ahead and in reverse.
    let mut turned = samples.clone();
    invert(&mut turned, Channel::Heading, from, String::new());
    let from = if goes_backwards(&turned) {
        from + PI
    } else {
        from
    };
    let from = from.rem_euclid(TAU);
    let heading = format!(
        "taken as clockwise from {:.0} deg (counter-clockwise from east) and converted: {text}",
        from.to_degrees()
    );
    invert(samples, Channel::Heading, from, heading);
    if gyro {
        let text = format!("taken as clockwise, its sign turned round: {text}");
        invert(samples, Channel::YawRate, 0.0, text);
        note_lateral_axis(samples);
    }
}

/// Frames with clockwise angles usually have a lateral axis to the right.
fn note_lateral_axis(samples: &mut RawSamples) {
    let measured = |channel: &Channel| samples.all(*channel).count > 0;
    let Some(channel) = [Channel::VY, Channel::AY].into_iter().find(measured) else {
        return;
    };
    let text = "unchanged, though heading and yaw_rate count clockwise: where it (v_y, a_y) is positive to the right, \
                turn its sign round";
    let all = samples.all(channel);
    samples.note(NoteKind::Suspicion, Some(channel), all, text);
}

/// Whether on the whole the vehicle moves against the rolling direction of its wheels.
fn goes_backwards(samples: &RawSamples) -> bool {
    let product = |run: &RawRun| {
        let (distance, rims) = (travel(run)?, wheel_mean(run)?);
        let grid = TimeGrid::over(&distance, &rims, STEP)?;
        let rates = [distance, rims].map(|sum| sum.mean_rates(&grid, SPANS[0]));
        let pairs = rates[0].iter().zip(&rates[1]);
        Some(pairs.filter_map(|(a, b)| Some((*a)? * (*b)?)).sum::<f64>())
    };
    samples.runs.iter().filter_map(product).sum::<f64>() < 0.0
}

/// Without a heading the course decides between gyro and wheels; without a course the wheels count as swapped.
fn settle_gyro(samples: &mut RawSamples, r: f64) {
    let by_wheels = Comparison::of(compare(samples, STEP, wheel_difference, course));
    let by_gyro = Comparison::of(compare(samples, STEP, gyro, course));
    match (by_wheels.vote, by_gyro.vote) {
        (Vote::Together, Vote::Against) => {
            let text = format!(
                "sign turned round: it contradicts the course (correlation {:.2}) and wheels ({r:.2}), which agree",
                by_gyro.r
            );
            invert(samples, Channel::YawRate, 0.0, text);
        }
        (Vote::Against, Vote::Together) => swap_wheels(samples, "yaw_rate and the course", r),
        _ => swap_wheels(samples, "yaw_rate", r),
    }
}

/// The course over ground \[rad\], continuous over whole turns, the same in reverse.
fn course(run: &RawRun) -> Option<Cumulated> {
    let (x, y) = (cumulated(run, Channel::X)?, cumulated(run, Channel::Y)?);
    let mut twice: Option<f64> = None;
    let mut angles: Vec<(f64, f64)> = Vec::new();
    for sample in &run.channels[Channel::X.index()] {
        let speed = |sum: &Cumulated| sum.mean_rate(sample.time, SPANS[0]);
        let (Some(east), Some(north)) = (speed(&x), speed(&y)) else {
            continue;
        };
        if east.hypot(north) * SPANS[0] >= TRAVEL {
            let now = 2.0 * north.atan2(east);
            let before = twice.unwrap_or(now);
            let now = now + ((before - now) / TAU).round() * TAU;
            twice = Some(now);
            angles.push((sample.time, 0.5 * now));
        }
    }
    let series: Series = angles.into_iter().collect();
    (series.len() > 1).then(|| Cumulated::of_position(&series))
}

/// Wheels that turn the vehicle the other way are swapped, or both count backwards. In the second case the vehicle also
/// moves the other way.
fn correct_wheels(samples: &mut RawSamples, witness: &str, r: f64) {
    let found = Comparison::of(compare(samples, STEP, wheel_mean, travel));
    let backwards = match found.vote {
        Vote::Against => true,
        // At a steady speed nothing correlates.
        Vote::Absent => goes_backwards(samples),
        _ => false,
    };
    if !backwards {
        return swap_wheels(samples, witness, r);
    }
    let text = format!(
        "its sign turned round, as that of the other side: {witness} went the other way (correlation {r:.2}), and so \
         did the way along the heading ({:.2})",
        found.r
    );
    invert(samples, Channel::OmegaLeft, 0.0, text.clone());
    invert(samples, Channel::OmegaRight, 0.0, text);
}

fn swap_wheels(samples: &mut RawSamples, witness: &str, r: f64) {
    let text = format!(
        "left and right wheel speeds taken as swapped, and swapped back: {witness} went the other \
         way (correlation {r:.2}); turns counted clockwise would look the same"
    );
    let pair = [Channel::OmegaLeft, Channel::OmegaRight];
    swap(samples, pair, NoteKind::SwappedWheels, text);
}

/// A heading that turns the wrong way. It counts clockwise from north if the positions agree; without positions only its
/// sign is inverted; if the positions disagree, it is not changed.
fn settle_heading(samples: &mut RawSamples, is_mirrored: bool, evidence: &str) {
    if is_mirrored {
        let text = format!(
            "taken as clockwise from north and converted: {evidence}, and the direction of travel \
             is a quarter turn less it"
        );
        invert(samples, Channel::Heading, FRAC_PI_2, text);
    } else if samples.all(Channel::X).count == 0 {
        let text = format!("sign turned round: {evidence}");
        invert(samples, Channel::Heading, 0.0, text);
    } else {
        suspect_heading(samples, format!("{evidence}; left as it is"));
    }
}

fn swap(samples: &mut RawSamples, pair: [Channel; 2], kind: NoteKind, text: String) {
    samples.note(kind, Some(pair[0]), samples.all(pair[0]), text);
    for run in &mut samples.runs {
        run.channels.swap(pair[0].index(), pair[1].index());
    }
}

/// Subtracts each value from a constant.
fn invert(samples: &mut RawSamples, channel: Channel, from: f64, text: String) {
    samples.note(NoteKind::Sign, Some(channel), samples.all(channel), text);
    samples.map(channel, |value| from - value);
}

fn suspect_heading(samples: &mut RawSamples, text: String) {
    let heading = Channel::Heading;
    samples.note(
        NoteKind::Suspicion,
        Some(heading),
        samples.all(heading),
        text,
    );
}

/// Relation between direction of travel and heading, forward or in reverse.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Relation {
    /// The direction is the heading plus a constant angle.
    Same,
    /// The direction is a quarter turn less the heading.
    Mirrored,
    /// The direction is this angle, or half a turn more, less the heading \[rad\].
    Clockwise(f64),
}

/// Directions of travel with the headings \[rad\], if the positions show enough of them. A slow vehicle needs a longer
/// duration for a direction.
pub fn directions(samples: &RawSamples) -> Option<Vec<(f64, f64)>> {
    let mut over = SPANS
        .into_iter()
        .map(|seconds| directions_over(samples, seconds));
    over.find(|found| found.len() >= MIN_DIRECTIONS)
}

/// Directions over this duration \[s\].
fn directions_over(samples: &RawSamples, seconds: f64) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for run in &samples.runs {
        let (Some(x), Some(y)) = (cumulated(run, Channel::X), cumulated(run, Channel::Y)) else {
            continue;
        };
        for sample in &run.channels[Channel::Heading.index()] {
            let speed = |sum: &Cumulated| sum.mean_rate(sample.time, seconds);
            let (Some(east), Some(north)) = (speed(&x), speed(&y)) else {
                continue;
            };
            if east.hypot(north) * seconds >= TRAVEL {
                found.push((north.atan2(east), sample.value));
            }
        }
    }
    found
}

/// The relation that the positions show, if any.
fn relation(samples: &RawSamples) -> Option<Relation> {
    let directions = directions(samples)?;
    // Sums of unit vectors at twice the angles, so that reverse counts as forward.
    let (mut same, mut mirrored) = ([0.0; 2], [0.0; 2]);
    for (travel, heading) in &directions {
        for (sum, angle) in [
            (&mut same, travel - heading),
            (&mut mirrored, travel + heading),
        ] {
            sum[0] += (2.0 * angle).cos();
            sum[1] += (2.0 * angle).sin();
        }
    }
    let length = |sum: [f64; 2]| sum[0].hypot(sum[1]) / directions.len() as f64;
    let off = (mirrored[1].atan2(mirrored[0]) - PI).rem_euclid(TAU);
    let is_mirrored = length(mirrored) >= CLEAR && length(same) <= UNCLEAR;
    if is_mirrored && off.min(TAU - off) <= NEAR {
        Some(Relation::Mirrored)
    } else if is_mirrored {
        Some(Relation::Clockwise(0.5 * mirrored[1].atan2(mirrored[0])))
    } else {
        (length(same) >= CLEAR && length(mirrored) <= UNCLEAR).then_some(Relation::Same)
    }
}

/// Distance along the heading \[m\].
pub fn travel(run: &RawRun) -> Option<Cumulated> {
    let [x, y, heading] =
        [Channel::X, Channel::Y, Channel::Heading].map(|channel| run.series(channel));
    let distance = distance_along_heading(&x, &y, &heading);
    (distance.len() > 1).then(|| Cumulated::of_position(&distance))
}
