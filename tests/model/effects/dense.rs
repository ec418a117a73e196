//! One wheel under every effect of its contact against a dense sum written from the declarations'
//! equations alone: other coordinates, another rule, no shared code.

use fearless_simd::Level;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use ugv_terrain::contact::{
    Detail, Regularisation, Resolution, Wheel, WheelContact, WheelForces, WheelLaw, WheelMemory,
    WheelMotion,
};
use ugv_terrain::effects::{Bulldozing, Displacement, Multipass, SlipSinkage, Soil, StressPeak};

const RADIUS: f64 = 0.25;
pub const WIDTH: f64 = 0.246;
/// Of the wheel's largest force: what the model's own rule may err by on such a law.
const RELATIVE_TOLERANCE: f64 = 4e-3;
const FORCE_TOLERANCE: f64 = 0.3;
/// Speed \[m/s\] that keeps the slip of a wheel at rest finite.
const SLOWEST: f64 = 1e-12;
/// \[W\].
const POWER_TOLERANCE: f64 = 0.3;

/// Rows across the width and points along the arc of the dense sum (midpoint rule).
const DENSE: [usize; 2] = [64, 3000];

fn soil() -> Soil<f64> {
    Soil {
        cohesion: 1720.0,
        friction: 29.0_f64.to_radians().tan(),
        modulus: 5.27e3 / WIDTH + 1_515_040.0,
        exponent: 0.7,
        shear_modulus: 0.025,
    }
}

pub fn plain() -> WheelLaw<f64> {
    WheelLaw::paper(soil(), RADIUS, WIDTH)
}

fn contact() -> WheelContact {
    WheelContact::new(Regularisation::default(), Resolution::default()).unwrap()
}

/// Circle and entry angle of a tyre that sinks to `flat` at most: its contact grows beyond with the square of what a
/// rigid wheel would have sunk.
fn arc(law: &WheelLaw<f64>, reach: f64) -> (f64, f64) {
    let rigid = law.radius * (1.0 - reach.cos());
    match law.flat {
        Some(flat) if rigid > flat => {
            let circle = law.radius * (rigid / flat).powi(4);
            (circle, (1.0 - flat / circle).acos())
        }
        _ => (law.radius, reach),
    }
}

/// The cosine of an angle less that of another, to the last digits where both are small.
fn fallen(angle: f64, entry: f64) -> f64 {
    2.0 * ((0.5 * entry).sin().powi(2) - (0.5 * angle).sin().powi(2))
}

/// What the soil does to a wheel, and takes from it.
pub struct DenseSums {
    /// F_X, F_Y, F_Z \[N\] and the moment about the vertical axis \[N m\].
    pub forces: [f64; 4],
    /// Power \[W\] that the soil takes up: each stress times the velocity of the rim's point against
    /// the soil, (11) and (12).
    pub lost: f64,
}

