//! Replacements: which mechanism does what an accepted effect does?
//!
//! The likeliest fit has the motion, and nearly the soil, whatever its effect is called. There the problem is linearised
//! once more. The effect's wrench, or a sensor fault's share of the measurements, is taken away, and each mechanism of the
//! catalogue has to supply it, with its amplitudes and its shape freedom (see [`super::shape`]), while the soil follows.
//!
//! # Algorithm
//! 1. The motion of the fit, and on it the wrench w_p(t) of the effect to replace, or the signal of the sensor fault.
//! 2. For each mechanism the wrenches w_j(t) of its parameters at their typical values, one at a time. Those that do
//!    nothing alone, such as the place of a load, count by the differences d_k(t) that a standard deviation makes.
//! 3. Its signal is sum_j A_j w_j(t) (1 + sum_m a_m f_m(t)) + A_1 sum_k c_k d_k(t): amplitudes A_j around 1, c_k ~
//!    N(0, 1), shapes a_m as in `shape`.
//! 4. Soil and starts are projected out, the soil held near the fit's. Gauss–Newton for (A, c, a), and Laplace's method
//!    for the evidence.

use super::screen::Projection;
use super::sensitivity::{Layout, sensitivities};
use super::shape::{AXES, Acting, between, components, deviations, features, follow};
use super::system::{System, linearise};
use super::wrench::force_columns;
use crate::diagnosis::Subject;
use crate::diagnosis::hypothesis::candidate::Target;
use crate::diagnosis::hypothesis::likelihood::FittedHypothesis;
use crate::diagnosis::hypothesis::{Problem, Solution};
use crate::effects::CATALOGUE;
use crate::fit::parameter::{ActsBy, FreeParameter, Prior, Scale};
use crate::fit::problem::NoiseModel;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Standard deviation of an amplitude that may have either sign, in units of the typical one, and of the logarithm of
/// another one.
const AMPLITUDE: f64 = 1.0;
const LOG_AMPLITUDE: f64 = 1.2;
/// Standard deviation of an amplitude of one sign while it is fitted, and the smallest one that has a logarithm.
const WEAK: f64 = 10.0;
const SMALLEST: f64 = 1e-2;
/// The linearised problem holds while the soil's logarithms move by this.
const LINEAR: f64 = 1.0;
/// Gauss–Newton steps.
const STEPS: usize = 12;
/// A parameter whose wrench is below this share of the largest of its effect does nothing alone.
const ALONE: f64 = 1e-3;
/// No unknown comes near this.
const FARTHEST: f64 = 1e6;

/// A mechanism in the place of an effect.
#[derive(Debug, Clone)]
pub struct Replacement {
    /// Which.
    pub subject: Subject,
    /// Log odds relative to the replaced effect, without priors of the names.
    pub odds: f64,
    /// Its coefficients' coordinates.
    pub coordinates: Vec<(usize, f64)>,
    /// Step of the soil.
    pub soil: DVector<f64>,
}

/// A mechanism's wrenches: for each parameter that acts alone the wrench in each segment's time bins.
struct Mechanism {
    subject: Subject,
    coefficients: Vec<usize>,
    each: Vec<Vec<Vec<Acting>>>,
    arguments: usize,
    /// Columns of the linearised problem: by parameter and feature.
    columns: Vec<Vec<usize>>,
    /// Parameters that do nothing alone, and the wrenches that a standard deviation of each adds.
    further: Vec<usize>,
    differences: Vec<Vec<Vec<[f64; AXES]>>>,
    /// Their columns.
    further_columns: Vec<usize>,
}

/// What is replaced, segment by segment.
struct Replaced {
    /// The wrench in each time bin.
    wrench: Vec<Vec<Acting>>,
    /// The columns of a sensor fault, each with its size.
    fault: Vec<Vec<(usize, f64)>>,
}

