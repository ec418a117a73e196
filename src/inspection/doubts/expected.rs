//! What the given vehicle would do with the recorded wheel speeds, on the soils of the paper and on stiffer, softer,
//! stronger and weaker ones.
//!
//! A few stretches are driven from a guessed state; their first seconds, in which the guess is forgotten, do not count.

use super::doubt::standing;
use crate::recording::{Cumulated, Drive, Run, Series, range};
use crate::simulation::{Simulation, State, WheelSpeeds};
use crate::terrain::Terrain;
use crate::vehicle::{Vehicle, VehicleModel};
use rayon::prelude::*;
use std::sync::Arc;

/// Length of a stretch, the part that does not count, and the margin at its end for delays \[s\].
const LENGTH: f64 = 5.0;
const FORGET: f64 = 1.2;
const MARGIN: f64 = 0.35;
/// Maximum number of stretches. With 4 of them twice the wheel speeds of four recordings of one vehicle (runs of 6 s on
/// asphalt, gravel, ice and sand) were not doubted.
const MAX_STRETCHES: usize = 12;
/// Window of the mean rates, and from one window to the next \[s\].
const WINDOW: f64 = 1.0;
const SPACING: f64 = 0.25;
/// Rows of the wheel speeds: interval, and the mean that they are \[s\]. Encoders that are read at 4 Hz make steps, on which
/// a simulation takes long.
const ROW: f64 = 0.1;
const ROW_MEAN: f64 = 0.3;
/// No stretch has a longer interval between wheel speeds \[s\].
const MAX_GAP: f64 = 0.5;
/// Slower wheels stand \[rad/s\].
const STANDING: f64 = 0.3;
/// Delays of the measurement behind the model \[s\], beyond those behind the wheels.
const SHIFTS: [f64; 7] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3];
/// Errors of the model on real ground, as a share of the motion: smaller differences prove nothing.
const MODEL_ERROR: f64 = 0.03;
/// Errors as a share of the motion up to which nothing is left for a factor to explain.
const EXPECTED: f64 = 0.06;
/// First steps of the search in the logarithms of strength, shear modulus and stiffness, and of the factor.
const STEPS: [f64; 4] = [0.35, 0.5, 0.7, 0.15];
/// Their ranges around a soil of the paper.
const RANGES: [f64; 3] = [1.0, 1.4, 1.4];
/// Halvings of the steps, and the maximum number of drives.
const HALVINGS: usize = 2;
const MAX_DRIVES: usize = 24;
/// Maximum number of the integrator's steps: for a second of a drive, which is given up beyond, and for a hypothesis, whose
/// search ends there. These bound the work rather than the time, so that the result does not depend on the machine.
const STEPS_PER_SECOND: f64 = 400.0;
const STEPS_PER_SEARCH: u64 = 60_000;
/// A round of the search that gains less log likelihood is the last of its step.
const GAIN: f64 = 0.3;
/// Factors below this one are not refined, nor is what explains less by this log likelihood.
const SMALL: f64 = 1.15;
const MAX_DEFICIT: f64 = 5.0;
/// Soils within this log likelihood of the best explain the motion as well.
pub const CLOSE_LIKELIHOOD: f64 = 3.0;
/// Drives to find the factor at which a search starts, the logarithm of a ratio that is near enough to 1, and the smallest
/// slope of that over the logarithm of the factor.
const SECANTS: usize = 4;
const CLOSE: f64 = 0.02;
const FLATTEST: f64 = 0.3;
/// Factors at which a search starts.
const START: std::ops::RangeInclusive<f64> = 0.005..=200.0;

/// The measured motion: speed ahead \[m/s\] and yaw rate \[rad/s\], with their delays behind the wheels.
pub struct Measured {
    /// Integrals of each run, if measured.
    pub signals: [Vec<Option<Cumulated>>; 2],
    /// Delays \[s\].
    pub delays: [f64; 2],
    /// Ratios to the motion without slip, for the guess of the first state.
    pub ratios: [Option<f64>; 2],
}

/// What a factor stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scaled {
    /// Nothing: the vehicle as it is given.
    Nothing,
    /// The wheel speeds, or the radius.
    Wheels,
    /// The track.
    Track,
}

