//! Whatever legal vehicle, soil, effects and wheel speeds: every drive ends, in time, or says why it cannot.

mod draw;

use draw::Drive;
use rayon::prelude::*;
use ugv_terrain::effects::Effects;
use ugv_terrain::simulation::{Simulation, SimulationError, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{
    Balance, BalanceError, Motion, Specification, Vehicle, VehicleModel, Wrench,
};

/// Random drives and motions of each kind in every run, and in a campaign.
const SOME: u64 = 60;
const MANY: u64 = 2000;

fn is_bogged(error: &SimulationError) -> bool {
    let SimulationError::Balance { source, .. } = error else {
        return false;
    };
    matches!(source, BalanceError::Bogged { .. })
}

/// Drives them all: none may end but by bogging down.
fn all_end(count: u64, drives: impl Fn(u64) -> Drive + Sync) {
    let failures: Vec<String> = (0..count)
        .into_par_iter()
        .filter_map(|seed| {
            let drive = drives(seed);
            let error = draw::run(&drive).err().filter(|error| !is_bogged(error))?;
            Some(format!("{}: {error}", drive.what))
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn plausible_drives_end_or_bog_down() {
    all_end(SOME, draw::plausible);
}

#[test]
fn effects_at_the_ends_of_their_ranges_can_be_driven() {
    all_end(SOME, draw::at_ends);
}

#[test]
#[ignore = "nightly: thousands of drives"]
fn a_campaign_of_drives_ends_or_bogs_down() {
    all_end(MANY, draw::plausible);
    all_end(MANY, draw::at_ends);
}

/// Firm clay with a load-bearing that grows about as the sinkage does: a braked wheel is dragged down.
fn clay(cohesion: f64, exponent: f64) -> Terrain {
    Terrain {
        cohesion,
        friction_angle: 28f64.to_radians(),
        cohesive_modulus: 8400.0,
        frictional_modulus: 2e6,
        sinkage_exponent: exponent,
        shear_modulus: 0.01,
    }
}

#[test]
fn every_motion_on_cohesive_soil_has_a_balance_or_a_wheel_that_cannot_carry_its_load() {
    balances(SOME);
}

#[test]
#[ignore = "nightly: thousands of motions"]
fn a_campaign_of_motions_on_cohesive_soil_has_a_balance_or_such_a_wheel() {
    balances(MANY);
}

fn balances(count: u64) {
    let mut rng = fastrand::Rng::with_seed(5);
    for cohesion in [5e3, 10e3, 20e3, 30e3, 50e3, 70e3] {
        for exponent in [0.3, 0.8, 1.0, 1.1, 1.3] {
            let model = VehicleModel::new(Vehicle::tran2007(), clay(cohesion, exponent)).unwrap();
            for _ in 0..count / 3 {
                let mut within = |size: f64| size * (2.0 * rng.f64() - 1.0);
                let motion = Motion::from_array([2.0, 0.5, 1.5, 8.0, 8.0].map(&mut within));
                let mut balance = Balance::new(&model);
                match model.solve(&motion, &mut balance) {
                    Ok(()) => check(&model, &motion, &balance),
                    // The soil would bear the vehicle at rest: what drags it down is said.
                    Err(error @ BalanceError::Bogged { .. }) => {
                        assert!(exponent >= 1.0 && cohesion > 20e3, "{cohesion} {exponent}");
                        assert!(error.to_string().contains("drags it down"), "{error}");
                    }
                    Err(error) => panic!("{cohesion} Pa, n {exponent}: {error}"),
                }
            }
        }
    }
}

/// The loads carry the weight, and the accelerations are the forces'.
fn check(model: &VehicleModel, motion: &Motion, balance: &Balance) {
    let mut wrench = Wrench::for_model(model);
    balance.wrench(model, motion, &mut wrench);
    let weight = 490.0 * 9.81;
    let sum: f64 = wrench.wheels.iter().map(|wheel| wheel.load).sum();
    assert!((sum / weight - 1.0).abs() < 1e-9, "{sum}");
    let force_x: f64 = wrench.wheels.iter().map(|wheel| wheel.force_x).sum();
    let force_y: f64 = wrench.wheels.iter().map(|wheel| wheel.force_y).sum();
    let missing = [force_x / 490.0 - wrench.a_x, force_y / 490.0 - wrench.a_y];
    assert!(missing.iter().all(|a| a.abs() < 0.01), "{missing:?}");
}

/// An emergency stop from 1 m/s.
fn stop(terrain: Terrain, effects: Effects) -> Simulation {
    let specification = Specification {
        vehicle: Vehicle::tran2007(),
        terrain,
        effects,
    };
    let model = VehicleModel::from_specification(&specification).unwrap();
    let mut simulation = Simulation::new(model);
    let start = State {
        v_x: 1.0,
        ..State::default()
    };
    simulation.set_state(start).unwrap();
    simulation
}

#[test]
fn an_emergency_stop_on_firm_clay_ends_at_rest() {
    for (cohesion, exponent) in [(5e3, 1.3), (15e3, 1.1), (20e3, 1.0), (30e3, 0.8)] {
        let mut simulation = stop(clay(cohesion, exponent), Effects::default());
        let mut speed = 1.0;
        for _ in 0..300 {
            simulation.step(0.01).unwrap();
            let state = simulation.state();
            // Nothing drives: the vehicle only ever slows down.
            assert!(state.v_x.abs() <= speed + 1e-9, "{state:?}");
            speed = state.v_x.abs();
        }
        let state = simulation.state();
        assert!(state.x > 0.0 && state.x < 0.2, "{state:?}");
        assert!(state.v_x.abs() < 1e-6 && state.y.abs() < 1e-6, "{state:?}");
    }
}

#[test]
fn soft_tyres_on_dry_clay_turn() {
    for pressure in [15e3, 20e3, 35e3, 60e3] {
        let effects = Effects::default()
            .with("tyre_compliance.pressure", pressure)
            .unwrap();
        let mut simulation = stop(Terrain::preset("dry_clay").unwrap(), effects);
        simulation.set_state(State::default()).unwrap();
        let rates = WheelSpeeds {
            left: 3.0,
            right: 2.0,
        };
        simulation.set_wheel_accelerations(rates).unwrap();
        simulation.step(1.0).unwrap();
        simulation
            .set_wheel_accelerations(WheelSpeeds::default())
            .unwrap();
        simulation.step(4.0).unwrap();
        let state = simulation.state();
        assert!(
            state.v_x > 0.5 && state.yaw_rate < -0.01,
            "{pressure} {state:?}"
        );
    }
}

#[test]
fn a_relaxation_that_is_hardly_there_ends_as_the_shortest_one() {
    let end = |relaxation: f64| {
        let effects = Effects::default()
            .with("transient_shear.relaxation", relaxation)
            .unwrap();
        let mut simulation = stop(Terrain::preset("clayed_soil").unwrap(), effects);
        let mut table = [(0.0, [5.0, 5.0]), (0.4, [9.0, 1.0]), (1.0, [10.0, 0.0])].to_vec();
        table.push((3.0, [-3.0, 8.0]));
        draw::follow(&mut simulation, &table).unwrap();
        simulation.state()
    };
    let (shortest, longer) = (end(1e-7), end(0.02));
    assert_eq!(shortest, end(1e-3));
    let apart = (shortest.x - longer.x).hypot(shortest.y - longer.y);
    assert!(apart > 0.0 && apart < 1e-3, "{apart}");
}

#[test]
fn what_is_too_stiff_says_so_and_names_the_parameter() {
    let mut soil = Terrain::preset("clayed_soil").unwrap();
    soil.shear_modulus = 1e-12;
    let model = VehicleModel::new(Vehicle::tran2007(), soil).unwrap();
    let mut simulation = Simulation::new(model);
    simulation.limit_work(5.0);
    let rates = WheelSpeeds {
        left: 3.0,
        right: -2.0,
    };
    simulation.set_wheel_accelerations(rates).unwrap();
    let error = simulation.step(6.0).unwrap_err();
    let SimulationError::TooStiff { time, suspect } = &error else {
        panic!("{error}");
    };
    assert!((0.0..6.0).contains(time));
    assert_eq!(suspect.as_ref().unwrap().name, "shear_modulus");
    assert!(
        error.to_string().contains("shear_modulus = 1.0000e-12 m"),
        "{error}"
    );
    // It stands where it came to, and can be driven on from there.
    assert_eq!(simulation.time(), *time);
    simulation.limit_work(1e9);
    simulation.step(0.1).unwrap();
}
