//! What the model costs. `scripts/tools/bench.sh` runs it beside its peers and prints the table.
//!
//! The drive is the table that `scripts/tools/numpy_model.py drive` writes, named by `UGV_DRIVE`.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x8};
use serde_json::Value;
use std::hint::black_box;
use std::time::Duration;
use ugv_terrain::contact::{Regularisation, Resolution};
use ugv_terrain::effects::{EffectKind, Effects, ParameterName};
use ugv_terrain::scalar::Real;
use ugv_terrain::simulation::{SensitiveSimulation, Simulation, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Balance, ModelParameter, Motion, Specification, Vehicle};
use ugv_terrain::vehicle::{VehicleModel, Wrench};

/// The golden states with their models: what a wrench costs is their mean.
fn golden() -> Vec<(VehicleModel, Motion)> {
    let document: Value = serde_json::from_str(include_str!("../golden/wrenches.json")).unwrap();
    let states = document["states"].as_array().unwrap();
    let state = |value: &Value| {
        let number = |key: &str| value[key].as_f64().unwrap();
        let soil = Terrain::preset(value["terrain"].as_str().unwrap()).unwrap();
        let motion = Motion {
            v_x: number("V_X"),
            v_y: number("V_Y"),
            yaw_rate: number("yaw_rate"),
            omega_left: number("omega_left"),
            omega_right: number("omega_right"),
        };
        (
            VehicleModel::new(Vehicle::tran2007(), soil).unwrap(),
            motion,
        )
    };
    states.iter().map(state).collect()
}

fn clayed(resolution: Resolution, rows: usize) -> VehicleModel {
    let spacing = 0.61;
    let first = spacing * (rows as f64 - 1.0) / 2.0;
    let vehicle = Vehicle {
        row_positions: (0..rows).map(|row| first - spacing * row as f64).collect(),
        mass: 490.0 * rows as f64 / 4.0,
        ..Vehicle::tran2007()
    };
    let soil = Terrain::preset("clayed_soil").unwrap();
    VehicleModel::with_settings(vehicle, soil, Regularisation::default(), resolution).unwrap()
}

const MOTION: Motion = Motion {
    v_x: 1.5,
    v_y: 0.05,
    yaw_rate: -0.2,
    omega_left: 8.0,
    omega_right: 7.0,
};

fn wrenches(c: &mut Criterion) {
    let states = golden();
    let fresh: Vec<Balance> = states
        .iter()
        .map(|(model, _)| Balance::new(model))
        .collect();
    let mut balances = fresh.clone();
    let mut wrench = Wrench::for_model(&states[0].0);
    let mut simulations: Vec<Simulation> = states
        .iter()
        .map(|(model, motion)| {
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
        })
        .collect();
    let mut group = c.benchmark_group("16 golden wrenches");
    // From the loads at rest: nothing is known of the answer.
    let restart = || fresh.clone();
    group.bench_function("from scratch", |b| {
        b.iter_batched_ref(
            restart,
            |balances| {
                for ((model, motion), balance) in states.iter().zip(balances) {
                    model.solve(black_box(motion), balance).unwrap();
                    balance.wrench(model, motion, &mut wrench);
                }
            },
            BatchSize::SmallInput,
        );
    });
    group.bench_function("Jacobian at a balance", |b| {
        b.iter(|| {
            for simulation in &mut simulations {
                black_box(simulation.jacobian().unwrap());
            }
        });
    });
    group.bench_function("from the neighbourhood", |b| {
        b.iter(|| {
            for ((model, motion), balance) in states.iter().zip(&mut balances) {
                model.solve(black_box(motion), balance).unwrap();
                balance.wrench(model, motion, &mut wrench);
            }
        });
    });
    group.finish();
}

/// The paper's vehicle on clayed soil with effects.
fn with_effects(effects: Effects) -> VehicleModel {
    let plain = clayed(Resolution::default(), 4);
    let specification = Specification {
        vehicle: plain.vehicle().clone(),
        terrain: *plain.terrain(),
        effects,
    };
    VehicleModel::from_specification(&specification).unwrap()
}

/// Every effect a little on.
fn every_effect() -> Effects {
    let mut effects = Effects::NONE;
    for name in ParameterName::all() {
        let (effect, parameter) = name.declaration();
        if effect.kind == EffectKind::Physics && parameter.switches {
            let far = if parameter.default < parameter.high {
                parameter.high
            } else {
                parameter.low
            };
            let value = parameter.default + 0.05 * (far - parameter.default);
            effects.set(name, value).unwrap();
        }
    }
    effects
}

fn effects(c: &mut Criterion) {
    let mut group = c.benchmark_group("effects");
    let models = [
        ("none asked for", clayed(Resolution::default(), 4)),
        ("all off", with_effects(Effects::NONE)),
        (
            "one on",
            with_effects(Effects::NONE.with("grade.slope_east", 0.05).unwrap()),
        ),
        ("every one on", with_effects(every_effect())),
    ];
    for (name, model) in &models {
        let fresh = Balance::new(model);
        group.bench_function(*name, |b| {
            b.iter_batched_ref(
                || fresh.clone(),
                |balance| model.solve(black_box(&MOTION), balance).unwrap(),
                BatchSize::SmallInput,
            );
        });
    }
    for (name, model) in &models {
        let mut start = Simulation::new(model.clone());
        start
            .set_wheel_speeds(WheelSpeeds {
                left: 6.0,
                right: 7.0,
            })
            .unwrap();
        group.bench_function(format!("10 s drive, {name}"), |b| {
            b.iter(|| {
                let mut drive = start.clone();
                drive.step(10.0).unwrap();
                drive.state()
            });
        });
    }
    let plain = Specification {
        vehicle: models[0].1.vehicle().clone(),
        terrain: *models[0].1.terrain(),
        effects: Effects::NONE,
    };
    let soil: Vec<ModelParameter> = ModelParameter::all().take(6).collect();
    let mut start = SensitiveSimulation::new(&plain, &soil).unwrap();
    start
        .drive(
            WheelSpeeds {
                left: 6.0,
                right: 7.0,
            },
            WheelSpeeds::default(),
        )
        .unwrap();
    group.bench_function("10 s drive with its derivatives by the soil", |b| {
        b.iter(|| {
            let mut drive = start.clone();
            drive.step(10.0).unwrap();
            drive.derivatives().by_parameter(0)
        });
    });
    group.finish();
}

