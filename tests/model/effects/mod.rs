//! Left-out physics switched on: limits, signs, symmetries, derivatives.

#[path = "../../common/page.rs"]
mod generated;

mod by_hand;
mod dense;
mod derivatives;
mod energy;
mod limits;
mod memory;
mod page;
mod properties;
mod ruts;
mod signs;
mod variables_page;
mod window;

use ugv_terrain::effects::Effects;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Motion, Specification, Vehicle, VehicleModel};

/// The paper's vehicle on one of its terrains with effects.
pub fn specification(terrain: &str, effects: Effects) -> Specification {
    Specification {
        vehicle: Vehicle::tran2007(),
        terrain: Terrain::preset(terrain).unwrap(),
        effects,
    }
}

/// The same as a model, with effects given by name.
pub fn model(terrain: &str, effects: &[(&str, f64)]) -> VehicleModel {
    let effects = effects.iter().fold(Effects::NONE, |all, (name, value)| {
        all.with(name, *value).unwrap()
    });
    VehicleModel::from_specification(&specification(terrain, effects)).unwrap()
}

/// A turn, a straight run, a turn in reverse, a pivot turn, braked left wheels.
pub const MOTIONS: [Motion; 5] = [
    Motion {
        v_x: 1.5,
        v_y: 0.05,
        yaw_rate: -0.2,
        omega_left: 8.0,
        omega_right: 7.0,
    },
    Motion {
        v_x: 2.0,
        v_y: 0.0,
        yaw_rate: 0.0,
        omega_left: 8.8,
        omega_right: 8.8,
    },
    Motion {
        v_x: -1.0,
        v_y: 0.1,
        yaw_rate: 0.3,
        omega_left: -5.0,
        omega_right: -3.0,
    },
    Motion {
        v_x: 0.02,
        v_y: -0.03,
        yaw_rate: 0.5,
        omega_left: -4.0,
        omega_right: 4.0,
    },
    Motion {
        v_x: 1.0,
        v_y: 0.0,
        yaw_rate: 0.1,
        omega_left: 0.0,
        omega_right: 2.0,
    },
];
