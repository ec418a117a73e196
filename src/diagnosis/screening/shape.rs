//! Shape freedom: how far a mechanism's formula may differ from the catalogue's.
//!
//! An effect's name means a mechanism. The catalogue has one formula of it; the ground may obey another. So each
//! component a of an effect's wrench may be
//!
//! ```text
//! sum over i of w_ai(t) (1 + d_a + sum over u of p_au l_ui(t) + q_au l_ui(t)^2),    l_ui = ln(u_i / u_0)
//! ```
//!
//! with the arguments u (speed, lateral speed, slip, sinkage, row), u_0 their mean where the effect acts. An effect on the
//! wheels has three components, each with a share w_ai of every wheel i: the motion resistance, which is what the thrust
//! of the axle's torque exceeds the force along the wheel by, that thrust, and the lateral force; moments follow from the
//! wheels' places. One on the body, or one that remembers, has the force along, the force across and the moment. p is
//! a difference of the exponent, q bends the power law towards saturation, d changes the component's share of the effect. All
//! have normal priors around zero. The wrench is the difference between the accelerations with the effect and without it at the
//! fitted motion. Its signal follows from the sensitivities to a force in each time bin, so a shape costs no
//! prediction of its own, and Laplace's method integrates it out.

use super::screen::Projection;
use super::sensitivity::{Layout, SegmentTable, sensitivities};
use super::system::{System, linearise};
use super::wrench::force_columns;
use crate::diagnosis::hypothesis::candidate::Target;
use crate::diagnosis::hypothesis::likelihood::FurtherColumns;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::effects::{Acts, CATALOGUE, Declaration};
use crate::fit::exact::ExactPredictor;
use crate::fit::parameter::{ActsBy, FreeParameter, Prior, Scale};
use crate::fit::predictor::{Predictor, Request, Trajectory};
use crate::fit::problem::NoiseModel;
use crate::fit::segment::Segment;
use crate::fit::sensor::{SensorParameter, SensorValues};
use crate::simulation::{Simulation, State, WheelSpeeds};
use crate::vehicle::{GRAVITY, Specification, Vehicle, VehicleModel};
use nalgebra::{DMatrix, DVector, RowDVector};
use rayon::prelude::*;

/// Components of the wrench, and those of an effect that have shapes.
pub const AXES: usize = 3;
const COMPONENTS: usize = 3;
/// The last component of an effect on the wheels.
const LATERAL: usize = 2;
/// Standard deviations of d, p and q.
const DIRECTION: f64 = 0.5;
const EXPONENT: f64 = 0.5;
const BEND: f64 = 0.15;
/// No shape comes near this.
const FARTHEST: f64 = 1e3;
/// Logarithms of arguments are held within this of their mean: the effect is small where its argument is.
const RANGE: f64 = 2.0;
/// Arguments below these count as these: \[m/s\], \[-\], \[m\].
const SMALLEST: f64 = 1e-3;
/// Log prior of the catalogue's own formula, and of another one.
const EVEN: f64 = std::f64::consts::LN_2;

/// What an effect's formula may depend on, besides its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Argument {
    /// Speed of the vehicle \[m/s\].
    Speed,
    /// Lateral speed of the wheel \[m/s\].
    SideSpeed,
    /// Longitudinal slip of the wheel \[-\].
    Slip,
    /// Sinkage of the wheel \[m\].
    Sinkage,
    /// Place of the wheel along the vehicle: exp(x / x_1), x_1 that of the first row.
    Row,
}

impl Argument {
    const OF_WHEELS: [Self; 5] = [
        Self::Slip,
        Self::Sinkage,
        Self::SideSpeed,
        Self::Speed,
        Self::Row,
    ];
}

/// Unknowns of the shapes of some effects, appended to a linearised problem.
#[derive(Debug, Clone, Default)]
pub struct Shapes {
    /// The unknowns.
    pub unknowns: Vec<usize>,
}

