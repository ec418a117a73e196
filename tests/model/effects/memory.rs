//! What the vehicle and its ground remember: held slopes, steady states, ruts.

use super::model;
use crate::common::{paper_model, speeds, symmetric_model};
use ugv_terrain::simulation::{Simulation, State};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Specification, VehicleModel};

/// 10 deg \[rad\].
const TEN_DEGREES: f64 = 0.174_532_925_199_432_95;

/// What a held vehicle may creep in a minute \[m\]: what the integrator tolerates in a step.
const STILL: f64 = 2e-5;
/// Steps with the shear as a state over those of the paper's model, which has no springs.
const MOST_STEPS: f64 = 3.0;

/// Positions along the slope after a minute with locked wheels (set down on untouched soil the
/// vehicle overshoots, and springs back by some tenths of a millimetre per second), and after another.
fn parked(model: VehicleModel) -> [State; 2] {
    let mut parked = Simulation::new(model);
    [60.0, 60.0].map(|seconds| {
        parked.step(seconds).unwrap();
        parked.state()
    })
}

#[test]
fn locked_wheels_hold_a_slope_of_ten_degrees_without_creeping() {
    for terrain in Terrain::PRESETS {
        for (slope, heading) in [
            ("grade.slope_east", "uphill"),
            ("grade.slope_north", "across"),
        ] {
            let effects = [(slope, TEN_DEGREES), ("transient_shear.relaxation", 1.0)];
            let [settled, later] = parked(model(terrain, &effects));
            let crept = (later.x - settled.x).hypot(later.y - settled.y);
            println!("{terrain} {heading}: {crept:.1e} m in 60 s");
            assert!(crept < STILL, "{terrain} {heading}: {crept} m in 60 s");
            assert!(
                later.v_x.hypot(later.v_y) < 1e-5,
                "{terrain} {heading}: {later:?}"
            );
            // It gives by a few shear moduli until the soil holds.
            let given = later.x.hypot(later.y);
            assert!(
                given > 1e-4 && given < 0.15,
                "{terrain} {heading}: gave {given} m"
            );
            // The paper's model, whose shear forgets, creeps.
            let [settled, later] = parked(model(terrain, &[(slope, TEN_DEGREES)]));
            let crept = (later.x - settled.x).hypot(later.y - settled.y);
            assert!(crept > 1e-3, "{terrain} {heading}: {crept} m");
        }
    }
}

#[test]
fn the_steady_state_of_the_transient_is_the_papers() {
    let both_ways = Terrain::PRESETS
        .into_iter()
        .flat_map(|name| [(name, 1.0), (name, -1.0)]);
    for (terrain, ahead) in both_ways {
        let steady = |model: VehicleModel| {
            let mut drive = Simulation::new(model);
            drive
                .set_wheel_speeds(speeds(5.0 * ahead, 6.0 * ahead))
                .unwrap();
            drive.step(20.0).unwrap();
            drive.state()
        };
        let paper = steady(paper_model(terrain));
        let transient = steady(model(terrain, &[("transient_shear.relaxation", 1.0)]));
        for (name, a, b) in [
            ("v_x", paper.v_x, transient.v_x),
            ("v_y", paper.v_y, transient.v_y),
            ("yaw rate", paper.yaw_rate, transient.yaw_rate),
        ] {
            // What holds a wheel at rest turns the shear by some mm/s over the slip speed.
            assert!(
                (a - b).abs() < 5e-3 * paper.v_x.abs(),
                "{terrain} {ahead} {name}: {a} {b}"
            );
        }
    }
}

/// The shear of a rolling wheel fades at the paper's slip speed, only that of a held one at a much lower one, which takes
/// short steps.
#[test]
fn coming_to_rest_takes_few_steps() {
    let steps = |mut drive: Simulation| {
        for tenth in 0..60 {
            let speed = 4.0 * (-0.15 * f64::from(tenth)).exp();
            drive.set_wheel_speeds(speeds(speed, speed)).unwrap();
            drive.step(0.1).unwrap();
        }
        drive.counters().steps as f64
    };
    for terrain in Terrain::PRESETS {
        let paper = steps(Simulation::new(paper_model(terrain)));
        let effects = [("transient_shear.relaxation", 1.0)];
        let transient = steps(Simulation::new(model(terrain, &effects)));
        println!("{terrain}: {paper} {transient}");
        assert!(
            transient < MOST_STEPS * paper,
            "{terrain}: {paper} {transient}"
        );
    }
}

#[test]
fn forces_lag_the_motion_for_longer_with_a_longer_relaxation() {
    let reached = |relaxation: f64| {
        let mut drive = Simulation::new(model(
            "sandy_loam",
            &[("transient_shear.relaxation", relaxation)],
        ));
        drive.set_wheel_speeds(speeds(4.0, 4.0)).unwrap();
        drive.step(0.15).unwrap();
        drive.state().v_x
    };
    let [quick, physical, slow] = [0.3, 1.0, 4.0].map(reached);
    assert!(
        quick > physical && physical > slow && slow > 0.0,
        "{quick} {physical} {slow}"
    );
}