/// The sums of a wheel that travels forwards, on a circle that enters the soil at an angle; so many
/// rows and points.
pub fn dense(
    law: &WheelLaw<f64>,
    m: &WheelMotion<f64>,
    memory: &WheelMemory<f64>,
    (circle, entry): (f64, f64),
    [rows, points]: [usize; 2],
) -> DenseSums {
    let regularisation = Regularisation::default();
    let rim = law.radius * m.angular_speed;
    // Slips are rounded off within one per cent, and held from 1 on.
    let rounded = |slip: f64| slip.hypot(0.01) - 0.01;
    let slip = rounded((rim - m.forward) / rim.abs().max(m.forward.abs()).max(SLOWEST));
    let (mut k, mut n) = (law.soil.modulus, law.soil.exponent);
    if let Some(effect) = &law.slip_sinkage {
        let whole = (rim - m.forward).hypot(m.lateral)
            / rim.abs().max(m.forward.hypot(m.lateral)).max(SLOWEST);
        let whole = match rounded(whole) {
            slip if slip <= 1.0 => slip,
            slip => 1.1 - 0.1 * (-(slip - 1.0) / 0.1).exp(),
        };
        let grown = effect.sinkage_growth * whole;
        k /= ((1.0 + grown) / (1.0 - grown / 2.0)).powf(n);
        n += effect.exponent_growth * whole;
    }
    let exit = -law.rebound * entry;
    let share = law
        .peak
        .map_or(0.5, |peak| (peak.a0 + peak.a1 * slip).min(0.95));
    let peak = exit + share * (entry - exit);
    let pressure = |theta: f64| {
        let alike = if theta >= peak {
            theta
        } else {
            entry - (theta - exit) / (peak - exit) * (entry - peak)
        };
        let depth = circle * fallen(alike, entry).max(0.0);
        match &law.multipass {
            None => k * depth.powf(n),
            Some(effect) => {
                let before = memory.pressed;
                let ground = before * (1.0 - 1.0 / effect.stiffness_ratio);
                if ground + depth < before {
                    effect.stiffness_ratio * k * before.powf(n - 1.0) * depth
                } else {
                    k * (ground + depth).powf(n)
                }
            }
        }
    };
    let (turning, slowest) = (m.angular_speed.abs(), regularisation.angular_speed);
    let turning = if turning < 2.0 * slowest {
        slowest + turning * turning / (4.0 * slowest)
    } else {
        turning
    };
    let time = circle / (law.radius * turning);
    let moved = if law.transient {
        memory.displacement
    } else {
        Displacement {
            forward: m.forward * time,
            lateral: m.lateral * time,
            yaw: m.yaw_rate * time,
            rim: rim * time,
        }
    };
    let step = (entry - exit) / points as f64;
    let mut sums = [0.0; 4];
    let mut lost = 0.0;
    for row in 0..rows {
        let y = WIDTH * ((row as f64 + 0.5) / rows as f64 - 0.5);
        for point in 0..points {
            let theta = exit + step * (point as f64 + 0.5);
            let (sin, cos) = theta.sin_cos();
            let sigma = pressure(theta);
            let forward = m.forward - m.yaw_rate * y;
            let v = [
                forward * cos * cos - rim * cos,
                m.lateral + m.yaw_rate * circle * sin,
                forward * sin * cos - rim * sin,
            ];
            let jf = moved.forward - moved.yaw * y;
            let j = [
                jf * ((entry - theta) / 2.0 + ((2.0 * entry).sin() - (2.0 * theta).sin()) / 4.0)
                    - moved.rim * (entry.sin() - sin),
                moved.lateral * (entry - theta) + moved.yaw * circle * fallen(theta, entry),
                jf * ((2.0 * theta).cos() - (2.0 * entry).cos()) / 4.0
                    + moved.rim * -fallen(theta, entry),
            ];
            let kx = law.soil.shear_modulus;
            let ky = kx * law.modulus_ratio;
            let path = ((j[0] / kx).powi(2) + (j[2] / kx).powi(2) + (j[1] / ky).powi(2)).sqrt();
            let tau = (law.soil.cohesion + sigma * law.soil.friction) * (1.0 - (-path).exp());
            let slip = v;
            let v = if law.transient {
                // Where nothing slides, the shear is opposite to the displacement.
                let length = j.iter().map(|j| j * j).sum::<f64>().sqrt();
                let share = regularisation.slip_speed / (length + kx);
                let tangential = (j[0] * cos + j[2] * sin) * share;
                let lean = [tangential * cos, j[1] * share, tangential * sin];
                [0, 1, 2].map(|axis| v[axis] + lean[axis])
            } else {
                v
            };
            let speed = v.iter().map(|v| v * v).sum::<f64>() + regularisation.slip_speed.powi(2);
            let direction = v.map(|v| -v / speed.sqrt());
            let area = circle * step * WIDTH / rows as f64;
            let shear = [
                direction[0],
                direction[1] * law.strength_ratio,
                direction[2],
            ];
            let force = [
                tau * shear[0] - sigma * sin,
                tau * shear[1],
                tau * shear[2] + sigma * cos,
            ];
            for axis in 0..3 {
                sums[axis] += force[axis] * area;
            }
            sums[3] += area * (circle * sin * tau * shear[1] - y * tau * shear[0]);
            let sheared: f64 = shear.iter().zip(slip).map(|(s, v)| -tau * s * v).sum();
            lost += area * (sheared + sigma * forward * sin);
        }
    }
    if let Some(effect) = &law.bulldozing {
        let phi = law.soil.friction.atan();
        let x = std::f64::consts::FRAC_PI_4 - phi / 2.0;
        let (cot, d1) = (1.0 / x.tan(), 1.0 / x.tan() + (x + phi).tan());
        let d2 = cot + cot * cot * phi.tan();
        let blade = |h: f64| d1 * (law.soil.cohesion * h + d2 * effect.unit_weight * h * h / 2.0);
        let fading = m
            .forward
            .hypot(m.lateral)
            .hypot(regularisation.travel_speed);
        for point in 0..points {
            let theta = exit + step * (point as f64 + 0.5);
            let h = circle * fallen(theta, entry);
            let blades = blade(h) * circle * theta.cos() * step;
            let push = effect.lateral * blades * m.lateral / fading;
            sums[1] -= push;
            sums[3] -= push * circle * theta.sin();
            lost += push * (m.lateral + m.yaw_rate * circle * theta.sin());
        }
        let deepest = circle * fallen(0.0, entry);
        let front = effect.frontal * WIDTH * blade(deepest) * m.forward / fading;
        sums[0] -= front;
        lost += front * m.forward;
    }
    let viscous = [m.forward, m.lateral];
    for axis in 0..2 {
        sums[axis] -= law.viscosity[axis] * viscous[axis];
        lost += law.viscosity[axis] * viscous[axis].powi(2);
    }
    DenseSums { forces: sums, lost }
}

