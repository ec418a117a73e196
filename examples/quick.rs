#[path = "../tests/bench/drive.rs"]
mod drive;
use std::sync::Arc;
use ugv_terrain::simulation::Simulation;
use ugv_terrain::simulation::batch::Rollout;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};
fn main() {
    for name in Terrain::PRESETS {
        let model = VehicleModel::new(Vehicle::tran2007(), Terrain::preset(name).unwrap()).unwrap();
        let exact = {
            let mut r = Rollout {
                simulation: Simulation::new(model.clone()),
                inputs: Arc::new(drive::mixed(60.0, 1)),
            };
            r.run(|_, _| Ok(())).unwrap();
            r.simulation.state()
        };
        for parts in [1, 10, 100] {
            let inputs = Arc::new(drive::mixed(60.0, parts));
            let mut best = 1e9_f64;
            let mut end = None;
            for _ in 0..4 {
                let mut r = Rollout {
                    simulation: Simulation::new(model.clone()),
                    inputs: inputs.clone(),
                };
                let t = std::time::Instant::now();
                r.run(|_, _| Ok(())).unwrap();
                best = best.min(t.elapsed().as_secs_f64());
                end = Some(r.simulation);
            }
            let s = end.unwrap();
            let (c, e) = (s.counters(), s.state());
            println!(
                "{name:12} {:4} ms: {:6.0}x  {:6.2} us/step; steps {} rej {} eval {} jac {}  us/eval {:.2} end {:.4} {:.4} {:.4} diff {:.2} mm",
                100 / parts,
                60.0 / best,
                best * 1e6 / (600.0 * parts as f64),
                c.steps,
                c.rejected,
                c.evaluations,
                c.jacobians,
                best * 1e6 / c.evaluations as f64,
                e.x,
                e.y,
                e.heading,
                1e3 * (e.x - exact.x).hypot(e.y - exact.y)
            );
        }
    }
}
