//! Effects whose result can be said by hand.

use super::MOTIONS;
use crate::common::wrench;
use ugv_terrain::effects::Effects;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Motion, Specification, Vehicle, VehicleModel};

/// Rounding, and the step tolerance of the balance.
const CLOSE: f64 = 1e-3;

/// A vehicle whose loads do not follow its accelerations.
fn low() -> Vehicle {
    Vehicle {
        com_height: 0.0,
        ..Vehicle::tran2007()
    }
}

fn model(vehicle: Vehicle, terrain: &str, effects: &[(&str, f64)]) -> VehicleModel {
    let effects = effects.iter().fold(Effects::NONE, |all, (name, value)| {
        all.with(name, *value).unwrap()
    });
    let terrain = Terrain::preset(terrain).unwrap();
    VehicleModel::from_specification(&Specification {
        vehicle,
        terrain,
        effects,
    })
    .unwrap()
}

#[test]
fn soil_that_springs_back_whole_has_no_compaction_drag() {
    let straight = Motion {
        v_x: 1.5,
        omega_left: 6.0,
        omega_right: 6.0,
        ..Motion::default()
    };
    for terrain in Terrain::PRESETS {
        let springy = wrench(
            &model(low(), terrain, &[("elastic_rebound.share", 1.0)]),
            &straight,
        );
        assert!(
            springy.rolling_resistance.abs() < CLOSE,
            "{terrain} {}",
            springy.rolling_resistance
        );
    }
}

#[test]
fn viscous_soil_adds_its_coefficients_times_the_velocities() {
    let motion = Motion {
        v_x: 2.0,
        v_y: 0.3,
        yaw_rate: 0.4,
        omega_left: 9.0,
        omega_right: 8.0,
    };
    let wet = [
        ("rate_dependent_soil.forward", 80.0),
        ("rate_dependent_soil.lateral", 160.0),
    ];
    let (with, without) = (
        wrench(&model(low(), "sandy_loam", &wet), &motion),
        wrench(
            &model(
                low(),
                "sandy_loam",
                &[("rate_dependent_soil.forward", 1e-9)],
            ),
            &motion,
        ),
    );
    // -80 x 2.0 N; across, the wheels' mean place is 0.17 m behind the centre of mass:
    // -160 (0.3 - 0.17 x 0.4) N.
    assert!((490.0 * (with.a_x - without.a_x) + 160.0).abs() < CLOSE);
    assert!((490.0 * (with.a_y - without.a_y) + 160.0 * (0.3 - 0.068)).abs() < CLOSE);
    // Yaw: -20 Omega sum X^2 - 20 V_Y sum X - 10 Omega sum Y^2, X = rows - 0.17, two wheels each:
    // sum X = -1.36, sum X^2 = 3.7210 + 8 x 0.0289 = 3.9522, sum Y^2 = 2.9768.
    let expected = -20.0 * 0.4 * 3.9522 + 20.0 * 0.3 * 1.36 - 10.0 * 0.4 * 2.9768;
    let found = 309.43 * (with.yaw_acceleration - without.yaw_acceleration);
    assert!((found - expected).abs() < 1e-2, "{found} {expected}");
}

#[test]
fn fully_sheared_soil_resists_sliding_aside_by_the_strength_ratio() {
    // Locked wheels far beyond K: tau = tau_max everywhere, straight aside.
    let aside = Motion {
        v_y: 1.0,
        ..Motion::default()
    };
    let plain = wrench(
        &model(
            low(),
            "dry_sand",
            &[("shear_anisotropy.modulus_ratio", 1.0000001)],
        ),
        &aside,
    );
    let strong = wrench(
        &model(
            low(),
            "dry_sand",
            &[("shear_anisotropy.strength_ratio", 1.4)],
        ),
        &aside,
    );
    assert!(
        (strong.a_y / plain.a_y - 1.4).abs() < CLOSE,
        "{} {}",
        strong.a_y,
        plain.a_y
    );
    // c A + N tan(phi) bounds it from both sides: N tan(28 deg) = 2556 N.
    let force = -490.0 * plain.a_y;
    assert!(
        force > 2556.0 && force < 2556.0 + 1040.0 * 8.0 * 0.246 * 0.25,
        "{force}"
    );
}

#[test]
fn a_stiffer_direction_mobilises_as_if_it_had_slid_further() {
    // Half K across is twice the displacement: the same as K for both at twice the lateral speed,
    // as long as all of the displacement is lateral (no yaw, no longitudinal slip to speak of).
    let locked = |v_y: f64| Motion {
        v_y,
        ..Motion::default()
    };
    let clay = |ratio: f64, v_y: f64| {
        let slow = 2e-5 * v_y;
        wrench(
            &model(
                low(),
                "clayed_soil",
                &[("shear_anisotropy.modulus_ratio", ratio)],
            ),
            &locked(slow),
        )
        .a_y
    };
    // Where the shear's direction is still fading, it goes with the speed itself.
    let (half, double) = (clay(0.5, 1.0), clay(0.9999999, 2.0));
    assert!((2.0 * half / double - 1.0).abs() < CLOSE, "{half} {double}");
}

