//! Analytic limits, hand-computed numbers, and exact derivatives against differences.

use crate::common::{paper_model, speeds, starting_at, symmetric_model, wrench};
use ugv_terrain::simulation::{Simulation, State};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Balance, BalanceError, Motion, Specification, Vehicle, VehicleModel};

const WEIGHT: f64 = 490.0 * 9.81;

#[test]
fn sliding_locked_wheels_feel_coulomb_friction() {
    // Far beyond K of sliding all of the strength is mobilised; with phi alone (c = 0) the
    // lateral force of a wheel that slides sideways is tan(phi) times the normal stress over
    // the contact. That integral lies between the load and the load / cos(theta_1).
    let soil = Terrain {
        cohesion: 0.0,
        ..Terrain::preset("dry_sand").unwrap()
    };
    let model = VehicleModel::new(Vehicle::tran2007(), soil).unwrap();
    let motion = Motion {
        v_y: 2.0,
        ..Motion::default()
    };
    let w = wrench(&model, &motion);
    let friction = -490.0 * w.a_y / WEIGHT / soil.friction_angle.tan();
    let steepest = w
        .wheels
        .iter()
        .map(|wheel| wheel.entry_angle)
        .fold(0.0, f64::max);
    assert!(
        (1.0..1.0 / steepest.cos()).contains(&friction),
        "{friction}"
    );
    assert!(w.a_x.abs() < 1e-9);
}

#[test]
fn sinkage_of_a_standing_wheel_follows_bekker_at_small_entry_angles() {
    // At rest nothing shears, so the normal stress alone carries the load. For n = 1 and a small
    // angle, sigma = k r (theta_1^2 - u^2) / 2 with u the angle from the nearer of the two ends'
    // mirror: W = 2 b r int_{theta_1/2}^{theta_1} k r (theta_1^2 - u^2) / 2 du
    //           = b k r^2 theta_1^3 (1/2 - 7/24).
    let soil = Terrain {
        sinkage_exponent: 1.0,
        cohesive_modulus: 0.0,
        frictional_modulus: 1e9,
        ..Terrain::preset("dry_sand").unwrap()
    };
    let model = VehicleModel::new(Vehicle::tran2007(), soil).unwrap();
    let w = wrench(&model, &Motion::default());
    for wheel in &w.wheels {
        let cube = wheel.load / (0.246 * 1e9 * 0.25 * 0.25 * (0.5 - 7.0 / 24.0));
        let expected = cube.cbrt();
        // Terms of the order of theta_1^2, here about 0.05 squared.
        assert!(
            (wheel.entry_angle / expected - 1.0).abs() < 3e-3,
            "{}",
            wheel.entry_angle
        );
    }
}

#[test]
fn slips_at_the_lowest_point_are_those_of_equation_13() {
    let motion = Motion {
        v_x: 1.5,
        v_y: 0.1,
        yaw_rate: 0.2,
        omega_left: 8.0,
        omega_right: 7.0,
    };
    let w = wrench(&paper_model("clayed_soil"), &motion);
    // Wheel 1: Y = 0.61, X = 0.915 - 0.17.
    let forward = 1.5 - 0.2 * 0.61;
    let lateral = 0.1 + 0.2 * 0.745;
    assert!((w.wheels[0].longitudinal_slip - (1.0 - forward / 2.0)).abs() < 1e-12);
    assert!((w.wheels[0].lateral_slip + lateral / 2.0).abs() < 1e-12);
    // At standstill of the wheel the denominator is r omega_min = 0.25 * 0.05.
    let locked = Motion {
        omega_left: 0.0,
        ..motion
    };
    let w = wrench(&paper_model("clayed_soil"), &locked);
    assert!((w.wheels[0].longitudinal_slip + forward / 0.0125).abs() < 1e-9);
}

