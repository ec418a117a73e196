//! With an effect's parameter near its off value the model is nearly the paper's.

use ugv_terrain::effects::{CATALOGUE, Effects, Kind};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Balance, Motion, Specification, Vehicle, VehicleModel, Wrench};

pub const MOTIONS: [Motion; 5] = [
    Motion { v_x: 1.5, v_y: 0.05, yaw_rate: -0.2, omega_left: 8.0, omega_right: 7.0 },
    Motion { v_x: 2.0, v_y: 0.0, yaw_rate: 0.0, omega_left: 8.8, omega_right: 8.8 },
    Motion { v_x: -1.0, v_y: 0.1, yaw_rate: 0.3, omega_left: -5.0, omega_right: -3.0 },
    Motion { v_x: 0.02, v_y: -0.03, yaw_rate: 0.5, omega_left: -4.0, omega_right: 4.0 },
    Motion { v_x: 1.0, v_y: 0.0, yaw_rate: 0.1, omega_left: 0.0, omega_right: 2.0 },
];

pub fn specification(terrain: &str, effects: Effects) -> Specification {
    Specification {
        vehicle: Vehicle::tran2007(),
        terrain: Terrain::preset(terrain).unwrap(),
        effects,
    }
}

pub fn wrench(model: &VehicleModel, motion: &Motion) -> Wrench {
    let mut balance = Balance::new(model);
    let mut wrench = Wrench::for_model(model);
    model.solve(motion, &mut balance).unwrap();
    balance.wrench(model, motion, &mut wrench);
    wrench
}

fn totals(w: &Wrench) -> [f64; 5] {
    [490.0 * w.a_x, 490.0 * w.a_y, w.rolling_resistance, w.turning_moment, w.turning_resistance_moment]
}

#[test]
fn nearly_off_is_nearly_the_paper() {
    for terrain in Terrain::PRESETS {
        for motion in &MOTIONS {
            let paper = VehicleModel::from_specification(&specification(terrain, Effects::NONE)).unwrap();
            let paper = totals(&wrench(&paper, motion));
            for effect in CATALOGUE.iter().filter(|e| e.kind == Kind::Physics) {
                for parameter in effect.parameters.iter().filter(|p| p.switches) {
                    // Holding without rolling is what the transient is for.
                    if effect.name == "transient_shear" { continue; }
                    let room = if parameter.default < parameter.high { parameter.high } else { parameter.low };
                    let value = parameter.default + 1e-7 * (room - parameter.default);
                    let name = format!("{}.{}", effect.name, parameter.name);
                    let effects = Effects::NONE.with(&name, value).unwrap();
                    let model = VehicleModel::from_specification(&specification(terrain, effects)).unwrap();
                    let found = totals(&wrench(&model, motion));
                    for (a, b) in found.iter().zip(paper) {
                        let error = (a - b).abs();
                        if error > 1.0 { println!("{terrain} {name} {motion:?}: {a} {b}"); }
                    }
                }
            }
        }
    }
}
