//! Starts of segments, looked for anew.
//!
//! A segment's start is fitted along with everything else, from its present value. Beside a model that lacks something
//! it may have gone far off, to velocities that nothing measures and that are gone after some tenths of a second,
//! and it stays there when the model is right: what that segment leaves over then looks like a force for some seconds.
//! So each start is fitted again, the model held, from where it stands, from where the sensors show it and from where
//! the segment before ends (as multiple shooting would have it: H. G. Bock, 1983), and the likeliest is taken. What the
//! linearised segment foretells of another start, or one that is on its way to the same place, is not followed: most are.

use super::linearised::add_segment;
use super::noise_model::reweigh_segment;
use super::normal::{Eliminated, Normal, START};
use super::observation::{Residuals, columns, observe};
use super::predictor::{Predictor, Request, Trajectory};
use super::problem::{NoiseModel, Point, ShootingProblem, Tables};
use super::robust;
use super::segment::Segment;
use super::sensor::{SensorParameter, SensorValues};
use crate::recording::upper_median;
use crate::simulation::State;
use nalgebra::{DVector, SVector};
use rayon::prelude::*;

/// Steps at most.
const STEPS: usize = 12;
/// The cost, a chi-square, need not fall by more than this any further where starts are looked for anew.
pub const LEAST: f64 = 0.5;
/// Another start is taken where it costs so much less.
const WORTH: f64 = 2.0;
const FIRST_DAMPING: f64 = 1e-3;
const LARGEST_DAMPING: f64 = 1e4;

/// Another start lies in the same basin where the cost there is that of the linearised segment, up to this share of the
/// difference and this much.
const FORETOLD: f64 = 0.25;
const ROUGHLY: f64 = 2.0;
/// Two minima are the same where the linearised cost differs by no more than this.
const SAME: f64 = 4.0;

/// A segment may be in a wrong minimum where its samples cost so many times what those of the median segment do.
const OUTLYING: f64 = 3.0;

/// The starts of all segments, those that were found to do better anew; `None` where none was. The parameters are held.
#[must_use]
pub fn restarted<P: Predictor>(
    problem: &ShootingProblem<P>,
    point: &Point,
    by: &NoiseModel,
) -> Option<Vec<[f64; START]>> {
    restarted_where(problem, point, by, &|_| true)
}

/// As [`restarted`], of the segments whose costs stand out from those of the others.
#[must_use]
pub fn outlying_restarted<P: Predictor>(
    problem: &ShootingProblem<P>,
    point: &Point,
    by: &NoiseModel,
    costs: impl Iterator<Item = f64>,
) -> Option<Vec<[f64; START]>> {
    let each = each(problem, costs);
    let bar = OUTLYING * upper_median(each.clone())?;
    let outlying = |index: usize| each[index] > bar;
    if !(0..each.len()).any(outlying) {
        return None;
    }
    restarted_where(problem, point, by, &outlying)
}

/// What segments whose costs stand out cost more than the median segment would.
#[must_use]
pub fn outlying_excess<P: Predictor>(
    problem: &ShootingProblem<P>,
    costs: impl Iterator<Item = f64>,
) -> f64 {
    let each = each(problem, costs);
    let middle = upper_median(each.clone()).unwrap_or(0.0);
    let pairs = each.iter().zip(&problem.segments);
    let outlying = pairs.filter(|(cost, _)| **cost > OUTLYING * middle);
    outlying
        .map(|(cost, segment)| (cost - middle) * samples(segment))
        .sum()
}

/// The segments' costs for each of their samples.
fn each<P: Predictor>(problem: &ShootingProblem<P>, costs: impl Iterator<Item = f64>) -> Vec<f64> {
    let pairs = costs.zip(&problem.segments);
    pairs
        .map(|(cost, segment)| cost / samples(segment))
        .collect()
}

fn samples(segment: &Segment) -> f64 {
    segment.sample_count().max(1) as f64
}

/// The point with these starts, and its residuals and derivatives: those of segments whose start has not changed are at
/// hand. `None` where one cannot be driven.
#[must_use]
pub fn moved<P: Predictor>(
    problem: &ShootingProblem<P>,
    point: &Point,
    tables: &[Tables],
    starts: Vec<[f64; START]>,
) -> Option<(Point, Vec<Tables>)> {
    let moved = Point {
        coordinates: point.coordinates.clone(),
        starts,
    };
    let values = problem.values(&moved);
    let same = |index: usize| moved.starts[index] == point.starts[index];
    let one = |(index, segment): (usize, &Segment)| {
        if same(index) {
            return Some(tables[index].clone());
        }
        let pair = (segment, &moved.starts[index]);
        problem.predicted(pair, &moved, &values, true).ok()
    };
    let tables = problem.segments.par_iter().enumerate().map(one).collect();
    let tables: Option<Vec<Tables>> = tables;
    Some((moved, tables?))
}

