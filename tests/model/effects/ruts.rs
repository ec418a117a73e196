//! Wheels in the tracks that they and others left.

use super::derivatives::{Differentiated, by_shares};
use super::{model, specification};
use ugv_terrain::effects::Effects;
use ugv_terrain::simulation::{SensitiveSimulation, Simulation, State, WheelSpeeds};
use ugv_terrain::vehicle::{ModelParameter, Specification, VehicleModel, seen_from};

fn speeds(left: f64, right: f64) -> WheelSpeeds {
    WheelSpeeds { left, right }
}

/// Depth to which the soil that the first row's left wheel meets was pressed before, and the last row's \[m\].
fn met(drive: &Simulation) -> [f64; 2] {
    let memory = drive.memory();
    [memory[0], memory[memory.len() - 2]]
}

#[test]
fn the_first_row_meets_untouched_ground_and_its_own_track_on_the_way_back() {
    let mut drive = Simulation::new(model("dry_sand", &[("multipass.memory", 1.0)]));
    drive.set_wheel_speeds(speeds(5.0, 5.0)).unwrap();
    drive.step(6.0).unwrap();
    let [first, last] = met(&drive);
    assert!(first < 1e-6 && last > 5e-3, "{first} {last}");
    // Turning back takes less than the length of the vehicle.
    drive.set_wheel_speeds(speeds(-5.0, -5.0)).unwrap();
    drive.step(0.6).unwrap();
    let [first, last] = met(&drive);
    assert!(first > 5e-3 && last > 5e-3, "{first} {last}");
    // Behind the place where it began.
    drive.step(10.0).unwrap();
    let [first, last] = met(&drive);
    assert!(first > 5e-3 && last < 1e-4, "{first} {last}");
}

#[test]
fn a_vehicle_that_is_placed_elsewhere_stands_on_untouched_ground() {
    let mut drive = Simulation::new(model("dry_sand", &[("multipass.memory", 1.0)]));
    drive.set_wheel_speeds(speeds(5.0, 5.0)).unwrap();
    drive.step(4.0).unwrap();
    let state = State {
        y: 20.0,
        ..drive.state()
    };
    drive.set_state(state).unwrap();
    drive.step(0.3).unwrap();
    let [_, last] = met(&drive);
    assert!(last < 1e-3, "{last}");
}

#[test]
fn tracks_of_a_long_drive_are_those_of_a_settled_one() {
    // Straight on, and in a bend.
    for (left, right, share) in [(5.0, 5.0, 5e-3), (3.0, 6.0, 2e-2)] {
        let mut drive = Simulation::new(model("sandy_loam", &[("multipass.memory", 0.8)]));
        drive.set_wheel_speeds(speeds(left, right)).unwrap();
        // Less than a whole circle, where it would come upon its own tracks.
        drive.step(8.0).unwrap();
        let mut settled = Simulation::new(model("sandy_loam", &[("multipass.memory", 0.8)]));
        settled.set_state(drive.state()).unwrap();
        settled.set_wheel_speeds(speeds(left, right)).unwrap();
        settled.settle().unwrap();
        let deepest = drive.memory().iter().fold(0.0_f64, |a, b| a.max(*b));
        assert!(deepest > 5e-3);
        let check = |drive: &Simulation, settled: &Simulation| {
            for (long, short) in drive.memory().iter().zip(settled.memory()) {
                assert!(
                    (long - short).abs() < share * deepest,
                    "{left} {right}: {:?} {:?}",
                    drive.memory(),
                    settled.memory()
                );
            }
        };
        check(&drive, &settled);
        // And they stay so.
        drive.step(2.0).unwrap();
        settled.step(2.0).unwrap();
        check(&drive, &settled);
    }
}

/// A wheel that comes upon a track or leaves it at another step chops the differences, by as much; without what past
/// states do through the tracks the derivatives would err by a quarter.
const CHOPPED: f64 = 0.12;

/// Over these poses to its beginning, then straight on, and on the spot: wheels leave the tracks and come upon them again.
fn turns(specification: &Specification, start: State, course: &[[f64; 3]]) -> [f64; 6] {
    let mut drive = Simulation::new(VehicleModel::from_specification(specification).unwrap());
    drive.set_state(start).unwrap();
    for (k, (speeds, seconds)) in MANOEUVRE.into_iter().enumerate() {
        drive.set_wheel_speeds(speeds).unwrap();
        if k == 0 {
            drive.settle_after(course).unwrap();
        }
        for _ in 0..seconds * 100 {
            drive.step(0.01).unwrap();
        }
    }
    drive.state().to_array()
}