fn growth(c: &mut Criterion) {
    let mut group = c.benchmark_group("wrench by nodes");
    for factor in [1, 2, 4] {
        let resolution = Resolution {
            arc: 8 * factor,
            width: 2 * factor,
            reversal: 5 * factor,
            sharp_reversal: 12 * factor,
        };
        cold(&mut group, &clayed(resolution, 4), 16 * factor * factor);
    }
    group.finish();
    let mut group = c.benchmark_group("wrench by rows");
    for rows in [2, 3, 4, 8, 16] {
        cold(&mut group, &clayed(Resolution::default(), rows), rows);
    }
    group.finish();
}

fn cold(
    group: &mut criterion::BenchmarkGroup<criterion::measurement::WallTime>,
    model: &VehicleModel,
    label: usize,
) {
    let fresh = Balance::new(model);
    group.bench_function(BenchmarkId::from_parameter(label), |b| {
        b.iter_batched_ref(
            || fresh.clone(),
            |balance| model.solve(black_box(&MOTION), balance).unwrap(),
            BatchSize::SmallInput,
        );
    });
}

/// The drive as rows of time, left and right wheel speed.
fn drive_table() -> Option<Vec<[f64; 3]>> {
    let text = std::fs::read_to_string(std::env::var_os("UGV_DRIVE")?).ok()?;
    let row = |line: &str| {
        let mut cells = line.split(',').map(|cell| cell.trim().parse().unwrap());
        std::array::from_fn(|_| cells.next().unwrap())
    };
    Some(text.lines().skip(1).map(row).collect())
}

/// Drives the table with a communication step that divides the table's.
fn drive(start: &Simulation, table: &[[f64; 3]], parts: usize) -> Simulation {
    let mut simulation = start.clone();
    for pair in table.windows(2) {
        let [[t0, l0, r0], [t1, l1, r1]] = [pair[0], pair[1]];
        let rates = WheelSpeeds::from([(l1 - l0) / (t1 - t0), (r1 - r0) / (t1 - t0)]);
        for part in 0..parts {
            let elapsed = (t1 - t0) * part as f64 / parts as f64;
            let speeds = WheelSpeeds::from([l0, r0]).after(rates, elapsed);
            simulation.set_wheel_speeds(speeds).unwrap();
            simulation.set_wheel_accelerations(rates).unwrap();
            simulation.step((t1 - t0) / parts as f64).unwrap();
            black_box(simulation.state());
        }
    }
    simulation
}

/// The rows at which a piecewise linear table turns: between them it can be taken in one go.
fn knots(table: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let bends =
        |w: &[[f64; 3]]| (1..3).any(|k| ((w[2][k] - w[1][k]) - (w[1][k] - w[0][k])).abs() > 1e-6);
    let inner = table.windows(3).filter(|w| bends(w)).map(|w| w[1]);
    let ends = [table[0], table[table.len() - 1]];
    let mut all: Vec<[f64; 3]> = inner.chain(ends).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    all
}

fn drives(c: &mut Criterion) {
    let Some(table) = drive_table() else {
        eprintln!(
            "UGV_DRIVE names no drive; the drives are skipped (scripts/tools/bench.sh sets it)"
        );
        return;
    };
    let start = Simulation::new(clayed(Resolution::default(), 4));
    let knots = knots(&table);
    let mut group = c.benchmark_group("60 s drive on clayed soil");
    group
        .sample_size(20)
        .measurement_time(Duration::from_secs(4));
    group.bench_function("free run", |b| b.iter(|| drive(&start, &knots, 1)));
    group.bench_function("table rows of 50 ms", |b| {
        b.iter(|| drive(&start, &table, 1))
    });
    group.bench_function("steps of 10 ms", |b| b.iter(|| drive(&start, &table, 5)));
    group.finish();
    println!(
        "free run: {} legs, {:?}",
        knots.len() - 1,
        drive(&start, &knots, 1).counters()
    );
    println!("steps of 10 ms: {:?}", drive(&start, &table, 5).counters());
}

#[inline(always)]
fn many<S: Simd>(simd: S, count: usize, f: impl Fn(f64x8<S>) -> f64x8<S>) -> f64 {
    let mut sum = f64x8::splat(simd, 0.0);
    for k in 0..count {
        sum += f(f64x8::splat(simd, -1.0 - k as f64 * 1e-3));
    }
    sum.as_slice()[0]
}

fn functions(c: &mut Criterion) {
    let level = Level::new();
    let mut group = c.benchmark_group("1000 x 8 lanes");
    group.bench_function("exp", |b| {
        b.iter(|| dispatch!(level, simd => many(simd, black_box(1000), |x| x.decay())));
    });
    group.bench_function("1/sqrt", |b| {
        b.iter(|| dispatch!(level, simd => many(simd, black_box(1000), |x| (-x).inverse_sqrt())));
    });
    group.bench_function("pow", |b| {
        b.iter(|| dispatch!(level, simd => many(simd, black_box(1000), |x| (-x).power(0.5))));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(500));
    targets = wrenches, effects, growth, drives, functions
}
criterion_main!(benches);
