//! The energy that the axles put into a drive is what the vehicle holds and what the ground takes.
//!
//! The axles' side is the output `power`. The other side shares no sum with it: stress times slip velocity by the dense
//! rule of [`super::dense`], written from the declarations' equations, on the entry angles and sinkages of the outputs; the
//! kinetic energy of the states; the height of the path; the resistances of drag and drawbar by hand.

use super::dense::{WIDTH, dense, plain};
use super::specification;
use crate::common::{paper_model, speeds};
use ugv_terrain::contact::{WheelLaw, WheelMemory, WheelMotion};
use ugv_terrain::effects::{
    Bulldozing, CATALOGUE, Displacement, EffectKind, Effects, Multipass, ParameterName,
    SlipSinkage, Soil, StressPeak,
};
use ugv_terrain::simulation::{Simulation, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Motion, Vehicle, VehicleModel};

/// Every physics of the catalogue, moderately strong.
const STRENGTHS: [(&str, &[(&str, f64)]); 20] = [
    ("grade", &[("slope_east", 0.06), ("slope_north", -0.04)]),
    (
        "terrain_change",
        &[
            ("cohesion_factor", 0.7),
            ("friction_factor", 0.9),
            ("stiffness_factor", 0.6),
            ("shear_modulus_factor", 1.4),
            ("position", 0.8),
            ("direction", 0.2),
            ("transition", 0.5),
        ],
    ),
    ("left_right_soil", &[("ratio", 1.4)]),
    ("bulldozing", &[("lateral", 0.8), ("frontal", 0.4)]),
    (
        "slip_sinkage",
        &[("exponent_growth", 0.1), ("sinkage_growth", 0.3)],
    ),
    ("multipass", &[("memory", 0.9), ("stiffness_ratio", 8.0)]),
    ("elastic_rebound", &[("share", 0.3)]),
    ("stress_peak", &[("a0", 0.42), ("a1", 0.2)]),
    ("tyre_compliance", &[("pressure", 25e3)]),
    (
        "shear_anisotropy",
        &[("modulus_ratio", 0.6), ("strength_ratio", 1.3)],
    ),
    ("transient_shear", &[("relaxation", 1.0)]),
    (
        "rate_dependent_soil",
        &[("forward", 80.0), ("lateral", 150.0)],
    ),
    ("drag", &[("coefficient", 15.0)]),
    ("drawbar", &[("force", 150.0), ("hitch_behind", 1.2)]),
    ("payload", &[("mass", 60.0), ("ahead", 0.3), ("left", 0.1)]),
    ("com_shift", &[("ahead", 0.06), ("left", -0.04)]),
    ("wheel_radius", &[("left", 0.97), ("right", 1.02)]),
    (
        "residual_longitudinal",
        &[("constant", -0.01), ("slip", 0.03)],
    ),
    ("residual_lateral", &[("sideways", -0.05)]),
    ("residual_yaw", &[("turning", -0.05)]),
];

/// On dry clay with all other effects: a softer tyre makes that drive too stiff (docs/explanation/model.md).
const FIRM_TYRE: &[(&str, f64)] = &[("pressure", 300e3)];

/// Rows and points of the dense rule, and seconds between the samples of both powers.
const RULE: [usize; 2] = [10, 100];
const SAMPLE: f64 = 0.01;
/// Seconds, and the speeds of both sides at their end: ahead, a turn, braking, reverse, a pivot turn, a stop.
const PHASES: [(f64, f64, f64); 9] = [
    (0.6, 6.0, 6.0),
    (0.4, 6.0, 6.0),
    (0.3, 7.0, 4.5),
    (0.4, 7.0, 4.5),
    (0.3, 1.0, 1.0),
    (0.5, -5.0, -4.0),
    (0.3, -5.0, -4.0),
    (0.4, -4.0, 4.0),
    (0.3, 0.5, 0.5),
];
/// Share of all that the soil took so far, and energy \[J\], that may be missing of the balance at any time: the samples'
/// trapezoids leave most of it, a quarter where they are half as long.
const SHARE: f64 = 1e-3;
const JOULES: f64 = 2.0;

fn get(effects: &Effects, name: &str) -> f64 {
    effects.get(ParameterName::find(name).unwrap())
}

fn is_on(effects: &Effects, name: &str) -> bool {
    effects
        .on(EffectKind::Physics)
        .any(|effect| effect.name == name)
}