/// The best soil for a hypothesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explained {
    /// Log likelihood, up to a constant.
    pub likelihood: f64,
    /// The factor, 1 without one.
    pub factor: f64,
    /// Smallest and largest factor on soils that explain the motion nearly as well.
    pub factors: [f64; 2],
    /// Errors as shares of the motion: speed, yaw rate; `None` if not measured.
    pub errors: [Option<f64>; 2],
    /// Measured over predicted.
    pub ratios: [Option<f64>; 2],
}

impl Explained {
    /// Whether the motion is predicted as well as a model does.
    pub fn is_expected(&self) -> bool {
        self.errors.iter().flatten().all(|error| *error <= EXPECTED)
    }
}

/// Where a search for the best soil starts.
#[derive(Debug, Clone, Copy)]
pub struct Start<'a> {
    base: &'a Terrain,
    scaled: Scaled,
    /// Logarithms of strength, shear modulus and stiffness over those of the base, and of the factor.
    at: [f64; 4],
    /// How many of them are searched.
    free: usize,
    found: Explained,
    /// Steps of the integrator so far.
    steps: u64,
}

/// A stretch of driving.
struct Stretch {
    drive: Drive,
    run: usize,
    /// Its start in the recording \[s\].
    start: f64,
}

/// The stretches of a recording, and what was measured in them.
pub struct Expectation<'a> {
    vehicle: &'a Vehicle,
    measured: &'a Measured,
    stretches: Vec<Stretch>,
    /// The soils of the paper, each with what it explains.
    bases: Vec<(Terrain, Explained)>,
    is_over: &'a (dyn Fn() -> bool + Sync),
}

/// Sums of one channel at one shift.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    measured: f64,
    predicted: f64,
    both: f64,
    count: usize,
}

impl Sums {
    fn push(&mut self, measured: f64, predicted: f64) {
        self.measured += measured * measured;
        self.predicted += predicted * predicted;
        self.both += measured * predicted;
        self.count += 1;
    }

    fn and(self, other: Self) -> Self {
        Self {
            measured: self.measured + other.measured,
            predicted: self.predicted + other.predicted,
            both: self.both + other.both,
            count: self.count + other.count,
        }
    }

    /// Root mean square error, as a share of the measured motion.
    fn error(&self) -> f64 {
        let square = self.measured - 2.0 * self.both + self.predicted;
        (square.max(0.0) / self.measured).sqrt()
    }
}

type Table = [[Sums; SHIFTS.len()]; 2];

impl<'a> Expectation<'a> {
    /// Chooses stretches spread evenly over the driving; `None` without any.
    pub fn new(
        runs: &[Run],
        vehicle: &'a Vehicle,
        measured: &'a Measured,
        is_over: &'a (dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        let mut stretches: Vec<Stretch> = Vec::new();
        let still = standing(runs, STANDING);
        for (index, run) in runs.iter().enumerate() {
            stretches.extend(stretches_of(index, run, still));
        }
        let count = stretches.len();
        let kept = count.min(MAX_STRETCHES);
        let chosen: Vec<usize> = (0..kept)
            .map(|k| (2 * k + 1) * count / (2 * kept))
            .collect();
        let mut index = 0;
        stretches.retain(|_| {
            index += 1;
            chosen.contains(&(index - 1))
        });
        let mut expectation = Self {
            vehicle,
            measured,
            stretches,
            bases: Vec::new(),
            is_over,
        };
        let soils = Terrain::PRESETS.iter();
        let soils = soils.filter_map(|name| Terrain::preset(name));
        let mut steps = 0;
        let driven = soils.filter_map(|soil| {
            let found = expectation.at(&soil, Scaled::Nothing, &[0.0; 4], &mut steps)?;
            Some((soil, found))
        });
        expectation.bases = driven.collect();
        (!expectation.bases.is_empty()).then_some(expectation)
    }

