//! Angles and wheel speeds in other units than radians.

use super::agreement::{
    Agreement, compare, cumulated, gyro, heading, wheel_difference, wheel_mean,
};
use super::limits::limit;
use super::signs::{self, travel};
use crate::recording::channel::Channel;
use crate::recording::csv::{RawRun, RawSamples};
use crate::recording::cumulated::{Cumulated, TimeGrid};
use crate::recording::note::{Note, NoteKind};
use crate::recording::statistics::{nearest_rank, range};
use crate::vehicle::Vehicle;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

const SIDES: [Channel; 2] = [Channel::OmegaLeft, Channel::OmegaRight];
const DEGREES: f64 = 180.0 / PI;
/// Step of the comparison \[s\].
const STEP: f64 = 0.1;
/// Maximum factor between a ratio and that of the units; minimum correlation.
const NEAR: f64 = 1.15;
const STRONG: f64 = 0.9;
/// Maximum of yaw rate over difference of wheel speeds \[-\]. It is at most r / 2B, and no wheel's radius exceeds the
/// track; degrees make the ratio 57 times as large.
const MAX_TURN: f64 = 3.0;
/// No vehicle keeps turning faster than this \[rad/s\]; angles that would are degrees.
const FASTEST: f64 = 4.0;
/// Jumps of a wrapped heading in degrees, and the size from which other jumps count \[deg\]. QUICK are the longest intervals
/// \[s\] in which no vehicle turns by a full turn, or by a jump of that size.
const FULL_TURN: RangeInclusive<f64> = 310.0..=360.5;
const LARGE: f64 = 50.0;
const QUICK: [f64; 2] = [1.2, 0.35];
/// A wrapped heading in radians stays below this. If more than half of the values are beyond it, other jumps are allowed
/// as well, such as those of a course at standstill \[rad\].
const NO_RADIANS: f64 = 7.0;
/// As MAX_TURN for rim speeds in m/s: at most 1 / 2B, and no track is narrower than 0.2 m.
const MAX_TURN_OF_RIMS: f64 = 5.0;
/// Ratio of vehicle speed to rim speed in the right unit.
const EFFECTIVE: RangeInclusive<f64> = 0.7..=1.2;
/// The same for an unknown vehicle, whose wheel radius may be a metre.
const EFFECTIVE_OF_ANY: RangeInclusive<f64> = 0.85..=1.1;
/// Share of impossible wheel speeds above which they are no spikes.
const OFTEN: f64 = 0.01;
/// Minimum share of the distance along the heading, if the distance shows the unit of wheel speeds.
const AHEAD: f64 = 0.8;
/// Window of the means for that share \[s\].
const SPAN: f64 = 1.0;
/// Maximum ratio of vehicle speed to rim speed, except when sliding downhill.
const MAX_TRAVEL: f64 = 1.5;

/// Converts headings and yaw rates from degrees, and rim speeds of a known vehicle.
pub fn convert(samples: &mut RawSamples, vehicle: Option<&Vehicle>) {
    let before = samples.notes.len();
    wrapped_degrees(samples);
    let max_turn = if rim_speeds(samples, vehicle) == Some(NoteKind::Suspicion) {
        MAX_TURN_OF_RIMS
    } else {
        MAX_TURN
    };
    degrees(samples, max_turn);
    let concerns_heading = |note: &Note| note.channel == Some(Channel::Heading);
    if !samples.notes[before..].iter().any(concerns_heading) {
        degrees_by_course(samples);
    }
    wheel_unit(samples, vehicle);
}

fn from_degrees(samples: &mut RawSamples, channel: Channel, evidence: &str) {
    samples.map(channel, |value| value * (1.0 / DEGREES));
    let text = format!("taken as degrees and converted: {evidence}");
    samples.note(NoteKind::Unit, Some(channel), samples.all(channel), text);
}

/// Notes on both wheel speeds, whose values change by a factor if it is known.
fn wheel_note(samples: &mut RawSamples, kind: NoteKind, factor: f64, text: String) {
    for side in SIDES {
        samples.map(side, |value| value * factor);
    }
    samples.note(kind, Some(SIDES[0]), samples.all(SIDES[0]), text);
}

