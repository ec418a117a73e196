//! Off is the paper, bit for bit; nearly off is nearly the paper.

use super::common::{paper_model, wrench};
use super::{MOTIONS, model, specification};
use ugv_terrain::effects::{CATALOGUE, Effects, Kind};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{VehicleModel, Wrench};

/// Of the distance from off to the end of the range: what a force of some 1000 N changes by is
/// below a newton.
const NEARLY_OFF: f64 = 1e-7;
/// Force [N] and moment [N m]: the rules of quadrature differ by less on these motions.
const QUADRATURE_TOLERANCE: f64 = 1.0;

fn totals(w: &Wrench) -> [f64; 5] {
    [
        490.0 * w.a_x,
        490.0 * w.a_y,
        w.rolling_resistance,
        w.turning_moment,
        w.turning_resistance_moment,
    ]
}

#[test]
fn off_is_the_paper_bit_for_bit() {
    for terrain in Terrain::PRESETS {
        // Shapes and sensors change nothing while no switch is on.
        let effects = Effects::NONE
            .with("drawbar.hitch_height", 1.0)
            .and_then(|e| e.with("latency.pose", 0.4))
            .and_then(|e| e.with("yaw_rate_bias.bias", 0.02))
            .unwrap();
        let off = VehicleModel::from_specification(&specification(terrain, effects)).unwrap();
        assert_eq!(off.memory_count(), 0);
        for motion in &MOTIONS {
            assert_eq!(wrench(&off, motion), wrench(&paper_model(terrain), motion));
        }
    }
}

#[test]
fn nearly_off_is_nearly_the_paper() {
    let mut compared = 0;
    for terrain in Terrain::PRESETS {
        let paper = MOTIONS.map(|motion| totals(&wrench(&paper_model(terrain), &motion)));
        for effect in CATALOGUE.iter().filter(|e| e.kind == Kind::Physics) {
            // A transient is a state of its own: tests/effects/memory.rs.
            let switches = effect.parameters.iter().filter(|p| p.switches);
            for parameter in switches.filter(|_| effect.name != "transient_shear") {
                let far = if parameter.default < parameter.high {
                    parameter.high
                } else {
                    parameter.low
                };
                let value = parameter.default + NEARLY_OFF * (far - parameter.default);
                let name = format!("{}.{}", effect.name, parameter.name);
                let on = model(terrain, &[(&name, value)]);
                for (motion, paper) in MOTIONS.iter().zip(&paper) {
                    for (found, paper) in totals(&wrench(&on, motion)).iter().zip(paper) {
                        let error = (found - paper).abs();
                        assert!(
                            error < QUADRATURE_TOLERANCE,
                            "{terrain} {name} {motion:?}: {error}"
                        );
                        compared += 1;
                    }
                }
            }
        }
    }
    assert!(compared > 2000, "{compared}");
}