    /// Where a search for the best soil starts, with a factor or without one. `None` if no soil of the paper can be driven,
    /// if the factor is near 1, or if it explains much less than the best soil of the paper does without one.
    pub fn begin(&self, scaled: Scaled) -> Option<Start<'_>> {
        let mut steps = 0;
        let tried = self.bases.iter().filter_map(|(base, found)| {
            let (factor, found) = self.start(base, found, scaled, &mut steps)?;
            Some((base, [0.0, 0.0, 0.0, factor], found))
        });
        let tried: Vec<(&Terrain, [f64; 4], Explained)> = tried.collect();
        let best = tried.iter();
        let best = best.max_by(|a, b| a.2.likelihood.total_cmp(&b.2.likelihood));
        let (base, at, mut best) = *best?;
        let given = self.bases.iter().map(|(_, found)| found.likelihood);
        let given = given.fold(f64::NEG_INFINITY, f64::max);
        let is_near = best.factor.ln().abs() < SMALL.ln();
        if scaled != Scaled::Nothing && (is_near || best.likelihood < given - MAX_DEFICIT) {
            return None;
        }
        let close = tried.iter().map(|(_, _, found)| found);
        let close = close.filter(|found| found.likelihood > best.likelihood - CLOSE_LIKELIHOOD);
        best.factors = range(close.map(|found| found.factor));
        Some(Start {
            base,
            scaled,
            at,
            free: if scaled == Scaled::Nothing { 3 } else { 4 },
            found: best,
            steps,
        })
    }

    /// The same for wheel speeds times a known factor.
    pub fn begin_at(&self, factor: f64) -> Option<Start<'_>> {
        let mut steps = 0;
        let at = [0.0, 0.0, 0.0, factor.ln()];
        let tried = self.bases.iter().filter_map(|(base, _)| {
            let found = self.at(base, Scaled::Wheels, &at, &mut steps)?;
            Some((base, found))
        });
        let (base, found) = tried.max_by(|a, b| a.1.likelihood.total_cmp(&b.1.likelihood))?;
        Some(Start {
            base,
            scaled: Scaled::Wheels,
            at,
            free: 3,
            found,
            steps,
        })
    }

    /// The best soil from a start on. Without a factor, the search ends where the motion is as
    /// [expected](Explained::is_expected).
    pub fn explain(&self, start: &Start) -> Explained {
        let Start {
            base,
            scaled,
            mut at,
            free,
            found: mut best,
            mut steps,
        } = *start;
        let factors = best.factors;
        // A pattern search: the likelihood has kinks where another delay fits better.
        let (mut scale, mut tried) = (1.0, vec![at]);
        let is_done = |best: &Explained| scaled == Scaled::Nothing && best.is_expected();
        for _ in 0..=HALVINGS {
            while !is_done(&best) {
                let before = best.likelihood;
                for dimension in 0..free {
                    for direction in [1.0, -1.0] {
                        let mut other = at;
                        other[dimension] += direction * scale * STEPS[dimension];
                        let range = RANGES.get(dimension).copied().unwrap_or(f64::INFINITY);
                        let is_spent = tried.len() > MAX_DRIVES || steps >= STEPS_PER_SEARCH;
                        if other[dimension].abs() > range || is_spent || tried.contains(&other) {
                            continue;
                        }
                        tried.push(other);
                        if let Some(found) = self.at(base, scaled, &other, &mut steps)
                            && found.likelihood > best.likelihood
                        {
                            (best, at) = (found, other);
                            break;
                        }
                    }
                }
                if best.likelihood < before + GAIN {
                    break;
                }
            }
            scale *= 0.5;
        }
        best.factors = range(factors.into_iter().chain([best.factor]));
        best
    }

    /// The logarithm of the factor with which the vehicle moves as far as measured on a soil, by secants from what it falls
    /// short by without a factor; with what it explains. The resistance to turning depends on the track, so that the
    /// first guess may be far off.
    fn start(
        &self,
        base: &Terrain,
        unscaled: &Explained,
        scaled: Scaled,
        steps: &mut u64,
    ) -> Option<(f64, Explained)> {
        // What is measured falls short of the prediction as the factor grows, or the other way round.
        let (slope, short_by): (f64, fn(&Explained) -> Option<f64>) = match scaled {
            Scaled::Nothing => return Some((0.0, *unscaled)),
            Scaled::Wheels => (-1.0, |found| found.ratios[0].or(found.ratios[1])),
            Scaled::Track => (1.0, |found| found.ratios[1]),
        };
        let short_by = |found: &Explained| {
            let ratio = short_by(found).filter(|ratio| START.contains(ratio))?;
            Some(ratio.ln())
        };
        let (mut last, mut short) = (0.0, short_by(unscaled)?);
        if short.abs() <= CLOSE {
            return Some((0.0, *unscaled));
        }
        let mut slope = slope;
        let mut best: Option<(f64, Explained)> = None;
        for _ in 0..SECANTS {
            let next = last - short / slope;
            let Some(found) = self.at(base, scaled, &[0.0, 0.0, 0.0, next], steps) else {
                break;
            };
            if best.is_none_or(|(_, best)| found.likelihood > best.likelihood) {
                best = Some((next, found));
            }
            let Some(rest) = short_by(&found).filter(|rest| rest.abs() > CLOSE) else {
                break;
            };
            // The slope keeps its sign, and no secant goes further than a few times the plain guess.
            let secant = (rest - short) / (next - last);
            slope = slope.signum() * (secant * slope.signum()).clamp(FLATTEST, 1.0);
            (last, short) = (next, rest);
        }
        best
    }

    /// Drives the stretches on a soil, and adds the integrator's steps; `None` if the vehicle cannot.
    fn at(
        &self,
        base: &Terrain,
        scaled: Scaled,
        at: &[f64; 4],
        steps: &mut u64,
    ) -> Option<Explained> {
        if (self.is_over)() {
            return None;
        }
        let [strength, shear, stiffness, factor] = at.map(f64::exp);
        let soil = Terrain {
            cohesion: base.cohesion * strength,
            friction_angle: (base.friction_angle.tan() * strength).atan(),
            shear_modulus: base.shear_modulus * shear,
            frictional_modulus: base.frictional_modulus * stiffness,
            ..*base
        };
        let mut vehicle = self.vehicle.clone();
        let mut wheels = 1.0;
        match scaled {
            Scaled::Nothing => {}
            Scaled::Wheels => wheels = factor,
            Scaled::Track => {
                vehicle.half_track *= factor;
                // The wheels stay within the vehicle.
                vehicle.wheel_width = vehicle.wheel_width.min(2.0 * vehicle.half_track);
            }
        }
        let model = Arc::new(VehicleModel::new(vehicle, soil).ok()?);
        let driven: Vec<(Option<Table>, u64)> = self
            .stretches
            .par_iter()
            .map(|stretch| self.table(&model, stretch, wheels))
            .collect();
        *steps += driven.iter().map(|(_, steps)| steps).sum::<u64>();
        let tables: Vec<Option<Table>> = driven.into_iter().map(|(table, _)| table).collect();
        let lost = tables.iter().filter(|table| table.is_none()).count();
        if 2 * lost >= tables.len() {
            return None;
        }
        let mut sums: Table = Default::default();
        for table in tables.into_iter().flatten() {
            for (channel, shifts) in sums.iter_mut().zip(table) {
                for (sum, other) in channel.iter_mut().zip(shifts) {
                    *sum = sum.and(other);
                }
            }
        }
        let best = sums.map(|shifts| {
            let used = shifts
                .into_iter()
                .filter(|sum| sum.measured > 0.0 && sum.count > 0);
            used.min_by(|a, b| a.error().total_cmp(&b.error()))
        });
        // Windows overlap; a second or two of driving is independent of the next.
        let likelihood = best.iter().flatten().map(|sum| {
            let seconds = sum.count as f64 * SPACING;
            -0.25 * seconds * (sum.error().powi(2) + MODEL_ERROR.powi(2)).ln()
        });
        Some(Explained {
            likelihood: likelihood.sum(),
            factor,
            factors: [factor; 2],
            errors: best.map(|sum| Some(sum?.error())),
            ratios: best.map(|sum| sum.map(|sum| sum.both / sum.predicted)),
        })
    }

    /// Drives one stretch and compares it with what was measured; with the integrator's steps.
    fn table(
        &self,
        model: &Arc<VehicleModel>,
        stretch: &Stretch,
        factor: f64,
    ) -> (Option<Table>, u64) {
        let mut simulation = Simulation::new(Arc::clone(model));
        simulation.limit_work(STEPS_PER_SECOND);
        let motion = self.drive(&mut simulation, &stretch.drive, factor);
        let counters = simulation.counters();
        let table = motion.map(|motion| self.compare(&motion, stretch));
        (table, counters.steps + counters.rejected)
    }

    /// Compares the motion of a stretch with what was measured.
    fn compare(&self, motion: &[Cumulated; 2], stretch: &Stretch) -> Table {
        let mut table: Table = Default::default();
        let last = LENGTH - MARGIN - WINDOW / 2.0;
        let count = ((last - FORGET - WINDOW / 2.0) / SPACING).floor() as usize;
        for (channel, sums) in table.iter_mut().enumerate() {
            let measured = self.measured.signals[channel][stretch.run].as_ref();
            let Some(measured) = measured else { continue };
            for k in 0..=count {
                let centre = FORGET + WINDOW / 2.0 + SPACING * k as f64;
                let at = stretch.start + centre + self.measured.delays[channel];
                let Some(found) = measured.mean_rate(at, WINDOW) else {
                    continue;
                };
                for (sum, shift) in sums.iter_mut().zip(SHIFTS) {
                    if let Some(predicted) = motion[channel].mean_rate(centre + shift, WINDOW) {
                        sum.push(found, predicted);
                    }
                }
            }
        }
        table
    }

    /// Distance ahead and angle turned over time, with the wheel speeds times a factor; `None` if the vehicle cannot drive.
    fn drive(
        &self,
        simulation: &mut Simulation,
        drive: &Drive,
        factor: f64,
    ) -> Option<[Cumulated; 2]> {
        let ratios = self.measured.ratios;
        let vehicle = simulation.model().vehicle();
        let speeds = |row: usize| drive.wheel_speeds(row).map(|speed| factor * speed);
        let [left, right] = speeds(0);
        let guess = |ratio: Option<f64>, usual: f64| {
            ratio.map_or(usual, |ratio| (ratio / factor).clamp(0.1, 1.0))
        };
        let (radius, half_track) = (vehicle.wheel_radius, vehicle.half_track);
        let start = State {
            v_x: guess(ratios[0], 0.8) * radius * 0.5 * (left + right),
            yaw_rate: guess(ratios[1], 0.5) * radius * (right - left) / (2.0 * half_track),
            ..State::default()
        };
        simulation.set_state(start).ok()?;
        let mut motion: [Vec<(f64, f64)>; 2] = Default::default();
        for row in 0..drive.len() {
            let state = simulation.state();
            motion[0].push((drive.time[row], state.v_x));
            motion[1].push((drive.time[row], state.yaw_rate));
            let Some(next) = drive.time.get(row + 1) else {
                break;
            };
            if (self.is_over)() {
                return None;
            }
            let [left, right] = speeds(row);
            let rates = drive.wheel_accelerations(row).map(|rate| factor * rate);
            let wheels = |[left, right]: [f64; 2]| WheelSpeeds { left, right };
            simulation.set_wheel_speeds(wheels([left, right])).ok()?;
            simulation.set_wheel_accelerations(wheels(rates)).ok()?;
            simulation.step(next - drive.time[row]).ok()?;
        }
        let sum =
            |rates: Vec<(f64, f64)>| Cumulated::of_rate(&rates.into_iter().collect::<Series>());
        Some(motion.map(sum))
    }
}

