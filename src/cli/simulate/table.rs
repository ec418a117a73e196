//! The motion as CSV.

use super::drive::Stop;
use std::io::{self, Write};
use ugv_terrain::vehicle::WheelOutputs;

type Value = fn(&Stop) -> f64;
type WheelValue = fn(&WheelOutputs) -> f64;

/// Names and values of the columns.
const COLUMNS: [(&str, Value); 14] = [
    ("time", |stop| stop.time),
    ("omega_left", |stop| stop.wheel_speeds.left),
    ("omega_right", |stop| stop.wheel_speeds.right),
    ("x", |stop| stop.state.x),
    ("y", |stop| stop.state.y),
    ("heading", |stop| stop.state.heading),
    ("v_x", |stop| stop.state.v_x),
    ("v_y", |stop| stop.state.v_y),
    ("yaw_rate", |stop| stop.state.yaw_rate),
    ("a_x", |stop| stop.wrench.a_x),
    ("a_y", |stop| stop.wrench.a_y),
    ("rolling_resistance", |stop| stop.wrench.rolling_resistance),
    ("turning_resistance_moment", |stop| {
        stop.wrench.turning_resistance_moment
    }),
    ("turning_moment", |stop| stop.wrench.turning_moment),
];

/// The same for each wheel.
const WHEEL_COLUMNS: [(&str, WheelValue); 7] = [
    ("longitudinal_slip", |wheel| wheel.longitudinal_slip),
    ("lateral_slip", |wheel| wheel.lateral_slip),
    ("load", |wheel| wheel.load),
    ("sinkage", |wheel| wheel.sinkage),
    ("entry_angle", |wheel| wheel.entry_angle),
    ("force_x", |wheel| wheel.force_x),
    ("force_y", |wheel| wheel.force_y),
];

/// The header line for a vehicle with so many wheels.
pub fn header(wheels: usize) -> String {
    let mut names: Vec<String> = COLUMNS.iter().map(|(name, _)| (*name).into()).collect();
    for wheel in 1..=wheels {
        names.extend(
            WHEEL_COLUMNS
                .iter()
                .map(|(name, _)| format!("wheel[{wheel}].{name}")),
        );
    }
    names.join(",") + "\n"
}

/// Writes a row; its numbers read back to the last bit.
pub fn write_row(out: &mut impl Write, stop: &Stop) -> io::Result<()> {
    for (index, (_, value)) in COLUMNS.iter().enumerate() {
        let comma = if index > 0 { "," } else { "" };
        write!(out, "{comma}{:?}", unsigned_zero(value(stop)))?;
    }
    for wheel in &stop.wrench.wheels {
        for (_, value) in &WHEEL_COLUMNS {
            write!(out, ",{:?}", unsigned_zero(value(wheel)))?;
        }
    }
    writeln!(out)
}

/// -0 says nothing that 0 does not.
fn unsigned_zero(value: f64) -> f64 {
    value + 0.0
}