fn totals(forces: &WheelForces<f64>) -> [f64; 4] {
    [
        forces.thrust - forces.compaction,
        forces.lateral,
        forces.vertical,
        forces.arc_moment - forces.width_moment,
    ]
}

fn law() -> impl Strategy<Value = WheelLaw<f64>> {
    (0..9, 0.0..1.0, 0.0..1.0).prop_map(|(which, a, b)| {
        let mut law = plain();
        match which {
            0 => law.rebound = a,
            1 => {
                law.peak = Some(StressPeak {
                    a0: 0.25 + 0.3 * a,
                    a1: 0.3 * b,
                })
            }
            2 => {
                law.slip_sinkage = Some(SlipSinkage {
                    exponent_growth: 0.5 * a,
                    sinkage_growth: b,
                })
            }
            3 => {
                law.bulldozing = Some(Bulldozing {
                    lateral: 2.0 * a,
                    frontal: b,
                    unit_weight: 17e3,
                })
            }
            4 => {
                law.multipass = Some(Multipass {
                    memory: 1.0,
                    stiffness_ratio: 2.0 + 20.0 * a,
                })
            }
            5 => (law.modulus_ratio, law.strength_ratio) = (0.4 + a, 0.6 + b),
            6 => law.flat = Some(0.004 + 0.02 * a),
            7 => law.viscosity = [100.0 * a, 100.0 * b],
            _ => {
                law.rebound = 0.4 * a;
                law.peak = Some(StressPeak { a0: 0.4, a1: 0.2 });
                law.multipass = Some(Multipass {
                    memory: 1.0,
                    stiffness_ratio: 8.0,
                });
                law.modulus_ratio = 0.5 + b;
            }
        }
        law
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, rng_seed: prop::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn forces_are_those_of_a_dense_sum(
        law in law(),
        forward in 0.2..3.0_f64,
        slip in -0.6..0.6_f64,
        lateral in -0.5..0.5_f64,
        yaw_rate in -0.8..0.8_f64,
        entry in 0.15..0.7_f64,
        pressed in 0.001..0.02_f64,
    ) {
        let motion = WheelMotion {
            forward,
            lateral,
            yaw_rate,
            angular_speed: forward / (RADIUS * (1.0 - slip)),
        };
        let memory = WheelMemory { pressed, ..WheelMemory::NONE };
        let wheel = Wheel { law, motion, memory, reach: entry };
        let forces = contact().forces(Level::new(), &wheel, Detail::Full);
        let sums = dense(&law, &motion, &memory, arc(&law, entry), DENSE);
        let (found, expected) = (totals(&forces), sums.forces);
        // What the axle puts in is what the forces on the wheel do and what the soil takes up.
        let driven = forces.torque * motion.angular_speed;
        let moved = found[0] * forward + found[1] * lateral + found[3] * yaw_rate;
        let allowed = RELATIVE_TOLERANCE * sums.lost.max(driven.abs()) + POWER_TOLERANCE;
        prop_assert!(
            (driven - moved - sums.lost).abs() < allowed,
            "{driven} W - {moved} W, {} W",
            sums.lost
        );
        let largest = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        for (a, b) in found.iter().zip(expected) {
            let tolerance = RELATIVE_TOLERANCE * largest + FORCE_TOLERANCE;
            prop_assert!((a - b).abs() < tolerance, "{found:?} {expected:?}");
        }
    }
}

/// Effects, and the soil's exponent, under which the rules have to converge.
fn converging() -> Vec<(&'static str, WheelLaw<f64>)> {
    let laws = [0.15, 0.7, 1.1].map(|exponent| {
        let law = |change: &dyn Fn(&mut WheelLaw<f64>)| {
            let mut law = plain();
            law.soil.exponent = exponent;
            change(&mut law);
            law
        };
        let rut = Multipass {
            memory: 1.0,
            stiffness_ratio: 10.0,
        };
        [
            ("viscosity", law(&|law| law.viscosity = [50.0; 2])),
            ("rebound", law(&|law| law.rebound = 0.4)),
            (
                "peak",
                law(&|law| law.peak = Some(StressPeak { a0: 0.4, a1: 0.2 })),
            ),
            ("rut", law(&|law| law.multipass = Some(rut))),
            ("tyre", law(&|law| law.flat = Some(0.03))),
            ("transient", law(&|law| law.transient = true)),
        ]
    });
    laws.into_iter().flatten().collect()
}

/// Of the wheel's largest force: what few motions may err by for want of nodes along the arc, and any.
const ALONG: [f64; 2] = [1e-3, 5e-3];
const FEW: f64 = 0.99;

#[test]
fn the_nodes_along_the_arc_have_converged_under_every_effect() {
    let settings = Regularisation::default();
    let make = |resolution: Resolution| WheelContact::new(settings, resolution).unwrap();
    let usual = Resolution::default();
    let fine = Resolution { arc: 160, ..usual };
    let contacts = [usual, fine].map(make);
    let motions = (
        0.2..3.0_f64,
        -0.3..0.3_f64,
        -0.5..0.5_f64,
        -0.8..0.8_f64,
        0.15..0.7_f64,
        0.0..1.0_f64,
    );
    let mut runner = TestRunner::deterministic();
    for (name, law) in converging() {
        let mut errors: Vec<f64> = (0..600)
            .map(|_| {
                let drawn = motions.new_tree(&mut runner).unwrap().current();
                let (forward, slip, lateral, yaw_rate, entry, share) = drawn;
                let motion = WheelMotion {
                    forward,
                    lateral: lateral * share,
                    yaw_rate,
                    angular_speed: forward / (RADIUS * (1.0 - slip.powi(3) / 0.09)),
                };
                let memory = WheelMemory {
                    pressed: RADIUS * (1.0 - entry.cos()) * 1.3 * share * share,
                    displacement: Displacement {
                        forward: 0.2,
                        lateral: 0.2 * lateral / forward,
                        yaw: 0.2 * yaw_rate / forward,
                        rim: 0.2 * RADIUS * motion.angular_speed / forward,
                    },
                };
                let [found, expected] = [0, 1].map(|k: usize| {
                    let wheel = Wheel {
                        law,
                        motion,
                        memory,
                        reach: entry,
                    };
                    totals(&contacts[k].forces(Level::new(), &wheel, Detail::Full))
                });
                let largest = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                let pairs = found.iter().zip(expected);
                pairs
                    .map(|(a, b)| (a - b).abs() / largest)
                    .fold(0.0, f64::max)
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize];
        let n = law.soil.exponent;
        println!(
            "{name}, n {n}: {:.0e} {:.0e} {:.0e} {:.0e}",
            at(0.5),
            at(0.9),
            at(FEW),
            at(1.0)
        );
        assert!(
            at(FEW) < ALONG[0] && at(1.0) < ALONG[1],
            "{name}, n {n}: {} {}",
            at(FEW),
            at(1.0)
        );
    }
}
