//! Properties that hold whatever the numbers are.

mod common;

use common::{motions, paper_model, power_lost, speeds, starting_at, symmetric_model, wrench};
use proptest::prelude::*;
use ugv_terrain::simulation::{Simulation, State};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::Motion;

/// Newton's method leaves some 1e-7 of a wheel's force of 1000 N.
const FORCE_TOLERANCE: f64 = 1e-2;

fn terrain() -> impl Strategy<Value = &'static str> {
    prop::sample::select(Terrain::PRESETS.to_vec())
}

fn motion() -> impl Strategy<Value = Motion> {
    let speed = prop_oneof![-50.0..50.0, -1.0..1.0, Just(0.0)];
    let velocity = prop_oneof![-10.0..10.0, -0.02..0.02, Just(0.0)];
    let yaw_rate = prop_oneof![-4.0..4.0, -0.05..0.05, Just(0.0)];
    motions(velocity.clone(), velocity, yaw_rate, speed)
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(1.0)
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