/// Stretches of a run in which the wheels turn faster than `still` and have no gap.
fn stretches_of(index: usize, run: &Run, still: f64) -> Vec<Stretch> {
    let Some(drive) = run.drive() else {
        return Vec::new();
    };
    let gaps = run.wheel_gaps(MAX_GAP);
    let side = |speeds: &[f64]| {
        let series: Series = drive
            .time
            .iter()
            .copied()
            .zip(speeds.iter().copied())
            .collect();
        Cumulated::of_rate(&series)
    };
    let sides = [side(&drive.omega_left), side(&drive.omega_right)];
    let first = drive.time[0];
    let count = (drive.duration() / LENGTH).floor() as usize;
    let stretch = |k: usize| {
        let start = first + LENGTH * k as f64;
        let overlaps = |gap: &[f64; 2]| gap[0] < start + LENGTH && gap[1] > start;
        if gaps.iter().any(overlaps) {
            return None;
        }
        let rows = (LENGTH / ROW).round() as usize;
        let time: Vec<f64> = (0..=rows).map(|row| ROW * row as f64).collect();
        let speeds = |sum: &Cumulated| -> Option<Vec<f64>> {
            let last = drive.time[drive.len() - 1] - ROW_MEAN / 2.0;
            let at = |t: &f64| (start + t).clamp(first + ROW_MEAN / 2.0, last);
            time.iter()
                .map(|t| sum.mean_rate(at(t), ROW_MEAN))
                .collect()
        };
        let drive = Drive {
            omega_left: speeds(&sides[0])?,
            omega_right: speeds(&sides[1])?,
            time: time.clone(),
            filled_rows: 0,
        };
        let size = |row: usize| drive.wheel_speeds(row).map(f64::abs).iter().sum::<f64>() / 2.0;
        let mean = (0..drive.len()).map(size).sum::<f64>() / drive.len() as f64;
        (mean > still).then_some(Stretch {
            drive,
            run: index,
            start,
        })
    };
    (0..count).filter_map(stretch).collect()
}
