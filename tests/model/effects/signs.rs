//! Which way effects push, and how far, by hand.

use super::model;
use crate::common::{paper_model, speeds, wrench};
use ugv_terrain::simulation::{Simulation, State};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Motion, VehicleModel};

const STRAIGHT: Motion = Motion {
    v_x: 1.9,
    v_y: 0.0,
    yaw_rate: 0.0,
    omega_left: 8.0,
    omega_right: 8.0,
};
const SIDEWAYS: Motion = Motion {
    v_x: 1.9,
    v_y: 0.4,
    yaw_rate: 0.0,
    omega_left: 8.0,
    omega_right: 8.0,
};

/// The state after ten seconds at 6 rad/s, or at these wheel speeds.
fn driven(model: VehicleModel, left: f64, right: f64) -> State {
    let mut drive = Simulation::new(model);
    drive.set_wheel_speeds(speeds(left, right)).unwrap();
    drive.step(10.0).unwrap();
    drive.state()
}

#[test]
fn what_resists_slows_the_vehicle_down() {
    for terrain in Terrain::PRESETS {
        let paper = driven(paper_model(terrain), 6.0, 6.0).x;
        for effect in [
            ("grade.slope_east", 0.1),
            ("drag.coefficient", 60.0),
            ("drawbar.force", 400.0),
            ("rate_dependent_soil.forward", 100.0),
            ("bulldozing.frontal", 1.0),
            ("wheel_radius.left", 0.95),
        ] {
            let found = driven(model(terrain, &[effect]), 6.0, 6.0).x;
            assert!(
                found < paper - 1e-3,
                "{terrain} {effect:?}: {found} {paper}"
            );
        }
        let downhill = driven(model(terrain, &[("grade.slope_east", -0.1)]), 6.0, 6.0).x;
        assert!(downhill > paper + 1e-3, "{terrain}: {downhill} {paper}");
        let springy = driven(model(terrain, &[("elastic_rebound.share", 0.8)]), 6.0, 6.0).x;
        assert!(springy > paper, "{terrain}: {springy} {paper}");
    }
}

#[test]
fn what_pulls_aside_turns_or_drifts_the_vehicle() {
    let paper = driven(paper_model("sandy_loam"), 6.0, 6.0);
    assert!(paper.y.abs() < 1e-9 && paper.heading.abs() < 1e-9);
    // Ground that falls to the right.
    let side = driven(model("sandy_loam", &[("grade.slope_north", 0.1)]), 6.0, 6.0);
    assert!(side.y < -1e-3, "{side:?}");
    // A smaller left radius turns to the left.
    let worn = driven(
        model("sandy_loam", &[("wheel_radius.left", 0.95)]),
        6.0,
        6.0,
    );
    assert!(worn.heading > 1e-2, "{worn:?}");
    // A weaker left soil drags the left side.
    let soft = driven(
        model("sandy_loam", &[("left_right_soil.ratio", 0.5)]),
        6.0,
        6.0,
    );
    assert!(soft.heading > 1e-3, "{soft:?}");
}

#[test]
fn what_resists_sideways_resists_turning() {
    let paper = driven(paper_model("sandy_loam"), 5.0, 8.0).heading;
    for effect in [
        ("bulldozing.lateral", 1.0),
        ("rate_dependent_soil.lateral", 500.0),
        ("shear_anisotropy.strength_ratio", 1.5),
        ("shear_anisotropy.modulus_ratio", 0.5),
    ] {
        let found = driven(model("sandy_loam", &[effect]), 5.0, 8.0).heading;
        assert!(found < paper - 1e-3, "{effect:?}: {found} {paper}");
    }
}