/// The start of a segment in the basin of `start` that costs least, the parameters and the weights held, where steps that gain
/// less than `least` are not taken. `None` where the vehicle cannot be driven. The weighing is of this segment alone.
#[must_use]
pub fn settled<P: Predictor>(
    problem: &ShootingProblem<P>,
    index: usize,
    coordinates: &DVector<f64>,
    start: [f64; START],
    by: &NoiseModel,
    least: f64,
) -> Option<[f64; START]> {
    let segment = &problem.segments[index];
    let values = problem.model_values(segment.recording, coordinates);
    let stretch = Stretch {
        predictor: &problem.predictor().held(&values).ok()?,
        segment,
        sensors: problem.sensor_values(segment.recording, coordinates),
        by: by.clone(),
        reweighed: false,
    };
    let settled = stretch.settled(stretch.start(start)?, None, least)?;
    Some(settled.at)
}

fn restarted_where<P: Predictor>(
    problem: &ShootingProblem<P>,
    point: &Point,
    by: &NoiseModel,
    wanted: &(impl Fn(usize) -> bool + Sync),
) -> Option<Vec<[f64; START]>> {
    let held = |recording: usize| {
        let values = problem.model_values(recording, &point.coordinates);
        problem.predictor().held(&values)
    };
    let recordings = 0..problem.recordings.len();
    let predictors: Vec<P> = recordings.map(held).collect::<Result<_, _>>().ok()?;
    let stretch = |index: usize| {
        let segment: &Segment = &problem.segments[index];
        Stretch {
            predictor: &predictors[segment.recording],
            segment,
            sensors: problem.sensor_values(segment.recording, &point.coordinates),
            by: by.of(&[index]),
            reweighed: true,
        }
    };
    let all = 0..problem.segments.len();
    let stretches: Vec<Stretch<P>> = all.map(stretch).collect();
    let pairs = stretches.par_iter().enumerate().zip(&point.starts);
    let found: Vec<_> = pairs
        .map(|((index, one), start)| {
            if !wanted(index) {
                return None;
            }
            let before = index.checked_sub(1);
            let before = before.filter(|k| one.segment.follows(stretches[*k].segment));
            let before = before.and_then(|k| stretches[k].end(&point.starts[k]));
            let begins = [Some(one.segment.start_prior), before];
            one.better(start, begins.iter().flatten())
        })
        .collect();
    if found.iter().all(Option::is_none) {
        return None;
    }
    let pairs = found.into_iter().zip(&point.starts);
    Some(pairs.map(|(new, old)| new.unwrap_or(*old)).collect())
}

/// A segment, and the model that drives it.
struct Stretch<'p, P> {
    predictor: &'p P,
    segment: &'p Segment,
    sensors: SensorValues,
    /// Noise, and the weights of this segment alone.
    by: NoiseModel,
    /// Whether these follow the residuals of each start.
    reweighed: bool,
}

/// A start, and what it costs.
struct Start {
    at: [f64; START],
    normal: Normal,
    /// Sum of the squares, and of what the weights cost where each is as its sample asks for.
    cost: f64,
    /// These weights, by channel.
    weights: Vec<Vec<f64>>,
}

impl Start {
    /// By how much the squares are more at another start, if the segment is as linear as it looks from here.
    fn foretold(&self, other: &[f64; START]) -> f64 {
        let off = self.off(other);
        off.dot(&(self.normal.by_start * off)) - 2.0 * self.normal.start_gradient.dot(&off)
    }

    fn off(&self, other: &[f64; START]) -> SVector<f64, START> {
        SVector::from_fn(|k, _| other[k] - self.at[k])
    }

    /// Whether another start is as good as here.
    fn reached(&self, other: &[f64; START]) -> bool {
        let off = self.off(other);
        off.dot(&(self.normal.by_start * off)) < SAME
    }
}

