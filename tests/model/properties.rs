//! Properties that hold whatever the numbers are.

use crate::common::{
    motions, paper_model, power_lost, speeds, starting_at, symmetric_model, wrench,
};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;
use ugv_terrain::simulation::{Simulation, State};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Motion, Vehicle, VehicleModel, Wrench};

/// Newton's method leaves some 1e-7 of a wheel's force of 1000 N.
const FORCE_TOLERANCE: f64 = 1e-2;

/// Regularisation of the slip's direction \[m/s\].
const SLIP_SPEED: f64 = 1e-3;

fn terrain() -> impl Strategy<Value = &'static str> {
    prop::sample::select(Terrain::PRESETS.to_vec())
}

fn motion() -> impl Strategy<Value = Motion> {
    let speed = prop_oneof![-50.0..50.0, -1.0..1.0, Just(0.0)];
    let velocity = prop_oneof![-10.0..10.0, -0.02..0.02, Just(0.0)];
    let yaw_rate = prop_oneof![-4.0..4.0, -0.05..0.05, Just(0.0)];
    motions(velocity.clone(), velocity, yaw_rate, speed)
}

/// Motions that the paper's equations cover as they stand: rolling wheels, also those that roll ahead of their rims.
fn rolling() -> impl Strategy<Value = Motion> {
    let sign = prop_oneof![Just(1.0), Just(-1.0)];
    let (lateral, yaw_rate) = (
        prop_oneof![-0.5..0.5, Just(0.0)],
        prop_oneof![-0.5..0.5, Just(0.0)],
    );
    let share = || prop_oneof![0.9..1.1, 0.3..3.0];
    (sign, 0.5..5.0, lateral, yaw_rate, share(), share()).prop_map(
        |(sign, v_x, v_y, yaw_rate, left, right): (f64, f64, f64, f64, f64, f64)| {
            let rolling = sign * v_x / Vehicle::tran2007().wheel_radius;
            Motion {
                v_x: sign * v_x,
                v_y,
                yaw_rate,
                omega_left: rolling * left,
                omega_right: rolling * right,
            }
        },
    )
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(1.0)
}

/// Power \[W\] that the soil takes up under wheel `index`, by (2), (3), (5), (6), (12), (14), (15) and a dense rule: the
/// shear stress times the slip velocity, and the normal stress times the speed of compaction V_Xi sin(theta) (11).
fn dissipated(model: &VehicleModel, motion: &Motion, index: usize, entry: f64) -> f64 {
    const NODES: (usize, usize) = (80, 20);
    let (vehicle, soil) = (model.vehicle(), model.terrain());
    let (radius, width) = (vehicle.wheel_radius, vehicle.wheel_width);
    let side = [1.0, -1.0][index % 2];
    let ahead = vehicle.row_positions[index / 2] - vehicle.com_offset;
    let forward = motion.v_x - motion.yaw_rate * side * vehicle.half_track;
    let lateral = motion.v_y + motion.yaw_rate * ahead;
    let omega = [motion.omega_left, motion.omega_right][index % 2];
    // The wheel compacts on the side towards which it travels: seen from there it travels forward.
    let sign = forward.signum();
    let (forward, yaw_rate, rim) = (
        sign * forward,
        sign * motion.yaw_rate,
        sign * radius * omega,
    );
    let modulus = soil.cohesive_modulus / width + soil.frictional_modulus;
    let stress = |theta: f64| {
        let height = theta.max(entry - theta).cos() - entry.cos();
        modulus * (radius * height.max(0.0)).powf(soil.sinkage_exponent)
    };
    let mut power = 0.0;
    for row in 0..NODES.1 {
        let across = ((row as f64 + 0.5) / NODES.1 as f64 - 0.5) * width;
        let forward = forward - yaw_rate * across;
        // Where the stress has its peak, and where the tangential slip changes its sign.
        let reversal = (rim / forward).clamp(entry.cos(), 1.0).acos();
        let mut edges = [0.0, 0.5 * entry, reversal, entry];
        edges.sort_by(f64::total_cmp);
        for pair in edges.windows(2) {
            for node in 0..NODES.0 {
                // Nodes cluster at both ends, where powers of the sinkage are singular.
                let angle = (node as f64 + 0.5) / NODES.0 as f64 * FRAC_PI_2;
                let theta = pair[0] + (pair[1] - pair[0]) * angle.sin().powi(2);
                let weight = (pair[1] - pair[0]) * (2.0 * angle).sin() * FRAC_PI_2 / NODES.0 as f64;
                let rest = entry - theta;
                let j_x = forward
                    * (0.5 * rest + 0.25 * ((2.0 * entry).sin() - (2.0 * theta).sin()))
                    - rim * (entry.sin() - theta.sin());
                let j_y = lateral * rest + radius * yaw_rate * (theta.cos() - entry.cos());
                let j_z = 0.25 * forward * ((2.0 * theta).cos() - (2.0 * entry).cos())
                    - rim * (theta.cos() - entry.cos());
                let displacement = (j_x.powi(2) + j_y.powi(2) + j_z.powi(2)).sqrt() / omega.abs();
                let normal = stress(theta);
                let strength = soil.cohesion + normal * soil.friction_angle.tan();
                let shear = -strength * (-displacement / soil.shear_modulus).exp_m1();
                let slip =
                    (forward * theta.cos() - rim).hypot(lateral + radius * yaw_rate * theta.sin());
                let lost =
                    shear * slip * slip / slip.hypot(SLIP_SPEED) + normal * forward * theta.sin();
                power += lost * weight * radius * width / NODES.1 as f64;
            }
        }
    }
    power
}