#[test]
fn a_payload_sinks_the_wheels_under_it() {
    let loaded = model(
        "dry_sand",
        &[("payload.mass", 100.0), ("payload.ahead", 0.915)],
    );
    let (with, without) = (
        wrench(&loaded, &STRAIGHT),
        wrench(&paper_model("dry_sand"), &STRAIGHT),
    );
    let sum: f64 = with.wheels.iter().map(|wheel| wheel.load).sum();
    assert!((sum - 590.0 * 9.81).abs() < 1e-6);
    assert!(with.wheels[0].sinkage > 1.1 * without.wheels[0].sinkage);
    // Sum X F_Z about the old centre of mass: 100 kg at 0.915 - 0.17 m, in a steady run.
    let moment: f64 = [0.745, 0.135, -0.475, -1.085]
        .iter()
        .zip(with.wheels.chunks(2))
        .map(|(x, row)| x * (row[0].load + row[1].load))
        .sum();
    // Less what the acceleration shifts, m h a at the centre of mass of both.
    let height = (490.0 * 0.35 + 100.0 * 0.5) / 590.0;
    let expected = 100.0 * 9.81 * 0.745 - 590.0 * height * with.a_x;
    assert!((moment - expected).abs() < 1e-6, "{moment} {expected}");
}

#[test]
fn a_drawbar_unloads_the_front_rows_when_it_pulls_low_or_high() {
    // Below the centre of mass the pull at 0.1 m and the ground's thrust at 0 m.
    let pulled = model(
        "dry_clay",
        &[("drawbar.force", 1000.0), ("drawbar.hitch_height", 0.6)],
    );
    let loads = wrench(&pulled, &STRAIGHT).wheels;
    let paper = wrench(&paper_model("dry_clay"), &STRAIGHT).wheels;
    // Sum X F_Z changes by (0.6 - 0.35) x -1000 N = -250 N m; the plane through rows at +-0.915
    // and +-0.305 m shares it out by X / sum X^2 = 0.915 / 3.7210.
    let change = loads[0].load - paper[0].load;
    assert!((change + 250.0 * 0.915 / 3.721).abs() < 1.0, "{change}");
}

#[test]
fn grade_moves_the_load_downhill_by_the_moment_of_the_weight() {
    // Held by its wheels on a slope of 0.1 rad, facing uphill: the ground pushes forward with
    // m g sin 0.1 = 479.9 N at the ground, 0.35 m below the centre of mass: 167.96 N m.
    let rest = Motion::default();
    let held = model(
        "dry_clay",
        &[
            ("grade.slope_east", 0.1),
            ("transient_shear.relaxation", 1.0),
        ],
    );
    let mut parked = Simulation::new(held);
    parked.step(20.0).unwrap();
    let loads = parked.wrench().unwrap().wheels.clone();
    let flat = wrench(&paper_model("dry_clay"), &rest).wheels;
    let sum: f64 = loads.iter().map(|wheel| wheel.load).sum();
    assert!((sum - 490.0 * 9.81 * 0.1_f64.cos()).abs() < 1e-6);
    let moment = |wheels: &[ugv_terrain::vehicle::WheelOutputs]| -> f64 {
        let rows = [0.915, 0.305, -0.305, -0.915].map(|row| row - 0.17);
        wheels
            .iter()
            .enumerate()
            .map(|(i, w)| rows[i / 2] * w.load)
            .sum()
    };
    let change = moment(&loads) - moment(&flat);
    assert!(
        (change + 0.35 * 490.0 * 9.81 * 0.1_f64.sin()).abs() < 0.2,
        "{change}"
    );
}

#[test]
fn wedges_push_as_hard_as_by_hand() {
    // Side force of one wheel at beta = 90 deg beside the rolling: the difference to the paper is
    // N times int R_b r cos theta sin(beta) dtheta, here by the midpoint rule.
    let effect = model("dry_sand", &[("bulldozing.lateral", 1.0)]);
    let (with, without) = (
        wrench(&effect, &SIDEWAYS),
        wrench(&paper_model("dry_sand"), &SIDEWAYS),
    );
    let sin_beta = 0.4 / 1.9_f64.hypot(0.4);
    let t = 28.0_f64.to_radians().tan();
    let q = (1.0 + t * t).sqrt() + t;
    let mut expected = 0.0;
    for wheel in &with.wheels {
        let (r, entry) = (0.25, wheel.entry_angle);
        let strip = |theta: f64| {
            let h = r * (theta.cos() - entry.cos());
            2.0 * q * (1040.0 * h + (q + q * q * t) * 16e3 * h * h / 2.0) * r * theta.cos()
        };
        let step = entry / 2000.0;
        let sum: f64 = (0..2000).map(|k| strip((f64::from(k) + 0.5) * step)).sum();
        expected -= sum * step * sin_beta;
    }
    let found: f64 = with
        .wheels
        .iter()
        .zip(&without.wheels)
        .map(|(a, b)| a.force_y - b.force_y)
        .sum();
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
}

