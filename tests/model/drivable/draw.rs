//! Random drives: vehicles, soils, effects and wheel speeds drawn over what engineers may ask for.

use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects, ParameterName, Prior};
use ugv_terrain::simulation::{Simulation, SimulationError, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{GRAVITY, Specification, Vehicle, VehicleModel};

const PRESETS: [&str; 4] = ["dry_sand", "sandy_loam", "clayed_soil", "dry_clay"];

/// Wheel speeds at a time [s], linear in between.
pub type Table = Vec<(f64, [f64; 2])>;

/// A drive from rest.
pub struct Drive {
    /// What was drawn, for messages.
    pub what: String,
    pub specification: Specification,
    pub table: Table,
}

fn between(rng: &mut fastrand::Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}
fn log_between(rng: &mut fastrand::Rng, low: f64, high: f64) -> f64 {
    between(rng, low.ln(), high.ln()).exp()
}

/// A vehicle of 20 to 3,000 kg with two to five rows, proportioned as the paper's one.
fn vehicle(rng: &mut fastrand::Rng) -> Vehicle {
    let mass = log_between(rng, 20.0, 3000.0);
    let size = (mass / 490.0).cbrt();
    let wheel_radius = 0.25 * size * between(rng, 0.7, 1.3);
    let rows = rng.usize(2..=5);
    let spacing = 2.0 * wheel_radius * between(rng, 1.05, 1.6);
    let row_positions: Vec<f64> = (0..rows)
        .map(|row| spacing * (0.5 * (rows as f64 - 1.0) - row as f64))
        .collect();
    let half_track = 0.61 * size * between(rng, 0.7, 1.3);
    let long = row_positions[0] + wheel_radius;
    let com_height = (0.35 * size * between(rng, 0.6, 1.5))
        .min(0.8 * half_track)
        .min(0.8 * long);
    Vehicle {
        mass,
        yaw_inertia: mass * (long * long + half_track * half_track) / 3.0 * between(rng, 0.7, 1.3),
        wheel_radius,
        wheel_width: 0.246 * size * between(rng, 0.5, 1.3),
        half_track,
        com_offset: row_positions[0] * between(rng, -0.3, 0.3),
        com_height,
        row_positions,
    }
}

/// One of the paper's soils, or another into which the vehicle's wheels sink by 2 to 12 % of their radius.
fn soil(rng: &mut fastrand::Rng, vehicle: &Vehicle) -> Terrain {
    if rng.bool() {
        return Terrain::preset(PRESETS[rng.usize(0..4)]).unwrap();
    }
    let sinkage = vehicle.wheel_radius * log_between(rng, 0.02, 0.12);
    let length = (2.0 * vehicle.wheel_radius * sinkage).sqrt();
    let load = vehicle.mass * GRAVITY / vehicle.wheel_count() as f64;
    let exponent = between(rng, 0.1, 1.3);
    let modulus = 1.5 * load / (vehicle.wheel_width * length) / sinkage.powf(exponent);
    Terrain {
        cohesion: log_between(rng, 100.0, 20e3),
        friction_angle: between(rng, 10.0, 42.0).to_radians(),
        cohesive_modulus: 0.0,
        frictional_modulus: modulus,
        sinkage_exponent: exponent,
        shear_modulus: log_between(rng, 2e-3, 0.05),
    }
}

/// Ramps, turns, pivots, emergency stops and reversals over 20 s.
fn table(rng: &mut fastrand::Rng, vehicle: &Vehicle) -> Table {
    let fastest = 2.5 * (vehicle.wheel_radius / 0.25).sqrt() / vehicle.wheel_radius;
    let mut table = vec![(0.0, [0.0; 2])];
    let mut time = 0.0;
    while time < 20.0 {
        let omega = fastest * between(rng, 0.1, 1.0) * if rng.u8(0..4) == 0 { -1.0 } else { 1.0 };
        let (target, ramp) = match rng.u8(0..6) {
            0 => ([omega, omega], between(rng, 0.3, 2.0)),
            1 => (
                [omega, omega * between(rng, 0.0, 1.0)],
                between(rng, 0.3, 2.0),
            ),
            2 => (
                [omega * between(rng, 0.0, 1.0), omega],
                between(rng, 0.3, 2.0),
            ),
            3 => ([0.6 * omega, -0.6 * omega], between(rng, 0.3, 1.5)),
            4 => ([0.0, 0.0], between(rng, 0.01, 0.2)),
            _ => (
                [omega, fastest * between(rng, -1.0, 1.0)],
                between(rng, 0.1, 1.0),
            ),
        };
        time += ramp;
        table.push((time, target));
        time += between(rng, 0.2, 2.0);
        table.push((time, target));
    }
    table
}

/// The physics of the catalogue.
fn physics() -> Vec<usize> {
    (0..CATALOGUE.len())
        .filter(|e| CATALOGUE[*e].kind == EffectKind::Physics)
        .collect()
}

fn drawn(rng: &mut fastrand::Rng, parameter: ParameterName) -> f64 {
    let (_, declared) = parameter.declaration();
    let normal: f64 = (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0;
    let value = match declared.prior {
        Prior::Normal { mean, deviation } => mean + deviation * normal,
        Prior::LogNormal { median, deviation } => median * (deviation * normal).exp(),
    };
    value.clamp(declared.low, declared.high)
}

/// A drive that an engineer may ask for, with none, one or two effects of usual size.
pub fn plausible(seed: u64) -> Drive {
    let mut rng = fastrand::Rng::with_seed(seed);
    let vehicle = vehicle(&mut rng);
    let terrain = soil(&mut rng, &vehicle);
    let table = table(&mut rng, &vehicle);
    let mut effects = Effects::default();
    let all = physics();
    let mut names = vec![];
    for _ in 0..rng.usize(0..3) {
        let effect = if rng.u8(0..3) == 0 {
            CATALOGUE
                .iter()
                .position(|e| e.name == "tyre_compliance")
                .unwrap()
        } else {
            all[rng.usize(0..all.len())]
        };
        names.push(CATALOGUE[effect].name);
        for place in 0..CATALOGUE[effect].parameters.len() {
            let parameter = ParameterName::at(effect, place).unwrap();
            let mut value = drawn(&mut rng, parameter);
            if ["payload.mass", "drawbar.force"].contains(&parameter.full_name().as_str()) {
                value = value.min(0.3 * vehicle.mass);
            }
            if parameter.full_name().starts_with("com_shift")
                || parameter.full_name().starts_with("payload.ahead")
                || parameter.full_name().starts_with("payload.left")
            {
                value *= vehicle.wheel_radius;
            }
            effects.set(parameter, value).unwrap();
        }
    }
    Drive {
        what: format!("seed {seed} {names:?}"),
        specification: Specification {
            vehicle,
            terrain,
            effects,
        },
        table,
    }
}

/// The paper's vehicle with parameters of effects at the ends of their ranges.
pub fn at_ends(seed: u64) -> Drive {
    let mut rng = fastrand::Rng::with_seed(seed);
    let all = physics();
    let vehicle = Vehicle::tran2007();
    let name = PRESETS[rng.usize(0..4)];
    let terrain = Terrain::preset(name).unwrap();
    let mut effects = Effects::default();
    let mut what = format!("seed {seed} {name}");
    let effect = all[seed as usize % all.len()];
    for place in 0..CATALOGUE[effect].parameters.len() {
        let parameter = ParameterName::at(effect, place).unwrap();
        let (_, d) = parameter.declaration();
        let value = match rng.u8(0..5) {
            0 => d.low,
            1 => d.high,
            2 => d.low + 1e-6 * (d.high - d.low),
            3 => d.high - 1e-3 * (d.high - d.low),
            _ => drawn(&mut rng, parameter),
        };
        what += &format!(" {}={value}", parameter.full_name());
        effects.set(parameter, value).unwrap();
    }
    let mut table = table(&mut rng, &vehicle);
    table.truncate(8);
    Drive {
        what,
        specification: Specification {
            vehicle,
            terrain,
            effects,
        },
        table,
    }
}

/// Drives from row to row of a table, in steps of 0.1 s at most.
pub fn follow(
    simulation: &mut Simulation,
    table: &[(f64, [f64; 2])],
) -> Result<(), SimulationError> {
    for pair in table.windows(2) {
        let ((from, a), (to, b)) = (pair[0], pair[1]);
        let seconds = to - from;
        let rate = |k: usize| (b[k] - a[k]) / seconds;
        simulation.set_wheel_speeds(WheelSpeeds::from(a))?;
        simulation.set_wheel_accelerations(WheelSpeeds::from([rate(0), rate(1)]))?;
        let steps = (seconds / 0.1).ceil();
        for _ in 0..steps as usize {
            simulation.step(seconds / steps)?;
        }
    }
    Ok(())
}

/// Drives it, in a model that must be accepted.
pub fn run(drive: &Drive) -> Result<(), SimulationError> {
    let model = VehicleModel::from_specification(&drive.specification)
        .unwrap_or_else(|error| panic!("{}: {error}", drive.what));
    let mut simulation = Simulation::new(model);
    follow(&mut simulation, &drive.table)?;
    let end = simulation.state().to_array();
    assert!(end.iter().all(|v| v.is_finite()), "{}", drive.what);
    Ok(())
}
