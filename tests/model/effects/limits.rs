//! Off is the paper, bit for bit; nearly off is nearly the paper.

use super::{MOTIONS, model, specification};
use crate::common::{paper_model, wrench};
use ugv_terrain::effects::{CATALOGUE, EffectKind, Effects};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Motion, VehicleModel, Wrench};

/// Of the distance from off to the end of the range: what a force of some 1000 N changes by is
/// below a newton.
const NEARLY_OFF: f64 = 1e-7;
/// Force [N] and moment [N m]: the rules of quadrature differ by less on these motions.
const QUADRATURE_TOLERANCE: f64 = 1.0;

/// Relative: the load transfer of a wheel that rolls slowly.
const FLAT: f64 = 0.01;

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
        for effect in CATALOGUE.iter().filter(|e| e.kind == EffectKind::Physics) {
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

/// On hard ground a tyre is flat: its sinkage goes with the pressure as a plate's, p^(1/n), and its contact
/// is as long as the load over the pressure, however large the circle that stands for it.
#[test]
fn a_soft_tyre_on_hard_ground_is_flat() {
    let rolling = Motion {
        v_x: 1.0,
        v_y: 0.0,
        yaw_rate: 0.0,
        omega_left: 4.0,
        omega_right: 4.0,
    };
    let n = Terrain::preset("dry_clay").unwrap().sinkage_exponent;
    let contact = |pressure: f64| {
        let model = model("dry_clay", &[("tyre_compliance.pressure", pressure)]);
        let wheel = wrench(&model, &rolling).wheels[0];
        (
            wheel.sinkage,
            2.0 * wheel.sinkage / wheel.entry_angle,
            wheel.load,
        )
    };
    for pressure in [200e3, 100e3, 60e3] {
        let (sinkage, length, load) = contact(pressure);
        let (deeper, shorter, other) = contact(1.25 * pressure);
        assert!((deeper / sinkage / 1.25_f64.powf(1.0 / n) - 1.0).abs() < FLAT);
        assert!((length / shorter / 1.25 - 1.0).abs() < FLAT);
        assert!((load / other - 1.0).abs() < FLAT);
        // The stress is nowhere more than the tyre's pressure, and not far below it where n is small.
        let mean = load / (0.246 * length);
        assert!(
            (0.8..1.05).contains(&(mean / pressure)),
            "{mean} {pressure}"
        );
    }
}