/// Headings that jump by 360 and stay within that range.
fn wrapped_degrees(samples: &mut RawSamples) {
    let heading = Channel::Heading.index();
    // Their zero does not matter: it may be 90 less a compass, or a compass with declination.
    let [min, max] = range(samples.of(Channel::Heading).map(|sample| sample.value));
    if max - min > *FULL_TURN.end() {
        return;
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
    if full == 0 || (other > 0 && !(are_beyond_radians(samples) && other <= full)) {
        return;
    }
    let evidence = format!("it stays within 360 and jumps by that {full} times");
    from_degrees(samples, Channel::Heading, &evidence);
}

/// Whether more than half of the headings are too large for wrapped radians.
fn are_beyond_radians(samples: &RawSamples) -> bool {
    let beyond = samples.of(Channel::Heading);
    let beyond = beyond.filter(|sample| sample.value.abs() > NO_RADIANS);
    2 * beyond.count() > samples.all(Channel::Heading).count
}

/// Distance along the heading \[m\] of a run in which the vehicle moves along its heading. A heading across the vehicle, or
/// in another frame, does not show the wheels' unit.
fn travel_ahead(run: &RawRun) -> Option<Cumulated> {
    let distance = travel(run)?;
    let (x, y) = (cumulated(run, Channel::X)?, cumulated(run, Channel::Y)?);
    let grid = TimeGrid::over(&x, &distance, STEP)?;
    let rates = |sum: &Cumulated| sum.mean_rates(&grid, SPAN);
    let (x, y) = (rates(&x), rates(&y));
    let (mut ahead, mut whole) = (0.0, 0.0);
    for (along, (x, y)) in rates(&distance).iter().zip(x.iter().zip(&y)) {
        if let (Some(along), Some(x), Some(y)) = (along, x, y) {
            ahead += along.abs();
            whole += x.hypot(*y);
        }
    }
    (ahead >= AHEAD * whole).then_some(distance)
}

/// Wheel speeds in metres per second: as rad/s the vehicle would be faster than its rims. They are converted for a known
/// vehicle and otherwise noted. Returns the kind of the note.
fn rim_speeds(samples: &mut RawSamples, vehicle: Option<&Vehicle>) -> Option<NoteKind> {
    let found = compare(samples, STEP, travel_ahead, wheel_mean)?;
    let (correlation, slope) = found.strongest();
    if correlation < STRONG {
        return None;
    }
    let Some(radius) = vehicle.map(|vehicle| vehicle.wheel_radius) else {
        let is_clear = |ratio: &f64| EFFECTIVE_OF_ANY.contains(ratio);
        if !found.ratios().iter().all(is_clear) {
            return None;
        }
        let text = format!(
            "both wheel speeds may be rim speeds in m/s: the vehicle moves at {slope:.2} of them \
             (correlation {correlation:.2}); left as they are, for the wheels' radius is not known"
        );
        wheel_note(samples, NoteKind::Suspicion, 1.0, text);
        return Some(NoteKind::Suspicion);
    };
    let fits = |ratio: &f64| EFFECTIVE.contains(ratio) && *ratio >= MAX_TRAVEL * radius;
    if !found.ratios().iter().all(fits) {
        return None;
    }
    let text = format!(
        "both wheel speeds taken as rim speeds in m/s and divided by the wheels' radius of {radius} m: the vehicle \
         moves at {slope:.2} of them (correlation {correlation:.2}), as rad/s at {:.1} of the rims' speed",
        slope / radius
    );
    wheel_note(samples, NoteKind::Unit, 1.0 / radius, text);
    Some(NoteKind::Unit)
}

/// Headings and yaw rates that turn 57 times too fast for each other or for the wheels.
fn degrees(samples: &mut RawSamples, max_turn: f64) {
    let clear = |(correlation, slope): (f64, f64)| {
        (correlation.abs() >= STRONG).then_some((correlation, slope.abs()))
    };
    let of = |agreement: Option<Agreement>| agreement.and_then(|found| clear(found.strongest()));
    let both = of(compare(samples, STEP, heading, gyro));
    let by_wheels = |of_turn: Option<Agreement>| of(of_turn).filter(|turn| turn.1 > max_turn);
    let turn = by_wheels(compare(samples, STEP, heading, wheel_difference));
    let yaw = by_wheels(compare(samples, STEP, gyro, wheel_difference));
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
            let turning = [fastest_turn(samples, heading), fastest_turn(samples, gyro)];
            let [quick, fast] = turning.map(|rate| rate.is_some_and(|rate| rate > FASTEST));
            // Wheel speeds that are too small, as those behind a gear, look the same as angles that are too large.
            for (channel, found, is_fast) in [
                (Channel::Heading, turn, quick),
                (Channel::YawRate, yaw, fast),
            ] {
                if let Some(found) = found.filter(|_| !is_fast) {
                    let text = format!(
                        "may be degrees, or the wheel speeds may be too small (gear ratio, ticks per turn, unit): {}; left \
                         as it is",
                        text(found)
                    );
                    samples.note(
                        NoteKind::Suspicion,
                        Some(channel),
                        samples.all(channel),
                        text,
                    );
                }
            }
            heading_evidence = turn.filter(|_| quick).map(text);
            gyro_evidence = yaw.filter(|_| fast).map(text);
            // Signals that turn equally fast have the same unit.
            if both.is_some() {
                heading_evidence = heading_evidence.or_else(|| gyro_evidence.clone());
                gyro_evidence = gyro_evidence.or_else(|| heading_evidence.clone());
            }
        }
    }
    for (channel, evidence) in [
        (Channel::Heading, heading_evidence),
        (Channel::YawRate, gyro_evidence),
    ] {
        if let Some(text) = evidence {
            from_degrees(samples, channel, &text);
        }
    }
}

