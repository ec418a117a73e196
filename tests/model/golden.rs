//! The independent golden values: wrenches and trajectories of the paper's vehicle, and the
//! convergence of the quadrature on them.

use crate::common::{drive, paper_model, starting_at, wrench};
use serde_json::Value;
use ugv_terrain::contact::{Regularisation, Resolution};
use ugv_terrain::simulation::State;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Motion, Vehicle, VehicleModel, Wrench};

/// The golden values' own tolerance: 0.1 % of the largest wheel force or 0.1 N, whichever is
/// larger; they do not regularise the slip direction, the model does.
const RELATIVE_TOLERANCE: f64 = 1e-3;
const FORCE_TOLERANCE: f64 = 0.1;
/// Entry angles: what 0.1 % of a load is worth, and half of it.
const ANGLE_TOLERANCE: f64 = 5e-4;
/// The golden trajectories' own tolerance at their end.
const POSITION_TOLERANCE: f64 = 2e-3;
const HEADING_TOLERANCE: f64 = 1e-3;

struct GoldenState {
    terrain: String,
    motion: Motion,
    value: Value,
}

impl GoldenState {
    fn number(&self, key: &str) -> f64 {
        self.value[key]
            .as_f64()
            .unwrap_or_else(|| panic!("{key} is missing"))
    }

    fn wheel(&self, index: usize, key: &str) -> f64 {
        self.value["wheels"][index][key]
            .as_f64()
            .unwrap_or_else(|| panic!("{key} is missing"))
    }

    /// The totals that these numbers of quadrature nodes give.
    fn totals_with(&self, resolution: Resolution) -> [f64; 5] {
        let soil = Terrain::preset(&self.terrain).unwrap();
        let (vehicle, settings) = (Vehicle::tran2007(), Regularisation::default());
        let model = VehicleModel::with_settings(vehicle, soil, settings, resolution).unwrap();
        totals(&wrench(&model, &self.motion))
    }

    /// Tolerance of every force and moment of this state.
    fn tolerance(&self) -> f64 {
        let largest = (0..8)
            .map(|i| self.wheel(i, "F_X").abs().max(self.wheel(i, "F_Y").abs()))
            .fold(0.0, f64::max);
        (RELATIVE_TOLERANCE * largest).max(FORCE_TOLERANCE)
    }
}

fn golden_states() -> Vec<GoldenState> {
    let document: Value = serde_json::from_str(include_str!("../golden/wrenches.json")).unwrap();
    let states = document["states"].as_array().unwrap();
    assert_eq!(states.len(), 16);
    states
        .iter()
        .map(|value| {
            let number = |key: &str| value[key].as_f64().unwrap();
            GoldenState {
                terrain: value["terrain"].as_str().unwrap().to_owned(),
                motion: Motion {
                    v_x: number("V_X"),
                    v_y: number("V_Y"),
                    yaw_rate: number("yaw_rate"),
                    omega_left: number("omega_left"),
                    omega_right: number("omega_right"),
                },
                value: value.clone(),
            }
        })
        .collect()
}

/// F_X, F_Y, M_Z, R_r and M_r.
fn totals(wrench: &Wrench) -> [f64; 5] {
    let Vehicle {
        mass, yaw_inertia, ..
    } = Vehicle::tran2007();
    [
        mass * wrench.a_x,
        mass * wrench.a_y,
        yaw_inertia * wrench.yaw_acceleration,
        wrench.rolling_resistance,
        wrench.turning_resistance_moment,
    ]
}