/// Power of the axles \[W\], and the rate of change of the kinetic energy \[W\].
fn axle_power_and_rate(vehicle: &Vehicle, motion: &Motion, w: &Wrench) -> (f64, f64) {
    let speeds = [motion.omega_left, motion.omega_right];
    let axles = w.wheels.iter().zip(speeds.into_iter().cycle());
    let driven: f64 = axles.map(|(wheel, omega)| wheel.torque * omega).sum();
    (driven, driven - power_lost(vehicle, motion, w))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_finite_motion_has_finite_forces_and_loads_that_carry_the_weight(
        terrain in terrain(), motion in motion()
    ) {
        let model = paper_model(terrain);
        let w = wrench(&model, &motion);
        let loads: f64 = w.wheels.iter().map(|wheel| wheel.load).sum();
        let weight = 490.0 * 9.81;
        prop_assert!(close(loads, weight, 1e-6), "{loads}");
        for value in [w.a_x, w.a_y, w.yaw_acceleration, w.rolling_resistance] {
            prop_assert!(value.is_finite());
        }
        for wheel in &w.wheels {
            prop_assert!(wheel.load >= 0.0 && (0.0..1.58).contains(&wheel.entry_angle));
            prop_assert!(wheel.longitudinal_slip.is_finite() && wheel.lateral_slip.is_finite());
        }
    }

    #[test]
    fn left_and_right_are_mirror_images(terrain in terrain(), motion in motion()) {
        let model = paper_model(terrain);
        let mirrored = Motion {
            v_x: motion.v_x,
            v_y: -motion.v_y,
            yaw_rate: -motion.yaw_rate,
            omega_left: motion.omega_right,
            omega_right: motion.omega_left,
        };
        let (a, b) = (wrench(&model, &motion), wrench(&model, &mirrored));
        prop_assert!(close(a.a_x, b.a_x, FORCE_TOLERANCE / 490.0));
        prop_assert!(close(a.a_y, -b.a_y, FORCE_TOLERANCE / 490.0));
        prop_assert!(close(a.turning_moment, -b.turning_moment, FORCE_TOLERANCE));
        prop_assert!(close(a.turning_resistance_moment, -b.turning_resistance_moment, FORCE_TOLERANCE));
        for row in 0..4 {
            let (left, right) = (a.wheels[2 * row], b.wheels[2 * row + 1]);
            prop_assert!(close(left.load, right.load, FORCE_TOLERANCE));
            prop_assert!(close(left.force_y, -right.force_y, FORCE_TOLERANCE));
        }
    }

    #[test]
    fn front_and_rear_are_mirror_images_without_offset(terrain in terrain(), motion in motion()) {
        let model = symmetric_model(terrain);
        let mirrored = Motion {
            v_x: -motion.v_x,
            v_y: motion.v_y,
            yaw_rate: -motion.yaw_rate,
            omega_left: -motion.omega_left,
            omega_right: -motion.omega_right,
        };
        let (a, b) = (wrench(&model, &motion), wrench(&model, &mirrored));
        prop_assert!(close(a.a_x, -b.a_x, FORCE_TOLERANCE / 490.0));
        prop_assert!(close(a.a_y, b.a_y, FORCE_TOLERANCE / 490.0));
        prop_assert!(close(a.turning_moment, -b.turning_moment, FORCE_TOLERANCE));
        prop_assert!(close(a.rolling_resistance, b.rolling_resistance, FORCE_TOLERANCE));
        for row in 0..4 {
            let (front, rear) = (a.wheels[2 * row], b.wheels[6 - 2 * row]);
            prop_assert!(close(front.load, rear.load, FORCE_TOLERANCE));
            prop_assert!(close(front.force_x, -rear.force_x, FORCE_TOLERANCE));
        }
    }

    #[test]
    fn power_lost_to_the_soil_is_never_negative(terrain in terrain(), motion in motion()) {
        let model = paper_model(terrain);
        let power = power_lost(model.vehicle(), &motion, &wrench(&model, &motion));
        let speed = motion.to_array().into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        prop_assert!(power >= -FORCE_TOLERANCE * speed, "{power} W");
    }

    #[test]
    fn the_axles_power_moves_the_vehicle_or_is_lost_to_the_soil(terrain in terrain(), motion in rolling()) {
        let model = paper_model(terrain);
        let w = wrench(&model, &motion);
        // The forces of a wheel about to lift are faded out.
        prop_assume!(w.wheels.iter().all(|wheel| wheel.load > 1.0));
        let entries = w.wheels.iter().map(|wheel| wheel.entry_angle);
        let lost: Vec<f64> = entries
            .enumerate()
            .map(|(index, entry)| dissipated(&model, &motion, index, entry))
            .collect();
        prop_assert!(lost.iter().all(|power| *power >= 0.0), "{lost:?}");
        let lost: f64 = lost.iter().sum();
        let (driven, rate) = axle_power_and_rate(model.vehicle(), &motion, &w);
        prop_assert!((driven - rate - lost).abs() < 1e-3 * lost, "{driven} W - {rate} W, {lost} W");
        prop_assert!(driven > 0.0 || rate < 0.0, "{driven} W drive nothing, {rate} W");
    }

    #[test]
    fn a_drive_stays_finite(
        terrain in terrain(),
        legs in prop::collection::vec((-50.0..50.0, -50.0..50.0, 0.0001..0.5), 1..12)
    ) {
        let mut simulation = Simulation::new(paper_model(terrain));
        for (left, right, seconds) in legs {
            simulation.set_wheel_speeds(speeds(left, right)).unwrap();
            simulation.step(seconds).unwrap();
            let state = simulation.state().to_array();
            prop_assert!(state.iter().all(|value| value.is_finite()));
            // The rim is the fastest thing about: 50 rad/s times 0.25 m.
            prop_assert!(state[3].hypot(state[4]) < 13.0 && state[5].abs() < 25.0, "{state:?}");
        }
    }
}

