//! Random drives in steps of 1, 10 and 100 ms: how many end, how far their ends lie apart, and what the dearest step takes.
//! Prints the tables of the robustness page. The argument is the number of drives; without it there are 200.
//!
//! Ends are compared, and dearest steps taken, of drives that do not bog down. A step's time is the least of three runs,
//! in seconds of its thread's processor time.

#[path = "../model/drivable/draw.rs"]
#[allow(dead_code, reason = "tests drive others of them")]
mod draw;

use draw::Drive;
use rayon::prelude::*;
use rustix::time::{ClockId, clock_gettime};
use std::collections::BTreeMap;
use ugv_terrain::simulation::{Simulation, SimulationError, State, WheelSpeeds};
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{BalanceError, VehicleModel};

/// Steps \[ms\], and runs of which the dearest step's time is the least.
const STEPS: [usize; 3] = [1, 10, 100];
const RUNS: usize = 3;
const SECONDS: f64 = 20.0;
/// Drives of each kind that are listed.
const LISTED: usize = 5;

/// Seconds that this thread has had of the processor.
fn processor() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Wheel speeds at a time, linear between the rows of a table.
fn at(table: &[(f64, [f64; 2])], time: f64) -> WheelSpeeds {
    let later = table.iter().position(|(row, _)| *row > time);
    let later = later.unwrap_or(table.len() - 1).max(1);
    let ((from, a), (to, b)) = (table[later - 1], table[later]);
    let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
    WheelSpeeds::from([0, 1].map(|k| a[k] + share * (b[k] - a[k])))
}

/// The drive over the wheel speeds at every 100 ms, in steps of so many milliseconds. Where each step ends goes to
/// `visit`.
fn drive(
    model: &VehicleModel,
    table: &[(f64, [f64; 2])],
    step: usize,
    mut visit: impl FnMut(usize),
) -> Result<State, SimulationError> {
    let mut simulation = Simulation::new(model.clone());
    let seconds = 1e-3 * step as f64;
    for row in 0..(10.0 * SECONDS) as usize {
        let [from, to] = [row, row + 1].map(|row| at(table, 0.1 * row as f64));
        let rates = [10.0 * (to.left - from.left), 10.0 * (to.right - from.right)];
        for part in 0..100 / step {
            let speeds = from.left + rates[0] * seconds * part as f64;
            let other = from.right + rates[1] * seconds * part as f64;
            simulation.set_wheel_speeds([speeds, other].into())?;
            simulation.set_wheel_accelerations(rates.into())?;
            simulation.step(seconds)?;
            visit(row * (100 / step) + part);
        }
    }
    Ok(simulation.state())
}

/// The dearest step of 10 ms \[us\]; each the least of the runs.
fn dearest(model: &VehicleModel, table: &[(f64, [f64; 2])]) -> f64 {
    let mut least = vec![f64::INFINITY; (100.0 * SECONDS) as usize];
    for _ in 0..RUNS {
        let mut before = processor();
        // A drive that breaks off has been measured up to there.
        drive(model, table, 10, |step| {
            let now = processor();
            least[step] = least[step].min(now - before);
            before = processor();
        })
        .ok();
    }
    let taken = least.into_iter().filter(|seconds| seconds.is_finite());
    1e6 * taken.fold(0.0, f64::max)
}

/// How a drive went.
struct Went {
    what: String,
    soil: &'static str,
    effects: Vec<String>,
    /// Ended, bogged down, or broke off otherwise, in steps of 10 ms.
    end: &'static str,
    error: String,
    /// Of the ends in steps of 1 and 100 ms from that of 10 ms \[mm, mrad\]; none where a drive broke off.
    apart: Option<[f64; 2]>,
    dearest: f64,
}

