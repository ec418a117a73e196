//! What the model costs, in seconds of the processor. `scripts/tools/bench.sh` runs it beside the FMU and a NumPy
//! peer, and prints the table.
//!
//! Its argument is a folder. It writes there the drive (`drive.csv`), before all else, and what it measured (`model.json`).

mod clock;
mod drive;

use clock::compare;
use drive::{SECONDS, mixed};
use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x8};
use serde_json::{Map, Value, json};
use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;
use ugv_terrain::contact::{Regularisation, Resolution};
use ugv_terrain::effects::{Acts, CATALOGUE, EffectKind, Effects, ParameterDeclaration};
use ugv_terrain::effects::{ParameterName, Prior};
use ugv_terrain::scalar::Real;
use ugv_terrain::simulation::batch::{Rollout, WheelSpeedTable, trajectories};
use ugv_terrain::simulation::{SensitiveSimulation, Simulation, State};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Balance, ModelParameter, Motion, Specification, Vehicle};
use ugv_terrain::vehicle::{VehicleModel, Wrench};

/// The soil of the comparisons that need only one.
const SOIL: &str = "clayed_soil";

fn main() {
    let folder = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let folder = PathBuf::from(folder.expect("the folder for the results"));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("drive.csv"), drive::csv()).expect("a file");
    let measured = json!({
        "drive_seconds": SECONDS,
        "wheels": Vehicle::tran2007().wheel_count(),
        "soils": by_soil(),
        "effects": effects(),
        "batch": batch(),
        "nodes": nodes(),
        "rows": rows(),
        "lanes": lanes(),
    });
    let text = serde_json::to_string_pretty(&measured).expect("numbers");
    std::fs::write(folder.join("model.json"), text).expect("a file");
}

fn soil(name: &str) -> Terrain {
    Terrain::preset(name).expect("one of the paper's terrains")
}

fn plain(name: &str) -> VehicleModel {
    VehicleModel::new(Vehicle::tran2007(), soil(name)).expect("the paper's vehicle")
}

/// The motions of the golden wrenches, with their soils.
fn golden() -> Vec<(String, Motion)> {
    let document: Value = serde_json::from_str(include_str!("../golden/wrenches.json")).unwrap();
    let state = |value: &Value| {
        let number = |key: &str| value[key].as_f64().unwrap();
        let motion = Motion {
            v_x: number("V_X"),
            v_y: number("V_Y"),
            yaw_rate: number("yaw_rate"),
            omega_left: number("omega_left"),
            omega_right: number("omega_right"),
        };
        (value["terrain"].as_str().unwrap().to_owned(), motion)
    };
    document["states"]
        .as_array()
        .unwrap()
        .iter()
        .map(state)
        .collect()
}

/// Solves a motion from scratch: nothing is known of the answer.
fn from_scratch(model: &VehicleModel, motion: &Motion, balance: &mut Balance, wrench: &mut Wrench) {
    *balance = Balance::new(model);
    model.solve(black_box(motion), balance).unwrap();
    balance.wrench(model, motion, wrench);
}

/// Wrenches from scratch of all motions, as a work to measure.
fn wrenches<'a>(model: &'a VehicleModel, motions: &'a [Motion]) -> Box<dyn FnMut() + 'a> {
    let (mut balance, mut wrench) = (Balance::new(model), Wrench::for_model(model));
    Box::new(move || {
        for motion in motions {
            from_scratch(model, motion, &mut balance, &mut wrench);
        }
    })
}

/// The simulation at a motion, evaluated.
fn at(model: &VehicleModel, motion: &Motion) -> Simulation {
    let mut simulation = Simulation::new(model.clone());
    let state = State {
        v_x: motion.v_x,
        v_y: motion.v_y,
        yaw_rate: motion.yaw_rate,
        ..State::default()
    };
    let speeds = [motion.omega_left, motion.omega_right];
    simulation.set_wheel_speeds(speeds.into()).unwrap();
    simulation.set_state(state).unwrap();
    simulation.wrench().unwrap();
    simulation
}