impl Shapes {
    /// Log Bayes factor of "the catalogue's formula or a neighbour of it" against the catalogue's formula alone. The
    /// `further` unknowns (the coefficients that are on) and the soil follow.
    #[must_use]
    pub fn gain(&self, system: &System, further: &[usize]) -> f64 {
        if self.unknowns.is_empty() {
            return 0.0;
        }
        let Some(projection) = Projection::over_all(system, further) else {
            return 0.0;
        };
        let score = projection.score_with(&projection.of(&self.unknowns), 1.0);
        mixed(score.evidence)
    }

    /// The linearised problem after the likeliest step of the shapes; `None` if the catalogue's formulas are likelier.
    #[must_use]
    pub fn followed(&self, system: &System, further: &[usize]) -> Option<System> {
        if self.gain(system, further) <= 0.0 {
            return None;
        }
        let projection = Projection::over_all(system, further)?;
        let step = projection
            .score_with(&projection.of(&self.unknowns), 1.0)
            .step;
        let settled = projection.inverse().1 + projection.following(&self.unknowns, &step);
        let mut followed = system.clone();
        for segment in &mut followed.segments {
            let mut whole = DVector::zeros(segment.gradient.len());
            for (unknowns, step) in [(projection.nuisance(), &settled), (&self.unknowns, &step)] {
                let columns = system.columns(segment.recording, unknowns);
                for (column, step) in columns.into_iter().zip(step.iter()) {
                    if let Some(column) = column {
                        whole[column] = *step;
                    }
                }
            }
            segment.gradient -= &segment.matrix * whole;
        }
        Some(followed)
    }
}

/// Log evidence of an even mixture of two models, the first of which has the log evidence 0.
#[must_use]
pub fn mixed(evidence: f64) -> f64 {
    evidence.max(0.0) + (-evidence.abs()).exp().ln_1p() - EVEN
}

/// Probability of the catalogue's own formula where its neighbourhood has this gain.
#[must_use]
pub fn exactness(gain: f64) -> f64 {
    (-gain - EVEN).exp().min(1.0)
}

/// The gain of shape freedom at a fit, see [`Shapes::gain`]: zero where none of the effects that are on has any.
#[must_use]
pub fn gain_at(problem: &Problem, on: &[usize], at: &Solution, noise: &NoiseModel) -> f64 {
    if effects(problem, on).is_empty() {
        return 0.0;
    }
    let layout = Layout::beside(problem, on);
    let tables = sensitivities(problem, &layout, at);
    let mut system = linearise(problem, &layout, &tables, at, noise);
    drop(tables);
    let shapes = append(problem, on, at, &mut system);
    let further: Vec<usize> = on.iter().flat_map(|k| system.unknowns(*k)).collect();
    shapes.gain(&system, &further)
}

/// What the formula of an effect may depend on, besides its parameters. That of wheels may depend on anything that the
/// contact knows: with the arguments of the catalogue's formulas alone, six wrong names patched right ones with 0.9 or more on
/// four drives by other formulas; with all arguments none had 0.7.
#[must_use]
pub fn arguments(effect: usize) -> &'static [Argument] {
    match &CATALOGUE[effect] {
        Declaration {
            formulas_differ: false,
            ..
        } => &[],
        Declaration {
            acts: Acts::Body, ..
        } => &[Argument::Speed],
        _ => &Argument::OF_WHEELS,
    }
}

/// The effects with shape freedom among those of some coefficients.
fn effects(problem: &Problem, on: &[usize]) -> Vec<usize> {
    let mut effects: Vec<usize> = on
        .iter()
        .filter(|place| matches!(problem.candidates[**place].target, Target::Model(_)))
        .map(|place| problem.candidates[*place].effect)
        .filter(|effect| CATALOGUE[*effect].formulas_differ)
        .collect();
    effects.sort_unstable();
    effects.dedup();
    effects
}