#[test]
fn forces_are_continuous_where_the_paper_is_undefined() {
    // Across omega = 0, V_X = 0 and the sign change of the slip: small steps, small changes.
    for terrain in Terrain::PRESETS {
        let model = symmetric_model(terrain);
        let lines: [fn(f64) -> Motion; 3] = [
            |s| Motion {
                v_x: 0.3,
                omega_left: s,
                omega_right: s,
                ..Motion::default()
            },
            |s| Motion {
                v_x: 0.1 * s,
                omega_left: 1.0,
                omega_right: 1.0,
                ..Motion::default()
            },
            |s| Motion {
                v_x: 1.0 + s,
                v_y: 0.01,
                omega_left: 4.0,
                omega_right: 4.0,
                ..Motion::default()
            },
        ];
        for line in lines {
            let step = 2e-5;
            let mut previous = wrench(&model, &line(-0.2)).a_x;
            for k in 1..20_000 {
                let a_x = wrench(&model, &line(-0.2 + step * f64::from(k))).a_x;
                // The steepest slope is some 1e4 /s at a slip of 1 mm/s.
                assert!(
                    (a_x - previous).abs() < 0.3,
                    "{terrain}: {previous} to {a_x}"
                );
                previous = a_x;
            }
        }
    }
}

#[test]
fn exact_derivatives_agree_with_differences() {
    let motions = [
        Motion {
            v_x: 1.5,
            v_y: 0.1,
            yaw_rate: -0.4,
            omega_left: 8.0,
            omega_right: 5.0,
        },
        Motion {
            v_x: 0.004,
            v_y: 0.001,
            yaw_rate: 0.002,
            omega_left: 0.03,
            omega_right: -0.02,
        },
        Motion {
            v_x: -1.2,
            v_y: -0.1,
            yaw_rate: 0.9,
            omega_left: -3.0,
            omega_right: -7.0,
        },
        Motion {
            v_x: 0.0,
            v_y: 0.0,
            yaw_rate: 1.0,
            omega_left: -4.0,
            omega_right: 4.0,
        },
    ];
    for terrain in Terrain::PRESETS {
        for motion in motions {
            let mut simulation = Simulation::new(paper_model(terrain));
            let set = |simulation: &mut Simulation, motion: &Motion| {
                let state = State {
                    v_x: motion.v_x,
                    v_y: motion.v_y,
                    yaw_rate: motion.yaw_rate,
                    heading: 0.7,
                    ..State::default()
                };
                simulation.set_state(state).unwrap();
                let speeds = speeds(motion.omega_left, motion.omega_right);
                simulation.set_wheel_speeds(speeds).unwrap();
            };
            for direction in 0..5 {
                let mut along = [0.0; 5];
                along[direction] = 1.0;
                set(&mut simulation, &motion);
                let exact = simulation
                    .wrench_derivative(&Motion::from_array(along), [0.0; 3])
                    .unwrap()
                    .clone();
                let at = |h: f64| {
                    let mut numbers = motion.to_array();
                    numbers[direction] += h;
                    let mut simulation = Simulation::new(paper_model(terrain));
                    set(&mut simulation, &Motion::from_array(numbers));
                    simulation.wrench().unwrap().clone()
                };
                let h = 1e-5;
                let (ahead, behind) = (at(h), at(-h));
                let check = |what: &str, exact: f64, ahead: f64, behind: f64, unit: f64| {
                    let difference = (ahead - behind) / (2.0 * h);
                    // Newton's method leaves 1e-7 of the forces, which the difference divides
                    // by h; near standstill the second derivatives add a per cent.
                    let tolerance = 0.02 * difference.abs() + 0.02 * unit;
                    assert!(
                        (exact - difference).abs() < tolerance,
                        "{terrain}, {motion:?}, direction {direction}, {what}: {exact} and {difference}"
                    );
                };
                check("a_x", exact.a_x, ahead.a_x, behind.a_x, 10.0);
                check("a_y", exact.a_y, ahead.a_y, behind.a_y, 10.0);
                let (e, a, b) = (
                    exact.turning_moment,
                    ahead.turning_moment,
                    behind.turning_moment,
                );
                check("turning moment", e, a, b, 1e3);
                let (e, a, b) = (exact.torque_left, ahead.torque_left, behind.torque_left);
                check("torque_left", e, a, b, 1e3);
                let (e, a, b) = (exact.torque_right, ahead.torque_right, behind.torque_right);
                check("torque_right", e, a, b, 1e3);
                check("power", exact.power, ahead.power, behind.power, 1e3);
                for index in 0..8 {
                    let (e, a, b) = (
                        &exact.wheels[index],
                        &ahead.wheels[index],
                        &behind.wheels[index],
                    );
                    check("load", e.load, a.load, b.load, 1e3);
                    check(
                        "entry angle",
                        e.entry_angle,
                        a.entry_angle,
                        b.entry_angle,
                        1.0,
                    );
                    check("sinkage", e.sinkage, a.sinkage, b.sinkage, 1.0);
                    check("force_y", e.force_y, a.force_y, b.force_y, 1e3);
                    check("torque", e.torque, a.torque, b.torque, 1e2);
                    let slips = (
                        e.longitudinal_slip,
                        a.longitudinal_slip,
                        b.longitudinal_slip,
                    );
                    check("slip", slips.0, slips.1, slips.2, 10.0);
                }
            }
        }
    }
}

