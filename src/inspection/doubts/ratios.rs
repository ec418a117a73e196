//! Factors between sensors of one motion.

use super::doubt::{Doubt, DoubtKind, logistic};
use super::expected::{CLOSE_LIKELIHOOD, Expectation, Explained, Measured, Scaled};
use super::pairs::{Pairs, Ratio};
use crate::inspection::signals::MotionSignal;
use crate::recording::{Channel, Recording, range};
use crate::vehicle::Vehicle;
use std::f64::consts::{PI, TAU};

/// A heading and a yaw rate that are proportional leave less unexplained.
const PROPORTIONAL: f64 = 0.15;
/// Gyros and headings agree within this factor; width of the transition in its logarithm.
const SCALE: f64 = 1.1;
const SCALE_WIDTH: f64 = 0.02;
/// Factors within this one are left to the fit: worn tyres, the model's own errors.
const NEAR: f64 = 1.25;
/// Width of the transition in its logarithm.
const NEAR_WIDTH: f64 = 0.03;
/// A factor explains what a sensor measured if the error, as a share of the motion, is below this.
const EXPLAINED: f64 = 0.2;
/// Errors of a poor sensor within this factor are the same.
const WORSE: f64 = 1.1;
/// Log prior odds of a wrong factor. They are low, as what the model lacks may look like a factor for a while.
const PRIOR: f64 = -5.0;
/// Largest factor between a number and that of a unit, and between the numbers on two soils that are reported as one.
const UNIT: f64 = 1.08;
/// On some soil a vehicle turns so many times as fast as on another with the same wheel speeds. Units within this factor of
/// the best number are compared with it.
const SOILS: f64 = 2.0;
/// Weaker correlations show no relation between wheels and motion.
const RELATED: f64 = 0.6;

/// Units of a position that are no metres: how many of each are one.
const POSITION_UNITS: [(&str, f64); 5] = [
    ("mm", 1000.0),
    ("cm", 100.0),
    ("in", 39.370_078_740_157_48),
    ("ft", 3.280_839_895_013_123),
    ("km", 0.001),
];
/// What a vehicle covers of the way that its wheels roll, and of the turn, where the units are right: dry sand takes four
/// tenths of the way, and clay nine tenths of the turn.
const ROLLS: std::ops::RangeInclusive<f64> = 0.6..=1.15;
const TURNS: std::ops::RangeInclusive<f64> = 0.1..=1.2;
const IMPOSSIBLE: f64 = 0.97;

/// Heading and yaw rate of different size.
pub fn heading(recording: &Recording) -> Option<Doubt> {
    let pairs = Pairs::of(
        &recording.runs,
        MotionSignal::Heading,
        MotionSignal::YawRate,
    )?;
    let ratio = pairs.ratio()?;
    if ratio.unexplained > PROPORTIONAL || ratio.value <= 0.0 {
        return None;
    }
    let excess = ratio.value.ln().abs() - SCALE.ln();
    let probability = logistic(excess / SCALE_WIDTH);
    Some(Doubt {
        kind: DoubtKind::HeadingFactor,
        channels: vec![Channel::Heading, Channel::YawRate],
        span: None,
        probability,
        left_out: Vec::new(),
        evidence: format!(
            "heading turns {:.2} times as far as yaw_rate says, at a correlation of {:.2}",
            ratio.value, ratio.correlation
        ),
        remedy: format!(
            "Check the scale of the gyro, the unit of time ({:.2} s a second would fit) and the source of the heading",
            1.0 / ratio.value
        ),
    })
}

/// A position in another unit: the vehicle gets much farther, or less far, than its wheels roll, while it turns as they say.
pub fn position(recording: &Recording, vehicle: &Vehicle) -> Option<Doubt> {
    let ratio = |signal, wheels| {
        let ratio = Pairs::of(&recording.runs, signal, wheels)?.ratio()?;
        (ratio.correlation >= RELATED).then_some(ratio.value)
    };
    let ahead = ratio(MotionSignal::Distance, MotionSignal::WheelMean)? / vehicle.wheel_radius;
    let by_track = 2.0 * vehicle.half_track / vehicle.wheel_radius;
    let turn = [MotionSignal::YawRate, MotionSignal::Heading];
    let mut turns = turn.into_iter().filter_map(|signal| {
        let turn = by_track * ratio(signal, MotionSignal::WheelDifference)?;
        TURNS.contains(&turn).then_some(turn)
    });
    let turn = turns.next()?;
    let decimals = (2.0 - ahead.log10().floor()).max(0.0) as usize;
    let is = |(_, factor): &&(&str, f64)| ROLLS.contains(&(ahead / factor));
    let (unit, _) = POSITION_UNITS.iter().find(is)?;
    Some(Doubt {
        kind: DoubtKind::PositionUnit,
        channels: vec![Channel::X, Channel::Y],
        span: None,
        probability: IMPOSSIBLE,
        left_out: Vec::new(),
        evidence: format!(
            "x and y move by {ahead:.decimals$} for each metre that the wheels roll, though the vehicle turns at {turn:.2} of the rate without \
             slip"
        ),
        remedy: format!(
            "They look like {unit}: give them in metres, or name the columns x_{unit} and y_{unit}"
        ),
    })
}