const MANOEUVRE: [(WheelSpeeds, usize); 3] = [
    (
        WheelSpeeds {
            left: 5.0,
            right: 5.5,
        },
        1,
    ),
    (
        WheelSpeeds {
            left: -5.0,
            right: 5.0,
        },
        4,
    ),
    (
        WheelSpeeds {
            left: 5.0,
            right: 4.0,
        },
        2,
    ),
];

#[test]
fn turns_on_the_spot_are_differentiated_through_the_tracks() {
    let effects = Effects::NONE.with("multipass.memory", 0.8).unwrap();
    let on = specification("sandy_loam", effects);
    let start = State {
        v_x: 1.1,
        heading: 0.3,
        ..State::default()
    };
    let names = [
        "multipass.memory",
        "multipass.stiffness_ratio",
        "friction_angle",
        "mass",
    ];
    let parameters = names.map(|name| ModelParameter::find(name).unwrap());
    // Straight on for as long as anyone remembers, and out of a bend.
    let bend = |k: i32| {
        let turned = -0.02 * f64::from(k);
        [2.0 * turned.sin(), 2.0 * (1.0 - turned.cos()), turned]
    };
    let bend: Vec<[f64; 3]> = (1..=60).rev().map(bend).collect();
    for course in [&[], &bend[..]] {
        let mut exact = SensitiveSimulation::new(&on, &parameters).unwrap();
        exact.restart(0.0, start).unwrap();
        for (k, (speeds, seconds)) in MANOEUVRE.into_iter().enumerate() {
            exact.drive(speeds, WheelSpeeds::default()).unwrap();
            if k == 0 {
                exact.settle_after(course).unwrap();
            }
            for _ in 0..seconds * 100 {
                exact.step(0.01).unwrap();
            }
        }
        let drive = Differentiated {
            on: &on,
            start,
            end: &|specification, start| turns(specification, start, course),
            tolerance: CHOPPED,
        };
        drive.by_parameters("turns", &exact, &by_shares(1e-2, &on, &parameters));
        drive.by_beginning(&exact, 0..6, 1e-2);
    }
}

/// A drive that turns on the spot and goes back, and the same taken up in its midst, with the course that led there and
/// without: how far both are off after two seconds \[m, rad\].
#[test]
fn a_drive_that_is_taken_up_in_its_midst_meets_the_tracks_of_before() {
    let ruts = [("multipass.memory", 1.0)];
    for seconds in [4.5, 5.5, 6.5] {
        let mut drive = Simulation::new(model("sandy_loam", &ruts));
        let mut course = Vec::new();
        let mut on = |drive: &mut Simulation, speeds: WheelSpeeds, seconds: f64| {
            drive.set_wheel_speeds(speeds).unwrap();
            for _ in 0..(10.0 * seconds) as usize {
                let state = drive.state();
                course.push([state.x, state.y, state.heading]);
                drive.step(0.1).unwrap();
            }
        };
        let go_on = speeds(5.0, 5.0);
        on(&mut drive, go_on, 4.0);
        on(&mut drive, speeds(-5.0, 5.0), seconds - 4.0);
        drive.set_wheel_speeds(go_on).unwrap();
        drive.step(0.1).unwrap();
        let state = drive.state();
        let here = [state.x, state.y, state.heading];
        let seen: Vec<_> = course.iter().map(|pose| seen_from(*pose, here)).collect();
        drive.step(2.0).unwrap();
        let off = |course: &[[f64; 3]]| {
            let mut again = Simulation::new(model("sandy_loam", &ruts));
            again.set_state(state).unwrap();
            again.set_wheel_speeds(go_on).unwrap();
            again.settle_after(course).unwrap();
            again.step(2.0).unwrap();
            let (a, b) = (again.state(), drive.state());
            (a.x - b.x)
                .hypot(a.y - b.y)
                .max((a.heading - b.heading).abs())
        };
        assert!(off(&seen) < 0.5 * off(&[]));
    }
}

#[test]
fn a_course_that_is_no_number_is_refused() {
    let mut drive = Simulation::new(model("sandy_loam", &[("multipass.memory", 1.0)]));
    let error = drive.settle_after(&[[0.0, f64::NAN, 0.0]]).unwrap_err();
    assert_eq!(error.to_string(), "pose to the left = NaN is not finite");
}
