//! Shape freedom: how far a mechanism's formula may differ from the catalogue's.
//!
//! An effect's name means a mechanism. The catalogue has one formula of it; the ground may obey another. So each
//! component a of an effect's wrench w_a(t), along, across and about the vehicle, may be
//!
//! ```text
//! w_a(t) (1 + d_a + sum over u of p_au l_u(t) + q_au l_u(t)^2),    l_u = ln(u / u_0)
//! ```
//!
//! with the arguments u that the effect declares (speed, slip, sinkage ...), u_0 their mean where the effect acts. p is
//! a difference of the exponent, q bends the power law towards saturation, d changes the direction. All have normal
//! priors around zero. The wrench is the difference between the accelerations with the effect and without it at the
//! fitted motion. Its signal follows from the sensitivities to a force in each time bin, so a shape costs no
//! prediction of its own, and Laplace's method integrates it out.

use super::screen::Projection;
use super::sensitivity::{Layout, sensitivities};
use super::system::{System, linearise};
use super::wrench::force_columns;
use crate::diagnosis::hypothesis::candidate::Target;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::effects::{Argument, CATALOGUE};
use crate::fit::exact::ExactPredictor;
use crate::fit::parameter::{FreeParameter, Prior, Scale};
use crate::fit::predictor::{Predictor, Request, Trajectory};
use crate::fit::problem::NoiseModel;
use crate::fit::segment::Segment;
use crate::fit::sensor::{SensorParameter, SensorValues};
use crate::simulation::{Simulation, State, WheelSpeeds};
use crate::vehicle::{GRAVITY, Specification, Vehicle, VehicleModel};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Components of the wrench.
const AXES: usize = 3;
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

