//! Angles and wheel speeds in other units than radians.

use super::agreement::{Agreement, compare, cumulated, wheels};
use super::limits::limit;
use super::signs::{self, travel};
use super::{note, place};
use crate::recording::csv::{RawRun, Samples};
use crate::recording::{Channel, Cumulated, Grid, Note, NoteKind};
use crate::vehicle::Vehicle;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

const DEGREES: f64 = 180.0 / PI;
/// Step of the comparison \[s\].
const STEP: f64 = 0.1;
/// How near a ratio must come to that of the units, and how strong the correlation must be.
const NEAR: f64 = 1.15;
const STRONG: f64 = 0.9;
/// Yaw rate by difference of wheel speeds \[-\]: r / 2B times at most one. No vehicle's wheels
/// have a radius of more than its track, and degrees make it 57 times as much.
const MOST_TURN: f64 = 3.0;
/// Jumps of a wrapped heading in degrees, smaller ones that do not count \[deg\], and the longest
/// intervals in which no vehicle turns by a full turn, and by as much as lies between \[s\].
const FULL_TURN: RangeInclusive<f64> = 310.0..=360.5;
const LARGE: f64 = 50.0;
const QUICK: [f64; 2] = [1.2, 0.35];
/// Some other jumps may be among them (a course at standstill) where more than half of all values are beyond this,
/// which is no wrapped heading in radians \[rad\].
const NO_RADIANS: f64 = 7.0;
/// The same of rim speeds in metres per second, 1 / 2B at most: no track is narrower than 0.2 m.
const MOST_TURN_OF_RIMS: f64 = 5.0;
/// Share of the rim speed at which a vehicle may seem to move, where the unit is right.
const EFFECTIVE: RangeInclusive<f64> = 0.7..=1.2;
/// The same where no vehicle is known, whose wheels may have a radius of a metre.
const EFFECTIVE_OF_ANY: RangeInclusive<f64> = 0.85..=1.1;
/// Share of the way that goes along the heading, at least, where the way tells the unit of wheel speeds.
const AHEAD: f64 = 0.8;
/// Means for it are over so many seconds \[s\].
const SPAN: f64 = 1.0;
/// No vehicle moves at more than so many times the speed of its rims, sliding downhill aside.
const MOST_TRAVEL: f64 = 1.5;

/// Converts headings and yaw rates from degrees, and wheel speeds that cannot be.
pub fn convert(samples: &mut Samples, vehicle: Option<&Vehicle>) -> Vec<Note> {
    let mut notes = Vec::new();
    notes.extend(wrapped_degrees(samples));
    let rims = rim_speeds(samples, vehicle);
    let is_suspected = |note: &Note| note.kind == NoteKind::Suspicion;
    let most_turn = if rims.as_ref().is_some_and(is_suspected) {
        MOST_TURN_OF_RIMS
    } else {
        MOST_TURN
    };
    notes.extend(rims);
    notes.extend(degrees(samples, most_turn));
    if !notes
        .iter()
        .any(|note| note.channel == Some(Channel::Heading))
    {
        notes.extend(degrees_by_course(samples));
    }
    notes.extend(wheel_unit(samples, vehicle));
    notes
}

fn scale(samples: &mut Samples, channel: Channel, factor: f64) -> (usize, usize) {
    for run in &mut samples.runs {
        for sample in &mut run.channels[channel.index()] {
            sample.value *= factor;
        }
    }
    place(samples, channel)
}

fn from_degrees(samples: &mut Samples, channel: Channel, evidence: &str) -> Option<Note> {
    let place = scale(samples, channel, 1.0 / DEGREES);
    let text = format!("taken as degrees and converted: {evidence}");
    note(NoteKind::Unit, Some(channel), place, text)
}

/// Headings that jump by 360 and stay within that.
fn wrapped_degrees(samples: &mut Samples) -> Option<Note> {
    let heading = Channel::Heading.index();
    // From where it counts does not matter: 90 less a compass, a compass with declination.
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let headings = samples.of(Channel::Heading).map(|sample| sample.value);
    let (low, high) = headings.fold(nothing, |(low, high), value| {
        (value.min(low), value.max(high))
    });
    if high - low > *FULL_TURN.end() {
        return None;
    }
    let jumps = |run: &RawRun| {
        let (mut full, mut other) = (0, 0);
        for pair in run.channels[heading].windows(2) {
            let size = (pair[1].value - pair[0].value).abs();
            let interval = pair[1].time - pair[0].time;
            if FULL_TURN.contains(&size) {
                full += usize::from(interval < QUICK[0]);
            } else {
                other += usize::from(size > LARGE && interval < QUICK[1]);
            }
        }
        (full, other)
    };
    let (full, other) = samples
        .runs
        .iter()
        .map(jumps)
        .fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    let all = samples.of(Channel::Heading).count();
    let beyond = samples.of(Channel::Heading);
    let beyond = beyond.filter(|sample| sample.value.abs() > NO_RADIANS);
    let is_degrees = 2 * beyond.count() > all && other <= full;
    if full == 0 || (other > 0 && !is_degrees) {
        return None;
    }
    let evidence = format!("it stays within 360 and jumps by that {full} times");
    from_degrees(samples, Channel::Heading, &evidence)
}