fn with(mut effects: Effects, name: &str, values: &[(&str, f64)]) -> Effects {
    for (parameter, value) in values {
        effects = effects
            .with(&format!("{name}.{parameter}"), *value)
            .unwrap();
    }
    effects
}

/// The soil under a wheel at a place on the map, by the declarations.
fn soil(effects: &Effects, terrain: &Terrain, left: bool, place: [f64; 2]) -> Soil<f64> {
    let get = |name: &str| get(effects, name);
    let share = {
        let direction = get("terrain_change.direction");
        let along = place[0] * direction.cos() + place[1] * direction.sin();
        let beyond = (along - get("terrain_change.position")) / get("terrain_change.transition");
        let t = (0.5 * (beyond + 1.0)).clamp(0.0, 1.0);
        t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
    };
    let changed = |name: &str| get(&format!("terrain_change.{name}_factor")).powf(share);
    let side = get("left_right_soil.ratio").powf(if left { 0.5 } else { -0.5 });
    let cohesion = terrain.cohesion * side;
    let cohesion = if is_on(effects, "tyre_compliance") {
        let adhesion = 0.5 * get("tyre_compliance.pressure");
        (cohesion.min(adhesion) * changed("cohesion")).min(adhesion)
    } else {
        cohesion * changed("cohesion")
    };
    Soil {
        cohesion,
        friction: terrain.friction_angle.tan() * side * changed("friction"),
        modulus: (terrain.cohesive_modulus / WIDTH + terrain.frictional_modulus)
            * side
            * changed("stiffness"),
        exponent: terrain.sinkage_exponent,
        shear_modulus: terrain.shear_modulus * changed("shear_modulus"),
    }
}

fn law(effects: &Effects, radius: f64, soil: Soil<f64>) -> WheelLaw<f64> {
    let get = |name: &str| get(effects, name);
    let on = |name: &str| is_on(effects, name);
    WheelLaw {
        soil,
        radius,
        rebound: get("elastic_rebound.share"),
        modulus_ratio: get("shear_anisotropy.modulus_ratio"),
        strength_ratio: get("shear_anisotropy.strength_ratio"),
        viscosity: ["forward", "lateral"]
            .map(|axis| get(&format!("rate_dependent_soil.{axis}")) / 8.0),
        peak: on("stress_peak").then(|| StressPeak {
            a0: get("stress_peak.a0"),
            a1: get("stress_peak.a1"),
        }),
        slip_sinkage: on("slip_sinkage").then(|| SlipSinkage {
            exponent_growth: get("slip_sinkage.exponent_growth"),
            sinkage_growth: get("slip_sinkage.sinkage_growth"),
        }),
        bulldozing: on("bulldozing").then(|| Bulldozing {
            lateral: get("bulldozing.lateral"),
            frontal: get("bulldozing.frontal"),
            unit_weight: get("bulldozing.unit_weight"),
        }),
        multipass: on("multipass").then(|| Multipass {
            memory: get("multipass.memory"),
            stiffness_ratio: get("multipass.stiffness_ratio"),
        }),
        transient: on("transient_shear"),
        ..plain()
    }
}

/// A vehicle's bodies: mass \[kg\], place ahead and to the left of the reference point \[m\].
struct Bodies {
    masses: Vec<(f64, [f64; 2])>,
    yaw_inertia: f64,
}

impl Bodies {
    fn new(effects: &Effects, vehicle: &Vehicle) -> Self {
        let get = |name: &str| get(effects, name);
        let shift = [get("com_shift.ahead"), get("com_shift.left")];
        let ahead = get("payload.ahead") - vehicle.com_offset;
        let payload = (get("payload.mass"), [ahead, get("payload.left")]);
        Self {
            masses: vec![(vehicle.mass, shift), payload],
            yaw_inertia: vehicle.yaw_inertia,
        }
    }

    fn mass(&self) -> f64 {
        self.masses.iter().map(|(mass, _)| mass).sum()
    }

    fn centre(&self) -> [f64; 2] {
        let moment = |axis: usize| self.masses.iter().map(|(m, at)| m * at[axis]).sum::<f64>();
        [0, 1].map(|axis| moment(axis) / self.mass())
    }

