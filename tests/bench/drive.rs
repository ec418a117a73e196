//! The mixed drive of all benchmarks: one table, which Rust, C and NumPy drive.

use std::f64::consts::TAU;
use std::fmt::Write;
use ugv_terrain::simulation::WheelSpeeds;
use ugv_terrain::simulation::batch::WheelSpeedTable;

/// Length of the drive \[s\].
pub const SECONDS: f64 = 60.0;
/// Rows of the table in each second; between them the wheel speeds are linear.
const ROWS_PER_SECOND: usize = 10;

/// Wheel speeds \[rad/s\]: start, slalom, pivot to and fro, reverse with a bend, stop.
fn wheel_speeds(time: f64) -> WheelSpeeds {
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

/// The first seconds of the drive, in `parts` rows for each of the table's.
pub fn mixed(seconds: f64, parts: usize) -> WheelSpeedTable {
    let rows = (seconds * ROWS_PER_SECOND as f64).round() as usize;
    let at = |row: usize| wheel_speeds(row as f64 / ROWS_PER_SECOND as f64);
    let (mut time, mut speeds) = (Vec::new(), Vec::new());
    for place in 0..=rows * parts {
        let (row, share) = (place / parts, (place % parts) as f64 / parts as f64);
        let (from, to) = (at(row), at(row + 1));
        let between = |from: f64, to: f64| from + share * (to - from);
        time.push(place as f64 / (ROWS_PER_SECOND * parts) as f64);
        speeds.push(WheelSpeeds {
            left: between(from.left, to.left),
            right: between(from.right, to.right),
        });
    }
    WheelSpeedTable::new(time, speeds).expect("times increase")
}

/// The table as CSV, which reads back to the last bit.
pub fn csv() -> String {
    let table = mixed(SECONDS, 1);
    let mut text = "time,omega_left,omega_right\n".to_owned();
    for (time, speeds) in table.time().iter().zip(table.wheel_speeds()) {
        writeln!(text, "{time:?},{:?},{:?}", speeds.left, speeds.right).expect("a text");
    }
    text
}
