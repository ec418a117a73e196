//! Mirror images, lost power, finite numbers, for random effects and motions.

use super::specification;
use crate::common::{motions, power_lost};
use proptest::prelude::*;
use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects, ParameterName};
use ugv_terrain::simulation::{Simulation, SimulationError, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Balance, BalanceError, Motion, Vehicle, VehicleModel, Wrench};

/// Error of the quadrature [N], [N m].
const FORCE_TOLERANCE: f64 = 3.0;

fn motion() -> impl Strategy<Value = Motion> {
    motions(-3.0..3.0, -0.5..0.5, -1.0..1.0, -12.0..12.0)
}

/// One effect, its parameters anywhere in moderate ranges.
fn effects(allowed: fn(&str) -> bool) -> impl Strategy<Value = Effects> {
    let on: Vec<usize> = (0..CATALOGUE.len())
        .filter(|i| CATALOGUE[*i].kind == EffectKind::Physics && allowed(CATALOGUE[*i].name))
        .collect();
    (
        prop::sample::select(on),
        prop::collection::vec(0.0..1.0, 16),
    )
        .prop_map(|(index, shares)| {
            let effect = CATALOGUE[index];
            let mut effects = Effects::NONE;
            for (parameter, share) in effect.parameters.iter().zip(shares) {
                let name =
                    ParameterName::find(&format!("{}.{}", effect.name, parameter.name)).unwrap();
                // Positions far away are no use, nor payloads of a hundred tonnes.
                let (low, high) = match (effect.name, parameter.name) {
                    ("payload", "mass") => (0.0, 200.0),
                    ("payload" | "com_shift", "ahead" | "left") => (-0.3, 0.3),
                    ("drawbar", "force") => (0.0, 1200.0),
                    ("drawbar", "hitch_behind") => (0.0, 1.5),
                    ("drawbar" | "payload", _) => (0.0, 1.0),
                    ("terrain_change", "position") => (-2.0, 2.0),
                    ("terrain_change", "transition") => (0.1, 2.0),
                    ("terrain_change" | "left_right_soil", _) if parameter.low > 0.0 => (0.4, 2.5),
                    // A twentieth of the weight each is a lot.
                    ("residual_longitudinal" | "residual_lateral" | "residual_yaw", _) => {
                        (-0.05, 0.05)
                    }
                    _ => (parameter.low, parameter.high),
                };
                effects.set(name, low + share * (high - low)).unwrap();
            }
            effects
        })
}

fn model(terrain: &str, effects: Effects) -> VehicleModel {
    VehicleModel::from_specification(&specification(terrain, effects)).unwrap()
}

/// Whether an effect may drive the vehicle: masses and slopes have power of their own, laws without a
/// name say what acts and not where its power comes from.
fn has_power(effect: &str) -> bool {
    ["grade", "payload", "com_shift"].contains(&effect) || effect.starts_with("residual_")
}

/// What changes its sign, or its side, in a mirror along the body's X axis while heading east.
fn mirrored(effects: &Effects) -> Effects {
    let mut other = effects.clone();
    let mut set = |name: &str, value: f64| other = other.clone().with(name, value).unwrap();
    let get = |name: &str| effects.get(ParameterName::find(name).unwrap());
    for name in [
        "grade.slope_north",
        "payload.left",
        "com_shift.left",
        "terrain_change.direction",
        "residual_lateral.constant",
        "residual_lateral.north",
        "residual_yaw.constant",
        "residual_yaw.speed",
        "residual_yaw.speed_squared",
        "residual_yaw.east",
    ] {
        set(name, -get(name));
    }
    set("left_right_soil.ratio", 1.0 / get("left_right_soil.ratio"));
    set("wheel_radius.left", get("wheel_radius.right"));
    set("wheel_radius.right", get("wheel_radius.left"));
    other
}