/// The rate of turning, in the data's unit, that is exceeded for a twentieth of the time.
fn fastest_turn(samples: &RawSamples, angle: impl Fn(&RawRun) -> Option<Cumulated>) -> Option<f64> {
    let mut rates: Vec<f64> = Vec::new();
    for sum in samples.runs.iter().filter_map(angle) {
        let grid = TimeGrid::over(&sum, &sum, STEP)?;
        rates.extend(
            sum.mean_rates(&grid, SPAN)
                .into_iter()
                .flatten()
                .map(f64::abs),
        );
    }
    rates.sort_by(f64::total_cmp);
    nearest_rank(&rates, 0.95)
}

/// Headings of a drive with few turns that agree with the course over ground as degrees and not as radians, and yaw rates
/// that turn equally fast.
fn degrees_by_course(samples: &mut RawSamples) {
    if !are_beyond_radians(samples) {
        return;
    }
    let Some(directions) = signs::directions(samples) else {
        return;
    };
    // Length and half the angle of the mean unit vector at twice the angle between both, which is the same in reverse.
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
        return;
    }
    let evidence = format!(
        "as such it is within {:.0} deg of the direction of travel, on the mean",
        degrees.1.abs().to_degrees().max(1.0)
    );
    // A steady heading with another zero looks the same, and so may one that counts the other way.
    let otherwise = if radians.0 >= signs::CLEAR {
        format!("as radians {:.0} deg off", radians.1.abs().to_degrees())
    } else if clockwise.0 >= signs::CLEAR {
        "as radians it would count the other way round".into()
    } else {
        let gyro = equal_turning(samples);
        from_degrees(samples, Channel::Heading, &evidence);
        if let Some(r) = gyro {
            let text = format!("heading turns alike (correlation {r:.2}), which is in degrees");
            from_degrees(samples, Channel::YawRate, &text);
        }
        return;
    };
    let text = format!("may be degrees: {evidence}, {otherwise}; left as it is");
    let heading = Channel::Heading;
    samples.note(
        NoteKind::Suspicion,
        Some(heading),
        samples.all(heading),
        text,
    );
}

/// Correlation of heading and yaw rate, if they turn equally fast.
fn equal_turning(samples: &RawSamples) -> Option<f64> {
    let (r, slope) = compare(samples, STEP, heading, gyro)?.strongest();
    (r.abs() >= STRONG && near(slope.abs(), 1.0)).then_some(r)
}

/// Whether a ratio is that of the units.
fn near(ratio: f64, unit: f64) -> bool {
    (ratio / unit).max(unit / ratio) < NEAR
}

/// Notes wheel speeds that match the motion of the vehicle in another unit, and related ones beyond the limit. Their size
/// does not distinguish a unit from a gear, or from wheels that slip: they are left as they are.
fn wheel_unit(samples: &mut RawSamples, vehicle: Option<&Vehicle>) {
    if let Some(text) = wheel_finding(samples, vehicle) {
        wheel_note(samples, NoteKind::Suspicion, 1.0, text);
    }
}