/// Way along the heading \[m\] of a run in which the vehicle goes along its heading: one that is measured across, or in
/// another frame, tells nothing of the wheels' unit.
fn travel_ahead(run: &RawRun) -> Option<Cumulated> {
    let way = travel(run)?;
    let (x, y) = (cumulated(run, Channel::X)?, cumulated(run, Channel::Y)?);
    let grid = Grid::over(&x, &way, STEP)?;
    let rates = |sum: &Cumulated| sum.mean_rates(&grid, SPAN);
    let (x, y) = (rates(&x), rates(&y));
    let (mut ahead, mut whole) = (0.0, 0.0);
    for (way, (x, y)) in rates(&way).iter().zip(x.iter().zip(&y)) {
        if let (Some(way), Some(x), Some(y)) = (way, x, y) {
            ahead += way.abs();
            whole += x.hypot(*y);
        }
    }
    (ahead >= AHEAD * whole).then_some(way)
}

/// Wheel speeds in metres per second: as rad/s the vehicle would leave its rims behind. Without a vehicle they are told.
fn rim_speeds(samples: &mut Samples, vehicle: Option<&Vehicle>) -> Option<Note> {
    let sides = [Channel::OmegaLeft, Channel::OmegaRight];
    let mean = |run: &_| wheels(run, [0.5, 0.5]);
    let found = compare(samples, STEP, travel_ahead, mean)?;
    let (correlation, slope) = found.strongest();
    if correlation < STRONG {
        return None;
    }
    let Some(radius) = vehicle.map(|vehicle| vehicle.wheel_radius) else {
        let text = format!(
            "both wheel speeds may be rim speeds in m/s: the vehicle moves at {slope:.2} of them \
             (correlation {correlation:.2}); left as they are, for the wheels' radius is not known"
        );
        let is_told = found
            .ratios()
            .iter()
            .all(|ratio| EFFECTIVE_OF_ANY.contains(ratio));
        let place = place(samples, sides[0]);
        return note(NoteKind::Suspicion, Some(sides[0]), place, text).filter(|_| is_told);
    };
    let fits = |ratio: &f64| EFFECTIVE.contains(ratio) && *ratio >= MOST_TRAVEL * radius;
    if !found.ratios().iter().all(fits) {
        return None;
    }
    let places = sides.map(|side| scale(samples, side, 1.0 / radius));
    let text = format!(
        "both wheel speeds taken as rim speeds in m/s and divided by the wheels' radius of {radius} m: the vehicle \
         moves at {slope:.2} of them (correlation {correlation:.2}), as rad/s at {:.1} of the rims' speed",
        slope / radius
    );
    note(NoteKind::Unit, Some(sides[0]), places[0], text)
}

/// Headings and yaw rates that turn 57 times too fast for each other or for the wheels.
fn degrees(samples: &mut Samples, most_turn: f64) -> Vec<Note> {
    let heading = |run: &_| cumulated(run, Channel::Heading);
    let gyro = |run: &_| cumulated(run, Channel::YawRate);
    let difference = |run: &_| wheels(run, [-1.0, 1.0]);
    let clear = |(correlation, slope): (f64, f64)| {
        (correlation.abs() >= STRONG).then_some((correlation, slope.abs()))
    };
    let of = |agreement: Option<Agreement>| agreement.and_then(|found| clear(found.strongest()));
    let both = of(compare(samples, STEP, heading, gyro));
    let turn = of(compare(samples, STEP, heading, difference)).filter(|turn| turn.1 > most_turn);
    let yaw = of(compare(samples, STEP, gyro, difference)).filter(|yaw| yaw.1 > most_turn);
    let (mut heading_evidence, mut gyro_evidence) = (None, None);
    match both {
        Some((r, ratio)) if near(ratio, DEGREES) => {
            heading_evidence = Some(format!(
                "it turns {ratio:.1} times as fast as yaw_rate says (correlation {r:.2})"
            ));
        }
        Some((r, ratio)) if near(1.0 / ratio, DEGREES) => {
            let fast = 1.0 / ratio;
            gyro_evidence = Some(format!(
                "it is {fast:.1} times as fast as heading turns (correlation {r:.2})"
            ));
        }
        Some((_, ratio)) if !near(ratio, 1.0) => {}
        _ => {
            let text = |(r, slope): (f64, f64)| {
                format!(
                    "the turn is {slope:.1} per radian of wheel difference (correlation {r:.2})"
                )
            };
            (heading_evidence, gyro_evidence) = (turn.map(text), yaw.map(text));
            // Those that turn alike have one unit.
            if both.is_some() {
                heading_evidence = heading_evidence.or_else(|| gyro_evidence.clone());
                gyro_evidence = gyro_evidence.or_else(|| heading_evidence.clone());
            }
        }
    }
    let mut notes = Vec::new();
    for (channel, evidence) in [
        (Channel::Heading, heading_evidence),
        (Channel::YawRate, gyro_evidence),
    ] {
        notes.extend(evidence.and_then(|text| from_degrees(samples, channel, &text)));
    }
    notes
}