#[test]
fn a_vehicle_on_mud_is_bogged_and_says_so() {
    let mud = Terrain {
        cohesion: 200.0,
        friction_angle: 0.05,
        cohesive_modulus: 0.0,
        frictional_modulus: 2e3,
        sinkage_exponent: 1.0,
        shear_modulus: 0.02,
    };
    let model = VehicleModel::new(Vehicle::tran2007(), mud).unwrap();
    let error = model
        .solve(&Motion::default(), &mut Balance::new(&model))
        .unwrap_err();
    assert!(matches!(error, BalanceError::Bogged { .. }), "{error:?}");
    let message = error.to_string();
    assert!(
        message.contains("bogged") && message.contains("wheel"),
        "{message}"
    );
}

#[test]
fn a_short_high_vehicle_lifts_wheels_and_still_carries_its_weight() {
    let vehicle = Vehicle {
        row_positions: vec![0.2, -0.2],
        com_offset: 0.0,
        com_height: 1.5,
        ..Vehicle::tran2007()
    };
    let model = VehicleModel::new(vehicle, Terrain::preset("dry_clay").unwrap()).unwrap();
    let motion = Motion {
        v_x: 0.5,
        omega_left: 20.0,
        omega_right: 20.0,
        ..Motion::default()
    };
    let mut balance = Balance::new(&model);
    model.solve(&motion, &mut balance).unwrap();
    assert!(balance.lifted());
    let w = wrench(&model, &motion);
    assert_eq!((w.wheels[0].load, w.wheels[0].force_x), (0.0, 0.0));
    let loads: f64 = w.wheels.iter().map(|wheel| wheel.load).sum();
    assert!((loads - WEIGHT).abs() < 1e-3);
}

#[test]
fn any_number_of_rows_drives() {
    for rows in [
        vec![0.4, -0.5],
        vec![0.9, 0.0, -0.7],
        vec![2.0, 1.2, 0.4, -0.4, -1.2, -2.0],
    ] {
        let vehicle = Vehicle {
            row_positions: rows,
            com_offset: 0.05,
            ..Vehicle::tran2007()
        };
        let model = VehicleModel::new(vehicle, Terrain::preset("sandy_loam").unwrap()).unwrap();
        let mut simulation = starting_at(model, State::default());
        simulation.set_wheel_speeds(speeds(6.0, 4.0)).unwrap();
        simulation.step(5.0).unwrap();
        let state = simulation.state();
        assert!(
            state.x > 1.0 && state.y < 0.0 && state.heading < 0.0,
            "{state:?}"
        );
    }
}

