//! A minute of mixed driving on each soil in steps of 1, 10 and 100 ms: how many times faster than
//! real time, the worst step, and where the drive ends. `scripts/tools/bench.sh` runs it.

use std::f64::consts::TAU;
use std::time::Instant;
use ugv_terrain::simulation::{Simulation, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};

const SECONDS: f64 = 60.0;

/// Wheel speeds \[rad/s\]: start, slalom, pivot to and fro, reverse with a bend, stop.
fn mixed(time: f64) -> WheelSpeeds {
    let ramp = |from: f64, to: f64| ((time - from) / (to - from)).clamp(0.0, 1.0);
    let smooth = |u: f64| u * u * (3.0 - 2.0 * u);
    let forward = 8.0 * smooth(ramp(1.0, 5.0)) * (1.0 - smooth(ramp(26.0, 29.0)))
        - 6.0 * smooth(ramp(42.0, 45.0)) * (1.0 - smooth(ramp(53.0, 56.0)));
    let slalom =
        2.0 * (TAU * (time - 8.0) / 6.0).sin() * f64::from(u8::from((8.0..26.0).contains(&time)));
    let pivot = 4.0 * smooth(ramp(30.0, 32.0)) * (1.0 - smooth(ramp(34.0, 35.0)))
        - 4.0 * smooth(ramp(36.0, 38.0)) * (1.0 - smooth(ramp(40.0, 41.0)));
    let bend = 1.0 * smooth(ramp(46.0, 47.0)) * (1.0 - smooth(ramp(50.0, 51.0)));
    let turn = slalom + pivot + bend;
    WheelSpeeds {
        left: forward - turn,
        right: forward + turn,
    }
}

fn main() {
    println!(
        "| soil | step [ms] | times real time | worst step [us] | steps | evaluations | Jacobians | x [m] | y [m] | heading [rad] |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for soil in Terrain::PRESETS {
        let model = VehicleModel::new(
            Vehicle::tran2007(),
            Terrain::preset(soil).expect("a preset"),
        );
        let model = std::sync::Arc::new(model.expect("valid"));
        for step in [0.001, 0.01, 0.1] {
            let count = (SECONDS / step).round() as usize;
            let mut best = f64::INFINITY;
            let mut worst = vec![f64::INFINITY; count];
            let mut end = None;
            for _ in 0..5 {
                let mut drive = Simulation::new(model.clone());
                let start = Instant::now();
                for (k, worst) in worst.iter_mut().enumerate() {
                    let begun = Instant::now();
                    drive
                        .set_wheel_speeds(mixed(k as f64 * step))
                        .expect("finite");
                    drive.step(step).expect("drivable");
                    *worst = worst.min(begun.elapsed().as_secs_f64());
                }
                best = best.min(start.elapsed().as_secs_f64());
                end = Some(drive);
            }
            let drive = end.expect("driven");
            let (state, counters) = (drive.state(), drive.counters());
            println!(
                "| {soil} | {} | {:.0} | {:.0} | {} | {} | {} | {:.4} | {:.4} | {:.4} |",
                step * 1e3,
                SECONDS / best,
                1e6 * worst.iter().copied().fold(0.0, f64::max),
                counters.steps,
                counters.evaluations,
                counters.jacobians,
                state.x,
                state.y,
                state.heading,
            );
        }
    }
}