/// Appends the shapes of the effects that are on to a problem that was linearised there.
#[must_use]
pub fn append(problem: &Problem, on: &[usize], at: &Solution, system: &mut System) -> Shapes {
    let mut shapes = Shapes::default();
    let Some(forces) = force_columns(problem, &system.layout) else {
        return shapes;
    };
    for effect in effects(problem, on) {
        let places = system.segments.iter();
        let places: Vec<(usize, &[f64])> = places.map(|s| (s.index, s.edges.as_slice())).collect();
        let (each, deviations) = combinations(problem, effect, at, &system.layout, forces, &places);
        let (first, whole) = (system.parameters.len(), system.layout.whole());
        let columns = each
            .into_iter()
            .map(|binned| binned.insert_rows(0, whole, 0.0));
        let columns: Vec<DMatrix<f64>> = columns.collect();
        let parameters = deviations.iter().map(|deviation| FreeParameter {
            name: format!("shape of {}", CATALOGUE[effect].name),
            unit: "1",
            scale: Scale::Linear,
            acts_by: ActsBy::Coordinate,
            prior: Prior {
                median: 0.0,
                deviation: *deviation,
            },
            low: -FARTHEST,
            high: FARTHEST,
        });
        system.append(&columns, parameters.collect());
        shapes.unknowns.extend(first..system.parameters.len());
    }
    shapes
}

/// Derivatives of all samples by the shapes of the effects that are on; `None` where none of them has shape freedom.
#[must_use]
pub fn sample_columns(problem: &Problem, on: &[usize], at: &Solution) -> Option<FurtherColumns> {
    let effects = effects(problem, on);
    if effects.is_empty() {
        return None;
    }
    let layout = Layout::beside(problem, on);
    let forces = force_columns(problem, &layout)?;
    let tables = sensitivities(problem, &layout, at);
    let known = tables.iter().enumerate();
    let known = known.filter_map(|(k, table)| Some((k, table.as_ref()?)));
    let known: Vec<(usize, &SegmentTable)> = known.collect();
    let places: Vec<(usize, &[f64])> = known
        .iter()
        .map(|(k, table)| (*k, table.edges.as_slice()))
        .collect();
    let of_effects = effects.iter().map(|effect| {
        let (mut each, deviations) = combinations(problem, *effect, at, &layout, forces, &places);
        for combination in &mut each {
            for (mut column, deviation) in combination.column_iter_mut().zip(&deviations) {
                column *= *deviation;
            }
        }
        each
    });
    let of_effects: Vec<Vec<DMatrix<f64>>> = of_effects.collect();
    let count = of_effects
        .iter()
        .map(|each| each.first().map_or(0, DMatrix::ncols))
        .sum();
    let mut samples = vec![None; tables.len()];
    for (place, (index, table)) in known.iter().enumerate() {
        let channels = table.binned.iter().map(|binned| {
            let width = layout.per_bin() * (table.edges.len() - 1);
            let rows = binned.chunks_exact(width.max(1)).flat_map(|row| {
                let row = RowDVector::from_row_slice(row);
                let each = of_effects.iter().map(|each| &row * &each[place]);
                each.flat_map(|part| part.iter().copied().collect::<Vec<f64>>())
                    .collect::<Vec<f64>>()
            });
            rows.collect()
        });
        samples[*index] = Some(channels.collect());
    }
    Some(FurtherColumns {
        count,
        each: samples,
    })
}