#[test]
fn bad_parameters_are_refused_by_name() {
    let vehicle = Vehicle::tran2007;
    let cases: [(&str, Vehicle); 8] = [
        (
            "mass",
            Vehicle {
                mass: -1.0,
                ..vehicle()
            },
        ),
        (
            "yaw_inertia",
            Vehicle {
                yaw_inertia: f64::NAN,
                ..vehicle()
            },
        ),
        (
            "wheel_radius",
            Vehicle {
                wheel_radius: 0.0,
                ..vehicle()
            },
        ),
        (
            "wheel_width",
            Vehicle {
                wheel_width: 1.3,
                ..vehicle()
            },
        ),
        (
            "com_offset",
            Vehicle {
                com_offset: 1.0,
                ..vehicle()
            },
        ),
        (
            "com_height",
            Vehicle {
                com_height: f64::INFINITY,
                ..vehicle()
            },
        ),
        (
            "row_positions",
            Vehicle {
                row_positions: vec![-0.3, 0.3],
                ..vehicle()
            },
        ),
        (
            "row_positions",
            Vehicle {
                row_positions: vec![0.3],
                ..vehicle()
            },
        ),
    ];
    let sand = Terrain::preset("dry_sand").unwrap();
    for (name, vehicle) in cases {
        let error = VehicleModel::new(vehicle, sand).unwrap_err();
        assert!(error.name.contains(name), "{error}");
        assert!(error.to_string().contains(&error.range) && !error.unit.is_empty());
    }
    let soils: [(&str, Terrain); 6] = [
        (
            "cohesion",
            Terrain {
                cohesion: -1.0,
                ..sand
            },
        ),
        (
            "friction_angle_deg",
            Terrain {
                friction_angle: 90_f64.to_radians(),
                ..sand
            },
        ),
        (
            "sinkage_exponent",
            Terrain {
                sinkage_exponent: 0.0,
                ..sand
            },
        ),
        (
            "shear_modulus",
            Terrain {
                shear_modulus: f64::NAN,
                ..sand
            },
        ),
        (
            "frictional_modulus",
            Terrain {
                frictional_modulus: -5.0,
                ..sand
            },
        ),
        (
            "cohesive_modulus",
            Terrain {
                cohesive_modulus: -1e6,
                ..sand
            },
        ),
    ];
    for (name, soil) in soils {
        let error = VehicleModel::new(vehicle(), soil).unwrap_err();
        assert!(error.name.contains(name), "{error}");
    }
}

/// Hard ground under the four-wheeled vehicle of some recordings, to which a soil was fitted.
fn hard_ground() -> Specification {
    let vehicle = Vehicle {
        mass: 470.0,
        yaw_inertia: 165.0,
        wheel_radius: 0.3,
        wheel_width: 0.25,
        row_positions: vec![0.457, -0.457],
        half_track: 0.568,
        com_offset: 0.0,
        com_height: 0.45,
    };
    let terrain = Terrain {
        cohesion: 2508.0,
        friction_angle: 13.4_f64.to_radians(),
        cohesive_modulus: 13190.0,
        frictional_modulus: 11_978_196.0,
        sinkage_exponent: 0.244,
        shear_modulus: 5e-4,
    };
    Specification::plain(vehicle, terrain)
}

#[test]
fn a_wheel_that_rolls_without_slip_but_for_rounding_has_forces() {
    // V_Xi / (r omega) = 1 + 1e-16: the slip velocity changes its sign at an angle of 1e-8 rad.
    let motion = Motion {
        v_x: 1.05,
        v_y: 0.0,
        yaw_rate: 0.264_084_507_042_253_56,
        omega_left: 3.0,
        omega_right: 4.0,
    };
    let plain = hard_ground();
    let effects = plain
        .effects
        .clone()
        .with("elastic_rebound.share", 1e-9)
        .unwrap();
    for specification in [plain.clone(), Specification { effects, ..plain }] {
        let model = VehicleModel::from_specification(&specification).unwrap();
        assert!(wrench(&model, &motion).a_y.is_finite());
    }
}
