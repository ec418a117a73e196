//! Columns that are swapped and signs that are turned round: two sensors that agree outvote a
//! third one that says the opposite.

use super::agreement::{Agreement, compare, cumulated, wheels};
use super::{note, place};
use crate::recording::csv::{RawRun, Samples};
use crate::recording::{Channel, Cumulated, Grid, Note, NoteKind, Series, way_along};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Step of the comparisons \[s\].
const STEP: f64 = 0.1;
/// Slower turning than this is noise \[rad/s\].
const SLOWEST_TURN: f64 = 0.03;
/// Directions of travel are those of so many seconds \[s\], the shortest of which there are enough, in which the vehicle
/// comes this far \[m\].
const SPANS: [f64; 3] = [1.0, 3.0, 10.0];
const TRAVEL: f64 = 0.3;
/// Fewer directions tell nothing.
const FEWEST: usize = 50;
/// How well directions must agree with one relation, and how badly with the other: lengths of
/// the mean of unit vectors.
pub const CLEAR: f64 = 0.9;
const UNCLEAR: f64 = 0.5;
/// Largest angle between the relation and what is expected of it \[rad\].
pub const NEAR: f64 = 0.3;

/// What two signals say of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Vote {
    Together,
    Against,
    /// Neither clearly.
    Unclear,
    /// One of both was not measured, or not for long enough.
    Absent,
}

/// Two signals' vote with their correlation.
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

/// Puts right what is swapped or turned round.
pub fn settle(samples: &mut Samples) -> Vec<Note> {
    use Vote::{Absent, Against, Together};
    let difference = |run: &_| wheels(run, [-1.0, 1.0]);
    let heading = |run: &_| cumulated(run, Channel::Heading);
    let gyro = |run: &_| cumulated(run, Channel::YawRate);
    let pose_wheels = Comparison::of(compare(samples, STEP, difference, heading));
    let gyro_wheels = Comparison::of(compare(samples, STEP, difference, gyro));
    let pose_gyro = Comparison::of(compare(samples, STEP, heading, gyro));
    let relation = position(samples);
    let is_mirrored = relation == Some(Relation::Mirrored);
    if let (Against, Against | Absent, Together | Absent, Some(Relation::Clockwise(from)))
    | (Against, Together, Against, Some(Relation::Clockwise(from))) =
        (pose_wheels.vote, gyro_wheels.vote, pose_gyro.vote, relation)
    {
        return clockwise(samples, from, pose_wheels.r, gyro_wheels.vote == Against);
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
            let mut notes = turn_round(samples, Channel::Heading, FRAC_PI_2, heading);
            notes.extend(turn_round(samples, Channel::YawRate, 0.0, gyro));
            notes.extend(sideways(samples));
            notes
        }
        (Against, Against, Together) => mend_wheels(samples, "yaw_rate and heading", gyro_wheels.r),
        (Absent, Against, _) => settle_gyro(samples, gyro_wheels.r),
        (Against, Absent, _) if !is_mirrored => mend_wheels(samples, "heading", pose_wheels.r),
        (Together, Against, Against) => {
            let text = format!(
                "sign turned round: it contradicts heading (correlation {:.2}) and wheels \
                 ({:.2}), which agree",
                pose_gyro.r, gyro_wheels.r
            );
            turn_round(samples, Channel::YawRate, 0.0, text)
        }
        (Against, Together, Against) | (Against, Absent, _) => {
            let text = format!(
                "it contradicts the wheels (correlation {:.2}) and yaw_rate, if there is one",
                pose_wheels.r
            );
            settle_heading(samples, is_mirrored, &text)
        }
        (Together, ..) | (_, _, Together) if is_mirrored => {
            let text = "x and y taken as swapped, and swapped back: the direction of travel is a \
                        quarter turn less the heading, which agrees with yaw rate or wheels";
            let pair = [Channel::X, Channel::Y];
            swap(samples, pair, NoteKind::SwappedPosition, text.into())
        }
        _ if is_mirrored => {
            let text = "the direction of travel is a quarter turn less it; left as it is";
            suspicion(samples, text.into())
        }
        _ => Vec::new(),
    }
}

/// A heading that counts clockwise from this direction, as the course over the ground shows, which goes with the wheels;
/// and the gyro, where it counts so, too.
fn clockwise(samples: &mut Samples, from: f64, r: f64, gyro: bool) -> Vec<Note> {
    let text = format!(
        "the wheels went the other way (correlation {r:.2}), and so did the course over the ground"
    );
    // The course is the same ahead and in reverse.
    let mut turned = samples.clone();
    turn_round(&mut turned, Channel::Heading, from, String::new());
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
    let mut notes = turn_round(samples, Channel::Heading, from, heading);
    if gyro {
        let text = format!("taken as clockwise, its sign turned round: {text}");
        notes.extend(turn_round(samples, Channel::YawRate, 0.0, text));
        notes.extend(sideways(samples));
    }
    notes
}