/// Wheel speeds, or a track, that fit the motion on no soil. `is_own` says that the pose is of the wheels, so that only
/// the gyro is a witness.
pub fn wheels(
    recording: &Recording,
    vehicle: &Vehicle,
    is_own: bool,
    is_over: &(dyn Fn() -> bool + Sync),
) -> Option<Doubt> {
    let runs = &recording.runs;
    let speeds: &[MotionSignal] = if is_own {
        &[]
    } else {
        &[MotionSignal::Distance, MotionSignal::Velocity]
    };
    let turns: &[MotionSignal] = if is_own {
        &[MotionSignal::YawRate]
    } else {
        &[MotionSignal::YawRate, MotionSignal::Heading]
    };
    let of = |signals: &[MotionSignal], wheels| {
        signals.iter().find_map(|signal| {
            let pairs = Pairs::of(runs, *signal, wheels)?;
            let ratio = pairs.ratio()?;
            let is_related = ratio.correlation >= RELATED || ratio.scatter <= 1.0 - RELATED;
            is_related.then_some((*signal, pairs.delay, ratio))
        })
    };
    let ahead = of(speeds, MotionSignal::WheelMean);
    let turn = of(turns, MotionSignal::WheelDifference);
    let by_radius = 1.0 / vehicle.wheel_radius;
    let by_track = 2.0 * vehicle.half_track / vehicle.wheel_radius;
    let measured = Measured {
        signals: [&ahead, &turn].map(|found| {
            let signal = |run| found.as_ref().and_then(|(signal, ..)| signal.of(run));
            runs.iter().map(signal).collect()
        }),
        delays: [&ahead, &turn].map(|found| found.as_ref().map_or(0.0, |found| found.1)),
        ratios: [
            ahead.map(|found| found.2.value * by_radius),
            turn.map(|found| found.2.value * by_track),
        ],
    };
    if measured.ratios.iter().all(Option::is_none) {
        return None;
    }
    let expectation = Expectation::new(runs, vehicle, &measured, is_over)?;
    // A few drives show that most recordings need no factor.
    let wheels = expectation.begin(Scaled::Wheels);
    let track = expectation.begin(Scaled::Track);
    if wheels.is_none() && track.is_none() {
        return None;
    }
    let given = expectation.begin(Scaled::Nothing);
    let given = given.map(|start| expectation.explain(&start));
    if given.as_ref().is_some_and(Explained::is_expected) {
        return None;
    }
    let wheels = wheels.map(|start| in_unit(expectation.explain(&start), &expectation, vehicle));
    let track = track.map(|start| expectation.explain(&start));
    let likelihood = given.map_or(f64::NEG_INFINITY, |given| given.likelihood);
    let errors = given.map_or([None; 2], |given| given.errors);
    let judged = [(Scaled::Wheels, wheels), (Scaled::Track, track)];
    let judged = judged.into_iter().filter_map(|(scaled, found)| {
        let found = found?;
        let size = logistic((found.factor.ln().abs() - NEAR.ln()) / NEAR_WIDTH);
        let is_explained = is_explained(found.errors, errors);
        let odds = found.likelihood - likelihood + PRIOR;
        let probability = if is_explained {
            size * logistic(odds)
        } else {
            0.0
        };
        Some((scaled, found, probability))
    });
    let judged: Vec<(Scaled, Explained, f64)> = judged.collect();
    // An unfinished comparison shows nothing.
    if is_over() {
        return None;
    }
    let best = judged.iter().max_by(|a, b| a.2.total_cmp(&b.2))?;
    let is_close = |one: &&(Scaled, Explained, f64)| {
        one.0 != best.0 && one.1.likelihood > best.1.likelihood - CLOSE_LIKELIHOOD && one.2 > 0.2
    };
    let other = judged.iter().find(is_close);
    let ratios = Ratios {
        ahead: ahead.map(|found| (found.2, by_radius)),
        turn: turn.map(|found| (found.2, by_track)),
    };
    Some(doubt(best, other, &ratios, vehicle))
}

