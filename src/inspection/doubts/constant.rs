//! Channels that repeat one value, are cut off or have coarse steps, though they were alive.

use super::doubt::{Doubt, DoubtKind, Span};
use super::sides::by_sides;
use crate::inspection::signals::MotionSignal;
use crate::recording::{BySides, Channel, Recording, Run, Series, longest_interval};

/// Minimum duration and number of samples of a frozen stretch \[s\]. Shorter ones are interpolated like a gap.
const LONG: f64 = 1.5;
const MANY: usize = 10;
/// Minimum number of samples elsewhere, and maximum share of repeated values among them.
const ALIVE_SAMPLES: usize = 40;
const ALIVE: f64 = 0.15;
/// Minimum share of changes back and forth of a channel with noise.
const NOISY: f64 = 0.1;
/// Turns that the wheels leave unexplained in a stretch, as a multiple of those elsewhere, for a speed that is not true. With
/// a side frozen in five real drives most stretches have 13 to 60, on the poorest pose 3 to 8; constant speeds of simulated
/// drives without noise have 1.3 at most.
const CONTRADICTED: f64 = 5.0;
/// Probability by chance of as many repeats below which the stretch of a channel with noise is no coincidence.
const CHANCE: f64 = 1e-9;
/// Faster wheels or yaw rates show that the vehicle moves \[rad/s\].
const MOVING: f64 = 0.2;
const TURNING: f64 = 0.05;
/// Share of samples at the largest or smallest value, in stretches of so many, that shows a limit.
const CUT_SHARE: f64 = 0.03;
const CUT_RUN: usize = 3;
/// Steps as a share of the standard deviation that hide the motion, and the most values that a lattice may have.
const COARSE: f64 = 0.25;
const FEW_VALUES: usize = 40;

/// A stretch of one value.
struct Held {
    run: usize,
    value: f64,
    /// First and last time \[s\].
    span: [f64; 2],
    /// Samples that repeat the one before. The first may be a measurement; the last is followed by another value.
    repeats: usize,
}

/// Stretches in which a channel repeats one value exactly while the vehicle moves and the channel changes elsewhere.
pub fn frozen(recording: &Recording) -> Vec<Doubt> {
    let channels = Channel::ALL.into_iter();
    channels
        .filter_map(|channel| frozen_doubt(channel, &held(recording, channel)))
        .collect()
}

/// The stretches of a channel.
///
/// # Algorithm
/// 1. Long stretches of one value, and the share of repeats elsewhere. Exact zeros are no evidence: a locked wheel reads
///    nothing, and so does a vehicle at rest.
/// 2. A channel with noise is alive if it hardly repeats a value elsewhere. Its stretches must be longer than chance makes them.
/// 3. Other channels must show that the vehicle moves.
/// 4. A constant wheel speed may be one: the turns must contradict what both sides add to them elsewhere. Where that is not
///    clear, channels that are alive keep their stretches.
fn held(recording: &Recording, channel: Channel) -> Vec<Held> {
    // 1.
    let (mut long, mut inside, mut short, mut count) = (Vec::new(), 0, 0, 0);
    for (run, one) in recording.runs.iter().enumerate() {
        let Some(series) = one.series(channel) else {
            continue;
        };
        count += series.len() - 1;
        for [from, to] in stretches(series) {
            let held = Held {
                run,
                value: series.value[from],
                span: [from, to].map(|k| series.time[k]),
                repeats: to - from,
            };
            let lasts = held.repeats >= MANY && held.span[1] - held.span[0] >= LONG;
            if held.value == 0.0 || lasts {
                inside += held.repeats;
            } else {
                short += held.repeats;
            }
            if held.value != 0.0 && lasts {
                long.push(held);
            }
        }
    }
    let elsewhere = count.saturating_sub(inside);
    if long.is_empty() || elsewhere < ALIVE_SAMPLES {
        return Vec::new();
    }
    // 2.
    let share = short as f64 / elsewhere as f64;
    let runs = recording.runs.iter();
    let is_alive =
        share <= ALIVE && noise_share(runs.filter_map(|run| run.series(channel))) >= NOISY;
    let by_chance = |held: &Held| {
        elsewhere as f64 * share.max(1.0 / elsewhere as f64).powi(held.repeats as i32)
    };
    // 3.
    long.retain(|held| {
        (!is_alive || by_chance(held) < CHANCE)
            && moves(&recording.runs[held.run], channel, held.span)
    });
    // 4.
    let is_wheel = channel.is_required() && !long.is_empty();
    let elsewhere = is_wheel.then(|| Elsewhere::of(recording, channel, &long));
    match elsewhere.flatten() {
        Some(elsewhere) => {
            long.retain(|held| elsewhere.is_contradicted(&recording.runs[held.run], held.span));
        }
        None if is_alive => {}
        None => long.clear(),
    }
    long
}