#[test]
fn every_golden_wrench_is_met() {
    for (number, golden) in golden_states().iter().enumerate() {
        let wrench = wrench(&paper_model(&golden.terrain), &golden.motion);
        let tolerance = golden.tolerance();
        let close = |what: &str, value: f64, expected: f64, tolerance: f64| {
            let error = (value - expected).abs();
            assert!(
                error <= tolerance,
                "state {number}, {what}: {value} and not {expected}"
            );
        };
        let names = [
            "F_X",
            "F_Y",
            "M_Z",
            "rolling_resistance",
            "turning_resistance_moment",
        ];
        for (name, value) in names.into_iter().zip(totals(&wrench)) {
            close(name, value, golden.number(name), tolerance);
        }
        let turning = wrench.turning_moment - wrench.turning_resistance_moment;
        close(
            "M_Z from its two parts",
            turning,
            golden.number("M_Z"),
            tolerance,
        );
        for (index, wheel) in wrench.wheels.iter().enumerate() {
            close("load", wheel.load, golden.wheel(index, "load"), tolerance);
            close(
                "F_X of a wheel",
                wheel.force_x,
                golden.wheel(index, "F_X"),
                tolerance,
            );
            close(
                "F_Y of a wheel",
                wheel.force_y,
                golden.wheel(index, "F_Y"),
                tolerance,
            );
            let angle = golden.wheel(index, "entry_angle");
            close("entry angle", wheel.entry_angle, angle, ANGLE_TOLERANCE);
        }
    }
}

#[test]
fn halving_the_quadrature_nodes_changes_no_golden_total() {
    let full = Resolution::default();
    let half = full.halved();
    assert_eq!((half.arc, half.width), (full.arc / 2, full.width / 2));
    for (number, golden) in golden_states().iter().enumerate() {
        let evaluate = |resolution| golden.totals_with(resolution);
        let tolerance = golden.tolerance();
        for (fine, coarse) in evaluate(full).into_iter().zip(evaluate(half)) {
            let change = (fine - coarse).abs();
            assert!(
                change <= tolerance,
                "state {number}: {change} over {tolerance}"
            );
        }
    }
}

#[test]
fn the_nodes_have_converged_far_below_the_tolerance() {
    // Doubling the nodes must change next to nothing: a twentieth of the tolerance.
    let full = Resolution::default();
    let double = Resolution {
        arc: 2 * full.arc,
        width: 2 * full.width,
        sharp_reversal: 2 * full.sharp_reversal,
    };
    for (number, golden) in golden_states().iter().enumerate() {
        let evaluate = |resolution| golden.totals_with(resolution);
        for (fine, coarse) in evaluate(double).into_iter().zip(evaluate(full)) {
            let change = (fine - coarse).abs();
            let allowed = 0.05 * golden.tolerance();
            assert!(change <= allowed, "state {number}: {change} over {allowed}");
        }
    }
}

#[test]
fn every_golden_trajectory_is_met() {
    for (terrain, text) in [
        (
            "dry_sand",
            include_str!("../golden/trajectory_dry_sand.csv"),
        ),
        (
            "sandy_loam",
            include_str!("../golden/trajectory_sandy_loam.csv"),
        ),
        (
            "clayed_soil",
            include_str!("../golden/trajectory_clayed_soil.csv"),
        ),
        (
            "dry_clay",
            include_str!("../golden/trajectory_dry_clay.csv"),
        ),
    ] {
        let rows: Vec<Vec<f64>> = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
            .collect();
        let table: Vec<_> = rows.iter().map(|row| (row[0], row[1], row[2])).collect();
        let start = State {
            v_x: 1.1,
            ..State::default()
        };
        let mut simulation = starting_at(paper_model(terrain), start);
        drive(&mut simulation, &table, |index, simulation| {
            let (row, state) = (&rows[index], simulation.state());
            let distance = (state.x - row[3]).hypot(state.y - row[4]);
            assert!(
                distance < POSITION_TOLERANCE,
                "{terrain}, {} s: {distance} m",
                row[0]
            );
            let turned = (state.heading - row[5]).abs();
            assert!(
                turned < HEADING_TOLERANCE,
                "{terrain}, {} s: {turned} rad",
                row[0]
            );
            let wrench = simulation.wrench().unwrap();
            // The resistances vary by some 100 N and 1000 N m a second: 0.1 % of them.
            let resistance = (wrench.rolling_resistance - row[9]).abs();
            assert!(resistance < 1.0, "{terrain}, {} s: {resistance} N", row[0]);
            let moment = (wrench.turning_resistance_moment - row[10]).abs();
            assert!(moment < 1.0, "{terrain}, {} s: {moment} N m", row[0]);
        });
    }
}