/// Evidence of an even mixture of two models, the first of which has the evidence 0.
fn mixed(evidence: f64) -> f64 {
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

/// The effects with shape freedom among those of some coefficients.
fn effects(problem: &Problem, on: &[usize]) -> Vec<usize> {
    let mut effects: Vec<usize> = on
        .iter()
        .filter(|place| matches!(problem.candidates[**place].target, Target::Model(_)))
        .map(|place| problem.candidates[*place].effect)
        .filter(|effect| !CATALOGUE[*effect].varies_with.is_empty())
        .collect();
    effects.sort_unstable();
    effects.dedup();
    effects
}

/// Appends the shapes of the effects that are on to a problem that was linearised there.
#[must_use]
pub fn append(problem: &Problem, on: &[usize], at: &Solution, system: &mut System) -> Shapes {
    let mut shapes = Shapes::default();
    let Some(forces) = force_columns(problem, system) else {
        return shapes;
    };
    for effect in effects(problem, on) {
        let each = system.segments.par_iter().map(|segment| {
            let start = &at.starts[segment.index];
            let data = &problem.segments[segment.index];
            let all = problem.candidates.coefficients.iter().enumerate();
            let own = all.filter(|(_, one)| one.effect == effect);
            let own: Vec<usize> = own.map(|(place, _)| place).collect();
            acting(problem, &own, at, data, start, &segment.edges).unwrap_or_default()
        });
        let each: Vec<Vec<Acting>> = each.collect();
        let arguments = CATALOGUE[effect].varies_with;
        let features = features(&each, arguments.len());
        let deviations = deviations(arguments.len());
        let first = system.parameters.len();
        let columns = each.iter().zip(&system.segments).map(|(acting, segment)| {
            let mut columns = DMatrix::zeros(segment.gradient.len(), deviations.len());
            for (time_bin, acting) in acting.iter().enumerate() {
                let features = features(acting);
                for axis in 0..AXES {
                    let row =
                        system.layout.whole() + time_bin * system.layout.per_bin() + forces[axis];
                    for (k, feature) in features.iter().enumerate() {
                        columns[(row, axis * features.len() + k)] = acting.wrench[axis] * feature;
                    }
                }
            }
            columns
        });
        let columns: Vec<DMatrix<f64>> = columns.collect();
        let parameters = deviations.iter().map(|deviation| FreeParameter {
            name: format!("shape of {}", CATALOGUE[effect].name),
            unit: "1",
            scale: Scale::Linear,
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

/// Prior deviations of a component's shape: its direction, then exponent and bend by each argument; component by
/// component.
fn deviations(arguments: usize) -> Vec<f64> {
    let one = std::iter::once(DIRECTION).chain([EXPONENT, BEND].repeat(arguments));
    let one: Vec<f64> = one.collect();
    one.repeat(AXES)
}

/// What an effect does in a time bin.
#[derive(Debug, Clone, PartialEq)]
struct Acting {
    /// Its wrench as shares of the weight, the moment's of the weight times half the track.
    wrench: [f64; AXES],
    /// Logarithms of its arguments.
    arguments: Vec<f64>,
}

/// The factors of a time bin's shape: 1, then l and l^2 of each argument.
fn features(each: &[Vec<Acting>], arguments: usize) -> impl Fn(&Acting) -> Vec<f64> {
    // Where the effect acts: weighted by its wrench.
    let mut sums = vec![0.0; arguments];
    let mut weights = 0.0;
    for acting in each.iter().flatten() {
        let weight: f64 = acting.wrench.iter().map(|w| w * w).sum();
        weights += weight;
        for (sum, argument) in sums.iter_mut().zip(&acting.arguments) {
            *sum += weight * argument;
        }
    }
    let means: Vec<f64> = sums.iter().map(|sum| sum / weights.max(1e-300)).collect();
    move |acting| {
        let each = acting.arguments.iter().zip(&means).flat_map(|(at, mean)| {
            let l = (at - mean).clamp(-RANGE, RANGE);
            [l, l * l]
        });
        std::iter::once(1.0).chain(each).collect()
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
    let with = problem.specification(at, segment.recording).ok()?;
    let mut off = at.clone();
    for &place in coefficients {
        off.coefficients[segment.recording][place] = problem.candidates[place].off();
    }
    let effects = coefficients
        .iter()
        .map(|place| problem.candidates[*place].effect);
    let memory = effects.clone().any(|effect| CATALOGUE[effect].memory);
    let arguments = effects
        .clone()
        .next()
        .map_or(&[][..], |effect| CATALOGUE[effect].varies_with);
    let without = problem.specification(&off, segment.recording).ok()?;
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
    let mut predicted = Trajectory::default();
    ExactPredictor::new(with.clone(), Vec::new())
        .with_tolerance(problem.tolerance)
        .with_deadline(problem.deadline)
        .predict(&request, &mut predicted)
        .ok()?;
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
        let inertia = vehicle.yaw_inertia / (vehicle.mass * GRAVITY * vehicle.half_track);
        let sinkage = {
            let wheels = &without.wrench().ok()?.wheels;
            wheels.iter().map(|w| w.sinkage).sum::<f64>() / wheels.len() as f64
        };
        Some(Acting {
            wrench: [
                (on[3] - off[3]) / GRAVITY,
                (on[4] - off[4]) / GRAVITY,
                (on[5] - off[5]) * inertia,
            ],
            arguments: arguments
                .iter()
                .map(|argument| {
                    value(*argument, &state, speeds, vehicle, sinkage)
                        .max(SMALLEST)
                        .ln()
                })
                .collect(),
        })
    });
    each.collect()
}

fn standing(specification: &Specification) -> Option<Simulation> {
    VehicleModel::from_specification(specification)
        .ok()
        .map(Simulation::new)
}

/// An argument of an effect's formula, positive.
fn value(
    argument: Argument,
    state: &State,
    speeds: WheelSpeeds,
    vehicle: &Vehicle,
    sinkage: f64,
) -> f64 {
    let sides = [(speeds.left, -1.0), (speeds.right, 1.0)];
    match argument {
        Argument::Speed => state.v_x.hypot(state.v_y),
        // Of the first and the last row, on average.
        Argument::SideSpeed => {
            let rows = &vehicle.row_positions;
            let lever = rows
                .first()
                .zip(rows.last())
                .map_or(0.0, |(a, b)| 0.5 * (a - b).abs());
            let row = |side: f64| (state.v_y + side * state.yaw_rate * lever).abs();
            0.5 * (row(1.0) + row(-1.0))
        }
        Argument::Slip => {
            let slip = |(omega, side): (f64, f64)| {
                let rim = vehicle.wheel_radius * omega;
                let speed = state.v_x + side * state.yaw_rate * vehicle.half_track;
                (rim - speed).abs() / rim.abs().max(speed.abs()).max(SMALLEST)
            };
            0.5 * sides.map(slip).iter().sum::<f64>()
        }
        Argument::Sinkage => sinkage,
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
            arguments: vec![at],
        };
        let each = vec![vec![acting(1.0, 2.0), acting(-20.0, 0.0)]];
        let features = features(&each, 1);
        assert_eq!(features(&each[0][0]), [1.0, 0.0, 0.0]);
        assert_eq!(features(&each[0][1]), [1.0, -RANGE, RANGE * RANGE]);
    }
}