#[test]
fn locked_wheels_take_energy_out_of_the_motion() {
    for terrain in Terrain::PRESETS {
        let start = State {
            v_x: 2.0,
            v_y: 0.5,
            yaw_rate: 0.7,
            ..State::default()
        };
        let mut simulation = starting_at(paper_model(terrain), start);
        let energy = |state: State| {
            0.5 * 490.0 * (state.v_x.powi(2) + state.v_y.powi(2))
                + 0.5 * 309.43 * state.yaw_rate.powi(2)
        };
        let mut before = energy(simulation.state());
        for _ in 0..400 {
            simulation.step(0.005).unwrap();
            let after = energy(simulation.state());
            assert!(after <= before + 1e-9, "{terrain}: {before} to {after}");
            before = after;
        }
        assert!(before < 1e-6, "{terrain}: {before} J are left");
    }
}

#[test]
fn rest_stays_rest_for_a_minute() {
    for terrain in Terrain::PRESETS {
        let mut simulation = Simulation::new(paper_model(terrain));
        for _ in 0..600 {
            simulation.step(0.1).unwrap();
            let state = simulation.state();
            assert!(
                state.v_x.abs() < 1e-6 && state.v_y.abs() < 1e-6 && state.yaw_rate.abs() < 1e-6
            );
        }
        let state = simulation.state();
        assert!(state.x.hypot(state.y) < 1e-6, "{terrain}: {state:?}");
    }
}

#[test]
fn a_disturbed_vehicle_comes_to_rest_and_stays() {
    for terrain in Terrain::PRESETS {
        let nudge = State {
            v_x: 1e-3,
            v_y: -1e-3,
            yaw_rate: 1e-3,
            ..State::default()
        };
        let mut simulation = starting_at(paper_model(terrain), nudge);
        for _ in 0..50 {
            simulation.step(0.1).unwrap();
        }
        let settled = simulation.state();
        for _ in 0..600 {
            simulation.step(0.1).unwrap();
        }
        let state = simulation.state();
        assert!(state.v_x.abs() < 1e-6 && state.v_y.abs() < 1e-6 && state.yaw_rate.abs() < 1e-6);
        let crept = (state.x - settled.x).hypot(state.y - settled.y);
        assert!(crept < 1e-5, "{terrain}: crept {crept} m in a minute");
    }
}