/// How the shapes of an effect combine the forces in the time bins of some segments, a matrix for each, and the shapes'
/// prior deviations. Segments are given by their index and the edges of their time bins.
fn combinations(
    problem: &Problem,
    effect: usize,
    at: &Solution,
    layout: &Layout,
    forces: [usize; AXES],
    places: &[(usize, &[f64])],
) -> (Vec<DMatrix<f64>>, Vec<f64>) {
    let all = problem.candidates.coefficients.iter().enumerate();
    let own = all.filter(|(_, one)| one.effect == effect);
    let own: Vec<usize> = own.map(|(place, _)| place).collect();
    let each = places.par_iter().map(|(index, edges)| {
        let (data, start) = (&problem.segments[*index], &at.starts[*index]);
        acting(problem, &own, at, data, start, edges).unwrap_or_default()
    });
    let each: Vec<Vec<Acting>> = each.collect();
    let arguments = arguments(effect).len();
    let features = features(&each, arguments);
    let deviations = deviations(arguments);
    let columns = each.iter().zip(places).map(|(acting, (_, edges))| {
        let width = (edges.len() - 1) * layout.per_bin();
        let mut columns = DMatrix::zeros(width, deviations.len());
        for (time_bin, acting) in acting.iter().enumerate() {
            for (k, feature) in features(acting).iter().enumerate() {
                for (axis, force) in feature.iter().enumerate() {
                    columns[(time_bin * layout.per_bin() + forces[axis], k)] = *force;
                }
            }
        }
        columns
    });
    (columns.collect(), deviations)
}

/// Number of features of a component: itself, then times l and l^2 of each argument.
const fn of_component(arguments: usize) -> usize {
    1 + 2 * arguments
}

/// Places of the components themselves among their features.
pub fn components(arguments: usize) -> impl Iterator<Item = usize> {
    (0..COMPONENTS).map(move |component| component * of_component(arguments))
}

/// Prior deviations of an effect's shape: of each component its share, then exponent and bend by each argument.
#[must_use]
pub fn deviations(arguments: usize) -> Vec<f64> {
    let one = std::iter::once(DIRECTION).chain([EXPONENT, BEND].repeat(arguments));
    one.collect::<Vec<f64>>().repeat(COMPONENTS)
}

/// What an effect does in a time bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Acting {
    /// Its wrench as shares of the weight, the moment's of the weight times half the track.
    pub wrench: [f64; AXES],
    /// The wrench by component, and by what exerts it: each wheel, or the body.
    pub shares: Vec<Share>,
}

/// What one wheel, or the body, contributes to a component of an effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Share {
    /// The component.
    pub component: usize,
    /// The contribution.
    pub wrench: [f64; AXES],
    /// Logarithms of the effect's arguments there.
    pub arguments: Vec<f64>,
}

/// A time bin's wrench by shape: each component itself, then times l and l^2 of each argument.
pub fn features(
    each: &[Vec<Acting>],
    arguments: usize,
) -> impl Fn(&Acting) -> Vec<[f64; AXES]> + use<> {
    // Where the effect acts: weighted by its wrench.
    let mut sums = vec![0.0; arguments];
    let mut weights = 0.0;
    for share in each.iter().flatten().flat_map(|acting| &acting.shares) {
        let weight: f64 = share.wrench.iter().map(|w| w * w).sum();
        weights += weight;
        for (sum, argument) in sums.iter_mut().zip(&share.arguments) {
            *sum += weight * argument;
        }
    }
    let means: Vec<f64> = sums.iter().map(|sum| sum / weights.max(1e-300)).collect();
    move |acting| {
        let mut features = vec![[0.0; AXES]; COMPONENTS * of_component(arguments)];
        for share in &acting.shares {
            let logarithms = share.arguments.iter().zip(&means);
            let powers = logarithms.flat_map(|(at, mean)| {
                let l = (at - mean).clamp(-RANGE, RANGE);
                [l, l * l]
            });
            let factors = std::iter::once(1.0).chain(powers);
            let first = share.component * of_component(arguments);
            for (feature, factor) in features[first..].iter_mut().zip(factors) {
                for (sum, force) in feature.iter_mut().zip(&share.wrench) {
                    *sum += factor * force;
                }
            }
        }
        features
    }
}