/// Headings of a drive with few turns, which the course over the ground agrees with as degrees and not as radians; and
/// yaw rates that turn alike.
fn degrees_by_course(samples: &mut Samples) -> Vec<Note> {
    let headings = samples.of(Channel::Heading);
    let (count, beyond) = headings.fold((0, 0), |(count, beyond), sample| {
        (
            count + 1,
            beyond + usize::from(sample.value.abs() > NO_RADIANS),
        )
    });
    if 2 * beyond <= count {
        return Vec::new();
    }
    let Some(directions) = signs::directions(samples) else {
        return Vec::new();
    };
    // Length and half the angle of the mean unit vector at twice the angle between, which is the same in reverse.
    let off = |unit: f64| {
        let angles = directions
            .iter()
            .map(|(travel, heading)| 2.0 * (travel - heading / unit));
        let (east, north) = angles.fold((0.0, 0.0), |(x, y), angle| {
            (x + angle.cos(), y + angle.sin())
        });
        (
            east.hypot(north) / directions.len() as f64,
            0.5 * north.atan2(east),
        )
    };
    let goes_along =
        |(length, angle): (f64, f64)| length >= signs::CLEAR && angle.abs() <= signs::NEAR;
    let (degrees, radians, clockwise) = (off(DEGREES), off(1.0), off(-1.0));
    if !goes_along(degrees) || goes_along(radians) {
        return Vec::new();
    }
    let evidence = format!(
        "as such it is within {:.0} deg of the direction of travel, on the mean",
        degrees.1.abs().to_degrees().max(1.0)
    );
    // A steady heading from another zero looks the same, and so can one that counts the other way.
    let otherwise = if radians.0 >= signs::CLEAR {
        format!("as radians {:.0} deg off", radians.1.abs().to_degrees())
    } else if clockwise.0 >= signs::CLEAR {
        "as radians it would count the other way round".into()
    } else {
        let gyro = alike(samples).and_then(|r| {
            let text = format!("heading turns alike (correlation {r:.2}), which is in degrees");
            from_degrees(samples, Channel::YawRate, &text)
        });
        let heading = from_degrees(samples, Channel::Heading, &evidence);
        return heading.into_iter().chain(gyro).collect();
    };
    let text = format!("may be degrees: {evidence}, {otherwise}; left as it is");
    let place = place(samples, Channel::Heading);
    let told = note(NoteKind::Suspicion, Some(Channel::Heading), place, text);
    told.into_iter().collect()
}

/// Correlation of heading and yaw rate, if they turn alike.
fn alike(samples: &Samples) -> Option<f64> {
    let heading = |run: &_| cumulated(run, Channel::Heading);
    let gyro = |run: &_| cumulated(run, Channel::YawRate);
    let (r, slope) = compare(samples, STEP, heading, gyro)?.strongest();
    (r.abs() >= STRONG && near(slope.abs(), 1.0)).then_some(r)
}

/// Whether a ratio is that of units.
fn near(ratio: f64, unit: f64) -> bool {
    (ratio / unit).max(unit / ratio) < NEAR
}

/// Wheel speeds that in another unit move the vehicle as its pose says: those beyond the limit are converted, others told,
/// for wheels that slip look the same.
fn wheel_unit(samples: &mut Samples, vehicle: Option<&Vehicle>) -> Option<Note> {
    let sides = [Channel::OmegaLeft, Channel::OmegaRight];
    let beyond = |side: Channel| {
        samples
            .of(side)
            .any(|sample| sample.value.abs() > limit(side))
    };
    let radius = vehicle?.wheel_radius;
    let mean = |run: &_| wheels(run, [0.5, 0.5]);
    let found = compare(samples, STEP, travel_ahead, mean)?;
    let (correlation, slope) = found.strongest();
    let units = [("degrees per second", DEGREES), ("rpm", 30.0 / PI)];
    let fits = |unit: &(&str, f64)| {
        let effective = found.ratios().map(|ratio| ratio * unit.1 / radius);
        effective.iter().all(|ratio| EFFECTIVE.contains(ratio))
    };
    let (name, size) = units
        .into_iter()
        .find(fits)
        .filter(|_| correlation >= STRONG)?;
    let evidence = format!(
        "as rad/s the vehicle would move at {:.3} of the rims' speed (correlation {correlation:.2})",
        slope / radius
    );
    if !sides.into_iter().any(beyond) {
        let place = place(samples, sides[0]);
        let text = format!("both wheel speeds may be {name}: {evidence}; left as they are");
        return note(NoteKind::Suspicion, Some(sides[0]), place, text);
    }
    let places = sides.map(|side| scale(samples, side, 1.0 / size));
    let text = format!("both wheel speeds taken as {name} and converted: {evidence}");
    note(NoteKind::Unit, Some(sides[0]), places[0], text)
}
