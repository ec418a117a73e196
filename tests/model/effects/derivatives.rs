//! Exact derivatives against differences: of a whole drive, by its beginning and by every parameter.

use super::specification;
use std::ops::ControlFlow;
use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects};
use ugv_terrain::simulation::{SensitiveSimulation, Simulation, State, WheelSpeeds};
use ugv_terrain::vehicle::{ModelParameter, Specification, VehicleModel};

/// The derivative's integration errs by some 1e-3 of the largest (order 2, steps chosen for the
/// motion), the differences by the integrator's tolerance over their step.
const RELATIVE_TOLERANCE: f64 = 2e-2;
/// The integrator's own tolerance: its Jacobian, and with it its steps, come from the derivatives.
const MOTION_TOLERANCE: f64 = 1e-5;

pub const START: State = State {
    x: 0.0,
    y: 0.0,
    heading: 0.3,
    v_x: 1.2,
    v_y: 0.02,
    yaw_rate: 0.1,
};
const SECONDS: usize = 40;

fn speeds(time: f64) -> WheelSpeeds {
    WheelSpeeds {
        left: 5.5 + (1.7 * time).sin(),
        right: 6.0 - 0.8 * (1.1 * time).sin(),
    }
}

fn rates(time: f64) -> WheelSpeeds {
    let (from, to) = (speeds(time), speeds(time + 0.05));
    WheelSpeeds {
        left: (to.left - from.left) / 0.05,
        right: (to.right - from.right) / 0.05,
    }
}

/// The state after a drive of two seconds, the wheel speeds late by `delay`.
pub fn end(specification: &Specification, start: State) -> [f64; 6] {
    let mut drive = Simulation::new(VehicleModel::from_specification(specification).unwrap());
    drive.set_state(start).unwrap();
    for k in 0..SECONDS {
        let time = 0.05 * k as f64;
        drive.set_wheel_speeds(speeds(time)).unwrap();
        drive.set_wheel_accelerations(rates(time)).unwrap();
        // Steps so short that the integrator's error control does not chop the differences, each of them evaluated.
        for _ in 0..10 {
            drive
                .step_looking(0.005, |_| ControlFlow::Continue(()))
                .unwrap();
        }
    }
    drive.state().to_array()
}

pub fn sensitive(
    specification: &Specification,
    parameters: &[ModelParameter],
) -> SensitiveSimulation {
    driven(SensitiveSimulation::new(specification, parameters).unwrap())
}

fn driven(mut drive: SensitiveSimulation) -> SensitiveSimulation {
    drive.restart(0.0, START).unwrap();
    for k in 0..SECONDS {
        let time = 0.05 * k as f64;
        drive.drive(speeds(time), rates(time)).unwrap();
        for _ in 0..10 {
            drive.step(0.005).unwrap();
        }
    }
    drive
}

pub fn compare(what: &str, exact: [f64; 6], difference: [f64; 6]) {
    compare_within(RELATIVE_TOLERANCE, what, exact, difference);
}

/// Compares within a share of the largest.
fn compare_within(share: f64, what: &str, exact: [f64; 6], difference: [f64; 6]) {
    let largest = difference.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (a, b) in exact.iter().zip(difference) {
        assert!(
            (a - b).abs() <= share * largest + 1e-9,
            "{what}: {exact:?} {difference:?}"
        );
    }
}

pub fn difference(high: [f64; 6], low: [f64; 6], step: f64) -> [f64; 6] {
    std::array::from_fn(|k| (high[k] - low[k]) / (2.0 * step))
}

/// A drive that is differentiated.
pub struct Differentiated<'a> {
    pub on: &'a Specification,
    pub start: State,
    /// Where it ends with a specification from a start.
    pub end: &'a dyn Fn(&Specification, State) -> [f64; 6],
    /// Share of the largest by which derivatives and differences may part.
    pub tolerance: f64,
}

impl<'a> Differentiated<'a> {
    /// From [`START`], by differences that nothing chops.
    pub fn new(on: &'a Specification, end: &'a dyn Fn(&Specification, State) -> [f64; 6]) -> Self {
        Self {
            on,
            start: START,
            end,
            tolerance: RELATIVE_TOLERANCE,
        }
    }

    /// Compares the derivatives by these parameters, moved by steps of their own.
    pub fn by_parameters(
        &self,
        what: &str,
        exact: &SensitiveSimulation,
        parameters: &[(ModelParameter, f64)],
    ) {
        for (index, (parameter, step)) in parameters.iter().enumerate() {
            let moved = |by: f64| {
                let mut changed = self.on.clone();
                let value = parameter.get(self.on) + by;
                parameter.set(&mut changed, value).unwrap();
                (self.end)(&changed, self.start)
            };
            compare_within(
                self.tolerance,
                &format!("{what} {}", parameter.name()),
                exact.derivatives().by_parameter(index),
                difference(moved(*step), moved(-step), *step),
            );
        }
    }