/// A drive from rest along a table.
fn rollout(model: &VehicleModel, inputs: &Arc<WheelSpeedTable>) -> Rollout {
    Rollout {
        simulation: Simulation::new(model.clone()),
        inputs: inputs.clone(),
    }
}

/// The drive as a work to measure.
fn driven(start: Rollout) -> Box<dyn FnMut()> {
    Box::new(move || start.clone().run(|_, _| Ok(())).unwrap())
}

/// The drive with derivatives as a work to measure.
fn sensitive<'a>(
    start: &'a SensitiveSimulation,
    inputs: &'a WheelSpeedTable,
) -> Box<dyn FnMut() + 'a> {
    Box::new(move || {
        let mut drive = start.clone();
        let rows = inputs
            .time()
            .windows(2)
            .zip(inputs.wheel_speeds().windows(2));
        for (time, speeds) in rows {
            let seconds = time[1] - time[0];
            let rates = [
                (speeds[1].left - speeds[0].left) / seconds,
                (speeds[1].right - speeds[0].right) / seconds,
            ];
            drive.drive(speeds[0], rates.into()).unwrap();
            drive.step(seconds).unwrap();
        }
        black_box(drive.derivatives().by_parameter(0));
    })
}

/// All parameters of soil and vehicle, and one of every effect that is physics.
fn directions() -> Vec<ModelParameter> {
    let mut effects = Vec::new();
    let mut list = Vec::new();
    for parameter in ModelParameter::all() {
        if let ModelParameter::Effect(name) = parameter {
            let (effect, declared) = name.declaration();
            let is_next = declared.switches && effect.kind == EffectKind::Physics;
            if !is_next || effects.contains(&effect.name) {
                continue;
            }
            effects.push(effect.name);
        }
        list.push(parameter);
    }
    list
}

/// Wrench, Jacobian, drives and derivatives on each soil.
fn by_soil() -> Value {
    let golden = golden();
    let directions = directions();
    let mut soils = Map::new();
    for name in Terrain::PRESETS {
        let model = plain(name);
        let of_soil = golden.iter().filter(|(soil, _)| soil == name);
        let motions: Vec<Motion> = of_soil.map(|(_, motion)| *motion).collect();
        let count = motions.len() as f64;
        let mut simulations: Vec<_> = motions.iter().map(|motion| at(&model, motion)).collect();
        let mut balances = vec![Balance::new(&model); motions.len()];
        let mut wrench = Wrench::for_model(&model);
        let [long, middle, short] = [1, 10, 100].map(|parts| Arc::new(mixed(SECONDS, parts)));
        let derived = Specification::plain(Vehicle::tran2007(), soil(name));
        let derived = SensitiveSimulation::new(&derived, &directions).unwrap();
        let costs = compare(&mut [
            wrenches(&model, &motions),
            Box::new(|| {
                for simulation in &mut simulations {
                    black_box(simulation.jacobian().unwrap());
                }
            }),
            Box::new(|| {
                for (motion, balance) in motions.iter().zip(&mut balances) {
                    model.solve(black_box(motion), balance).unwrap();
                    balance.wrench(&model, motion, &mut wrench);
                }
            }),
            driven(rollout(&model, &long)),
            driven(rollout(&model, &middle)),
            driven(rollout(&model, &short)),
            sensitive(&derived, &long),
        ]);
        let costs: Vec<f64> = costs.iter().map(|cost| cost.processor).collect();
        let mut end = rollout(&model, &long);
        end.run(|_, _| Ok(())).unwrap();
        let (state, counters) = (end.simulation.state(), end.simulation.counters());
        let measured = json!({
            "golden_states": count,
            "wrench": costs[0] / count,
            "jacobian": costs[1] / count,
            "near": costs[2] / count,
            "drives": {"100": costs[3], "10": costs[4], "1": costs[5]},
            "derivatives": costs[6],
            "directions": directions.len(),
            "steps": counters.steps,
            "evaluations": counters.evaluations,
            "jacobians": counters.jacobians,
            "end": [state.x, state.y, state.heading],
        });
        soils.insert((*name).to_owned(), measured);
    }
    Value::Object(soils)
}

