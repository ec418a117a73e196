//! The integrator: accuracy for any communication step, work, determinism, no allocation.

use crate::common::{accelerate_then_turn_right, drive, paper_model, speeds, starting_at};
use std::ops::ControlFlow;
use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects, ParameterName};
use ugv_terrain::simulation::{
    SensitiveSimulation, Simulation, SimulationError, SnapshotError, State,
};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{
    ModelParameter, Specification, TerrainParameter, Vehicle, VehicleModel,
};

/// The state at the end of the paper's manoeuvre, inputs linear over 0.1 s, taken in
/// communication steps of `step` seconds.
fn end_state(terrain: &str, step: f64) -> State {
    let mut simulation = Simulation::new(paper_model(terrain));
    let parts = (0.1 / step).round() as usize;
    let table = accelerate_then_turn_right(0.1);
    for pair in table.windows(2) {
        let rate = |a: f64, b: f64| (b - a) / 0.1;
        simulation
            .set_wheel_speeds(speeds(pair[0].1, pair[0].2))
            .unwrap();
        let rates = speeds(rate(pair[0].1, pair[1].1), rate(pair[0].2, pair[1].2));
        simulation.set_wheel_accelerations(rates).unwrap();
        for _ in 0..parts {
            simulation.step(0.1 / parts as f64).unwrap();
        }
    }
    simulation.state()
}

#[test]
fn every_communication_step_gives_the_same_drive() {
    for terrain in Terrain::PRESETS {
        let reference = end_state(terrain, 1e-4);
        for step in [1e-3, 0.01, 0.1] {
            let state = end_state(terrain, step);
            let distance = (state.x - reference.x).hypot(state.y - reference.y);
            // The golden trajectories' tolerance: 2 mm and 1 mrad after 6 s.
            assert!(distance < 2e-3, "{terrain}, {step} s: {distance} m");
            assert!(
                (state.heading - reference.heading).abs() < 1e-3,
                "{terrain}, {step} s"
            );
        }
    }
}

