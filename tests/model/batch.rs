//! Batches: the same bits as one drive after the other, in the order of the members, each with its own error.

use crate::common::{accelerate_then_turn_right, drive, paper_model, speeds};
use rayon::ThreadPoolBuilder;
use std::sync::Arc;
use ugv_terrain::effects::Effects;
use ugv_terrain::simulation::batch::{
    Rollout, TableError, Trajectory, WheelSpeedTable, each, step, trajectories,
};
use ugv_terrain::simulation::{Simulation, SimulationError, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, Vehicle, VehicleModel};

fn table(rows: &[(f64, f64, f64)]) -> Arc<WheelSpeedTable> {
    let time = rows.iter().map(|row| row.0).collect();
    let wheels = rows.iter().map(|row| speeds(row.1, row.2)).collect();
    Arc::new(WheelSpeedTable::new(time, wheels).unwrap())
}

/// Soils, masses and an effect with memory, in turns to the right and to the left.
fn members() -> Vec<Rollout> {
    let right = accelerate_then_turn_right(0.1);
    let left: Vec<_> = right.iter().map(|&(t, l, r)| (t, r, l)).collect();
    let inputs = [table(&right), table(&left)];
    let rutted = Effects::NONE.with("multipass.memory", 0.5).unwrap();
    let member = |index: usize| {
        let soil = Terrain::preset(Terrain::PRESETS[index % 4]).unwrap();
        let vehicle = Vehicle {
            mass: 400.0 + 10.0 * index as f64,
            ..Vehicle::tran2007()
        };
        let mut model = Specification::plain(vehicle, soil);
        if index.is_multiple_of(3) {
            model.effects = rutted.clone();
        }
        Rollout {
            simulation: Simulation::new(VehicleModel::from_specification(&model).unwrap()),
            inputs: inputs[index % 2].clone(),
        }
    };
    (0..12).map(member).collect()
}

/// A member that sinks to its axles, at rest already.
fn bogged() -> Rollout {
    let heavy = Vehicle {
        mass: 1e5,
        ..Vehicle::tran2007()
    };
    let soil = Terrain::preset("dry_sand").unwrap();
    Rollout {
        simulation: Simulation::new(VehicleModel::new(heavy, soil).unwrap()),
        inputs: table(&[(0.0, 0.0, 0.0), (1.0, 5.0, 5.0)]),
    }
}

fn bits(trajectory: &Trajectory) -> Vec<u64> {
    let states = trajectory.states.iter().flat_map(|state| state.to_array());
    let numbers = trajectory.time.iter().copied().chain(states);
    numbers.map(f64::to_bits).collect()
}

#[test]
fn a_batch_has_the_bits_of_one_drive_after_the_other_for_any_number_of_threads() {
    let alone: Vec<Trajectory> = members().iter_mut().map(Rollout::trajectory).collect();
    assert_ne!(bits(&alone[0]), bits(&alone[1]));
    for threads in [1, 2, 5] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let mut batch = members();
        let together = pool.unwrap().install(|| trajectories(&mut batch));
        assert_eq!(together.len(), alone.len());
        for ((a, b), member) in alone.iter().zip(&together).zip(&batch) {
            assert_eq!((&a.error, a.states.len()), (&None, 61));
            assert_eq!(bits(a), bits(b));
            assert_eq!(b.states.last(), Some(&member.simulation.state()));
        }
    }
}

#[test]
fn a_member_drives_as_an_importer_steps_the_fmu() {
    let rows = accelerate_then_turn_right(0.1);
    let mut simulation = Simulation::new(paper_model("sandy_loam"));
    let mut states = Vec::new();
    drive(&mut simulation, &rows, |_, simulation| {
        states.push(simulation.state());
    });
    // The times of a recording may start anywhere.
    let shifted: Vec<_> = rows.iter().map(|&(t, l, r)| (t + 4.0, l, r)).collect();
    for rows in [&rows, &shifted] {
        let simulation = Simulation::new(paper_model("sandy_loam"));
        let inputs = table(rows);
        let driven = Rollout { simulation, inputs }.trajectory();
        // Rounding of the times.
        let near = |a: &State, b: &State| (a.x - b.x).hypot(a.y - b.y) < 1e-9;
        assert!(driven.states.iter().zip(&states).all(|(a, b)| near(a, b)));
        assert_eq!(driven.states.len(), states.len());
    }
}