/// The centre of a parameter's prior; where that is off, a standard deviation beside it.
fn usual(parameter: &ParameterDeclaration) -> f64 {
    let (centre, beside) = match parameter.prior {
        Prior::Normal { mean, deviation } => (mean, mean + deviation),
        Prior::LogNormal { median, deviation } => (median, median * deviation.exp()),
    };
    let is_off = centre == parameter.default;
    let value = if is_off { beside } else { centre };
    value.clamp(parameter.low, parameter.high)
}

/// The effects that a filter lets through, at their usual size.
fn with_effects(is_on: impl Fn(&str) -> bool) -> VehicleModel {
    let mut effects = Effects::NONE;
    for name in ParameterName::all() {
        let (effect, parameter) = name.declaration();
        if effect.kind == EffectKind::Physics && parameter.switches && is_on(effect.name) {
            let value = usual(parameter);
            effects.set(name, value).unwrap();
        }
    }
    let specification = Specification::plain(Vehicle::tran2007(), soil(SOIL));
    VehicleModel::from_specification(&specification.with_effects(effects)).unwrap()
}

/// Wrench and drive with each effect, beside the model without.
fn effects() -> Value {
    let motions: Vec<Motion> = golden().into_iter().map(|(_, motion)| motion).collect();
    let inputs = Arc::new(mixed(SECONDS, 1));
    let mut models = vec![("none", "", with_effects(|_| false))];
    let physics = CATALOGUE.iter().filter(|e| e.kind == EffectKind::Physics);
    for effect in physics {
        let acts = match effect.acts {
            Acts::Wheels | Acts::SoilByPlace => "wheels",
            Acts::Body | Acts::Slope | Acts::Residual(_) => "body",
            Acts::Sensors => continue,
        };
        models.push((effect.name, acts, with_effects(|name| name == effect.name)));
    }
    let every = |acts: &'static str| {
        let of = models.iter().filter(move |(_, other, _)| *other == acts);
        of.map(|(name, _, _)| *name).collect::<Vec<_>>()
    };
    let (body, wheels) = (every("body"), every("wheels"));
    models.push((
        "every one of the body",
        "body",
        with_effects(|name| body.contains(&name)),
    ));
    models.push((
        "every one of the wheels",
        "wheels",
        with_effects(|name| wheels.contains(&name)),
    ));
    models.push(("every one", "both", with_effects(|_| true)));
    let rows = models.iter().map(|(name, acts, model)| {
        // Beside the model without effects each time: the ratio is of the same seconds.
        let of = |index: usize| [&models[0].2, model][index];
        let mut solved = [wrenches(of(0), &motions), wrenches(of(1), &motions)];
        let solved = compare(&mut solved);
        let start = rollout(model, &inputs);
        let end = start.clone().run(|_, _| Ok(()));
        let drive = end.as_ref().ok().map(|()| {
            let costs = compare(&mut [driven(rollout(of(0), &inputs)), driven(start)]);
            costs[1].processor / costs[0].processor
        });
        json!({
            "name": name,
            "acts": acts,
            "memory": model.memory_count(),
            "wrench": solved[1].processor / solved[0].processor,
            "drive": drive,
            "error": end.err().map(|error| error.to_string()),
        })
    });
    rows.collect()
}

