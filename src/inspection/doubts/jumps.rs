//! Positions and headings that jump further than the vehicle can move.

use super::doubt::{Doubt, DoubtKind, Span, logistic};
use crate::recording::{Channel, Recording, Run, Series, longest_interval, median, quantile};

/// A jump exceeds this distance \[m\] or angle \[rad\], and this multiple of the usual step.
const FAR: f64 = 0.5;
const TURNED: f64 = 0.5;
const USUAL: f64 = 8.0;
/// Size of a jump at even odds \[m\], as robust fits bear smaller ones, and \[rad\], as no vehicle turns in one sample; width of
/// the transition in its logarithm.
const CLEAR: f64 = 1.5;
const CLEAR_TURN: f64 = 0.75;
const WIDTH: f64 = 0.3;
/// No vehicle turns faster than this \[rad/s\], whatever its heading does.
const FASTEST_TURN: f64 = 6.0;
/// Nearly all steps are so fast at most, and others no more than twice that.
const NEARLY_ALL: f64 = 0.95;
/// Jumps in more of the samples are the sensor's noise.
const MAX_SHARE: f64 = 0.02;
/// Samples on either side whose medians must differ as well, so that none is seen at the very ends. Single samples that lie
/// apart are outliers, which robust fits bear.
const SIDE: usize = 3;

/// Doubts about jumps of the pose.
pub fn doubts(recording: &Recording) -> Vec<Doubt> {
    let runs = || recording.runs.iter().enumerate();
    let mut positions: Vec<(Span, f64)> = Vec::new();
    let mut headings: Vec<(Span, f64)> = Vec::new();
    let (mut places, mut angles) = (0, 0);
    for (index, run) in runs() {
        let (found, count) = position_jumps(run, index);
        positions.extend(found);
        places += count;
        if let Some(heading) = run.series(Channel::Heading) {
            let steps = steps(heading, |k| (heading.value[k] - heading.value[k - 1]).abs());
            angles += steps.len();
            let shift = |k: usize| shift(&heading.value, k).abs();
            let fastest = fastest(&steps).min(FASTEST_TURN);
            headings.extend(jumps(&steps, shift, TURNED, fastest, index));
        }
    }
    let found = [
        of(
            &positions,
            places,
            vec![Channel::X, Channel::Y],
            "the position",
            CLEAR,
            ("m", 1.0),
        ),
        of(
            &headings,
            angles,
            vec![Channel::Heading],
            "heading",
            CLEAR_TURN,
            ("deg", 1f64.to_degrees()),
        ),
    ];
    found.into_iter().flatten().collect()
}

fn of(
    jumps: &[(Span, f64)],
    samples: usize,
    channels: Vec<Channel>,
    what: &str,
    clear: f64,
    (unit, scale): (&str, f64),
) -> Option<Doubt> {
    let (span, size) = jumps.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if jumps.len() as f64 > (MAX_SHARE * samples as f64).max(1.0) {
        return None;
    }
    let count = match jumps.len() {
        1 => "once".into(),
        more => format!("{more} times, most"),
    };
    Some(Doubt {
        kind: DoubtKind::Jump,
        channels,
        span: Some(*span),
        probability: logistic((size / clear).ln() / WIDTH),
        left_out: Vec::new(),
        evidence: format!(
            "{what} jumps {count} by {:.1} {unit} between {:.2} and {:.2} s, which the vehicle cannot",
            scale * size,
            span.start,
            span.end
        ),
        remedy: "Check the localisation there (loop closure, lost satellites), or leave these seconds out".into(),
    })
}

/// Difference of the medians of a few values from here on and before.
fn shift(values: &[f64], k: usize) -> f64 {
    if k < SIDE || values.len() - k < SIDE {
        return 0.0;
    }
    let mut before = values[k - SIDE..k].to_vec();
    let mut after = values[k..k + SIDE].to_vec();
    median(&mut after) - median(&mut before)
}

/// A step from one sample to the next.
struct Step {
    /// Place of the later sample.
    place: usize,
    start: f64,
    interval: f64,
    size: f64,
}

/// All steps without a gap.
fn steps(series: &Series, size: impl Fn(usize) -> f64) -> Vec<Step> {
    let limit = longest_interval(series);
    let steps = 1..series.len();
    let steps = steps.map(|k| {
        let start = series.time[k - 1];
        Step {
            place: k,
            start,
            interval: series.time[k] - start,
            size: size(k),
        }
    });
    steps.filter(|step| step.interval <= limit).collect()
}

/// The fastest plausible speed: twice that of nearly all steps.
fn fastest(steps: &[Step]) -> f64 {
    let mut speeds: Vec<f64> = steps.iter().map(|step| step.size / step.interval).collect();
    speeds.sort_by(f64::total_cmp);
    2.0 * quantile(&speeds, NEARLY_ALL)
}

/// The steps that are too large, and behind which the values stay shifted.
fn jumps(
    steps: &[Step],
    shift: impl Fn(usize) -> f64,
    far: f64,
    speed: f64,
    run: usize,
) -> Vec<(Span, f64)> {
    let mut sizes: Vec<f64> = steps.iter().map(|step| step.size).collect();
    let usual = median(&mut sizes);
    let too_large = steps.iter().filter(|step| {
        step.size > far + speed * step.interval
            && step.size > USUAL * usual
            && shift(step.place) > far
    });
    let jump = |step: &Step| {
        let (start, end) = (step.start, step.start + step.interval);
        (Span { run, start, end }, step.size)
    };
    too_large.map(jump).collect()
}

/// Jumps of a position, and the number of its steps.
fn position_jumps(run: &Run, index: usize) -> (Vec<(Span, f64)>, usize) {
    let (Some(x), Some(y)) = (run.series(Channel::X), run.series(Channel::Y)) else {
        return (Vec::new(), 0);
    };
    let north: Series = x
        .samples()
        .filter_map(|(t, _)| Some((t, y.at(t)?)))
        .collect();
    if north.len() != x.len() {
        return (Vec::new(), 0);
    }
    let size = |k: usize| (x.value[k] - x.value[k - 1]).hypot(north.value[k] - north.value[k - 1]);
    let steps = steps(x, size);
    let shift = |k: usize| shift(&x.value, k).hypot(shift(&north.value, k));
    let found = jumps(&steps, shift, FAR, fastest(&steps), index);
    (found, steps.len())
}