#[test]
fn a_rollout_goes_on_from_where_its_simulation_stands() {
    // As a controller that tries inputs: the same drive in one table or in two.
    let rows = accelerate_then_turn_right(0.1);
    let whole = Rollout {
        simulation: Simulation::new(paper_model("dry_clay")),
        inputs: table(&rows),
    };
    let mut halves = Rollout {
        inputs: table(&rows[..31]),
        ..whole.clone()
    };
    let whole = { whole }.trajectory();
    let first = halves.trajectory();
    halves.inputs = table(&rows[30..]);
    let second = halves.trajectory();
    assert_eq!(first.states, whole.states[..31]);
    let (a, b) = (second.states[30], whole.states[60]);
    // Rounding of the times; the integrator's steps are the same.
    assert!((a.x - b.x).hypot(a.y - b.y) < 1e-6 && (a.heading - b.heading).abs() < 1e-6);
}

#[test]
fn an_error_ends_the_drive_of_one_member() {
    let mut batch = members();
    batch.insert(3, bogged());
    let driven = trajectories(&mut batch);
    assert_eq!(driven.len(), 13);
    for (place, trajectory) in driven.iter().enumerate() {
        let is_bogged = matches!(trajectory.error, Some(SimulationError::Balance { .. }));
        assert_eq!(is_bogged, place == 3, "{place}: {:?}", trajectory.error);
        // The bogged one stands at its first row.
        let rows = if is_bogged { 1 } else { 61 };
        assert_eq!(trajectory.states.len(), rows);
    }
}

#[test]
fn members_may_be_made_where_they_are_driven() {
    let limits = [2, 70, 5];
    let rows = each(&limits, |limit| {
        let mut member = members().swap_remove(1);
        let mut seen = 0;
        let ended = member.run(|row, simulation| {
            seen += 1;
            let value = simulation.wrench()?.rolling_resistance;
            let what = "limit";
            let too_far = SimulationError::NotFinite { what, value };
            if row < *limit { Ok(()) } else { Err(too_far) }
        });
        (seen, ended.is_err())
    });
    // The row of the error is seen, and none behind it; the table has 61.
    assert_eq!(rows, [(3, true), (61, false), (6, true)]);
}

#[test]
fn an_empty_batch_is_nothing() {
    assert_eq!(trajectories(&mut []), []);
    assert_eq!(each(&[0; 0], |_| 1), [0; 0]);
    assert_eq!(step(&mut [], 0.1, |_, _| Ok(speeds(1.0, 1.0))), []);
}

#[test]
fn a_learner_steps_a_batch() {
    let start: Vec<Simulation> = members().into_iter().map(|m| m.simulation).collect();
    // Each member another speed, and slower the further it is.
    let control = |place: usize, simulation: &mut Simulation| {
        let speed = 2.0 + place as f64 - simulation.state().x;
        Ok(speeds(speed, speed + 0.5))
    };
    let mut batch = start.clone();
    batch.push(bogged().simulation);
    let mut alone = start;
    for _ in 0..10 {
        let states = step(&mut batch, 0.1, control);
        assert!(states[12].is_err());
        for (place, simulation) in alone.iter_mut().enumerate() {
            let wheels = control(place, simulation).unwrap();
            simulation.set_wheel_speeds(wheels).unwrap();
            simulation.step(0.1).unwrap();
            assert_eq!(states[place], Ok(simulation.state()));
        }
    }
    assert!(alone[11].state().x > alone[0].state().x);
}

#[test]
fn wrong_tables_are_refused() {
    let still = WheelSpeeds::default();
    let new = |time: &[f64], wheels: &[WheelSpeeds]| {
        WheelSpeedTable::new(time.to_vec(), wheels.to_vec()).unwrap_err()
    };
    assert_eq!(new(&[], &[]), TableError::Empty);
    let (times, two) = (2, 1);
    assert_eq!(
        new(&[0.0, 1.0], &[still]),
        TableError::Lengths { times, speeds: two }
    );
    for time in [1.0, 0.5, f64::INFINITY] {
        let error = TableError::Time { row: 1, time };
        assert_eq!(new(&[1.0, time], &[still; 2]), error);
    }
    let error = new(&[0.0], &[speeds(1.0, f64::INFINITY)]);
    assert!(error.to_string().contains("row 0") && error.to_string().contains("inf rad/s"));
}