/// The wrench, unless a wheel sinks to its axle: some random motions ask for that.
fn wrench(model: &VehicleModel, motion: &Motion) -> Option<Wrench> {
    let mut balance = Balance::new(model);
    match model.solve(motion, &mut balance) {
        Err(BalanceError::Bogged { .. }) => return None,
        outcome => outcome.unwrap(),
    }
    let mut wrench = Wrench::for_model(model);
    balance.wrench(model, motion, &mut wrench);
    Some(wrench)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, rng_seed: prop::test_runner::RngSeed::Fixed(20261121), ..ProptestConfig::default() })]

    #[test]
    fn left_and_right_are_mirror_images(
        terrain in prop::sample::select(&Terrain::PRESETS[..3]),
        effects in effects(|_| true),
        motion in motion(),
    ) {
        let reflected = Motion {
            v_y: -motion.v_y,
            yaw_rate: -motion.yaw_rate,
            omega_left: motion.omega_right,
            omega_right: motion.omega_left,
            ..motion
        };
        let one = wrench(&model(terrain, effects.clone()), &motion);
        let other = wrench(&model(terrain, mirrored(&effects)), &reflected);
        prop_assume!(one.is_some() && other.is_some());
        let (one, other) = (one.unwrap(), other.unwrap());
        for (name, a, b, scale) in [
            ("a_x", one.a_x, other.a_x, 490.0),
            ("a_y", one.a_y, -other.a_y, 490.0),
            ("yaw", one.yaw_acceleration, -other.yaw_acceleration, 309.0),
        ] {
            prop_assert!((a - b).abs() * scale < FORCE_TOLERANCE, "{name}: {a} {b}");
        }
    }

    #[test]
    fn the_ground_and_what_is_towed_only_take_power(
        terrain in prop::sample::select(&Terrain::PRESETS[..3]),
        effects in effects(|name| !has_power(name)),
        motion in motion(),
    ) {
        let found = wrench(&model(terrain, effects), &motion);
        prop_assume!(found.is_some());
        let power = power_lost(&Vehicle::tran2007(), &motion, &found.unwrap());
        let speed = motion.to_array().into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        prop_assert!(power >= -FORCE_TOLERANCE * speed, "{power} W");
    }

    #[test]
    fn soil_that_springs_back_under_a_peak_that_moves_only_takes_power(
        terrain in prop::sample::select(&Terrain::PRESETS[..3]),
        share in 0.0..1.0f64,
        peak in 0.2..0.6f64,
        growth in 0.0..0.4f64,
        motion in motion(),
    ) {
        let effects = Effects::NONE
            .with("elastic_rebound.share", share)
            .and_then(|effects| effects.with("stress_peak.a0", peak))
            .and_then(|effects| effects.with("stress_peak.a1", growth));
        let found = wrench(&model(terrain, effects.unwrap()), &motion);
        prop_assume!(found.is_some());
        let power = power_lost(&Vehicle::tran2007(), &motion, &found.unwrap());
        let speed = motion.to_array().into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        prop_assert!(power >= -FORCE_TOLERANCE * speed, "{power} W");
    }

    #[test]
    fn drives_with_effects_stay_finite(
        terrain in prop::sample::select(&Terrain::PRESETS[..3]),
        effects in effects(|_| true),
        legs in prop::collection::vec((-12.0..12.0, -12.0..12.0, 0.01..0.6), 1..6),
    ) {
        let mut drive = Simulation::new(model(terrain, effects));
        for (left, right, seconds) in legs {
            drive.set_wheel_speeds(WheelSpeeds { left, right }).unwrap();
            match drive.step(seconds) {
                Err(SimulationError::Balance { source: BalanceError::Bogged { .. }, .. }) => break,
                outcome => outcome.unwrap(),
            }
            let state = drive.state().to_array();
            prop_assert!(state.iter().chain(drive.memory()).all(|value| value.is_finite()));
            prop_assert!(state[3].hypot(state[4]) < 8.0, "{state:?}");
        }
    }
}

#[test]
fn a_jump_of_the_wheel_speeds_far_from_the_last_balance_is_followed() {
    let digging = [
        ("slip_sinkage.exponent_growth", 0.6789616516735253),
        ("slip_sinkage.sinkage_growth", 0.44473550984414256),
    ];
    let mut drive = Simulation::new(super::model("clayed_soil", &digging));
    for (left, right, seconds) in [
        (3.1276918996435987, 0.07135436482034097, 0.3530507816388498),
        (0.0, -10.313238935156942, 0.01),
    ] {
        drive.set_wheel_speeds(WheelSpeeds { left, right }).unwrap();
        drive.step(seconds).unwrap();
    }
    assert!(drive.wrench().is_ok());
}