    /// Compares the derivatives by some numbers of the start, moved by a step.
    pub fn by_beginning(
        &self,
        exact: &SensitiveSimulation,
        columns: std::ops::Range<usize>,
        step: f64,
    ) {
        let by_initial = exact.derivatives().by_initial();
        for column in columns {
            let moved = |by: f64| {
                let mut start = self.start.to_array();
                start[column] += by;
                (self.end)(self.on, State::from_array(start))
            };
            compare_within(
                self.tolerance,
                &format!("initial state {column}"),
                by_initial.column(column).into_owned().into(),
                difference(moved(step), moved(-step), step),
            );
        }
    }
}

/// Parameters with steps of a share of their values.
pub fn by_shares(
    share: f64,
    on: &Specification,
    parameters: &[ModelParameter],
) -> Vec<(ModelParameter, f64)> {
    let step = |p: &ModelParameter| (*p, share * p.get(on).abs());
    parameters.iter().map(step).collect()
}

#[test]
fn a_drive_is_differentiated_by_its_beginning() {
    let plain = specification("clayed_soil", Effects::NONE);
    Differentiated::new(&plain, &end).by_beginning(&sensitive(&plain, &[]), 0..6, 1e-3);
}

#[test]
fn a_drive_is_differentiated_by_the_soil_and_the_vehicle() {
    for terrain in ["dry_sand", "clayed_soil"] {
        let plain = specification(terrain, Effects::NONE);
        let parameters: Vec<ModelParameter> = ModelParameter::all()
            .filter(|p| !matches!(p, ModelParameter::Effect(_)))
            .collect();
        let exact = sensitive(&plain, &parameters);
        let steps = by_shares(1e-2, &plain, &parameters);
        Differentiated::new(&plain, &end).by_parameters(terrain, &exact, &steps);
    }
}

#[test]
fn a_drive_is_differentiated_by_every_effect() {
    for effect in CATALOGUE.iter().filter(|e| e.kind == EffectKind::Physics) {
        // A point within the ranges, all shapes at their defaults.
        let mut effects = Effects::NONE;
        for parameter in effect.parameters.iter().filter(|p| p.switches) {
            let value = match (effect.name, parameter.name) {
                ("terrain_change" | "left_right_soil" | "shear_anisotropy", _) => 1.3,
                ("tyre_compliance", _) => 18e3,
                ("wheel_radius", _) => 0.97,
                ("stress_peak", "a0") => 0.42,
                ("drag" | "rate_dependent_soil", _) => 40.0,
                ("drawbar", _) => 200.0,
                ("payload", _) => 60.0,
                ("transient_shear", _) => 1.0,
                ("multipass", _) => 0.8,
                ("grade" | "com_shift", _) => 0.06,
                ("residual_longitudinal" | "residual_lateral" | "residual_yaw", _) => 0.01,
                _ => 0.3,
            };
            let name = format!("{}.{}", effect.name, parameter.name);
            effects = effects.with(&name, value).unwrap();
        }
        if effect.name == "terrain_change" {
            effects = effects.with("terrain_change.position", 1.0).unwrap();
        }
        let on = specification("sandy_loam", effects);
        let parameters: Vec<ModelParameter> = effect
            .parameters
            .iter()
            .map(|p| ModelParameter::find(&format!("{}.{}", effect.name, p.name)).unwrap())
            .collect();
        let step = |parameter: &ModelParameter| {
            let ModelParameter::Effect(name) = *parameter else {
                unreachable!()
            };
            let declared = name.declaration().1;
            let least = 0.02 * (declared.high - declared.low).min(1.0);
            (*parameter, 1e-2 * parameter.get(&on).abs().max(least))
        };
        let steps: Vec<(ModelParameter, f64)> = parameters.iter().map(step).collect();
        Differentiated::new(&on, &end).by_parameters("", &sensitive(&on, &parameters), &steps);
    }
}

#[test]
fn a_drive_that_begins_with_settled_memory_is_differentiated() {
    let effects = Effects::NONE
        .with("multipass.memory", 0.8)
        .and_then(|e| e.with("transient_shear.relaxation", 1.0))
        .unwrap();
    let on = specification("sandy_loam", effects);
    // So short that most of what is seen is how the drive began.
    let short = |specification: &Specification, start: State| {
        let mut drive = Simulation::new(VehicleModel::from_specification(specification).unwrap());
        drive.set_state(start).unwrap();
        drive.set_wheel_speeds(speeds(0.0)).unwrap();
        drive.settle().unwrap();
        for _ in 0..20 {
            drive.step(0.005).unwrap();
        }
        drive.state().to_array()
    };
    let names = [
        "multipass.memory",
        "multipass.stiffness_ratio",
        "transient_shear.relaxation",
    ];
    let parameters = names.map(|name| ModelParameter::find(name).unwrap());
    let mut exact = SensitiveSimulation::new(&on, &parameters).unwrap();
    exact.restart(0.0, START).unwrap();
    exact.drive(speeds(0.0), WheelSpeeds::default()).unwrap();
    // Twice is as good as once.
    exact.settle().unwrap();
    exact.settle().unwrap();
    for _ in 0..20 {
        exact.step(0.005).unwrap();
    }
    let steps = by_shares(1e-2, &on, &parameters);
    let drive = Differentiated::new(&on, &short);
    drive.by_parameters("settled", &exact, &steps);
    drive.by_beginning(&exact, 3..6, 1e-3);
}

