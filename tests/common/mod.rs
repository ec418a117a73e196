//! What several tests share: the paper's vehicle on its terrains, wheel-speed tables.
#![allow(dead_code, reason = "not every test uses everything")]

use proptest::prelude::*;
use ugv_terrain::simulation::{Simulation, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Balance, Motion, Vehicle, VehicleModel, Wrench};

/// The paper's vehicle on one of its terrains.
pub fn paper_model(terrain: &str) -> VehicleModel {
    let soil = Terrain::preset(terrain).expect("a terrain of the paper");
    VehicleModel::new(Vehicle::tran2007(), soil).expect("the paper's parameters are valid")
}

/// The paper's vehicle with the centre of mass in its centroid.
pub fn symmetric_model(terrain: &str) -> VehicleModel {
    let vehicle = Vehicle {
        com_offset: 0.0,
        ..Vehicle::tran2007()
    };
    let soil = Terrain::preset(terrain).expect("a terrain of the paper");
    VehicleModel::new(vehicle, soil).expect("the paper's parameters are valid")
}

/// The wrench at a motion, from scratch.
pub fn wrench(model: &VehicleModel, motion: &Motion) -> Wrench {
    let mut balance = Balance::new(model);
    model.solve(motion, &mut balance).expect("a balance");
    let mut wrench = Wrench::for_model(model);
    balance.wrench(model, motion, &mut wrench);
    wrench
}

/// Both sides at these speeds [rad/s].
pub fn speeds(left: f64, right: f64) -> WheelSpeeds {
    WheelSpeeds { left, right }
}

/// Drives with wheel speeds that are linear between the rows `(time, left, right)`, calling
/// `look` at every row.
pub fn drive(
    simulation: &mut Simulation,
    table: &[(f64, f64, f64)],
    mut look: impl FnMut(usize, &mut Simulation),
) {
    for (index, &(time, left, right)) in table.iter().enumerate() {
        simulation.set_wheel_speeds(speeds(left, right)).unwrap();
        look(index, simulation);
        if let Some(&(next, next_left, next_right)) = table.get(index + 1) {
            let step = next - time;
            let rates = speeds((next_left - left) / step, (next_right - right) / step);
            simulation.set_wheel_accelerations(rates).unwrap();
            simulation.step(step).unwrap();
        }
    }
}

/// The paper's kind of manoeuvre: accelerate straight ahead from rest, then turn right.
pub fn accelerate_then_turn_right(step: f64) -> Vec<(f64, f64, f64)> {
    let count = (6.0 / step).round() as usize;
    (0..=count)
        .map(|k| {
            let t = k as f64 * step;
            let straight = 7.0 * (t / 2.0).min(1.0);
            let turn = (t - 2.5).clamp(0.0, 1.0);
            (t, straight + 1.5 * turn, straight - 3.5 * turn)
        })
        .collect()
}

/// A simulation at a given state.
pub fn starting_at(model: VehicleModel, state: State) -> Simulation {
    let mut simulation = Simulation::new(model);
    simulation.set_state(state).unwrap();
    simulation
}

/// Random motions: V_X, V_Y, Omega, and both wheel speeds alike.
pub fn motions(
    v_x: impl Strategy<Value = f64>,
    v_y: impl Strategy<Value = f64>,
    yaw_rate: impl Strategy<Value = f64>,
    omega: impl Strategy<Value = f64> + Clone,
) -> impl Strategy<Value = Motion> {
    (v_x, v_y, yaw_rate, omega.clone(), omega).prop_map(
        |(v_x, v_y, yaw_rate, omega_left, omega_right)| Motion {
            v_x,
            v_y,
            yaw_rate,
            omega_left,
            omega_right,
        },
    )
}

/// Power that the soil takes up \[W\]: what the axles are driven with, less what the forces
/// on the vehicle do.
pub fn power_lost(vehicle: &Vehicle, motion: &Motion, wrench: &Wrench) -> f64 {
    let driven: f64 = wrench
        .wheels
        .iter()
        .zip([motion.omega_left, motion.omega_right].into_iter().cycle())
        .map(|(wheel, speed)| wheel.torque * speed)
        .sum();
    let moment = vehicle.yaw_inertia * wrench.yaw_acceleration;
    let moved = vehicle.mass * (wrench.a_x * motion.v_x + wrench.a_y * motion.v_y);
    driven - moved - moment * motion.yaw_rate
}