#[test]
fn a_shifted_centre_of_mass_shifts_the_loads() {
    let shifted = [("com_shift.ahead", 0.1), ("com_shift.left", -0.05)];
    let loads = wrench(&model(low(), "dry_clay", &shifted), &Motion::default()).wheels;
    let weight = 490.0 * 9.81;
    let moment = |arm: &dyn Fn(usize) -> f64| -> f64 {
        loads
            .iter()
            .enumerate()
            .map(|(i, wheel)| arm(i) * wheel.load)
            .sum()
    };
    let rows = [0.915, 0.305, -0.305, -0.915];
    assert!((moment(&|i| rows[i / 2]) - weight * (0.17 + 0.1)).abs() < CLOSE);
    assert!((moment(&|i| if i % 2 == 0 { 0.61 } else { -0.61 }) + weight * 0.05).abs() < CLOSE);
}

#[test]
fn equal_factors_on_both_radii_are_a_vehicle_with_such_wheels() {
    for motion in &MOTIONS {
        let worn = model(
            Vehicle::tran2007(),
            "sandy_loam",
            &[("wheel_radius.left", 0.94), ("wheel_radius.right", 0.94)],
        );
        let small = Vehicle {
            wheel_radius: 0.25 * 0.94,
            ..Vehicle::tran2007()
        };
        let small = model(small, "sandy_loam", &[]);
        let (worn, small) = (wrench(&worn, motion), wrench(&small, motion));
        assert!((worn.a_x - small.a_x).abs() * 490.0 < 1.0, "{motion:?}");
        assert!(
            (worn.turning_moment - small.turning_moment).abs() < 1.0,
            "{motion:?}"
        );
        assert!((worn.wheels[3].sinkage - small.wheels[3].sinkage).abs() < 1e-5);
    }
}

#[test]
fn laws_without_a_name_push_with_their_share_of_the_weight() {
    // No lever of the centre of mass: the ground's forces stay what they are.
    let motion = Motion {
        v_x: 1.5,
        v_y: 0.2,
        yaw_rate: -0.4,
        omega_left: 8.0,
        omega_right: 6.4,
    };
    let found = |name: &str, value: f64| {
        let with = wrench(&model(low(), "sandy_loam", &[(name, value)]), &motion);
        let without = wrench(&model(low(), "sandy_loam", &[(name, 1e-12)]), &motion);
        [
            with.a_x - without.a_x,
            with.a_y - without.a_y,
            with.yaw_acceleration - without.yaw_acceleration,
        ]
    };
    // Scaled by sqrt(9.81 x 0.61) = 2.446242 m/s: u = 0.613185, w = 0.081758, q = -0.099745; the
    // rims' 0.25 m x 8.0 and 6.4 rad/s: (1.8 - 1.5) / 2.446242 = 0.122637. Of the weight a share
    // of 0.03 accelerates by 0.2943 m/s^2; of m g B by 490 x 9.81 x 0.61 / 309.43 x 0.03
    // = 0.284286 rad/s^2.
    for (name, axis, expected) in [
        ("residual_longitudinal.constant", 0, 0.2943),
        ("residual_longitudinal.speed_squared", 0, 0.2943 * 0.375996),
        ("residual_longitudinal.slip", 0, 0.2943 * 0.122637),
        ("residual_longitudinal.east", 0, 0.2943),
        ("residual_lateral.sideways", 1, 0.2943 * 0.081758),
        ("residual_lateral.north", 1, 0.2943),
        ("residual_yaw.turning", 2, 0.284286 * -0.099745),
        ("residual_yaw.speed_sideways", 2, 0.284286 * 0.050133),
    ] {
        let changes = found(name, 0.03);
        for (index, change) in changes.into_iter().enumerate() {
            let expected = if index == axis { expected } else { 0.0 };
            assert!(
                (change - expected).abs() < 1e-5,
                "{name}: {changes:?} {expected}"
            );
        }
    }
}

#[test]
fn a_push_towards_the_east_is_felt_wherever_the_vehicle_heads() {
    // Both components of one force, heading 100 deg on dry clay: ahead cos 100 deg, to the left
    // -sin 100 deg.
    use ugv_terrain::simulation::{Simulation, State};
    let heading = 100.0_f64.to_radians();
    let state = State {
        heading,
        v_x: 1.0,
        ..State::default()
    };
    let pushed = |value: f64| {
        let both = [
            ("residual_longitudinal.east", value),
            ("residual_lateral.east", value),
        ];
        let mut drive = Simulation::new(model(low(), "dry_clay", &both));
        drive.set_state(state).unwrap();
        drive.wrench().unwrap().clone()
    };
    let (with, without) = (pushed(0.02), pushed(1e-12));
    assert!((with.a_x - without.a_x - 0.1962 * heading.cos()).abs() < 1e-5);
    assert!((with.a_y - without.a_y + 0.1962 * heading.sin()).abs() < 1e-5);
}