/// Drives of many vehicles, one after the other and in a batch.
fn batch() -> Value {
    const MEMBERS: usize = 64;
    const LENGTH: f64 = 10.0;
    let inputs = Arc::new(mixed(LENGTH, 1));
    let member = |index: usize| {
        let vehicle = Vehicle {
            mass: 400.0 + 2.0 * index as f64,
            ..Vehicle::tran2007()
        };
        let soil = soil(Terrain::PRESETS[index % Terrain::PRESETS.len()]);
        rollout(&VehicleModel::new(vehicle, soil).unwrap(), &inputs)
    };
    let members: Vec<Rollout> = (0..MEMBERS).map(member).collect();
    let costs = compare(&mut [
        Box::new(|| {
            for mut member in members.clone() {
                black_box(member.trajectory());
            }
        }),
        Box::new(|| {
            black_box(trajectories(&mut members.clone()));
        }),
    ]);
    let of =
        |index: usize| json!({"processor": costs[index].processor, "clock": costs[index].clock});
    json!({
        "members": MEMBERS,
        "seconds": LENGTH,
        "threads": rayon::current_num_threads(),
        "alone": of(0),
        "together": of(1),
    })
}

/// The vehicle on clayed soil with other quadrature, or other rows of wheels.
fn resized(resolution: Resolution, rows: usize) -> VehicleModel {
    let spacing = 0.61;
    let first = spacing * (rows as f64 - 1.0) / 2.0;
    let vehicle = Vehicle {
        row_positions: (0..rows).map(|row| first - spacing * row as f64).collect(),
        mass: 490.0 * rows as f64 / 4.0,
        ..Vehicle::tran2007()
    };
    let regularisation = Regularisation::default();
    VehicleModel::with_settings(vehicle, soil(SOIL), regularisation, resolution).unwrap()
}

const TURN: [Motion; 1] = [Motion {
    v_x: 1.5,
    v_y: 0.05,
    yaw_rate: -0.2,
    omega_left: 8.0,
    omega_right: 7.0,
}];

/// Seconds of a wrench by the number that distinguishes the models.
fn sized(models: &[(usize, VehicleModel)]) -> Value {
    let works = models.iter().map(|(_, model)| wrenches(model, &TURN));
    let costs = compare(&mut works.collect::<Vec<_>>());
    let pairs = models.iter().zip(costs);
    pairs
        .map(|((size, _), cost)| json!([size, cost.processor]))
        .collect()
}

fn nodes() -> Value {
    let model = |factor: usize| {
        let resolution = Resolution {
            arc: 8 * factor,
            width: 2 * factor,
            sharp_reversal: 12 * factor,
        };
        (16 * factor * factor, resized(resolution, 4))
    };
    sized(&[1, 2, 4].map(model))
}

fn rows() -> Value {
    let model = |rows: usize| (rows, resized(Resolution::default(), rows));
    sized(&[2, 4, 8, 16].map(model))
}

#[inline(always)]
fn many<S: Simd>(simd: S, count: usize, f: impl Fn(f64x8<S>) -> f64x8<S>) -> f64 {
    let mut sum = f64x8::splat(simd, 0.0);
    for k in 0..count {
        sum += f(f64x8::splat(simd, -1.0 - k as f64 * 1e-3));
    }
    sum.as_slice()[0]
}

/// Seconds of the functions that bound the kernel, of eight lanes.
fn lanes() -> Value {
    const COUNT: usize = 1000;
    let level = Level::new();
    let costs = compare(&mut [
        Box::new(|| {
            black_box(dispatch!(level, simd => many(simd, black_box(COUNT), |x| x.decay())));
        }),
        Box::new(|| {
            black_box(
                dispatch!(level, simd => many(simd, black_box(COUNT), |x| (-x).inverse_sqrt())),
            );
        }),
        Box::new(|| {
            black_box(dispatch!(level, simd => many(simd, black_box(COUNT), |x| (-x).power(0.5))));
        }),
    ]);
    let names = ["exp", "1/sqrt", "pow"].into_iter().zip(costs);
    names
        .map(|(name, cost)| json!([name, cost.processor / COUNT as f64]))
        .collect()
}