#[test]
fn in_a_turn_the_last_row_runs_in_the_rut_of_the_first() {
    // Both are as far from the middle about which the vehicle turns; the second row runs inside.
    let entry_angles = |memory: f64| {
        let mut drive = Simulation::new(model("dry_sand", &[("multipass.memory", memory)]));
        drive.set_wheel_speeds(speeds(2.0, 6.0)).unwrap();
        drive.step(15.0).unwrap();
        assert!(drive.state().yaw_rate > 0.1);
        let wrench = drive.wrench().unwrap();
        [0, 1, 2, 3].map(|row| wrench.wheels[2 * row].entry_angle)
    };
    let (plain, remembering) = (entry_angles(1e-9), entry_angles(1.0));
    let share = |row: usize| remembering[row] / plain[row];
    assert!(share(0) > 0.9, "{plain:?} {remembering:?}");
    for row in [2, 3] {
        assert!(share(row) < 0.75, "{plain:?} {remembering:?}");
    }
}

#[test]
fn rows_behind_run_in_the_rut_of_the_rows_ahead() {
    for terrain in Terrain::PRESETS {
        let run = |memory: f64, omega: f64| {
            let mut drive = Simulation::new(model(
                terrain,
                &[("multipass.memory", memory), ("com_shift.ahead", -0.17)],
            ));
            drive.set_wheel_speeds(speeds(omega, omega)).unwrap();
            drive.step(10.0).unwrap();
            drive
        };
        let mut remembering = run(1.0, 6.0);
        let wrench = remembering.wrench().unwrap().clone();
        let row = |index: usize| wrench.wheels[2 * index];
        for index in 1..4 {
            // Steeper ground: a shorter contact for about the same load, at least as deep a track.
            let (before, behind) = (row(index - 1), row(index));
            assert!(
                behind.entry_angle < 1.02 * before.entry_angle,
                "{terrain} row {index}"
            );
            assert!(
                behind.sinkage > 0.9 * before.sinkage,
                "{terrain} row {index}"
            );
        }
        // Dry clay hardly yields: its loading is nearly as steep as its unloading.
        let share = if terrain == "dry_clay" { 1.0 } else { 0.7 };
        assert!(row(1).entry_angle < share * row(0).entry_angle, "{terrain}");
        let mut forgetting = run(1e-9, 6.0);
        let plain = forgetting.wrench().unwrap();
        assert!(
            wrench.rolling_resistance < share.max(0.8) * plain.rolling_resistance,
            "{terrain}"
        );
        // In reverse the last row leads.
        let mut back = run(1.0, -6.0);
        let reverse = back.wrench().unwrap().clone();
        for index in 0..4 {
            let (ahead, behind) = (
                row(index).entry_angle,
                reverse.wheels[2 * (3 - index)].entry_angle,
            );
            assert!(
                (ahead - behind).abs() < 0.02 * ahead,
                "{terrain}: {ahead} {behind}"
            );
        }
    }
}

#[test]
fn the_rut_is_remembered_at_rest_and_left_behind_in_a_turn() {
    let mut drive = Simulation::new(model("dry_sand", &[("multipass.memory", 1.0)]));
    drive.set_wheel_speeds(speeds(6.0, 6.0)).unwrap();
    drive.step(8.0).unwrap();
    let names = drive.model().memory_names();
    assert_eq!(names[2], "wheel[3].rut_depth");
    drive.set_wheel_speeds(speeds(0.0, 0.0)).unwrap();
    drive.step(3.0).unwrap();
    let stopped = drive.memory()[2];
    drive.step(60.0).unwrap();
    assert!(stopped > 1e-3);
    assert!(
        (drive.memory()[2] - stopped).abs() < 1e-6,
        "{stopped} {:?}",
        drive.memory()
    );
    // On the spot every row slides out of the tracks, and then runs on the circle that the wheels before it pressed.
    drive.set_wheel_speeds(speeds(-6.0, 6.0)).unwrap();
    drive.step(2.0).unwrap();
    let (aside, slow) = (drive.memory()[2], drive.state().yaw_rate);
    assert!(aside < 0.7 * stopped, "{stopped} {:?}", drive.memory());
    drive.step(10.0).unwrap();
    let (circle, fast) = (drive.memory()[2], drive.state().yaw_rate);
    assert!(circle > 1.5 * aside, "{aside} {:?}", drive.memory());
    assert!(fast > 1.05 * slow, "{slow} {fast}");
}

#[test]
fn saved_memory_is_taken_up_again() {
    let build = || {
        model(
            "sandy_loam",
            &[
                ("multipass.memory", 1.0),
                ("transient_shear.relaxation", 1.0),
            ],
        )
    };
    let mut drive = Simulation::new(build());
    drive.set_wheel_speeds(speeds(5.0, 7.0)).unwrap();
    drive.step(1.5).unwrap();
    let saved = drive.snapshot();
    let mut other = Simulation::new(build());
    other.restore(&saved).unwrap();
    drive.step(1.0).unwrap();
    other.step(1.0).unwrap();
    assert_eq!(drive.state(), other.state());
    assert_eq!(drive.memory(), other.memory());
    assert_eq!(drive.wrench().unwrap(), other.wrench().unwrap());
}