    /// Energy of motion \[J\], and of height on a slope, q of `grade`.
    fn energy(&self, effects: &Effects, state: &State) -> f64 {
        let (sin, cos) = state.heading.sin_cos();
        let [east, north] =
            ["east", "north"].map(|side| get(effects, &format!("grade.slope_{side}")).tan());
        let per_metre = 9.81 / (1.0 + east * east + north * north).sqrt();
        let bodies = self.masses.iter().map(|(mass, [ahead, left])| {
            let [v_x, v_y] = velocity(state, [*ahead, *left]);
            let (x, y) = (
                state.x + ahead * cos - left * sin,
                state.y + ahead * sin + left * cos,
            );
            mass * (0.5 * (v_x * v_x + v_y * v_y) + per_metre * (east * x + north * y))
        });
        bodies.sum::<f64>() + 0.5 * self.yaw_inertia * state.yaw_rate.powi(2)
    }
}

/// Velocity of a point of the vehicle in the body's frame \[m/s\].
fn velocity(state: &State, [ahead, left]: [f64; 2]) -> [f64; 2] {
    [
        state.v_x - state.yaw_rate * left,
        state.v_y + state.yaw_rate * ahead,
    ]
}

/// Power \[W\] that drag, drawbar and the empirical residual models take, by their declarations.
fn resisted(effects: &Effects, vehicle: &Vehicle, state: &State, speeds: WheelSpeeds) -> f64 {
    let get = |name: &str| get(effects, name);
    let bodies = Bodies::new(effects, vehicle);
    let [v_x, v_y] = velocity(state, bodies.centre());
    let drag = get("drag.coefficient") * v_x.hypot(v_y).powi(3);
    let hitch = -(vehicle.com_offset + get("drawbar.hitch_behind"));
    let [h_x, h_y] = velocity(state, [hitch, 0.0]);
    let squared = h_x * h_x + h_y * h_y;
    let drawbar = get("drawbar.force") * squared / (squared + 1e-4).sqrt();
    let (scale, half_track) = ((9.81 * vehicle.half_track).sqrt(), vehicle.half_track);
    let rim = |side: &str| vehicle.wheel_radius * get(&format!("wheel_radius.{side}"));
    let mean = 0.5 * (rim("left") * speeds.left + rim("right") * speeds.right);
    let along = get("residual_longitudinal.constant")
        + get("residual_longitudinal.slip") * (mean - state.v_x) / scale;
    let across = get("residual_lateral.sideways") * state.v_y / scale;
    let around = get("residual_yaw.turning") * state.yaw_rate * (half_track / 9.81).sqrt();
    let pushed = along * v_x + across * v_y + around * half_track * state.yaw_rate;
    drag + drawbar - bodies.mass() * 9.81 * pushed
}

/// Power \[W\] that the soil takes up.
fn absorbed(effects: &Effects, terrain: &Terrain, drive: &mut Simulation) -> f64 {
    let names = drive.model().memory_names();
    let memory = drive.memory().to_vec();
    let remembered = |wheel: usize, name: &str| {
        let name = format!("wheel[{}].{name}", wheel + 1);
        names
            .iter()
            .position(|n| *n == name)
            .map_or(0.0, |k| memory[k])
    };
    let (state, speeds) = (drive.state(), drive.wheel_speeds());
    let vehicle = drive.model().vehicle().clone();
    let wheels = drive.wrench().unwrap().wheels.clone();
    let (sin, cos) = state.heading.sin_cos();
    let mut power = 0.0;
    for (index, wheel) in wheels.iter().enumerate() {
        if wheel.load <= 0.0 {
            continue;
        }
        let is_left = index % 2 == 0;
        let (side, omega) = if is_left {
            ("left", speeds.left)
        } else {
            ("right", speeds.right)
        };
        let ahead = vehicle.row_positions[index / 2] - vehicle.com_offset;
        let left = if is_left { 1.0 } else { -1.0 } * vehicle.half_track;
        let place = [
            state.x + ahead * cos - left * sin,
            state.y + ahead * sin + left * cos,
        ];
        let radius = vehicle.wheel_radius * get(effects, &format!("wheel_radius.{side}"));
        let law = law(effects, radius, soil(effects, terrain, is_left, place));
        let [forward, lateral] = velocity(&state, [ahead, left]);
        // A wheel that travels backwards is the mirror image of one that travels forwards.
        let sign = if forward < 0.0 { -1.0 } else { 1.0 };
        let motion = WheelMotion {
            forward: sign * forward,
            lateral,
            yaw_rate: sign * state.yaw_rate,
            angular_speed: sign * omega,
        };
        let pressed = remembered(index, "rut_depth");
        let memory = WheelMemory {
            displacement: Displacement {
                forward: sign * remembered(index, "shear_forward"),
                lateral: remembered(index, "shear_lateral"),
                yaw: sign * remembered(index, "shear_yaw"),
                rim: sign * remembered(index, "shear_rim"),
            },
            pressed,
        };
        let ground = law
            .multipass
            .map_or(0.0, |effect| pressed * (1.0 - 1.0 / effect.stiffness_ratio));
        let entry = wheel.entry_angle;
        let circle = (wheel.sinkage - ground) / (2.0 * (0.5 * entry).sin().powi(2));
        power += dense(&law, &motion, &memory, (circle, entry), RULE).lost;
    }
    power
}