/// The mechanisms that may replace some coefficients of a fit, the likeliest first, and what the linearised problem loses
/// if nothing does \[log likelihood\].
#[must_use]
pub fn replacements(
    problem: &Problem,
    fit: &FittedHypothesis,
    own: &[usize],
    noise: &NoiseModel,
) -> (Vec<Replacement>, f64) {
    found(problem, fit, own, noise).unwrap_or_default()
}

fn found(
    problem: &Problem,
    fit: &FittedHypothesis,
    own: &[usize],
    noise: &NoiseModel,
) -> Option<(Vec<Replacement>, f64)> {
    if own.is_empty() {
        return None;
    }
    let (on, at) = (&fit.coefficients, &fit.solution);
    let layout = Layout::beside(problem, on);
    let tables = sensitivities(problem, &layout, at);
    let mut system = linearise(problem, &layout, &tables, at, noise);
    drop(tables);
    let forces = force_columns(problem, &system.layout)?;
    for soil in system.soil() {
        system.precision[soil] += LINEAR.powi(-2);
    }
    let off = problem.turned_off(at, own.iter().copied());
    let effects: Vec<usize> = own.iter().map(|k| problem.candidates[*k].effect).collect();
    let motions: Vec<_> = system
        .segments
        .par_iter()
        .map(|segment| {
            let data = &problem.segments[segment.index];
            follow(problem, at, data, &at.starts[segment.index], &segment.edges)
        })
        .collect();
    let wrench = |effects: &[usize], with: &Solution, without: &Solution| -> Vec<Vec<Acting>> {
        let memory = effects.iter().any(|effect| CATALOGUE[*effect].memory);
        let each = system.segments.par_iter().zip(&motions);
        let each = each.map(|(segment, motion)| {
            let data = &problem.segments[segment.index];
            let start = &at.starts[segment.index];
            let own = memory.then(|| follow(problem, with, data, start, &segment.edges));
            let motion = own.as_ref().unwrap_or(motion).as_ref()?;
            between(problem, effects, with, without, data, motion)
        });
        each.map(Option::unwrap_or_default).collect()
    };
    let sensors = own.iter().copied();
    let sensors: Vec<usize> = sensors
        .filter(|k| matches!(problem.candidates[*k].target, Target::Sensor(_)))
        .collect();
    let fault = system.segments.iter().map(|segment| {
        let at = &at.coefficients[segment.recording];
        let size = |k: &usize| at[*k] - problem.candidates[*k].off();
        let columns = sensors.iter();
        columns.map(|k| (system.layout.soil + k, size(k))).collect()
    });
    let replaced = Replaced {
        wrench: wrench(&effects, at, &off),
        fault: fault.collect(),
    };
    let subjects = problem.candidates.subjects.iter().copied();
    let mut mechanisms: Vec<Mechanism> = subjects
        .filter_map(|subject| {
            let coefficients: Vec<usize> = problem.candidates.of(subject).collect();
            let model = coefficients
                .iter()
                .all(|k| matches!(problem.candidates[*k].target, Target::Model(_)));
            let other = coefficients
                .iter()
                .any(|k| on.contains(k) && !own.contains(k));
            if !model || other || coefficients.is_empty() {
                return None;
            }
            let effect = problem.candidates[coefficients[0]].effect;
            let each = coefficients.iter().map(|k| {
                let mut with = off.clone();
                for recording in &mut with.coefficients {
                    recording[*k] = typical(problem, *k);
                }
                wrench(&[effect], &with, &off)
            });
            let each: Vec<Vec<Vec<Acting>>> = each.collect();
            let size = |one: &Vec<Vec<Acting>>| -> f64 {
                let all = one.iter().flatten().flat_map(|acting| acting.wrench);
                all.map(|w| w * w).sum()
            };
            let largest = each.iter().map(size).fold(0.0, f64::max);
            let alone: Vec<bool> = each
                .iter()
                .map(|one| size(one) > ALONE * ALONE * largest)
                .collect();
            let chosen = |wanted: bool| -> Vec<usize> {
                let all = coefficients.iter().zip(&alone);
                all.filter(|(_, alone)| **alone == wanted)
                    .map(|(k, _)| *k)
                    .collect()
            };
            let (acting, further) = (chosen(true), chosen(false));
            let mut on = off.clone();
            let set = |solution: &mut Solution, k: usize, to: f64| {
                for recording in &mut solution.coefficients {
                    recording[k] = to;
                }
            };
            for k in acting.iter().take(1) {
                set(&mut on, *k, typical(problem, *k));
            }
            let base = if further.is_empty() {
                Vec::new()
            } else {
                wrench(&[effect], &on, &off)
            };
            let differences = further.iter().map(|k| {
                let about = &problem.candidates[*k];
                let (low, high) = about.parameter.bounds();
                let mut moved = on.clone();
                set(
                    &mut moved,
                    *k,
                    (about.typical + about.parameter.prior.deviation).clamp(low, high),
                );
                let moved = wrench(&[effect], &moved, &off);
                let of_segment = |(a, b): (&Vec<Acting>, &Vec<Acting>)| {
                    let pairs = a.iter().zip(b);
                    pairs
                        .map(|(a, b)| std::array::from_fn(|axis| a.wrench[axis] - b.wrench[axis]))
                        .collect()
                };
                moved.iter().zip(&base).map(of_segment).collect()
            });
            let differences: Vec<Vec<Vec<[f64; AXES]>>> = differences.collect();
            let each = each.into_iter().zip(&alone);
            let each = each.filter(|(_, alone)| **alone).map(|(one, _)| one);
            Some(Mechanism {
                subject,
                each: each.collect(),
                coefficients: acting,
                arguments: super::shape::arguments(effect).len(),
                columns: Vec::new(),
                further,
                differences,
                further_columns: Vec::new(),
            })
        })
        .filter(|mechanism| !mechanism.coefficients.is_empty())
        .collect();
    let first = system.parameters.len();
    let columns = append(&mut system, forces, &replaced, &mut mechanisms);
    let mut on_unknowns: Vec<usize> = on
        .iter()
        .filter(|k| !own.contains(k))
        .flat_map(|k| system.unknowns(*k))
        .collect();
    on_unknowns.sort_unstable();
    let projection = Projection::over_all(&system, &on_unknowns)?;
    let all: Vec<usize> = (first..first + columns).collect();
    let projected = projection.of(&all);
    let (matrix, gradient) = (projected.matrix, projected.gradient);
    // Without the effect: a step of what it does to zero.
    let without = DVector::from_fn(columns, |k, _| if k == 0 { -1.0 } else { 0.0 });
    let pull = &gradient - &matrix * &without;
    let removed = 0.5 * matrix[(0, 0)] + gradient[0];
    let occam = {
        let unknowns: Vec<usize> = own.iter().flat_map(|k| system.unknowns(*k)).collect();
        let projected = projection.of(&unknowns);
        let precision = projection.precisions(&unknowns);
        let count = unknowns.len();
        let scaled = DMatrix::from_fn(count, count, |i, j| {
            projected.matrix[(i, j)] / (precision[i] * precision[j]).sqrt()
                + f64::from(u8::from(i == j))
        });
        let prior = unknowns
            .iter()
            .map(|u| system.pull[*u].powi(2) / system.precision[*u]);
        0.5 * (prior.sum::<f64>() + scaled.determinant().max(1.0).ln())
    };
    let settled = projection.inverse().1;
    let mut found: Vec<Replacement> = mechanisms
        .iter()
        .filter_map(|mechanism| {
            let (loss, amplitudes, signal) = fitted(problem, mechanism, &matrix, &pull)?;
            let step = &without + &signal;
            let follows = &settled + projection.following(&all, &step);
            let alone = mechanism.coefficients.len();
            let all = mechanism.coefficients.iter().chain(&mechanism.further);
            let coordinates = all.zip(&amplitudes).enumerate().map(|(place, (k, a))| {
                let about = &problem.candidates[*k];
                let (low, high) = about.parameter.bounds();
                let to = if place < alone {
                    about.off() + a * (typical(problem, *k) - about.off())
                } else {
                    about.typical + a * about.parameter.prior.deviation
                };
                (*k, to.clamp(low, high))
            });
            Some(Replacement {
                subject: mechanism.subject,
                odds: occam - removed - loss,
                coordinates: coordinates.collect(),
                soil: follows.rows(0, problem.soil.len()).into_owned(),
            })
        })
        .collect();
    found.sort_by(|a, b| b.odds.total_cmp(&a.odds));
    Some((found, removed))
}