/// How the vehicle turns by its sides outside of stretches.
struct Elsewhere {
    turn: MotionSignal,
    by_sides: BySides,
}

impl Elsewhere {
    fn of(recording: &Recording, channel: Channel, held: &[Held]) -> Option<Self> {
        let rest = |(index, run): (usize, &Run)| {
            let spans = || held.iter().filter(|held| held.run == index);
            let is_outside = |(time, _): &(f64, f64)| {
                spans().all(
                    |Held {
                         span: [from, to], ..
                     }| time < from || time > to,
                )
            };
            let samples = run.series(channel)?.samples().filter(is_outside);
            Some(run.clone().with(channel, samples.collect()))
        };
        let rest: Vec<Run> = recording.runs.iter().enumerate().filter_map(rest).collect();
        let turns = [MotionSignal::Heading, MotionSignal::YawRate];
        turns.into_iter().find_map(|turn| {
            let by_sides = by_sides(&rest, turn)?;
            by_sides.is_clear().then_some(Self { turn, by_sides })
        })
    }

    /// Whether the turns in a stretch contradict the wheel speeds far more than elsewhere.
    fn is_contradicted(&self, run: &Run, span: [f64; 2]) -> bool {
        let signals = [
            self.turn,
            MotionSignal::LeftWheels,
            MotionSignal::RightWheels,
        ];
        let [Some(turn), Some(left), Some(right)] = signals.map(|signal| signal.of(run)) else {
            return false;
        };
        let residual = self.by_sides.residual_within(&[turn, left, right], span);
        residual.is_some_and(|inside| inside > CONTRADICTED * self.by_sides.residual)
    }
}

/// A doubt about stretches of one value each.
fn frozen_doubt(channel: Channel, held: &[Held]) -> Option<Doubt> {
    let length = |held: &Held| held.span[1] - held.span[0];
    let longest = held.iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let Held {
        value,
        span: [start, end],
        ..
    } = longest;
    let span = |held: &Held| Span {
        run: held.run,
        start: held.span[0],
        end: held.span[1],
    };
    let others = match held.len() - 1 {
        0 => String::new(),
        more => format!(" ({more} more such stretches)"),
    };
    Some(Doubt {
        kind: DoubtKind::Frozen,
        channels: vec![channel],
        span: Some(span(longest)),
        probability: 0.97,
        left_out: held.iter().map(span).collect(),
        evidence: format!(
            "{channel} is exactly {value} from {start:.1} to {end:.1} s{others}, though it changes from sample to sample \
             elsewhere and the vehicle moves"
        ),
        remedy: format!(
            "These samples of {channel} are left out; check the sensor, its bus and its driver"
        ),
    })
}

/// Share of the changes from sample to sample that go the other way than the one before: two thirds for white noise, none for
/// a smooth or computed course. Only noise shows that a constant value is no measurement.
fn noise_share<'a>(runs: impl Iterator<Item = &'a Series>) -> f64 {
    let (mut back, mut count) = (0, 0);
    for series in runs {
        let changes = series.value.windows(2).map(|pair| pair[1] - pair[0]);
        let changes: Vec<f64> = changes.filter(|change| *change != 0.0).collect();
        let turns = changes.windows(2).filter(|pair| pair[0] * pair[1] < 0.0);
        back += turns.count();
        count += changes.len();
    }
    back as f64 / count.max(1) as f64
}

/// Index of first and last sample of each stretch of equal values without a gap.
fn stretches(series: &Series) -> Vec<[usize; 2]> {
    let limit = longest_interval(series);
    let mut found: Vec<[usize; 2]> = Vec::new();
    for index in 1..series.len() {
        let is_same = series.value[index] == series.value[index - 1]
            && series.time[index] - series.time[index - 1] <= limit;
        match found.last_mut() {
            Some(last) if is_same && last[1] == index - 1 => last[1] = index,
            _ if is_same => found.push([index - 1, index]),
            _ => {}
        }
    }
    found
}