#[test]
fn derivatives_are_there_as_soon_as_a_state_is_taken_up() {
    let build = || model("sandy_loam", &[("drag.coefficient", 7.0)]);
    let mut drive = Simulation::new(build());
    drive.set_wheel_speeds(speeds(5.0, 7.0)).unwrap();
    drive.step(1.5).unwrap();
    let mut other = Simulation::new(build());
    other.restore(&drive.snapshot()).unwrap();
    assert_eq!(drive.jacobian().unwrap(), other.jacobian().unwrap());
}

#[test]
fn tyres_on_hard_ground_grip_while_shear_builds_up() {
    // The contact is a few centimetres, on a circle of kilometres: shear has built up after as much.
    let tyres = ("tyre_compliance.pressure", 60e3);
    let mut at_once = Simulation::new(model("dry_clay", &[tyres]));
    let slow = [tyres, ("transient_shear.relaxation", 1.0)];
    let mut slow = Simulation::new(model("dry_clay", &slow));
    for drive in [&mut at_once, &mut slow] {
        drive.set_wheel_speeds(speeds(5.0, 5.0)).unwrap();
        drive.step(3.0).unwrap();
    }
    let (x, all) = (slow.state().x, at_once.state().x);
    assert!(all > 1.0 && (x / all - 1.0).abs() < 0.1, "{x} {all}");
}

#[test]
fn a_bump_shorter_than_a_step_is_felt() {
    use ugv_terrain::effects::{Effects, Extent, Points, SlopeProfile, Window};
    let flat = super::specification("dry_clay", Effects::NONE);
    let driven = |on: &Specification, begin: f64, steps: u32| {
        let mut drive = Simulation::new(VehicleModel::from_specification(on).unwrap());
        drive.set_time(begin).unwrap();
        drive.set_wheel_speeds(speeds(4.0, 4.0)).unwrap();
        for _ in 0..steps {
            drive.step(20.0 / f64::from(steps)).unwrap();
        }
        drive.state().x
    };
    // Where in its steps the drive comes upon it, is by chance.
    for k in 0..8 {
        let bump = 10.0 + 0.07 * f64::from(k);
        let at = [0.0, bump, bump + 0.05, bump + 0.1, 30.0].to_vec();
        let slopes = [0.0, 0.0, 0.3, 0.0, 0.0].map(|east| [east, 0.0]).to_vec();
        let points = Points::new(at, slopes).unwrap();
        let mut disc = Effects::NONE.with("grade.slope_east", 0.2).unwrap();
        disc.window = Some(Window {
            effects: vec![0],
            extent: Extent::Place {
                x: bump,
                y: 0.0,
                radius: 0.06,
            },
        });
        let sloped = |profile| {
            let mut effects = Effects::NONE;
            effects.slope_profile = Some(profile);
            effects
        };
        for (begin, effects) in [
            (0.4, sloped(SlopeProfile::Time(points.clone()))),
            (0.0, sloped(SlopeProfile::Distance(points))),
            (0.0, disc),
        ] {
            let bumpy = super::specification("dry_clay", effects);
            let [flat, at_once, in_steps] = [(&flat, 1), (&bumpy, 1), (&bumpy, 2000)]
                .map(|(on, steps)| driven(on, begin, steps));
            let (felt, wanted) = (flat - at_once, flat - in_steps);
            assert!(
                wanted > 5e-4 && (felt / wanted - 1.0).abs() < 0.3,
                "{bump}: {felt} {wanted}"
            );
        }
    }
}

#[test]
fn the_distance_is_remembered_where_a_profile_needs_it() {
    use ugv_terrain::effects::{Effects, Points, SlopeProfile};
    let mut effects = Effects::NONE;
    let points = Points::new(vec![3.0, 3.5], vec![[0.0; 2], [0.15, 0.0]]).unwrap();
    effects.slope_profile = Some(SlopeProfile::Distance(points));
    let specification = super::specification("dry_clay", effects);
    let mut drive = Simulation::new(VehicleModel::from_specification(&specification).unwrap());
    let mut flat = Simulation::new(symmetric_model("dry_clay"));
    for drive in [&mut drive, &mut flat] {
        drive.set_wheel_speeds(speeds(4.0, 4.0)).unwrap();
        drive.step(2.0).unwrap();
    }
    let before = drive.state().x;
    assert!((drive.memory()[0] - before).abs() < 1e-3);
    let level = drive.wrench().unwrap().wheels[6].load;
    drive.step(8.0).unwrap();
    // Uphill the rear rows carry more.
    assert!(drive.wrench().unwrap().wheels[6].load > level + 50.0);
}