#[test]
fn a_drive_is_differentiated_by_a_delay_of_the_wheel_speeds() {
    let plain = specification("sandy_loam", Effects::NONE);
    let late = |delay: f64| {
        let mut drive = Simulation::new(VehicleModel::from_specification(&plain).unwrap());
        drive.set_state(START).unwrap();
        for k in 0..400 {
            let time = 0.005 * f64::from(k);
            let (from, to) = (speeds(time - delay), speeds(time + 0.005 - delay));
            drive.set_wheel_speeds(from).unwrap();
            let rate = |a: f64, b: f64| (b - a) / 0.005;
            let rates = WheelSpeeds {
                left: rate(from.left, to.left),
                right: rate(from.right, to.right),
            };
            drive.set_wheel_accelerations(rates).unwrap();
            drive.step(0.005).unwrap();
        }
        drive.state().to_array()
    };
    let found = difference(late(0.01), late(-0.01), 0.01);
    compare(
        "delay",
        sensitive(&plain, &[]).derivatives().by_wheel_delay(),
        found,
    );
}

#[test]
fn coarse_derivatives_are_nearly_the_same_of_the_same_motion() {
    let effects = Effects::NONE.with("left_right_soil.ratio", 1.3).unwrap();
    let specification = specification("clayed_soil", effects);
    let names = ["cohesion", "friction_angle", "sinkage_exponent"];
    let mut parameters = names
        .map(|name| ModelParameter::find(name).unwrap())
        .to_vec();
    parameters.push(ModelParameter::find("left_right_soil.ratio").unwrap());
    let exact = sensitive(&specification, &parameters);
    let coarse = SensitiveSimulation::new(&specification, &parameters).unwrap();
    let coarse = driven(coarse.with_coarse_derivatives());
    let (by_coarse, by_exact) = (coarse.state().to_array(), exact.state().to_array());
    for (a, b) in by_coarse.iter().zip(by_exact) {
        assert!(
            (a - b).abs() < MOTION_TOLERANCE,
            "{by_coarse:?} {by_exact:?}"
        );
    }
    for k in 0..parameters.len() {
        compare(
            "coarse",
            coarse.derivatives().by_parameter(k),
            exact.derivatives().by_parameter(k),
        );
        assert_ne!(
            coarse.derivatives().by_parameter(k),
            exact.derivatives().by_parameter(k)
        );
    }
}

#[test]
fn derivatives_within_a_step_are_those_of_a_drive_that_ends_there() {
    let specification = specification("dry_sand", Effects::NONE);
    let parameters = [ModelParameter::find("friction_angle").unwrap()];
    let begin = || {
        let mut drive = SensitiveSimulation::new(&specification, &parameters).unwrap();
        drive.restart(0.0, START).unwrap();
        drive.drive(speeds(0.0), rates(0.0)).unwrap();
        drive.step(0.5).unwrap();
        drive
    };
    let mut looking = begin();
    let (mut reached, mut within) = (0.0, Vec::new());
    looking
        .step_looking(1.0, |step| {
            reached += step.length();
            let middle = 0.5 * step.length();
            within.push((reached - middle, step.derivatives(middle).unwrap()));
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(within.len() > 3);
    for (time, found) in within {
        let mut stopping = begin();
        stopping.step(time).unwrap();
        let there = stopping.derivatives();
        compare("within", found.by_parameter(0), there.by_parameter(0));
        compare("within", found.by_wheel_delay(), there.by_wheel_delay());
    }
}

#[test]
fn a_parameter_may_be_asked_for_twice_and_in_gates_as_well() {
    let specification = specification("sandy_loam", Effects::NONE);
    let [friction, mass] =
        ["friction_angle", "mass"].map(|name| ModelParameter::find(name).unwrap());
    let alone = sensitive(&specification, &[friction]).derivatives();
    let close = |found: [f64; 6]| {
        let pairs = found.into_iter().zip(alone.by_parameter(0));
        pairs
            .into_iter()
            .all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + b.abs()))
    };
    let twice = sensitive(&specification, &[friction, mass, friction]).derivatives();
    for place in [0, 2] {
        assert!(close(twice.by_parameter(place)), "{place}");
    }
    // Without any gate there is one, which is the whole drive.
    let binned = SensitiveSimulation::with_time_bins(&specification, &[friction], &[friction], 0);
    let binned = driven(binned.unwrap()).derivatives();
    for place in [0, 1] {
        assert!(close(binned.by_parameter(place)), "{place}");
    }
    let mut drive = SensitiveSimulation::new(&specification, &[]).unwrap();
    assert!(drive.restart(f64::NAN, START).is_err());
}