/// Mean squares of the wrench that some coefficients exert along, across and about the vehicle, as shares of the weight,
/// of the moment of the weight times half the track.
#[must_use]
pub fn exerted(problem: &Problem, coefficients: &[usize], at: &Solution) -> [f64; AXES] {
    const BINS: usize = 20;
    let each = problem.segments.par_iter().zip(&at.starts);
    let each = each.map(|(segment, start)| {
        let length = segment.end - segment.start;
        let edges: Vec<f64> = (0..=BINS)
            .map(|k| segment.start + length * k as f64 / BINS as f64)
            .collect();
        acting(problem, coefficients, at, segment, start, &edges).unwrap_or_default()
    });
    let all: Vec<Acting> = each.flatten().collect();
    let count = all.len().max(1) as f64;
    std::array::from_fn(|axis| all.iter().map(|one| one.wrench[axis].powi(2)).sum::<f64>() / count)
}

/// What some coefficients do in each time bin of a segment. Arguments are those of the first one's effect. `None` if the
/// model cannot follow the segment.
fn acting(
    problem: &Problem,
    coefficients: &[usize],
    at: &Solution,
    segment: &Segment,
    start: &[f64; State::COUNT],
    edges: &[f64],
) -> Option<Vec<Acting>> {
    let off = problem.turned_off(at, coefficients.iter().copied());
    let path = follow(problem, at, segment, start, edges)?;
    let effects = coefficients.iter();
    let effects: Vec<usize> = effects.map(|k| problem.candidates[*k].effect).collect();
    between(problem, &effects, at, &off, segment, &path)
}

/// A segment's motion at the middles of its time bins.
#[derive(Debug, Clone)]
pub struct Motion {
    times: Vec<f64>,
    late: f64,
    trajectory: Trajectory,
}

/// The motion that a solution predicts for a segment. `None` if the model cannot follow it.
#[must_use]
pub fn follow(
    problem: &Problem,
    at: &Solution,
    segment: &Segment,
    start: &[f64; State::COUNT],
    edges: &[f64],
) -> Option<Motion> {
    let with = problem.specification(at, segment.recording).ok()?;
    let mut sensors: SensorValues = [0.0; SensorParameter::ALL.len()];
    let coordinates = &at.coefficients[segment.recording];
    for (coefficient, coordinate) in problem.candidates.coefficients.iter().zip(coordinates) {
        if let Target::Sensor(sensor) = coefficient.target {
            sensors[sensor.index()] = *coordinate;
        }
    }
    let late = sensors[SensorParameter::WheelLatency.index()];
    let middles = edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let times: Vec<f64> = std::iter::once(segment.start).chain(middles).collect();
    let request = Request {
        parameters: &[],
        start: &State::from_array(*start),
        course: &segment.course_here(&sensors),
        clock: segment.clock,
        drive: &segment.drive,
        wheel_latency: late,
        times: &times,
        time_bins: &[],
        derivatives: false,
    };
    let mut trajectory = Trajectory::default();
    ExactPredictor::new(with, Vec::new())
        .with_tolerance(problem.tolerance)
        .with_deadline(problem.deadline)
        .predict(&request, &mut trajectory)
        .ok()?;
    Some(Motion {
        times,
        late,
        trajectory,
    })
}