/// The energies of a drive \[J\]: how much the axles put in, how much the ground took, and the largest that is missing of
/// the balance as a share of what is allowed.
fn balance(terrain: &str, effects: &Effects) -> (f64, f64, f64) {
    let specification = specification(terrain, effects.clone());
    let model = VehicleModel::from_specification(&specification).unwrap();
    let (vehicle, soil) = (specification.vehicle, specification.terrain);
    let bodies = Bodies::new(effects, &vehicle);
    let mut drive = Simulation::new(model);
    let at = |drive: &mut Simulation| {
        let driven = drive.wrench().unwrap().power;
        let (state, speeds) = (drive.state(), drive.wheel_speeds());
        let resisted = resisted(effects, &vehicle, &state, speeds);
        [driven, absorbed(effects, &soil, drive), resisted]
    };
    let start = bodies.energy(effects, &drive.state());
    let mut before = at(&mut drive);
    let finite = |powers: [f64; 3]| assert!(powers.iter().all(|p| p.is_finite()), "{powers:?}");
    finite(before);
    let mut sums = [0.0; 3];
    let (mut turnover, mut worst) = (0.0, 0.0_f64);
    let mut from = [0.0; 2];
    for (seconds, left, right) in PHASES {
        let rates = speeds((left - from[0]) / seconds, (right - from[1]) / seconds);
        drive.set_wheel_accelerations(rates).unwrap();
        for _ in 0..(seconds / SAMPLE).round() as usize {
            drive.step(SAMPLE).unwrap();
            let now = at(&mut drive);
            finite(now);
            for k in 0..3 {
                sums[k] += 0.5 * SAMPLE * (before[k] + now[k]);
            }
            turnover += 0.5 * SAMPLE * (before[1] + now[1]).abs();
            before = now;
            let held = bodies.energy(effects, &drive.state()) - start;
            let missing = sums[0] - sums[1] - sums[2] - held;
            worst = worst.max(missing.abs() / (SHARE * turnover + JOULES));
        }
        from = [left, right];
    }
    (sums[0], sums[1], worst)
}

fn check(terrain: &str) {
    let physics = CATALOGUE.iter().filter(|e| e.kind == EffectKind::Physics);
    assert!(physics.map(|e| e.name).eq(STRENGTHS.iter().map(|s| s.0)));
    let mut cases = vec![("none", Effects::NONE)];
    for (name, values) in STRENGTHS {
        cases.push((name, with(Effects::NONE, name, values)));
    }
    let mut all = STRENGTHS
        .iter()
        .fold(Effects::NONE, |all, (name, values)| with(all, name, values));
    if terrain == "dry_clay" {
        all = with(all, "tyre_compliance", FIRM_TYRE);
    }
    cases.push(("all", all));
    let mut failed = Vec::new();
    for (name, effects) in cases {
        let (driven, lost, worst) = balance(terrain, &effects);
        println!(
            "{terrain} {name}: {driven:.1} J, {lost:.1} J to the soil, {worst:.2} of the tolerance"
        );
        if worst.is_nan() || worst > 1.0 {
            failed.push(name);
        }
    }
    assert!(failed.is_empty(), "{terrain}: {failed:?}");
}

#[test]
fn the_axles_energy_is_accounted_for_on_dry_sand() {
    check("dry_sand");
}

#[test]
fn the_axles_energy_is_accounted_for_on_sandy_loam() {
    check("sandy_loam");
}

#[test]
fn the_axles_energy_is_accounted_for_on_clayed_soil() {
    check("clayed_soil");
}

#[test]
fn the_axles_energy_is_accounted_for_on_dry_clay() {
    check("dry_clay");
}

/// Central differences; what the balance leaves of them as in `limits.rs`.
const STEP: f64 = 1e-5;