#[test]
fn slip_sinkage_digs_spinning_wheels_in() {
    let spinning = Motion {
        v_x: 0.5,
        ..STRAIGHT
    };
    let mean = |model: &VehicleModel, motion: &Motion| {
        let wheels = wrench(model, motion).wheels;
        wheels.iter().map(|wheel| wheel.sinkage).sum::<f64>() / wheels.len() as f64
    };
    for effect in [
        ("slip_sinkage.sinkage_growth", 0.8),
        ("slip_sinkage.exponent_growth", 0.4),
    ] {
        let (on, off) = (model("dry_sand", &[effect]), paper_model("dry_sand"));
        let dug = mean(&on, &spinning) / mean(&off, &spinning);
        let rolling = mean(&on, &STRAIGHT) / mean(&off, &STRAIGHT);
        assert!(
            dug > 1.25 && dug > rolling && rolling >= 1.0,
            "{effect:?}: {dug} {rolling}"
        );
    }
}

#[test]
fn wheels_that_slide_sideways_dig_in_as_well() {
    let (on, off) = (
        model("dry_sand", &[("slip_sinkage.sinkage_growth", 0.8)]),
        paper_model("dry_sand"),
    );
    let deeper = |motion: &Motion| {
        let sinkages = |model| {
            wrench(model, motion)
                .wheels
                .iter()
                .map(|wheel| wheel.sinkage)
                .sum::<f64>()
        };
        sinkages(&on) / sinkages(&off)
    };
    assert!(deeper(&SIDEWAYS) > 1.02 * deeper(&STRAIGHT));
}

#[test]
fn a_soft_tyre_sinks_less_where_the_ground_is_hard_enough() {
    let flat = model("dry_clay", &[("tyre_compliance.pressure", 20e3)]);
    let (soft, rigid) = (
        wrench(&flat, &STRAIGHT),
        wrench(&paper_model("dry_clay"), &STRAIGHT),
    );
    assert!(soft.rolling_resistance < rigid.rolling_resistance);
    assert!(soft.wheels[0].sinkage < rigid.wheels[0].sinkage);
}

#[test]
fn another_soil_begins_at_its_boundary() {
    let change = [
        ("terrain_change.cohesion_factor", 0.3),
        ("terrain_change.stiffness_factor", 0.1),
        ("terrain_change.position", 5.0),
    ];
    let mut drive = Simulation::new(model("clayed_soil", &change));
    let mut paper = Simulation::new(paper_model("clayed_soil"));
    for drive in [&mut drive, &mut paper] {
        drive.set_wheel_speeds(speeds(6.0, 6.0)).unwrap();
        drive.step(2.0).unwrap();
    }
    assert!((drive.state().x - paper.state().x).abs() < 1e-3 && drive.state().x < 3.5);
    drive.step(8.0).unwrap();
    paper.step(8.0).unwrap();
    assert!(
        drive.wrench().unwrap().wheels[0].sinkage > 1.5 * paper.wrench().unwrap().wheels[0].sinkage
    );
}

#[test]
fn the_greatest_stress_further_back_lowers_the_resistance() {
    let early = wrench(&model("dry_sand", &[("stress_peak.a0", 0.3)]), &STRAIGHT);
    let late = wrench(&model("dry_sand", &[("stress_peak.a0", 0.6)]), &STRAIGHT);
    assert!(early.rolling_resistance < late.rolling_resistance);
}
