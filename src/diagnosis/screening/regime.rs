//! The regime in which an effect shows: the time bins from which its fit gains.
//!
//! With the effect's step d, the soil following, a time bin b gains d^T g_b - d^T (sum over b' of H_bb') d / 2 of the
//! log likelihood; gains are summed over classes of speed, turning and heading.

use super::screen::Projection;
use super::system::{SegmentSystem, System};
use super::wrench;
use crate::diagnosis::hypothesis::Problem;
use crate::diagnosis::outcome::Channel;
use nalgebra::DVector;
use std::f64::consts::PI;

/// A time bin's share in what a fit gains.
#[derive(Debug, Clone, Copy)]
pub struct BinGain {
    /// Recording and run.
    pub run: (usize, usize),
    /// Gain of the log likelihood.
    pub gain: f64,
    /// Speed along the vehicle by the wheels \[m/s\], turn rate by the wheels \[rad/s\].
    motion: [f64; 2],
    heading: Option<f64>,
}

/// Turn rates below this are straight on \[rad/s\].
const STRAIGHT: f64 = 0.15;
/// A regime is reported if it holds this share of the gain, at this multiple of the mean gain per time.
const MOST: f64 = 0.6;
const DENSER: f64 = 1.5;
/// Sectors of the heading.
const SECTORS: usize = 6;

/// Gains of all time bins by steps of binned coefficients; empty where none of the coefficients is binned.
#[must_use]
pub fn gains(
    problem: &Problem,
    system: &System,
    projection: &Projection,
    steps: &[(usize, Vec<f64>)],
) -> Vec<BinGain> {
    let binned = |coefficient: usize| {
        system
            .layout
            .binned
            .iter()
            .position(|other| *other == coefficient)
    };
    let known: Vec<(usize, &Vec<f64>)> = steps
        .iter()
        .filter_map(|(coefficient, each)| Some((binned(*coefficient)?, each)))
        .collect();
    if known.is_empty() {
        return Vec::new();
    }
    let soil = following(system, projection, steps);
    let layout = &system.layout;
    let mut all = Vec::new();
    for segment in &system.segments {
        let mut direction = DVector::zeros(layout.per_bin());
        direction.rows_mut(0, layout.soil).copy_from(&soil);
        for (column, each) in &known {
            direction[layout.soil + column] += each[segment.recording];
        }
        let count = segment.time_bins();
        let mut whole = DVector::zeros(segment.gradient.len());
        for time_bin in 0..count {
            let first = layout.whole() + time_bin * layout.per_bin();
            whole
                .rows_mut(first, layout.per_bin())
                .copy_from(&direction);
        }
        let bent = &segment.matrix * &whole;
        for time_bin in 0..count {
            let first = layout.whole() + time_bin * layout.per_bin();
            let own = |v: &DVector<f64>| direction.dot(&v.rows(first, layout.per_bin()));
            let gain = own(&segment.gradient) - 0.5 * own(&bent);
            all.push(describe(problem, segment, time_bin, gain));
        }
    }
    all
}

/// How the soil follows the steps.
fn following(
    system: &System,
    projection: &Projection,
    steps: &[(usize, Vec<f64>)],
) -> DVector<f64> {
    let mut unknowns = Vec::new();
    let mut values = Vec::new();
    for (coefficient, each) in steps {
        for (recording, value) in each.iter().enumerate() {
            if let Some(unknown) = system.places[recording][system.layout.soil + coefficient]
                && !unknowns.contains(&unknown)
            {
                unknowns.push(unknown);
                values.push(*value);
            }
        }
    }
    let followed = projection.following(&unknowns, &DVector::from_vec(values));
    followed.rows(0, system.layout.soil).into_owned()
}

fn describe(problem: &Problem, segment: &SegmentSystem, time_bin: usize, gain: f64) -> BinGain {
    let data = &problem.segments[segment.index];
    let middle = 0.5 * (segment.edges[time_bin] + segment.edges[time_bin + 1]);
    let row = data.drive.time.partition_point(|time| *time <= middle);
    let [left, right] = data.drive.wheel_speeds(row.saturating_sub(1));
    let vehicle = &problem.nominal.vehicle;
    let run = &problem.recordings[data.recording].runs[data.run];
    let heading = run.series(crate::recording::Channel::Heading);
    BinGain {
        run: (data.recording, data.run),
        gain,
        motion: [
            0.5 * vehicle.wheel_radius * (left + right),
            0.5 * vehicle.wheel_radius * (right - left) / vehicle.half_track,
        ],
        heading: heading.and_then(|series| series.at(middle)),
    }
}