#[test]
fn derivatives_of_torque_and_power_are_the_limit_of_differences_under_every_effect() {
    let mut largest = 0.0_f64;
    for (name, values) in STRENGTHS {
        let effects = with(Effects::NONE, name, values);
        let specification = specification("sandy_loam", effects);
        let mut drive = Simulation::new(VehicleModel::from_specification(&specification).unwrap());
        drive.set_wheel_accelerations(speeds(7.0, 4.0)).unwrap();
        drive.step(1.0).unwrap();
        let numbers = |drive: &mut Simulation| {
            let wrench = drive.wrench().unwrap();
            let wheels = [0, 3, 6].map(|wheel| wrench.wheels[wheel].torque);
            [wrench.torque_left, wrench.torque_right, wrench.power]
                .into_iter()
                .chain(wheels)
                .collect::<Vec<_>>()
        };
        for direction in 0..8 {
            let mut along = [0.0; 8];
            along[direction] = 1.0;
            let [v_x, v_y, yaw_rate, left, right, x, y, heading] = along;
            let moved = |by: f64| {
                let mut there = drive.clone();
                let state = drive.state();
                there
                    .set_state(State {
                        x: state.x + by * x,
                        y: state.y + by * y,
                        heading: state.heading + by * heading,
                        v_x: state.v_x + by * v_x,
                        v_y: state.v_y + by * v_y,
                        yaw_rate: state.yaw_rate + by * yaw_rate,
                    })
                    .unwrap();
                let from = drive.wheel_speeds();
                there
                    .set_wheel_speeds(speeds(from.left + by * left, from.right + by * right))
                    .unwrap();
                numbers(&mut there)
            };
            let (ahead, behind) = (moved(STEP), moved(-STEP));
            let motion = Motion::from_array([v_x, v_y, yaw_rate, left, right]);
            let exact = drive
                .clone()
                .wrench_derivative(&motion, [x, y, heading])
                .unwrap()
                .clone();
            let wheels = [0, 3, 6].map(|wheel| exact.wheels[wheel].torque);
            let exact = [exact.torque_left, exact.torque_right, exact.power]
                .into_iter()
                .chain(wheels);
            for (k, exact) in exact.enumerate() {
                let difference = (ahead[k] - behind[k]) / (2.0 * STEP);
                largest = largest.max(difference.abs());
                assert!(
                    (exact - difference).abs() < 2e-3 * difference.abs() + 0.5,
                    "{name}, direction {direction}, {k}: {exact} and {difference}"
                );
            }
        }
    }
    assert!(largest > 1e3);
}

#[test]
fn power_is_positive_where_axles_drive_and_negative_where_they_brake() {
    for terrain in Terrain::PRESETS {
        let driving = |left: f64, right: f64| {
            let mut drive = Simulation::new(paper_model(terrain));
            drive.set_wheel_accelerations(speeds(left, right)).unwrap();
            drive.step(1.0).unwrap();
            drive.set_wheel_accelerations(speeds(0.0, 0.0)).unwrap();
            drive.step(3.0).unwrap();
            drive
        };
        for (left, right) in [(6.0, 6.0), (-6.0, -6.0), (-4.0, 4.0), (5.0, -5.0)] {
            let wrench = driving(left, right).wrench().unwrap().clone();
            assert!(wrench.power > 10.0, "{terrain}: {} W", wrench.power);
            assert!(wrench.torque_left * left > 0.0, "{terrain}: {wrench:?}");
            assert!(wrench.torque_right * right > 0.0, "{terrain}: {wrench:?}");
            let sum: f64 = wrench.wheels.iter().map(|wheel| wheel.torque).sum();
            assert!((sum - wrench.torque_left - wrench.torque_right).abs() < 1e-9);
        }
        for speed in [6.0, -6.0] {
            let mut drive = driving(speed, speed);
            // As fast as before, the wheels slower by half.
            drive
                .set_wheel_speeds(speeds(0.5 * speed, 0.5 * speed))
                .unwrap();
            let braked = drive.wrench().unwrap().clone();
            assert!(braked.power < -10.0, "{terrain}: {} W", braked.power);
            assert!(braked.torque_left * speed < 0.0 && braked.torque_right * speed < 0.0);
            // Locked wheels hold a torque and do no work.
            drive.set_wheel_speeds(speeds(0.0, 0.0)).unwrap();
            let locked = drive.wrench().unwrap();
            assert!(locked.power == 0.0 && locked.torque_left * speed < 0.0);
        }
        let mut resting = Simulation::new(paper_model(terrain));
        let rest = resting.wrench().unwrap();
        assert!(rest.power == 0.0 && rest.torque_left.abs() < 1e-6);
    }
}