/// The wrench by which two solutions differ along a motion; that of what remembers along the motion of the first.
/// Arguments are those of the first of these effects. `None` if the model cannot follow it.
#[must_use]
pub fn between(
    problem: &Problem,
    effects: &[usize],
    with: &Solution,
    without: &Solution,
    segment: &Segment,
    motion: &Motion,
) -> Option<Vec<Acting>> {
    let memory = effects.iter().any(|effect| CATALOGUE[*effect].memory);
    let on_body = |effect: &usize| matches!(CATALOGUE[*effect].acts, Acts::Body);
    let on_wheels = !memory && !effects.iter().any(on_body);
    let arguments = effects
        .first()
        .map_or(&[][..], |effect| self::arguments(*effect));
    let with = problem.specification(with, segment.recording).ok()?;
    let without = problem.specification(without, segment.recording).ok()?;
    let Motion {
        times,
        late,
        trajectory: predicted,
    } = motion;
    let wheels = |time: f64| -> WheelSpeeds {
        let drive = &segment.drive;
        let row = drive.time.partition_point(|t| *t <= time + late);
        let row = row.saturating_sub(1);
        let speeds = WheelSpeeds::from(drive.wheel_speeds(row));
        let rates = WheelSpeeds::from(drive.wheel_accelerations(row));
        let since = (time + late - drive.time[row]).max(0.0);
        speeds.after(rates, since)
    };
    let [mut with, mut without] = [standing(&with)?, standing(&without)?];
    let vehicle = &problem.nominal.vehicle;
    let each = (1..times.len()).map(|k| {
        let state = State::from_array(predicted.states[k]);
        let speeds = wheels(times[k]);
        let clock = segment.clock + times[k];
        let [on, off] = [&mut with, &mut without].map(|simulation| {
            simulation.set_state(state).ok()?;
            simulation.set_time(clock).ok()?;
            simulation.set_wheel_speeds(speeds).ok()?;
            simulation.derivative().ok()
        });
        // What remembers acts only along the drive.
        let (on, off) = (if memory { Some(predicted.rates[k]) } else { on }, off?);
        let on = on?;
        let weight = vehicle.mass * GRAVITY;
        let inertia = vehicle.yaw_inertia / (vehicle.mass * GRAVITY * vehicle.half_track);
        let wrench = [
            (on[3] - off[3]) / GRAVITY,
            (on[4] - off[4]) / GRAVITY,
            (on[5] - off[5]) * inertia,
        ];
        let at = |argument: &Argument, wheel: Option<&Standing>| {
            value(*argument, &state, speeds, vehicle, wheel)
                .max(SMALLEST)
                .ln()
        };
        let mut shares = Vec::new();
        let mut share = |component: usize, wrench: [f64; AXES], arguments: &[f64]| {
            shares.push(Share {
                component,
                wrench,
                arguments: arguments.to_vec(),
            });
        };
        let [on, off] = [with.wrench().ok()?, without.wrench().ok()?];
        let wheels = on.wheels.iter().zip(&off.wheels).enumerate();
        if on_wheels {
            let mut rest = wrench;
            for (place, (on, off)) in wheels {
                let side = if place % 2 == 0 { 1.0 } else { -1.0 };
                let x = vehicle.row_positions[place / 2] - vehicle.com_offset;
                let y = side * vehicle.half_track;
                let here = Standing {
                    at: [x, y],
                    sinkage: off.sinkage,
                    slip: off.longitudinal_slip.abs(),
                };
                let here: Vec<f64> = arguments.iter().map(|a| at(a, Some(&here))).collect();
                let thrust = (on.torque - off.torque) / vehicle.wheel_radius / weight;
                let along = (on.force_x - off.force_x) / weight;
                let across = (on.force_y - off.force_y) / weight;
                let [left, ahead] = [y, x].map(|lever| lever / vehicle.half_track);
                for (component, wrench) in [
                    [along - thrust, 0.0, -left * (along - thrust)],
                    [thrust, 0.0, -left * thrust],
                    [0.0, across, ahead * across],
                ]
                .into_iter()
                .enumerate()
                {
                    share(component, wrench, &here);
                    for (rest, own) in rest.iter_mut().zip(&wrench) {
                        *rest -= own;
                    }
                }
            }
            // Moments of the wheels about their middles.
            share(LATERAL, rest, &[]);
        } else {
            let count = off.wheels.len() as f64;
            let sinkage = off.wheels.iter().map(|w| w.sinkage).sum::<f64>() / count;
            let argument = |argument: &Argument| match argument {
                Argument::Sinkage => sinkage.max(SMALLEST).ln(),
                _ => at(argument, None),
            };
            let here: Vec<f64> = arguments.iter().map(argument).collect();
            for axis in 0..AXES {
                let own = std::array::from_fn(|k| if k == axis { wrench[k] } else { 0.0 });
                share(axis, own, &here);
            }
        }
        Some(Acting { wrench, shares })
    });
    each.collect()
}