fn went(drawn: &Drive) -> Went {
    let model = VehicleModel::from_specification(&drawn.specification).expect("a legal model");
    let ends = STEPS.map(|step| drive(&model, &drawn.table, step, |_| ()));
    let (end, error) = match &ends[1] {
        Ok(_) => ("ended", String::new()),
        Err(SimulationError::Balance {
            source: BalanceError::Bogged { .. },
            ..
        }) => ("bogged down", String::new()),
        Err(error) => ("broke off", error.to_string()),
    };
    let states: Vec<State> = ends
        .iter()
        .filter_map(|end| end.as_ref().ok().copied())
        .collect();
    let apart = (states.len() == STEPS.len()).then(|| {
        let far = |other: &State| {
            let of = &states[1];
            let turned = (other.heading - of.heading).abs();
            [1e3 * (other.x - of.x).hypot(other.y - of.y), 1e3 * turned]
        };
        let [a, b] = [far(&states[0]), far(&states[2])];
        [a[0].max(b[0]), a[1].max(b[1])]
    });
    let preset = Terrain::PRESETS.iter().find(|name| {
        Terrain::preset(name).is_some_and(|preset| preset == drawn.specification.terrain)
    });
    let names = drawn.what.split('[').nth(1).unwrap_or_default();
    let names = names.split('"').skip(1).step_by(2);
    Went {
        what: drawn.what.clone(),
        soil: preset.map_or("another soil", |name| name),
        effects: names.map(str::to_owned).collect(),
        end,
        error,
        apart,
        dearest: dearest(&model, &drawn.table),
    }
}

fn share(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// A row of the table for some of the drives.
fn row(name: &str, of: &[&Went]) {
    let count = |end: &str| of.iter().filter(|went| went.end == end).count();
    let apart: Vec<[f64; 2]> = of.iter().filter_map(|went| went.apart).collect();
    let [mm, mrad] = [0, 1].map(|k| sorted(apart.iter().map(|apart| apart[k]).collect()));
    let within = apart
        .iter()
        .filter(|[mm, mrad]| *mm <= 5.0 && *mrad <= 2.0)
        .count();
    let ended = of.iter().filter(|went| went.end == "ended");
    let dearest = sorted(ended.map(|went| went.dearest).collect());
    println!(
        "| {name} | {} | {} | {} | {:.1} % | {:.2}, {:.1}, {:.0} | {:.2}, {:.1}, {:.0} | {:.0}, {:.0}, {:.0} |",
        of.len(),
        count("bogged down"),
        count("broke off"),
        100.0 * within as f64 / apart.len().max(1) as f64,
        share(&mm, 0.5),
        share(&mm, 0.95),
        share(&mm, 1.0),
        share(&mrad, 0.5),
        share(&mrad, 0.95),
        share(&mrad, 1.0),
        share(&dearest, 0.5),
        share(&dearest, 0.95),
        share(&dearest, 1.0),
    );
}

fn main() {
    let count = std::env::args().skip(1).find_map(|word| word.parse().ok());
    let all: Vec<Went> = (0..count.unwrap_or(200_u64))
        .into_par_iter()
        .map(|seed| went(&draw::plausible(seed)))
        .collect();
    println!(
        "| drives | number | bogged down | broke off | within 5 mm and 2 mrad | apart \\[mm\\]: median, 95 %, most | turned \
         \\[mrad\\] | dearest step of 10 ms \\[us\\] |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    row("all", &all.iter().collect::<Vec<_>>());
    let mut groups: BTreeMap<(u8, String), Vec<&Went>> = BTreeMap::new();
    for went in &all {
        groups
            .entry((0, went.soil.to_owned()))
            .or_default()
            .push(went);
        for effect in &went.effects {
            groups
                .entry((2, format!("with `{effect}`")))
                .or_default()
                .push(went);
        }
        if went.effects.is_empty() {
            groups
                .entry((1, "no effect".to_owned()))
                .or_default()
                .push(went);
        }
    }
    for ((_, name), of) in &groups {
        row(name, of);
    }
    println!("\nBroke off:\n");
    for went in all.iter().filter(|went| went.end == "broke off") {
        println!("- {}: {}", went.what, went.error);
    }
    println!("\nFarthest apart, and dearest:\n");
    let far = |went: &Went| went.apart.map_or(0.0, |apart| apart[0]);
    for (by, unit) in [
        (&far as &dyn Fn(&Went) -> f64, "mm"),
        (&|went| went.dearest, "us"),
    ] {
        let mut first: Vec<&Went> = all.iter().filter(|went| went.end == "ended").collect();
        first.sort_by(|a, b| by(b).total_cmp(&by(a)));
        for went in first.into_iter().take(LISTED) {
            println!("- {}, {}: {:.0} {unit}", went.what, went.soil, by(went));
        }
    }
}