/// Whether a factor explains the motion: one sensor nearly whole, and none clearly worse than without it. A poor one, as a
/// matched pose of a vehicle that turns on the spot, is explained by nothing.
fn is_explained(errors: [Option<f64>; 2], without: [Option<f64>; 2]) -> bool {
    let mut pairs = errors.into_iter().zip(without);
    errors.iter().flatten().any(|error| *error <= EXPLAINED)
        && pairs.all(|(error, without)| {
            let bearable = (WORSE * without.unwrap_or(f64::INFINITY)).max(EXPLAINED);
            error.is_none_or(|error| error <= bearable)
        })
}

/// Names of units of wheel speeds, the commonest first, with the factors that make them rad/s.
fn units(vehicle: &Vehicle) -> [(&'static str, f64); 4] {
    [
        ("m/s of the rim", 1.0 / vehicle.wheel_radius),
        ("rpm", PI / 30.0),
        ("degrees per second", PI / 180.0),
        ("turns per second", TAU),
    ]
}

/// The factor of a unit, if it explains the motion as well as the best number: a wrong unit is likelier than a number without
/// a meaning, and a gyro alone shows the factor only as exactly as the soil is known.
fn in_unit(free: Explained, expectation: &Expectation, vehicle: &Vehicle) -> Explained {
    let near = units(vehicle).map(|(_, unit)| unit).into_iter();
    let near = near.filter(|unit| (free.factor / unit).ln().abs() < SOILS.ln());
    let starts = near.filter_map(|unit| expectation.begin_at(unit));
    let mut found = starts.map(|start| expectation.explain(&start));
    let Some(unit) = found.find(|unit| unit.likelihood > free.likelihood - CLOSE_LIKELIHOOD) else {
        return free;
    };
    Explained {
        factors: range([unit.factors, free.factors].into_iter().flatten()),
        ..unit
    }
}

/// Measured ratios of motion to wheels, with the factors that make them 1 without slip.
struct Ratios {
    ahead: Option<(Ratio, f64)>,
    turn: Option<(Ratio, f64)>,
}

fn doubt(
    (scaled, found, probability): &(Scaled, Explained, f64),
    other: Option<&(Scaled, Explained, f64)>,
    ratios: &Ratios,
    vehicle: &Vehicle,
) -> Doubt {
    let ahead = ratios.ahead.map(|(ratio, unit)| {
        format!(
            "the vehicle covers {:.2} of what its wheels roll, at a correlation of {:.2}",
            ratio.value * unit,
            ratio.correlation
        )
    });
    let turn = ratios.turn.map(|(ratio, unit)| {
        format!(
            "it turns at {:.2} of the rate without slip, at a correlation of {:.2}",
            ratio.value * unit,
            ratio.correlation
        )
    });
    let facts: Vec<String> = [ahead, turn].into_iter().flatten().collect();
    let evidence = format!(
        "{}: on no soil does the given vehicle move like that",
        facts.join(", and ")
    );
    let mut remedies = vec![remedy(*scaled, found, vehicle)];
    remedies.extend(other.map(|other| remedy(other.0, &other.1, vehicle)));
    Doubt {
        kind: if *scaled == Scaled::Track {
            DoubtKind::TurningRatio
        } else {
            DoubtKind::RollingRatio
        },
        channels: vec![Channel::OmegaLeft, Channel::OmegaRight],
        span: None,
        probability: *probability,
        left_out: Vec::new(),
        evidence,
        remedy: remedies.join(", or "),
    }
}

/// What a factor would mean.
fn remedy(scaled: Scaled, found: &Explained, vehicle: &Vehicle) -> String {
    let factor = found.factor;
    let [low, high] = found.factors;
    let is_wide = high > low * UNIT;
    if scaled == Scaled::Track {
        let half_track = vehicle.half_track;
        let others = format!(
            " ({:.2} to {:.2} m on other soils)",
            low * half_track,
            high * half_track
        );
        return format!(
            "Check the track: half_track = {:.2} m would fit{}, not {half_track} m",
            factor * half_track,
            if is_wide { &others[..] } else { "" }
        );
    }
    let others = format!(" ({low:.2} to {high:.2} on other soils)");
    let others = if is_wide { &others[..] } else { "" };
    let near = units(vehicle).into_iter();
    let near = near.filter(|(_, unit)| (factor / unit).ln().abs() < UNIT.ln());
    let near: Vec<&str> = near.map(|(name, _)| name).collect();
    let reason = if near.is_empty() {
        format!(
            "or wheel_radius = {:.3} m, not {} m",
            factor * vehicle.wheel_radius,
            vehicle.wheel_radius
        )
    } else {
        format!("as if they were in {}", near.join(" or "))
    };
    format!(
        "Check wheel radius, gear ratio, ticks per turn and unit: wheel speeds {factor:.2} times as large would fit{others}, \
         {reason}"
    )
}
