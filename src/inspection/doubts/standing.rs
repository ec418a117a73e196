//! Sensors that show no motion at all while others show that the vehicle moves: dead encoders, a dead gyro, a pose that
//! stays where it is.
//!
//! Unlike a frozen channel these need not be alive elsewhere: the other sensors contradict them.

use super::doubt::{Doubt, DoubtKind, Span};
use crate::recording::{Channel, Recording, Run, Series};

/// Shortest stretch \[s\] without any motion.
const LONG: f64 = 1.5;
/// Wheels that stand cannot be those of a vehicle that gets so far meanwhile \[m\], and farther than on a radius of this \[m\]:
/// with a locked side it turns about that, a half track from its middle.
const FAR: f64 = 2.0;
const STRAIGHT: f64 = 2.0;
/// In windows of this length \[s\] too: over a whole drive every vehicle turns.
const PART: f64 = 5.0;
/// A gyro at rest contradicts a heading that turns by so much meanwhile \[rad\].
const TURNED: f64 = 0.5;
/// Wheels that roll so far ahead on average \[rad\] move every vehicle by more than this \[m\] for each radian, a thousandth of
/// a small wheel's radius: vehicles that are stuck shake more.
const ROLLED: f64 = 50.0;
const LEAST: f64 = 3e-5;
const PROBABILITY: f64 = 0.95;

/// Doubts about sensors that stand still.
pub fn doubts(recording: &Recording) -> Vec<Doubt> {
    let runs = recording.runs.iter().enumerate();
    let mut found = Vec::new();
    for (index, run) in runs {
        found.extend(wheels(index, run));
        found.extend(gyro(index, run));
        found.extend(pose(index, run));
    }
    found
}

/// The longest stretch in which a channel is exactly zero.
fn zero(series: &Series) -> Option<[f64; 2]> {
    let mut longest: Option<[f64; 2]> = None;
    let mut start = None;
    for (time, value) in series.samples() {
        start = (value == 0.0).then(|| start.unwrap_or(time));
        let length = |[from, to]: [f64; 2]| to - from;
        if let Some(from) = start
            && longest.is_none_or(|other| time - from > length(other))
        {
            longest = Some([from, time]);
        }
    }
    longest.filter(|[from, to]| to - from >= LONG)
}

/// The values of a channel between two times.
fn within(run: &Run, channel: Channel, [from, to]: [f64; 2]) -> Vec<f64> {
    let series = run.series(channel).into_iter();
    let samples = series.flat_map(Series::samples);
    let inside = samples.filter(|(time, _)| (from..=to).contains(time));
    inside.map(|(_, value)| value).collect()
}

/// How far the position gets from where it is first \[m\].
fn distance(run: &Run, span: [f64; 2]) -> f64 {
    let [x, y] = [Channel::X, Channel::Y].map(|channel| within(run, channel, span));
    let from_start = x.iter().zip(&y).map(|(a, b)| (a - x[0]).hypot(b - y[0]));
    from_start.fold(0.0, f64::max)
}

/// Between which angles the heading lies \[rad\].
fn turned(run: &Run, span: [f64; 2]) -> Option<f64> {
    let heading = within(run, Channel::Heading, span);
    let low = heading.iter().copied().fold(f64::INFINITY, f64::min);
    let high = heading.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (!heading.is_empty()).then_some(high - low)
}

fn doubt(index: usize, channels: Vec<Channel>, span: [f64; 2], evidence: String) -> Doubt {
    let [start, end] = span;
    Doubt {
        kind: DoubtKind::Frozen,
        channels,
        span: Some(Span {
            run: index,
            start,
            end,
        }),
        probability: PROBABILITY,
        left_out: Vec::new(),
        evidence,
        remedy: "Check the sensor, its bus and its driver; leave this part of the recording, or this column, out".into(),
    }
}

/// Whether wheels never turn: then there is nothing to diagnose, whatever the pose does.
pub fn never_turn(run: &Run) -> bool {
    let sides = [Channel::OmegaLeft, Channel::OmegaRight].into_iter();
    let mut speeds = sides
        .filter_map(|side| run.series(side))
        .flat_map(|series| series.value.iter());
    speeds.all(|speed| *speed == 0.0)
}

/// Wheels that are exactly at rest while the vehicle drives on.
fn wheels(index: usize, run: &Run) -> Vec<Doubt> {
    if never_turn(run) {
        return Vec::new();
    }
    let sides = [Channel::OmegaLeft, Channel::OmegaRight].into_iter();
    let found = sides.filter_map(|channel| {
        let [start, end] = zero(run.series(channel)?)?;
        let parts = ((end - start) / PART).ceil().max(1.0);
        let length = (end - start) / parts;
        let part = |k: usize| [start + length * k as f64, start + length * (k + 1) as f64];
        let whole = std::iter::once([start, end]);
        whole.chain((0..parts as usize).map(part)).find_map(|span| {
            let (far, turned) = (distance(run, span), turned(run, span)?);
            let goes_on = far > FAR && far > STRAIGHT * turned;
            goes_on.then(|| {
                let evidence = format!(
                    "{channel} is exactly 0 from {start:.1} to {end:.1} s, though the position moves by {far:.1} m from \
                     {:.1} to {:.1} s and turns by {:.0} deg only",
                    span[0],
                    span[1],
                    turned.to_degrees()
                );
                doubt(index, vec![channel], [start, end], evidence)
            })
        })
    });
    found.collect()
}

/// A gyro that is exactly at rest while the heading turns.
fn gyro(index: usize, run: &Run) -> Option<Doubt> {
    let span = zero(run.series(Channel::YawRate)?)?;
    let turned = turned(run, span).filter(|turned| *turned > TURNED)?;
    let [from, to] = span;
    let evidence = format!(
        "yaw_rate is exactly 0 from {from:.1} to {to:.1} s, though heading turns by {:.0} deg",
        turned.to_degrees()
    );
    Some(doubt(index, vec![Channel::YawRate], span, evidence))
}

/// A position that hardly changes while the wheels roll ahead.
fn pose(index: usize, run: &Run) -> Option<Doubt> {
    let [left, right] = [
        run.series(Channel::OmegaLeft)?,
        run.series(Channel::OmegaRight)?,
    ];
    let span = [*left.time.first()?, *left.time.last()?];
    let rolled = |series: &Series| {
        let pairs = series.time.windows(2).zip(series.value.windows(2));
        pairs
            .map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0]))
            .sum::<f64>()
    };
    let ahead = (0.5 * (rolled(left) + rolled(right))).abs();
    let far = distance(run, span);
    let stays = run.series(Channel::X).is_some() && ahead > ROLLED && far < LEAST * ahead;
    stays.then(|| {
        let evidence = format!(
            "x and y move by {far:.2e} m at most, though the wheels roll ahead by {ahead:.0} rad on average"
        );
        let mut doubt = doubt(index, vec![Channel::X, Channel::Y], span, evidence);
        doubt.remedy = "Give x and y in metres, not in degrees of latitude and longitude; or the position was not \
                        updated"
            .into();
        doubt
    })
}