#[test]
fn braking_to_a_stop_does_not_reverse() {
    for terrain in Terrain::PRESETS {
        for seconds in [0.05, 1.0, 3.0] {
            let start = State {
                v_x: 1.5,
                ..State::default()
            };
            let mut simulation = starting_at(paper_model(terrain), start);
            simulation.set_wheel_speeds(speeds(6.0, 6.0)).unwrap();
            simulation
                .set_wheel_accelerations(speeds(-6.0 / seconds, -6.0 / seconds))
                .unwrap();
            let steps = (seconds / 0.01_f64).round() as usize;
            let mut farthest: f64 = 0.0;
            let mut look = |simulation: &mut Simulation| {
                simulation.step(0.01).unwrap();
                let state = simulation.state();
                assert!(state.v_x > -1e-4, "{terrain}, {seconds} s: {state:?}");
                farthest = farthest.max(state.x);
            };
            for _ in 0..steps {
                look(&mut simulation);
            }
            simulation.set_wheel_speeds(speeds(0.0, 0.0)).unwrap();
            simulation
                .set_wheel_accelerations(speeds(0.0, 0.0))
                .unwrap();
            for _ in 0..300 {
                look(&mut simulation);
            }
            let state = simulation.state();
            assert!(state.v_x.abs() < 1e-5, "{terrain}, {seconds} s: {state:?}");
            assert!(
                farthest - state.x < 1e-5,
                "{terrain}, {seconds} s: rolled back"
            );
        }
    }
}

#[test]
fn a_pivot_turn_keeps_the_centroid() {
    for terrain in Terrain::PRESETS {
        let mut simulation = Simulation::new(symmetric_model(terrain));
        simulation
            .set_wheel_accelerations(speeds(-6.0, 6.0))
            .unwrap();
        simulation.step(1.0).unwrap();
        simulation
            .set_wheel_accelerations(speeds(0.0, 0.0))
            .unwrap();
        for _ in 0..500 {
            simulation.step(0.01).unwrap();
            let state = simulation.state();
            assert!(state.x.hypot(state.y) < 1e-3, "{terrain}: {state:?}");
        }
        assert!(
            simulation.state().heading > 1.0,
            "{terrain}: {:?}",
            simulation.state()
        );
    }
}

/// Newton's method takes damped steps where a wheel is about to lift; they end as close as whole ones.
#[test]
fn a_wheel_about_to_lift_has_a_mirror_image() {
    let model = paper_model("dry_clay");
    let motion = Motion {
        v_x: 4.874664749172477,
        v_y: 2.8481693175746843,
        yaw_rate: -1.7790939039741718,
        omega_left: 0.0,
        omega_right: 0.20385287683124037,
    };
    let mirrored = Motion {
        v_y: -motion.v_y,
        yaw_rate: -motion.yaw_rate,
        omega_left: motion.omega_right,
        omega_right: motion.omega_left,
        ..motion
    };
    let (a, b) = (wrench(&model, &motion), wrench(&model, &mirrored));
    assert!(
        close(a.a_y, -b.a_y, FORCE_TOLERANCE / 490.0),
        "{} {}",
        a.a_y,
        b.a_y
    );
    assert!(close(a.a_x, b.a_x, FORCE_TOLERANCE / 490.0));
}

/// Narrow wheels sink deep, and the vehicle travels faster than their rims: (13), at the lowest point, reads a negative
/// slip where the entry of the contact drives. The axles supply all that the soil takes up.
#[test]
fn a_vehicle_that_overruns_its_rims_is_driven_by_its_axles() {
    let vehicle = Vehicle {
        wheel_width: 0.05,
        ..Vehicle::tran2007()
    };
    let soil = Terrain {
        shear_modulus: 0.003,
        ..Terrain::preset("dry_sand").unwrap()
    };
    let mut simulation = Simulation::new(VehicleModel::new(vehicle.clone(), soil).unwrap());
    simulation.set_wheel_speeds(speeds(4.0, 4.0)).unwrap();
    simulation.step(20.0).unwrap();
    let motion = Motion {
        v_x: simulation.state().v_x,
        omega_left: 4.0,
        omega_right: 4.0,
        ..Motion::default()
    };
    let w = wrench(simulation.model(), &motion);
    assert!(w.a_x.abs() < 1e-6, "{} m/s^2: not steady", w.a_x);
    let mut lost = 0.0;
    for (index, wheel) in w.wheels.iter().enumerate() {
        // V cos(theta) >= r omega at the entry would leave nothing that drives.
        let bound = 1.0 - 1.0 / wheel.entry_angle.cos();
        let slip = wheel.longitudinal_slip;
        assert!(bound < slip && slip < -0.005, "{bound} < {slip}");
        assert!(wheel.torque > 0.0);
        lost += dissipated(simulation.model(), &motion, index, wheel.entry_angle);
    }
    let (driven, _) = axle_power_and_rate(&vehicle, &motion, &w);
    assert!((driven - lost).abs() < 1e-3 * lost, "{driven} W, {lost} W");
}
