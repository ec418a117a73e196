//! The motion as CSV.

use super::drive::DrivePoint;
use std::io::{self, Write};
use ugv_terrain::vehicle::WheelOutputs;

type PointValue = fn(&DrivePoint) -> f64;
type WheelValue = fn(&WheelOutputs) -> f64;

/// Names and values of the columns.
const COLUMNS: [(&str, PointValue); 14] = [
    ("time", |point| point.time),
    ("omega_left", |point| point.wheel_speeds.left),
    ("omega_right", |point| point.wheel_speeds.right),
    ("x", |point| point.state.x),
    ("y", |point| point.state.y),
    ("heading", |point| point.state.heading),
    ("v_x", |point| point.state.v_x),
    ("v_y", |point| point.state.v_y),
    ("yaw_rate", |point| point.state.yaw_rate),
    ("a_x", |point| point.wrench.a_x),
    ("a_y", |point| point.wrench.a_y),
    ("rolling_resistance", |point| {
        point.wrench.rolling_resistance
    }),
    ("turning_resistance_moment", |point| {
        point.wrench.turning_resistance_moment
    }),
    ("turning_moment", |point| point.wrench.turning_moment),
];

/// The columns of each wheel.
const WHEEL_COLUMNS: [(&str, WheelValue); 7] = [
    ("longitudinal_slip", |wheel| wheel.longitudinal_slip),
    ("lateral_slip", |wheel| wheel.lateral_slip),
    ("load", |wheel| wheel.load),
    ("sinkage", |wheel| wheel.sinkage),
    ("entry_angle", |wheel| wheel.entry_angle),
    ("force_x", |wheel| wheel.force_x),
    ("force_y", |wheel| wheel.force_y),
];

/// The header line for a vehicle with this many wheels.
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
pub fn write_row(out: &mut impl Write, point: &DrivePoint) -> io::Result<()> {
    for (index, (_, value)) in COLUMNS.iter().enumerate() {
        let comma = if index > 0 { "," } else { "" };
        // -0 becomes 0.
        write!(out, "{comma}{:?}", value(point) + 0.0)?;
    }
    for wheel in &point.wrench.wheels {
        for (_, value) in &WHEEL_COLUMNS {
            write!(out, ",{:?}", value(wheel) + 0.0)?;
        }
    }
    writeln!(out)
}