/// Axes in which angles count clockwise mostly point to the right, too.
fn sideways(samples: &Samples) -> Option<Note> {
    let told = |channel: &Channel| samples.of(*channel).next().is_some();
    let channel = [Channel::VY, Channel::AY].into_iter().find(told)?;
    let text = "left as it is, though heading and yaw_rate count clockwise: where it (v_y, a_y) is positive to the right, \
                turn its sign round";
    note(
        NoteKind::Suspicion,
        Some(channel),
        place(samples, channel),
        text.into(),
    )
}

/// Whether the vehicle comes the other way than its wheels roll, on the whole.
fn goes_backwards(samples: &Samples) -> bool {
    let product = |run: &RawRun| {
        let (way, rims) = (travel(run)?, wheels(run, [0.5, 0.5])?);
        let grid = Grid::over(&way, &rims, STEP)?;
        let rates = [way, rims].map(|sum| sum.mean_rates(&grid, SPANS[0]));
        let pairs = rates[0].iter().zip(&rates[1]);
        Some(pairs.filter_map(|(a, b)| Some((*a)? * (*b)?)).sum::<f64>())
    };
    samples.runs.iter().filter_map(product).sum::<f64>() < 0.0
}

/// Without a heading the course decides between gyro and wheels; without that, too, the wheels are swapped.
fn settle_gyro(samples: &mut Samples, r: f64) -> Vec<Note> {
    let difference = |run: &_| wheels(run, [-1.0, 1.0]);
    let gyro = |run: &_| cumulated(run, Channel::YawRate);
    let by_wheels = Comparison::of(compare(samples, STEP, difference, course));
    let by_gyro = Comparison::of(compare(samples, STEP, gyro, course));
    match (by_wheels.vote, by_gyro.vote) {
        (Vote::Together, Vote::Against) => {
            let text = format!(
                "sign turned round: it contradicts the course (correlation {:.2}) and wheels ({r:.2}), which agree",
                by_gyro.r
            );
            turn_round(samples, Channel::YawRate, 0.0, text)
        }
        (Vote::Against, Vote::Together) => swap_wheels(samples, "yaw_rate and the course", r),
        _ => swap_wheels(samples, "yaw_rate", r),
    }
}

/// The course over the ground \[rad\], counted on over whole turns, forward as in reverse.
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

/// Wheels that turn the vehicle the other way are swapped, or both count backwards: then the vehicle comes the other way,
/// too.
fn mend_wheels(samples: &mut Samples, witness: &str, r: f64) -> Vec<Note> {
    let ahead = |run: &_| wheels(run, [0.5, 0.5]);
    let found = Comparison::of(compare(samples, STEP, ahead, travel));
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
    let mut notes = turn_round(samples, Channel::OmegaLeft, 0.0, text.clone());
    notes.extend(turn_round(samples, Channel::OmegaRight, 0.0, text));
    notes
}

fn swap_wheels(samples: &mut Samples, witness: &str, r: f64) -> Vec<Note> {
    let text = format!(
        "left and right wheel speeds taken as swapped, and swapped back: {witness} went the other \
         way (correlation {r:.2}); turns counted clockwise would look the same"
    );
    let pair = [Channel::OmegaLeft, Channel::OmegaRight];
    swap(samples, pair, NoteKind::SwappedWheels, text)
}

/// A heading that turns the wrong way round: clockwise from north, if the positions say so; only
/// its sign, if there are none; left alone, if they say something else.
fn settle_heading(samples: &mut Samples, is_mirrored: bool, evidence: &str) -> Vec<Note> {
    if is_mirrored {
        let text = format!(
            "taken as clockwise from north and converted: {evidence}, and the direction of travel \
             is a quarter turn less it"
        );
        turn_round(samples, Channel::Heading, FRAC_PI_2, text)
    } else if samples.of(Channel::X).next().is_none() {
        let text = format!("sign turned round: {evidence}");
        turn_round(samples, Channel::Heading, 0.0, text)
    } else {
        suspicion(samples, format!("{evidence}; left as it is"))
    }
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
    /// It is this, or half a turn more, less the heading \[rad\].
    Clockwise(f64),
}

/// Directions of travel beside the headings \[rad\], if the positions show enough of them: a slow vehicle takes longer to
/// come anywhere.
pub fn directions(samples: &Samples) -> Option<Vec<(f64, f64)>> {
    let mut over = SPANS
        .into_iter()
        .map(|seconds| directions_over(samples, seconds));
    over.find(|found| found.len() >= FEWEST)
}

/// The same over so many seconds.
fn directions_over(samples: &Samples, seconds: f64) -> Vec<(f64, f64)> {
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

/// The relation that the positions show, if they show one.
fn position(samples: &Samples) -> Option<Relation> {
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

/// Way along the heading \[m\].
pub fn travel(run: &RawRun) -> Option<Cumulated> {
    let of = |channel: Channel| -> Series {
        let samples = run.channels[channel.index()].iter();
        samples.map(|sample| (sample.time, sample.value)).collect()
    };
    let way = way_along(&of(Channel::X), &of(Channel::Y), &of(Channel::Heading));
    (way.len() > 1).then(|| Cumulated::of_position(&way))
}