#[test]
fn looks_within_a_step_see_the_drive_between_its_ends() {
    // The wheels spin up on one side: 2 s in one call, looked at every 20 ms without stopping there.
    for terrain in Terrain::PRESETS {
        let begin = || {
            let mut simulation = Simulation::new(paper_model(terrain));
            simulation.set_wheel_speeds(speeds(3.0, 3.0)).unwrap();
            simulation.step(1.0).unwrap();
            simulation
                .set_wheel_accelerations(speeds(1.0, -0.5))
                .unwrap();
            simulation
        };
        let mut stopping = begin();
        let mut looking = begin();
        let (mut reached, mut next, mut steps) = (0.0, 1, 0);
        looking
            .step_looking(2.0, |step| {
                reached += step.length();
                steps += 1;
                while next <= 100 && 0.02 * f64::from(next) <= reached + 1e-9 {
                    let back = reached - 0.02 * f64::from(next);
                    let (state, rates) = step.state(back);
                    stopping.step(0.02).unwrap();
                    let other = stopping.state().to_array();
                    let derivative = stopping.derivative().unwrap();
                    for (k, (a, b)) in state.to_array().iter().zip(other).enumerate() {
                        // A few times the integrator's tolerance.
                        assert!((a - b).abs() < 5e-4, "{terrain}, {next}, {k}: {a} {b}");
                        let (a, b) = (rates[k], derivative[k]);
                        assert!((a - b).abs() < 0.05, "{terrain}, {next}, rate {k}: {a} {b}");
                    }
                    next += 1;
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(next, 101);
        assert!(
            steps < 60,
            "{steps} steps: there was nothing to look within"
        );
    }
}

#[test]
fn a_look_breaks_a_step_off() {
    let mut simulation = Simulation::new(paper_model("sandy_loam"));
    simulation.set_wheel_speeds(speeds(2.0, 3.0)).unwrap();
    let mut looks = 0;
    let broken = simulation.step_looking(10.0, |_| {
        looks += 1;
        if looks < 3 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    assert!(matches!(broken, Err(SimulationError::StepBudget { time }) if time < 10.0));
    assert_eq!(looks, 3);
}

#[test]
fn long_steps_stay_few() {
    // Work counters on the smooth manoeuvre: 6 s in 60 communication steps.
    for terrain in Terrain::PRESETS {
        let mut simulation = Simulation::new(paper_model(terrain));
        drive(&mut simulation, &accelerate_then_turn_right(0.1), |_, _| {});
        let counters = simulation.counters();
        assert!(counters.steps < 250, "{terrain}: {counters:?}");
        assert!(counters.rejected < 25, "{terrain}: {counters:?}");
        assert!(counters.jacobians < 60, "{terrain}: {counters:?}");
        assert!(
            counters.steps >= 60 && counters.jacobians > 0,
            "{terrain}: {counters:?}"
        );
        assert!(
            counters.evaluations >= counters.steps,
            "{terrain}: {counters:?}"
        );
        assert!(counters.evaluations <= 2 * (counters.steps + counters.rejected));
    }
}

#[test]
fn standstill_and_high_speed_are_both_stable() {
    for terrain in Terrain::PRESETS {
        for step in [1e-4, 0.1] {
            let start = State {
                v_x: 5.0,
                ..State::default()
            };
            let mut simulation = starting_at(paper_model(terrain), start);
            simulation.set_wheel_speeds(speeds(20.0, 20.0)).unwrap();
            for _ in 0..20 {
                simulation.step(step).unwrap();
                assert!((0.5..6.0).contains(&simulation.state().v_x));
            }
        }
    }
}

#[test]
fn clones_and_restored_snapshots_go_on_to_the_bit() {
    let table = accelerate_then_turn_right(0.02);
    let mut whole = Simulation::new(paper_model("dry_sand"));
    let mut copies: Option<(Simulation, Simulation)> = None;
    drive(&mut whole, &table, |index, simulation| {
        if index == 150 {
            let clone = simulation.clone();
            let mut restored = Simulation::new(paper_model("dry_sand"));
            restored.restore(&simulation.snapshot()).unwrap();
            // A step that was put right at its end lies a little beside the state of its forces: these go along.
            let mut before = simulation.clone();
            assert_eq!(before.wrench().unwrap(), restored.wrench().unwrap());
            assert_eq!(before.derivative(), restored.derivative());
            copies = Some((clone, restored));
        }
    });
    let (mut clone, mut restored) = copies.unwrap();
    drive(&mut clone, &table[150..], |_, _| {});
    drive(&mut restored, &table[150..], |_, simulation| {
        // Reading leaves no trace.
        simulation.wrench().unwrap();
        simulation.jacobian().unwrap();
    });
    assert_eq!(whole.state(), clone.state());
    assert_eq!(whole.wrench().unwrap(), restored.wrench().unwrap());
    assert_eq!(whole.snapshot(), restored.snapshot());
}

#[test]
fn short_steps_go_without_evaluations_as_long_as_the_forces_are_linear() {
    // Under held and evenly changing wheel speeds in steps of 1 ms, and at rest; a jump of them is evaluated at once.
    for terrain in Terrain::PRESETS {
        let mut simulation = Simulation::new(paper_model(terrain));
        let mut evaluations = |seconds: f64, from: f64, rate: f64| {
            let before = simulation.counters().evaluations;
            let steps = (seconds / 1e-3).round() as usize;
            for step in 0..steps {
                let speed = from + rate * 1e-3 * step as f64;
                simulation.set_wheel_speeds(speeds(speed, speed)).unwrap();
                simulation
                    .set_wheel_accelerations(speeds(rate, rate))
                    .unwrap();
                simulation.step(1e-3).unwrap();
            }
            simulation.counters().evaluations - before
        };
        let starts = evaluations(2.0, 0.0, 2.0);
        let held = evaluations(1.0, 4.0, 0.0);
        let jump = evaluations(1e-3, 6.0, 0.0);
        evaluations(4.0, 6.0, -1.5);
        evaluations(2.0, 0.0, 0.0);
        let rest = evaluations(1.0, 0.0, 0.0);
        println!("{terrain}: {starts} {held} {jump} {rest}");
        assert!(starts < 700 && held < 150 && rest < 150, "{terrain}");
        assert!(jump >= 1, "{terrain}");
    }
}

/// A slalom on sand with a pivot and a stop, in steps of 10 ms that are longer by a share of themselves.
fn slalom(longer: f64) -> State {
    let mut simulation = Simulation::new(paper_model("dry_sand"));
    let at = |time: f64| {
        let ahead = 5.0 * (0.3 * time).sin();
        let turn = 2.0 * (0.8 * time).sin();
        speeds(ahead - turn, ahead + turn)
    };
    for k in 0..3000 {
        let time = 0.01 * f64::from(k);
        let (from, to) = (at(time), at(time + 0.01));
        let rate = |a: f64, b: f64| (b - a) / 0.01;
        simulation.set_wheel_speeds(from).unwrap();
        let rates = speeds(rate(from.left, to.left), rate(from.right, to.right));
        simulation.set_wheel_accelerations(rates).unwrap();
        simulation.step(0.01 * (1.0 + longer)).unwrap();
    }
    simulation.state()
}

#[test]
fn rounding_of_the_steps_does_not_grow() {
    let (one, other) = (slalom(0.0).to_array(), slalom(1e-14).to_array());
    for (one, other) in one.iter().zip(other) {
        assert!((one - other).abs() < 1e-9, "{one} {other}");
    }
}

#[test]
fn a_time_that_differs_by_rounding_is_no_other_time() {
    let effects = Effects::default().with("grade.slope_east", 0.05).unwrap();
    let terrain = Terrain::preset("dry_sand").unwrap();
    let specification = Specification {
        effects,
        ..Specification::plain(Vehicle::tran2007(), terrain)
    };
    let end = |other: f64| {
        let model = VehicleModel::from_specification(&specification).unwrap();
        let mut simulation = Simulation::new(model);
        simulation.set_wheel_speeds(speeds(4.0, 3.0)).unwrap();
        for k in 0..200 {
            let time = 0.01 * f64::from(k);
            simulation.set_time(time * (1.0 + other)).unwrap();
            simulation.step(0.01).unwrap();
        }
        (simulation.state().to_array(), simulation.counters())
    };
    let ((one, cost), (other, same)) = (end(0.0), end(f64::EPSILON));
    assert_eq!(cost, same);
    assert_eq!(one, other);
}

#[test]
fn derivatives_change_no_bit_of_the_motion() {
    let terrain = Terrain::preset("dry_sand").unwrap();
    let specification = Specification::plain(Vehicle::tran2007(), terrain);
    let friction = ModelParameter::Terrain(TerrainParameter::FrictionAngle);
    for coarse in [false, true] {
        let mut varied = SensitiveSimulation::new(&specification, &[friction]).unwrap();
        if coarse {
            varied = varied.with_coarse_derivatives();
        }
        let mut plain = Simulation::new(paper_model("dry_sand"));
        for pair in accelerate_then_turn_right(0.25).windows(2) {
            let rate = |a: f64, b: f64| (b - a) / 0.25;
            let from = speeds(pair[0].1, pair[0].2);
            let rates = speeds(rate(pair[0].1, pair[1].1), rate(pair[0].2, pair[1].2));
            varied.drive(from, rates).unwrap();
            varied.step(0.25).unwrap();
            plain.set_wheel_speeds(from).unwrap();
            plain.set_wheel_accelerations(rates).unwrap();
            plain
                .step_looking(0.25, |_| ControlFlow::Continue(()))
                .unwrap();
            assert_eq!(varied.state(), plain.state());
        }
    }
}

#[test]
fn a_snapshot_of_another_vehicle_is_refused() {
    let mut simulation = Simulation::new(paper_model("dry_sand"));
    let expected = simulation.snapshot().len();
    let refused = simulation.restore(&[0.0; 3]);
    assert_eq!(refused, Err(SnapshotError::Count { expected, found: 3 }));
}

#[test]
fn numbers_that_no_simulation_has_are_no_snapshot() {
    let mut simulation = Simulation::new(paper_model("dry_sand"));
    simulation.set_wheel_speeds(speeds(3.0, 2.0)).unwrap();
    simulation.step(0.5).unwrap();
    let snapshot = simulation.snapshot();
    for number in [f64::NAN, -1.0, 0.0] {
        for place in 0..snapshot.len() {
            let mut other = snapshot.clone();
            other[place] = number;
            let mut restored = Simulation::new(paper_model("dry_sand"));
            if restored.restore(&other).is_ok() {
                // Of time and state none may be NaN.
                assert!(place > State::COUNT || !number.is_nan(), "{place}");
                // Whatever it is then, a step ends.
                let _ = restored.step(0.05);
            } else {
                assert_eq!(restored.state(), State::default());
            }
        }
    }
}

#[test]
fn a_budget_of_steps_that_is_used_up_leaves_a_state_to_go_on_from() {
    let begin = || {
        let mut simulation = Simulation::new(paper_model("clayed_soil"));
        simulation.set_wheel_speeds(speeds(3.0, 2.0)).unwrap();
        simulation
            .set_wheel_accelerations(speeds(1.0, 0.5))
            .unwrap();
        simulation
    };
    let mut whole = begin();
    whole.step(2.0).unwrap();
    let mut halted = begin();
    halted.limit_steps(5);
    let error = halted.step(2.0).unwrap_err();
    let time = halted.time();
    assert_eq!(error, SimulationError::StepBudget { time });
    assert!(time > 0.0 && time < 2.0, "{time}");
    // Time, inputs and state belong together.
    assert!((halted.wheel_speeds().left - (3.0 + time)).abs() < 1e-12);
    halted.limit_steps(u64::MAX);
    halted.step(2.0 - time).unwrap();
    let (a, b) = (halted.state(), whole.state());
    assert!((a.x - b.x).hypot(a.y - b.y) < 1e-5, "{a:?} {b:?}");
}

/// How often a model allocates in steps after the first ones.
fn allocations(model: VehicleModel) -> u64 {
    let mut simulation = Simulation::new(model);
    simulation
        .set_wheel_accelerations(speeds(3.0, 2.0))
        .unwrap();
    simulation.step(0.5).unwrap();
    let count = allocation_counter::measure(|| {
        for _ in 0..100 {
            simulation.set_wheel_speeds(speeds(6.0, 4.0)).unwrap();
            simulation.step(0.02).unwrap();
            simulation.wrench().unwrap();
        }
    });
    count.count_total
}

#[test]
fn stepping_allocates_nothing() {
    assert_eq!(allocations(paper_model("clayed_soil")), 0);
    let plain = paper_model("clayed_soil").specification().clone();
    for effect in CATALOGUE {
        // Tracks grow as they are left.
        if effect.kind != EffectKind::Physics || effect.name == "multipass" {
            continue;
        }
        let mut specification = plain.clone();
        for name in ParameterName::all() {
            let (of, parameter) = name.declaration();
            if of.name == effect.name && parameter.switches {
                let far = if parameter.default < parameter.high {
                    parameter.high
                } else {
                    parameter.low
                };
                let value = parameter.default + 0.05 * (far - parameter.default);
                specification.effects.set(name, value).unwrap();
            }
        }
        let model = VehicleModel::from_specification(&specification).unwrap();
        assert_eq!(allocations(model), 0, "{}", effect.name);
    }
}

#[test]
fn steps_and_inputs_that_make_no_sense_are_refused_and_change_nothing() {
    let mut simulation = Simulation::new(paper_model("clayed_soil"));
    let untouched = simulation.snapshot();
    assert_eq!(simulation.step(-0.1), Err(SimulationError::StepSize(-0.1)));
    assert!(simulation.step(f64::NAN).is_err());
    assert!(simulation.step(1e300).is_err());
    assert!(simulation.set_time(f64::NAN).is_err());
    assert!(simulation.set_wheel_speeds(speeds(f64::NAN, 0.0)).is_err());
    assert!(
        simulation
            .set_wheel_accelerations(speeds(0.0, f64::INFINITY))
            .is_err()
    );
    let state = State {
        x: f64::NAN,
        ..State::default()
    };
    let error = simulation.set_state(state).unwrap_err();
    assert!(error.to_string().contains("x = NaN"), "{error}");
    assert_eq!(simulation.snapshot(), untouched);
}

#[test]
fn velocities_too_large_for_finite_forces_are_an_error() {
    let start = State {
        v_x: 1e200,
        ..State::default()
    };
    let mut simulation = starting_at(paper_model("clayed_soil"), start);
    assert!(simulation.step(0.01).is_err());
}