/// The coordinate that the catalogue expects, or a standard deviation from "off" where that is the likeliest.
fn typical(problem: &Problem, coefficient: usize) -> f64 {
    let about = &problem.candidates[coefficient];
    let off = about.off();
    if (about.typical - off).abs() > 1e-9 {
        about.typical
    } else {
        off + about.parameter.prior.deviation
    }
}

/// Appends what is replaced, then each mechanism's components with their features. The number of columns.
fn append(
    system: &mut System,
    forces: [usize; AXES],
    replaced: &Replaced,
    mechanisms: &mut [Mechanism],
) -> usize {
    let mut count = 1;
    for mechanism in mechanisms.iter_mut() {
        let features = deviations(mechanism.arguments).len();
        let columns = mechanism.coefficients.iter().map(|_| {
            let first = count;
            count += features;
            (first..count).collect()
        });
        mechanism.columns = columns.collect();
        mechanism.further_columns = (count..count + mechanism.further.len()).collect();
        count += mechanism.further.len();
    }
    let row = |system: &System, time_bin: usize, axis: usize| {
        system.layout.whole() + time_bin * system.layout.per_bin() + forces[axis]
    };
    let mut combinations: Vec<DMatrix<f64>> = system
        .segments
        .iter()
        .enumerate()
        .map(|(place, segment)| {
            let mut columns = DMatrix::zeros(segment.gradient.len(), count);
            for (time_bin, acting) in replaced.wrench[place].iter().enumerate() {
                for axis in 0..AXES {
                    columns[(row(system, time_bin, axis), 0)] = acting.wrench[axis];
                }
            }
            for (row, size) in &replaced.fault[place] {
                columns[(*row, 0)] = *size;
            }
            columns
        })
        .collect();
    for mechanism in mechanisms.iter() {
        for (one, places) in mechanism.each.iter().zip(&mechanism.columns) {
            let features = features(one, mechanism.arguments);
            for (segment, columns) in one.iter().zip(&mut combinations) {
                for (time_bin, acting) in segment.iter().enumerate() {
                    for (feature, place) in features(acting).iter().zip(places) {
                        for (axis, force) in feature.iter().enumerate() {
                            columns[(row(system, time_bin, axis), *place)] = *force;
                        }
                    }
                }
            }
        }
    }
    for mechanism in mechanisms.iter() {
        for (one, place) in mechanism.differences.iter().zip(&mechanism.further_columns) {
            for (segment, columns) in one.iter().zip(&mut combinations) {
                for (time_bin, wrench) in segment.iter().enumerate() {
                    for axis in 0..AXES {
                        columns[(row(system, time_bin, axis), *place)] = wrench[axis];
                    }
                }
            }
        }
    }
    let parameters = (0..count).map(|_| FreeParameter {
        name: "wrench".into(),
        unit: "1",
        scale: Scale::Linear,
        acts_by: ActsBy::Coordinate,
        prior: Prior {
            median: 0.0,
            deviation: FARTHEST,
        },
        low: -FARTHEST,
        high: FARTHEST,
    });
    system.append(&combinations, parameters.collect());
    count
}