/// The note's text.
fn wheel_finding(samples: &RawSamples, vehicle: Option<&Vehicle>) -> Option<String> {
    let beyond = |side: Channel| {
        samples
            .of(side)
            .any(|sample| sample.value.abs() > limit(side))
    };
    let often = |side: Channel| {
        let beyond = samples.of(side).filter(|s| s.value.abs() > limit(side));
        beyond.count() as f64 > OFTEN * samples.all(side).count as f64
    };
    let radius = vehicle?.wheel_radius;
    let found = compare(samples, STEP, travel_ahead, wheel_mean)?;
    let (correlation, slope) = found.strongest();
    if correlation < STRONG {
        return None;
    }
    let units = [
        ("degrees per second", DEGREES, "deg/s"),
        ("rpm", 30.0 / PI, "rpm"),
    ];
    let fits = |unit: &(&str, f64, &str)| {
        let effective = found.ratios().map(|ratio| ratio * unit.1 / radius);
        effective.iter().all(|ratio| EFFECTIVE.contains(ratio))
    };
    let unit = units.into_iter().find(fits);
    let evidence = format!(
        "as rad/s the vehicle would move at {:.3} of the rims' speed (correlation {correlation:.2})",
        slope / radius
    );
    match (unit, SIDES.into_iter().any(beyond)) {
        (Some((name, ..)), false) => Some(format!(
            "both wheel speeds may be {name}: {evidence}; left as they are"
        )),
        // Spikes are dropped later.
        (None, true) if !SIDES.into_iter().any(often) => None,
        (unit, true) => {
            let (name, short) =
                unit.map_or(("another unit", "deg/s"), |(name, _, short)| (name, short));
            Some(format!(
                "both wheel speeds may be {name}, or of motors in front of a gear: {evidence}; left as they are \
                 (--column omega_left=NAME:{short} names a unit; divide by the ratio of a gear)"
            ))
        }
        (None, false) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::about::About;
    use crate::recording::reading::parse_recording;
    use crate::recording::reading::test_drive::{
        Rows, assert_restored, drive, kinds, read, text, turning, with,
    };
    use std::f64::consts::{FRAC_PI_2, TAU};

    /// 40 s straight on in this direction \[rad\], as its heading wavers by half a degree.
    fn straight(direction: f64) -> Rows {
        let row = |index: usize| {
            let time = 0.05 * index as f64;
            let heading = direction + 0.5f64.to_radians() * (1.3 * time).sin();
            let way = 0.9 * time;
            let values = [
                4.0,
                4.0,
                way * direction.cos(),
                way * direction.sin(),
                heading,
                0.0,
            ];
            (time, values)
        };
        (0..800).map(row).collect()
    }

    #[test]
    fn degrees_of_a_drive_straight_on_are_seen_by_its_course() {
        let heading = Some(Channel::Heading);
        for direction in [0.5 * PI, -0.9 * PI] {
            let good = straight(direction);
            let degrees = with(&good, |_, v| v[4] = v[4].to_degrees());
            assert_restored(&good, &degrees, &[(NoteKind::Unit, heading)]);
            // In reverse as well.
            let degrees = with(&good, |_, v| {
                [v[0], v[1]] = [-v[0], -v[1]];
                v[4] = (v[4] - direction.signum() * PI).to_degrees();
            });
            assert_eq!(read(&degrees).unwrap().notes[0].kind, NoteKind::Unit);
        }
        // Steadier than a sensor: another zero of a heading in radians might look the same.
        let steady = with(&straight(0.5 * PI), |_, v| v[4] = 90.0);
        let notes = read(&steady).unwrap().notes;
        assert_eq!(
            (notes[0].kind, notes[0].channel),
            (NoteKind::Suspicion, heading),
            "{notes:?}"
        );
        assert!(notes[0].text.contains("may be degrees"), "{notes:?}");
        // A gyro that turns equally fast is in degrees as well; one in radians is not changed.
        let unit = |channel| (NoteKind::Unit, Some(channel));
        let good = with_rate(straight(0.5 * PI));
        let degrees = with(&good, |_, v| {
            (v[4], v[5]) = (v[4].to_degrees(), v[5].to_degrees())
        });
        let both = [unit(Channel::Heading), unit(Channel::YawRate)];
        assert_restored(&good, &degrees, &both);
        let degrees = with(&good, |_, v| v[4] = v[4].to_degrees());
        assert_restored(&good, &degrees, &both[..1]);
        // Radians beyond a turn, and from another zero.
        for offset in [3.0 * TAU, 3.0 * TAU + 1.0] {
            let good = with(&straight(0.5 * PI), |_, v| v[4] += offset);
            assert!(read(&good).unwrap().notes.is_empty());
        }
    }

    /// Rows whose gyro shows how the heading wavers.
    fn with_rate(rows: Rows) -> Rows {
        let rate = |time: f64| 0.5f64.to_radians() * 1.3 * (1.3 * time).cos();
        let row = |(time, v): (f64, [f64; 6])| (time, [v[0], v[1], v[2], v[3], v[4], rate(time)]);
        rows.into_iter().map(row).collect()
    }

    #[test]
    fn radians_that_count_clockwise_are_no_degrees() {
        // Clockwise from north, beyond a turn; as degrees it would also agree with the course.
        let (mut x, mut y) = (0.0, 0.0);
        let row = |index: usize| {
            let time = 0.05 * index as f64;
            let heading = 7.72 + 0.3 * (0.3 * time).sin();
            x += 0.045 * (FRAC_PI_2 - heading).cos();
            y += 0.045 * (FRAC_PI_2 - heading).sin();
            let rate = 0.09 * (0.3 * time).cos();
            (time, [4.0, 4.0, x, y, heading, rate])
        };
        let rows: Rows = (0..1600).map(row).collect();
        let recording = read(&text(&rows)).unwrap();
        let is_unit = |note: &Note| note.kind == NoteKind::Unit;
        assert!(
            !recording.notes.iter().any(is_unit),
            "{:?}",
            recording.notes
        );
    }

    #[test]
    fn units_of_angles_are_seen() {
        let good = drive(60.0, 2);
        let unit = |channel| (NoteKind::Unit, Some(channel));
        let bad = with(&good, |_, v| v[4] = v[4].to_degrees());
        assert_restored(&good, &bad, &[unit(Channel::Heading)]);
        let bad = with(&good, |_, v| v[5] = v[5].to_degrees());
        assert_restored(&good, &bad, &[unit(Channel::YawRate)]);
        let bad = with(&good, |_, v| {
            [v[4], v[5]] = [v[4].to_degrees(), v[5].to_degrees()]
        });
        assert_restored(
            &good,
            &bad,
            &[unit(Channel::Heading), unit(Channel::YawRate)],
        );
        let unwrapped = (NoteKind::Unwrapped, Some(Channel::Heading));
        let bad = with(&good, |_, v| v[4] = (v[4] + PI).rem_euclid(TAU) - PI);
        assert_restored(&good, &bad, &[unwrapped]);
        let bad = with(&good, |_, v| v[4] = v[4].to_degrees().rem_euclid(360.0));
        assert_restored(&good, &bad, &[unit(Channel::Heading), unwrapped]);
        // A number that stands for a missing one hides neither.
        let outlier = (NoteKind::Outlier, Some(Channel::Heading));
        for missing in [-999.0, 9999.0] {
            let never = |t: f64, value: f64| {
                if t == 0.0 || t == 30.0 {
                    missing
                } else {
                    value
                }
            };
            let bad = with(&good, |t, v| {
                v[4] = never(*t, (v[4] + PI).rem_euclid(TAU) - PI)
            });
            assert_restored(&good, &bad, &[outlier, unwrapped]);
            let bad = with(&good, |t, v| {
                v[4] = never(*t, v[4].to_degrees().rem_euclid(360.0))
            });
            assert_restored(&good, &bad, &[outlier, unit(Channel::Heading), unwrapped]);
        }
        // Nor does one outside the turn that holds the others.
        for missing in [-99.0, 10.0, 99.0] {
            let bad = with(&good, |t, v| {
                let wrapped = (v[4] + PI).rem_euclid(TAU) - PI;
                v[4] = if *t == 30.0 { missing } else { wrapped };
            });
            assert_restored(&good, &bad, &[outlier, unwrapped]);
        }
        let bad = with(&good, |t, v| {
            let wrapped = v[4].to_degrees().rem_euclid(360.0);
            v[4] = if *t == 30.0 { -100.0 } else { wrapped };
        });
        assert_restored(&good, &bad, &[outlier, unit(Channel::Heading), unwrapped]);
        // 90 less a compass, and a compass with its declination.
        let unit_and_more = [unit(Channel::Heading), unwrapped];
        let bad = with(&good, |_, v| {
            v[4] = (v[4].to_degrees() + 270.0).rem_euclid(360.0) - 270.0
        });
        assert_restored(&good, &bad, &unit_and_more);
        // Two antennas swapped once.
        let bad = with(&good, |t, v| {
            let turned = if *t == 30.0 { 180.0 } else { 0.0 };
            v[4] = (v[4].to_degrees() + turned).rem_euclid(360.0);
        });
        let notes = read(&bad).unwrap().notes;
        let is_unit = |note: &Note| (note.kind, note.channel) == unit(Channel::Heading);
        assert!(notes.iter().any(is_unit), "{notes:?}");
    }

    #[test]
    fn impossible_wheel_speeds_are_doubted_or_refused() {
        let good = drive(60.0, 3);
        // Degrees per second and the speed of a motor in front of a gear differ in size alone.
        for factor in [DEGREES, 48.0, 40.0] {
            let bad = with(&good, |_, v| [v[0], v[1]] = [factor * v[0], factor * v[1]]);
            let recording = read(&bad).unwrap();
            let notes = &recording.notes;
            assert_eq!(kinds(notes), [NoteKind::Suspicion], "{factor}: {notes:?}");
            for expected in ["in front of a gear", "left as they are", ":deg/s"] {
                assert!(notes[0].text.contains(expected), "{factor}: {notes:?}");
            }
            let left = recording.runs[0].series(Channel::OmegaLeft).unwrap();
            let speed = left.at(good[600].0).unwrap();
            assert!(
                (speed / (factor * good[600].1[0]) - 1.0).abs() < 1e-3,
                "{factor}"
            );
        }
        // Revolutions per minute that might be rad/s are noted.
        let bad = with(&good, |_, v| {
            [v[0], v[1]] = [v[0], v[1]].map(|speed| speed * 30.0 / PI)
        });
        let notes = read(&bad).unwrap().notes;
        assert_eq!(kinds(&notes), [NoteKind::Suspicion], "{notes:?}");
        assert!(notes[0].text.contains("may be rpm"), "{notes:?}");
        // Rim speeds in metres per second of a narrow vehicle: it turns by 3.3 per metre that the rims differ.
        let narrow = turning(60.0, 3, 1.0);
        let bad = with(&narrow, |_, v| [v[0], v[1]] = [0.3 * v[0], 0.3 * v[1]]);
        assert_restored(&narrow, &bad, &[(NoteKind::Unit, Some(Channel::OmegaLeft))]);
        let recording = parse_recording(
            "drive.csv",
            "drive",
            bad.as_bytes(),
            About::default(),
            None,
            &[],
        );
        let notes = recording.unwrap().notes;
        assert_eq!(kinds(&notes), [NoteKind::Suspicion], "{notes:?}");
        assert!(
            notes[0].text.contains("may be rim speeds in m/s"),
            "{notes:?}"
        );
        // A vehicle from the caller, not from the metadata.
        let vehicle = Vehicle {
            wheel_radius: 0.3,
            ..Vehicle::tran2007()
        };
        let about = About::default();
        let recording = parse_recording(
            "drive.csv",
            "drive",
            bad.as_bytes(),
            about,
            Some(&vehicle),
            &[],
        );
        assert_eq!(kinds(&recording.unwrap().notes), [NoteKind::Unit]);
        // A spike is dropped.
        let bad = with(&good, |t, v| v[1] = if *t == 20.0 { 400.0 } else { v[1] });
        assert_restored(
            &good,
            &bad,
            &[(NoteKind::Outlier, Some(Channel::OmegaRight))],
        );
        let bad = parse_recording(
            "drive.csv",
            "drive",
            with(&good, |_, v| [v[0], v[1]] = [40.0 * v[0], 40.0 * v[1]]).as_bytes(),
            About::default(),
            None,
            &[],
        );
        let error = bad.unwrap_err().to_string();
        assert!(
            error.contains("(omega_") && error.contains("rpm or degrees per second"),
            "{error}"
        );
        let bad = with(&good, |t, v| v[1] = if *t > 20.0 { 400.0 } else { v[1] });
        let error = read(&bad).unwrap_err().to_string();
        let expected =
            "line 403, column 3 (omega_right): found 400, expected a value within 200 rad/s";
        assert!(error.contains(expected), "{error}");
    }
}
