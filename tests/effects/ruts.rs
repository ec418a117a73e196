//! Wheels in the tracks that they and others left.

use super::derivatives::difference;
use super::{model, specification};
use ugv_terrain::effects::Effects;
use ugv_terrain::simulation::{SensitiveSimulation, Simulation, State, WheelSpeeds};
use ugv_terrain::vehicle::{Parameter, Specification, VehicleModel};

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

fn compare(what: &str, exact: [f64; 6], difference: [f64; 6]) {
    let largest = difference.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (a, b) in exact.iter().zip(difference) {
        assert!(
            (a - b).abs() <= CHOPPED * largest,
            "{what}: {exact:?} {difference:?}"
        );
    }
}

/// From a settled beginning straight on, then on the spot: wheels leave the tracks and come upon them again.
fn turns(specification: &Specification, start: State) -> [f64; 6] {
    let mut drive = Simulation::new(VehicleModel::from_specification(specification).unwrap());
    drive.set_state(start).unwrap();
    for (k, (speeds, seconds)) in MANOEUVRE.into_iter().enumerate() {
        drive.set_wheel_speeds(speeds).unwrap();
        if k == 0 {
            drive.settle().unwrap();
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
    let parameters = names.map(|name| Parameter::find(name).unwrap());
    let mut exact = SensitiveSimulation::new(&on, &parameters).unwrap();
    exact.restart(0.0, start).unwrap();
    for (k, (speeds, seconds)) in MANOEUVRE.into_iter().enumerate() {
        exact.drive(speeds, WheelSpeeds::default()).unwrap();
        if k == 0 {
            exact.settle().unwrap();
        }
        for _ in 0..seconds * 100 {
            exact.step(0.01).unwrap();
        }
    }
    let derivatives = exact.derivatives();
    for (index, parameter) in parameters.iter().enumerate() {
        let step = 1e-2 * parameter.get(&on);
        let moved = |by: f64| {
            let mut changed = on.clone();
            let value = parameter.get(&on) + by;
            parameter.set(&mut changed, value).unwrap();
            turns(&changed, start)
        };
        compare(
            &parameter.name(),
            derivatives.by_parameter(index),
            difference(moved(step), moved(-step), step),
        );
    }
    let by_initial = derivatives.by_initial();
    for column in 0..6 {
        let moved = |by: f64| {
            let mut start = start.to_array();
            start[column] += by;
            turns(&on, State::from_array(start))
        };
        compare(
            &format!("initial state {column}"),
            by_initial.column(column).into_owned().into(),
            difference(moved(1e-2), moved(-1e-2), 1e-2),
        );
    }
}