/// Negative log evidence of a mechanism, its amplitudes and further parameters, and its signal by the columns.
fn fitted(
    problem: &Problem,
    mechanism: &Mechanism,
    matrix: &DMatrix<f64>,
    pull: &DVector<f64>,
) -> Option<(f64, Vec<f64>, DVector<f64>)> {
    let amplitudes = mechanism.coefficients.len();
    let deviations = if mechanism.arguments == 0 {
        Vec::new()
    } else {
        deviations(mechanism.arguments)
    };
    let shapes = deviations.len();
    let count = amplitudes + shapes + mechanism.further.len();
    let one_sided = |k: usize| {
        let about = &problem.candidates[mechanism.coefficients[k]];
        let (low, high) = about.parameter.bounds();
        let away = (typical(problem, mechanism.coefficients[k]) - about.off()).abs();
        !(low < about.off() - away && about.off() + away < high)
    };
    let mut precision = DVector::from_fn(count, |k, _| {
        let deviation = if k < amplitudes {
            if one_sided(k) { WEAK } else { AMPLITUDE }
        } else if k >= amplitudes + shapes {
            1.0
        } else {
            deviations[k - amplitudes]
        };
        deviation.powi(-2)
    });
    let width = matrix.nrows();
    // The signal by the columns, and its derivatives.
    let signal = |x: &DVector<f64>| {
        let mut signal = DVector::zeros(width);
        let mut derivative = DMatrix::zeros(width, count);
        for (j, places) in mechanism.columns.iter().enumerate() {
            for component in components(mechanism.arguments) {
                signal[places[component]] += x[j];
                derivative[(places[component], j)] += 1.0;
            }
            for (place, k) in places.iter().zip(amplitudes..amplitudes + shapes) {
                signal[*place] += x[j] * x[k];
                derivative[(*place, j)] += x[k];
                derivative[(*place, k)] += x[j];
            }
        }
        for (place, column) in mechanism.further_columns.iter().enumerate() {
            let k = amplitudes + shapes + place;
            signal[*column] += x[0] * x[k];
            derivative[(*column, 0)] += x[k];
            derivative[(*column, k)] += x[0];
        }
        (signal, derivative)
    };
    let fitting = precision.clone();
    let loss = |x: &DVector<f64>, signal: &DVector<f64>| -> f64 {
        let prior: f64 = x.iter().zip(&fitting).map(|(x, p)| p * x * x).sum();
        -pull.dot(signal) + 0.5 * signal.dot(&(matrix * signal)) + 0.5 * prior
    };
    let mut x = DVector::zeros(count);
    // Shapes have no derivative where there is no amplitude: that comes first.
    for k in 0..amplitudes {
        x[k] = 1e-3;
    }
    let (mut s, mut derivative) = signal(&x);
    let mut best = loss(&x, &s);
    let mut held: Vec<usize> = Vec::new();
    for turn in 0..STEPS {
        let free: Vec<usize> = (0..count)
            .filter(|k| !held.contains(k) && (turn > 0 || *k < amplitudes))
            .collect();
        let bent = matrix * &derivative;
        let normal = derivative.tr_mul(&bent) + DMatrix::from_diagonal(&precision);
        let slope = derivative.tr_mul(&(pull - matrix * &s)) - precision.component_mul(&x);
        let part = normal.select_rows(&free).select_columns(&free);
        let solved = part.cholesky()?.solve(&slope.select_rows(&free));
        let mut share = 1.0;
        let before = best;
        while share > 1e-3 {
            let mut other = x.clone();
            for (k, step) in free.iter().zip(solved.iter()) {
                other[*k] += share * step;
            }
            for k in 0..amplitudes {
                if one_sided(k) && other[k] < 0.0 {
                    other[k] = 0.0;
                }
            }
            let (signal, slope) = signal(&other);
            let value = loss(&other, &signal);
            if value < best {
                (x, s, derivative, best) = (other, signal, slope, value);
                break;
            }
            share *= 0.5;
        }
        held = (0..amplitudes)
            .filter(|k| one_sided(*k) && x[*k] <= 0.0)
            .collect();
        if before - best < 0.01 && turn > 1 {
            break;
        }
    }
    for k in (0..amplitudes).filter(|k| one_sided(*k)) {
        let size = x[k].max(SMALLEST);
        best += 0.5 * ((size.ln() / LOG_AMPLITUDE).powi(2) - fitting[k] * x[k] * x[k]);
        precision[k] = (LOG_AMPLITUDE * size).powi(-2);
    }
    let normal = derivative.tr_mul(&(matrix * &derivative));
    let scaled = DMatrix::from_fn(count, count, |i, j| {
        normal[(i, j)] / (precision[i] * precision[j]).sqrt() + f64::from(u8::from(i == j))
    });
    let determinant = 2.0 * scaled.cholesky()?.l_dirty().diagonal().map(f64::ln).sum();
    let all = (0..amplitudes)
        .chain(amplitudes + shapes..count)
        .map(|k| x[k])
        .collect();
    Some((best + 0.5 * determinant, all, s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::hypothesis::likelihood::fit_hypothesis;
    use crate::diagnosis::testing::{driven, named, on, refitted, with_effects};
    use crate::recording::{Channel, Recording, Run, Series};

    #[test]
    fn a_mechanism_replaces_itself_at_its_size_and_others_fall_behind() {
        let nominal = on("sandy_loam");
        let truth = with_effects(&nominal, r#"{"drag": {"coefficient": 150}}"#);
        let recordings = [driven(&truth, "slalom")];
        let (stage, noise) = refitted(&nominal, &recordings);
        let problem = &stage.problem;
        let own: Vec<usize> = problem.candidates.of(named("drag")).collect();
        let mut initial = stage.fit.solution.clone();
        for recording in &mut initial.coefficients {
            recording[own[0]] = problem.candidates[own[0]].typical;
        }
        let fit = fit_hypothesis(problem, &own, &initial, &noise).unwrap();
        let (all, removed) = replacements(problem, &fit, &own, &noise);
        assert!(removed > 20.0, "{removed}");
        let find = |name: &str| all.iter().find(|one| one.subject == named(name)).unwrap();
        let first = find("drag");
        // At one speed a wedge before the wheels is as good. Time bins leave some of it.
        let all_of_it = format!("{removed} {all:?}");
        assert!(first.odds > all[0].odds - 0.1 * removed, "{all_of_it}");
        assert!(first.odds.abs() < 0.2 * removed, "{all_of_it}");
        let size = fit.solution.coefficients[0][own[0]];
        let found = first.coordinates[0].1;
        // Amplitude and direction share a component: together they have the size.
        assert!((0.4..2.5).contains(&(found / size)), "{found} {size}");
        // A mechanism that cannot do it loses much of it.
        let other = find("left_right_soil").odds;
        assert!(other < first.odds - 0.3 * removed, "{all_of_it}");
        // A sensor fault exerts nothing: what it does to the measurements is to be supplied.
        let arm = |run: &Run| {
            let [x, y, heading] = [Channel::X, Channel::Y, Channel::Heading].map(|channel| {
                let samples = run.series(channel).unwrap().samples();
                samples.collect::<Vec<(f64, f64)>>()
            });
            let shifted = |position: &[(f64, f64)], by: fn(f64) -> f64| -> Series {
                let pairs = position.iter().zip(&heading);
                pairs
                    .map(|((t, p), (_, h))| (*t, p + 0.2 * by(*h)))
                    .collect()
            };
            run.clone()
                .with(Channel::X, shifted(&x, f64::cos))
                .with(Channel::Y, shifted(&y, f64::sin))
        };
        let plain = driven(&nominal, "slalom");
        let ahead = [Recording {
            runs: plain.runs.iter().map(arm).collect(),
            ..plain
        }];
        let (stage, noise) = refitted(&nominal, &ahead);
        let problem = &stage.problem;
        let own: Vec<usize> = problem.candidates.of(named("lever_arm")).collect();
        let fit = fit_hypothesis(problem, &own, &stage.fit.solution, &noise).unwrap();
        let (all, removed) = replacements(problem, &fit, &own, &noise);
        assert!(removed > 20.0, "{removed}");
        assert!(all.iter().all(|one| one.odds < -100.0), "{removed} {all:?}");
        // Nothing replaces nothing.
        assert!(replacements(problem, &fit, &[], &noise).0.is_empty());
    }
}