impl<P: Predictor> Stretch<'_, P> {
    /// Where the vehicle is at the end.
    fn end(&self, start: &[f64; START]) -> Option<[f64; START]> {
        let request = Request {
            parameters: &[],
            start: &State::from_array(*start),
            course: &self.segment.course_here(&self.sensors),
            clock: self.segment.clock,
            drive: &self.segment.drive,
            wheel_latency: self.sensors[SensorParameter::WheelLatency.index()],
            times: &[self.segment.start, self.segment.end],
            time_bins: &[],
            derivatives: false,
        };
        let mut trajectory = Trajectory::default();
        self.predictor.predict(&request, &mut trajectory).ok()?;
        trajectory.states.last().copied()
    }

    /// The likeliest start in the basins of this one and of others, where it does better than this one as it is.
    fn better<'b>(
        &self,
        start: &[f64; START],
        others: impl Iterator<Item = &'b [f64; START]>,
    ) -> Option<[f64; START]> {
        let here = self.start(*start)?;
        let enough = here.cost - WORTH;
        let here = self.settled(here, None, LEAST)?;
        let others = others.filter(|begin| !self.foretells(&here, begin));
        let others =
            others.filter_map(|begin| self.settled(self.start(*begin)?, Some(&here), LEAST));
        let elsewhere = others.min_by(|a, b| a.cost.total_cmp(&b.cost));
        let better = elsewhere.filter(|there| there.cost < here.cost);
        let best = better.unwrap_or(here);
        (best.cost < enough).then_some(best.at)
    }

    /// Whether the squares at another start are about those of the linearised segment.
    fn foretells(&self, here: &Start, other: &[f64; START]) -> bool {
        let Some(squares) = self.squares(here, other) else {
            return false;
        };
        let foretold = here.foretold(other);
        (squares - here.normal.cost - foretold).abs() < FORETOLD * foretold.abs() + ROUGHLY
    }

    /// Sum of the squares at another start, the weights held. `None` where the vehicle cannot be driven from there.
    fn squares(&self, here: &Start, other: &[f64; START]) -> Option<f64> {
        let Self {
            predictor,
            segment,
            sensors,
            by,
            ..
        } = self;
        let observed = observe(*predictor, segment, other, &[], sensors, false).ok()?;
        let mut sum = 0.0;
        for ((channel, samples), weights) in
            observed.iter().zip(&segment.samples).zip(&here.weights)
        {
            let mut residual = channel.residual.clone();
            let noise = by.noise[segment.recording][samples.signal.group() as usize];
            noise.whiten(&samples.time, weights, 1, &mut residual);
            sum += residual.iter().map(|r| r * r).sum::<f64>();
        }
        let apart = segment.start_prior.iter().zip(other);
        let pairs = apart.zip(segment.start_deviation);
        Some(sum + pairs.map(|((p, o), d)| ((p - o) / d).powi(2)).sum::<f64>())
    }

    /// `None` where the vehicle cannot be driven from there.
    fn start(&self, at: [f64; START]) -> Option<Start> {
        let Self {
            predictor,
            segment,
            sensors,
            by,
            reweighed,
        } = self;
        let observed = observe(*predictor, segment, &at, &[], sensors, true).ok()?;
        let width = columns(0);
        let table = |channel: &Residuals| {
            let pairs = channel
                .residual
                .iter()
                .zip(channel.rows.chunks_exact(width));
            let rows = pairs.flat_map(|(r, row)| std::iter::once(r).chain(&row[..START]));
            rows.copied().collect()
        };
        let tables = Tables {
            channels: observed.iter().map(table).collect(),
            columns: 1 + START,
        };
        let mut by = by.clone();
        let (noise, weights) = (&by.noise[segment.recording], &mut by.weights[0]);
        if *reweighed {
            reweigh_segment(segment, &tables, noise, weights);
        }
        let penalty: f64 = weights.iter().flatten().map(|w| robust::penalty(*w)).sum();
        let mut normal = Normal::zeros(0);
        add_segment(&mut normal, segment, 0, &[], &tables, &by);
        let missing = std::array::from_fn(|k| segment.start_prior[k] - at[k]);
        normal.add_start_prior(&missing, &segment.start_deviation);
        let cost = normal.cost + penalty;
        cost.is_finite().then_some(Start {
            at,
            normal,
            cost,
            weights: by.weights.swap_remove(0),
        })
    }

    /// The start in the same basin that costs least. `None` where that one is `known`.
    fn settled(&self, mut here: Start, known: Option<&Start>, least: f64) -> Option<Start> {
        let mut damping = FIRST_DAMPING;
        for _ in 0..STEPS {
            if known.is_some_and(|known| known.reached(&here.at)) {
                return None;
            }
            let Some(eliminated) = Eliminated::new(&here.normal, damping) else {
                break;
            };
            if eliminated.start_gain < least || damping > LARGEST_DAMPING {
                break;
            }
            let step = eliminated.start_step(&here.normal, &DVector::zeros(0));
            let there = self.start(std::array::from_fn(|k| here.at[k] + step[k]));
            match there.filter(|there| there.cost < here.cost) {
                Some(there) => {
                    let gain = here.cost - there.cost;
                    here = there;
                    damping *= 0.3;
                    if gain < least {
                        break;
                    }
                }
                None => damping *= 10.0,
            }
        }
        Some(here)
    }
}