/// Where a wheel stands, and how.
struct Standing {
    at: [f64; 2],
    sinkage: f64,
    slip: f64,
}

fn standing(specification: &Specification) -> Option<Simulation> {
    VehicleModel::from_specification(specification)
        .ok()
        .map(Simulation::new)
}

/// An argument of an effect's formula at a wheel, or of the body as a whole; positive.
fn value(
    argument: Argument,
    state: &State,
    speeds: WheelSpeeds,
    vehicle: &Vehicle,
    wheel: Option<&Standing>,
) -> f64 {
    let sides = [(speeds.left, -1.0), (speeds.right, 1.0)];
    match (argument, wheel) {
        (Argument::Speed, Some(Standing { at: [x, y], .. })) => {
            (state.v_x - state.yaw_rate * y).hypot(state.v_y + state.yaw_rate * x)
        }
        (Argument::SideSpeed, Some(Standing { at: [x, _], .. })) => {
            (state.v_y + state.yaw_rate * x).abs()
        }
        (Argument::Row, Some(Standing { at: [x, _], .. })) => {
            (x / vehicle.row_positions[0].abs().max(1e-3)).exp()
        }
        (Argument::Row, None) => 1.0,
        (Argument::Slip, Some(wheel)) => wheel.slip,
        (Argument::Sinkage, wheel) => wheel.map_or(0.0, |wheel| wheel.sinkage),
        (Argument::Speed, None) => state.v_x.hypot(state.v_y),
        // Of the first and the last row, on average.
        (Argument::SideSpeed, None) => {
            let rows = &vehicle.row_positions;
            let lever = rows
                .first()
                .zip(rows.last())
                .map_or(0.0, |(a, b)| 0.5 * (a - b).abs());
            let row = |side: f64| (state.v_y + side * state.yaw_rate * lever).abs();
            0.5 * (row(1.0) + row(-1.0))
        }
        (Argument::Slip, None) => {
            let slip = |(omega, side): (f64, f64)| {
                let rim = vehicle.wheel_radius * omega;
                let speed = state.v_x + side * state.yaw_rate * vehicle.half_track;
                (rim - speed).abs() / rim.abs().max(speed.abs()).max(SMALLEST)
            };
            0.5 * sides.map(slip).iter().sum::<f64>()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_mixture_costs_a_formula_that_fits_half_of_its_probability() {
        assert!(mixed(0.0).abs() < 1e-12);
        assert!((mixed(-50.0) + EVEN).abs() < 1e-12);
        assert!((mixed(50.0) - 50.0 + EVEN).abs() < 1e-12);
        assert!((exactness(mixed(0.0)) - 0.5).abs() < 1e-12);
        assert!((exactness(mixed(-50.0)) - 1.0).abs() < 1e-12);
        assert!(exactness(mixed(20.0)) < 1e-8);
    }

    #[test]
    fn no_argument_leads_beyond_its_range() {
        let acting = |at: f64, wrench: f64| Acting {
            wrench: [wrench, 0.0, 0.0],
            shares: vec![Share {
                component: 0,
                wrench: [wrench, 0.0, 0.0],
                arguments: vec![at],
            }],
        };
        let each = vec![vec![acting(1.0, 2.0), acting(-20.0, 1e-9)]];
        let features = features(&each, 1);
        let along = |acting: &Acting| -> Vec<f64> {
            features(acting).iter().map(|feature| feature[0]).collect()
        };
        assert_eq!(along(&each[0][0])[..3], [2.0, 0.0, 0.0]);
        let along = along(&each[0][1]);
        assert!((along[1] / along[0] + RANGE).abs() < 1e-6);
        assert!((along[2] / along[0] - RANGE * RANGE).abs() < 1e-6);
    }
}