/// Whether a time bin lies in a regime.
type Holds = Box<dyn Fn(&BinGain) -> bool>;

/// The regime with the densest gain; empty for none.
#[must_use]
pub fn regime(gains: &[BinGain]) -> String {
    let mut speeds: Vec<f64> = gains.iter().map(|g| g.motion[0].abs()).collect();
    speeds.sort_by(f64::total_cmp);
    let Some(fast) = speeds.get(speeds.len() * 2 / 3).copied() else {
        return String::new();
    };
    let mut bins: Vec<(String, Holds)> = vec![
        (
            format!("speed over {fast:.2} m/s"),
            Box::new(move |g| g.motion[0].abs() > fast),
        ),
        (
            "straight on".into(),
            Box::new(|g| g.motion[1].abs() < STRAIGHT),
        ),
        (
            "turning".into(),
            Box::new(|g| g.motion[1].abs() >= STRAIGHT),
        ),
        ("turning left".into(), Box::new(|g| g.motion[1] >= STRAIGHT)),
        (
            "turning right".into(),
            Box::new(|g| g.motion[1] <= -STRAIGHT),
        ),
        ("reversing".into(), Box::new(|g| g.motion[0] < 0.0)),
    ];
    let width = 2.0 * PI / SECTORS as f64;
    for sector in 0..SECTORS {
        let from = width * sector as f64 - PI;
        let (a, b) = (
            from.to_degrees().round(),
            (from + width).to_degrees().round(),
        );
        bins.push((
            format!("heading {a}..{b} deg"),
            Box::new(move |g| {
                g.heading.is_some_and(|psi| {
                    let wrapped = (psi + PI).rem_euclid(2.0 * PI) - PI;
                    (from..from + width).contains(&wrapped)
                })
            }),
        ));
    }
    let positive = |g: &&BinGain| g.gain > 0.0;
    let all: f64 = gains.iter().filter(positive).map(|g| g.gain).sum();
    let mut best: Option<(f64, String)> = None;
    for (name, holds) in bins {
        let inside: Vec<&BinGain> = gains.iter().filter(|g| holds(g)).collect();
        let share = inside.iter().map(|g| g.gain.max(0.0)).sum::<f64>() / all.max(1e-300);
        let time = inside.len() as f64 / gains.len() as f64;
        let denser = share / time.max(1e-9);
        if share > MOST && denser > DENSER && best.as_ref().is_none_or(|(d, _)| denser > *d) {
            best = Some((denser, name));
        }
    }
    best.map_or(String::new(), |(_, name)| name)
}

/// The component of the wrench whose signal is most like that of a step of binned coefficients.
#[must_use]
pub fn channel(problem: &Problem, system: &System, steps: &[(usize, Vec<f64>)]) -> Channel {
    const CHANNELS: [Channel; 3] = [Channel::Longitudinal, Channel::Lateral, Channel::Yaw];
    let Some(force_columns) = wrench::force_columns(problem, &system.layout) else {
        return Channel::Longitudinal;
    };
    let mut likeness = [0.0; 3];
    for segment in &system.segments {
        let layout = &system.layout;
        let mut whole = DVector::zeros(segment.gradient.len());
        for (coefficient, each) in steps {
            whole[layout.soil + coefficient] = each[segment.recording];
        }
        let seen = &segment.matrix * whole;
        for time_bin in 0..segment.time_bins() {
            let first = layout.whole() + time_bin * layout.per_bin();
            for (sum, column) in likeness.iter_mut().zip(force_columns) {
                let own = segment.matrix[(first + column, first + column)];
                if own > 0.0 {
                    *sum += seen[first + column].powi(2) / own;
                }
            }
        }
    }
    let best = (0..3).max_by(|a, b| likeness[*a].total_cmp(&likeness[*b]));
    best.map_or(Channel::Longitudinal, |k| CHANNELS[k])
}