/// Whether other channels show motion, for most of the time.
fn moves(run: &Run, frozen: Channel, [start, end]: [f64; 2]) -> bool {
    let by = |channel: Channel, limit: f64| {
        if channel == frozen {
            return false;
        }
        let Some(series) = run.series(channel) else {
            return false;
        };
        let within = series.samples().filter(|(t, _)| (start..=end).contains(t));
        let values: Vec<f64> = within.map(|(_, value)| value).collect();
        let moving = values.iter().filter(|value| value.abs() > limit).count();
        2 * moving > values.len() && !values.is_empty()
    };
    by(Channel::OmegaLeft, MOVING)
        || by(Channel::OmegaRight, MOVING)
        || by(Channel::YawRate, TURNING)
        || by(Channel::VX, TURNING)
}

/// Channels that are cut off at their largest values, or have steps as coarse as the motion.
pub fn coarse(recording: &Recording) -> Vec<Doubt> {
    let channels = Channel::ALL.into_iter();
    channels
        .filter_map(|channel| {
            saturated(recording, channel).or_else(|| quantised(recording, channel))
        })
        .collect()
}

fn saturated(recording: &Recording, channel: Channel) -> Option<Doubt> {
    if matches!(channel, Channel::X | Channel::Y | Channel::Heading) {
        return None;
    }
    let runs = || recording.runs.iter().filter_map(|run| run.series(channel));
    let all = || runs().flat_map(|series| series.value.iter().copied());
    let count = all().count();
    let largest = all().map(f64::abs).fold(0.0, f64::max);
    let (mut cut, mut repeats) = (0, 0);
    for series in runs() {
        for [from, to] in stretches(series) {
            let length = to - from + 1;
            let at_limit = series.value[from].abs() == largest;
            if at_limit && length >= CUT_RUN {
                cut += length;
            } else {
                repeats += length - 1;
            }
        }
    }
    let share = cut as f64 / count.max(1) as f64;
    let is_noisy = noise_share(runs()) >= NOISY;
    let is_alive = is_noisy && (repeats as f64) < 0.3 * ALIVE * (count - cut) as f64;
    let is_cut = largest > 0.0 && share >= CUT_SHARE && count - cut >= ALIVE_SAMPLES;
    (is_cut && is_alive).then(|| Doubt {
        kind: DoubtKind::Saturated,
        channels: vec![channel],
        span: None,
        probability: 0.7,
        left_out: Vec::new(),
        evidence: format!(
            "{channel} stays at its largest magnitude of exactly {largest} {} for {:.0} % of its samples, though it \
             changes from sample to sample elsewhere",
            channel.unit(),
            100.0 * share
        ),
        remedy: "Check the range of the sensor or of its message: the true values may be larger".into(),
    })
}

fn quantised(recording: &Recording, channel: Channel) -> Option<Doubt> {
    let runs = recording.runs.iter().filter_map(|run| run.series(channel));
    let mut values: Vec<f64> = runs
        .flat_map(|series| series.value.iter().copied())
        .collect();
    let count = values.len() as f64;
    if values.len() < 5 * FEW_VALUES {
        return None;
    }
    let mean = values.iter().sum::<f64>() / count;
    let deviation = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
    let deviation = deviation.sqrt();
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.len() < 4 || values.len() > FEW_VALUES {
        return None;
    }
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let step = steps.fold(f64::INFINITY, f64::min);
    let is_lattice = values.iter().all(|value| {
        let place = (value - values[0]) / step;
        (place - place.round()).abs() < 1e-3
    });
    (is_lattice && step >= COARSE * deviation).then(|| Doubt {
        kind: DoubtKind::Quantised,
        channels: vec![channel],
        span: None,
        probability: 0.5,
        left_out: Vec::new(),
        evidence: format!(
            "{channel} takes only {} values, in steps of {step:.3} {}, which is {:.0} % of its standard deviation",
            values.len(),
            channel.unit(),
            100.0 * step / deviation
        ),
        remedy: "Record it with more digits, or over longer counting intervals: effects smaller than a step are not \
                 seen"
            .into(),
    })
}
